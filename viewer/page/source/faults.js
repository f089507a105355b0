// What is wrong with a model, by kind of finding: on the page before anybody asks.

import { kindOf, SEVERITIES } from "./model.js";
import { escapeText, number, plural } from "./text.js";

const MOST = 60; // of many parts of a kind, the table has the rest
// Where less is worse.
const LEAST = /\b(sharper|shorter|less) than\b/;
const AMOUNT = /,? ?(?:\b(?:of|by|is only) )?(\d[\d.,e+]* (?:mm|degrees))\b/;

/** Findings of the same kind: their title, their parts, the worst of them and what is said of it. */
export function faultKinds(model) {
  const kinds = new Map();
  for (const [part, found] of Object.entries(model.findings)) {
    for (const each of found) {
      const title = titleOf(each.message), key = `${each.severity} ${each.code} ${title}`;
      if (!kinds.has(key)) kinds.set(key, { key, title, code: each.code, severity: each.severity, parts: new Set(), worst: null });
      const kind = kinds.get(key), entry = { ...each, part: Number(part) };
      kind.parts.add(entry.part);
      if (!kind.worst || isWorse(entry, kind.worst)) kind.worst = entry;
    }
  }
  const rank = (kind) => -SEVERITIES.indexOf(kind.severity);
  return [...kinds.values()].sort((a, b) => rank(a) - rank(b) || b.parts.size - a.parts.size);
}

/** Reasons of missing parts tell their size in words only. */
const sizeOf = ({ size, message }) => size ?? parseFloat(sentenceOf(message).match(AMOUNT)?.[1] ?? 0);

const isWorse = (one, other) => (LEAST.test(one.message) ? sizeOf(one) < sizeOf(other) : sizeOf(one) > sizeOf(other));

const sentenceOf = (message) => message.split(": ")[0];

/** What is found, without how much, on what and what to do: “a step to a neighbour”. */
function titleOf(message) {
  return sentenceOf(message).replace(AMOUNT, "").split(/, /)[0].replace(/ (panel|beam|node) [A-Z]\d+\b/, " a $1").trim();
}

/** How much, of the worst: “36.1 mm, more than 5”. */
function amountOf(message) {
  const sentence = sentenceOf(message), limit = sentence.split(/, /)[1];
  const amount = sentence.match(AMOUNT)?.[1] ?? "";
  return [amount, limit].filter(Boolean).join(", ");
}

/** Parts of the same kind by number: “268 panels”. */
function counted(model, parts) {
  const kinds = new Set([...parts].map((part) => kindOf(model, part)));
  return plural(parts.size, kinds.size === 1 ? [...kinds][0] : "part");
}

/** All kinds of findings, of the one that is chosen the parts by name; nothing without any. */
export function faultsMarkup(model, kinds, key) {
  if (!kinds.length) return "";
  const lines = kinds.map((kind) => {
    const { title, code, severity, parts, worst } = kind, chosen = key === kind.key;
    const amount = amountOf(worst.message), advice = worst.message.split(": ").slice(1).join(": ");
    const name = `<button class="part" data-part="${worst.part}">${escapeText(model.ids[worst.part])}</button>`;
    const example = parts.size === 1 ? name : `${amount ? "worst" : "such as"} ${name}`;
    return `<li class="${severity}"><button class="row" data-fault="${escapeText(kind.key)}" aria-pressed="${chosen}">`
      + `${escapeText(title)}: <b>${counted(model, parts)}</b></button> `
      + `<span>${example}${amount ? `: ${escapeText(amount)}` : ""}${advice ? `. ${escapeText(advice)}` : ""} <em>(${escapeText(code)})</em></span>`
      + `${chosen ? namesMarkup(model, parts) : ""}</li>`;
  });
  return `<h3>What is wrong</h3><ul>${lines.join("")}</ul>`;
}

function namesMarkup(model, parts) {
  const names = [...parts].slice(0, MOST).map((part) => `<button class="part" data-part="${part}">${escapeText(model.ids[part])}</button>`);
  const rest = parts.size > MOST ? ` <button class="quiet" data-more>${number(parts.size - MOST)} more in the table</button>` : "";
  return `<p class="names">${names.join(" ")}${rest}</p>`;
}
