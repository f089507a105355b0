// Opens the page: the model that it is filled with, then its picture.

import { Page } from "./page.js";
import { decodeModel } from "./unpack.js";

// The page has begun to inflate its model before this code was there.
window.modelBytes.then(async (bytes) => {
  const page = new Page(...decodeModel(new Uint8Array(bytes)));
  page.start();
  window.spheremesh = page;
  await page.view?.drawFirst();
  document.documentElement.dataset.ready = "";
  performance.mark("ready");
}).catch((error) => {
  document.getElementById("message").textContent = `The model cannot be shown: ${error.message}.`;
});
