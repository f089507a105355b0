// The card of a part: what it is, who its neighbours are, what was found on it.

import { kindOf, SEVERITIES } from "./model.js";
import { escapeText, number, plural } from "./text.js";

const link = (model, i) => (i === null || i < 0
  ? '<span class="none">rim</span>'
  : `<button class="part" data-part="${i}">${escapeText(model.ids[i])}</button>${i >= model.made ? " (missing)" : ""}`);

const row = (name, value) => `<div><dt>${name}</dt><dd>${value}</dd></div>`;

export function cardMarkup(model, part) {
  const panels = model.panels.id.length, beams = model.beams.id.length;
  const head = `<header><h2>${escapeText(model.ids[part])}</h2>${badge(model, part)}`
    + '<button class="close" aria-label="Close">×</button></header>';
  let body;
  if (part >= model.made) body = missingRows(model, part);
  else if (part < panels) body = panelRows(model, part);
  else if (part < panels + beams) body = beamRows(model, part - panels);
  else body = row("Node", `radius ${number(model.nodes.radius_mm)} mm`);
  return `${head}${findings(model, part)}<dl>${body}</dl>`;
}

function badge(model, part) {
  const worst = SEVERITIES[model.worst[part]];
  return worst ? `<span class="badge ${worst}">${worst === "rejected" ? "missing" : worst}</span>` : "";
}

function findings(model, part) {
  const found = model.findings[part] ?? [];
  if (!found.length) return "";
  return `<ul class="findings">${found.map((f) => `<li class="${f.severity}">${f.severity === "rejected" ? "cannot be made: " : ""}${escapeText(f.message)} <em>(${escapeText(f.code)})</em></li>`).join("")}</ul>`;
}

function panelRows(model, i) {
  const p = model.panels, mould = p.mould[i];
  const radius = p.radius_mm[i] === null ? "plane" : `${number(p.radius_mm[i])} mm, bulges ${p.bulge[i]}`;
  const edges = p.edge_lengths_mm[i].map((length, k) => {
    const angle = p.angles_deg[i][k];
    return `<tr><td>${k + 1}</td><td>${number(length)}</td><td>${number(p.sagittas_mm[i][k])}</td>`
      + `<td>${angle === null ? "–" : number(angle)}</td><td>${link(model, p.neighbors[i][k])}</td></tr>`;
  }).join("");
  const around = [...new Set(p.neighbors[i].filter((j) => j !== null && j >= 0))].map((j) => link(model, j)).join(" ");
  return row("Mould", mould === null ? "–" : `<button class="mould" data-mould="${mould}">${mould}</button>`)
    + row("Neighbours", around || "none") + row("Radius", radius) + row("Area", `${number(p.area_m2[i])} m²`)
    + row("Size", `${p.size_mm[i].map(number).join(" × ")} mm`)
    + row("Thickness", p.thickness_mm[i] ? `${number(p.thickness_mm[i])} mm` : "surface")
    + row("Largest angle", p.angle_deg[i] === null ? "–" : `${number(p.angle_deg[i])}°`)
    + row("Tilt of walls", `${number(p.tilt_deg[i])}°`)
    + row("Corners off plane", `${number(p.planarity_mm[i])} mm`)
    + `</dl><table class="edges"><thead><tr><th>Edge</th><th>Length mm</th><th>Rise mm</th><th>Angle °</th><th>Neighbour</th></tr></thead><tbody>${edges}</tbody></table><dl>`;
}

function missingRows(model, part) {
  const { beside } = model.missing[part - model.made];
  const around = beside.map((id) => model.places.get(id)).filter((i) => i !== undefined);
  const name = kindOf(model, part) === "beam" ? "Panels" : "Neighbours";
  return row(name, around.map((i) => link(model, i)).join(" ") || "not known");
}

function beamRows(model, b) {
  const beams = model.beams;
  return row("Length", `${number(beams.length_mm[b])} mm`)
    + row("Depth", `${beams.depths_mm[b].map(number).join(" / ")} mm`)
    + row("Thickness", `${number(beams.thickness_mm[b])} mm`)
    + row("Tilt", `${number(beams.tilt_deg[b])}°`)
    + row("Panels", beams.panels[b].map((i) => link(model, i)).join(" "))
    + row("Nodes", escapeText(beams.nodes[b].join(" – ")));
}

/** What a screen reader hears when a part is chosen. */
export function spoken(model, part) {
  const panels = model.panels.id.length, found = model.findings[part] ?? [];
  const name = model.ids[part];
  if (part >= model.made) return `${name} cannot be made: ${found[0].message}.`;
  if (part >= panels) return `${name}. ${plural(found.length, "finding")}.`;
  const p = model.panels;
  const mould = p.mould[part] === null ? "" : ` Mould ${p.mould[part]}.`;
  const radius = p.radius_mm[part] === null ? "plane" : `radius ${number(p.radius_mm[part])} mm`;
  const next = p.neighbors[part].filter((i) => i !== null).map((i) => model.ids[i]).join(", ");
  return `Panel ${name}.${mould} ${radius}. Neighbours ${next}. ${plural(found.length, "finding")}.`;
}
