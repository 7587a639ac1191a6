// SPDX-License-Identifier: MIT
//
// node render_chart.mjs SPEC.json OUT.svg [SPEC.json OUT.svg ...]
//
// Draws Vega-Lite specifications as static SVGs: the very specification that the page makes
// interactive, so the two cannot tell different stories. It reads no other file and no network.
// Exit status: 0 done, 1 one of them cannot be drawn, 2 wrong use.
import { open, readFile, rename, rm } from "node:fs/promises";
import { argv, exit, pid, stderr } from "node:process";

/** Refuses data that would come from outside the specification, and remembers. */
const refused = [];
const refuse = (uri) => {
  refused.push(uri);
  return Promise.reject(new Error("refused"));
};
const sealedLoader = { load: refuse, sanitize: refuse };

async function writeWhole(path, text) {
  const temporary = `${path}.${pid}.tmp`;
  try {
    const file = await open(temporary, "w");
    try {
      await file.writeFile(text);
      await file.sync();
    } finally {
      await file.close();
    }
    await rename(temporary, path);
  } catch (error) {
    await rm(temporary, { force: true });
    throw error;
  }
}

/** Whether any data set of the compiled chart holds a row. */
function rowsIn(spec, view) {
  return (spec.data ?? []).some(({ name }) => view.data(name).length > 0);
}

/** What is wrong with a specification or its drawing, in words; null: nothing is. */
async function draw(specPath, svgPath, vega, compile) {
  const warnings = new Set();
  // Not worth a word: there is no window here for the interaction to listen to, and a layer
  // without rows (no slopes, no intervals) has no extent.
  const note = (text) => {
    if (!/^(Can not resolve event source|Infinite extent)/.test(text)) warnings.add(text);
    return logger;
  };
  const logger = {
    level: () => logger,
    error: (...args) => note(args.join(" ")),
    warn: (...args) => note(args.join(" ")),
    info: () => logger,
    debug: () => logger,
  };
  const { spec } = compile(JSON.parse(await readFile(specPath, "utf8")), { logger });
  const view = new vega.View(vega.parse(spec), { renderer: "none", loader: sealedLoader, logger });
  const svg = await view.toSVG();
  view.finalize();
  if (refused.length > 0)
    return `the specification asks for ${refused[0]}; put the rows into "datasets"`;
  if (!rowsIn(spec, view)) return "there is nothing to draw: no data set holds a row";
  for (const warning of warnings) stderr.write(`${specPath}: ${warning}\n`);
  if (/NaN|Infinity/.test(svg.replace(/>[^<]*</g, "><")))
    return "a coordinate is not a number; log axes take positive values only";
  await writeWhole(svgPath, `${svg}\n`);
  return null;
}

async function main() {
  const paths = argv.slice(2);
  if (paths.length < 2 || paths.length % 2 !== 0) {
    stderr.write("usage: node render_chart.mjs SPEC.json OUT.svg [SPEC.json OUT.svg ...]\n");
    return 2;
  }
  for (let i = 0; i < paths.length; i += 2) {
    try {
      const vega = await import("vega");
      const { compile } = await import("vega-lite");
      const wrong = await draw(paths[i], paths[i + 1], vega, compile);
      if (wrong !== null) {
        stderr.write(`${paths[i]}: ${wrong}\n`);
        return 1;
      }
    } catch (error) {
      const hint = error.code === "ERR_MODULE_NOT_FOUND" ? " (run `npm ci` in scripts/report)" : "";
      stderr.write(`${paths[i]}: ${error.message}${hint}\n`);
      return 1;
    }
  }
  return 0;
}

exit(await main());
