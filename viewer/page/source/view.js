// The picture: what is drawn, from where, and which part is under the pointer.

import { DoubleSide, FrontSide, PerspectiveCamera, Scene, Vector3, WebGLRenderer, WebGLRenderTarget } from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { cameraThatFits, FIELD, sidewards } from "./cameras.js";
import { ghostsOf, groundOf, linesOf, makeUniforms, meshGeometry, meshOf, surfaceTexture } from "./scene.js";
import { addTouchingWalls, outward, sizeOf } from "./shapes.js";
import { add, cross, dot, length, scale, sub, unit } from "./vectors.js";

const MANY = 2000;
const AROUND = 2.6; // sizes of a part that are seen around it

export class View {
  constructor(canvas, head, arrays, shapes) {
    this.canvas = canvas;
    this.renderer = new WebGLRenderer({ canvas, antialias: true, alpha: true, preserveDrawingBuffer: true });
    this.renderer.setPixelRatio(Math.min(2, window.devicePixelRatio || 1));
    this.renderer.setClearColor(0xffffff, 0);
    this.scene = new Scene();
    this.camera = new PerspectiveCamera(FIELD, 1, 0.02, 60);
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.enableDamping = false;
    this.controls.minDistance = 0.02;
    this.controls.maxDistance = 20;
    this.controls.addEventListener("change", () => this.draw());
    this.fitted = null;
    this.controls.addEventListener("start", () => { this.fitted = null; });
    this.flat = "off";
    this.swipe = 0.5;
    this.visible = { panels: true, edges: true, beams: true, nodes: true, axes: false, missing: true };
    this.ready = true;
    this.target = new WebGLRenderTarget(1, 1);
    this.pending = 0;
    this.load(head, arrays, shapes);
  }

  /** Show a model; one that was shown before makes room, and the camera stays where it is. */
  load(head, arrays, shapes) {
    this.clear();
    this.shapes = shapes;
    const parts = shapes.centers.length;
    this.colorData = new Uint8Array(1024 * Math.ceil(Math.max(1, parts) / 1024) * 4).fill(255);
    this.uniforms = makeUniforms(shapes, this.colorData);
    this.edge = meanEdge(shapes.corners);
    this.build(head, arrays);
    this.draw();
  }

  /** Give back what the graphics hold of the present model. */
  clear() {
    for (const each of [...this.scene.children]) {
      this.scene.remove(each);
      each.geometry.dispose();
      for (const { value } of Object.values(each.material.uniforms)) if (value?.isTexture) value.dispose();
      each.material.dispose();
    }
  }

  /** Give back all: nothing is drawn here any more. */
  dispose() {
    cancelAnimationFrame(this.pending);
    this.pending = -1;
    this.clear();
    this.target.dispose();
    this.controls.dispose();
    this.renderer.dispose();
  }

  build(head, arrays) {
    const { shapes, uniforms } = this, mesh = (soup, solid) => meshOf(soup, uniforms, solid);
    this.meshes = {
      panels: mesh(shapes.panels, head.solid), walls: mesh(shapes.walls, head.solid), flat: mesh(shapes.flat, false),
      beams: mesh(shapes.beams, true), nodes: mesh(shapes.nodes, true),
    };
    this.lines = linesOf(shapes, uniforms);
    this.marked = this.lines.marked.material;
    this.ghosts = ghostsOf(shapes, this.meshes, head.beam_thickness, uniforms);
    this.ground = groundOf(head, arrays);
    // In this order: what hides most comes first, and what it hides is not shaded.
    this.renderer.sortObjects = false;
    for (const each of [this.ground, ...Object.values(this.meshes), ...Object.values(this.lines), ...Object.values(this.ghosts)]) {
      each.frustumCulled = false;
      this.scene.add(each);
    }
  }

  /** Walls that touch, when they are first seen. */
  buildWalls() {
    const { shapes, uniforms, meshes } = this;
    addTouchingWalls(shapes);
    uniforms.surfaces.value.dispose();
    uniforms.surfaces.value = surfaceTexture(shapes);
    meshes.walls.geometry.dispose();
    meshes.walls.geometry = meshGeometry(shapes.walls);
  }

  setColors(colors) {
    this.colorData.set(colors);
    this.uniforms.colors.value.needsUpdate = true;
    this.draw();
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.canvas.parentElement;
    if (this.size === `${width} ${height}`) return;
    this.size = `${width} ${height}`;
    this.renderer.setSize(width, height);
    this.camera.aspect = width / Math.max(1, height);
    this.camera.updateProjectionMatrix();
    // What was made to fit fits again; who has turned the model keeps the view.
    if (this.fitted) this.fit(this.fitted);
    // At once: whoever prints the page does not wait.
    if (this.ready) this.drawNow();
  }

  /** Look at the whole model from a direction. */
  fit(direction) {
    this.fitted = direction;
    this.stand(this.shapes.corners.length ? this.shapes.corners.flat() : this.shapes.centers, direction);
  }

  /** Look at points from a direction, as near as they allow. */
  stand(points, direction) {
    const [eye, target] = cameraThatFits(points, direction, this.camera.aspect, this.freeSides());
    this.camera.position.set(...eye);
    this.controls.target.set(...target);
    this.controls.update();
    this.draw();
  }

  /** What share of each half of the canvas is left free by title and tools. */
  freeSides() {
    const { clientWidth: width, clientHeight: height } = this.canvas.parentElement;
    const share = (pixels, side, most) => 1 - 2 * Math.min(most, pixels / Math.max(1, side));
    const across = share(34, width, 0.06);
    return { left: across, right: across, below: share(84, height, 0.17), above: share(92, height, 0.19) };
  }

  /** Turn about what is looked at, by angles to the left and upwards. */
  orbit(left, upward) {
    this.fitted = null;
    const away = this.camera.position.clone().sub(this.controls.target), r = away.length();
    const turn = Math.atan2(away.y, away.x) - left;
    const rise = Math.max(-1.55, Math.min(1.55, Math.asin(away.z / r) + upward));
    away.set(Math.cos(turn) * Math.cos(rise), Math.sin(turn) * Math.cos(rise), Math.sin(rise));
    this.camera.position.copy(this.controls.target).addScaledVector(away, r);
    this.controls.update();
    this.draw();
  }

  /** The middle of a part where it is drawn, apart from others or not. */
  placeOf(part) {
    const { centers, lifts } = this.shapes, moved = add(scale(centers[part], 0.4), lifts[part], 0.07);
    return add(centers[part], moved, this.uniforms.explode.value);
  }

  /** Whether a section has taken the middle of a part away. */
  isCut(part) {
    const { cuts, plane } = this.uniforms;
    return cuts.value && dot(this.placeOf(part), plane.value.toArray()) > plane.value.w;
  }

  /** Look at a part from its outside, from where nothing hides it. */
  reveal(part) {
    const { shapes } = this, middle = shapes.centers[part], size = sizeOf(shapes, part) ?? this.edge / 2;
    // Nobody knows where it would be.
    if (part >= shapes.total && !shapes.outlines[part - shapes.total].length) return;
    this.fitted = null;
    const at = this.placeOf(part);
    const points = [0, 1, 2].flatMap((k) => [-1, 1].map((s) => at.map((c, j) => c + (j === k ? AROUND * s * size : 0))));
    const probes = [at, ...(shapes.corners[part] ?? []).map((c) => add(at, sub(c, middle), 0.6))];
    let best = null, most = -1;
    for (const direction of sidewards(outward(shapes, part))) {
      this.stand(points, direction);
      // What lies under panels, or is missing, is drawn through them.
      if (part >= shapes.parts) return;
      const seen = probes.filter((p) => this.pick(...this.project(p)) === part).length;
      if (seen > most) [best, most] = [direction, seen];
      if (seen === probes.length) return;
    }
    this.stand(points, best);
  }

  draw() {
    if (!this.pending) this.pending = requestAnimationFrame(() => this.drawNow());
  }

  /** A coarse picture at once, a fine one when that has been shown. */
  async drawFirst() {
    this.ready = false;
    const next = () => new Promise((done) => { requestAnimationFrame(done); });
    const ratio = this.renderer.getPixelRatio(), { beams, nodes } = this.visible;
    this.renderer.setPixelRatio(ratio / 2);
    // Below many panels little is seen of what carries them.
    if (this.shapes.parts > MANY) Object.assign(this.visible, { beams: false, nodes: false });
    this.drawNow();
    Object.assign(this.visible, { beams, nodes });
    await next();
    setTimeout(() => {
      this.ready = true;
      this.renderer.setPixelRatio(ratio);
      this.draw();
    }, 150);
  }

  drawNow() {
    cancelAnimationFrame(this.pending);
    this.pending = 0;
    this.light();
    const { renderer } = this, size = this.canvas.parentElement;
    const width = size.clientWidth, height = size.clientHeight;
    renderer.setScissorTest(this.flat === "swipe");
    if (this.flat === "swipe") {
      const middle = Math.round(this.swipe * width);
      renderer.setScissor(0, 0, middle, height);
      this.show(true);
      renderer.render(this.scene, this.camera);
      renderer.setScissor(middle, 0, width - middle, height);
      this.show(false);
    } else {
      this.show(this.flat === "on");
    }
    renderer.render(this.scene, this.camera);
    this.drawn?.();
  }

  show(flat) {
    const { meshes, lines, visible } = this;
    meshes.panels.visible = visible.panels && !flat;
    // Walls that touch are seen in a section, or where parts stand apart.
    const open = this.uniforms.cuts.value || this.uniforms.explode.value > 0;
    if (open && this.shapes.touching.length) this.buildWalls();
    meshes.walls.visible = meshes.panels.visible && open;
    meshes.flat.visible = visible.panels && flat;
    lines.edges.visible = visible.panels && visible.edges && !flat;
    lines.flatEdges.visible = visible.panels && visible.edges && flat;
    lines.marked.visible = visible.panels && this.marked.uniforms.only.value >= 0 && !flat;
    lines.missing.visible = visible.missing;
    lines.axes.visible = visible.axes;
    const { selected, marked } = this.uniforms, { parts, total } = this.shapes;
    this.ghosts.missing.visible = selected.value >= total || marked.value;
    this.ghosts.beams.visible = this.ghosts.nodes.visible = selected.value >= parts && selected.value < total;
    meshes.beams.visible = visible.beams;
    meshes.nodes.visible = visible.nodes;
    this.ground.visible = this.uniforms.explode.value === 0;
    // Of closed things backs are seen in a section only.
    for (const mesh of [meshes.panels, meshes.walls, meshes.beams, meshes.nodes]) {
      const { solid, cuts } = mesh.material.uniforms;
      mesh.material.side = solid.value && !cuts.value ? FrontSide : DoubleSide;
    }
  }

  /** The sun stands behind the viewer, at the upper left. */
  light() {
    const { camera, uniforms } = this;
    camera.updateMatrixWorld();
    const e = camera.matrixWorld.elements;
    const right = [e[0], e[1], e[2]], back = [e[8], e[9], e[10]];
    const level = unit(add([back[0], back[1], 0], [right[0], right[1], 0], -1.1));
    uniforms.eye.value.copy(camera.position);
    // Small panels get paler edges, lest the picture turns grey.
    const focal = this.canvas.parentElement.clientHeight / (2 * Math.tan((FIELD * Math.PI) / 360));
    const pixels = (this.edge * focal) / camera.position.distanceTo(this.controls.target);
    this.lines.edges.material.uniforms.ink.value.w = 0.42 * Math.min(1, 0.1 + pixels / 26);
    this.lines.flatEdges.material.uniforms.ink.value.w = this.lines.edges.material.uniforms.ink.value.w;
    uniforms.right.value.set(...unit(right));
    uniforms.back.value.set(...unit(cross(unit(right), [0, 0, 1])));
    uniforms.sun.value.set(...unit(add(level, [0, 0, 1.15])));
  }

  /** The part under a point of the canvas; -1 for none. */
  pick(x, y) {
    const pixel = this.probe(x, y, 1);
    return pixel[3] ? pixel[0] + 256 * pixel[1] + 65536 * pixel[2] - 1 : -1;
  }

  /** Four bytes that a pixel tells: of its part (1), or its distance (2). */
  probe(x, y, what) {
    const { renderer, camera, scene, uniforms, target } = this;
    const { clientWidth: width, clientHeight: height } = this.canvas.parentElement;
    const flat = this.flat === "on" || (this.flat === "swipe" && x < this.swipe * width);
    this.light();
    this.show(flat);
    for (const each of [this.ground, ...Object.values(this.lines), ...Object.values(this.ghosts)]) each.visible = false;
    camera.setViewOffset(width, height, Math.floor(x), Math.floor(y), 1, 1);
    uniforms.picking.value = what;
    renderer.setScissorTest(false);
    renderer.setRenderTarget(target);
    renderer.clear();
    renderer.render(scene, camera);
    const pixel = new Uint8Array(4);
    renderer.readRenderTargetPixels(target, 0, 0, 1, 1, pixel);
    renderer.setRenderTarget(null);
    camera.clearViewOffset();
    uniforms.picking.value = 0;
    return pixel;
  }

  /** Direction from the eye through a point of the canvas. */
  ray(x, y) {
    const { clientWidth: width, clientHeight: height } = this.canvas.parentElement;
    this.camera.updateMatrixWorld();
    const far = new Vector3((2 * x) / width - 1, 1 - (2 * y) / height, 0.5).unproject(this.camera);
    return far.sub(this.camera.position).normalize().toArray();
  }

  /** Where a point of the model appears on the canvas. */
  project(point) {
    const { clientWidth: width, clientHeight: height } = this.canvas.parentElement;
    this.camera.updateMatrixWorld();
    const v = new Vector3(...point).project(this.camera);
    return [((v.x + 1) / 2) * width, ((1 - v.y) / 2) * height];
  }

  select(part) {
    this.uniforms.selected.value = part;
    this.marked.uniforms.only.value = part >= 0 && part < this.shapes.parts ? part : -1;
    this.draw();
  }
}

function meanEdge(polygons) {
  let sum = 0, count = 0;
  for (const corners of polygons) {
    corners.forEach((p, k) => { sum += length(sub(corners[(k + 1) % corners.length], p)); });
    count += corners.length;
  }
  return count ? sum / count : 1;
}
