// Distances: two points of the model that were clicked, drawn over the picture.

import { escapeText, number } from "./text.js";
import { length, sub } from "./vectors.js";

const NEAR = 11; // pixels within which a corner is meant
const FAR = 64; // as in the shader
const SAME = 2e-6; // of the model: addresses have six decimals

/** The point of the model that is seen at a place of the canvas, a corner if one is near. */
export function locate(view, x, y) {
  const part = view.pick(x, y);
  if (part < 0) return null;
  const corners = view.shapes.corners[part] ?? [];
  let best = NEAR, found = null;
  for (const corner of corners) {
    const [u, v] = view.project(corner), away = Math.hypot(u - x, v - y);
    if (away < best) [best, found] = [away, corner];
  }
  return found ?? pointAt(view, x, y);
}

/** What people call a point: “corner 2 of P0123”. */
export function nameOf(shapes, model, point) {
  for (let part = 0; part < shapes.corners.length; part++) {
    const k = shapes.corners[part].findIndex((corner) => length(sub(corner, point)) < SAME);
    if (k >= 0) return `corner ${k + 1} of ${model.ids[part]}`;
  }
  return "a point";
}

/** From the distance that the picture tells of its pixel. */
function pointAt(view, x, y) {
  const bytes = view.probe(x, y, 2);
  const distance = (((bytes[3] / 256 + bytes[2]) / 256 + bytes[1]) / 256 + bytes[0]) / 256;
  const ray = view.ray(Math.floor(x) + 0.5, Math.floor(y) + 0.5), eye = view.camera.position.toArray();
  return eye.map((e, k) => e + FAR * distance * ray[k]);
}

export class Measure {
  constructor(view, layer, scale) {
    Object.assign(this, { view, layer, scale, points: [], on: false, aimed: null });
  }

  /** Take a point; after two the next one begins anew. */
  take(point) {
    if (!point) return;
    this.points = this.points.length === 2 ? [point] : [...this.points, point];
    this.draw();
  }

  aim(point) {
    this.aimed = this.on ? point : null;
    this.draw();
  }

  get distance() {
    const [a, b] = this.points;
    return b ? length(sub(b, a)) * this.scale : null;
  }

  text() {
    const [a, b] = this.points, apart = sub(b, a).map((d) => Math.abs(d) * this.scale);
    return [`${number(this.distance)} mm`, `x ${number(apart[0])} · y ${number(apart[1])} · z ${number(apart[2])}`];
  }

  draw() {
    const { points, layer, view, aimed } = this;
    layer.toggleAttribute("hidden", !points.length && !aimed);
    if (layer.hasAttribute("hidden")) return;
    const places = points.map((p) => view.project(p).map((v) => v.toFixed(1)));
    const ring = aimed ? view.project(aimed).map((v) => v.toFixed(1)) : null;
    const dots = places.map(([x, y]) => `<circle cx="${x}" cy="${y}" r="4"/>`).join("")
      + (ring ? `<circle class="aim" cx="${ring[0]}" cy="${ring[1]}" r="8"/>` : "");
    if (places.length < 2) {
      layer.innerHTML = dots;
      return;
    }
    const [[x, y], [u, v]] = places, [main, rest] = this.text();
    // A plate beside the line, not over it.
    const along = [u - x, v - y], far = Math.hypot(...along) || 1, width = 7 * Math.max(main.length, rest.length) + 16;
    const side = along[0] * along[1] > 0 ? 1 : -1, reach = 14 + 22 + (Math.abs(along[1]) / far) * (width / 2 - 22);
    const across = [(side * Math.abs(along[1])) / far, -Math.abs(along[0]) / far];
    const [cx, cy] = [(Number(x) + Number(u)) / 2 + reach * across[0], (Number(y) + Number(v)) / 2 + reach * across[1]].map((w) => Math.round(w));
    layer.innerHTML = `<line x1="${x}" y1="${y}" x2="${u}" y2="${v}"/>${dots}`
      + `<rect x="${cx - width / 2}" y="${cy - 22}" width="${width}" height="44" rx="7"/>`
      + `<text x="${cx}" y="${cy}" dy="-3">${escapeText(main)}</text>`
      + `<text class="fine" x="${cx}" y="${cy}" dy="15">${escapeText(rest)}</text>`;
  }
}
