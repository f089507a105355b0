// What is taken away from the page: a picture, a link, paper.

import { addressOf } from "./address.js";

/** The picture as it is seen, with the title, on white. */
export function savePicture(page, canvas) {
  page.view?.drawNow();
  const sheet = document.createElement("canvas"), { title } = page.model;
  Object.assign(sheet, { width: canvas.width, height: canvas.height });
  const context = sheet.getContext("2d"), size = Math.max(14, Math.round(canvas.height / 45));
  context.fillStyle = "#fff";
  context.fillRect(0, 0, sheet.width, sheet.height);
  context.drawImage(canvas, 0, 0);
  context.fillStyle = "#22262b";
  context.font = `600 ${size}px system-ui, sans-serif`;
  context.fillText(title, size, 2 * size);
  const link = document.createElement("a");
  link.download = `${title.replace(/[^\p{L}\p{N}]+/gu, "-").replace(/^-|-$/g, "") || "view"}.png`;
  link.href = sheet.toDataURL("image/png");
  link.click();
}

/** The address of what is seen, into the clipboard; whether that is allowed. */
export async function copyLink(page) {
  const link = location.href.split("#")[0] + addressOf(page);
  try {
    await navigator.clipboard.writeText(link);
    return true;
  } catch {
    return false;
  }
}
