// What people do with the page: clicks, drags, touches, keys.

import { NAMED_VIEWS } from "./cameras.js";
import { BINS } from "./colors.js";
import { copyLink, savePicture } from "./sharing.js";

const $ = (id) => document.getElementById(id);

export function listen(page) {
  listenControls(page);
  listenScale(page);
  listenCard(page);
  if (page.view) {
    listenPicture(page);
    listenDivider(page);
  }
  document.addEventListener("keydown", (event) => pressKey(page, event));
  window.addEventListener("hashchange", () => page.readAddress());
  new ResizeObserver(() => (page.view ? page.view.resize() : page.refresh())).observe($("stage"));
}

function listenControls(page) {
  const buttons = (id, change) => $(id).addEventListener("click", (event) => {
    const button = event.target.closest("button");
    if (button) change(button.dataset.value);
  });
  buttons("shading", (value) => page.set({ shading: Number(value) }));
  buttons("flat", (value) => page.set({ flat: value }));
  buttons("axis", (value) => page.set({ axis: value }));
  buttons("measuring", () => page.setMeasuring(!page.measure.on));
  buttons("views", (value) => { page.view.fit(NAMED_VIEWS[value] ?? page.home); page.writeAddress(); });
  $("color").addEventListener("change", (event) => page.set({ color: event.target.value }, true));
  $("depth").addEventListener("input", (event) => page.set({ depth: event.target.value / 1000 }));
  $("explode").addEventListener("input", (event) => page.set({ explode: event.target.value / 1000 }));
  $("layers").addEventListener("change", (event) => {
    const hidden = new Set(page.state.hidden);
    if (event.target.checked) hidden.delete(event.target.dataset.layer);
    else hidden.add(event.target.dataset.layer);
    page.set({ hidden });
  });
  $("all").addEventListener("click", () => { page.filter = null; page.refresh(); });
  $("search").addEventListener("submit", (event) => { event.preventDefault(); page.find(); });
  $("search").addEventListener("input", () => {
    $("search").querySelector("input").classList.remove("unknown");
    $("unknown").textContent = "";
  });
  $("search").addEventListener("change", () => page.find());
  buttons("sharing", async (value) => {
    $("shared").textContent = "";
    if (value === "print") window.print();
    else if (value === "save") savePicture(page, $("canvas"));
    else $("shared").textContent = await copyLink(page) ? "Copied. Send the file too." : "This browser does not let the page copy: take the address from above, and send the file too.";
  });
  $("listing").addEventListener("click", () => page.showTable($("table").hidden));
}

function listenPicture(page) {
  const canvas = $("canvas");
  let down = null;
  canvas.addEventListener("pointerdown", (event) => { down = event.isPrimary ? [event.clientX, event.clientY] : null; });
  canvas.addEventListener("pointerup", (event) => {
    const box = canvas.getBoundingClientRect();
    if (down && Math.hypot(event.clientX - down[0], event.clientY - down[1]) < 5) {
      page.tap(event.clientX - box.left, event.clientY - box.top);
    }
    down = null;
  });
  canvas.addEventListener("pointermove", (event) => {
    const box = canvas.getBoundingClientRect();
    if (page.measure.on && !event.buttons) page.aim(event.clientX - box.left, event.clientY - box.top);
  });
  page.view.controls.addEventListener("end", () => page.writeAddress());
}

function listenDivider(page) {
  const handle = $("divider").querySelector("i");
  handle.addEventListener("pointerdown", (event) => handle.setPointerCapture(event.pointerId));
  handle.addEventListener("pointermove", (event) => {
    const box = $("stage").getBoundingClientRect();
    if (handle.hasPointerCapture(event.pointerId)) page.moveDivider((event.clientX - box.left) / box.width);
  });
  handle.addEventListener("keydown", (event) => {
    const step = { ArrowLeft: -0.02, ArrowRight: 0.02 }[event.key];
    if (step) { event.stopPropagation(); page.moveDivider(page.view.swipe + step); }
  });
}

/** Kinds are chosen by a click, a range of the histogram by a drag. */
function listenScale(page) {
  const scale = $("scale");
  scale.addEventListener("click", (event) => {
    const kind = event.target.closest("[data-kind]")?.dataset.kind;
    if (kind) page.toggleKind(kind);
  });
  let from = null;
  const share = (event) => {
    const box = scale.getBoundingClientRect();
    return Math.min(1, Math.max(0, (event.clientX - box.left) / box.width));
  };
  const choose = (event) => {
    const bin = (s) => Math.min(BINS - 1, Math.floor(s * BINS));
    const [low, high] = [bin(from), bin(share(event))].sort((a, b) => a - b);
    page.filter = { range: [low / BINS, (high + 1) / BINS] };
    page.refresh();
  };
  scale.addEventListener("pointerdown", (event) => {
    if (!page.mode.values || !event.target.closest("svg")) return;
    from = share(event);
    scale.setPointerCapture(event.pointerId);
    choose(event);
  });
  scale.addEventListener("pointermove", (event) => { if (from !== null) choose(event); });
  scale.addEventListener("pointerup", () => { from = null; });
}

/** Parts and moulds that are named on the card, in the list of faults and in the title. */
function listenCard(page) {
  $("card").addEventListener("click", (event) => {
    const part = event.target.closest("[data-part]"), mould = event.target.closest("[data-mould]");
    if (event.target.closest(".close")) page.select(-1);
    else if (part) page.choose(Number(part.dataset.part));
    else if (mould) page.showKinds("mould", mould.dataset.mould);
  });
  $("faults").addEventListener("click", (event) => {
    const part = event.target.closest("[data-part]"), row = event.target.closest("[data-fault]");
    if (part) page.choose(Number(part.dataset.part));
    else if (row) page.showFault(row.dataset.fault);
    else if (event.target.closest("[data-more]")) page.showTable(true);
  });
  $("title").addEventListener("click", (event) => {
    const button = event.target.closest("button");
    if (button) page.showWorst(button.dataset.worst, button.dataset.of);
  });
}

function pressKey(page, event) {
  if (event.ctrlKey || event.metaKey || event.altKey) return;
  if (event.key === "Escape") {
    document.activeElement?.blur();
    if (page.measure?.on) page.setMeasuring(false);
    else page.select(-1);
    return;
  }
  if (event.target.closest?.("input, select, [role=slider]")) return;
  const turn = { ArrowLeft: [-0.08, 0], ArrowRight: [0.08, 0], ArrowUp: [0, 0.06], ArrowDown: [0, -0.06] }[event.key];
  const act = {
    "[": () => page.step(-1), "]": () => page.step(1), "/": () => $("search").querySelector("input").focus(),
    f: () => page.view?.fit(page.home), m: () => page.view && page.setMeasuring(!page.measure.on),
    t: () => page.showTable($("table").hidden),
  }[event.key.toLowerCase()];
  if (turn && page.view && !event.target.closest?.("#table, #side")) page.view.orbit(...turn);
  else if (act) act();
  else return;
  event.preventDefault();
  page.writeAddress();
}
