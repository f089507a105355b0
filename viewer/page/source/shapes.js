// Triangles of all parts, and the surface that each of them lies on.
//
// A surface is a plane, a sphere or a cylinder: a normal n at a point p0, the curvature A, and
// an axis (0 but for cylinders). Its normal at p is n - 2 A (p - p0), without what is along the
// axis. Planes have A = 0; nothing divides by it.

import { add, cross, dot, length, scale, sub, unit } from "./vectors.js";

const STEPS = 1 << 20;
export const OUTER = 0, INNER = 1, WALL = 2, BEAM = 3, NODE = 4;

/** Numbers that grow. */
class Numbers {
  constructor(Kind) {
    this.values = new Kind(1 << 12);
    this.length = 0;
  }

  push(value) {
    if (this.length === this.values.length) {
      const grown = new this.values.constructor(2 * this.length);
      grown.set(this.values);
      this.values = grown;
    }
    this.values[this.length++] = value;
  }

  push2(a, b) {
    this.push(a);
    this.push(b);
  }

  push3(a, b, c) {
    this.push(a);
    this.push(b);
    this.push(c);
  }

  get all() { return this.values.subarray(0, this.length); }
}

/** Vertices and triangles that grow. */
class Soup {
  constructor() {
    this.positions = new Numbers(Float32Array);
    this.surfaces = new Numbers(Float32Array);
    this.lights = new Numbers(Uint8Array);
    this.sides = new Numbers(Uint8Array);
    this.triangles = new Numbers(Uint32Array);
  }

  get size() { return this.surfaces.length; }

  vertex(p, surface, side, up = 255, down = 255) {
    this.positions.push3(p[0], p[1], p[2]);
    this.surfaces.push(surface);
    this.lights.push2(up, down);
    this.sides.push(side);
  }

  /** A strip between two rows of points, seen from the side of `low` × `high`. */
  strip(low, high, surface, side, light = [255, 255]) {
    const start = this.size, n = low.length;
    low.forEach((p) => this.vertex(p, surface, side, ...light));
    high.forEach((p) => this.vertex(p, surface, side, ...light));
    for (let i = 0; i + 1 < n; i++) {
      const a = start + i, b = a + n;
      this.triangles.push3(a, a + 1, b + 1);
      this.triangles.push3(a, b + 1, b);
    }
  }
}

/** Segments of lines, each end with its part. */
export class Lines {
  constructor() {
    this.positions = new Numbers(Float32Array);
    this.parts = new Numbers(Float32Array);
  }

  add(p, q, part) {
    this.positions.push3(p[0], p[1], p[2]);
    this.positions.push3(q[0], q[1], q[2]);
    this.parts.push2(part, part);
  }
}

export function buildShapes(head, arrays) {
  const shapes = {
    surfaces: [], parts: head.panels.id.length, panels: new Soup(), beams: new Soup(),
    nodes: new Soup(), flat: new Soup(), edges: new Lines(),
    flatEdges: new Lines(),
    centers: [], lifts: [], corners: [], outlines: [],
  };
  const at = (array, i) => [array[3 * i] / STEPS, array[3 * i + 1] / STEPS, array[3 * i + 2] / STEPS];
  addPanels(shapes, head, arrays, at);
  addBeams(shapes, head, arrays, at);
  addNodes(shapes, head, arrays, at);
  shapes.total = shapes.centers.length;
  let first = 0;
  for (const missing of head.missing) {
    const outline = [];
    for (let i = 0; i < missing.corners; i++) outline.push(at(arrays.missing, first++));
    shapes.outlines.push(outline);
    shapes.centers.push(scale(outline.reduce((a, b) => add(a, b), [0, 0, 0]), 1 / (outline.length || 1)));
    shapes.lifts.push([0, 0, 0]);
  }
  return shapes;
}

const surface = (shapes, n, A, p, part, axis = [0, 0, 0]) => {
  shapes.surfaces.push([...n, A, ...p, part, ...axis, 0]);
  return shapes.surfaces.length - 1;
};

function patterns(sizes, triangles) {
  const found = [];
  for (let k = 0, t = 0; 2 * k < sizes.length; k++) {
    const count = 3 * sizes[2 * k + 1];
    found.push({ points: sizes[2 * k], triangles: triangles.subarray(t, t + count) });
    t += count;
  }
  return found;
}

function addPanels(shapes, head, arrays, at) {
  const { panels: soup } = shapes;
  const count = shapes.parts;
  if (!count) return;
  const outer = patterns(arrays.outer_sizes, arrays.outer_triangles);
  const inner = arrays.inner_sizes ? patterns(arrays.inner_sizes, arrays.inner_triangles) : null;
  let o = 0, i = 0;
  for (let f = 0; f < count; f++) {
    const own = outer[arrays.outer_kinds[f]], degree = arrays.degrees[f];
    const n = [0, 1, 2].map((k) => arrays.normals[3 * f + k]);
    const face = surface(shapes, n, arrays.curvatures[f], at(arrays.outer_points, o), f);
    const rim = addFace(shapes, soup, arrays, at, own, o, face, OUTER, degree, "outer");
    addOutline(shapes, rim, f, degree);
    shapes.lifts.push(n);
    if (inner) {
      const other = inner[arrays.inner_kinds[f]];
      const under = addFace(shapes, soup, arrays, at, other, i, face, INNER, degree, "inner");
      addWalls(shapes, soup, rim, under, f, degree);
      i += other.points;
    }
    o += own.points;
  }
}

function addFace(shapes, soup, arrays, at, pattern, start, face, side, degree, name) {
  const first = soup.size, points = [], light = arrays[`${name}_light`];
  for (let k = 0; k < pattern.points; k++) {
    const p = at(arrays[`${name}_points`], start + k);
    points.push(p);
    soup.vertex(p, face, side, light[2 * (start + k)], light[2 * (start + k) + 1]);
  }
  for (const k of pattern.triangles) soup.triangles.push(first + k);
  return rimOf(points, pattern.triangles, degree, light, start);
}

/** The last points of a face lie on its rim, as many as its edges have steps. */
function rimOf(points, triangles, degree, light, start) {
  // A fan of s steps a side has 1 + degree s (s + 1) / 2 points; ears have the rim alone.
  let steps = points.length / degree;
  for (let s = 1; 1 + (degree * s * (s + 1)) / 2 <= points.length; s++) {
    if (1 + (degree * s * (s + 1)) / 2 === points.length && triangles.length === 3 * degree * s * s) {
      steps = s;
    }
  }
  const first = points.length - degree * steps;
  const rim = points.slice(first);
  rim.lights = rim.map((_, k) => [light[2 * (start + first + k)], light[2 * (start + first + k) + 1]]);
  return rim;
}

function addOutline(shapes, rim, part, degree) {
  const steps = rim.length / degree, corners = [];
  const edges = shapes.edges;
  rim.forEach((p, k) => {
    const q = rim[(k + 1) % rim.length];
    edges.add(p, q, part);
    if (k % steps === 0) corners.push(p);
  });
  const middle = scale(corners.reduce((a, b) => add(a, b), [0, 0, 0]), 1 / degree);
  shapes.corners.push(corners);
  shapes.centers.push(middle);
  let n = [0, 0, 0];
  corners.forEach((p, k) => {
    n = add(n, cross(sub(p, middle), sub(corners[(k + 1) % degree], middle)));
  });
  const flat = surface(shapes, unit(n), 0, middle, part), soup = shapes.flat, first = soup.size;
  const lights = corners.map((_, k) => rim.lights[k * steps]);
  const mean = [0, 1].map((s) => lights.reduce((a, b) => a + b[s], 0) / degree);
  soup.vertex(middle, flat, OUTER, ...mean);
  corners.forEach((p, k) => {
    const q = corners[(k + 1) % degree];
    soup.vertex(p, flat, OUTER, ...lights[k]);
    soup.triangles.push3(first, first + 1 + k, first + 1 + ((k + 1) % degree));
    shapes.flatEdges.add(p, q, part);
  });
}

function addWalls(shapes, soup, rim, under, part, degree) {
  const steps = rim.length / degree;
  if (under.length !== rim.length) return;
  for (let e = 0; e < degree; e++) {
    const row = (points) => Array.from(
      { length: steps + 1 }, (_, k) => points[(e * steps + k) % points.length],
    );
    const top = row(rim), low = row(under);
    const n = unit(cross(sub(low[0], top[0]), sub(top[steps], top[0])));
    const wall = surface(shapes, n, 0, top[0], part);
    soup.strip(low, top, wall, WALL, [200, 200]);
    for (let k = 0; k < steps; k++) shapes.edges.add(low[k], low[k + 1], part);
    shapes.edges.add(top[0], low[0], part);
  }
}

/** Points of an arc by its ends and its sagitta along a direction, and where its normal is. */
function arc(start, end, across, sagitta, steps) {
  const chord = sub(end, start), middle = add(start, scale(chord, 0.5));
  const half = length(chord) / 2, t = half ? sagitta / half : 0;
  const points = [];
  for (let k = 0; k <= steps; k++) {
    const x = -1 + (2 * k) / steps, denominator = 1 + t * t * x * x;
    // The rational arc: exact, and a line where the sagitta is 0.
    const along = (x * (1 + t * t)) / denominator, rise = (sagitta * (1 - x * x)) / denominator;
    points.push(add(add(middle, chord, along / 2), across, rise));
  }
  // 1/R = 2 s / (h² + s²), and N = n - 2 A (p - top) looks along the rise where A < 0.
  const curvature = -sagitta / (half * half + sagitta * sagitta || 1);
  return { points, top: add(middle, across, sagitta), curvature };
}

function addBeams(shapes, head, arrays, at) {
  const soup = shapes.beams, count = head.beams.id.length, half = head.beam_thickness / 2;
  for (let b = 0; b < count; b++) {
    const part = shapes.parts + b;
    const m = [0, 1, 2].map((k) => arrays.beam_planes[3 * b + k]);
    const [a0, b0, a1, b1] = [0, 1, 2, 3].map((k) => at(arrays.beam_corners, 4 * b + k));
    const rises = [arrays.beam_rises[2 * b], arrays.beam_rises[2 * b + 1]];
    const span = length(sub(a1, a0)) || 1;
    const steps = Math.max(1, Math.min(12, Math.ceil(Math.sqrt(Math.max(...rises.map(Math.abs)) / span / 0.004))));
    const lines = [[a0, a1], [b0, b1]].map(([p, q], k) => arc(p, q, unit(cross(m, sub(q, p))), rises[k], steps));
    addBeam(shapes, soup, lines, m, half, part);
    shapes.centers.push(scale(add(add(a0, a1), add(b0, b1)), 0.25));
    shapes.lifts.push([0, 0, 0]);
  }
}

function addBeam(shapes, soup, [outer, inner], m, half, part) {
  const shift = (points, s) => points.map((p) => add(p, m, s * half));
  const top = outer.points, low = inner.points, last = top.length - 1;
  const outward = unit(cross(m, sub(top[last], top[0])));
  const sign = dot(sub(top[0], low[0]), outward) < 0 ? -1 : 1;
  const side = (rows, n, A, p, axis) => {
    const [first, second] = rows, k = first.length - 1;
    const turn = dot(cross(sub(first[k], first[0]), sub(second[0], first[0])), n) < 0;
    soup.strip(turn ? second : first, turn ? first : second, surface(shapes, n, A, p, part, axis), BEAM);
  };
  side([shift(top, 1), shift(low, 1)], m, 0, top[0]);
  side([shift(top, -1), shift(low, -1)], scale(m, -1), 0, top[0]);
  for (const [line, s] of [[outer, sign], [inner, -sign]]) {
    const n = scale(unit(cross(m, sub(line.points[last], line.points[0]))), s);
    side([shift(line.points, -1), shift(line.points, 1)], n, line.curvature * s, line.top, m);
  }
  for (const k of [0, last]) {
    const n = unit(cross(sub(top[k], low[k]), m));
    const away = dot(n, sub(top[k], top[last - k])) < 0 ? scale(n, -1) : n;
    const pair = (s) => [add(top[k], m, s * half), add(low[k], m, s * half)];
    side([pair(-1), pair(1)], away, 0, top[k]);
  }
}

function addNodes(shapes, head, arrays, at) {
  const soup = shapes.nodes, count = head.nodes.id.length, first = shapes.parts + head.beams.id.length;
  const sides = 24, r = head.node_radius;
  for (let i = 0; i < count; i++) {
    const part = first + i, axis = [0, 1, 2].map((k) => arrays.node_axes[3 * i + k]);
    const low = at(arrays.node_origins, i), high = add(low, axis, arrays.node_heights[i]);
    const other = [[1, 0, 0], [0, 1, 0], [0, 0, 1]].sort((p, q) => Math.abs(dot(p, axis)) - Math.abs(dot(q, axis)))[0];
    const x = unit(cross(other, axis)), y = cross(axis, x);
    const around = Array.from({ length: sides + 1 }, (_, k) => {
      const angle = (2 * Math.PI * (k % sides)) / sides;
      return add(scale(x, Math.cos(angle)), y, Math.sin(angle));
    });
    const ring = (center) => around.map((n) => add(center, n, r));
    soup.strip(ring(low), ring(high), surface(shapes, x, -1 / (2 * r), add(low, x, r), part, axis), NODE);
    for (const [center, n] of [[low, scale(axis, -1)], [high, axis]]) {
      const disc = surface(shapes, n, 0, center, part), start = soup.size;
      soup.vertex(center, disc, NODE);
      ring(center).forEach((p) => soup.vertex(p, disc, NODE));
      for (let k = 1; k <= sides; k++) {
        soup.triangles.push3(start, ...(n === axis ? [start + k, start + k + 1] : [start + k + 1, start + k]));
      }
    }
    shapes.centers.push(low);
    shapes.lifts.push([0, 0, 0]);
  }
}
