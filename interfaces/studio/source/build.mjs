// Bundles the studio once: `npm ci && node node_modules/esbuild/install.js && npm run build`.

import { createHash } from "node:crypto";
import { existsSync, readFileSync, readdirSync, writeFileSync } from "node:fs";
import { build } from "esbuild";

const folder = new URL("../bundle/", import.meta.url).pathname;
const here = new URL(".", import.meta.url).pathname;
const read = (name) => readFileSync(`${here}${name}`, "utf8");

const script = await build({
  entryPoints: [`${here}main.jsx`], bundle: true, minify: true, write: false, metafile: true,
  format: "esm", target: "es2022", charset: "ascii", legalComments: "none", jsx: "automatic",
  define: { "process.env.NODE_ENV": '"production"' },
  // The viewer's bundle is served beside.
  external: ["/studio/viewer.js"],
});
const style = await build({
  entryPoints: [`${here}studio.css`], bundle: true, minify: true, write: false, charset: "ascii",
});

// The licence of every package that is in the bundle.
const inputs = Object.keys(script.metafile.inputs).filter((name) => name.includes("node_modules/"));
const packages = [...new Set(inputs.map((name) => name.split("node_modules/").pop().match(/^(@[^/]+\/)?[^/]+/)[0]))].sort();
const licences = packages.map((name) => {
  const file = ["LICENSE", "LICENSE.md", "LICENSE.txt"].map((each) => `${here}node_modules/${name}/${each}`).find(existsSync);
  if (!file) throw new Error(`${name} has no licence text`);
  const { version, license } = JSON.parse(read(`node_modules/${name}/package.json`));
  return `${name} ${version} (${license})\n\n${readFileSync(file, "utf8").trim()}\n`;
});
writeFileSync(`${folder}licences.txt`, licences.join(`\n${"-".repeat(80)}\n\n`));
writeFileSync(`${folder}studio.js`, `/* Licences of what is in here: licences.txt beside. */\n${script.outputFiles[0].text}`);
writeFileSync(`${folder}studio.css`, style.outputFiles[0].text);
writeFileSync(`${folder}studio.html`, read("studio.html"));

// What the bundle was made of, for a test that it is not left behind.
const names = readdirSync(here).filter((name) => /\.(m?js|jsx|css|html|json)$/.test(name)).sort();
const digest = createHash("sha256");
for (const name of names) digest.update(`${name}\n${read(name).replaceAll("\r\n", "\n")}\n`);
writeFileSync(`${folder}source.sha256`, `${digest.digest("hex")}\n`);
