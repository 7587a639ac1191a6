// SPDX-License-Identifier: MIT
//
// What checks of pages in headless Chromium share: the windows, what was found, and a page opened
// from disk, of which whatever breaks, complains or asks a network is a finding.
// $CHROMIUM names another browser than /usr/bin/chromium.
import { join } from "node:path";
import { env } from "node:process";
import { pathToFileURL } from "node:url";

export const CHROMIUM = env.CHROMIUM || "/usr/bin/chromium";
export const FLAGS = ["--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
  "--disable-background-networking", "--disable-component-update", "--disable-sync"];
export const WINDOWS = [
  ["wide", { viewport: { width: 1280, height: 900 }, colorScheme: "light" }],
  ["narrow", { viewport: { width: 390, height: 844 }, deviceScaleFactor: 3, hasTouch: true,
    colorScheme: "light", reducedMotion: "reduce" }],
  ["dark", { viewport: { width: 820, height: 1180 }, deviceScaleFactor: 1.25,
    colorScheme: "dark" }],
];

export const findings = [];
export const find = (text) => { if (!findings.includes(text)) findings.push(text); };

export async function open(browser, folder, where, options) {
  const context = await browser.newContext(options);
  const page = await context.newPage();
  page.on("pageerror", (error) => find(`${where}: a script broke: ${error.message}`));
  page.on("console", (message) => {
    if (message.type() === "error") find(`${where}: the console says ${message.text()}`);
  });
  page.on("request", (request) => {
    if (!/^(file|data|blob):/.test(request.url())) find(`${where}: asks for ${request.url()}`);
  });
  await page.goto(pathToFileURL(join(folder, "index.html")).href);
  await page.waitForFunction(() => document.documentElement.dataset.ready === "yes", null,
    { timeout: 20000 }).catch(() => find(`${where}: the page was not laid out`));
  return { context, page };
}
