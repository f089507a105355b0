// The model as the page asks for it: parts counted through, findings by part.

export function makeModel(head) {
  const { panels, beams, nodes } = head;
  const ids = [...panels.id, ...beams.id, ...nodes.id];
  const places = new Map(ids.map((id, i) => [id, i]));
  const findings = {}, worst = new Uint8Array(ids.length);
  for (const [code, id, severity, message] of head.findings) {
    const part = places.get(id);
    if (part === undefined) continue;
    (findings[part] ??= []).push({ code, severity, message });
    worst[part] = Math.max(worst[part], severity === "error" ? 2 : 1);
  }
  for (const found of Object.values(findings)) {
    found.sort((a, b) => (a.severity === "error" ? 0 : 1) - (b.severity === "error" ? 0 : 1));
  }
  panels.angle_deg = panels.angles_deg.map((row) => {
    const known = row.filter((v) => v !== null);
    return known.length ? Math.max(...known) : null;
  });
  return { ...head, ids, places, count: ids.length, findings, worst, moulds: mouldsOf(panels) };
}

function mouldsOf(panels) {
  const moulds = new Map();
  panels.mould.forEach((number, i) => {
    if (number !== null && !moulds.has(number)) moulds.set(number, { number, radius_mm: panels.radius_mm[i] });
  });
  return [...moulds.values()].sort((a, b) => a.number - b.number);
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
