// Windows over the page: open, export, rename, comment, keys.

import { useEffect, useRef, useState } from "react";
import { get } from "./api.js";
import { TemplateCards } from "./canvas.jsx";
import { KEYS } from "./keys.js";
import { Connect, Palette } from "./palette.jsx";
import { edit, exportFiles, guarded, now, open, revert, saveAs, set, toast, useStudio } from "./store.js";
import { savePicture } from "./view.jsx";

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
  const view = useStudio((s) => ({ templates: s.templates, versions: s.versions, folder: s.folder, file: s.doc.file }));
  const [files, setFiles] = useState([]);
  useEffect(() => { guarded(get("files?ending=.json").then(setFiles)); }, []);
  return (
    <>
      <h2>Open</h2>
      <h3>Start from a template</h3>
      <div className="cards"><TemplateCards templates={view.templates} /><button className="card" onClick={() => { open({}); close(); }}><b>Empty graph</b><span>Double-click the canvas to add steps.</span></button></div>
      <h3>Graphs in {view.folder}</h3>
      <ul className="files">{files.map((each) => <li key={each}><button onClick={() => { open({ file: each }); close(); }} aria-current={each === view.file}>{each}</button></li>)}{!files.length ? <li className="quiet">none yet</li> : null}</ul>
      {view.versions.length ? <><h3>Earlier versions of {view.file}</h3><ul className="files">{view.versions.map((each) => <li key={each}><button onClick={() => { revert(each); close(); }}>{each}</button></li>)}</ul></> : null}
    </>
  );
}

function Export() {
  const [folder, setFolder] = useState("out");
  const [overwrite, setOverwrite] = useState(false);
  const view = useStudio((s) => ({ exported: s.exported, root: s.folder, writers: Object.entries(s.doc.graph.steps).filter(([, entry]) => s.catalogue.nodes[entry.node]?.writes).map(([name, entry]) => `${name}: ${entry.inputs.path ?? s.catalogue.nodes[entry.node].inputs.find((p) => p.writes)?.default ?? ""}`) }));
  const { exported } = view;
  const code = () => guarded(get("code").then(({ code: text }) => save(`${now().doc.graph.title || "graph"}.py`, text)));
  return (
    <>
      <h2>Export</h2>
      <h3>Files</h3>
      {view.writers.length ? <p className="quiet">{view.writers.join(" · ")}</p> : <p className="quiet">No step writes a file yet. Add one: write step, write 3dm, write view, write schedule.</p>}
      <form className="line" onSubmit={(event) => { event.preventDefault(); exportFiles(folder, overwrite); }}>
        <label>{view.root}/<input value={folder} aria-label="folder" onChange={(event) => setFolder(event.target.value)} spellCheck={false} /></label>
        <button className="primary" disabled={!view.writers.length || exported?.state === "running"}>Write files</button>
      </form>
      <label className="check"><input type="checkbox" checked={overwrite} onChange={(event) => setOverwrite(event.target.checked)} />also replace files that spheremesh did not write</label>
      {exported ? <div className={`outcome is-${exported.state}`} role="status">{exported.state === "running" ? "Writing" : exported.state === "done" ? <><b>Written to {view.root}/{folder}</b><ul>{exported.text.split("\n").filter((each) => each && !each.startsWith(".")).map((each) => <li key={each}>{each}</li>)}</ul></> : exported.text || exported.state}</div> : null}
      <h3>The graph and its picture</h3>
      <div className="line">
        <button onClick={code}>Python code</button>
        <button onClick={() => { const { graph } = now().doc; save(`${graph.title || "graph"}.json`, `${JSON.stringify(graph, null, 2)}\n`); }}>Graph file</button>
        <button onClick={() => { if (!savePicture()) toast("no picture is shown"); }}>Picture</button>
      </div>
    </>
  );
}

function save(name, text) {
  const link = document.createElement("a"), address = URL.createObjectURL(new Blob([text], { type: "text/plain" }));
  link.download = name;
  link.href = address;
  link.click();
  setTimeout(() => URL.revokeObjectURL(address), 1000);
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
