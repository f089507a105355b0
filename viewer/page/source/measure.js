// Distances: two points of the model that were clicked, drawn over the picture.

import { escapeText, number } from "./text.js";
import { length, sub } from "./vectors.js";

const NEAR = 11; // pixels within which a corner is meant
const FAR = 64; // as in the shader

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

/** From the distance that the picture tells of its pixel. */
function pointAt(view, x, y) {
  const bytes = view.probe(x, y, 2);
  const distance = (((bytes[3] / 256 + bytes[2]) / 256 + bytes[1]) / 256 + bytes[0]) / 256;
  const ray = view.ray(Math.floor(x) + 0.5, Math.floor(y) + 0.5), eye = view.camera.position.toArray();
  return eye.map((e, k) => e + FAR * distance * ray[k]);
}

export class Measure {
  constructor(view, layer, scale) {
    Object.assign(this, { view, layer, scale, points: [], on: false });
  }

  /** Take a point; after two the next one begins anew. */
  take(point) {
    if (!point) return;
    this.points = this.points.length === 2 ? [point] : [...this.points, point];
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
    const { points, layer, view } = this;
    layer.toggleAttribute("hidden", !points.length);
    if (!points.length) return;
    const places = points.map((p) => view.project(p).map((v) => v.toFixed(1)));
    const dots = places.map(([x, y]) => `<circle cx="${x}" cy="${y}" r="4"/>`).join("");
    if (places.length < 2) {
      layer.innerHTML = dots;
      return;
    }
    const [[x, y], [u, v]] = places, [main, rest] = this.text();
    const middle = [(Number(x) + Number(u)) / 2, (Number(y) + Number(v)) / 2].map((w) => w.toFixed(1));
    layer.innerHTML = `<line x1="${x}" y1="${y}" x2="${u}" y2="${v}"/>${dots}`
      + `<text x="${middle[0]}" y="${middle[1]}" dy="-12">${escapeText(main)}</text>`
      + `<text class="fine" x="${middle[0]}" y="${middle[1]}" dy="18">${escapeText(rest)}</text>`;
  }
}
