// What colours mean: of every part a colour, and the legend that says so.

import { escapeText, number } from "./text.js";

const PLAIN = [226, 226, 222], BEAM = [150, 122, 96], NODE = [98, 102, 110];
const GOOD = [214, 219, 222], NOTE = [232, 164, 38], ERROR = [206, 58, 44], MISSING = [122, 16, 30];
const UNLABELLED = [178, 182, 187];

/** The path through OKLab of `kernel/parts/colors.py`: dark blue, green, pale sand. */
export function pathColor(share) {
  const hue = 4.45 + share * (1.1 - 4.45), light = 0.5 + share * (0.87 - 0.5);
  const a = 0.11 * Math.cos(hue), b = 0.11 * Math.sin(hue);
  const l = (light + 0.3963377774 * a + 0.2158037573 * b) ** 3;
  const m = (light - 0.1055613458 * a - 0.0638541728 * b) ** 3;
  const s = (light - 0.0894841775 * a - 1.291485548 * b) ** 3;
  const gamma = (x) => {
    const v = Math.min(1, Math.max(0, x));
    return Math.round(255 * (v <= 0.0031308 ? 12.92 * v : 1.055 * v ** (1 / 2.4) - 0.055));
  };
  return [
    gamma(4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s),
    gamma(-1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s),
    gamma(-0.0041960863 * l - 0.7034186147 * m + 1.707614701 * s),
  ];
}

const css = (c) => `rgb(${c.join(",")})`;

/** The modes that a model has something to show in. */
export function colorModes(model) {
  const { panels, moulds } = model;
  const modes = [];
  if (moulds.length) modes.push({ key: "mould", name: "Mould", kinds: mouldKinds(model) });
  const measures = [
    ["radius", "Radius", panels.radius_mm, "mm", true],
    ["angle", "Angle at edges", panels.angle_deg, "°", false],
    ["tilt", "Tilt of walls", panels.tilt_deg, "°", false],
    ["area", "Area", panels.area_m2, "m²", false],
    ["planarity", "Corners off their plane", panels.planarity_mm, "mm", false],
  ];
  for (const [key, name, values, unit, logarithmic] of measures) {
    if (values.some((v) => v !== null)) modes.push({ key, name, values, unit, logarithmic });
  }
  modes.push({ key: "finding", name: "Findings", kinds: findingKinds(model) });
  modes.push({ key: "none", name: "One colour", kinds: [] });
  return modes;
}

function mouldKinds({ panels, moulds }) {
  const count = Math.max(...moulds.map((m) => m.number));
  const kinds = moulds.map((m) => ({
    color: count > 1 ? pathColor((m.number - 1) / (count - 1)) : pathColor(0), name: `${m.number}`,
    note: m.radius_mm === null ? "plane" : `${number(m.radius_mm)} mm`,
    has: (i) => panels.mould[i] === m.number, key: `${m.number}`,
  }));
  if (panels.mould.includes(null)) {
    kinds.push({ color: UNLABELLED, name: "none", note: "", has: (i) => panels.mould[i] === null, key: "none" });
  }
  return kinds;
}

function findingKinds({ worst, missing }) {
  const rejected = { key: "rejected", name: "missing", note: "cannot be made", color: MISSING, has: (i) => worst[i] === 3, all: true };
  return [
    ...(missing.length ? [rejected] : []),
    { key: "error", name: "errors", note: "", color: ERROR, has: (i) => worst[i] === 2, all: true },
    { key: "note", name: "notes", note: "", color: NOTE, has: (i) => worst[i] === 1, all: true },
    { key: "good", name: "nothing found", note: "", color: GOOD, has: (i) => worst[i] === 0, all: true },
  ];
}

/** The share of each value along the scale of a mode, from 0 to 1; null without value. */
export function scaleOf(mode) {
  const known = mode.values.filter((v) => v !== null);
  const map = (v) => (mode.logarithmic ? Math.log(v) : v);
  const sorted = known.map(map).sort((a, b) => a - b);
  const low = sorted[0], high = sorted[sorted.length - 1];
  // A few extremes do not take all colours for themselves.
  const from = sorted[Math.floor(0.01 * (sorted.length - 1))], to = sorted[Math.ceil(0.99 * (sorted.length - 1))];
  const spread = to - from > 1e-9 * Math.max(Math.abs(to), 1e-12) ? to - from : 0;
  const share = (v) => (v === null ? null : spread ? Math.min(1, Math.max(0, (map(v) - from) / spread)) : 0.5);
  const back = (s) => {
    const value = s <= 0 ? low : s >= 1 ? high : from + s * spread;
    return mode.logarithmic ? Math.exp(value) : value;
  };
  return { share, back };
}

/** Colours of all parts, four bytes each: dim where the filter leaves a part out. */
export function partColors(mode, filter, model, size) {
  const colors = new Uint8Array(size).fill(255);
  const scale = mode.values ? scaleOf(mode) : null;
  const panels = model.panels.id.length, beams = model.beams.id.length;
  for (let i = 0; i < model.count; i++) {
    let color = i < panels ? PLAIN : i < panels + beams ? BEAM : NODE;
    if (scale && i < panels) {
      const share = scale.share(mode.values[i]);
      color = share === null ? UNLABELLED : pathColor(share);
    }
    const kind = mode.kinds?.find((each) => (i < panels || each.all) && each.has(i));
    if (kind && (i < panels || kind.key !== "good")) color = kind.color;
    for (let k = 0; k < 3; k++) colors[4 * i + k] = color[k];
    colors[4 * i + 3] = passes(mode, filter, i, panels, scale) ? 255 : 0;
  }
  return colors;
}

/** Whether a part is among those that are chosen in the legend. */
export function passes(mode, filter, i, panels, scale = mode.values ? scaleOf(mode) : null) {
  if (!filter) return true;
  if (filter.parts) return filter.parts.has(i);
  if (filter.kinds) return (mode.kinds ?? []).some((k) => filter.kinds.has(k.key) && (i < panels || k.all) && k.has(i));
  if (i >= panels) return false;
  const share = scale.share(mode.values[i]);
  return share !== null && share >= filter.range[0] && share <= filter.range[1];
}

/** The legend as HTML: kinds with their counts, or a histogram over the scale. */
export function legendMarkup(mode, filter, model) {
  if (mode.values) return histogramMarkup(mode, filter);
  const total = mode.key === "finding" ? model.count : model.panels.id.length;
  return (mode.kinds ?? []).map((kind) => {
    let count = 0;
    for (let i = 0; i < total; i++) count += kind.has(i) ? 1 : 0;
    const on = !filter?.kinds || filter.kinds.has(kind.key);
    return `<button class="kind" data-kind="${kind.key}" aria-pressed="${Boolean(filter?.kinds) && on}" ${on ? "" : 'data-off=""'}>`
      + `<i style="background:${css(kind.color)}"></i><b>${escapeText(kind.name)}</b>`
      + `<span>${escapeText(kind.note)}</span><em>${count}</em></button>`;
  }).join("");
}

export const BINS = 36;

function histogramMarkup(mode, filter) {
  const scale = scaleOf(mode), bins = new Array(BINS).fill(0);
  for (const value of mode.values) {
    const share = scale.share(value);
    if (share !== null) bins[Math.min(BINS - 1, Math.floor(share * BINS))]++;
  }
  const most = Math.max(...bins, 1);
  const [from, to] = filter?.range ?? [0, 1];
  const bars = bins.map((count, k) => {
    const middle = (k + 0.5) / BINS, h = count ? Math.max(2, (62 * count) / most) : 0;
    const dim = middle < from || middle > to ? 0.25 : 1;
    return `<rect x="${(k * 288) / BINS}" y="${64 - h}" width="${288 / BINS - 1}" height="${h}" fill="${css(pathColor(middle))}" opacity="${dim}"/>`;
  }).join("");
  const ends = [from, to].map((s) => `${number(scale.back(s))}${mode.unit === "°" ? "" : "\u00a0"}${mode.unit}`);
  const low = Math.round(from * 288), high = Math.round(to * 288);
  return `<svg class="histogram" viewBox="0 0 288 68" role="img" aria-label="Histogram: drag over a range to filter">`
    + `${bars}<rect x="0" y="65" width="288" height="3" fill="#e3e5e8"/>`
    + `<rect x="${low}" y="65" width="${high - low}" height="3" fill="#3b4149"/></svg>`
    + `<div class="ends"><span>${ends[0]}</span><span>${ends[1]}</span></div>`;
}
