// SPDX-License-Identifier: MIT
//
// node check_view.mjs [--quick] [--screenshots DIR] PAGE_DIR EXPECTED.json
//
// Opens a page of neph view from disk in headless Chromium and tries it as a person would: values
// under the pointer are those that EXPECTED says are in the files, colours those of the display,
// keys, wheel, drag and address do what the help says, nothing goes wrong in the console or to a
// network, and all can be read and reached. --quick: values and colours alone.
// EXPECTED: {"pixels": [{"set", "frame", "quantity", "x", "y", "values"}],
//            "maps": [{"set", "frame", "map", "x", "y", "values"}],
//            "views": [{"set", "x", "y", "ev", "codes"}]}
// Exit status: 0 all holds, 1 it does not (findings on stdout), 2 wrong use.
import { join } from "node:path";
import { address, browse, conclude, faintTexts, find, readArguments, readJson }
  from "./check_page.mjs";

const SHOWN_MOST = 200;

const same = (what, seen, wanted) => {
  if (JSON.stringify(seen) !== JSON.stringify(wanted))
    find(`${what}: ${JSON.stringify(seen)}, not ${JSON.stringify(wanted)}`);
};

// ------------------------------------------------------------------------------------- the page

async function ready(page) {
  await page.waitForSelector("html[data-ready=yes]", { timeout: 30000 })
    .catch(() => find("the page did not become ready"));
}

async function open(browser, folder, hash, options) {
  const context = await browser.newContext({ viewport: { width: 1280, height: 900 },
      colorScheme: "light", ...options });
  await context.setOffline(true);
  const page = await context.newPage();
  page.on("console", (message) => {
    if (!message.text().includes("willReadFrequently")) // it is this check that reads canvases
      find(`console ${message.type()}: ${message.text()}`);
  });
  page.on("pageerror", (error) => find(`script error: ${error.message}`));
  page.on("request", (request) => {
    if (!/^(file|data|blob):/.test(request.url())) find(`asked the network for ${request.url()}`);
  });
  await page.goto(address(folder, hash));
  await ready(page);
  return { context, page };
}

/** Look at something else, by the address. */
async function go(page, words) {
  await page.evaluate((hash) => {
    document.documentElement.dataset.ready = "no";
    if (location.hash === hash) window.dispatchEvent(new HashChangeEvent("hashchange"));
    else location.hash = hash;
  }, `#${Object.entries(words).map(([name, value]) => `${name}=${value}`).join("&")}`);
  await ready(page);
}

const hashOf = async (page) => {
  await page.waitForTimeout(40); // a picture of the screen later
  await ready(page);
  const hash = await page.evaluate(() => location.hash);
  return Object.fromEntries(new URLSearchParams(hash.slice(1)));
};

/** What is written under the pictures: the pixel, and the texts of each set's row. */
const readings = (page) => page.evaluate(() => ({
  pixel: document.querySelector(".values caption").textContent.match(/^Pixel (\d+), (\d+)/)
    ?.slice(1).map(Number) ?? null,
  rows: [...document.querySelectorAll(".values tbody tr")].map((row) =>
    [...row.querySelectorAll("td")].map((cell) => cell.textContent)),
}));

const numberOf = (text) => ({ "∞": Infinity, "−∞": -Infinity, "−0": -0 }[text]
  ?? Math.fround(Number(text.replace("−", "-"))));

/** Where a pixel is in the window, when the whole picture is shown or at a zoom about x, y. */
async function placeOf(page, data, x, y, pane = 0, zoomed = null) {
  return page.evaluate(([[w, h], px, py, n, zoom]) => {
    const box = document.querySelectorAll(".pane canvas")[n].getBoundingClientRect();
    const dots = devicePixelRatio;
    const scale = zoom ? zoom.zoom
      : Math.floor(Math.min((box.width * dots) / w, (box.height * dots) / h));
    const [cx, cy] = zoom ? [zoom.x, zoom.y] : [w / 2, h / 2];
    return [box.left + ((px + 0.5 - cx) * scale) / dots + box.width / 2,
      box.top + ((py + 0.5 - cy) * scale) / dots + box.height / 2];
  }, [data.size_px, x, y, pane, zoomed]);
}

/** The colour on the canvas at a place of the window. */
const colourAt = (page, [left, top], pane = 0) => page.evaluate(([x, y, n]) => {
  const canvas = document.querySelectorAll(".pane canvas")[n];
  const box = canvas.getBoundingClientRect();
  const at = [(x - box.left) * devicePixelRatio, (y - box.top) * devicePixelRatio];
  return [...canvas.getContext("2d").getImageData(Math.floor(at[0]), Math.floor(at[1]), 1, 1).data];
}, [left, top, pane]);

// ------------------------------------------------------------------------------------- values

/** Under the pointer, over each of some pixels: the very floats of the files. */
async function checkValues(page, data, expected) {
  for (const { set, frame, quantity, x, y, values } of expected.pixels) {
    await go(page, { mode: "one", set, frame, quantity });
    await page.mouse.move(...await placeOf(page, data, x, y));
    await hashOf(page);
    const { pixel, rows } = await readings(page);
    const where = `${quantity} of set ${set}, frame ${frame}, pixel ${x}, ${y}`;
    same(`${where}: the pixel`, pixel, [x, y]);
    values.forEach((value, c) => {
      if (!Object.is(numberOf(rows[set][c] ?? ""), Math.fround(value)))
        find(`${where}: the page reads ${rows[set][c]}, the file ${value}`);
    });
  }
  for (const { set, frame, map, x, y, values } of expected.maps ?? []) {
    await go(page, { mode: "one", set, frame, map, px: x, py: y });
    const text = (await readings(page)).rows[set].at(-1);
    same(`${map} of set ${set} at ${x}, ${y}`, text.split(" ").map(numberOf),
      values.map(Math.fround));
  }
}

/** The closed form of IEC 61966-2-1. */
function codeOf(linear) {
  const v = Math.min(1, Math.max(0, linear));
  return 255 * (v <= 0.0031308 ? 12.92 * v : 1.055 * v ** (1 / 2.4) - 0.055);
}

async function checkColours(page, data, expected) {
  for (const { set, frame, quantity, x, y, values } of expected.pixels) {
    if (quantity !== "radiance") continue;
    for (const ev of [0, -2, 3]) {
      await go(page, { mode: "one", set, frame, ev, view: 0 });
      const seen = await colourAt(page, await placeOf(page, data, x, y));
      values.forEach((value, c) => {
        const wanted = codeOf(Math.fround(value) * 2 ** ev);
        if (Math.abs(seen[c] - wanted) > 0.52) // rounding, and float arithmetic: see test_display.c
          find(`set ${set}, pixel ${x}, ${y} at ${ev} EV: code ${seen[c]}, not ${wanted}`);
      });
    }
  }
}

/** The view of a config: as near as the page says that its table is. */
async function checkViews(page, data, expected) {
  for (const { set, x, y, ev, codes } of expected.views ?? []) {
    await go(page, { mode: "one", set, ev, view: 1 });
    const seen = await colourAt(page, await placeOf(page, data, x, y));
    codes.forEach((code, c) => {
      if (Math.abs(seen[c] - code) > 0.5 + data.cube.error_max)
        find(`set ${set}, pixel ${x}, ${y} by ${data.cube.name}: code ${seen[c]}, not ${code}`);
    });
  }
}

// ------------------------------------------------------------------------------------- differences

async function checkDifferences(page, data, expected) {
  const { below, above, stops } = data.differences;
  const valueOf = (probe) => 0.2126 * probe.values[0] + 0.7152 * probe.values[1]
    + 0.0722 * probe.values[2];
  const probes = expected.pixels.filter(({ quantity, frame }) => quantity === "radiance"
    && frame === 0);
  let told = 0;
  for (const one of probes.filter(({ set }) => set === 0)) {
    const other = probes.find(({ set, x, y }) => set === 1 && x === one.x && y === one.y);
    if (!other) continue;
    await go(page, { mode: "difference", ref: 0, set: 1 });
    const seen = await colourAt(page, await placeOf(page, data, one.x, one.y));
    const relative = (valueOf(other) - valueOf(one)) / data.quantities[0].difference_scale;
    const wanted = relative > 1 ? above : relative < -1 ? below : relative === 0
      ? stops.find(({ position }) => position === 0).rgb : null;
    if (wanted) same(`the difference at ${one.x}, ${one.y}`, seen.slice(0, 3), wanted);
    told += wanted !== null;
    await go(page, { mode: "difference", ref: 1, set: 0 });
    if (relative > 1) same("the difference the other way",
      (await colourAt(page, await placeOf(page, data, one.x, one.y))).slice(0, 3), below);
  }
  if (told < 3) find("no three differences were looked at");
}

// ------------------------------------------------------------------------------------- keys

/** Each key, from a state, and what the address must then say. */
async function checkKeys(page, data) {
  const last = data.frames - 1;
  const [w, h] = data.size_px;
  const base = { mode: "one", set: 1, px: 5, py: 5 };
  const map = data.overlays[0].name;
  for (const [from, key, wanted] of [
    [base, "1", { set: "0" }], [base, "Shift+Digit2", { ref: "1" }],
    [base, "a", { mode: "all" }], [base, "f", { mode: "flip" }],
    [base, "d", { mode: "difference" }],
    [base, "w", { mode: undefined }], [{ ...base, mode: "all" }, "s", { mode: "one" }],
    [base, "Space", { ref: "1", set: "0" }],
    [base, "q", { quantity: data.sets[1].quantities[1] }], [base, "o", { map }],
    [{ ...base, map: data.overlays.at(-1).name }, "o", { map: undefined }],
    [base, "v", { view: data.cube ? "0" : undefined }], [base, "e", { ev: "0.5" }],
    [base, "Shift+E", { ev: "-0.5" }],
    [base, "[", { gain: "-1" }], [base, "]", { gain: "1" }],
    [{ ...base, gain: 3, ev: 2 }, "r", { gain: undefined, ev: undefined }],
    [{ ...base, zoom: 8 }, "+", { zoom: "12" }], [{ ...base, zoom: 8 }, "-", { zoom: "6" }],
    [{ ...base, zoom: 8 }, "z", { zoom: undefined }],
    [base, "ArrowLeft", { px: "4" }], [base, "ArrowRight", { px: "6" }],
    [base, "ArrowUp", { py: "4" }], [base, "ArrowDown", { py: "6" }],
    [base, "Shift+ArrowRight", { px: "15" }],
    [{ ...base, px: w - 1, py: h - 1 }, "ArrowRight", { px: String(w - 1) }],
    [base, ".", { frame: "1" }], [{ ...base, frame: 3 }, ",", { frame: "2" }],
    [base, ">", { frame: "4" }], [{ ...base, frame: 6 }, "<", { frame: "2" }],
    [base, "<", { frame: String(data.frames - 4) }], [base, "End", { frame: String(last) }],
    [{ ...base, frame: 6 }, "Home", { frame: undefined }],
  ]) {
    await go(page, from);
    await page.evaluate(() => document.activeElement.blur());
    await page.keyboard.press(key);
    const seen = await hashOf(page);
    for (const [name, value] of Object.entries(wanted))
      same(`key ${key}: ${name}`, seen[name], value);
  }
}

async function checkHelp(page) {
  await go(page, {});
  await page.keyboard.press("?");
  if (!await page.locator("dialog[open]").count()) find("? shows no list of keys");
  if (!await page.evaluate(() => document.activeElement.closest("dialog")))
    find("the list of keys does not take the focus");
  for (const text of await page.evaluate(faintTexts)) find(`help: too little contrast: ${text}`);
  await page.keyboard.press("Escape");
  if (await page.locator("dialog[open]").count()) find("Escape does not close the list of keys");
}

/** Played: all frames in turn, or the four of a cycle and no others. */
async function checkTime(page, data) {
  const framesSeen = async () => {
    const seen = new Set();
    for (let n = 0; n < 40; n++) {
      seen.add(Number((await page.locator("output").textContent()).match(/^frame (\d+)/)[1])
        - data.first_number);
      await page.waitForTimeout(25);
    }
    return [...seen].sort((a, b) => a - b);
  };
  await go(page, { mode: "one", set: 1, frame: 5 });
  await page.keyboard.press("c");
  same("frames of the cycle from 5 on", await framesSeen(), [5, 6, 7, 8]);
  await page.keyboard.press("c");
  const stopped = await hashOf(page);
  same("stopped", await hashOf(page), stopped);
  await page.keyboard.press("k");
  if ((await framesSeen()).length < Math.min(6, data.frames)) find("k does not play");
  await page.keyboard.press("k");
}

// ------------------------------------------------------------------------------------- pointer

async function checkPointer(page, data) {
  const [x, y] = [7, 4];
  await go(page, { mode: "all" });
  const from = await placeOf(page, data, x, y);
  await page.mouse.move(...from);
  await page.mouse.wheel(0, -100);
  await page.mouse.wheel(0, -100);
  const zoomed = await hashOf(page);
  if (!(Number(zoomed.zoom) > 0)) find("the wheel does not zoom");
  same("the pixel under the wheel stays", (await readings(page)).pixel, [x, y]);

  await page.mouse.down();
  await page.mouse.move(from[0] + 30, from[1] + 20, { steps: 3 });
  await page.mouse.up();
  const moved = await hashOf(page);
  same("the pixel goes with the drag", (await readings(page)).pixel, [x, y]);
  const zoom = { zoom: Number(moved.zoom), x: Number(moved.x), y: Number(moved.y) };
  for (let pane = 0; pane < data.sets.length; pane++) {
    await page.mouse.move(...await placeOf(page, data, 9, 6, pane, zoom));
    await hashOf(page);
    same(`pane ${pane} has moved with the others`, (await readings(page)).pixel, [9, 6]);
  }

  await go(page, { mode: "wipe", ref: 0, set: 1 });
  const box = await page.locator(".pane canvas").boundingBox();
  await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
  await page.mouse.down();
  await page.mouse.move(box.x + box.width / 4, box.y + box.height / 2, { steps: 3 });
  await page.mouse.up();
  const { wipe } = await hashOf(page);
  if (Math.abs(Number(wipe) - 0.25) > 0.01) find(`the line of the wipe is dragged to ${wipe}`);
}

/** A browser stops a page that changes its address all the time: five times a second is enough. */
async function checkCalm(page, data) {
  await go(page, { mode: "one" });
  await page.evaluate(() => {
    const replace = history.replaceState.bind(history);
    window.addressChanges = 0;
    history.replaceState = (...words) => { window.addressChanges++; replace(...words); };
  });
  const start = Date.now();
  for (let n = 0; n < 60; n++)
    await page.mouse.move(...await placeOf(page, data, n % data.size_px[0], 3));
  await hashOf(page);
  const count = await page.evaluate(() => window.addressChanges);
  const most = 2 + (Date.now() - start) / 200;
  if (count < 2 || count > most) find(`${count} changes of the address, not 2 to ${most}`);
}

/** The same address, the same picture and words. */
async function checkLink(browser, folder, page) {
  const words = { mode: "difference", set: "0", ref: "1", ev: "1.5", zoom: "24", x: "8.25",
    y: "6.5", wipe: "0.375", px: "3", py: "2", frame: "2", map: "flip", mix: "0.5", gain: "2",
    quantity: "depth" };
  await go(page, words);
  for (const [name, seen] of Object.entries(await hashOf(page)))
    same(`an address with ${name}`, seen, words[name]);
  same("the words of an address", Object.keys(await hashOf(page)).length,
    Object.keys(words).length);
  await go(page, { ...words, mode: "wipe", set: 1, ref: 0, quantity: "radiance" });
  await page.keyboard.press("]");
  await page.keyboard.press(".");
  await hashOf(page);
  const look = (of) => of.evaluate(() => [document.querySelector(".pane canvas").toDataURL(),
    document.querySelector("main").innerText]);
  const hash = await page.evaluate(() => location.hash);
  const again = await open(browser, folder, hash, {});
  await hashOf(again.page);
  const [one, two] = [await look(page), await look(again.page)];
  if (one[0] !== two[0]) find(`the address ${hash} does not restore the picture`);
  same("the address restores the words", two[1], one[1]);
  await again.context.close();
  // An address that makes no sense is none.
  for (const odd of ["#mode=x&set=99&zoom=-3&x=Infinity&frame=1e9&px=5", "#%E0%A4%A",
    "#=&=&&ev=a"]) {
    const strange = await open(browser, folder, odd, {});
    if (!await strange.page.locator(".pane canvas").count()) find(`nothing is shown at ${odd}`);
    await strange.context.close();
  }
}

// ------------------------------------------------------------------------------------- reading

/** By the tabulator alone: everything has a name, and shows that it has the focus. */
async function checkFocus(page) {
  await go(page, { mode: "difference", map: "flip" });
  await page.evaluate(() => document.activeElement.blur());
  const total = await page.evaluate(() => [...document.querySelectorAll(
    "a, button, input, select, [tabindex='0']")].filter((e) => e.checkVisibility()).length);
  const seen = new Set();
  for (let n = 0; n <= total; n++) { // and once over the page itself
    await page.keyboard.press("Tab");
    const focused = await page.evaluate(() => {
      const element = document.activeElement;
      const style = getComputedStyle(element);
      const name = element.getAttribute("aria-label") ?? element.labels?.[0]?.textContent
        ?? element.textContent;
      return { name: name.trim(), tag: element.tagName,
        outlined: style.outlineStyle !== "none" && parseFloat(style.outlineWidth) >= 2 };
    });
    if (focused.tag === "BODY") continue;
    if (!focused.name) find(`a ${focused.tag} has no name`);
    if (!focused.outlined) find(`${focused.tag} "${focused.name}" does not show its focus`);
    seen.add(focused.name);
  }
  if (seen.size < total) find(`the tabulator reaches ${seen.size} of ${total} controls`);
}

async function checkWindows(browser, folder, keep) {
  for (const [where, hash, options] of [
    ["wide", "#mode=wipe&px=3&py=3", {}],
    ["dark", "#mode=difference&px=3&py=3", { colorScheme: "dark" }],
    ["narrow", "#mode=difference&map=flip&px=3&py=3", { viewport: { width: 390, height: 844 },
        deviceScaleFactor: 3, hasTouch: true }],
    ["near", "#mode=all&zoom=64&x=6&y=5", {}],
  ]) {
    const { context, page } = await open(browser, folder, hash, options);
    const [width, window] = await page.evaluate(() =>
      [document.documentElement.scrollWidth, innerWidth]);
    if (width > window) find(`${where}: the page scrolls sideways (${width} of ${window} px)`);
    for (const text of await page.evaluate(faintTexts))
      find(`${where}: too little contrast: ${text}`);
    await keep(page, where);
    await context.close();
  }
}

// ------------------------------------------------------------------------------------- main

const options = readArguments(
  "node check_view.mjs [--quick] [--screenshots DIR] PAGE_DIR EXPECTED.json", 2, ["quick"]);
const [folder, wanted] = options.places;
const keep = async (page, name) => {
  if (options.screenshots)
    await page.screenshot({ path: join(options.screenshots, `${name}.png`) });
};

await conclude("the viewer", SHOWN_MOST, () => browse(async (browser) => {
  const data = readJson(folder, "data.json"), expected = readJson(wanted);
  const { page } = await open(browser, folder, "", {});
  await checkValues(page, data, expected);
  await checkColours(page, data, expected);
  if (options.quick) return;
  await checkViews(page, data, expected);
  await checkDifferences(page, data, expected);
  await checkKeys(page, data);
  await checkHelp(page);
  await checkTime(page, data);
  await checkPointer(page, data);
  await checkCalm(page, data);
  await checkLink(browser, folder, page);
  await checkFocus(page);
  await checkWindows(browser, folder, keep);
}));
