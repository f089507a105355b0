// Text of the page: numbers as people write them, names made safe.

const MARKS = { "&": "&amp;", "<": "&lt;", ">": "&gt;", '"': "&quot;", "'": "&#39;" };

export const escapeText = (text) => String(text).replace(/[&<>"']/g, (mark) => MARKS[mark]);

/** A number with four significant digits, thousands apart. */
export function number(value) {
  if (value === null || value === undefined) return "–";
  if (value === 0) return "0";
  const digits = Math.max(0, 3 - Math.floor(Math.log10(Math.abs(value))));
  const [whole, rest] = Math.abs(value).toFixed(Math.min(6, digits)).split(".");
  const apart = whole.length > 4 ? whole.replace(/\B(?=(\d{3})+$)/g, "\u2009") : whole;
  return `${value < 0 ? "−" : ""}${apart}${rest && Number(rest) ? `.${rest.replace(/0+$/, "")}` : ""}`;
}

export const plural = (count, word) => `${number(count)} ${word}${count === 1 ? "" : "s"}`;
