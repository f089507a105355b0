// The graph as the canvas draws it: nodes, wires, their places, and what fits what.

import dagre from "@dagrejs/dagre";
import { described, familyOf } from "./store.js";

export const STEP_WIDTH = 232, SLIDER_WIDTH = 196;
const HEAD = 38, ROW = 25;

/** The wires and sliders in what an input was given. */
export function sources(value) {
  if (Array.isArray(value)) return value.flatMap(sources);
  if (!value || typeof value !== "object") return [];
  if ("wire" in value) return [{ step: value.wire.split(".")[0], port: value.wire.split(".")[1] ?? "" }];
  if ("param" in value) return [{ param: value.param }];
  if ("each" in value) return sources(value.each);
  return [];
}

/** Inputs that are worth a row: needed, given, and the first that are given by hand. */
export function shownInputs(node, entry, isOpen) {
  if (!node) return [];
  if (isOpen) return node.inputs;
  let byHand = 0;
  return node.inputs.filter((port) => {
    if (port.required || port.name in entry.inputs) return true;
    if (node.writes) return false;
    return Boolean(port.field) && !port.graph_units && byHand++ < 2;
  });
}

export function sizeOf(s, id) {
  const name = id.slice(2);
  if (id.startsWith("p:")) return [SLIDER_WIDTH, 66];
  const node = described(s, name), entry = s.doc.graph.steps[name];
  const inputs = node ? shownInputs(node, entry, s.expanded[name]).length : Object.keys(entry.inputs).length;
  return [STEP_WIDTH, HEAD + ROW * (inputs + (node?.outputs.length ?? 1)) + 22];
}

let kept = { opening: -1, places: {} };

/** Where steps and sliders lie: as the file says, else laid out by dagre, and then they stay. */
export function placesOf(s) {
  if (kept.opening !== s.opening) kept = { opening: s.opening, places: {} };
  const { graph } = s.doc, canvas = graph.canvas ?? {}, places = {};
  const ids = [...Object.keys(graph.params).map((n) => `p:${n}`), ...Object.keys(graph.steps).map((n) => `s:${n}`)];
  for (const id of ids) {
    const place = (id.startsWith("s:") ? canvas.steps : canvas.params)?.[id.slice(2)] ?? kept.places[id];
    if (place) places[id] = place;
  }
  const missing = ids.filter((id) => !(id in places));
  if (missing.length) {
    const laid = layout(s, ids), known = Object.values(places);
    // Newcomers stand below what is there, as they lie to each other.
    const [x, y] = [0, 1].map((k) => Math.min(...missing.map((id) => laid[id][k])));
    const left = known.length ? Math.min(...known.map((p) => p[0])) : x;
    const low = known.length ? Math.max(...Object.keys(places).map((id) => places[id][1] + sizeOf(s, id)[1])) + 40 : y;
    for (const id of missing) places[id] = [laid[id][0] - x + left, laid[id][1] - y + low];
  }
  kept.places = places;
  return places;
}

/** A place for a new step near another: below what stands there already. */
export function freePlace(s, [x, y]) {
  const boxes = Object.entries(placesOf(s)).map(([id, at]) => [...at, ...sizeOf(s, id)]).sort((a, b) => a[1] - b[1]);
  const height = 150;
  for (const [left, top, w, h] of boxes) {
    if (left < x + STEP_WIDTH + 16 && x < left + w + 16 && top < y + height && y < top + h + 16) y = top + h + 26;
  }
  return [Math.round(x), Math.round(y)];
}

/** Operations that place something, with the places of all others before: what was laid out stays so. */
export function anchored(s, ops) {
  const { canvas } = s.doc.graph;
  if (canvas?.steps || canvas?.params) return ops;
  const steps = {}, params = {};
  for (const [id, at] of Object.entries(placesOf(s))) (id.startsWith("s:") ? steps : params)[id.slice(2)] = at;
  return Object.keys(steps).length || Object.keys(params).length ? [{ op: "move", steps, params }, ...ops] : ops;
}

export function layout(s, ids) {
  const graph = new dagre.graphlib.Graph({ multigraph: true });
  graph.setGraph({ rankdir: "LR", nodesep: 26, ranksep: 66, ranker: "network-simplex" });
  graph.setDefaultEdgeLabel(() => ({}));
  for (const id of ids) {
    const [width, height] = sizeOf(s, id);
    graph.setNode(id, { width, height });
  }
  for (const { source, target } of wiresOf(s)) graph.setEdge(source, target, {}, `${source} ${target}`);
  dagre.layout(graph);
  const boxes = ids.map((id) => ({ id, ...graph.node(id) }));
  return folded(boxes, wiresOf(s), canvasShape());
}

/** Height of the canvas for a width of 1. */
function canvasShape() {
  const box = document.querySelector(".canvas")?.getBoundingClientRect();
  return box?.width ? Math.min(2.5, Math.max(0.4, box.height / box.width)) : 1;
}

const MOST_FOLDED = 5, ROW_GAP = 58;

/** Columns in as many rows as fill the canvas best, like lines of text, where few wires cross the ends. */
function folded(boxes, wires, shape) {
  const columns = [];
  for (const box of [...boxes].sort((a, b) => a.x - b.x)) {
    const last = columns[columns.length - 1];
    if (last && Math.abs(last.x - box.x) < 1) last.boxes.push(box);
    else columns.push({ x: box.x, boxes: [box] });
  }
  for (const column of columns) {
    column.left = Math.min(...column.boxes.map((b) => b.x - b.width / 2));
    column.right = Math.max(...column.boxes.map((b) => b.x + b.width / 2));
  }
  const column = new Map(columns.flatMap((c, k) => c.boxes.map((b) => [b.id, k])));
  const crossing = columns.map((_, k) => wires.filter((w) => w.source.startsWith("s:") && column.get(w.source) < k && column.get(w.target) >= k).length);
  let best = null;
  for (let rows = 1; rows <= Math.min(4, columns.length); rows++) {
    const ends = cuts(columns, rows, crossing);
    if (!ends) continue;
    const lines = withSliders(ends.slice(0, -1).map((from, k) => columns.slice(from, ends[k + 1])), wires);
    const width = Math.max(...lines.map((l) => l[l.length - 1].right - l[0].left));
    const heights = lines.map((l) => span(l));
    const height = heights.reduce((a, b) => a + b[1] - b[0], 0) + ROW_GAP * (rows - 1);
    const zoom = Math.min(1 / width, shape / height) / (1 + 0.12 * (rows - 1));
    if (!best || zoom > best.zoom) best = { zoom, lines, heights };
  }
  const places = {};
  let top = 0;
  best.lines.forEach((line, k) => {
    const [low, high] = best.heights[k];
    for (const box of line.flatMap((c) => c.boxes)) places[box.id] = [Math.round(box.x - box.width / 2 - line[0].left), Math.round(box.y - box.height / 2 - low + top)];
    top += high - low + ROW_GAP;
  });
  return places;
}

/** Rows with sliders that feed later ones alone moved there, before the first column. */
function withSliders(rows, wires) {
  const row = new Map(rows.flatMap((line, k) => line.flatMap((c) => c.boxes.map((b) => [b.id, k]))));
  const fed = (box) => wires.filter((w) => w.source === box.id).map((w) => w.target);
  const goal = (box) => (box.id.startsWith("p:") && fed(box).length ? Math.min(...fed(box).map((id) => row.get(id))) : row.get(box.id));
  return rows.map((line, k) => {
    const kept = line.map((c) => ({ ...c, boxes: c.boxes.filter((b) => goal(b) === k) })).filter((c) => c.boxes.length);
    const come = rows.flatMap((other, j) => (j < k ? other.flatMap((c) => c.boxes.filter((b) => goal(b) === k)) : []));
    if (!come.length || !kept.length) return kept;
    const all = new Map(kept.flatMap((c) => c.boxes.map((b) => [b.id, b])));
    const right = kept[0].left - 44, moved = [];
    for (const box of come) {
      const target = all.get(fed(box)[0]) ?? kept[0].boxes[0];
      const y = Math.max(target.y - target.height / 2 + box.height / 2, ...moved.map((b) => b.y + b.height + 14));
      moved.push({ ...box, x: right - box.width / 2, y });
    }
    return [{ x: right - SLIDER_WIDTH / 2, left: right - SLIDER_WIDTH, right, boxes: moved }, ...kept];
  }).filter((line) => line.length);
}

const span = (line) => [Math.min(...line.flatMap((c) => c.boxes.map((b) => b.y - b.height / 2))), Math.max(...line.flatMap((c) => c.boxes.map((b) => b.y + b.height / 2)))];

/** Where rows of about the same width begin, each where few wires cross; null if there is no such place. */
function cuts(columns, rows, crossing) {
  const total = columns[columns.length - 1].right - columns[0].left, ends = [0];
  for (let row = 1; row < rows; row++) {
    const ideal = columns[0].left + (total * row) / rows;
    const places = columns.map((_, k) => k).filter((k) => k > ends[ends.length - 1] && crossing[k] <= MOST_FOLDED);
    if (!places.length) return null;
    ends.push(places.reduce((a, b) => (cost(a) <= cost(b) ? a : b)));
    function cost(k) { return Math.abs(columns[k].left - ideal) + 60 * crossing[k]; }
  }
  return [...ends, columns.length];
}

export function wiresOf(s) {
  const found = [];
  for (const [name, entry] of Object.entries(s.doc.graph.steps)) {
    for (const [port, value] of Object.entries(entry.inputs)) {
      for (const from of sources(value)) {
        const isParam = "param" in from;
        if (!isParam && !(from.step in s.doc.graph.steps)) continue;
        const outputs = isParam ? [] : described(s, from.step)?.outputs ?? [];
        const output = isParam ? "value" : from.port || outputs[0]?.name || "result";
        const source = isParam ? `p:${from.param}` : `s:${from.step}`;
        const family = isParam ? "number" : familyOf(s, outputs.find((each) => each.name === output));
        found.push({ id: `${source}.${output}>${name}.${port}`, source, sourceHandle: output, target: `s:${name}`, targetHandle: port, family,
          isEach: Boolean(value && typeof value === "object" && "each" in value) });
      }
    }
  }
  return found;
}

export const portOf = (ports, name) => ports?.find((port) => port.name === name);

/** Steps that a step needs, itself among them. */
function ancestors(s, name) {
  const found = new Set(), pending = [name];
  while (pending.length) {
    const next = pending.pop();
    if (found.has(next) || !s.doc.graph.steps[next]) continue;
    found.add(next);
    for (const value of Object.values(s.doc.graph.steps[next].inputs)) for (const each of sources(value)) if (each.step) pending.push(each.step);
  }
  return found;
}

/** An input or output as the canvas shows it: "panels · sphere mesh". */
const labelOf = (step, port) => (port === "result" ? step : `${step} · ${port.replaceAll("_", " ")}`);

/** Why an output or a slider cannot go into an input; empty if it can. */
export function whyNot(s, source, output, target, input) {
  if (!target?.startsWith("s:") || !source) return "wires end at inputs";
  const to = target.slice(2), node = described(s, to);
  if (!node) return "";
  const port = portOf(node.inputs, input);
  if (!port) return `${to} has no input ${input.replaceAll("_", " ")}`;
  if (source.startsWith("p:")) return whyNotSlider(s, source.slice(2), to, port);
  const from = source.slice(2), out = portOf(described(s, from)?.outputs, output);
  if (from === to || ancestors(s, from).has(to)) return `${from} needs ${to} already: that would be a circle`;
  if (!out || s.doc.facts[from]?.nesting) return "";
  if (s.catalogue.fits[out.type].has(port.type)) return "";
  const { types } = s.catalogue;
  return `${labelOf(from, output)} is ${types[out.type]}; ${labelOf(to, input)} takes ${types[port.type]}`;
}

function whyNotSlider(s, name, to, port) {
  const { value } = s.doc.graph.params[name];
  if (!port.field) return `${labelOf(to, port.name)} takes ${s.catalogue.types[port.type]}, no value of a slider`;
  const isNumber = typeof value === "number";
  if (isNumber && !["number", "whole", "choice", "list"].includes(port.field)) return `slider ${name} is a number; ${labelOf(to, port.name)} takes ${s.catalogue.types[port.type]}`;
  return "";
}

/** What an input is given when an output or a slider is wired to it. */
export function given(s, source, output, target, input) {
  const name = source.slice(2), to = target.slice(2);
  const value = source.startsWith("p:") ? { param: name } : { wire: `${name}.${output}` };
  const port = portOf(described(s, to)?.inputs, input);
  const type = port ? s.catalogue.types[port.type] : "";
  const isList = /^(list|tuple|Sequence)/.test(type), before = s.doc.graph.steps[to].inputs[input];
  const gives = source.startsWith("p:") ? Array.isArray(s.doc.graph.params[name].value) : (s.doc.facts[name]?.nesting ?? 0) > 0;
  if (gives && !isList) return { each: value };
  if (/^list of/.test(type) && !gives) {
    const out = portOf(described(s, name)?.outputs, output);
    if (out && !s.catalogue.types[out.type].startsWith("list")) return [...(Array.isArray(before) ? before : []), value];
  }
  return value;
}

/** All inputs that an output fits, or all outputs that fit an input, for lists. */
export function partners(s, end) {
  const found = [];
  if (end.output !== undefined) {
    for (const name of Object.keys(s.doc.graph.steps)) {
      for (const port of described(s, name)?.inputs ?? []) {
        if (!whyNot(s, end.id, end.output, `s:${name}`, port.name)) found.push({ source: end.id, output: end.output, target: `s:${name}`, input: port.name, label: `${name}.${port.name}`, type: s.catalogue.types[port.type], port });
      }
    }
    return found.sort((a, b) => Number(Boolean(b.port.required)) - Number(Boolean(a.port.required)));
  }
  for (const name of Object.keys(s.doc.graph.params)) {
    if (!whyNot(s, `p:${name}`, "value", end.id, end.input)) found.push({ source: `p:${name}`, output: "value", target: end.id, input: end.input, label: name, type: "slider" });
  }
  for (const name of Object.keys(s.doc.graph.steps)) {
    for (const port of described(s, name)?.outputs ?? []) {
      if (!whyNot(s, `s:${name}`, port.name, end.id, end.input)) found.push({ source: `s:${name}`, output: port.name, target: end.id, input: end.input, label: `${name}.${port.name}`, type: s.catalogue.types[port.type] });
    }
  }
  return found;
}

/** The steps of most roofs, in their order: what is shown before anything is searched for. */
const USUAL = ["read_mesh", "roof_mesh", "fit_spheres", "minimize_angles", "cluster_radii", "panels", "bisector_support", "beams", "write_step", "write_3dm", "write_view", "render"];
const usual = (node) => (USUAL.indexOf(node.name) + 1 || USUAL.length + 1);

/** Words that people search by and no name has. */
const otherWords = (node) => [node.writes ? "export save file" : "", node.inputs.some((port) => port.reads) ? "import open load file" : "", node.name === "cluster_radii" ? "moulds molds" : ""].join(" ");

/** Nodes for the palette: by name and words, and by what fits the wire that is held. */
export function searched(s, text, end) {
  const words = text.toLowerCase().split(/\s+/).filter(Boolean);
  const found = [];
  for (const node of Object.values(s.catalogue.nodes)) {
    const port = end ? fitting(s, node, end) : null;
    if (end && !port) continue;
    const name = node.name.replaceAll("_", " ");
    let score = 0;
    for (const word of words) {
      if (name === word || node.name === word) score += 12;
      else if (name.startsWith(word)) score += 8;
      else if (name.includes(word) || node.name.includes(word)) score += 5;
      else if (node.category.includes(word)) score += 3;
      else if (`${node.summary.toLowerCase()} ${otherWords(node)}`.includes(word)) score += 2;
      else { score = -1; break; }
    }
    if (score >= 0) found.push({ node, port, score: score + (port?.required ? 1 : 0) });
  }
  return found.sort((a, b) => b.score - a.score || usual(a.node) - usual(b.node) || a.node.category.localeCompare(b.node.category) || a.node.name.localeCompare(b.node.name));
}

function fitting(s, node, end) {
  if (end.output !== undefined) {
    if (end.id.startsWith("p:")) return node.inputs.find((port) => port.field === "number" || port.field === "whole");
    const out = portOf(described(s, end.id.slice(2))?.outputs, end.output);
    if (!out) return null;
    const ports = node.inputs.filter((port) => s.catalogue.fits[out.type].has(port.type));
    return ports.find((port) => port.required) ?? ports.find((port) => !port.field) ?? null;
  }
  const port = portOf(described(s, end.id.slice(2))?.inputs, end.input);
  return port ? node.outputs.find((out) => s.catalogue.fits[out.type].has(port.type)) : null;
}
