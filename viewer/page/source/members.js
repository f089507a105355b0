// Beams, node cylinders and node axes.

import { BEAM, NODE } from "./shapes.js";
import { add, cross, dot, length, scale, sub, unit } from "./vectors.js";

const MANY = 1000;

/** Points of an arc by its ends and its sagitta along a direction, and where its normal is. */
function arc(start, end, across, sagitta, steps) {
  const chord = sub(end, start), middle = add(start, scale(chord, 0.5));
  const half = length(chord) / 2, t = half ? sagitta / half : 0;
  const points = [];
  for (let k = 0; k <= steps; k++) {
    const x = -1 + (2 * k) / steps, denominator = 1 + t * t * x * x;
    // The rational arc: exact, and a line where the sagitta is 0.
    const along = (x * (1 + t * t)) / denominator / 2, rise = (sagitta * (1 - x * x)) / denominator;
    points.push([0, 1, 2].map((i) => middle[i] + along * chord[i] + rise * across[i]));
  }
  // 1/R = 2 s / (h² + s²), and N = n - 2 A (p - top) looks along the rise where A < 0.
  const curvature = -sagitta / (half * half + sagitta * sagitta || 1);
  return { points, top: add(middle, across, sagitta), curvature };
}

export function addBeams(shapes, head, arrays, at) {
  const count = head.beams.id.length, half = head.beam_thickness / 2, ends = new Map();
  const hidden = count > MANY && head.nodes.id.length > 0;
  for (let b = 0; b < count; b++) {
    const part = shapes.parts + b, m = [0, 1, 2].map((k) => arrays.beam_planes[3 * b + k]);
    const [a0, b0, a1, b1] = [0, 1, 2, 3].map((k) => at(arrays.beam_corners, 4 * b + k));
    const rises = [arrays.beam_rises[2 * b], arrays.beam_rises[2 * b + 1]];
    const span = length(sub(a1, a0)) || 1, fine = count > MANY ? 0.012 : 0.004;
    const steps = Math.max(1, Math.min(12, Math.ceil(Math.sqrt(Math.max(...rises.map(Math.abs)) / span / fine))));
    const lines = [[a0, a1], [b0, b1]].map(([p, q], k) => arc(p, q, unit(cross(m, sub(q, p))), rises[k], steps));
    addBeam(shapes, lines, m, half, part, hidden);
    shapes.centers.push([0, 1, 2].map((i) => (a0[i] + a1[i] + b0[i] + b1[i]) / 4));
    shapes.lifts.push([0, 0, 0]);
    head.beams.nodes?.[b].forEach((node, k) => ends.set(node, k ? [a1, b1, part] : [a0, b0, part]));
  }
  // Cylinders have their own axes; without them beams end on the axes of their nodes.
  if (!head.nodes.id.length) for (const [top, low, part] of ends.values()) addAxis(shapes, top, low, part);
}

function addAxis(shapes, top, low, part) {
  const beyond = scale(sub(top, low), 0.8);
  shapes.axes.add(add(top, beyond), sub(low, beyond), part);
}

function addBeam(shapes, [outer, inner], m, half, part, hidden) {
  const soup = shapes.beams, top = outer.points, low = inner.points, last = top.length - 1;
  const outward = unit(cross(m, sub(top[last], top[0])));
  const sign = dot(sub(top[0], low[0]), outward) < 0 ? -1 : 1;
  const row = (points, s, surface) => {
    const first = soup.size, x = s * half * m[0], y = s * half * m[1], z = s * half * m[2];
    for (const p of points) soup.vertex(p[0] + x, p[1] + y, p[2] + z, surface, BEAM, 255, 255);
    return first;
  };
  const side = (first, s, second, r, n, A, p, axis) => {
    const surface = shapes.surfaces.add(n, A, p, part, axis), k = first.length;
    const a = row(first, s, surface), b = row(second, r, surface);
    const [start, along, beyond] = [a, a + k - 1, b].map((i) => soup.point(i));
    const turn = dot(cross(sub(along, start), sub(beyond, start)), n) < 0;
    soup.strip(turn ? b : a, turn ? a : b, k);
  };
  side(top, 1, low, 1, m, 0, top[0]);
  side(top, -1, low, -1, scale(m, -1), 0, top[0]);
  for (const [line, s] of [[outer, sign], [inner, -sign]]) {
    const n = scale(unit(cross(m, sub(line.points[last], line.points[0]))), s);
    side(line.points, -1, line.points, 1, n, line.curvature * s, line.top, m);
  }
  // Within node cylinders ends are never seen.
  for (const k of hidden ? [] : [0, last]) {
    const n = unit(cross(sub(top[k], low[k]), m)), pair = [top[k], low[k]];
    const away = dot(n, sub(top[k], top[last - k])) < 0 ? scale(n, -1) : n;
    side(pair, -1, pair, 1, away, 0, top[k]);
  }
}

export function addNodes(shapes, head, arrays, at) {
  const soup = shapes.nodes, count = head.nodes.id.length, first = shapes.parts + head.beams.id.length;
  // Normals are those of the cylinder: of many small ones a few sides will do.
  const sides = count > MANY ? 8 : 24, r = head.node_radius;
  const turns = Array.from({ length: sides }, (_, k) => [Math.cos((2 * Math.PI * k) / sides), Math.sin((2 * Math.PI * k) / sides)]);
  for (let i = 0; i < count; i++) {
    const part = first + i, axis = [0, 1, 2].map((k) => arrays.node_axes[3 * i + k]);
    const low = at(arrays.node_origins, i), high = add(low, axis, arrays.node_heights[i]);
    const other = [[1, 0, 0], [0, 1, 0], [0, 0, 1]].sort((p, q) => Math.abs(dot(p, axis)) - Math.abs(dot(q, axis)))[0];
    const x = unit(cross(other, axis)), y = cross(axis, x);
    const ring = (c, surface) => {
      const start = soup.size;
      for (const [p, q] of turns) {
        soup.vertex(
          c[0] + r * (p * x[0] + q * y[0]), c[1] + r * (p * x[1] + q * y[1]), c[2] + r * (p * x[2] + q * y[2]),
          surface, NODE, 255, 255,
        );
      }
      return start;
    };
    const round = shapes.surfaces.add(x, -1 / (2 * r), add(low, x, r), part, axis);
    const a = ring(low, round), b = ring(high, round);
    for (let k = 0; k < sides; k++) {
      const l = (k + 1) % sides;
      soup.triangle(a + k, a + l, b + l);
      soup.triangle(a + k, b + l, b + k);
    }
    const disc = shapes.surfaces.add(scale(axis, -1), 0, low, part), over = shapes.surfaces.add(axis, 0, high, part);
    const c = ring(low, disc), d = ring(high, over);
    for (let k = 1; k + 1 < sides; k++) {
      soup.triangle(c, c + k + 1, c + k);
      soup.triangle(d, d + k, d + k + 1);
    }
    shapes.centers.push(low);
    shapes.lifts.push([0, 0, 0]);
    addAxis(shapes, low, high, part);
  }
}
