// Beams, node cylinders and node axes.

import { BEAM, NODE } from "./shapes.js";
import { add, cross, dot, length, scale, sub, unit } from "./vectors.js";

const MANY = 1000;

const LONGEST = 12; // steps of an arc
// Rows of points: of the arcs of one beam, and across its end.
const outer = new Float64Array(3 * (LONGEST + 1)), inner = new Float64Array(3 * (LONGEST + 1));
const pair = new Float64Array(6);

/** Points of an arc by its ends and its sagitta along a direction. */
function fillArc(row, start, end, across, sagitta, steps) {
  const half = length(sub(end, start)) / 2, t = half ? sagitta / half : 0;
  for (let k = 0; k <= steps; k++) {
    const x = -1 + (2 * k) / steps, denominator = 1 + t * t * x * x;
    // The rational arc: exact, and a line where the sagitta is 0.
    const along = (x * (1 + t * t)) / denominator / 2, rise = (sagitta * (1 - x * x)) / denominator;
    for (let i = 0; i < 3; i++) {
      row[3 * k + i] = (start[i] + end[i]) / 2 + along * (end[i] - start[i]) + rise * across[i];
    }
  }
}

export function addBeams(shapes, head, arrays, at) {
  const count = head.beams.id.length, half = head.beam_thickness / 2, ends = new Map();
  const hidden = count > MANY && head.nodes.id.length > 0, fine = count > MANY ? 0.012 : 0.004;
  for (let b = 0; b < count; b++) {
    const part = shapes.parts + b;
    const m = [arrays.beam_planes[3 * b], arrays.beam_planes[3 * b + 1], arrays.beam_planes[3 * b + 2]];
    const a0 = at(arrays.beam_corners, 4 * b), b0 = at(arrays.beam_corners, 4 * b + 1);
    const a1 = at(arrays.beam_corners, 4 * b + 2), b1 = at(arrays.beam_corners, 4 * b + 3);
    const high = arrays.beam_rises[2 * b], low = arrays.beam_rises[2 * b + 1];
    const bend = Math.max(Math.abs(high), Math.abs(low)) / (length(sub(a1, a0)) || 1);
    const steps = Math.max(1, Math.min(LONGEST, Math.ceil(Math.sqrt(bend / fine))));
    const over = unit(cross(m, sub(a1, a0))), under = unit(cross(m, sub(b1, b0)));
    const beam = { part, m, half, steps };
    fillArc(outer, a0, a1, over, high, steps);
    fillArc(inner, b0, b1, under, low, steps);
    addSide(shapes, beam, outer, 1, inner, 1, m, 0, a0);
    addSide(shapes, beam, outer, -1, inner, -1, scale(m, -1), 0, a0);
    const sign = dot(sub(a0, b0), over) < 0 ? -1 : 1;
    addRound(shapes, beam, outer, a0, a1, over, high, sign);
    addRound(shapes, beam, inner, b0, b1, under, low, -sign);
    // Within node cylinders ends are never seen.
    if (!hidden) {
      addEnd(shapes, beam, a0, b0, a1);
      addEnd(shapes, beam, a1, b1, a0);
    }
    shapes.centers.push(scale(add(add(a0, a1), add(b0, b1)), 0.25));
    shapes.lifts.push([0, 0, 0]);
    const nodes = head.beams.nodes?.[b];
    if (nodes) ends.set(nodes[0], [a0, b0, part]).set(nodes[1], [a1, b1, part]);
  }
  // Cylinders have their own axes; without them beams end on the axes of their nodes.
  if (!head.nodes.id.length) for (const [top, low, part] of ends.values()) addAxis(shapes, top, low, part);
}

function addAxis(shapes, top, low, part) {
  const beyond = scale(sub(top, low), 0.8);
  shapes.axes.add(add(top, beyond), sub(low, beyond), part);
}

/** A strip between two rows, moved across the beam by s and r times half its thickness. */
function addSide(shapes, beam, first, s, second, r, n, A, p, axis) {
  const soup = shapes.beams, { steps } = beam, surface = shapes.surfaces.add(n, A, p, beam.part, axis);
  const a = addRow(soup, beam, first, s, surface), b = addRow(soup, beam, second, r, surface);
  const start = soup.point(a), along = soup.point(a + steps), beyond = soup.point(b);
  const turned = dot(cross(sub(along, start), sub(beyond, start)), n) < 0;
  soup.strip(turned ? b : a, turned ? a : b, steps + 1);
}

function addRow(soup, { m, half, steps }, row, s, surface) {
  const first = soup.size, x = s * half * m[0], y = s * half * m[1], z = s * half * m[2];
  for (let k = 0; k <= steps; k++) {
    soup.vertex(row[3 * k] + x, row[3 * k + 1] + y, row[3 * k + 2] + z, surface, BEAM, 255, 255);
  }
  return first;
}

/** The face along an arc: a cylinder about the normal of the beam. */
function addRound(shapes, beam, row, start, end, across, sagitta, sign) {
  const half = length(sub(end, start)) / 2, top = add(scale(add(start, end), 0.5), across, sagitta);
  // 1/R = 2 s / (h² + s²), and N = n - 2 A (p - top) looks along the rise where A < 0.
  const A = -sagitta / (half * half + sagitta * sagitta || 1);
  addSide(shapes, beam, row, -1, row, 1, scale(across, sign), A * sign, top, beam.m);
}

function addEnd(shapes, beam, top, low, other) {
  const n = unit(cross(sub(top, low), beam.m));
  pair.set(top);
  pair.set(low, 3);
  addSide(shapes, { ...beam, steps: 1 }, pair, -1, pair, 1, dot(n, sub(top, other)) < 0 ? scale(n, -1) : n, 0, top);
}

export function addNodes(shapes, head, arrays, at) {
  const soup = shapes.nodes, count = head.nodes.id.length, first = shapes.parts + head.beams.id.length;
  // Normals are those of the cylinder: of many small ones a few sides will do.
  const sides = count > MANY ? 8 : 24, r = head.node_radius, circle = new Float64Array(2 * sides);
  for (let k = 0; k < sides; k++) {
    circle[2 * k] = r * Math.cos((2 * Math.PI * k) / sides);
    circle[2 * k + 1] = r * Math.sin((2 * Math.PI * k) / sides);
  }
  for (let i = 0; i < count; i++) {
    const part = first + i, axes = arrays.node_axes, axis = [axes[3 * i], axes[3 * i + 1], axes[3 * i + 2]];
    const low = at(arrays.node_origins, i), high = add(low, axis, arrays.node_heights[i]);
    const x = unit(cross(farthest(axis), axis)), y = cross(axis, x);
    const round = shapes.surfaces.add(x, -1 / (2 * r), add(low, x, r), part, axis);
    const a = addRing(soup, low, circle, x, y, round), b = addRing(soup, high, circle, x, y, round);
    for (let k = 0; k < sides; k++) {
      const l = (k + 1) % sides;
      soup.triangle(a + k, a + l, b + l);
      soup.triangle(a + k, b + l, b + k);
    }
    const disc = shapes.surfaces.add(scale(axis, -1), 0, low, part), over = shapes.surfaces.add(axis, 0, high, part);
    const c = addRing(soup, low, circle, x, y, disc), d = addRing(soup, high, circle, x, y, over);
    for (let k = 1; k + 1 < sides; k++) {
      soup.triangle(c, c + k + 1, c + k);
      soup.triangle(d, d + k, d + k + 1);
    }
    shapes.centers.push(low);
    shapes.lifts.push([0, 0, 0]);
    addAxis(shapes, low, high, part);
  }
}

/** The coordinate axis farthest from a direction. */
function farthest([x, y, z]) {
  const a = Math.abs(x), b = Math.abs(y), c = Math.abs(z);
  return a <= b && a <= c ? [1, 0, 0] : b <= c ? [0, 1, 0] : [0, 0, 1];
}

function addRing(soup, c, circle, x, y, surface) {
  const first = soup.size;
  for (let k = 0; k < circle.length; k += 2) {
    const p = circle[k], q = circle[k + 1];
    soup.vertex(
      c[0] + p * x[0] + q * y[0], c[1] + p * x[1] + q * y[1], c[2] + p * x[2] + q * y[2], surface, NODE, 255, 255,
    );
  }
  return first;
}
