// What is shown beside the canvas: the output that was chosen, and those that are pinned.

import { useEffect, useRef, useState } from "react";
import { blob } from "./api.js";
import { portOf } from "./graph.js";
import { togglePin } from "./keys.js";
import { described, familyOf, fileOf, pinsOf, set, show, useStudio } from "./store.js";
import { unfinishedText } from "./step.jsx";
import { Numbers, Table } from "./tables.jsx";
import { LinkButton, ModelView, SwipeLine } from "./view.jsx";

const shownNow = (s) => [...new Set([...(s.doc ? pinsOf(s.doc.graph) : []), s.shown].filter(Boolean))].slice(0, 6);
const DRAWN = ["panels", "beams", "spheres", "mesh", "array"];

/** The two that are swiped, if they are still shown. */
const swipedNow = (s) => (s.swipe?.every((target) => shownNow(s).includes(target)) ? s.swipe : []);

export function Preview() {
  // What is shown of another graph begins anew, with a camera that fits.
  const opening = useStudio((s) => s.opening);
  const targets = useStudio((s) => shownNow(s)), swiped = useStudio((s) => swipedNow(s));
  const drawn = useStudio((s) => shownNow(s).filter((target) => {
    const [step, port] = target.split(".");
    return DRAWN.includes(familyOf(s, portOf(described(s, step)?.outputs, port)));
  }));
  if (!targets.length) return <section className="preview nothing" aria-label="preview"><p>What a step makes is shown here.</p></section>;
  const others = targets.filter((target) => !swiped.includes(target)), count = others.length + (swiped.length ? 1 : 0);
  return (
    <section className={`preview tiles-${count}`} aria-label="preview">
      {swiped.length ? <Swipe key={`${opening} ${swiped.join()}`} targets={swiped} /> : null}
      {others.map((target) => <Tile key={`${opening} ${target}`} target={target} alone={targets.length === 1} />)}
      {targets.length > 1 && !swiped.length ? (
        <div className="links">
          {drawn.length > 1 ? <button title="one over the other, with a line between them" onClick={() => set({ swipe: drawn.slice(0, 2) })}>Swipe</button> : null}
          <LinkButton />
        </div>
      ) : null}
    </section>
  );
}

/** What is known of an output that is shown: its picture, what is wrong with it, whether it is out of date. */
function useOutput(target) {
  const [step] = target.split(".");
  const view = useStudio((s) => ({ preview: s.previews[target], state: s.steps[step], facts: s.doc.facts[step], isRunning: s.running > 0 }));
  const { preview, state, facts, isRunning } = view;
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
  const says = facts?.unfinished ? `${step} is not finished yet: it ${unfinishedText(facts.unfinished, step)}.` : state?.state === "failed" ? state.text : fault;
  const isStale = Boolean(says) || (isRunning && ["running", "progress", "queued"].includes(state?.state));
  return { data, says, isStale, isRunning };
}

function Body({ target, output }) {
  const { data, says, isRunning } = output;
  return (
    <>
      {data ? <Content data={data} target={target} /> : !says ? <p className="waiting">{isRunning ? "Making it" : ""}</p> : null}
      {says ? <p className="overlay message" role="status">{says}</p> : null}
    </>
  );
}

function Tile({ target, alone }) {
  const [step, portName] = target.split(".");
  const { node, file, isPinned } = useStudio((s) => ({ node: described(s, step), file: described(s, step)?.writes ? fileOf(s, step) : "", isPinned: pinsOf(s.doc.graph).includes(target) }));
  const output = useOutput(target);
  return (
    <article className={`tile${output.isStale ? " stale" : ""}`} data-target={target} data-digest={output.data?.digest ?? ""}>
      <header>
        <strong>{step}</strong>
        <nav role="tablist" aria-label={`outputs of ${step}`}>
          {node?.outputs.length > 1 ? node.outputs.map((port) => (
            <button key={port.name} role="tab" aria-selected={port.name === portName} onClick={() => show(`${step}.${port.name}`)}>{port.name.replaceAll("_", " ")}</button>
          )) : <span>{file || portOf(node?.outputs, portName)?.help?.replace(/\.$/, "") || ""}</span>}
        </nav>
        <button className="pin" aria-pressed={isPinned} title={isPinned ? "let it go" : "pin it: it stays while you look at others"} onClick={() => togglePin(target)}>{isPinned ? "Pinned" : "Pin"}</button>
        {!alone && !isPinned ? <button className="close" aria-label={`close ${target}`} onClick={() => set({ shown: "" })}>×</button> : null}
      </header>
      <div className="body"><Body target={target} output={output} /></div>
    </article>
  );
}

/** Two outputs, one over the other: left of the line the first, right of it the second. */
function Swipe({ targets }) {
  const [at, setAt] = useState(0.5);
  const outputs = [useOutput(targets[0]), useOutput(targets[1])];
  const names = targets.map((target) => { const [step, port] = target.split("."); return (port === step || port === "result" ? step : `${step} · ${port}`).replaceAll("_", " "); });
  return (
    <article className={`tile swiped${outputs.some((each) => each.isStale) ? " stale" : ""}`} data-target={targets.join(" ")} data-digest={outputs.every((each) => each.data) ? outputs.map((each) => each.data.digest).join(" ") : ""}>
      <header><strong>{names.join(" | ")}</strong><nav /><button className="pin" onClick={() => set({ swipe: null })}>Side by side</button></header>
      <div className="body" style={{ "--at": `${100 * at}%` }}>
        {targets.map((target, k) => <div key={target} className={k ? "second" : "first"}><Body target={target} output={outputs[k]} /></div>)}
        <SwipeLine at={at} setAt={setAt} names={names} />
      </div>
    </article>
  );
}

function Content({ data, target }) {
  const { head, arrays } = data;
  if (head.kind === "model") return <ModelView data={data} target={target} />;
  if (head.kind === "table") return <Table content={head.table} />;
  if (head.kind === "picture") return <Picture head={head} bytes={arrays.data} />;
  if (head.kind === "numbers") return <Numbers head={head} arrays={arrays} />;
  return <pre className="report">{head.text}</pre>;
}

/** A file that is a picture. */
function Picture({ head, bytes }) {
  const [address, setAddress] = useState("");
  useEffect(() => {
    const made = URL.createObjectURL(new Blob([new Uint8Array(bytes)], { type: head.type }));
    setAddress(made);
    return () => URL.revokeObjectURL(made);
  }, [bytes]);
  return address ? <img className="picture" src={address} alt={head.name} /> : null;
}
