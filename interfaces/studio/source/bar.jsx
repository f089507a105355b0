// The bar: what is open, what can be done with it, and what runs.

import { useEffect, useState } from "react";
import { TextField } from "./fields.jsx";
import { canvasActions } from "./canvas.jsx";
import { cancel, edit, redo, set, undo, useStudio } from "./store.js";

const ICONS = {
  undo: "M6 4 2.5 7.5 6 11M3 7.5h6.5a4 4 0 0 1 0 8H7", redo: "M10 4l3.5 3.5L10 11M13 7.5H6.5a4 4 0 0 0 0 8H9", add: "M8 3v10M3 8h10",
  tidy: "M2 3h4v4H2zM10 2h4v4h-4zM10 10h4v4h-4zM6 5h4M8 5v7h2",
};
const Icon = ({ name }) => <svg viewBox="0 0 16 17" width="16" height="16" aria-hidden="true"><path d={ICONS[name]} fill="none" stroke="currentColor" strokeWidth="1.5" strokeLinecap="round" strokeLinejoin="round" /></svg>;

export function Bar() {
  const view = useStudio((s) => ({ title: s.doc.graph.title, file: s.doc.file, isNew: s.doc.is_new, fault: s.doc.fault, undo: s.doc.undo, redo: s.doc.redo, running: s.running, online: s.online, units: s.doc.graph.units }));
  const middle = () => canvasActions.current?.middle() ?? { x: 0, y: 0 };
  return (
    <header className="bar">
      <svg className="mark" viewBox="0 0 32 20" aria-hidden="true"><path d="M2 19a14 14 0 0 1 28 0z" fill="#c4530f" /><path d="M16 5v14M7 10l3.5 9M25 10l-3.5 9" stroke="#fff" strokeWidth="1.4" /></svg>
      <div className="title">
        <TextField label="title of the graph" value={view.title} placeholder="Untitled graph" onChange={(text) => edit([{ op: "title", text }])} />
        <small title={view.fault}>{view.fault ? <b>{view.fault}</b> : view.file ? (view.isNew ? `to be saved as ${view.file}` : `${view.file}, saved`) : "not saved yet"}</small>
      </div>
      <div className="buttons" role="toolbar" aria-label="graph">
        <button onClick={() => set({ dialog: { kind: "palette", at: middle() } })} title="add a step (A, or double-click the canvas)"><Icon name="add" /><span>Step</span></button>
        <button onClick={undo} disabled={!view.undo} title="undo (Ctrl+Z)" aria-label="undo"><Icon name="undo" /></button>
        <button onClick={redo} disabled={!view.redo} title="redo (Ctrl+Y)" aria-label="redo"><Icon name="redo" /></button>
        <button onClick={() => canvasActions.current?.tidy()} title="lay out anew (L)" aria-label="lay out anew"><Icon name="tidy" /></button>
        <button className="worded" onClick={() => set({ dialog: { kind: "open" } })}>Open</button>
        <button className="worded primary" onClick={() => set({ dialog: { kind: "export" }, exported: null })}>Export</button>
        <button onClick={() => set({ dialog: { kind: "keys" } })} aria-label="keys" title="keys (?)">?</button>
      </div>
      <div className="spacer" />
      <Status running={view.running} online={view.online} />
      <label className="units">units <select aria-label="units" value={view.units} onChange={(event) => edit([{ op: "units", units: event.target.value }])}>{["mm", "cm", "m", "in", "ft"].map((each) => <option key={each}>{each}</option>)}</select></label>
    </header>
  );
}

function Status({ running, online }) {
  const [shown, setShown] = useState(false);
  const last = useStudio((s) => s.lastRun);
  const what = useStudio((s) => Object.values(s.steps).find((each) => each.state === "running" || each.state === "progress"));
  // What is over in a moment does not flicker.
  useEffect(() => {
    const timer = setTimeout(() => setShown(running > 0), running ? 350 : 0);
    return () => clearTimeout(timer);
  }, [running > 0]);
  if (!online) return <span className="status" role="status">the server does not answer</span>;
  if (shown && running) return <span className="status" role="status">{what ? what.step : "runs"}{what?.share ? ` ${Math.round(100 * what.share)} %` : ""}<button onClick={cancel} title="stop at once (Esc)">Stop</button></span>;
  if (last?.state === "failed" && last.text) return <span className="status failed" role="status">{last.text}</span>;
  return <span className="status" role="status" data-cpu={last?.cpu ?? ""}>{last && last.state === "done" && !last.folder ? `done in ${last.seconds < 1 ? `${Math.round(1000 * last.seconds)} ms` : `${last.seconds.toFixed(1)} s`}` : ""}</span>;
}
