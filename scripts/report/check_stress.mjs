// SPDX-License-Identifier: MIT
//
// node check_stress.mjs [--quick] [--screenshots DIR] PAGE_DIR
//
// Opens a page of the stress tests from disk in headless Chromium and holds it against data.json:
// every number, verdict and picture is shown, each row of the matrix has a number and each verdict
// a word, flip-books turn, by keyboard too, and slowly where less motion is asked for, strings
// stayed text, nothing was asked of a network, and no window scrolls sideways. --quick: at one
// window alone.
// Exit status: 0 the page holds, 1 it does not (findings on stdout), 2 wrong use.
// $CHROMIUM names another browser than /usr/bin/chromium.
import { checkImages, conclude, find, inWindows, readArguments, readJson } from "./check_page.mjs";

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
    if (typeof result.floor === "number" && shownCount(seen.values, result.floor) === 0)
      find(`${result.scene} ${result.point} ${result.measure} ${result.column}: the floor ` +
        `${result.floor} is not shown`);
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

const options = readArguments(
  "node check_stress.mjs [--quick] [--screenshots DIR] PAGE_DIR", 1, ["quick"]);
const [folder] = options.places;

await conclude(folder, Infinity, async () => {
  const data = readJson(folder, "data.json");
  await inWindows(folder, options, async (page, where, { reducedMotion }) => {
    const seen = await page.evaluate(survey);
    checkContent(data, seen);
    checkImages(where, seen);
    if (seen.nameless > 0) find(`${where}: ${seen.nameless} controls without a name`);
    await checkFlips(page, where, reducedMotion === "reduce");
  });
});
