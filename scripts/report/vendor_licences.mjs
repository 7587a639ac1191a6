// SPDX-License-Identifier: MIT
//
// node vendor_licences.mjs > vendor-licences.txt
//
// The licence text of every package inside the three bundles that travel with a report. Reads
// node_modules; run it again when package-lock.json changes (the tests notice if one forgets).
import { existsSync, readdirSync, readFileSync } from "node:fs";
import { fileURLToPath } from "node:url";

const modules = fileURLToPath(new URL("node_modules/", import.meta.url));
// Needed by the packages' command-line tools or by the TypeScript compiler, in no browser bundle.
const notBundled = new Set(["commander", "iconv-lite", "rw", "yargs"]);

const found = new Map();
function visit(name) {
  if (found.has(name) || notBundled.has(name) || name.startsWith("@types/")) return;
  const description = JSON.parse(readFileSync(`${modules}${name}/package.json`, "utf8"));
  const file = readdirSync(`${modules}${name}`).find((entry) => /^licen[cs]e/i.test(entry));
  found.set(name, {
    version: description.version,
    licence: description.license,
    text: file ? readFileSync(`${modules}${name}/${file}`, "utf8") : null,
  });
  for (const dependency of Object.keys(description.dependencies ?? {})) visit(dependency);
}

if (!existsSync(modules)) throw new Error("run `npm ci` in scripts/report first");
["vega", "vega-lite", "vega-embed"].forEach(visit);

// The Vega packages share one text: print each text once, under all its packages.
const byText = new Map();
for (const [name, { version, licence, text }] of [...found].sort(([a], [b]) => (a < b ? -1 : 1))) {
  const key = (text ?? `(the package holds no licence file; its package.json says: ${licence})`)
    .replace(/\r/g, "").replace(/[ \t]+$/gm, "").trim();
  byText.set(key, [...(byText.get(key) ?? []), `${name} ${version} (${licence})`]);
}
console.log("Licences of the code in vega.min.js, vega-lite.min.js and vega-embed.min.js\n");
for (const [text, names] of byText)
  console.log(`${"=".repeat(80)}\n${names.join("\n")}\n\n${text}\n`);
