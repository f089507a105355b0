// Windows over the page: open, rename, comment, save, keys.

import { useEffect, useRef, useState } from "react";
import { get } from "./api.js";
import { Export } from "./export.jsx";
import { KEYS } from "./keys.js";
import { Connect, Palette } from "./palette.jsx";
import { Templates } from "./start.jsx";
import { edit, guarded, now, open, revert, saveAs, set, useStudio } from "./store.js";

const TITLES = { palette: "Add a step", connect: "Connect", open: "Open", export: "Export", rename: "Rename", comment: "Comment", keys: "Keys", save: "Save as" };

export function Dialogs() {
  const dialog = useStudio((s) => s.dialog);
  if (!dialog) return null;
  const close = () => set({ dialog: null });
  return (
    <div className="shade" onPointerDown={(event) => { if (event.target === event.currentTarget) close(); }}>
      <Window dialog={dialog} close={close} />
    </div>
  );
}

function Window({ dialog, close }) {
  const box = useRef(null), before = useRef(document.activeElement);
  useEffect(() => {
    if (!box.current.contains(document.activeElement)) (box.current.querySelector("[autofocus], input, button:not(.close)") ?? box.current).focus();
    const back = before.current;
    return () => { if (back?.isConnected && document.activeElement === document.body) back.focus({ preventScroll: true }); };
  }, []);
  /** Tab goes around within the window. */
  const around = (event) => {
    if (event.key !== "Tab") return;
    const all = [...box.current.querySelectorAll("button, input, select, textarea, [tabindex]")].filter((each) => !each.disabled && each.offsetParent);
    const first = all[0], last = all[all.length - 1];
    if (event.shiftKey && document.activeElement === first) { event.preventDefault(); last.focus(); }
    if (!event.shiftKey && document.activeElement === last) { event.preventDefault(); first.focus(); }
  };
  const kinds = { palette: Palette, connect: Connect, open: Open, export: Export, rename: Rename, comment: Comment, keys: Keys, save: Save };
  const Kind = kinds[dialog.kind];
  return (
    <div className={`window ${dialog.kind}`} role="dialog" aria-modal="true" aria-label={TITLES[dialog.kind]} ref={box} tabIndex={-1} onKeyDown={around}>
      <button className="close" aria-label="close" onClick={close}>×</button>
      <Kind {...dialog} close={close} />
    </div>
  );
}

function Open({ close }) {
  const view = useStudio((s) => ({ versions: s.versions, place: s.place, file: s.doc.file }));
  const [files, setFiles] = useState([]);
  useEffect(() => { guarded(get("files?ending=.json").then(setFiles)); }, []);
  return (
    <>
      <h2>Open</h2>
      <h3>A new roof</h3>
      <Templates />
      <p><button className="link" onClick={() => { open({}); close(); }}>An empty graph</button></p>
      <h3>Graphs in {view.place}</h3>
      <ul className="files">{files.map((each) => <li key={each}><button onClick={() => { open({ file: each }); close(); }} aria-current={each === view.file}>{each}</button></li>)}{!files.length ? <li className="quiet">none yet</li> : null}</ul>
      {view.versions.length ? <><h3>Earlier versions of {view.file}</h3><ul className="files">{view.versions.map((each) => <li key={each}><button onClick={() => { revert(each); close(); }}>{each}</button></li>)}</ul></> : null}
    </>
  );
}

function Rename({ id, close }) {
  const old = id.slice(2), kind = { s: "steps", p: "params", g: "groups" }[id[0]];
  const [text, setText] = useState(old);
  const rename = (event) => {
    event.preventDefault();
    const name = kind === "groups" ? text.trim() : text.trim().replace(/[^\p{L}\p{N}_]+/gu, "_");
    close();
    if (!name || name === old) return;
    const members = now().doc.graph.groups?.[old] ?? [];
    edit(kind === "groups" ? [{ op: "group", name: old, steps: [] }, { op: "group", name, steps: members }] : [{ op: "rename", kind, old, new: name }]);
  };
  return <form onSubmit={rename}><h2>Rename {old}</h2><div className="line"><input autoFocus aria-label="new name" value={text} onChange={(event) => setText(event.target.value)} onFocus={(event) => event.target.select()} spellCheck={false} /><button className="primary">Rename</button></div></form>;
}

function Comment({ step, close }) {
  const [text, setText] = useState(now().doc.graph.comments?.[step] ?? "");
  const say = (event) => { event?.preventDefault(); close(); edit([{ op: "comment", step, text: text.trim() }]); };
  return <form onSubmit={say}><h2>Comment on {step || "the graph"}</h2><textarea autoFocus aria-label="comment" rows={4} value={text} onChange={(event) => setText(event.target.value)} onKeyDown={(event) => { if (event.key === "Enter" && (event.ctrlKey || event.metaKey)) say(); }} /><div className="line"><button className="primary">Keep</button></div></form>;
}

function Save({ close }) {
  const [text, setText] = useState(now().doc.file || "graph.json");
  return <form onSubmit={(event) => { event.preventDefault(); saveAs(text); close(); }}><h2>Save as</h2><div className="line"><label>{now().folder}/<input autoFocus aria-label="file" value={text} onChange={(event) => setText(event.target.value)} spellCheck={false} /></label><button className="primary">Save</button></div><p className="quiet">The graph is saved as you edit it; earlier versions stand beside and under Open.</p></form>;
}

function Keys() {
  return <><h2>Keys</h2><dl className="keys">{KEYS.map(([key, what]) => <div key={key}><dt>{key}</dt><dd>{what}</dd></div>)}</dl></>;
}
