// The table of parts: real rows, sorted by a click, in step with the picture.

import { SEVERITIES } from "./model.js";
import { escapeText, number } from "./text.js";

const PAGE = 200;

const COLUMNS = [
  ["Part", (m, i) => i, (v, m) => escapeText(m.ids[v])],
  ["Mould", (m, i) => of(m, i, "mould"), number],
  ["Radius mm", (m, i) => of(m, i, "radius_mm"), number],
  ["Area m²", (m, i) => of(m, i, "area_m2"), number],
  ["Angle °", (m, i) => of(m, i, "angle_deg"), number],
  ["Off plane mm", (m, i) => of(m, i, "planarity_mm"), number],
  ["Neighbours", (m, i) => next(m, i), (v) => escapeText(v)],
  ["Findings", (m, i) => (m.findings[i] ?? []).map((f) => `${f.severity === "rejected" ? "cannot be made: " : ""}${f.message} (${f.code})`).join("; "), (v) => escapeText(v)],
];

const of = (model, i, key) => (i < model.panels.id.length ? model.panels[key][i] : null);

function next(model, i) {
  const p = model.panels.id.length, b = i - p;
  if (i >= model.made) return model.missing[i - model.made].beside.join(" ");
  const ids = i < p ? model.panels.neighbors[i] : b < model.beams.id.length ? model.beams.panels[b] : [];
  return ids.filter((k) => k !== null).map((k) => model.ids[k]).join(" ");
}

export class PartList {
  constructor(root, model, choose) {
    this.root = root;
    this.model = model;
    this.sort = [0, 1];
    this.first = 0;
    this.parts = [];
    this.selected = -1;
    root.addEventListener("click", (event) => {
      const head = event.target.closest("[data-sort]"), line = event.target.closest("tr[data-part]");
      const turn = event.target.closest("[data-turn]");
      if (head) this.sortBy(Number(head.dataset.sort));
      else if (turn) this.turn(Number(turn.dataset.turn));
      else if (line) choose(Number(line.dataset.part));
    });
    root.addEventListener("keydown", (event) => {
      const line = event.target.closest("tr[data-part]");
      if (line && (event.key === "Enter" || event.key === " ")) {
        event.preventDefault();
        choose(Number(line.dataset.part));
      }
    });
  }

  show(parts) {
    this.parts = parts;
    this.first = 0;
    this.order();
    this.draw();
  }

  sortBy(column) {
    this.sort = [column, this.sort[0] === column ? -this.sort[1] : 1];
    this.order();
    this.draw();
  }

  order() {
    const [column, sign] = this.sort, value = COLUMNS[column][1];
    const keys = new Map(this.parts.map((i) => [i, value(this.model, i)]));
    const last = (v) => v === null || v === "";
    this.parts.sort((i, j) => {
      const a = keys.get(i), b = keys.get(j);
      if (last(a) || last(b)) return Number(last(a)) - Number(last(b)) || i - j;
      return sign * (typeof a === "number" ? a - b : a < b ? -1 : a > b ? 1 : 0) || i - j;
    });
  }

  turn(step) {
    this.first = Math.max(0, Math.min(this.parts.length - 1, this.first + step * PAGE));
    this.draw();
  }

  select(part) {
    this.selected = part;
    if (this.root.hidden) return;
    const place = this.parts.indexOf(part);
    if (place >= 0 && (place < this.first || place >= this.first + PAGE)) {
      this.first = PAGE * Math.floor(place / PAGE);
      this.draw();
    }
    for (const line of this.root.querySelectorAll("tr[aria-selected=true]")) line.removeAttribute("aria-selected");
    const line = this.root.querySelector(`tr[data-part="${part}"]`);
    line?.setAttribute("aria-selected", "true");
    line?.scrollIntoView({ block: "nearest" });
  }

  draw() {
    if (this.root.hidden) return;
    const { model, parts, first } = this;
    const heads = COLUMNS.map(([name], k) => {
      const sorted = this.sort[0] === k ? (this.sort[1] > 0 ? "ascending" : "descending") : "none";
      return `<th scope="col" aria-sort="${sorted}"><button data-sort="${k}">${name}</button></th>`;
    }).join("");
    const lines = parts.slice(first, first + PAGE).map((i) => {
      const cells = COLUMNS.map(([, value, write], k) => {
        const text = write(value(model, i), model);
        return k ? `<td>${text}</td>` : `<th scope="row">${text}</th>`;
      }).join("");
      const worst = SEVERITIES[model.worst[i]];
      return `<tr tabindex="0" data-part="${i}" class="${worst}"${i === this.selected ? ' aria-selected="true"' : ""}>${cells}</tr>`;
    }).join("");
    const last = Math.min(parts.length, first + PAGE);
    const pages = parts.length > PAGE
      ? `<nav><button data-turn="-1" ${first ? "" : "disabled"}>Previous</button><span>${first + 1} to ${last} of ${parts.length}</span>`
        + `<button data-turn="1" ${last < parts.length ? "" : "disabled"}>Next</button></nav>`
      : "";
    this.root.innerHTML = `<div class="scroll"><table><caption>${parts.length} parts</caption><thead><tr>${heads}</tr></thead><tbody>${lines}</tbody></table></div>${pages}`;
  }
}
