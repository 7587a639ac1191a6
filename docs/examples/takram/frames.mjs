// SPDX-License-Identifier: MIT
//
// Pictures of page.js in headless Chromium, drawn by its software WebGL 2, and their mean:
//
//     npm install && node frames.mjs OUT 80 preset=medium
//     neph flicker --reference OUT/mean.png 'OUT/frame_*.png' --warm-up 16
//
// $CHROMIUM names another browser than /usr/bin/chromium.
import { createServer } from "node:http";
import { mkdir, readFile, writeFile } from "node:fs/promises";
import { dirname, extname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { build } from "esbuild";
import { chromium } from "playwright-core";

const WARM_UP = 16;
const [out, count, ...words] = process.argv.slice(2);
if (!out || !(count > WARM_UP)) {
  console.error(`usage: node frames.mjs OUT COUNT [KEY=VALUE...]; COUNT is more than ${WARM_UP}`);
  process.exit(64);
}
const here = dirname(fileURLToPath(import.meta.url)), modules = join(here, "node_modules/@takram");
const folders = { clouds: join(modules, "three-clouds/assets"),
  atmosphere: join(modules, "three-atmosphere/assets") };
const types = { ".js": "text/javascript", ".html": "text/html", ".png": "image/png" };
const bundle = await build({ entryPoints: [join(here, "page.js")], bundle: true, format: "esm",
  write: false, logLevel: "warning" });
const pages = { "/": "<!doctype html><script type=module src=page.js></script>",
  "/page.js": bundle.outputFiles[0].text };

const server = createServer(async (request, response) => {
  const path = new URL(request.url, "http://localhost").pathname;
  const [, folder, name] = path.split("/");
  response.setHeader("content-type", types[extname(path) || ".html"] ?? "application/octet-stream");
  try {
    response.end(pages[path] ?? await readFile(join(folders[folder], name)));
  } catch {
    response.writeHead(404).end();
  }
}).listen(0);
const browser = await chromium.launch({ executablePath: process.env.CHROMIUM || "/usr/bin/chromium",
  args: ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist", "--disable-gpu-watchdog"] });
const page = await browser.newPage();
page.on("pageerror", (error) => console.error(error.message));
await page.goto(`http://localhost:${server.address().port}/?${words.join("&")}`);
await page.waitForFunction(() => document.documentElement.dataset.ready === "yes", null,
  { timeout: 60000 });
await mkdir(out, { recursive: true });
const save = (name, url) =>
  writeFile(join(out, name), Buffer.from(url.split(",")[1], "base64"));
for (let i = 0; i < count; i++)
  await save(`frame_${String(i).padStart(4, "0")}.png`,
    await page.evaluate((counts) => window.nextPicture(counts), i >= WARM_UP));
await save("mean.png", await page.evaluate(() => window.meanPicture()));
await browser.close();
server.close();
