// SPDX-License-Identifier: MIT
//
// node check_night.mjs [--quick] [--screenshots DIR] PAGE_DIR
//
// Opens the page of a night from disk in headless Chromium and holds it against data.json: every
// finding is on the front of it, worst first, with its number, interval, course, pictures and
// command; every number of tonight is shown, and no table has a row without one; strings stayed
// text, nothing was asked of a network, and no window scrolls sideways. --quick: at one window
// alone.
// Exit status: 0 the page holds, 1 it does not (findings on stdout), 2 wrong use.
// $CHROMIUM names another browser than /usr/bin/chromium.
import { checkImages, conclude, faintTexts, find, inWindows, readArguments, readJson }
  from "./check_page.mjs";

/** What a reader sees; runs in the page. */
function survey() {
  const text = (element) => element.innerText.replace(/\s+/g, " ").trim();
  const values = (element) => [...element.querySelectorAll("data")].map((one) => Number(one.value));
  const saidEnd = document.querySelector(".verdict .said").getBoundingClientRect().bottom;
  for (const details of document.querySelectorAll("details")) details.open = true;
  return {
    width: document.documentElement.scrollWidth, room: window.innerWidth, saidEnd,
    verdict: text(document.querySelector(".verdict")),
    text: document.querySelector("main").innerText,
    foreign: document.querySelectorAll("main img:not(.pixels), main script, main iframe").length,
    groups: [...document.querySelectorAll("article.finding-group")].map((article) => ({
      of: article.dataset.of, found: article.dataset.found, text: text(article),
      title: text(article.querySelector("h3")), values: values(article),
      trends: article.querySelectorAll("svg.trend").length,
      pictures: [...article.querySelectorAll("img.pixels")].map((image) =>
        image.getAttribute("src")),
      code: [...article.querySelectorAll("code")].map(text) })),
    cells: [...document.querySelectorAll("details.scene td data")].map((one) => Number(one.value)),
    empty: [...document.querySelectorAll("details.scene tbody tr")].filter((row) =>
      !row.querySelector("data")).map(text),
    clipped: [...document.querySelectorAll("article.finding-group *")].filter((element) =>
      element.scrollWidth > element.clientWidth + 1 && element.clientWidth > 0
      && !(element instanceof SVGElement)).map((element) => element.className || element.tagName),
    pictures: [...document.querySelectorAll("img.pixels")].map((image) => ({
      src: image.getAttribute("src"), alt: image.alt, loaded: image.naturalWidth > 0,
      shrunk: image.clientWidth < image.naturalWidth })),
    holes: [...document.querySelectorAll(".hole")].map(text),
  };
}

/** Of pictures that are only a part of the data: those that the page was given. */
const drawnOf = (shown) => [shown?.accepted, shown?.tonight, shown?.difference]
  .map((frame) => frame?.picture).filter((name) => name);

function checkFinding(finding, seen) {
  const where = `${finding.found}, ${finding.series}`;
  const single = (text) => text.replace(/\s+/g, " ").trim();
  const of = finding.kind === "mean" || !finding.scene ? [finding.series]
    : [finding.suite, finding.scene, finding.engine];
  const own = seen.groups.filter((group) => group.found === finding.found
    && group.of === of.join("/"));
  if (own.length !== 1) return find(`${where}: it stands in ${own.length} places`);
  const [group] = own;
  if (!seen.verdict.includes(of.length > 1 ? `${finding.engine} in ${finding.scene.split("@")[0]}`
    : single(finding.series))) find(`${where}: the verdict does not list it`);
  if (!group.title.includes(finding.found) || (of.length > 1 && !group.title.includes(
    `${finding.engine} in ${finding.scene.split("@")[0]}`))) find(`${where}: it is not named`);
  for (const key of ["tonight", "baseline"])
    if (finding.tonight !== null && finding.baseline !== null
      && !group.values.includes(finding[key])) find(`${where}: its number of ${key} is not shown`);
  for (const end of [...(finding.interval ?? []), finding.range?.low, finding.range?.high])
    if (end !== undefined && end !== null && finding.tonight !== null
      && !group.values.includes(end)) find(`${where}: its interval is not shown`);
  if (typeof finding.preset_floor === "number" && !group.values.includes(finding.preset_floor))
    find(`${where}: its floor is not shown`);
  if (finding.tonight === null && !group.text.includes(single(finding.words)))
    find(`${where}: it is not said: ${finding.words}`);
  if ((finding.trend ?? []).filter(({ value }) => value !== null).length > 1
    && group.trends === 0) find(`${where}: its course is not drawn`);
  if (finding.command && !group.code.some((text) => text === single(finding.command)))
    find(`${where}: its command is not shown`);
  if (finding.metric && ["worse", "missing"].includes(finding.found) && finding.kind !== "mean"
    && !group.code.some((text) => text.startsWith("neph baseline accept ")
      && text.includes(single(finding.series)) && text.endsWith("--why \"\"")))
    find(`${where}: the command that accepts it is not shown`);
  if (finding.shown && drawnOf(finding.shown).length > 0
    && !group.pictures.some((name) => drawnOf(finding.shown).includes(name)))
    find(`${where}: its pictures are not shown`);
}

function checkContent(data, seen) {
  for (const finding of data.state === "finished" ? data.findings : [])
    checkFinding(finding, seen);
  const worst = data.findings[0];
  if (data.state === "finished" && worst) {
    const name = worst.scene && worst.kind !== "mean" ? worst.engine : worst.series;
    if (!seen.groups[0]?.title.includes(worst.found) || !seen.groups[0].title.includes(
      name.replace(/\s+/g, " ").trim())) find("the worst is not the first");
    if (worst.fails && !seen.verdict.includes(name.replace(/\s+/g, " ").trim()))
      find("the verdict does not name the worst");
  }
  for (const row of data.series)
    if (row.tonight !== null && !row.series.endsWith("/contrast")
      && !seen.cells.includes(row.tonight)) find(`${row.series}: its number is not shown`);
  for (const row of data.series)
    if (typeof row.preset_floor === "number" && !seen.cells.includes(row.preset_floor))
      find(`${row.series}: its floor is not shown`);
  for (const row of seen.empty) find(`a row without a number: ${row}`);
  for (const step of data.steps)
    if (!seen.text.includes(step.name)) find(`step ${step.name} is not shown`);
  if (!seen.text.includes(`${data.compared} comparison`) && data.state === "finished"
    && data.compared > 0) find("comparisons are not counted");
  if (data.page.left_out > 0 && !seen.text.includes("limit of the page is reached"))
    find("it is not said that the limit of the page is reached");
  if (seen.foreign > 0) find("markup that is none of the page's");
}

/** The button beside a command copies it. */
async function checkCopy(page, where) {
  const button = page.locator("#whole-run button");
  if (await button.count() === 0) return; // the run is not finished
  await page.context().grantPermissions(["clipboard-read", "clipboard-write"]);
  await button.click();
  await page.waitForFunction(() => document.querySelector("#whole-run [role=status]").textContent);
  const copied = await page.evaluate(() => navigator.clipboard.readText());
  if (copied !== await page.locator("#whole-run code").innerText())
    find(`${where}: the button copies ${copied}`);
}

const options = readArguments(
  "node check_night.mjs [--quick] [--screenshots DIR] PAGE_DIR", 1, ["quick"]);
const [folder] = options.places;

await conclude(folder, Infinity, async () => {
  const data = readJson(folder, "data.json");
  await inWindows(folder, options, async (page, where, { viewport }) => {
    const seen = await page.evaluate(survey);
    checkContent(data, seen);
    checkImages(where, seen);
    if (seen.saidEnd > viewport.height) find(`${where}: the verdict is below the first screen`);
    for (const text of seen.clipped) find(`${where}: wider than its place: ${text}`);
    for (const text of await page.evaluate(faintTexts))
      find(`${where}: too little contrast: ${text}`);
    await checkCopy(page, where);
  });
});
