// Triangles of all parts, and the surface that each of them lies on.
//
// A surface is a plane, a sphere or a cylinder: a normal n at a point p0, the curvature A, and
// an axis (0 but for cylinders). Its normal at p is n - 2 A (p - p0), without what is along the
// axis. Planes have A = 0; nothing divides by it.

import { addBeams, addNodes } from "./members.js";
import { Lines, Soup, Surfaces } from "./soup.js";
import { add, cross, scale, sub, unit } from "./vectors.js";

const STEPS = 1 << 20;
export const OUTER = 0, INNER = 1, WALL = 2, BEAM = 3, NODE = 4;

const MANY = 2000;
/** Panels from which on lines along the lower edges are left out: they would be a veil. */

export function buildShapes(head, arrays) {
  const shapes = {
    surfaces: new Surfaces(), parts: head.panels.id.length, panels: new Soup(), walls: new Soup(), beams: new Soup(),
    nodes: new Soup(), flat: new Soup(), edges: new Lines(), flatEdges: new Lines(), axes: new Lines(),
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

/** The kinds of triangulated faces: points, triangles, and how many steps each edge has. */
function patterns(sizes, triangles) {
  const found = [];
  for (let k = 0, t = 0; 2 * k < sizes.length; k++) {
    const count = 3 * sizes[2 * k + 1];
    found.push({ points: sizes[2 * k], triangles: triangles.subarray(t, t + count), steps: {} });
    t += count;
  }
  return found;
}

/** The last points of a face lie on its rim, as many as its edges have steps. */
function stepsOf(pattern, degree) {
  if (degree in pattern.steps) return pattern.steps[degree];
  const { points, triangles } = pattern;
  // A fan of s steps a side has 1 + degree s (s + 1) / 2 points; ears have the rim alone.
  let steps = points / degree;
  for (let s = 1; 1 + (degree * s * (s + 1)) / 2 <= points; s++) {
    if (1 + (degree * s * (s + 1)) / 2 === points && triangles.length === 3 * degree * s * s) steps = s;
  }
  return (pattern.steps[degree] = steps);
}

function addPanels(shapes, head, arrays, at) {
  const { panels: soup, parts: count } = shapes;
  if (!count) return;
  const outer = patterns(arrays.outer_sizes, arrays.outer_triangles);
  const inner = arrays.inner_sizes ? patterns(arrays.inner_sizes, arrays.inner_triangles) : null;
  let o = 0, i = 0;
  for (let f = 0; f < count; f++) {
    const own = outer[arrays.outer_kinds[f]], degree = arrays.degrees[f];
    const n = [arrays.normals[3 * f], arrays.normals[3 * f + 1], arrays.normals[3 * f + 2]];
    const face = shapes.surfaces.add(n, arrays.curvatures[f], at(arrays.outer_points, o), f);
    const rim = addFace(soup, own, arrays.outer_points, arrays.outer_light, o, face, OUTER, degree);
    addOutline(shapes, rim, f, degree);
    shapes.lifts.push(n);
    if (inner) {
      const other = inner[arrays.inner_kinds[f]];
      const under = addFace(soup, other, arrays.inner_points, arrays.inner_light, i, face, INNER, degree);
      addWalls(shapes, rim, under, f, degree, (e) => head.tight === true && head.panels.neighbors[f][e] !== null);
      i += other.points;
    }
    o += own.points;
  }
}

/** Its first vertex on the rim, and the steps of each edge. */
function addFace(soup, pattern, points, light, start, face, side, degree) {
  const first = soup.size;
  for (let k = start; k < start + pattern.points; k++) {
    soup.vertex(
      points[3 * k] / STEPS, points[3 * k + 1] / STEPS, points[3 * k + 2] / STEPS, face, side,
      light[2 * k], light[2 * k + 1],
    );
  }
  soup.pattern(first, pattern.triangles);
  const steps = stepsOf(pattern, degree);
  return { first: first + pattern.points - degree * steps, steps };
}

function addOutline(shapes, rim, part, degree) {
  const { panels: soup, edges, flat, flatEdges } = shapes, { first, steps } = rim;
  const count = degree * steps, corners = [];
  for (let k = 0; k < count; k++) edges.between(soup, first + k, first + ((k + 1) % count), part);
  for (let k = 0; k < degree; k++) corners.push(soup.point(first + k * steps));
  const middle = scale(corners.reduce((a, b) => add(a, b), [0, 0, 0]), 1 / degree);
  shapes.corners.push(corners);
  shapes.centers.push(middle);
  let n = [0, 0, 0], up = 0, down = 0;
  corners.forEach((p, k) => {
    n = add(n, cross(sub(p, middle), sub(corners[(k + 1) % degree], middle)));
    up += soup.shares[2 * (first + k * steps)] / degree;
    down += soup.shares[2 * (first + k * steps) + 1] / degree;
  });
  const plane = shapes.surfaces.add(unit(n), 0, middle, part);
  const start = flat.vertex(...middle, plane, OUTER, up, down);
  corners.forEach((p, k) => {
    const i = first + k * steps;
    flat.vertex(p[0], p[1], p[2], plane, OUTER, soup.shares[2 * i], soup.shares[2 * i + 1]);
    flat.triangle(start, start + 1 + k, start + 1 + ((k + 1) % degree));
    flatEdges.add(p, corners[(k + 1) % degree], part);
  });
}

/** Walls, those that touch a neighbour's apart: they are seen in sections only. */
function addWalls(shapes, rim, under, part, degree, touches) {
  if (under.steps !== rim.steps) return;
  const { panels: soup, edges } = shapes, { steps } = rim, count = degree * steps;
  for (let e = 0; e < degree; e++) {
    const place = (row, k) => row.first + ((e * steps + k) % count);
    const top = soup.point(place(rim, 0)), end = soup.point(place(rim, steps)), low = soup.point(place(under, 0));
    const wall = shapes.surfaces.add(unit(cross(sub(low, top), sub(end, top))), 0, top, part);
    const target = touches(e) ? shapes.walls : soup;
    const rows = [under, rim].map((row) => {
      const first = target.size;
      for (let k = 0; k <= steps; k++) {
        const [x, y, z] = soup.point(place(row, k));
        target.vertex(x, y, z, wall, WALL, 200, 200);
      }
      return first;
    });
    target.strip(rows[0], rows[1], steps + 1);
    if (shapes.parts > MANY) continue;
    for (let k = 0; k < steps; k++) edges.between(target, rows[0] + k, rows[0] + k + 1, part);
    edges.between(target, rows[1], rows[0], part);
  }
}
