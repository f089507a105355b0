// The page: its state, and what changes by it.

import { addressOf, LAYERS, showAddress } from "./address.js";
import { cardMarkup, spoken } from "./card.js";
import { colorModes, legendMarkup, partColors, passes, scaleOf } from "./colors.js";
import { faultKinds, faultsMarkup } from "./faults.js";
import { listen } from "./listeners.js";
import { PartList } from "./list.js";
import { locate, Measure, nameOf } from "./measure.js";
import { ERROR, findPart, kindOf, makeModel, REJECTED } from "./model.js";
import { paint } from "./painter.js";
import { buildShapes } from "./shapes.js";
import { escapeText, number, plural } from "./text.js";
import { View } from "./view.js";

const $ = (id) => document.getElementById(id);

export class Page {
  constructor(head, arrays) {
    this.model = makeModel(head);
    this.shapes = buildShapes(head, arrays);
    this.head = head;
    this.modes = colorModes(this.model);
    this.faults = faultKinds(this.model);
    this.state = { color: this.modes[0].key, shading: 0, flat: "off", axis: "", depth: 0.5, explode: 0, part: -1, hidden: new Set(["axes"]) };
    this.filter = null;
    this.home = head.home;
    try {
      this.view = new View($("canvas"), head, arrays, this.shapes);
      this.view.ready = false; // until `drawFirst` has drawn
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
    this.fillLayers();
    listen(this);
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
    const { model } = this, texts = [];
    for (const kind of ["panel", "beam"]) {
      const all = model.ids.map((_, i) => i).filter((i) => kindOf(model, i) === kind);
      if (!all.length) continue;
      const wrong = [["rejected", REJECTED, "missing"], ["error", ERROR, "with errors"]].map(([key, worst, words]) => {
        const count = all.filter((i) => model.worst[i] === worst).length;
        return count && `<button data-worst="${key}" data-of="${kind}">${number(count)} ${words}</button>`;
      }).filter(Boolean);
      texts.push(plural(all.length, kind) + (wrong.length ? `: ${wrong.join(", ")}` : ""));
    }
    if (model.moulds.length) texts.push(plural(model.moulds.length, "mould"));
    return texts.join("; ");
  }

  fillFaults() {
    const chosen = this.filter?.fault, root = $("faults"), list = root.firstElementChild && root.querySelector("ul");
    if (list && chosen === this.shownFault) return;
    const top = list?.scrollTop ?? 0, focused = root.contains(document.activeElement) && document.activeElement.dataset.fault;
    root.innerHTML = faultsMarkup(this.model, this.faults, chosen);
    root.hidden = !this.faults.length;
    this.shownFault = chosen;
    // Whoever reads or types there stays there.
    if (list) root.querySelector("ul").scrollTop = top;
    if (focused) [...root.querySelectorAll("[data-fault]")].find((row) => row.dataset.fault === focused).focus();
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

  /** A click or a touch of the picture: a part, or an end of a distance. */
  tap(x, y) {
    if (!this.measure.on) {
      this.select(this.view.pick(x, y));
      return;
    }
    this.measure.take(locate(this.view, x, y));
    this.showHint();
    if (this.measure.distance !== null) $("spoken").textContent = this.measure.text().join("; ");
    this.writeAddress();
  }

  /** The corner that a click would take gets a ring. */
  aim(x, y) {
    cancelAnimationFrame(this.aiming);
    this.aiming = requestAnimationFrame(() => this.measure.aim(locate(this.view, x, y)));
  }

  /** What is to be clicked next, and what was taken. */
  showHint() {
    const { on, points } = this.measure, names = points.map((p) => nameOf(this.shapes, this.model, p));
    $("hint").hidden = !on;
    $("hint").textContent = [
      "Click the first corner or point", `From ${names[0]}: click the second corner or point`, `From ${names[0]} to ${names[1]}`,
    ][points.length];
  }

  /** Parts that are drawn apart are not where they are: there is nothing to measure. */
  setMeasuring(on) {
    this.measure.on = on && !this.state.explode;
    if (!this.measure.on) this.measure.points = [];
    $("measuring").firstElementChild.setAttribute("aria-pressed", String(this.measure.on));
    $("stage").classList.toggle("measuring", this.measure.on);
    this.measure.aimed = null;
    this.showHint();
    this.measure.draw();
    this.writeAddress();
  }

  moveDivider(share) {
    this.view.swipe = Math.min(0.98, Math.max(0.02, share));
    $("divider").style.left = `${100 * this.view.swipe}%`;
    $("divider").querySelector("i").setAttribute("aria-valuenow", Math.round(100 * this.view.swipe));
    this.view.draw();
  }

  toggleKind(kind) {
    const kinds = new Set(this.filter?.kinds ?? []);
    if (kinds.has(kind)) kinds.delete(kind);
    else kinds.add(kind);
    this.filter = kinds.size ? { kinds } : null;
    this.refresh();
  }

  /** Only the parts of some kinds, in their colours. */
  showKinds(color, ...kinds) {
    this.state.color = color;
    this.filter = { kinds: new Set(kinds) };
    this.refresh();
  }

  /** Only the parts on which something of a kind was found; all again if they are chosen. */
  showFault(key) {
    const kind = this.faults.find((each) => each.key === key);
    if (!kind || this.filter?.fault === key) this.filter = null;
    else {
      this.state.color = "finding";
      this.filter = { fault: key, parts: kind.parts };
    }
    this.refresh();
  }

  /** Only panels, or beams, that are missing or have errors; of missing ones the first is shown. */
  showWorst(key, kind) {
    const worst = key === "rejected" ? REJECTED : ERROR, parts = new Set();
    this.model.worst.forEach((w, i) => { if (w === worst && kindOf(this.model, i) === kind) parts.add(i); });
    this.state.color = "finding";
    this.filter = { parts };
    this.refresh();
    if (worst === REJECTED) this.choose(Math.min(...parts));
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
    if (part >= 0) {
      this.choose(part);
      return;
    }
    const text = input.value.trim();
    this.select(-1);
    input.value = text;
    input.classList.add("unknown");
    $("unknown").textContent = `No part ${text}`;
  }

  set(changes, clear = false) {
    Object.assign(this.state, changes);
    if (clear) this.filter = null;
    this.refresh();
  }

  /** Select a part by its name, and turn the model until it is seen. */
  choose(part) {
    const hidden = new Set(this.state.hidden);
    if (part < this.shapes.parts && hidden.delete("panels")) this.set({ hidden });
    if (this.view?.isCut(part)) this.set({ axis: "" });
    this.view?.reveal(part);
    this.select(part);
  }

  select(part) {
    this.state.part = part;
    const input = $("search").querySelector("input");
    input.value = part < 0 ? "" : this.model.ids[part];
    input.classList.remove("unknown");
    $("unknown").textContent = "";
    $("card").hidden = part < 0;
    if (part >= 0) {
      $("card").innerHTML = cardMarkup(this.model, part);
      $("spoken").textContent = spoken(this.model, part);
      // The card stands under the search.
      $("search").scrollIntoView({ block: "nearest" });
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
    this.fillFaults();
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
    uniforms.marked.value = Boolean(this.filter);
    view.setColors(colors);
  }

  writeAddress() {
    clearTimeout(this.later);
    this.later = setTimeout(() => {
      this.written = addressOf(this);
      try { history.replaceState(null, "", this.written); } catch { /* a sandboxed frame has no address */ }
    }, 250);
  }

  readAddress() {
    if (location.hash.length > 1 && location.hash !== this.written) showAddress(this, location.hash);
  }
}
