// What is drawn, as three.js has it: geometries, materials, textures.

import {
  BufferAttribute, BufferGeometry, DataTexture, DoubleSide, FloatType, FrontSide, GLSL3, LinearFilter, LineSegments,
  Mesh, NearestFilter, PlaneGeometry, RawShaderMaterial, RedFormat, RGBAFormat, UnsignedByteType, Vector3, Vector4,
} from "three";
import {
  GHOST_FRAGMENT, GROUND_FRAGMENT, GROUND_VERTEX, LINE_FRAGMENT, LINE_VERTEX, MESH_FRAGMENT, MESH_VERTEX, THROUGH_FRAGMENT,
} from "./shaders.js";
import { Lines } from "./soup.js";
import { add, cross, length, scale, sub, unit } from "./vectors.js";

const PULL = 4e-6; // of lines before the surfaces that they lie on, in depth
const INK = [0.13, 0.15, 0.18, 0.5];

const table = (data, width, height) => texture(data, width, height, RGBAFormat, FloatType, NearestFilter);

function texture(data, width, height, format, type, filter) {
  const result = new DataTexture(data, width, height, format, type);
  result.minFilter = result.magFilter = filter;
  result.needsUpdate = true;
  return result;
}

export function meshGeometry(soup) {
  const result = new BufferGeometry();
  result.setAttribute("position", new BufferAttribute(soup.positions, 3));
  result.setAttribute("surface", new BufferAttribute(soup.surfaces, 1));
  result.setAttribute("side", new BufferAttribute(soup.sides, 1));
  result.setAttribute("light", new BufferAttribute(soup.lights, 2, true));
  result.setIndex(new BufferAttribute(soup.triangles, 1));
  return result;
}

function lineGeometry(lines) {
  const result = new BufferGeometry();
  result.setAttribute("position", new BufferAttribute(lines.positions, 3));
  result.setAttribute("part", new BufferAttribute(lines.parts, 1));
  return result;
}

/** Displacement of each part where the model is drawn apart, for an amount of 1: texels. */
function shiftTexels(shapes) {
  const rows = Math.ceil(Math.max(1, shapes.centers.length) / 1024), data = new Float32Array(4096 * rows);
  shapes.centers.forEach((c, i) => data.set(add(scale(c, 0.4), shapes.lifts[i], 0.07), 4 * i));
  return data;
}

/** Normals and curvatures of all surfaces. */
export const surfaceTexture = (shapes) => {
  const [texels, height] = shapes.surfaces.texels(1536);
  return table(texels, 1536, height);
};

/** What all materials share. */
export function makeUniforms(shapes, colors) {
  const rows = Math.ceil(Math.max(1, shapes.centers.length) / 1024);
  return {
    surfaces: { value: surfaceTexture(shapes) },
    shifts: { value: table(shiftTexels(shapes), 1024, rows) },
    colors: { value: texture(colors, 1024, rows, RGBAFormat, UnsignedByteType, NearestFilter) },
    shading: { value: 0 }, selected: { value: -1 }, marked: { value: false }, picking: { value: 0 },
    cuts: { value: false }, explode: { value: 0 },
    eye: { value: new Vector3() }, right: { value: new Vector3(1, 0, 0) },
    back: { value: new Vector3(0, 1, 0) }, sun: { value: new Vector3(0, 0, 1) },
    plane: { value: new Vector4(1, 0, 0, 9) },
  };
}

/** Triangles of which the backs are seen, but for those of solids. */
export function meshOf(soup, uniforms, solid) {
  return new Mesh(meshGeometry(soup), new RawShaderMaterial({
    vertexShader: MESH_VERTEX, fragmentShader: MESH_FRAGMENT, glslVersion: GLSL3, side: DoubleSide,
    uniforms: { ...uniforms, solid: { value: solid } },
  }));
}

/** All lines of a model; `marked` are the edges of the panel that is selected. */
export function linesOf(shapes, uniforms) {
  const material = (ink, only = -1, pull = PULL) => new RawShaderMaterial({
    vertexShader: LINE_VERTEX, fragmentShader: LINE_FRAGMENT, glslVersion: GLSL3, transparent: true,
    uniforms: { ...uniforms, ink: { value: new Vector4(...ink) }, only: { value: only }, pull: { value: pull } },
    depthWrite: false,
  });
  const edges = lineGeometry(shapes.edges);
  return {
    edges: new LineSegments(edges, material(INK)),
    flatEdges: new LineSegments(lineGeometry(shapes.flatEdges), material(INK)),
    marked: new LineSegments(edges, material([0.78, 0.30, 0.02, 1], -1, 0.0006)),
    axes: new LineSegments(lineGeometry(shapes.axes), material([0.10, 0.30, 0.62, 0.9])),
    missing: new LineSegments(lineGeometry(outlines(shapes)), material([0.78, 0.16, 0.12, 1], -2)),
  };
}

function outlines(shapes) {
  const lines = new Lines();
  shapes.outlines.forEach((outline, i) => {
    if (outline.length < 3) return;
    const middle = shapes.centers[shapes.total + i];
    const corners = outline.map((p) => add(p, add(middle, p, -1), 0.06));
    const part = shapes.total + i, half = Math.floor(corners.length / 2);
    corners.forEach((p, k) => lines.add(p, corners[(k + 1) % corners.length], part));
    corners.slice(0, half).forEach((p, k) => lines.add(p, corners[k + half], part));
  });
  return lines;
}

/** What is drawn over everything: missing parts that were asked for, and what lies under others. */
export function ghostsOf(shapes, meshes, thickness, uniforms) {
  const material = (vertexShader, fragmentShader, more = {}) => new RawShaderMaterial({
    vertexShader, fragmentShader, glslVersion: GLSL3, transparent: true, depthTest: false, depthWrite: false,
    side: DoubleSide, uniforms: { ...uniforms, ...more },
  });
  const red = { ink: { value: new Vector4(0.80, 0.10, 0.12, 0.5) }, pull: { value: 0 } };
  const through = material(MESH_VERTEX, THROUGH_FRAGMENT);
  return {
    missing: new Mesh(lineGeometry(ghosts(shapes, thickness)), material(LINE_VERTEX, GHOST_FRAGMENT, red)),
    beams: new Mesh(meshes.beams.geometry, through), nodes: new Mesh(meshes.nodes.geometry, through),
  };
}

/** Triangles of missing parts, three ends each: faces with a broad rim, and bars along edges. */
function ghosts(shapes, thickness) {
  const found = new Lines();
  const triangle = (part, ...points) => { for (const p of points) found.end(p[0], p[1], p[2], part); };
  shapes.outlines.forEach((outline, i) => {
    const part = shapes.total + i, middle = shapes.centers[part];
    if (outline.length === 2) addBar(triangle, part, outline, thickness);
    else outline.forEach((p, k) => {
      const q = outline[(k + 1) % outline.length], [r, s] = [p, q].map((c) => add(c, sub(middle, c), 0.07));
      triangle(part, p, q, middle);
      triangle(part, p, q, s);
      triangle(part, p, s, r);
    });
  });
  return found;
}

/** Two bands that cross along an edge: it is seen from everywhere. */
function addBar(triangle, part, [p, q], thickness) {
  const along = sub(q, p), x = unit(along), u = unit(cross(x, Math.abs(x[2]) < 0.9 ? [0, 0, 1] : [1, 0, 0]));
  const half = Math.max(thickness / 2, 0.05 * length(along));
  for (const side of [u, cross(x, u)]) {
    const [a, b, c, d] = [add(p, side, half), add(p, side, -half), add(q, side, -half), add(q, side, half)];
    triangle(part, a, b, c);
    triangle(part, a, c, d);
  }
}

/** The plane that the model stands on, with its shadow. */
export function groundOf(head, arrays) {
  const n = head.ground.points, shade = new Uint8Array(arrays.ground);
  const map = texture(shade, n, n, RedFormat, UnsignedByteType, LinearFilter);
  const plane = new PlaneGeometry(head.ground.size, head.ground.size);
  const material = new RawShaderMaterial({
    vertexShader: GROUND_VERTEX, fragmentShader: GROUND_FRAGMENT, glslVersion: GLSL3, transparent: true,
    depthWrite: false, side: FrontSide, uniforms: { shade: { value: map } },
  });
  const result = new Mesh(plane, material);
  result.position.set(...head.ground.middle);
  return result;
}
