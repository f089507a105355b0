// The window that hands over: files into a folder, the graph, its code, its picture.

import { useEffect, useState } from "react";
import { get } from "./api.js";
import { anchored, placesOf, sizeOf } from "./graph.js";
import { described, edit, exportFiles, familyOf, fileOf, guarded, now, toast, useStudio } from "./store.js";
import { savePicture } from "./view.jsx";

/** What most people want to hand over: a node, the name of its step, its file, and what it is. */
const KINDS = [
  ["write_step", "step", "panels.step", "STEP for CAD and machines"], ["write_3dm", "rhino", "model.3dm", "Rhino model"],
  ["write_ifc", "ifc", "model.ifc", "IFC for building models"], ["write_view", "view", "view.html", "page to look at in any browser"],
  ["render", "picture", "picture.png", "picture"], ["write_drawings", "drawings", "drawings.pdf", "drawings of panels and beams"],
  ["write_mould_drawings", "mould_drawings", "moulds.dxf", "panels in the blanks of their moulds"], ["write_dxf", "cutting", "beams.dxf", "cutting drawings of beams"],
  ["write_schedule", "table", "schedule.csv", "list of panels"], ["write_tables", "tables", "tables.xlsx", "tables of all parts"],
];
const WHAT = new Map(KINDS.map(([node, , , what]) => [node, what]));

/** The last output of a family, and whether its step is finished. */
function lastOutput(s, family) {
  for (const name of Object.keys(s.doc.graph.steps).reverse()) {
    const port = s.doc.facts[name]?.nesting || s.doc.facts[name]?.unfinished ? null : described(s, name)?.outputs.find((each) => familyOf(s, each) === family);
    if (port) return { wire: `${name}.${port.name}`, type: port.type };
  }
  return null;
}

/** What a writer is given: the last panels and the last beams; null if it needs what is not there. */
function inputsFor(s, node) {
  const found = {};
  for (const port of node.inputs) {
    if (port.name !== "panels" && port.name !== "beams") continue;
    const source = lastOutput(s, port.name);
    if (source && s.catalogue.fits[source.type].has(port.type)) found[port.name] = { wire: source.wire };
    else if (port.required) return null;
  }
  return Object.keys(found).length ? found : null;
}

/** Below the others that write, or right of all. */
function placeFor(s) {
  const places = placesOf(s), boxes = Object.keys(places).map((id) => ({ id, x: places[id][0], y: places[id][1], size: sizeOf(s, id) }));
  const writers = boxes.filter(({ id }) => id.startsWith("s:") && described(s, id.slice(2))?.writes);
  const x = writers.length ? Math.max(...writers.map((box) => box.x)) : Math.max(...boxes.map((box) => box.x + box.size[0])) + 60;
  const column = boxes.filter((box) => Math.abs(box.x - x) < box.size[0]);
  const y = column.length ? Math.max(...column.map((box) => box.y + box.size[1])) + 26 : Math.min(...boxes.map((box) => box.y));
  return [Math.round(x), Math.round(y)];
}

function addWriter([kind, step, path]) {
  const s = now(), inputs = inputsFor(s, s.catalogue.nodes[kind]);
  let name = step, number = 2;
  while (name in s.doc.graph.steps) name = `${step}_${number++}`;
  edit(anchored(s, [{ op: "add", node: kind, name, inputs: { ...inputs, path }, at: placeFor(s) }]));
}

/** Every graph has a folder of its own, unless another one is chosen. */
const usualFolder = ({ file, graph }) => `${(file || graph.title || "graph").replace(/\.json$/i, "").replace(/[:*?"<>|\\]+/g, " ").trim() || "graph"} files`;

/** What there is already where the graph would write: asked for again after every change. */
function useReplaced(folder, doc, state) {
  const [replaced, setReplaced] = useState([]);
  useEffect(() => {
    let isLast = true;
    const take = (names) => { if (isLast) setReplaced(names); };
    const timer = setTimeout(() => get(`replaced?folder=${encodeURIComponent(folder)}`).then(take, () => take([])), 100);
    return () => { isLast = false; clearTimeout(timer); };
  }, [folder, doc, state]);
  return replaced;
}

export function Export() {
  const [folder, setFolder] = useState(() => usualFolder(now().doc));
  const [written, setWritten] = useState("");
  const [overwrite, setOverwrite] = useState(false);
  const { exported, place, doc, catalogue } = useStudio((s) => ({ exported: s.exported, place: s.place, doc: s.doc, catalogue: s.catalogue }));
  const s = now(), writers = Object.entries(doc.graph.steps).filter(([name]) => described(s, name)?.writes);
  const used = new Set(writers.map(([, entry]) => entry.node));
  const others = KINDS.filter(([node]) => !used.has(node) && inputsFor(s, catalogue.nodes[node]));
  const isWriting = exported?.state === "running", replaced = useReplaced(folder, doc, exported?.state);
  const code = () => guarded(get("code").then(({ code: text }) => save(`${doc.graph.title || "graph"}.py`, text)));
  return (
    <>
      <h2>Export</h2>
      {writers.length ? (
        <ul className="writers" aria-label="files">
          {writers.map(([name, entry]) => (
            <li key={name}>
              <b>{fileOf(s, name) || name}</b><span>{doc.facts[name]?.unfinished ? "not finished yet: left out" : WHAT.get(entry.node) ?? described(s, name).summary.replace(/\.$/, "")}</span>
              <button aria-label={`do not write ${fileOf(s, name)}`} title="do not write it" onClick={() => edit([{ op: "remove", steps: [name], params: [] }])}>×</button>
            </li>
          ))}
        </ul>
      ) : <p className="quiet">{others.length ? "Choose what is to be written:" : "There is nothing to write yet: make panels first."}</p>}
      {others.length ? <div className="chips">{others.map((each) => <button key={each[0]} title={each[2]} onClick={() => addWriter(each)}>+ {each[3]}</button>)}</div> : null}
      <form className="line into" onSubmit={(event) => { event.preventDefault(); setWritten(folder); exportFiles(folder, overwrite); }}>
        <label>into folder <input value={folder} aria-label="folder" onChange={(event) => setFolder(event.target.value)} spellCheck={false} /></label>
        <button className="primary" disabled={!writers.length || isWriting}>{isWriting ? "Writing …" : "Write files"}</button>
      </form>
      {replaced.length && !(exported && written === folder) ? <p className="replaces" role="status" title={replaced.join("\n")}>replaces {replaced.length === 1 ? "1 file" : `${replaced.length} files`} written before: {replaced.slice(0, 4).join(", ")}{replaced.length > 4 ? ", …" : ""}</p> : null}
      <label className="check"><input type="checkbox" checked={overwrite} onChange={(event) => setOverwrite(event.target.checked)} />also replace files that spheremesh did not write</label>
      {exported ? <Outcome exported={exported} where={`${place}/${written}`} /> : null}
      <h3>The graph</h3>
      <div className="line">
        <button onClick={code}>Python code</button>
        <button onClick={() => save(`${doc.graph.title || "graph"}.json`, `${JSON.stringify(doc.graph, null, 2)}\n`)}>Graph file</button>
        <button onClick={() => { if (!savePicture()) toast("no picture is shown"); }}>Picture as shown</button>
      </div>
    </>
  );
}

function Outcome({ exported, where }) {
  const running = useStudio((s) => Object.values(s.steps).find((each) => each.state === "running" || each.state === "progress")?.step);
  const { state, text } = exported;
  if (state === "running") return <div className="outcome is-running" role="status">Writing{running ? `: ${running}` : ""}</div>;
  if (state !== "done") return <div className={`outcome is-${state}`} role="status">{text || state}</div>;
  const files = text.split("\n").filter((each) => each && !each.startsWith("."));
  return <div className="outcome is-done" role="status"><b>Written to {where}</b><ul>{files.map((each) => <li key={each}>{each}</li>)}</ul></div>;
}

function save(name, text) {
  const link = document.createElement("a"), address = URL.createObjectURL(new Blob([text], { type: "text/plain" }));
  link.download = name;
  link.href = address;
  link.click();
  setTimeout(() => URL.revokeObjectURL(address), 1000);
}
