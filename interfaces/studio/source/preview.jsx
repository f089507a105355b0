// What is shown beside the canvas: the output that was chosen, and those that are pinned.

import { useEffect, useRef, useState } from "react";
import { blob } from "./api.js";
import { portOf } from "./graph.js";
import { togglePin } from "./keys.js";
import { described, pinsOf, set, show, useStudio } from "./store.js";
import { Numbers, Table } from "./tables.jsx";
import { LinkButton, ModelView } from "./view.jsx";

const shownNow = (s) => [...new Set([...(s.doc ? pinsOf(s.doc.graph) : []), s.shown].filter(Boolean))].slice(0, 6);

export function Preview() {
  const targets = useStudio((s) => shownNow(s));
  if (!targets.length) return <section className="preview nothing" aria-label="preview"><p>Choose a step to see what it makes.</p></section>;
  return (
    <section className={`preview tiles-${targets.length}`} aria-label="preview">
      {targets.map((target) => <Tile key={target} target={target} alone={targets.length === 1} />)}
      {targets.length > 1 ? <div className="link"><LinkButton /></div> : null}
    </section>
  );
}

function Tile({ target, alone }) {
  const [step, portName] = target.split(".");
  const view = useStudio((s) => ({ preview: s.previews[target], state: s.steps[step], facts: s.doc.facts[step], node: described(s, step), isPinned: pinsOf(s.doc.graph).includes(target), isRunning: s.running > 0 }));
  const { preview, state, facts, node, isPinned, isRunning } = view;
  const [data, setData] = useState(null), [fault, setFault] = useState("");
  const asked = useRef("");
  useEffect(() => {
    if (!preview) return;
    asked.current = preview.digest;
    setFault("");
    Promise.all([blob(preview.digest), import("/studio/viewer.js")]).then(([bytes, { decodeModel }]) => {
      if (asked.current !== preview.digest) return;
      const [head, arrays] = decodeModel(bytes);
      setData({ head, arrays, digest: preview.digest });
    }, (error) => setFault(error.message));
  }, [preview?.digest]);
  const says = facts?.unfinished ? `${step} is not finished yet.` : state?.state === "failed" ? state.text : fault;
  const isStale = Boolean(says) || (isRunning && ["running", "progress", "queued"].includes(state?.state));
  return (
    <article className={`tile${isStale ? " stale" : ""}`} data-target={target} data-digest={data?.digest ?? ""}>
      <header>
        <strong>{step}</strong>
        <nav role="tablist" aria-label={`outputs of ${step}`}>
          {node?.outputs.length > 1 ? node.outputs.map((port) => (
            <button key={port.name} role="tab" aria-selected={port.name === portName} onClick={() => (isPinned && port.name !== portName ? show(`${step}.${port.name}`) : show(`${step}.${port.name}`))}>{port.name.replaceAll("_", " ")}</button>
          )) : <span>{portOf(node?.outputs, portName)?.help?.replace(/\.$/, "") || ""}</span>}
        </nav>
        <button className="pin" aria-pressed={isPinned} title={isPinned ? "let it go" : "pin it: it stays while you look at others"} onClick={() => togglePin(target)}>{isPinned ? "Pinned" : "Pin"}</button>
        {!alone && !isPinned ? <button className="close" aria-label={`close ${target}`} onClick={() => set({ shown: "" })}>×</button> : null}
      </header>
      <div className="body">
        {data ? <Content data={data} target={target} /> : !says ? <p className="waiting">{isRunning ? "Making it" : ""}</p> : null}
        {says ? <p className="overlay message" role="status">{says}</p> : null}
      </div>
    </article>
  );
}

function Content({ data, target }) {
  const { head, arrays } = data;
  if (head.kind === "model") return <ModelView data={data} target={target} />;
  if (head.kind === "table") return <Table content={head.table} />;
  if (head.kind === "numbers") return <Numbers head={head} arrays={arrays} />;
  return <pre className="report">{head.text}</pre>;
}
