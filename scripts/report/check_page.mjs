// SPDX-License-Identifier: MIT
//
// Parts that checks of pages in headless Chromium share: arguments, the windows, findings, and a
// page opened from disk, of which whatever breaks, complains or asks a network is a finding.
// $CHROMIUM names another browser than /usr/bin/chromium.
import { mkdirSync, readFileSync } from "node:fs";
import { join, resolve } from "node:path";
import { argv, env, exit, stderr, stdout } from "node:process";
import { pathToFileURL } from "node:url";

const CHROMIUM = env.CHROMIUM || "/usr/bin/chromium";
const FLAGS = ["--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
  "--disable-background-networking", "--disable-component-update", "--disable-sync"];
const WINDOWS = [
  ["wide", { viewport: { width: 1280, height: 900 }, colorScheme: "light" }],
  ["narrow", { viewport: { width: 390, height: 844 }, deviceScaleFactor: 3, hasTouch: true,
    colorScheme: "light", reducedMotion: "reduce" }],
  ["dark", { viewport: { width: 820, height: 1180 }, deviceScaleFactor: 1.25,
    colorScheme: "dark" }],
];

export const findings = [];
export const find = (text) => { if (!findings.includes(text)) findings.push(text); };

export const readJson = (...path) => JSON.parse(readFileSync(join(...path), "utf8"));

/** The address of a page in a folder. */
export const address = (folder, hash = "") => pathToFileURL(join(folder, "index.html")).href + hash;

/** Do something with a browser. */
export async function browse(run) {
  const { chromium } = await import("playwright-core");
  const browser = await chromium.launch({ executablePath: CHROMIUM, args: FLAGS });
  try {
    await run(browser);
  } finally {
    await browser.close();
  }
}

async function open(browser, folder, where, options) {
  const context = await browser.newContext(options);
  const page = await context.newPage();
  page.on("pageerror", (error) => find(`${where}: a script broke: ${error.message}`));
  page.on("console", (message) => {
    if (message.type() === "error") find(`${where}: the console says ${message.text()}`);
  });
  page.on("request", (request) => {
    if (!/^(file|data|blob):/.test(request.url())) find(`${where}: asks for ${request.url()}`);
  });
  await page.goto(address(folder));
  await page.waitForFunction(() => document.documentElement.dataset.ready === "yes", null,
    { timeout: 20000 }).catch(() => find(`${where}: the page was not laid out`));
  return { context, page };
}

/** A page in each window, or in the first alone. */
export const inWindows = (folder, { quick, screenshots }, look) => browse(async (browser) => {
  for (const [where, options] of quick ? WINDOWS.slice(0, 1) : WINDOWS) {
    const { context, page } = await open(browser, folder, where, options);
    await page.waitForLoadState("load");
    if (screenshots)
      await page.screenshot({ path: join(screenshots, `${where}.png`), fullPage: true });
    await look(page, where, options);
    await context.close();
  }
});

/** What is of no data: `seen` has the widths, holes and images of a page. */
export function checkImages(where, seen) {
  if (seen.width > seen.room) find(`${where}: ${seen.width} px wide in a window of ${seen.room}`);
  for (const text of seen.holes) find(`${where}: ${text}`);
  for (const image of seen.pictures) {
    if (!image.hidden && !image.loaded) find(`${where}: ${image.src} does not load`);
    if (!image.hidden && image.shrunk) find(`${where}: ${image.src} is smaller than its pixels`);
    if (!image.alt) find(`${where}: ${image.src} says nothing to who does not see it`);
  }
}

/** Options, the flags among them as they are in `flags`, and places; wrong use ends the process. */
export function readArguments(usage, placeCount, flags) {
  const given = argv.slice(2);
  const options = { screenshots: null, places: [] };
  for (const flag of flags) options[flag] = given.includes(`--${flag}`);
  const rest = given.filter((word) => !flags.includes(word.replace(/^--/, "")));
  for (let n = 0; n < rest.length; n++)
    if (rest[n] === "--screenshots" && rest[n + 1]) options.screenshots = resolve(rest[++n]);
    else options.places.push(rest[n].startsWith("-") ? null : resolve(rest[n]));
  if (options.places.length !== placeCount || options.places.includes(null)) {
    stderr.write(`usage: ${usage}\n`);
    exit(2);
  }
  if (options.screenshots) mkdirSync(options.screenshots, { recursive: true });
  return options;
}

/** Check, say what was found, and end the process. */
export async function conclude(what, most, check) {
  try {
    await check();
  } catch (error) {
    const hint = error.code === "ERR_MODULE_NOT_FOUND" ? " (run `npm ci` in scripts/report)" : "";
    find(`the page could not be checked: ${error.message}${hint}`);
  }
  for (const text of findings.slice(0, most)) stdout.write(`${text}\n`);
  if (findings.length > most) stdout.write(`and ${findings.length - most} more\n`);
  stderr.write(`${what}: ${findings.length || "no"} findings\n`);
  exit(findings.length === 0 ? 0 : 1);
}

/** The rules of axe-core (npm) that a page breaks; without axe-core it says so, and finds none. */
export async function checkAccess(page, where) {
  let source;
  try {
    const { createRequire } = await import("node:module");
    source = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");
  } catch {
    stderr.write(`${where}: axe-core is not installed, so its rules were NOT checked (npm ci)\n`);
    return;
  }
  await page.evaluate(`${source};0`);
  // Assets that axe would load once more are out of reach of a page from disk.
  const broken = await page.evaluate(async () => (await window.axe.run(document,
    { resultTypes: ["violations"], preload: false })).violations.flatMap(({ id, help, nodes }) =>
    nodes.map(({ html }) => `${id} (${help}): ${html.slice(0, 160)}`)));
  for (const text of broken) find(`${where}: axe: ${text}`);
}

/** Runs in a page: each text whose contrast is below that of WCAG 2.1, 1.4.3, with its ratio. */
export function faintTexts() {
  const visible = (element) => element.checkVisibility({ visibilityProperty: true,
      opacityProperty: true });
  const parse = (colour) => {
    const c = colour.match(/[\d.]+/g).map(Number);
    return { r: c[0], g: c[1], b: c[2], a: c[3] ?? 1 };
  };
  const over = (top, bottom) => ({ r: top.r * top.a + bottom.r * (1 - top.a),
      g: top.g * top.a + bottom.g * (1 - top.a), b: top.b * top.a + bottom.b * (1 - top.a), a: 1 });
  const linear = (c) => (c / 255 <= 0.04045 ? c / 255 / 12.92 : ((c / 255 + 0.055) / 1.055) ** 2.4);
  const luminance = ({ r, g, b }) => 0.2126 * linear(r) + 0.7152 * linear(g) + 0.0722 * linear(b);
  const background = (element) => {
    const layers = [];
    for (let e = element; e; e = e.parentElement) {
      const colour = parse(getComputedStyle(e).backgroundColor);
      if (colour.a > 0) layers.push(colour);
      if (colour.a === 1) break;
    }
    return layers.reverse().reduce((below, layer) => over(layer, below),
      { r: 255, g: 255, b: 255, a: 1 });
  };
  const faint = new Set();
  for (const element of document.querySelectorAll(
    "body *:not(svg, svg *, .hidden, noscript, script)")) {
    if (![...element.childNodes].some((node) => node.nodeType === 3 && node.data.trim())
      || !visible(element)) continue;
    const style = getComputedStyle(element);
    const behind = background(element);
    const [light, dark] = [luminance(over(parse(style.color), behind)),
      luminance(behind)].sort((a, b) => b - a);
    const ratio = (light + 0.05) / (dark + 0.05);
    const size = parseFloat(style.fontSize);
    const large = size >= 24 || (size >= 18.66 && Number(style.fontWeight) >= 700);
    const className = element.className ? `.${element.className}` : "";
    if (ratio < (large ? 3 : 4.5)) faint.add(element.tagName.toLowerCase() + className
      + ` "${element.textContent.slice(0, 30)}" ${ratio.toFixed(2)}`);
  }
  return [...faint];
}
