// Triangles of all parts, and the surface that each of them lies on.
//
// A surface is a plane, a sphere or a cylinder: a normal n at a point p0, the curvature A, and
// an axis (0 but for cylinders). Its normal at p is n - 2 A (p - p0), without what is along the
// axis. Planes have A = 0; nothing divides by it.

import { addBeams, addNodes } from "./members.js";
import { Lines, Soup, Surfaces } from "./soup.js";
import { add, cross, length, scale, sub, unit } from "./vectors.js";

const STEPS = 1 << 20;
export const OUTER = 0, INNER = 1, WALL = 2, BEAM = 3, NODE = 4;

/** Panels from which on lines along the lower edges are left out: they would be a veil. */
const MANY = 2000;

export function buildShapes(head, arrays) {
  const count = head.panels.id.length, beams = head.beams.id.length, nodes = head.nodes.id.length;
  const corners = arrays.degrees?.reduce((a, b) => a + b, 0) ?? 0;
  const points = ((arrays.outer_points?.length ?? 0) + (arrays.inner_points?.length ?? 0)) / 3;
  const shapes = {
    surfaces: new Surfaces(2 * count + corners + 4 * beams + 3 * nodes), parts: count, panels: new Soup(points),
    walls: new Soup(), beams: new Soup(18 * beams), nodes: new Soup(32 * nodes), flat: new Soup(count + corners),
    edges: new Lines(points), flatEdges: new Lines(2 * corners), axes: new Lines(2 * nodes),
    centers: [], lifts: [], corners: [], outlines: [], touching: [],
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

/** How far a panel, or a missing part, reaches from its middle; null for others. */
export function sizeOf(shapes, part) {
  const points = shapes.corners[part] ?? shapes.outlines[part - shapes.total];
  return points ? Math.max(...points.map((p) => length(sub(p, shapes.centers[part])))) : null;
}

/** The direction from which a part is seen from outside: as the panels beside it, if it is none. */
export function outward(shapes, part) {
  const { parts, lifts, centers, outlines, total } = shapes;
  if (part < parts) return lifts[part];
  const middle = centers[part], outline = outlines[part - total] ?? [];
  let n = [0, 0, 0];
  outline.forEach((p, k) => { n = add(n, cross(sub(p, middle), sub(outline[(k + 1) % outline.length], middle))); });
  // Faces go round as those of panels do.
  if (length(n)) return unit(n);
  const away = centers.slice(0, parts).map((c) => length(sub(c, middle)));
  const near = away.map((_, i) => i).sort((i, j) => away[i] - away[j]).slice(0, 2);
  const beside = near.reduce((sum, i) => add(sum, lifts[i]), [0, 0, 0]);
  return unit(length(beside) ? beside : length(middle) ? middle : [0, -1, 0.5]);
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
  const inner = arrays.inner_sizes ? patterns(...kinds("inner"), arrays.degrees) : null;
  let o = 0, i = 0;
  for (let f = 0; f < count; f++) {
    const own = outer[arrays.outer_kinds[f]];
    const n = [arrays.normals[3 * f], arrays.normals[3 * f + 1], arrays.normals[3 * f + 2]];
    const face = shapes.surfaces.add(n, arrays.curvatures[f], at(arrays.outer_points, o), f);
    const rim = addFace(soup, own, arrays.outer_points, arrays.outer_light, o, face, OUTER);
    addOutline(shapes, rim, f);
    shapes.lifts.push(n);
    if (inner) {
      const other = inner[arrays.inner_kinds[f]];
      const under = addFace(soup, other, arrays.inner_points, arrays.inner_light, i, face, INNER);
      const touches = Array.from(own.steps, (_, e) => head.tight === true && head.panels.neighbors[f][e] !== null);
      addWalls(shapes, soup, rim, under, f, touches.map((yes) => !yes));
      shapes.touching.push([rim, under, f, touches]);
      i += other.points;
    }
    o += own.points;
  }
  if (count <= MANY) addTouchingWalls(shapes);
}

/** Walls that touch a neighbour's are seen in sections only: of many panels they come later. */
export function addTouchingWalls(shapes) {
  for (const wall of shapes.touching) addWalls(shapes, shapes.walls, ...wall);
  shapes.touching = [];
}

/** Its vertices on the rim, with the steps of each edge. */
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

function addOutline(shapes, { first, count, steps }, part) {
  const { panels: soup, edges, flat, flatEdges } = shapes, degree = steps.length, places = [];
  for (let k = 0; k < count; k++) edges.between(soup, first + k, first + ((k + 1) % count), part);
  for (let k = 0, place = first; k < degree; place += steps[k++]) places.push(place);
  const corners = places.map((place) => soup.point(place));
  let middle = [0, 0, 0], n = [0, 0, 0], up = 0, down = 0;
  for (const corner of corners) middle = add(middle, corner, 1 / degree);
  shapes.corners.push(corners);
  shapes.centers.push(middle);
  for (let k = 0; k < degree; k++) {
    n = add(n, cross(sub(corners[k], middle), sub(corners[(k + 1) % degree], middle)));
    up += soup.shares[2 * places[k]] / degree;
    down += soup.shares[2 * places[k] + 1] / degree;
  }
  const plane = shapes.surfaces.add(unit(n), 0, middle, part);
  const start = flat.vertex(middle[0], middle[1], middle[2], plane, OUTER, up, down);
  for (let k = 0; k < degree; k++) {
    const p = corners[k], i = places[k];
    flat.vertex(p[0], p[1], p[2], plane, OUTER, soup.shares[2 * i], soup.shares[2 * i + 1]);
    flat.triangle(start, start + 1 + k, start + 1 + ((k + 1) % degree));
    flatEdges.add(p, corners[(k + 1) % degree], part);
  }
}

/** The walls of a panel along those edges that are chosen. */
function addWalls(shapes, target, rim, under, part, chosen) {
  const { panels: soup, edges } = shapes, { count } = rim;
  for (let e = 0, start = 0; e < chosen.length; start += rim.steps[e++]) {
    if (!chosen[e]) continue;
    const steps = rim.steps[e];
    const top = soup.point(rim.first + start), low = soup.point(under.first + start);
    const end = soup.point(rim.first + ((start + steps) % count));
    const wall = shapes.surfaces.add(unit(cross(sub(low, top), sub(end, top))), 0, top, part);
    const lower = addRow(target, soup, under, start, steps, wall), upper = addRow(target, soup, rim, start, steps, wall);
    target.strip(lower, upper, steps + 1);
    if (shapes.parts > MANY) continue;
    for (let k = 0; k < steps; k++) edges.between(target, lower + k, lower + k + 1, part);
    edges.between(target, upper, lower, part);
  }
}

function addRow(target, soup, { first, count }, start, steps, wall) {
  const row = target.size;
  for (let k = start; k <= start + steps; k++) {
    const i = 3 * (first + (k % count)), { points } = soup;
    target.vertex(points[i], points[i + 1], points[i + 2], wall, WALL, 200, 200);
  }
  return row;
}
