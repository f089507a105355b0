// The studio: a canvas on the left, what it makes on the right.

import { Component, useEffect, useRef, useState } from "react";
import { createRoot } from "react-dom/client";
import { Bar } from "./bar.jsx";
import { Canvas } from "./canvas.jsx";
import { Dialogs } from "./dialogs.jsx";
import { Preview } from "./preview.jsx";
import { begin, now, set, useStudio } from "./store.js";

function Studio() {
  const { ready, fatal, toast } = useStudio((s) => ({ ready: s.ready, fatal: s.fatal, toast: s.toast }));
  const [share, setShare] = useState(() => Number(sessionStorage.getItem("share")) || 0.46);
  const title = useStudio((s) => s.doc?.graph.title ?? "");
  useEffect(() => { document.title = `${title || "Untitled"} · spheremesh studio`; }, [title]);
  useEffect(() => { if (ready) document.documentElement.dataset.ready = ""; }, [ready]);
  if (fatal && !ready) return <p className="opening">{fatal}</p>;
  if (!ready) return <p className="opening">Opening the studio</p>;
  return (
    <div className="studio" style={{ "--share": share }}>
      <Bar />
      <main>
        <Canvas />
        <Divider share={share} setShare={setShare} />
        <Preview />
      </main>
      <Dialogs />
      {toast ? <Toast key={toast.id} {...toast} /> : null}
    </div>
  );
}

function Divider({ share, setShare }) {
  const line = useRef(null);
  const move = (next) => {
    const kept = Math.min(0.8, Math.max(0.2, next));
    sessionStorage.setItem("share", kept);
    setShare(kept);
  };
  return (
    <div className="divider" ref={line} role="separator" tabIndex={0} aria-label="between canvas and preview" aria-orientation="vertical" aria-valuenow={Math.round(100 * share)}
      onPointerDown={(event) => event.currentTarget.setPointerCapture(event.pointerId)}
      onPointerMove={(event) => {
        if (!event.currentTarget.hasPointerCapture(event.pointerId)) return;
        const box = line.current.parentElement.getBoundingClientRect();
        move(box.width > 760 ? (event.clientX - box.left) / box.width : 1 - (event.clientY - box.top) / box.height);
      }}
      onKeyDown={(event) => { const by = { ArrowLeft: -0.03, ArrowRight: 0.03 }[event.key]; if (by) { event.stopPropagation(); move(share + by); } }} />
  );
}

function Toast({ text, kind }) {
  useEffect(() => {
    const timer = setTimeout(() => set({ toast: null }), 8000);
    return () => clearTimeout(timer);
  }, []);
  return <div className={`toast ${kind}`} role="alert">{text}<button aria-label="close" onClick={() => set({ toast: null })}>×</button></div>;
}

/** What goes wrong on the page is said there; the graph stands on the server. */
class Guarded extends Component {
  state = { fault: "" };

  static getDerivedStateFromError(error) { return { fault: error.message }; }

  render() {
    if (!this.state.fault) return this.props.children;
    return <p className="opening">Something went wrong on this page; your graph is kept. <button className="link" onClick={() => location.reload()}>Load the page again</button><br /><small>{this.state.fault}</small></p>;
  }
}

window.studio = { now };
begin();
createRoot(document.getElementById("root")).render(<Guarded><Studio /></Guarded>);
