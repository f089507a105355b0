// Fields of inputs: sliders, switches, choices, texts and files, made of the facts of ports.

import { useEffect, useRef, useState } from "react";
import { get } from "./api.js";
import { edit, toast, useStudio } from "./store.js";

let gestures = 0;
export const newGesture = () => `${Date.now().toString(36)} ${++gestures}`;

/** A number as one types it. */
export const shortNumber = (value) => (typeof value === "number" ? String(Number(value.toPrecision(7))) : value === null || value === undefined ? "" : String(value));

export const plainText = (value) => (typeof value === "string" ? value : value === null || value === undefined ? "" : JSON.stringify(value));

/** A number that is typed or stepped: what is no number stays until it is one. */
export function NumberField({ id, value, whole, min, max, unit, label, placeholder, onChange, onEnd }) {
  const [text, setText] = useState(null);
  const shown = text ?? shortNumber(value);
  const step = whole ? 1 : stepOf(value, min, max);
  const change = (written) => {
    setText(written);
    if (written.trim() === "") return;
    const number = Number(written);
    if (Number.isFinite(number) && (!whole || Number.isInteger(number))) onChange(number);
  };
  const end = () => {
    if (text !== null && text.trim() === "" && placeholder) onChange(null);
    setText(null);
    onEnd?.();
  };
  return (
    <span className="numberfield">
      <input id={id} className="nodrag" inputMode="decimal" aria-label={label} value={shown} placeholder={placeholder} spellCheck={false}
        onChange={(event) => change(event.target.value)} onBlur={end} onFocus={(event) => event.target.select()}
        onKeyDown={(event) => {
          event.stopPropagation();
          if (event.key === "Enter" || event.key === "Escape") event.currentTarget.blur();
          const turn = { ArrowUp: 1, ArrowDown: -1 }[event.key];
          if (!turn) return;
          event.preventDefault();
          const from = typeof value === "number" ? value : 0, by = turn * step * (event.shiftKey ? 10 : 1);
          const next = Math.min(max ?? Infinity, Math.max(min ?? -Infinity, Number((from + by).toPrecision(10))));
          setText(null);
          onChange(next);
        }} />
      {unit ? <i>{unit === "deg" ? "°" : unit}</i> : null}
    </span>
  );
}

export function stepOf(value, min, max) {
  const span = min !== undefined && max !== undefined ? max - min : Math.abs(value) || 1;
  return 10 ** Math.floor(Math.log10(span / 20 || 0.01));
}

/** A slider: live while it is dragged, one step to undo in the end. */
export function Range({ value, min, max, whole, label, onChange }) {
  const gesture = useRef("");
  const [held, setHeld] = useState(null);
  const step = whole ? 1 : stepOf(value, min, max) / 10;
  const shown = held ?? value ?? min;
  useEffect(() => { if (held !== null && held === value) setHeld(null); }, [held, value]);
  const share = max > min ? Math.min(1, Math.max(0, (shown - min) / (max - min))) : 0;
  return (
    <input type="range" className="nodrag nopan range" aria-label={label} min={min} max={max} step={step} value={shown}
      style={{ "--share": share }}
      onPointerDown={() => { gesture.current = newGesture(); }}
      onKeyDown={(event) => {
        if (!/^(Arrow|Page|Home|End)/.test(event.key)) return;
        event.stopPropagation();
        if (!event.repeat) gesture.current = newGesture();
      }}
      onChange={(event) => {
        const number = Number(event.target.value);
        setHeld(number);
        onChange(number, gesture.current);
      }}
      onPointerUp={() => { gesture.current = ""; setHeld(null); }} />
  );
}

/** The field of an input of a step. */
export function PortField({ step, port, value, isGiven }) {
  const label = `${step}.${port.name}`, present = isGiven ? value : port.default;
  const gesture = useRef("");
  const give = (next, held = gesture.current) => edit(
    [next === null && !isNullable(port) ? { op: "take", step, port: port.name } : { op: "give", step, port: port.name, value: next }], held,
  );
  if (port.field === "switch") {
    return <input type="checkbox" className="nodrag switch" aria-label={label} checked={Boolean(present)} onChange={(event) => give(event.target.checked)} />;
  }
  if (port.field === "choice") {
    return (
      <select className="nodrag" aria-label={label} value={JSON.stringify(present ?? null)} onKeyDown={(event) => event.stopPropagation()}
        onChange={(event) => give(JSON.parse(event.target.value))}>
        {present === undefined || present === null ? <option value="null">{port.graph_units ? "as the graph" : "–"}</option> : null}
        {port.choices.map((each) => <option key={String(each)} value={JSON.stringify(each)}>{String(each) || "none"}</option>)}
      </select>
    );
  }
  if (port.field === "number" || port.field === "whole") {
    const isBounded = port.min !== undefined && port.max !== undefined && port.max - port.min <= 1000;
    return (
      <>
        {isBounded && typeof present === "number" ? <Range label={`${label}, slider`} value={present} min={port.min} max={port.max} whole={port.field === "whole"} onChange={give} /> : null}
        <NumberField label={label} value={present} whole={port.field === "whole"} min={port.min} max={port.max} unit={port.unit}
          placeholder={present === null || present === undefined ? (port.required ? "needed" : "auto") : ""} onChange={(next) => give(next)} onEnd={() => { gesture.current = ""; }} />
      </>
    );
  }
  if (port.field === "file") return <FileField label={label} port={port} value={plainText(present)} onChange={give} />;
  if (port.field === "list") return <TextField label={label} value={plainText(present)} onChange={(text) => giveList(text, give)} />;
  return <TextField label={label} value={plainText(present)} onChange={give} />;
}

const isNullable = (port) => port.default === null;

function giveList(text, give) {
  if (!text.trim()) { give(null); return; }
  try {
    give(JSON.parse(/^[[{"]/.test(text.trim()) ? text : `[${text}]`));
  } catch {
    toast(`${text} is no list: write numbers such as 1, 2, 3`);
  }
}

/** A text that counts when one leaves it. */
export function TextField({ label, value, list, onChange, onFocus, placeholder, autoFocus }) {
  const [text, setText] = useState(null);
  const end = () => {
    if (text !== null && text !== value) onChange(text);
    setText(null);
  };
  return (
    <input className="nodrag text" aria-label={label} value={text ?? value} list={list} spellCheck={false} placeholder={placeholder} autoFocus={autoFocus}
      onFocus={onFocus} onChange={(event) => setText(event.target.value)} onBlur={end}
      onKeyDown={(event) => {
        event.stopPropagation();
        if (event.key === "Enter") event.currentTarget.blur();
        if (event.key === "Escape") { setText(null); event.currentTarget.blur(); }
      }} />
  );
}

function FileField({ label, port, value, onChange }) {
  const [files, setFiles] = useState([]);
  const folder = useStudio((s) => s.folder), id = `files-${label}`;
  const ask = () => { if (port.reads) get("files").then(setFiles).catch(() => {}); };
  return (
    <>
      <TextField label={label} value={value} list={id} onFocus={ask} onChange={onChange} placeholder={port.reads ? `file in ${folder}` : "file name"} />
      {port.reads ? <datalist id={id}>{files.map((each) => <option key={each} value={each} />)}</datalist> : null}
    </>
  );
}
