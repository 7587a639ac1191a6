// SPDX-License-Identifier: MIT
//
// node check_failure.mjs [--quick] [--screenshots DIR] PAGE_DIR
//
// Opens a page of the failure suite from disk in headless Chromium and holds it against data.json:
// every number, verdict and picture is shown, each row of the matrix has a number and each verdict
// a word, flip-books turn, by keyboard too, and slowly where less motion is asked for, strings
// stayed text, nothing was asked of a network, and no window scrolls sideways. --quick: at one
// window alone.
// Exit status: 0 the page holds, 1 it does not (findings on stdout), 2 wrong use.
// $CHROMIUM names another browser than /usr/bin/chromium.
import { mkdirSync, readFileSync } from "node:fs";
import { join, resolve } from "node:path";
import { argv, exit, stderr, stdout } from "node:process";
import { CHROMIUM, FLAGS, WINDOWS, find, findings, open } from "./opened_page.mjs";

/** What a reader sees; runs in the page. */
function survey() {
  const text = (element) => element.innerText.replace(/\s+/g, " ").trim();
  for (const details of document.querySelectorAll("details")) details.open = true;
  return {
    width: document.documentElement.scrollWidth, room: window.innerWidth,
    text: document.querySelector("main").innerText,
    foreign: document.querySelectorAll("main img:not(.pixels), main script, main iframe").length,
    matrix: [...document.querySelectorAll("table.matrix tbody tr")].map((row) => ({
      name: text(row.querySelector("th a")), numbers: row.querySelectorAll("td data, td [title]")
        .length, cells: [...row.querySelectorAll("td")].map(text) })),
    values: [...document.querySelectorAll("section table.findings:not(.matrix) td data")]
      .map((element) => Number(element.value)),
    words: [...document.querySelectorAll("td.num")].filter((cell) => !/[a-z]/.test(text(cell))
      && !cell.hasAttribute("title")).map(text),
    pictures: [...document.querySelectorAll("img.pixels")].map((image) => ({
      src: image.getAttribute("src"), alt: image.alt, hidden: image.hidden,
      loaded: image.naturalWidth > 0, shrunk: image.clientWidth < image.naturalWidth })),
    holes: [...document.querySelectorAll(".hole")].map(text),
    nameless: [...document.querySelectorAll("button, input")].filter((control) =>
      !control.getAttribute("aria-label") && !control.innerText).length,
  };
}

const shownCount = (values, value) => values.filter((shown) => shown === value).length;

function checkContent(data, seen) {
  for (const result of data.results) {
    if (result.value !== null && shownCount(seen.values, result.value) === 0)
      find(`${result.scene} ${result.point} ${result.measure} ${result.column}: the number ` +
        `${result.value} is not shown`);
    for (const said of [result.why, result.reason])
      if (said && !seen.text.includes(said)) find(`it is not said: ${said}`);
  }
  const measured = new Set(data.results.filter((result) => result.value !== null
    || result.infinite).map((result) => result.scene));
  for (const scene of measured)
    if (!seen.matrix.some((row) => row.name === scene)) find(`the matrix has no row of ${scene}`);
  for (const row of seen.matrix)
    if (row.numbers === 0) find(`the matrix has a row without a number: ${row.name}`);
  for (const cell of seen.words) find(`a verdict without a word: ${cell}`);
  for (const item of data.evidence)
    for (const name of item.pictures)
      if (!seen.pictures.some((image) => image.src === `${item.folder}/${name}`))
        find(`${item.folder}/${name} is not shown`);
  for (const scene of data.scenes)
    for (const key of ["title", "fails", "symptom"])
      if (!seen.text.includes(scene[key])) find(`${scene.name}: its ${key} is not shown`);
  if (!seen.text.includes(`${data.compared} comparison`)) find("comparisons are not counted");
  if (data.pictures.left_out > 0 && !seen.text.includes("limit is reached"))
    find("it is not said that the limit of the page is reached");
  if (seen.foreign > 0) find("markup that is none of the page's");
}

function checkWindow(where, seen) {
  if (seen.width > seen.room) find(`${where}: ${seen.width} px wide in a window of ${seen.room}`);
  for (const text of seen.holes) find(`${where}: ${text}`);
  for (const image of seen.pictures) {
    if (!image.hidden && !image.loaded) find(`${where}: ${image.src} does not load`);
    if (!image.hidden && image.shrunk) find(`${where}: ${image.src} is smaller than its pixels`);
    if (!image.alt) find(`${where}: ${image.src} says nothing to who does not see it`);
  }
  if (seen.nameless > 0) find(`${where}: ${seen.nameless} controls without a name`);
}

/** How often the frame of a flip-book changes in a second. */
const turns = (book) => book.evaluate((element) => new Promise((done) => {
  const images = [...element.querySelector(".stack").querySelectorAll("img")];
  const shown = () => images.findIndex((image) => !image.hidden);
  let count = 0, before = shown();
  const watch = window.setInterval(() => {
    if (shown() !== before) count++;
    before = shown();
  }, 10);
  window.setTimeout(() => { window.clearInterval(watch); done(count); }, 1000);
}));

async function checkFlips(page, where, isCalm) {
  const book = page.locator(".flipbook").first();
  if (await book.count() === 0) return;
  const shown = () => book.locator(".stack").first().locator("img:not([hidden])")
    .getAttribute("src");
  const first = await shown();
  if (await turns(book) !== 0) find(`${where}: a flip-book turns that nobody started`);
  await book.locator("button").focus();
  await page.keyboard.press("Space");
  const count = await turns(book);
  if (isCalm ? count < 1 || count > 2 : count < 6)
    find(`${where}: a flip-book turns ${count} times in a second`);
  await page.keyboard.press("Space");
  if (await turns(book) !== 0) find(`${where}: a flip-book that is stopped turns`);
  await book.locator("input").focus();
  await page.keyboard.press("Home");
  if (await shown() !== first) find(`${where}: Home does not show the first frame`);
  await page.keyboard.press("ArrowRight");
  if (await shown() === first) find(`${where}: an arrow key does not show the next frame`);
}

async function checkPage(folder, data, { quick, screenshots }) {
  const { chromium } = await import("playwright-core");
  const browser = await chromium.launch({ executablePath: CHROMIUM, args: FLAGS });
  try {
    for (const [where, options] of quick ? WINDOWS.slice(0, 1) : WINDOWS) {
      const { context, page } = await open(browser, folder, where, options);
      await page.waitForLoadState("load");
      if (screenshots)
        await page.screenshot({ path: join(screenshots, `${where}.png`), fullPage: true });
      const seen = await page.evaluate(survey);
      checkContent(data, seen);
      checkWindow(where, seen);
      await checkFlips(page, where, options.reducedMotion === "reduce");
      await context.close();
    }
  } finally {
    await browser.close();
  }
}

async function main() {
  const given = argv.slice(2);
  const options = { quick: false, screenshots: null, folder: null };
  for (let n = 0; n < given.length; n++) {
    if (given[n] === "--quick") options.quick = true;
    else if (given[n] === "--screenshots" && given[n + 1])
      options.screenshots = resolve(given[++n]);
    else options.folder = resolve(given[n]);
  }
  if (!options.folder) {
    stderr.write("usage: node check_failure.mjs [--quick] [--screenshots DIR] PAGE_DIR\n");
    return 2;
  }
  try {
    const data = JSON.parse(readFileSync(join(options.folder, "data.json"), "utf8"));
    if (options.screenshots) mkdirSync(options.screenshots, { recursive: true });
    await checkPage(options.folder, data, options);
  } catch (error) {
    find(`the page could not be checked: ${error.message}`);
  }
  for (const text of findings) stdout.write(`${text}\n`);
  stderr.write(`${options.folder}: ${findings.length || "no"} findings\n`);
  return findings.length === 0 ? 0 : 1;
}

exit(await main());
