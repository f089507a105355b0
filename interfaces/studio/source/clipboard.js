// Steps and sliders as text: copied from one graph, pasted into another.

import { edit, now, toast } from "./store.js";
import { anchored, placesOf } from "./graph.js";

const FORMAT = "spheremesh fragment";
let last = "";

const isTyping = (event) => Boolean(event.target.closest?.("input:not([type=checkbox]):not([type=range]), textarea, [contenteditable]"));

/** What is selected, as a part of a graph file. */
export function fragmentOf(selected) {
  const s = now(), { graph } = s.doc, places = placesOf(s);
  const names = selected.filter((id) => id.startsWith("s:")).map((id) => id.slice(2));
  const sliders = selected.filter((id) => id.startsWith("p:")).map((id) => id.slice(2));
  const pick = (from, keys) => Object.fromEntries(Object.keys(from).filter((key) => keys.includes(key)).map((key) => [key, from[key]]));
  const at = (kind, keys) => Object.fromEntries(keys.map((key) => [key, places[`${kind}:${key}`]]));
  return { format: FORMAT, steps: pick(graph.steps, names), params: pick(graph.params, sliders), canvas: { steps: at("s", names), params: at("p", sliders) } };
}

export function removeSelected(selected) {
  const steps = selected.filter((id) => id.startsWith("s:")).map((id) => id.slice(2));
  const params = selected.filter((id) => id.startsWith("p:")).map((id) => id.slice(2));
  const groups = selected.filter((id) => id.startsWith("g:")).map((id) => ({ op: "group", name: id.slice(2), steps: [] }));
  const ops = [...groups, ...(steps.length || params.length ? [{ op: "remove", steps, params }] : [])];
  if (ops.length) edit(ops);
}

export function copied(event) {
  const { selected } = now();
  if (isTyping(event) || !selected.length || String(document.getSelection())) return;
  last = JSON.stringify(fragmentOf(selected), null, 1);
  event.clipboardData?.setData("text/plain", last);
  event.preventDefault();
  if (event.type === "cut") removeSelected(selected);
}

export function pasted(event, middle) {
  if (isTyping(event)) return;
  const text = event.clipboardData?.getData("text/plain") || last;
  let fragment;
  try { fragment = JSON.parse(text); } catch { return; }
  if (fragment?.format !== FORMAT && fragment?.format !== "spheremesh graph") return;
  event.preventDefault();
  paste(fragment, middle);
}

/** Put a fragment where one looks, or a little beside where it was. */
export function paste(fragment, middle) {
  const at = [...Object.values(fragment.canvas?.steps ?? {}), ...Object.values(fragment.canvas?.params ?? {})];
  if (!Object.keys(fragment.steps ?? {}).length && !Object.keys(fragment.params ?? {}).length) { toast("there is nothing to paste"); return; }
  const mean = [0, 1].map((k) => at.reduce((sum, place) => sum + place[k], 0) / (at.length || 1));
  const by = middle ? [Math.round(middle.x - mean[0] - 100), Math.round(middle.y - mean[1] - 40)] : [40, 40];
  return edit(anchored(now(), [{ op: "paste", graph: fragment, by }]));
}
