// The model as the page asks for it: parts counted through, findings by part.

/** What is worst of what was found on a part. */
export const NOTE = 1, ERROR = 2, REJECTED = 3;
export const SEVERITIES = ["", "note", "error", "rejected"];

export function makeModel(head) {
  const { beams, nodes, missing } = head, made = head.panels.id.length + beams.id.length + nodes.id.length;
  const ids = [...head.panels.id, ...beams.id, ...nodes.id, ...missing.map((m) => m.id)];
  const places = new Map(ids.map((id, i) => [id, i]));
  const findings = {}, worst = new Uint8Array(ids.length);
  for (const [code, id, severity, message, size] of head.findings) {
    const part = places.get(id);
    if (part === undefined || part >= made) continue;
    (findings[part] ??= []).push({ code, severity, message, size });
    worst[part] = Math.max(worst[part], severity === "error" ? ERROR : NOTE);
  }
  // Of a part that cannot be made nothing is said but why: it is counted once.
  missing.forEach(({ code, reason }, i) => {
    findings[made + i] = [{ code, severity: "rejected", message: reason, size: null }];
    worst[made + i] = REJECTED;
  });
  const neighbors = head.panels.neighbors.map((row) => [...row]);
  missing.forEach(({ edges }, i) => { for (const [panel, edge] of edges) neighbors[panel][edge] = made + i; });
  const panels = { ...head.panels, neighbors };
  for (const found of Object.values(findings)) {
    found.sort((a, b) => (a.severity === "error" ? 0 : 1) - (b.severity === "error" ? 0 : 1));
  }
  panels.angle_deg = panels.angles_deg.map((row) => {
    const known = row.filter((v) => v !== null);
    return known.length ? Math.max(...known) : null;
  });
  return { ...head, panels, ids, places, made, count: ids.length, findings, worst, moulds: mouldsOf(panels) };
}

function mouldsOf(panels) {
  const moulds = new Map();
  panels.mould.forEach((number, i) => {
    if (number !== null && !moulds.has(number)) moulds.set(number, { number, radius_mm: panels.radius_mm[i] });
  });
  return [...moulds.values()].sort((a, b) => a.number - b.number);
}

/** What a part is, in a word. */
export function kindOf(model, part) {
  const panels = model.panels.id.length, beams = panels + model.beams.id.length;
  if (part >= model.made) return model.ids[part].startsWith("B") ? "beam" : "panel";
  return part < panels ? "panel" : part < beams ? "beam" : "node";
}

/** The part of a name as people type it: any case, with or without zeros. */
export function findPart(model, text) {
  const wanted = text.trim();
  if (model.places.has(wanted)) return model.places.get(wanted);
  const plain = (name) => name.toLowerCase().replace(/^([a-z]*)0+(?=\d)/, "$1");
  const found = model.ids.findIndex((id) => plain(id) === plain(wanted));
  if (found >= 0) return found;
  return /^\d+$/.test(wanted) ? model.ids.findIndex((id) => plain(id) === `p${plain(wanted)}`) : -1;
}
