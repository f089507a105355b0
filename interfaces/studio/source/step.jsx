// Steps and sliders as they stand on the canvas.

import { Handle, Position } from "@xyflow/react";
import { memo, useRef, useState } from "react";
import { newGesture, NumberField, PortField, Range, shortNumber } from "./fields.jsx";
import { shownInputs, sources } from "./graph.js";
import { described, edit, familyOf, isShowable, pinsOf, set, show, useStudio } from "./store.js";

/** Seconds as people say them. */
export function seconds(value) {
  if (value === undefined || value === null) return "";
  if (value < 0.001) return "< 1 ms";
  if (value < 1) return `${Math.round(1000 * value)} ms`;
  return `${value.toFixed(value < 10 ? 1 : 0)} s`;
}

function Badge({ state }) {
  if (!state?.state) return null;
  const { state: now, share } = state;
  const texts = {
    queued: "waits", running: "runs", progress: share ? `${Math.round(100 * share)} %` : "runs", done: seconds(state.seconds),
    cached: "kept", failed: "error", cancelled: "stopped",
  };
  const title = now === "cached" ? `from the cache; it took ${seconds(state.seconds)}` : now;
  return <span className={`badge is-${now}`} title={title}>{texts[now] ?? now}</span>;
}

const wireText = (value) => sources(value).map((each) => each.param ?? (each.port ? `${each.step}.${each.port}` : each.step)).join(", ");

function Input({ step, port, entry, family, isTight }) {
  const isGiven = port.name in entry.inputs, value = entry.inputs[port.name];
  const wired = isGiven && sources(value).length > 0;
  const isMissing = port.required && !isGiven && !port.field;
  const name = port.name.replaceAll("_", " ");
  const connect = () => set({ dialog: { kind: "connect", end: { id: `s:${step}`, input: port.name } } });
  return (
    <div className={`row in${isMissing ? " missing" : ""}${wired ? " wired" : ""}`}>
      <Handle id={port.name} type="target" position={Position.Left} className={`port f-${family}`} title={port.help} />
      <button className="label nodrag" title={`${port.help || name}\nConnect to …`} onClick={connect} tabIndex={-1}>
        {name}{port.required && !isGiven ? <b aria-label="needed"> ·</b> : null}
      </button>
      {wired ? <span className="from" title={wireText(value)}>{value?.each !== undefined ? "each " : ""}{wireText(value)}</span> : null}
      {!wired && port.field && !isTight ? <span className="field"><PortField step={step} port={port} value={value} isGiven={isGiven} /></span> : null}
      {!wired && isGiven && !port.required ? (
        <button className="reset nodrag" aria-label={`${step}.${port.name} as by default`} title="as by default" onClick={() => edit([{ op: "take", step, port: port.name }])}>×</button>
      ) : null}
    </div>
  );
}

function Output({ step, port, family, isShown, isPinned, isShowable, writes }) {
  const target = `${step}.${port.name}`;
  return (
    <div className={`row out${isShown ? " shown" : ""}`}>
      {writes ? <span className="quiet">written on export</span> : null}
      {isShowable ? (
        <button className="eye nodrag" aria-pressed={isShown} aria-label={`show ${target}`} title={port.help || "show it beside"} onClick={() => show(target)}>
          <Eye open={isShown || isPinned} />
        </button>
      ) : null}
      <button className="label nodrag" title={`${port.help || port.name}\nConnect to …`} tabIndex={-1}
        onClick={() => set({ dialog: { kind: "connect", end: { id: `s:${step}`, output: port.name } } })}>{port.name === "result" ? "" : port.name.replaceAll("_", " ")}</button>
      <Handle id={port.name} type="source" position={Position.Right} className={`port f-${family}`} title={port.help} />
    </div>
  );
}

export const Eye = ({ open }) => (
  <svg viewBox="0 0 16 16" width="14" height="14" aria-hidden="true"><path d="M1.2 8S3.6 3.4 8 3.4 14.8 8 14.8 8 12.4 12.6 8 12.6 1.2 8 1.2 8z" fill="none" stroke="currentColor" strokeWidth="1.3" /><circle cx="8" cy="8" r={open ? 2.4 : 1.6} fill={open ? "currentColor" : "none"} stroke="currentColor" strokeWidth="1.2" /></svg>
);

export const StepNode = memo(({ data, selected }) => {
  const { name } = data;
  const view = useStudio((s) => {
    const entry = s.doc?.graph.steps[name];
    if (!entry) return null;
    return { entry, node: described(s, name), facts: s.doc.facts[name], state: s.steps[name], isOpen: s.expanded[name], isShowable: isShowable(s, name), comment: s.doc.graph.comments?.[name],
      shown: s.shown.startsWith(`${name}.`) ? s.shown : "", pins: pinsOf(s.doc.graph).filter((pin) => pin.startsWith(`${name}.`)).join(" "), catalogue: s.catalogue };
  });
  if (!view) return null;
  const { entry, node, facts, state, isOpen, comment, shown, pins } = view;
  const s = { catalogue: view.catalogue };
  const inputs = node ? shownInputs(node, entry, isOpen) : (facts?.unknown ?? []);
  const outputs = node ? node.outputs : [{ name: "result", type: -1, help: "" }];
  const hidden = node ? node.inputs.length - inputs.length : 0;
  const fault = facts?.unfinished && node ? unfinishedText(facts.unfinished, name) : state?.state === "failed" ? state.text : "";
  const family = familyOf(s, outputs[0]);
  const said = state?.messages ?? [];
  return (
    <div className={`step f-${family}${selected ? " selected" : ""}${node ? "" : " unknown"}${state?.state ? ` is-${state.state}` : ""}${facts?.unfinished ? " unfinished" : ""}`} data-step={name}>
      {comment ? <div className="comment" onDoubleClick={() => set({ dialog: { kind: "comment", step: name } })}>{comment}</div> : null}
      <header title={node?.summary}>
        <strong onDoubleClick={() => set({ dialog: { kind: "rename", id: `s:${name}` } })}>{name}</strong>
        {entry.node !== name ? <em>{entry.node.replaceAll("_", " ")}</em> : null}
        {facts?.nesting ? <span className="badge" title="for each item of a list">each</span> : null}
        <Badge state={state} />
      </header>
      {state?.state === "progress" ? <i className="progress" style={{ "--share": state.share }} /> : null}
      {!node ? <p className="fault">The node {entry.node} is not known here. It stays as it is, and is saved so.</p> : null}
      <div className="rows">
        {inputs.map((port) => <Input key={port.name} step={name} port={port} entry={entry} family={familyOf(s, port)} />)}
        {hidden > 0 || isOpen ? (
          <button className="more nodrag" aria-expanded={Boolean(isOpen)} onClick={() => set((old) => ({ expanded: { ...old.expanded, [name]: !isOpen } }))}>
            {isOpen ? "fewer" : `${hidden} more`}
          </button>
        ) : null}
        {outputs.map((port) => (
          <Output key={port.name} step={name} port={port} family={familyOf(s, port)} writes={node?.writes} isShowable={view.isShowable}
            isShown={shown === `${name}.${port.name}`} isPinned={pins.split(" ").includes(`${name}.${port.name}`)} />
        ))}
      </div>
      {fault ? <p className="fault">{fault}</p> : null}
      {said.map((text) => <p className="said" key={text}>{text}</p>)}
    </div>
  );
});

/** "step 'x' (node y) misses its input 'mesh' (Mesh)" as it reads on the step itself. */
export const unfinishedText = (text, name) => text.replace(new RegExp(`^step '${name}'( \\(node \\w+\\))? `), "").replace(/^misses/, "needs");

export const SliderNode = memo(({ data, selected }) => {
  const { name } = data;
  const entry = useStudio((s) => s.doc?.graph.params[name] ?? null);
  const gesture = useRef("");
  const [limits, setLimits] = useState(false);
  if (!entry) return null;
  const { value, min, max, choices } = entry;
  const move = (next, held) => edit([{ op: "set", param: name, value: next }], held ?? gesture.current);
  const whole = Number.isInteger(value) && (min === undefined || Number.isInteger(min)) && (max === undefined || Number.isInteger(max));
  const isNumber = typeof value === "number";
  return (
    <div className={`slider f-number${selected ? " selected" : ""}`} data-slider={name}>
      <header>
        <strong onDoubleClick={() => set({ dialog: { kind: "rename", id: `p:${name}` } })}>{name.replaceAll("_", " ")}</strong>
        {isNumber && !choices ? <NumberField label={name} value={value} min={min} max={max} whole={whole} onChange={(next) => next !== null && move(next)} /> : null}
        <button className="nodrag gear" aria-label={`range of ${name}`} aria-expanded={limits} title="range" onClick={() => setLimits(!limits)}>⋯</button>
        <Handle id="value" type="source" position={Position.Right} className="port f-number" />
      </header>
      {isNumber && !choices ? <Range label={`${name}, slider`} value={value} min={min ?? softMin(value)} max={max ?? softMax(value, min)} whole={whole} onChange={move} /> : null}
      {choices ? (
        <select className="nodrag" aria-label={name} value={JSON.stringify(value)} onChange={(event) => move(JSON.parse(event.target.value), newGesture())}>
          {choices.map((each) => <option key={String(each)} value={JSON.stringify(each)}>{String(each)}</option>)}
        </select>
      ) : null}
      {typeof value === "boolean" && !choices ? <input type="checkbox" className="nodrag switch" aria-label={name} checked={value} onChange={(event) => move(event.target.checked, newGesture())} /> : null}
      {!isNumber && typeof value !== "boolean" && !choices ? <ListText name={name} value={value} onChange={(next) => move(next, newGesture())} /> : null}
      {limits && isNumber ? <Limits name={name} entry={entry} whole={whole} /> : null}
    </div>
  );
});

/** The sliders once more, in a list beside a canvas on which they are small. */
export function Sliders() {
  const params = useStudio((s) => s.doc.graph.params);
  const [isOpen, setOpen] = useState(true);
  const gesture = useRef("");
  const entries = Object.entries(params).filter(([, { value, choices }]) => typeof value === "number" && !choices);
  if (!entries.length) return null;
  return (
    <section className="sliders nowheel nopan" aria-label="sliders">
      <button aria-expanded={isOpen} onClick={() => setOpen(!isOpen)}>Sliders</button>
      {isOpen ? entries.map(([name, { value, min, max }]) => {
        const whole = [value, min ?? 0, max ?? 0].every(Number.isInteger);
        const move = (next, held) => edit([{ op: "set", param: name, value: next }], held ?? gesture.current);
        return (
          <div key={name}>
            <span>{name.replaceAll("_", " ")}</span>
            <Range label={`${name} in the list, slider`} value={value} min={min ?? softMin(value)} max={max ?? softMax(value, min)} whole={whole} onChange={move} />
            <NumberField label={`${name} in the list`} value={value} min={min} max={max} whole={whole} onChange={(next) => next !== null && move(next)} />
          </div>
        );
      }) : null}
    </section>
  );
}

const softMin = (value) => (value < 0 ? 2 * value : 0);
const softMax = (value, min) => Math.max(2 * Math.abs(value), (min ?? 0) + 10);

function ListText({ name, value, onChange }) {
  const [text, setText] = useState(null);
  const shown = text ?? (Array.isArray(value) ? value.map(shortNumber).join(", ") : String(value));
  const end = () => {
    if (text === null) return;
    if (Array.isArray(value)) {
      const items = text.split(/[\s,;]+/).filter(Boolean).map((each) => (Number.isFinite(Number(each)) ? Number(each) : each));
      onChange(items);
    } else onChange(text);
    setText(null);
  };
  return <input className="nodrag text" aria-label={name} value={shown} onChange={(event) => setText(event.target.value)} onBlur={end}
    onKeyDown={(event) => { event.stopPropagation(); if (event.key === "Enter") event.currentTarget.blur(); }} />;
}

function Limits({ name, entry, whole }) {
  const change = (key, next) => edit([{ op: "slider", name, value: entry.value, limits: { min: entry.min, max: entry.max, [key]: next ?? undefined } }]);
  return (
    <div className="limits">
      <label>from <NumberField label={`least ${name}`} value={entry.min} whole={whole} placeholder="any" onChange={(next) => change("min", next)} /></label>
      <label>to <NumberField label={`largest ${name}`} value={entry.max} whole={whole} placeholder="any" onChange={(next) => change("max", next)} /></label>
    </div>
  );
}

export const GroupNode = memo(({ data, selected }) => (
  <div className={`group${selected ? " selected" : ""}`} style={{ width: data.width, height: data.height }}>
    <span className="grouptitle" onDoubleClick={() => set({ dialog: { kind: "rename", id: `g:${data.name}` } })}>{data.name}</span>
  </div>
));
