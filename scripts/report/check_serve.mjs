// SPDX-License-Identifier: MIT
//
// node check_serve.mjs URL SERIES REASON
//
// Accepts a change of a nightly run on the page that `neph serve` serves at URL, by the keyboard
// alone: SERIES, with REASON. Then a page of another origin, which knows the address, tries the
// same for all series and must fail. Prints what is wrong; exit status as check_night.mjs.
import { argv, exit, stderr } from "node:process";

import { browse, checkAccess, conclude, find } from "./check_page.mjs";

const [url, series, reason] = argv.slice(2);
if (!reason) {
  stderr.write("usage: node check_serve.mjs URL SERIES REASON\n");
  exit(2);
}
const TABS = 400; // more than a page of a test has

const focused = (page) => page.evaluate(() => {
  const element = document.activeElement;
  return { tag: element.tagName.toLowerCase(), text: element.textContent,
    series: element.closest(".accept")?.dataset.series ?? null };
});

/** Presses Tab until an element of the form of the series has the focus. */
async function tabTo(page, tag) {
  for (let n = 0; n < TABS; n++) {
    await page.keyboard.press("Tab");
    const at = await focused(page);
    if (at.tag === tag && at.series === series) return true;
  }
  find(`no ${tag} of ${series} is reached by the keyboard`);
  return false;
}

async function load(page) {
  await page.goto(url);
  await page.waitForFunction(() => document.documentElement.dataset.approval === "yes", null,
    { timeout: 20000 });
}

const accepted = (page) => page.evaluate((wanted) => [...document.querySelectorAll(".accept")]
  .find((box) => box.dataset.series === wanted)?.querySelector(".accepted")?.innerText ?? "",
series);

async function acceptByKeyboard(page) {
  await load(page);
  if (!await tabTo(page, "summary")) return;
  await page.keyboard.press("Enter");
  await checkAccess(page, "the form");
  if (!await tabTo(page, "input")) return;
  await page.keyboard.press("Enter"); // without a reason nothing happens
  if (await accepted(page)) find("it was accepted without a reason");
  await page.keyboard.type(reason);
  if (!await tabTo(page, "button")) return;
  await page.keyboard.press("Enter");
  await page.waitForFunction(() => document.activeElement.classList.contains("accepted"), null,
    { timeout: 20000 }).catch(() => find("the acceptance is not confirmed where the focus is"));
  await checkAccess(page, "the acceptance");
  await load(page);
  if (!(await accepted(page)).includes(reason)) find("the page does not show the acceptance");
}

/** A page of another origin; returns what it could read. */
async function attack(page) {
  await page.goto("data:text/html,<title>another origin</title>");
  return page.evaluate(async (address) => {
    const body = JSON.stringify({ nonce: "", night: 1, series: ["*"], why: "attack" });
    const read = [];
    for (const options of [{}, { mode: "no-cors" }, { method: "POST", body },
      { method: "POST", body, mode: "no-cors" }]) {
      const text = await fetch(new URL("../approval", address), options)
        .then((answer) => answer.text()).catch(() => "");
      if (text) read.push(text);
    }
    const frame = document.createElement("iframe");
    frame.src = address;
    await new Promise((done) => {
      frame.onload = frame.onerror = done;
      document.body.append(frame);
    });
    if (frame.contentDocument?.title) read.push(frame.contentDocument.title);
    return read;
  }, url);
}

await conclude(url.replace(/\/[0-9a-f]{64}\//, "/TOKEN/"), Infinity, () => browse(
  async (browser) => {
    const page = await (await browser.newContext()).newPage();
    page.on("pageerror", (error) => find(`a script broke: ${error.message}`));
    page.on("console", (message) => {
      if (message.type() === "error") find(`the console says ${message.text()}`);
    });
    page.on("request", (request) => {
      if (!request.url().startsWith(url.replace(/report\/$/, "")) && !/^data:/.test(request.url()))
        find(`the page asks for ${request.url()}`);
    });
    await acceptByKeyboard(page);
    const other = await (await browser.newContext()).newPage();
    for (const text of await attack(other)) find(`another origin reads ${text}`);
  }));
