// The state in the address: a link shows what its sender saw.

import { findPart } from "./model.js";

const LIGHTS = ["daylight", "zebra", "lamps"];
export const LAYERS = { panels: "Panels", edges: "Edges", beams: "Beams", nodes: "Nodes", axes: "Node axes", missing: "Missing" };

/** What is seen, as the part of an address that begins with #. */
export function addressOf({ state, view, model, modes, filter, measure }) {
  const words = new URLSearchParams();
  if (state.color !== modes[0].key) words.set("color", state.color);
  if (state.shading) words.set("light", LIGHTS[state.shading]);
  if (state.flat !== "off") words.set("panels", state.flat);
  const hidden = [...state.hidden].filter((key) => key !== "axes");
  if (hidden.length) words.set("hide", hidden.join(" "));
  if (!state.hidden.has("axes")) words.set("show", "axes");
  if (measure?.points.length) words.set("measure", measure.points.flat().map((v) => v.toFixed(6)).join(" "));
  if (state.axis) words.set("cut", `${state.axis} ${state.depth}`);
  if (state.explode) words.set("apart", state.explode);
  if (state.part >= 0) words.set("part", model.ids[state.part]);
  if (filter?.kinds) words.set("only", [...filter.kinds].join(" "));
  if (filter?.fault) words.set("fault", filter.fault);
  if (filter?.range) words.set("only", filter.range.map((v) => v.toFixed(4)).join(" "));
  if (view) {
    const places = [...view.camera.position.toArray(), ...view.controls.target.toArray()];
    words.set("eye", places.map((v) => v.toFixed(4)).join(" "));
  }
  return `#${words}`;
}

/** Show what an address says; what it does not know of is left as it is at first. */
export function showAddress(page, text) {
  const words = new URLSearchParams(text.slice(1)), { state, view } = page;
  const get = (name, known) => (known.includes(words.get(name)) ? words.get(name) : null);
  const numbers = (name) => (words.get(name) ?? "").split(" ").map(Number);
  state.color = get("color", page.modes.map((m) => m.key)) ?? page.modes[0].key;
  state.shading = Math.max(0, LIGHTS.indexOf(words.get("light")));
  state.flat = get("panels", ["off", "swipe", "on"]) ?? "off";
  state.hidden = new Set((words.get("hide") ?? "").split(" ").filter((key) => key in LAYERS));
  if (words.get("show") !== "axes") state.hidden.add("axes");
  const ends = numbers("measure");
  if (page.measure && ends.length % 3 === 0 && ends.every(Number.isFinite)) {
    page.setMeasuring(true);
    page.measure.points = [ends.slice(0, 3), ends.slice(3, 6)].filter((p) => p.length);
    page.showHint();
  }
  const [axis, depth] = (words.get("cut") ?? "").split(" ");
  state.axis = ["x", "y", "z"].includes(axis) ? axis : "";
  state.depth = within(Number(depth), 0.5);
  state.explode = within(Number(words.get("apart")), 0);
  page.filter = filterOf(page.mode, words.get("only"));
  if (words.has("fault")) page.showFault(words.get("fault"));
  const eye = numbers("eye");
  if (view && eye.length === 6 && eye.every(Number.isFinite)) {
    view.camera.position.set(...eye.slice(0, 3));
    view.controls.target.set(...eye.slice(3));
    view.controls.update();
    page.placed = true;
    view.fitted = null;
  }
  page.refresh();
  page.select(words.has("part") ? findPart(page.model, words.get("part")) : -1);
}

function filterOf(mode, text) {
  if (!text) return null;
  const range = text.split(" ").map(Number);
  if (mode.values) return range.length === 2 && range.every(Number.isFinite) ? { range } : null;
  const known = mode.kinds.map((kind) => kind.key);
  const kinds = text.split(" ").filter((key) => known.includes(key));
  return kinds.length ? { kinds: new Set(kinds) } : null;
}

const within = (value, otherwise) => (Number.isFinite(value) && value >= 0 && value <= 1 ? value : otherwise);
