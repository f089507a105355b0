// Bundles the page once: `npm ci && node node_modules/esbuild/install.js && npm run build`.

import { createHash } from "node:crypto";
import { readFileSync, readdirSync, writeFileSync } from "node:fs";
import { build } from "esbuild";

const folder = new URL("../bundle/", import.meta.url).pathname;
const read = (name) => readFileSync(new URL(name, import.meta.url), "utf8");

const bundled = await build({
  entryPoints: [new URL("main.js", import.meta.url).pathname], bundle: true, minify: true, write: false,
  format: "iife", target: "es2022", charset: "ascii", legalComments: "none",
});
const style = await build({
  entryPoints: [new URL("page.css", import.meta.url).pathname], bundle: true, minify: true, write: false,
  charset: "ascii",
});
const licence = read("node_modules/three/LICENSE").trim();
const script = `/* With parts of three.js:\n${licence}\n*/\n${bundled.outputFiles[0].text}`;
writeFileSync(`${folder}page.js`, script.replaceAll("</script", "<\\/script"));
// The same picture for other pages, as a module.
const parts = await build({
  entryPoints: [new URL("parts.js", import.meta.url).pathname], bundle: true, minify: true, write: false,
  format: "esm", target: "es2022", charset: "ascii", legalComments: "none",
});
writeFileSync(`${folder}viewer.js`, `/* With parts of three.js:\n${licence}\n*/\n${parts.outputFiles[0].text}`);
writeFileSync(`${folder}page.html`, read("page.html").replace("{{style}}", () => style.outputFiles[0].text.trim()));

// What the bundle was made of, for a test that it is not left behind.
const names = readdirSync(new URL(".", import.meta.url)).filter((name) => /\.(m?js|css|html|json)$/.test(name)).sort();
const digest = createHash("sha256");
for (const name of names) digest.update(`${name}\n${read(name).replaceAll("\r\n", "\n")}\n`);
writeFileSync(`${folder}source.sha256`, `${digest.digest("hex")}\n`);
