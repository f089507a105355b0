// The page: what people do, and what changes by it.

import { cardMarkup, spoken } from "./card.js";
import { BINS, colorModes, legendMarkup, partColors, passes, scaleOf } from "./colors.js";
import { PartList } from "./list.js";
import { locate, Measure } from "./measure.js";
import { findPart, makeModel } from "./model.js";
import { paint } from "./painter.js";
import { buildShapes } from "./shapes.js";
import { escapeText, number, plural } from "./text.js";
import { unpackModel } from "./unpack.js";
import { NAMED_VIEWS, View } from "./view.js";

const $ = (id) => document.getElementById(id);
const LAYERS = { panels: "Panels", edges: "Edges", beams: "Beams", nodes: "Nodes", axes: "Node axes", missing: "Missing" };

class Page {
  constructor(head, arrays) {
    this.model = makeModel(head);
    this.shapes = buildShapes(head, arrays);
    this.head = head;
    this.modes = colorModes(this.model);
    this.state = { color: this.modes[0].key, shading: 0, flat: "off", axis: "", depth: 0.5, explode: 0, part: -1, hidden: new Set(["axes"]) };
    this.filter = null;
    this.home = head.home;
    try {
      this.view = new View($("canvas"), head, arrays, this.shapes);
    } catch {
      this.view = null;
    }
    this.measure = this.view ? new Measure(this.view, $("measure"), head.size_mm) : null;
    if (this.view) this.view.drawn = () => this.measure.draw();
    this.list = new PartList($("table"), this.model, (part) => this.choose(part));
  }

  get mode() { return this.modes.find((mode) => mode.key === this.state.color); }

  start() {
    const { model } = this;
    $("title").querySelector("h1").textContent = model.title;
    $("title").querySelector("p").innerHTML = this.summary();
    $("color").innerHTML = this.modes.map((m) => `<option value="${m.key}">${escapeText(m.name)}</option>`).join("");
    if (model.count <= 3000) $("names").innerHTML = model.ids.map((id) => `<option value="${escapeText(id)}">`).join("");
    this.fillMissing();
    this.fillLayers();
    this.listen();
    $("app").classList.remove("loading");
    $("message").textContent = "";
    if (!this.view) this.paintInstead();
    this.view?.resize();
    this.readAddress();
    this.refresh();
    if (this.view && !this.placed) {
      this.view.fit(this.home);
      if (this.state.part >= 0) this.view.reveal(this.state.part);
    }
  }

  summary() {
    const { model } = this, worst = [...model.worst], errors = worst.filter((w) => w === 2).length;
    const texts = [plural(model.panels.id.length, "panel")];
    if (model.beams.id.length) texts.push(plural(model.beams.id.length, "beam"));
    if (model.moulds.length) texts.push(plural(model.moulds.length, "mould"));
    if (errors) texts.push(`<b>${plural(errors, "part")} with errors</b>`);
    if (model.missing.length) texts.push(`<b>${number(model.missing.length)} missing</b>`);
    return texts.join(" · ");
  }

  fillMissing() {
    const { missing } = this.model;
    $("missing").hidden = missing.length === 0;
    $("missing").innerHTML = "<h3>Missing</h3><ul>" + missing.map((m) => `<li><b>${escapeText(m.id)}</b> ${escapeText(m.reason)}</li>`).join("") + "</ul>";
  }

  fillLayers() {
    const { model } = this;
    const has = { panels: model.panels.id.length, edges: model.panels.id.length, beams: model.beams.id.length, nodes: model.nodes.id.length, axes: this.shapes.axes.size, missing: this.shapes.outlines.some((o) => o.length) };
    $("layers").querySelector(".checks").innerHTML = Object.entries(LAYERS).filter(([key]) => has[key])
      .map(([key, name]) => `<label><input type="checkbox" data-layer="${key}" checked>${name}</label>`).join("");
  }

  paintInstead() {
    $("app").classList.add("painted");
    $("message").textContent = "This browser shows no WebGL, so the model stands still. Colours, search and the table work; to turn it, allow hardware acceleration or open the page in another browser.";
    this.showTable(true);
  }

  listen() {
    const buttons = (id, change) => $(id).addEventListener("click", (event) => {
      const button = event.target.closest("button");
      if (button) change(button.dataset.value);
    });
    buttons("shading", (value) => this.set({ shading: Number(value) }));
    buttons("flat", (value) => this.set({ flat: value }));
    buttons("axis", (value) => this.set({ axis: value }));
    buttons("measuring", () => this.setMeasuring(!this.measure.on));
    buttons("views", (value) => { this.view.fit(NAMED_VIEWS[value] ?? this.home); this.writeAddress(); });
    $("color").addEventListener("change", (event) => this.set({ color: event.target.value }, true));
    $("depth").addEventListener("input", (event) => this.set({ depth: event.target.value / 1000 }));
    $("explode").addEventListener("input", (event) => this.set({ explode: event.target.value / 1000 }));
    $("layers").addEventListener("change", (event) => {
      const hidden = new Set(this.state.hidden);
      if (event.target.checked) hidden.delete(event.target.dataset.layer);
      else hidden.add(event.target.dataset.layer);
      this.set({ hidden });
    });
    $("all").addEventListener("click", () => { this.filter = null; this.refresh(); });
    $("search").addEventListener("submit", (event) => { event.preventDefault(); this.find(); });
    $("search").addEventListener("input", () => $("search").querySelector("input").classList.remove("unknown"));
    $("search").addEventListener("change", () => this.find());
    $("listing").addEventListener("click", () => this.showTable($("table").hidden));
    $("card").addEventListener("click", (event) => this.cardClick(event));
    this.listenScale();
    if (this.view) this.listenPicture();
    document.addEventListener("keydown", (event) => this.key(event));
    window.addEventListener("hashchange", () => this.readAddress());
    new ResizeObserver(() => (this.view ? this.view.resize() : this.refresh())).observe($("stage"));
  }

  listenPicture() {
    const canvas = $("canvas");
    let down = null;
    canvas.addEventListener("pointerdown", (event) => { down = event.isPrimary ? [event.clientX, event.clientY] : null; });
    canvas.addEventListener("pointerup", (event) => {
      const box = canvas.getBoundingClientRect();
      if (down && Math.hypot(event.clientX - down[0], event.clientY - down[1]) < 5) {
        this.tap(event.clientX - box.left, event.clientY - box.top);
      }
      down = null;
    });
    this.view.controls.addEventListener("end", () => this.writeAddress());
    const handle = $("divider").querySelector("i");
    handle.addEventListener("pointerdown", (event) => handle.setPointerCapture(event.pointerId));
    handle.addEventListener("pointermove", (event) => {
      const box = $("stage").getBoundingClientRect();
      if (handle.hasPointerCapture(event.pointerId)) this.moveDivider((event.clientX - box.left) / box.width);
    });
    handle.addEventListener("keydown", (event) => {
      const step = { ArrowLeft: -0.02, ArrowRight: 0.02 }[event.key];
      if (step) { event.stopPropagation(); this.moveDivider(this.view.swipe + step); }
    });
  }

  /** A click or a touch of the picture: a part, or an end of a distance. */
  tap(x, y) {
    if (!this.measure.on) {
      this.select(this.view.pick(x, y));
      return;
    }
    this.measure.take(locate(this.view, x, y));
    if (this.measure.distance !== null) $("spoken").textContent = this.measure.text().join("; ");
    this.writeAddress();
  }

  /** Parts that are drawn apart are not where they are: there is nothing to measure. */
  setMeasuring(on) {
    this.measure.on = on && !this.state.explode;
    if (!this.measure.on) this.measure.points = [];
    $("measuring").firstElementChild.setAttribute("aria-pressed", String(this.measure.on));
    $("stage").classList.toggle("measuring", this.measure.on);
    this.measure.draw();
    this.writeAddress();
  }

  moveDivider(share) {
    this.view.swipe = Math.min(0.98, Math.max(0.02, share));
    $("divider").style.left = `${100 * this.view.swipe}%`;
    $("divider").querySelector("i").setAttribute("aria-valuenow", Math.round(100 * this.view.swipe));
    this.view.draw();
  }

  /** Kinds are chosen by a click, a range of the histogram by a drag. */
  listenScale() {
    const scale = $("scale");
    scale.addEventListener("click", (event) => {
      const kind = event.target.closest("[data-kind]")?.dataset.kind;
      if (kind) this.toggleKind(kind);
    });
    let from = null;
    const share = (event) => {
      const box = scale.getBoundingClientRect();
      return Math.min(1, Math.max(0, (event.clientX - box.left) / box.width));
    };
    const choose = (event) => {
      const bin = (s) => Math.min(BINS - 1, Math.floor(s * BINS));
      const [low, high] = [bin(from), bin(share(event))].sort((a, b) => a - b);
      this.filter = { range: [low / BINS, (high + 1) / BINS] };
      this.refresh();
    };
    scale.addEventListener("pointerdown", (event) => {
      if (!this.mode.values || !event.target.closest("svg")) return;
      from = share(event);
      scale.setPointerCapture(event.pointerId);
      choose(event);
    });
    scale.addEventListener("pointermove", (event) => { if (from !== null) choose(event); });
    scale.addEventListener("pointerup", () => { from = null; });
  }

  toggleKind(kind) {
    const kinds = new Set(this.filter?.kinds ?? []);
    if (kinds.has(kind)) kinds.delete(kind);
    else kinds.add(kind);
    this.filter = kinds.size ? { kinds } : null;
    this.refresh();
  }

  cardClick(event) {
    const part = event.target.closest("[data-part]"), mould = event.target.closest("[data-mould]");
    if (event.target.closest(".close")) this.select(-1);
    else if (part) this.choose(Number(part.dataset.part));
    else if (mould) {
      this.state.color = "mould";
      this.filter = { kinds: new Set([mould.dataset.mould]) };
      this.refresh();
    }
  }

  key(event) {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (event.key === "Escape") {
      document.activeElement?.blur();
      if (this.measure?.on) this.setMeasuring(false);
      else this.select(-1);
      return;
    }
    if (event.target.closest?.("input, select, [role=slider]")) return;
    const turn = { ArrowLeft: [-0.08, 0], ArrowRight: [0.08, 0], ArrowUp: [0, 0.06], ArrowDown: [0, -0.06] }[event.key];
    const act = { "[": () => this.step(-1), "]": () => this.step(1), "/": () => $("search").querySelector("input").focus(),
      f: () => this.view?.fit(this.home), m: () => this.view && this.setMeasuring(!this.measure.on), t: () => this.showTable($("table").hidden) }[event.key.toLowerCase()];
    if (turn && this.view && !event.target.closest?.("#table, #side")) this.view.orbit(...turn);
    else if (act) act();
    else return;
    event.preventDefault();
    this.writeAddress();
  }

  /** The next panel among those that the filter leaves. */
  step(by) {
    const left = this.left().filter((i) => i < this.model.panels.id.length).sort((a, b) => a - b);
    if (!left.length) return;
    const after = left.findIndex((i) => i > this.state.part), place = left.indexOf(this.state.part);
    const start = place >= 0 ? place + by : by > 0 ? (after < 0 ? 0 : after) : (after < 0 ? left.length : after) - 1;
    this.choose(left[(start + left.length) % left.length]);
  }

  left() {
    const { mode, filter, model } = this, count = model.panels.id.length;
    const scale = mode.values ? scaleOf(mode) : null, found = [];
    for (let i = 0; i < model.count; i++) if (passes(mode, filter, i, count, scale)) found.push(i);
    return found;
  }

  find() {
    const input = $("search").querySelector("input");
    if (!input.value.trim()) return;
    const part = findPart(this.model, input.value);
    input.classList.toggle("unknown", part < 0);
    if (part >= 0) this.choose(part);
    else $("spoken").textContent = `There is no part ${input.value}.`;
  }

  set(changes, clear = false) {
    Object.assign(this.state, changes);
    if (clear) this.filter = null;
    this.refresh();
  }

  /** Select a part by its name, and turn the model until it is seen. */
  choose(part) {
    this.view?.reveal(part);
    this.select(part);
  }

  select(part) {
    this.state.part = part;
    $("card").hidden = part < 0;
    if (part >= 0) {
      $("card").innerHTML = cardMarkup(this.model, part);
      $("spoken").textContent = spoken(this.model, part);
    }
    this.view?.select(part);
    this.list.select(part);
    this.writeAddress();
  }

  showTable(open) {
    $("table").hidden = !open;
    $("listing").setAttribute("aria-expanded", String(open));
    if (open) {
      this.list.show(this.left());
      this.list.select(this.state.part);
    }
  }

  refresh() {
    const { state, view, mode } = this;
    $("color").value = state.color;
    $("scale").innerHTML = legendMarkup(mode, this.filter, this.model);
    $("all").hidden = !this.filter;
    for (const id of ["shading", "flat", "axis"]) {
      for (const button of $(id).children) button.setAttribute("aria-pressed", String(button.dataset.value === String(state[id])));
    }
    for (const box of $("layers").querySelectorAll("input")) box.checked = !state.hidden.has(box.dataset.layer);
    $("depth").disabled = !state.axis;
    $("depth").value = Math.round(1000 * state.depth);
    $("explode").value = Math.round(1000 * state.explode);
    const size = 1024 * Math.ceil(Math.max(1, this.shapes.centers.length) / 1024) * 4;
    const colors = partColors(mode, this.filter, this.model, size);
    if (view) this.refreshView(colors);
    else paint($("canvas"), this.shapes, colors, this.home);
    if (!$("table").hidden) this.list.show(this.left());
    this.writeAddress();
  }

  refreshView(colors) {
    const { state, view } = this, { uniforms } = view;
    uniforms.shading.value = state.shading;
    uniforms.explode.value = state.explode;
    if (state.explode && this.measure.on) this.setMeasuring(false);
    $("measuring").firstElementChild.disabled = state.explode > 0;
    uniforms.cuts.value = state.axis !== "";
    const k = "xyz".indexOf(state.axis), { low, high } = this.head;
    if (k >= 0) {
      const n = [0, 0, 0];
      // The nearer part goes: one looks into the section.
      const sign = this.home[k] < 0 ? -1 : 1;
      n[k] = sign;
      const place = sign > 0 ? high[k] - state.depth * (high[k] - low[k]) : low[k] + state.depth * (high[k] - low[k]);
      uniforms.plane.value.set(...n, sign * place);
    }
    for (const layer of Object.keys(LAYERS)) view.visible[layer] = !state.hidden.has(layer);
    view.flat = state.flat;
    $("divider").hidden = state.flat !== "swipe";
    if (state.flat === "swipe") this.moveDivider(view.swipe);
    view.setColors(colors);
  }

  /** The state in the address: a link shows what its sender saw. */
  writeAddress() {
    clearTimeout(this.later);
    this.later = setTimeout(() => {
      const { state, view, model } = this, words = new URLSearchParams();
      if (state.color !== this.modes[0].key) words.set("color", state.color);
      if (state.shading) words.set("light", ["daylight", "zebra", "lamps"][state.shading]);
      if (state.flat !== "off") words.set("panels", state.flat);
      const hidden = [...state.hidden].filter((key) => key !== "axes");
      if (hidden.length) words.set("hide", hidden.join(" "));
      if (!state.hidden.has("axes")) words.set("show", "axes");
      if (this.measure?.points.length) words.set("measure", this.measure.points.flat().map((v) => v.toFixed(6)).join(" "));
      if (state.axis) words.set("cut", `${state.axis} ${state.depth}`);
      if (state.explode) words.set("apart", state.explode);
      if (state.part >= 0) words.set("part", model.ids[state.part]);
      if (this.filter?.kinds) words.set("only", [...this.filter.kinds].join(" "));
      if (this.filter?.range) words.set("only", this.filter.range.map((v) => v.toFixed(4)).join(" "));
      if (view) {
        const places = [...view.camera.position.toArray(), ...view.controls.target.toArray()];
        words.set("eye", places.map((v) => v.toFixed(4)).join(" "));
      }
      this.written = `#${words}`;
      try { history.replaceState(null, "", this.written); } catch { /* a sandboxed frame has no address */ }
    }, 250);
  }

  readAddress() {
    if (location.hash.length < 2 || location.hash === this.written) return;
    const words = new URLSearchParams(location.hash.slice(1)), { state, view } = this;
    const get = (name, known) => (known.includes(words.get(name)) ? words.get(name) : null);
    state.color = get("color", this.modes.map((m) => m.key)) ?? this.modes[0].key;
    state.shading = Math.max(0, ["daylight", "zebra", "lamps"].indexOf(words.get("light")));
    state.flat = get("panels", ["off", "swipe", "on"]) ?? "off";
    state.hidden = new Set((words.get("hide") ?? "").split(" ").filter((key) => key in LAYERS));
    if (words.get("show") !== "axes") state.hidden.add("axes");
    const ends = (words.get("measure") ?? "").split(" ").map(Number);
    if (this.measure && ends.length % 3 === 0 && ends.every(Number.isFinite)) {
      this.setMeasuring(true);
      this.measure.points = [ends.slice(0, 3), ends.slice(3, 6)].filter((p) => p.length);
    }
    const [axis, depth] = (words.get("cut") ?? "").split(" ");
    state.axis = ["x", "y", "z"].includes(axis) ? axis : "";
    state.depth = within(Number(depth), 0.5);
    state.explode = within(Number(words.get("apart")), 0);
    this.readFilter(words.get("only"));
    const eye = (words.get("eye") ?? "").split(" ").map(Number);
    if (view && eye.length === 6 && eye.every(Number.isFinite)) {
      view.camera.position.set(...eye.slice(0, 3));
      view.controls.target.set(...eye.slice(3));
      view.controls.update();
      this.placed = true;
      view.fitted = null;
    }
    this.refresh();
    this.select(words.has("part") ? findPart(this.model, words.get("part")) : -1);
  }

  readFilter(text) {
    this.filter = null;
    if (!text) return;
    const range = text.split(" ").map(Number);
    if (this.mode.values && range.length === 2 && range.every(Number.isFinite)) this.filter = { range };
    const known = (this.mode.kinds ?? []).map((kind) => kind.key);
    const kinds = text.split(" ").filter((key) => known.includes(key));
    if (!this.mode.values && kinds.length) this.filter = { kinds: new Set(kinds) };
  }
}

const within = (value, otherwise) => (Number.isFinite(value) && value >= 0 && value <= 1 ? value : otherwise);

unpackModel("model").then(async ([head, arrays]) => {
  const page = new Page(head, arrays);
  page.start();
  window.spheremesh = page;
  await page.view?.drawFirst();
  document.documentElement.dataset.ready = "";
  performance.mark("ready");
}).catch((error) => {
  $("message").textContent = `The model cannot be shown: ${error.message}.`;
});
