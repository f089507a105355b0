// Where one begins: a template on the demo roof or on a mesh of one's own, a graph, or nothing.

import { useEffect, useRef, useState } from "react";
import { get, send } from "./api.js";
import { canvasActions } from "./canvas.jsx";
import { guarded, open, set, toast, useStudio } from "./store.js";

const MESHES = ".obj,.off,.ply,.stl,.3dm";

/** What to begin with on an empty canvas. */
export function Empty() {
  const add = () => set({ dialog: { kind: "palette", at: canvasActions.current?.middle() ?? { x: 0, y: 0 } } });
  return (
    <div className="empty">
      <h2>Begin with a roof</h2>
      <Templates />
      <p>or <button className="link" onClick={() => set({ dialog: { kind: "open" } })}>open a graph</button>, or <button className="link" onClick={add}>add a step</button> to an empty canvas.</p>
    </div>
  );
}

/** Templates, and the mesh that they begin with. */
export function Templates() {
  const templates = useStudio((s) => s.templates);
  const [files, setFiles] = useState([]);
  const [mesh, setMesh] = useState("");
  const [isOver, setOver] = useState(false);
  const picked = useRef(null);
  useEffect(() => { guarded(get("files?ending=mesh").then(setFiles)); }, []);
  const receive = (file) => {
    if (!file) return;
    guarded(send(file).then(({ file: name }) => {
      setFiles((before) => [...new Set([...before, name])]);
      setMesh(name);
      toast(`${name} is in the folder: choose what becomes of it`, "note");
    }));
  };
  return (
    <div className={`templates${isOver ? " over" : ""}`} onDragOver={(event) => { event.preventDefault(); setOver(true); }} onDragLeave={() => setOver(false)}
      onDrop={(event) => { event.preventDefault(); setOver(false); receive(event.dataTransfer.files[0]); }}>
      <div className="design">
        <label>Mesh <select aria-label="mesh to begin with" value={mesh} onChange={(event) => setMesh(event.target.value)}>
          <option value="">a demo roof</option>
          {files.map((each) => <option key={each} value={each}>{each}</option>)}
        </select></label>
        <button onClick={() => picked.current.click()} title={`${MESHES.replaceAll(",", " ")}; or drop it here`}>My mesh file …</button>
        <input type="file" ref={picked} accept={MESHES} hidden aria-label="mesh file" onChange={(event) => { receive(event.target.files[0]); event.target.value = ""; }} />
      </div>
      <div className="cards">
        {templates.map((each) => (
          <button key={each.name} className="card" onClick={() => { open({ template: each.name, mesh }); set({ dialog: null }); }}><b>{each.title}</b><span>{each.summary}</span></button>
        ))}
      </div>
    </div>
  );
}
