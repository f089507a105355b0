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
function patterns(sizes, triangles, rims, kinds, degrees) {
  const found = [], known = [];
  kinds.forEach((kind, f) => { known[kind] ??= degrees[f]; });
  for (let k = 0, t = 0, r = 0; 2 * k < sizes.length; k++) {
    const count = 3 * sizes[2 * k + 1], steps = rims.subarray(r, r + known[k]);
    const rim = steps.reduce((a, b) => a + b, 0);
    found.push({ points: sizes[2 * k], triangles: triangles.subarray(t, t + count), steps, rim });
    t += count;
    r += known[k];
  }
  return found;
}

function addPanels(shapes, head, arrays, at) {
  const { panels: soup, parts: count } = shapes;
  if (!count) return;
  const kinds = (side) => ["sizes", "triangles", "rims", "kinds"].map((name) => arrays[`${side}_${name}`]);
  const outer = patterns(...kinds("outer"), arrays.degrees);
  const inner = head.solid ? patterns(...kinds("inner"), arrays.degrees) : null;
  let o = 0, i = 0;
  for (let f = 0; f < count; f++) {
    const own = outer[arrays.outer_kinds[f]], degree = arrays.degrees[f];
    const n = [arrays.normals[3 * f], arrays.normals[3 * f + 1], arrays.normals[3 * f + 2]];
    const face = shapes.surfaces.add(n, arrays.curvatures[f], at(arrays.outer_points, o), f);
    const rim = addFace(soup, own, arrays.outer_points, arrays.outer_light, o, face, OUTER);
    addOutline(shapes, rim, f, degree);
    shapes.lifts.push(n);
    if (inner) {
      const other = inner[arrays.inner_kinds[f]];
      const under = addFace(soup, other, arrays.inner_points, arrays.inner_light, i, face, INNER);
      addWalls(shapes, rim, under, f, (e) => head.tight === true && head.panels.neighbors[f][e] !== null);
      i += other.points;
    }
    o += own.points;
  }
}

/** Its vertices on the rim: the first of each edge and, as the last one, the first again. */
function addFace(soup, pattern, points, light, start, face, side) {
  const first = soup.size;
  for (let k = start; k < start + pattern.points; k++) {
    soup.vertex(
      points[3 * k] / STEPS, points[3 * k + 1] / STEPS, points[3 * k + 2] / STEPS, face, side,
      light[2 * k], light[2 * k + 1],
    );
  }
  soup.pattern(first, pattern.triangles);
  return { first: first + pattern.points - pattern.rim, count: pattern.rim, steps: pattern.steps };
}

/** Vertices along an edge of a rim, from its corner to the next one. */
function* along({ first, count, steps }) {
  let k = 0;
  for (const n of steps) {
    yield Array.from({ length: n + 1 }, (_, j) => first + ((k + j) % count));
    k += n;
  }
}

function addOutline(shapes, rim, part, degree) {
  const { panels: soup, edges, flat, flatEdges } = shapes;
  const { first, count, steps } = rim, places = [];
  for (let k = 0; k < count; k++) edges.between(soup, first + k, first + ((k + 1) % count), part);
  for (let k = 0, place = first; k < degree; place += steps[k++]) places.push(place);
  const corners = places.map((place) => soup.point(place));
  const middle = scale(corners.reduce((a, b) => add(a, b), [0, 0, 0]), 1 / degree);
  shapes.corners.push(corners);
  shapes.centers.push(middle);
  let n = [0, 0, 0], up = 0, down = 0;
  corners.forEach((p, k) => {
    n = add(n, cross(sub(p, middle), sub(corners[(k + 1) % degree], middle)));
    up += soup.shares[2 * places[k]] / degree;
    down += soup.shares[2 * places[k] + 1] / degree;
  });
  const plane = shapes.surfaces.add(unit(n), 0, middle, part);
  const start = flat.vertex(...middle, plane, OUTER, up, down);
  corners.forEach((p, k) => {
    const i = places[k];
    flat.vertex(p[0], p[1], p[2], plane, OUTER, soup.shares[2 * i], soup.shares[2 * i + 1]);
    flat.triangle(start, start + 1 + k, start + 1 + ((k + 1) % degree));
    flatEdges.add(p, corners[(k + 1) % degree], part);
  });
}

/** Walls, those that touch a neighbour's apart: they are seen in sections only. */
function addWalls(shapes, rim, under, part, touches) {
  const { panels: soup, edges } = shapes, lows = along(under);
  let e = 0;
  for (const high of along(rim)) {
    const low = lows.next().value, steps = high.length - 1;
    const top = soup.point(high[0]), end = soup.point(high[steps]), below = soup.point(low[0]);
    const wall = shapes.surfaces.add(unit(cross(sub(below, top), sub(end, top))), 0, top, part);
    const target = touches(e++) ? shapes.walls : soup;
    const rows = [low, high].map((row) => {
      const first = target.size;
      for (const k of row) {
        const [x, y, z] = soup.point(k);
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
