// What is wrong with a model, part by part: on the page before anybody asks.

import { escapeText, number, plural } from "./text.js";

const MOST = 60; // of many, the table has the rest

export function missingMarkup(model) {
  const lines = model.missing.map((m) => `<li><b>${escapeText(m.id)}</b> ${escapeText(m.reason)}</li>`);
  return `<h3>Missing: ${plural(lines.length, "part")} that cannot be made</h3><ul>${lines.join("")}</ul>`;
}

/** Parts with errors, then those with notes, each with its worst finding; nothing without any. */
export function faultsMarkup(model) {
  const parts = Object.keys(model.findings).map(Number);
  if (!parts.length) return "";
  parts.sort((i, j) => model.worst[j] - model.worst[i] || i - j);
  const errors = parts.filter((i) => model.worst[i] === 2).length, notes = parts.length - errors;
  const lines = parts.slice(0, MOST).map((i) => {
    const [first, ...others] = model.findings[i], more = others.length ? ` <em>+${others.length}</em>` : "";
    return `<li class="${first.severity}"><button data-part="${i}"><b>${escapeText(model.ids[i])}</b> ${escapeText(first.message)}${more}</button></li>`;
  });
  const counts = [errors && `${plural(errors, "part")} with errors`, notes && `${plural(notes, "part")} with notes`].filter(Boolean).join(", ");
  const rest = parts.length > MOST ? `<button class="quiet" data-more>${number(parts.length - MOST)} more in the table</button>` : "";
  return `<h3>What is wrong: ${counts}</h3><ul>${lines.join("")}</ul>${rest}`;
}
