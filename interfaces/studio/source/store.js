// What the page knows, and how it changes: the graph is the server's, the rest is here.

import { useRef, useSyncExternalStore } from "react";
import { get, listen, post, Refusal } from "./api.js";

let state = {
  ready: false, online: true, fatal: "", catalogue: null, doc: null, steps: {}, previews: {}, running: 0,
  runText: "", lastRun: null, shown: "", selected: [], expanded: {}, dialog: null, toast: null, refusal: "",
  fit: 0, opening: 0, linked: true, swipe: null, templates: [], versions: [], folder: "", place: "", exported: null,
};
const listeners = new Set();

export const now = () => state;
export function set(changes) {
  state = { ...state, ...(typeof changes === "function" ? changes(state) : changes) };
  for (const each of listeners) each();
}
const subscribe = (listener) => { listeners.add(listener); return () => listeners.delete(listener); };

function same(a, b) {
  if (Object.is(a, b)) return true;
  if (!a || !b || typeof a !== "object" || typeof b !== "object" || a.constructor !== b.constructor) return false;
  if (!Array.isArray(a) && a.constructor !== Object) return false;
  const keys = Object.keys(a);
  return keys.length === Object.keys(b).length && keys.every((key) => Object.is(a[key], b[key]));
}

/** A part of what is known; who uses it is drawn anew only when that part changes. */
export function useStudio(select) {
  const kept = useRef();
  return useSyncExternalStore(subscribe, () => {
    const value = select(state);
    if (!same(kept.current, value)) kept.current = value;
    return kept.current;
  });
}

/** The new value, with whatever is equal taken from the old one. */
export function shared(before, after) {
  if (before === after || !before || !after || typeof before !== "object" || typeof after !== "object") return after;
  if (Array.isArray(before) !== Array.isArray(after)) return after;
  const keys = Object.keys(after);
  let equal = keys.length === Object.keys(before).length;
  const found = Array.isArray(after) ? [] : {};
  for (const key of keys) {
    found[key] = shared(before[key], after[key]);
    if (!Object.is(found[key], before[key])) equal = false;
  }
  return equal ? before : found;
}

export function toast(text, kind = "error") {
  set({ toast: { text, kind, id: Math.random() } });
}
export const guarded = (promise) => promise.catch((error) => toast(error.message));

// ---- the graph -------------------------------------------------------------------------------

function take(content) {
  const { rev, undo, redo, file, is_new, fault, graph, facts } = content;
  if (state.doc && rev < state.doc.rev) return;
  const doc = shared(state.doc, { rev, undo, redo, file, is_new, fault, graph, facts: facts ?? state.doc?.facts ?? {} });
  const names = new Set(Object.keys(graph.steps));
  const steps = Object.fromEntries(Object.entries(state.steps).filter(([name]) => names.has(name)));
  const shown = names.has(state.shown.split(".")[0]) ? state.shown : "";
  set({ doc, steps, shown });
}

export async function load() {
  const [catalogue, content] = await Promise.all([state.catalogue ?? get("nodes"), get("state")]);
  if (!state.catalogue) catalogue.fits = catalogue.fits.map((each) => new Set(each));
  state = { ...state, catalogue };
  opened(content);
  set({ ready: true });
}

function opened(content) {
  // Nobody is told of what is half open.
  state = { ...state, doc: null, opening: state.opening + 1, steps: content.runs.steps, previews: content.runs.previews, running: content.runs.running,
    templates: content.templates, versions: content.versions, folder: content.folder, place: content.place, swipe: null, selected: [], shown: "", expanded: {} };
  take(content);
  const pins = pinsOf(content.graph);
  set({ shown: pins.length ? "" : firstShown(content.graph), fit: state.fit + 1 });
  runSoon();
}

const pending = [];
let isSending = false;

/** Change the graph: operations are sent one after the other, those of a drag only the last. */
export function edit(ops, gesture = "") {
  return new Promise((done) => {
    const last = pending[pending.length - 1];
    const isSame = last && gesture && last.gesture === gesture && last.ops.length === 1 && ops.length === 1
      && ["op", "step", "port", "param", "name"].every((key) => last.ops[0][key] === ops[0][key]);
    if (isSame) { last.ops = ops; last.done.push(done); } else pending.push({ ops, gesture, done: [done] });
    if (!isSending) send();
  });
}

async function send() {
  isSending = true;
  while (pending.length) {
    const { ops, gesture, done } = pending.shift();
    let ok = true;
    for (let attempt = 0; ; attempt++) {
      try {
        take(await post("edit", { rev: state.doc.rev, ops, gesture }));
        break;
      } catch (error) {
        if (error instanceof Refusal && error.status === 409 && attempt < 3) { take(error.content); continue; }
        ok = false;
        toast(error.message);
        set({ doc: { ...state.doc } });
        break;
      }
    }
    for (const each of done) each(ok);
    if (ok) runSoon();
  }
  isSending = false;
}

export const undo = () => guarded(post("undo").then((content) => { take(content); runSoon(); }));
export const redo = () => guarded(post("redo").then((content) => { take(content); runSoon(); }));
export const open = (what) => guarded(post("open", what).then(opened));
export const saveAs = (file) => guarded(post("save", { file }).then((content) => { take(content); set({ versions: content.versions }); }));
export const revert = (version) => guarded(post("revert", { version }).then((content) => { take(content); runSoon(); }));

// ---- what is shown, and runs of it -----------------------------------------------------------

export const pinsOf = (graph) => (graph.canvas?.pins ?? []).filter((pin) => pin.split(".")[0] in graph.steps);

const RANK = { panels: 0, beams: 1, spheres: 2, mesh: 3, array: 4, report: 5 };

/** Ports of a step: of its node, of a graph that is a node, or as far as the graph uses them. */
export function described(s, name) {
  const entry = s.doc.graph.steps[name], facts = s.doc.facts[name];
  return facts?.node ?? s.catalogue.nodes[entry?.node] ?? null;
}
export const familyOf = (s, port) => (port && port.type >= 0 ? s.catalogue.families[port.type] : "other");

/** The file that a step writes. */
export function fileOf(s, name) {
  const given = s.doc.graph.steps[name]?.inputs.path;
  return typeof given === "string" ? given : described(s, name)?.inputs.find((port) => port.writes)?.default ?? "";
}

/** Whether what a step makes can be looked at here: of files those that are pictures or tables. */
export const isShowable = (s, name) => !described(s, name)?.writes || /\.(png|svg|csv)$/i.test(fileOf(s, name));

/** The output that one wants to see first. */
export function bestOutput(s, name) {
  const node = described(s, name);
  if (!node || !isShowable(s, name)) return "";
  const rank = (port) => RANK[familyOf(s, port)] ?? 9;
  const ports = [...node.outputs].sort((a, b) => rank(a) - rank(b));
  return ports.length ? `${name}.${ports[0].name}` : "";
}

function firstShown(graph) {
  const names = Object.keys(graph.steps).reverse();
  const outputs = names.filter((name) => !described(state, name)?.writes).map((name) => bestOutput(state, name)).filter(Boolean);
  const rank = (output) => RANK[familyOf(state, described(state, output.split(".")[0]).outputs.find((p) => p.name === output.split(".")[1]))] ?? 9;
  return outputs.sort((a, b) => rank(a) - rank(b))[0] ?? "";
}

export function targetsOf(s) {
  if (!s.doc) return [];
  const wanted = [...new Set([...pinsOf(s.doc.graph), s.shown].filter(Boolean))];
  return wanted.filter((output) => {
    const [step, port] = output.split(".");
    return !s.doc.facts[step]?.unfinished && described(s, step)?.outputs.some((each) => each.name === port);
  });
}

export function show(output) {
  set({ shown: output });
  runSoon();
}

let timer = 0, lastAsked = "", ended = 0;
export function runSoon(force = false) {
  if (force) lastAsked = "";
  clearTimeout(timer);
  timer = setTimeout(run, 15);
}

async function run() {
  const targets = targetsOf(state);
  if (!targets.length || !state.doc) return;
  const key = JSON.stringify([state.doc.rev, targets]);
  if (key === lastAsked) return;
  lastAsked = key;
  try {
    const { run: number } = await post("run", { targets });
    // Its end may have been heard before this answer.
    if (number > Math.max(state.running, ended)) set({ running: number });
  } catch (error) {
    toast(error.message);
  }
}

export const cancel = () => guarded(post("cancel", { run: state.running }));
export const exportFiles = (folder, overwrite) => {
  set({ exported: { state: "running", text: "" } });
  return guarded(post("export", { folder, overwrite }).then(({ run: number }) => set({ exported: { state: "running", run: number, text: "" } })));
};

let heard = [];
function hear(event) {
  heard.push(event);
  if (heard.length === 1) requestAnimationFrame(takeHeard);
  if (document.hidden) takeHeard();
}

function takeHeard() {
  const events = heard;
  heard = [];
  if (!events.length) return;
  let { steps, previews, running, runText, lastRun, exported } = state;
  let again = false;
  for (const event of events) {
    if (event.type === "step") steps = { ...steps, [event.step]: { ...steps[event.step], ...event } };
    else if (event.type === "fault") steps = { ...steps, [event.step]: { ...steps[event.step], state: "failed", text: event.text } };
    else if (event.type === "messages") {
      steps = { ...steps };
      for (const [name, messages] of Object.entries(event.messages)) steps[name] = { ...steps[name], messages };
    } else if (event.type === "preview") previews = { ...previews, [event.target]: event };
    else if (event.type === "run") {
      if (event.state === "running") { running = Math.max(running, event.run); runText = "running"; }
      else ended = Math.max(ended, event.run);
      if (event.state !== "running" && event.run >= running) { running = 0; runText = event.state === "failed" ? event.text : ""; lastRun = event; }
      if (exported && event.run === exported.run && event.state !== "running") exported = { state: event.state, text: event.text, run: event.run };
    } else if (event.type === "doc" || event.type === "hello") {
      if (state.doc && event.rev > state.doc.rev) again = true;
    } else if (event.type === "opened") again = "opened";
  }
  set({ steps, previews, running, runText, lastRun, exported });
  if (again && !isSending) refresh(again === "opened");
}

let refreshing = 0;
function refresh(isOpened) {
  clearTimeout(refreshing);
  refreshing = setTimeout(async () => {
    const content = await get("state").catch(() => null);
    if (!content || (state.doc && content.rev <= state.doc.rev)) return;
    if (isOpened) opened(content);
    else { take(content); runSoon(); }
  }, 30);
}

export function begin() {
  load().catch((error) => set({ fatal: error.message }));
  listen(hear, (online, fatal) => set(fatal ? { online, fatal } : { online }));
}
