// Lists to choose from: nodes to add, and ends to connect to.

import { useEffect, useMemo, useRef, useState } from "react";
import { canvasActions } from "./canvas.jsx";
import { anchored, freePlace, given, partners, placesOf, searched, sources } from "./graph.js";
import { bestOutput, described, edit, familyOf, now, set, show, useStudio } from "./store.js";

/** A list under a search field: arrows choose, Enter takes. */
export function Chooser({ label, placeholder, items, text, setText, onTake, children, foot }) {
  const [at, setAt] = useState(0);
  const list = useRef(null);
  useEffect(() => setAt(0), [text]);
  useEffect(() => { list.current?.querySelector("[aria-selected=true]")?.scrollIntoView({ block: "nearest" }); }, [at]);
  return (
    <div className="chooser">
      <input autoFocus role="combobox" aria-expanded="true" aria-controls="choices" aria-label={label} placeholder={placeholder} value={text} spellCheck={false}
        aria-activedescendant={items[at] ? `choice-${at}` : undefined}
        onChange={(event) => setText(event.target.value)}
        onKeyDown={(event) => {
          const turn = { ArrowDown: 1, ArrowUp: -1, PageDown: 8, PageUp: -8 }[event.key];
          if (turn) { event.preventDefault(); setAt(Math.max(0, Math.min(items.length - 1, at + turn))); }
          if (event.key === "Enter" && items[at]) { event.preventDefault(); onTake(items[at]); }
        }} />
      <ul id="choices" role="listbox" aria-label={label} ref={list}>
        {items.map((item, k) => (
          <li key={item.key} id={`choice-${k}`} role="option" aria-selected={k === at} onPointerMove={() => setAt(k)} onClick={() => onTake(item)}>{children(item)}</li>
        ))}
        {!items.length ? <li className="none">nothing fits</li> : null}
      </ul>
      {foot}
    </div>
  );
}

/** The nodes there are; with a wire in hand only those that it fits, and they are wired. */
export function Palette({ at, end }) {
  const [text, setText] = useState("");
  const catalogue = useStudio((s) => s.catalogue);
  const items = useMemo(() => searched(now(), text, end).slice(0, 120).map((each) => ({ key: each.node.name, ...each })), [text, end, catalogue]);
  const add = ({ node, port }) => {
    const s = now();
    let name = node.name, number = 2;
    while (name in s.doc.graph.steps) name = `${node.name}_${number++}`;
    const place = freePlace(s, [Math.round(at.x - (end?.input !== undefined ? 240 : 0)), Math.round(at.y - 20)]);
    const ops = [{ op: "add", node: node.name, name, at: place }];
    if (end?.output !== undefined) {
      const value = end.id.startsWith("p:") ? { param: end.id.slice(2) } : { wire: `${end.id.slice(2)}.${end.output}` };
      const isList = /^list of/.test(s.catalogue.types[port.type]);
      const nests = !end.id.startsWith("p:") && s.doc.facts[end.id.slice(2)]?.nesting;
      ops.push({ op: "give", step: name, port: port.name, value: nests ? { each: value } : isList ? [value] : value });
    } else if (end) {
      ops.push({ op: "give", step: end.id.slice(2), port: end.input, value: { wire: `${name}.${port.name}` } });
    }
    set({ dialog: null });
    edit(anchored(s, ops)).then((ok) => {
      if (!ok) return;
      focusStep(name);
      const output = now().doc.facts[name]?.unfinished ? "" : bestOutput(now(), name);
      if (output) show(output);
    });
  };
  const slider = () => {
    set({ dialog: null });
    let name = "slider", number = 2;
    while (name in now().doc.graph.params) name = `slider_${number++}`;
    edit(anchored(now(), [{ op: "slider", name, value: 1, limits: { min: 0, max: 10 }, at: [Math.round(at.x), Math.round(at.y)] }]));
  };
  const type = end && (end.output !== undefined ? (end.id.startsWith("p:") ? "a slider" : `${end.id.slice(2)}.${end.output}`) : `${end.id.slice(2)}.${end.input}`);
  return (
    <>
      <h2>{end ? <>Steps that fit <code>{type}</code></> : "Add a step"}</h2>
      <Chooser label="Search steps" placeholder="Search: panels, moulds, beams …" items={items} text={text} setText={setText} onTake={add}
        foot={end ? null : <button className="wide" onClick={slider}>A slider</button>}>
        {({ node, port }) => (
          <>
            <i className={`dot f-${familyOf(now(), node.outputs[0])}`} />
            <b>{node.name.replaceAll("_", " ")}</b><em>{node.category}</em>
            <span>{end && port ? `${end.output !== undefined ? "into" : "from"} ${port.name.replaceAll("_", " ")}` : node.summary}</span>
          </>
        )}
      </Chooser>
    </>
  );
}

/** The focus on a step, as soon as it stands on the canvas, and the canvas where it is seen. */
function focusStep(name, tries = 60) {
  const node = document.querySelector(`.react-flow__node[data-id="s:${name}"]`);
  if (node && getComputedStyle(node).visibility === "visible") {
    node.focus({ preventScroll: true });
    canvasActions.current?.reveal(node);
  } else if (tries) requestAnimationFrame(() => focusStep(name, tries - 1));
}

/** "Connect to …": every end that fits, for keys and for fingers; what is wired can be cut. */
export function Connect({ end }) {
  const [text, setText] = useState("");
  const [chosen, setChosen] = useState(end);
  const doc = useStudio((s) => s.doc);
  const s = now(), name = end.id.slice(2);
  if (chosen.input === undefined && chosen.output === undefined) return <Ends id={end.id} setChosen={setChosen} />;
  const wires = chosen.input === undefined ? [] : sources(doc.graph.steps[name]?.inputs[chosen.input]);
  const value = chosen.input === undefined ? undefined : doc.graph.steps[name]?.inputs[chosen.input];
  const matches = (item) => text.toLowerCase().split(/\s+/).every((word) => `${item.label} ${item.type}`.toLowerCase().includes(word));
  const items = partners(s, chosen).filter(matches).map((each) => ({ key: `${each.label} ${each.source}`, ...each }));
  if (wires.length && !text) {
    items.unshift({ key: "cut", label: "Cut the wire", type: wires.map((w) => w.param ?? w.step).join(", "), cut: true });
    const isEach = value?.each !== undefined;
    items.push({ key: "each", label: isEach ? "Take the list as one value" : "Once for each item of the list", type: "each", each: isEach ? value.each : { each: value } });
  }
  const port = chosen.input !== undefined ? described(s, name)?.inputs.find((p) => p.name === chosen.input) : null;
  if (port?.field && !wires.length && !text && ["number", "whole"].includes(port.field)) items.push({ key: "slider", label: "A new slider", type: "for this input", slider: port });
  const take = (item) => {
    set({ dialog: null });
    if (item.cut) edit([{ op: "take", step: name, port: chosen.input }]);
    else if (item.each) edit([{ op: "give", step: name, port: chosen.input, value: item.each }]);
    else if (item.slider) newSlider(name, item.slider);
    else edit([{ op: "give", step: item.target.slice(2), port: item.input, value: given(s, item.source, item.output, item.target, item.input) }]);
  };
  return (
    <>
      <h2>Connect <code>{name}{chosen.output !== undefined || chosen.input !== undefined ? `.${chosen.output ?? chosen.input}` : ""}</code> {chosen.output !== undefined ? "to …" : "from …"}</h2>
      <Chooser label="Connect to" placeholder="Search by name or type" items={items} text={text} setText={setText} onTake={take}>
        {(item) => <><b>{item.label}</b><em>{item.type}</em></>}
      </Chooser>
    </>
  );
}

function newSlider(step, port) {
  const s = now(), entry = s.doc.graph.steps[step];
  let name = port.name, number = 2;
  while (name in s.doc.graph.params) name = `${port.name}_${number++}`;
  const present = entry.inputs[port.name] ?? port.default ?? port.min ?? 1, value = typeof present === "number" ? present : port.min ?? 1;
  const min = port.min ?? (value < 0 ? 2 * value : 0), max = port.max ?? Math.max(2 * Math.abs(value), min + (port.field === "whole" ? 20 : 1));
  const [x, y] = placesOf(s)[`s:${step}`];
  edit(anchored(s, [{ op: "slider", name, value, limits: { min, max }, feeds: [[step, port.name]], at: [x - 230, y] }]));
}

/** Which end of a step is meant. */
function Ends({ id, setChosen }) {
  const [text, setText] = useState("");
  const s = now(), name = id.slice(2), node = id.startsWith("s:") ? described(s, name) : null;
  const outputs = id.startsWith("p:") ? [{ name: "value" }] : node?.outputs ?? [];
  const type = (port) => (port.type >= 0 ? s.catalogue.types[port.type] : "");
  const items = [
    ...outputs.map((port) => ({ key: `out ${port.name}`, label: `${port.name} →`, type: type(port), end: { id, output: port.name } })),
    ...(node?.inputs ?? []).map((port) => ({ key: `in ${port.name}`, label: `→ ${port.name}`, type: type(port), end: { id, input: port.name } })),
  ].filter((item) => item.label.toLowerCase().includes(text.toLowerCase()));
  return (
    <>
      <h2>Connect <code>{name}</code></h2>
      <Chooser label="Which end" placeholder="Which output or input?" items={items} text={text} setText={setText} onTake={(item) => setChosen(item.end)}>
        {(item) => <><b>{item.label.replaceAll("_", " ")}</b><em>{item.type}</em></>}
      </Chooser>
    </>
  );
}
