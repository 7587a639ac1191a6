// SPDX-License-Identifier: MIT
//
// The viewer of neph view. One object, `state`, describes the view. Controls and keys change it,
// the address stores it, and render() shows it. Strings of the data reach the page as text nodes
// only, never as markup.
(function () {
  "use strict";

  const data = window.NEPH_VIEW;
  const main = document.getElementById("main");
  const { el, colHead, rowHead, row, table, complain } = window.NephPage;
  const { want, keep, have } = window.NephPlanes;
  const { display, byCodes, byCube, paintPicture, paintDepth, paintValues, valueOf, differenceOf,
    gradient } = window.NephPaint;

  if (data?.format !== "neph-view-1")
    return complain(main, "This page has no data",
      "data.js in the folder of this page is missing or has another version.");

  const [width, height] = data.size_px;
  const pixels = width * height;
  const codeOf = display(data.display_codes);
  const plainColours = byCodes(codeOf);
  const VIEWS = ["sRGB", ...(data.cube ? [data.cube.name] : [])];
  const MODES = [["one", "One", "s", "one set only"], ["all", "All", "a", "all sets side by side"],
    ["wipe", "Wipe", "w", "wipe from the reference to the shown set"],
    ["flip", "Flip", "f", "alternate the reference and the shown set, twice a second"],
    ["difference", "Difference", "d", "shown − reference"]];
  // Device pixels per pixel of a frame, from small to large; 0 is the largest zoom that fits.
  const ZOOMS = [0.125, 0.25, 0.5, 1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64, 96, 128, 192];
  const NUMBERS_FROM = 48; // CSS pixels of a frame pixel with room for its values
  const ADDRESS_MS = 200; // minimum time between two changes of the address
  const FLIP_MS = 500; // per side; slower than flashes that can cause a seizure

  const quantities = data.quantities
    .filter(({ name }) => data.sets.some((set) => set.quantities.includes(name)));
  const START = {
    mode: data.sets.length > 1 ? "wipe" : "one", ref: 0, set: Math.min(1, data.sets.length - 1),
    quantity: quantities[0].name, map: "", mix: 1, ev: data.exposure_ev, gain: 0, frame: 0,
    view: VIEWS.length - 1,
    zoom: 0, x: width / 2, y: height / 2, wipe: 0.5, px: -1, py: -1,
  };
  const state = { ...START };
  let flipped = false; // true: a flip shows the reference
  let playing = null; // {first, count} of the played frames
  let timer = 0;

  const clamp = (value, low, high) => Math.min(high, Math.max(low, value));

  // ------------------------------------------------------------------------------------- planes

  const quantityNamed = (name) => quantities.find((quantity) => quantity.name === name);
  const overlayNamed = (name) => data.overlays.find((overlay) => overlay.name === name);
  const frameOf = (set) => (data.sets[set].files.length > 1 ? state.frame : 0);

  /** The key of the planes of the quantity in a set; null if the set has no such quantity. */
  const keyOf = (set) => (data.sets[set].quantities.includes(state.quantity)
    ? `${set}_${frameOf(set)}_${state.quantity}` : null);

  function mapKeyOf(set) {
    const overlay = overlayNamed(state.map);
    if (!overlay?.sets.includes(set)) return null;
    return `${set}_${overlay.temporal ? "all" : frameOf(set)}_map_${overlay.name}`;
  }

  /** The keys of all planes that the current view shows. */
  function keysNeeded() {
    const shown = state.mode === "all" ? data.sets.map((_, s) => s)
      : state.mode === "one" ? [state.set] : [state.ref, state.set];
    return [...shown.map(keyOf), ...shown.map(mapKeyOf), isViewed() ? "cube" : null]
      .filter((key) => key !== null);
  }

  /** Whether the config's view converts the colours: it does for light, not for transmittance and
   * depth. */
  const isViewed = () => state.view > 0 && ["radiance", "volume"].includes(state.quantity);

  let cubeColours = null;
  function colours() {
    if (!isViewed()) return plainColours;
    cubeColours ??= byCube(data.cube, have("cube"));
    return cubeColours;
  }

  // Three planes of a quantity and three of a map for each set, and the config's view.
  keep(4 * (6 * pixels * data.sets.length + (data.cube ? 3 * data.cube.side ** 3 : 0)));

  const keysOfValues = () => data.sets.flatMap((_, s) => [keyOf(s), mapKeyOf(s)])
    .filter((key) => key !== null);

  // ------------------------------------------------------------------------------------- painting

  const painted = new Map(); // canvases of the frames' size, by their contents
  const PAINTED_MOST = 24;

  /** The canvas `name`, of the frames' size; `paint` fills it unless it is cached. */
  function sheet(name, paint) {
    let canvas = painted.get(name);
    if (!canvas) {
      canvas = el("canvas", { width, height });
      const image = new ImageData(width, height);
      paint(image.data);
      canvas.getContext("2d").putImageData(image, 0, 0);
    }
    painted.delete(name);
    painted.set(name, canvas);
    if (painted.size > PAINTED_MOST) painted.delete(painted.keys().next().value);
    return canvas;
  }

  let nearest = null; // least depth of the first frame shown; all frames use this scale
  function nearestOf(plane) {
    nearest ??= plane.reduce((least, z) => (z > 0 && z < least ? z : least), Infinity);
    return nearest;
  }

  /** The frame of a set at the exposure; null while it is loaded, and without its planes. */
  function picture(set) {
    const key = keyOf(set);
    const planes = key && have(key);
    if (!planes || (isViewed() && !have("cube"))) return null;
    const gain = 2 ** state.ev;
    return sheet(`${key} ${state.ev} ${state.view}`, (rgba) => (planes.length === 1
      ? paintDepth(rgba, planes[0], nearestOf(planes[0]), gain, codeOf)
      : paintPicture(rgba, planes, state.quantity === "transmittance" ? 1 : gain, colours())));
  }

  const differenceScale = () =>
    quantityNamed(state.quantity).difference_scale * 2 ** state.gain;
  const overlayScale = () => overlayNamed(state.map).scale * 2 ** state.gain;

  function difference() {
    const [reference, shown] = bothPlanes();
    if (!reference || !shown) return null;
    return sheet(`${keyOf(state.ref)} ${keyOf(state.set)} ${state.gain}`, (rgba) => paintValues(
      rgba, pixels, (i) => differenceOf(reference, shown, i), data.differences, differenceScale()));
  }

  function overlay(set) {
    const key = mapKeyOf(set);
    const planes = key && have(key);
    if (!planes) return null;
    const colours = overlayNamed(state.map).is_signed ? data.differences : data.amounts;
    return sheet(`${key} ${state.gain}`, (rgba) => paintValues(rgba, pixels,
      (i) => valueOf(planes, i), colours, overlayScale()));
  }

  // ------------------------------------------------------------------------------------- geometry

  const dots = () => window.devicePixelRatio || 1;

  /** The current zoom: device pixels per pixel of a frame. */
  function zoomIn(box) {
    if (state.zoom > 0) return state.zoom;
    const room = Math.min((box.width * dots()) / width, (box.height * dots()) / height);
    return room >= 1 ? Math.floor(room) : room;
  }

  /** The place of a frame in a pane: its upper left corner and a pixel's size, in device pixels. */
  function placeIn(box) {
    const scale = zoomIn(box);
    const [x, y] = state.zoom > 0 ? [state.x, state.y] : [width / 2, height / 2];
    return { scale, left: Math.round((box.width * dots()) / 2 - x * scale),
      top: Math.round((box.height * dots()) / 2 - y * scale) };
  }

  /** The frame coordinates [px] below the pointer, with fractions. */
  function pointIn(pane, event) {
    const box = pane.canvas.getBoundingClientRect();
    const { scale, left, top } = placeIn(box);
    return [((event.clientX - box.left) * dots() - left) / scale,
      ((event.clientY - box.top) * dots() - top) / scale];
  }

  function zoomTo(zoom, x, y, box) {
    const before = placeIn(box);
    const half = [(box.width * dots()) / 2, (box.height * dots()) / 2];
    const at = [before.left + x * before.scale, before.top + y * before.scale];
    state.zoom = zoom;
    state.x = clamp(x + (half[0] - at[0]) / zoom, 0, width);
    state.y = clamp(y + (half[1] - at[1]) / zoom, 0, height);
  }

  /** Zooms in (step > 0) or out by a step, around a fixed pixel. */
  function zoomBy(step, x, y) {
    const box = panes[0].canvas.getBoundingClientRect();
    const now = zoomIn(box);
    const next = step > 0 ? ZOOMS.find((zoom) => zoom > now * 1.001)
      : ZOOMS.findLast((zoom) => zoom < now * 0.999);
    if (next) zoomTo(next, x ?? (state.zoom ? state.x : width / 2),
      y ?? (state.zoom ? state.y : height / 2), box);
  }

  // ------------------------------------------------------------------------------------- panes

  let panes = []; // {element, canvas, name, other, bar, lack, sets}
  const stage = el("div", { class: "stage", tabindex: 0, role: "group",
    "aria-label": "Frames; arrow keys move the cursor over pixels, ? lists all keys" });

  function makePane() {
    const canvas = el("canvas", { role: "img" });
    const [name, other] = [el("span", { class: "name" }), el("span", { class: "name right" })];
    const colours = el("div", { class: "bar-colours" });
    const ends = el("div", { class: "ends" });
    const title = el("div", {});
    const bar = el("div", { class: "scale-bar" }, title, colours, ends);
    const lack = el("div", { class: "lack" });
    const pane = { canvas, name, other, bar, title, colours, ends, lack,
      element: el("div", { class: "pane" }, canvas, lack, name, other, bar) };
    listen(pane);
    return pane;
  }

  function layPanes() {
    const count = state.mode === "all" ? data.sets.length : 1;
    while (panes.length < count) panes.push(makePane());
    panes.length = count;
    const box = stage.getBoundingClientRect();
    let columns = 1; // the count that makes the panes largest
    const room = (n) => Math.min(box.width / n / width, box.height / Math.ceil(count / n) / height);
    for (let n = 2; n <= count; n++) if (room(n) > room(columns)) columns = n;
    stage.style.gridTemplateColumns = `repeat(${columns}, minmax(0, 1fr))`;
    stage.style.gridAutoRows = "minmax(0, 1fr)";
    if (stage.childElementCount !== count)
      stage.replaceChildren(...panes.map(({ element }) => element));
  }

  const labelOf = (set) => `${set + 1} ${data.sets[set].label}`;

  /** The contents of a pane: the set below, the set right of the wipe line, and their labels. */
  function contentOf(n) {
    const { ref, set, mode } = state;
    if (mode === "wipe") return { base: ref, over: set, name: labelOf(ref), other: labelOf(set) };
    if (mode === "difference") return { name: `${labelOf(set)} − ${labelOf(ref)}` };
    const base = mode === "all" ? n : mode === "flip" && flipped ? ref : set;
    return { base, name: labelOf(base) };
  }

  function fillBar(pane, colours, low, high, text) {
    pane.bar.hidden = !colours;
    if (!colours) return;
    pane.colours.style.background = gradient(colours);
    pane.title.textContent = text;
    const numbers = (low < 0 ? [low, 0, high] : [low, high])
      .map((value) => el("span", {}, short(value)));
    pane.ends.replaceChildren(...(low < 0 ? [beyond(colours.below)] : []), ...numbers,
      beyond(colours.above));
  }

  /** A patch of the colour of values beyond an end of the scale. */
  function beyond(rgb) {
    const patch = el("span", { class: "patch", title: "beyond the scale" });
    patch.style.background = `rgb(${rgb.join(" ")})`;
    return patch;
  }

  function drawSheet(context, place, sheet, from, to, alpha) {
    context.save();
    context.beginPath();
    context.rect(from, 0, to - from, context.canvas.height);
    context.clip();
    context.globalAlpha = alpha;
    context.imageSmoothingEnabled = place.scale < 1;
    context.drawImage(sheet, place.left, place.top, width * place.scale, height * place.scale);
    context.restore();
  }

  function drawSet(context, place, set, from, to) {
    const below = picture(set);
    const above = state.map ? overlay(set) : null;
    if (below) drawSheet(context, place, below, from, to, 1);
    if (above) drawSheet(context, place, above, from, to, state.mix);
    return below !== null;
  }

  function drawPane(pane, n) {
    const { canvas } = pane;
    const box = canvas.getBoundingClientRect();
    canvas.width = Math.max(1, Math.round(box.width * dots()));
    canvas.height = Math.max(1, Math.round(box.height * dots()));
    const context = canvas.getContext("2d");
    const place = placeIn(box);
    const { base, over, name, other } = contentOf(n);
    const edge = over === undefined ? canvas.width : Math.round(state.wipe * canvas.width);
    let complete = true;
    if (state.mode === "difference") {
      const image = difference();
      complete = image !== null;
      if (image) drawSheet(context, place, image, 0, canvas.width, 1);
    } else {
      complete = drawSet(context, place, base, 0, edge);
      if (over !== undefined) {
        complete = drawSet(context, place, over, edge, canvas.width) && complete;
        context.fillStyle = "#fff";
        context.fillRect(edge - 1, 0, 2, canvas.height);
      }
    }
    drawNumbers(context, place, over === undefined ? base : null, edge);
    drawCursor(context, place);
    pane.name.textContent = name;
    pane.other.textContent = other ?? "";
    pane.other.hidden = !other;
    canvas.setAttribute("aria-label", `${name}${other ? ` left, ${other} right` : ""}: `
      + `${state.quantity}, frame ${data.first_number + state.frame}`);
    tellLack(pane, complete, base, over);
    tellScale(pane, n === panes.length - 1);
  }

  /** Shows the colour scale; the scale of an overlay only in the last pane. */
  function tellScale(pane, isLast) {
    const overlay = state.map ? overlayNamed(state.map) : null;
    if (state.mode === "difference") {
      const { unit } = quantityNamed(state.quantity);
      fillBar(pane, data.differences, -differenceScale(), differenceScale(),
        `shown − reference [${data.is_picture ? "display value" : unit}]`);
    } else if (overlay && isLast) {
      fillBar(pane, overlay.is_signed ? data.differences : data.amounts,
        overlay.is_signed ? -overlayScale() : 0, overlayScale(),
        `${overlay.name} [${overlay.unit}], reference ${labelOf(0)}`);
    } else {
      fillBar(pane, null);
    }
  }

  const failures = new Map(); // error messages of keys that could not be loaded

  /** Shows the reason why a frame or map is missing. */
  function tellLack(pane, complete, ...sets) {
    const shown = state.mode === "difference" ? [state.ref, state.set]
      : sets.filter((set) => set !== undefined);
    const without = shown.find((set) => keyOf(set) === null);
    const failed = shown.map(keyOf).find((key) => failures.has(key));
    const noMap = state.map && state.mode !== "difference"
      && shown.every((set) => mapKeyOf(set) === null) && shown.some((set) => set !== 0);
    const text = without !== undefined
      ? `${labelOf(without)} has no ${state.quantity}`
      : failed ? failures.get(failed)
      : noMap ? `no ${state.map} of ${labelOf(shown.at(-1))}: ${whyNoMap(shown.at(-1))}`
      : complete ? "" : "loading";
    pane.lack.replaceChildren(...(text ? [el("span", {}, text)] : []));
  }

  const whyNoMap = (set) => data.not_taken.find((row) => row.set === set
    && (row.overlay === state.map || row.overlay === "all"))?.because ?? "it was not computed";

  function drawCursor(context, { scale, left, top }) {
    if (state.px < 0) return;
    const size = Math.max(3, scale);
    const [x, y] = [left + state.px * scale, top + state.py * scale];
    context.lineWidth = Math.max(1, Math.round(dots()));
    for (const [colour, grow] of [["#000", 1.5], ["#fff", 0.5]]) {
      context.strokeStyle = colour;
      context.strokeRect(x - grow * context.lineWidth, y - grow * context.lineWidth,
        size + 2 * grow * context.lineWidth, size + 2 * grow * context.lineWidth);
    }
  }

  /** Writes values into large pixels; each side of a wipe has the values of its set. */
  function drawNumbers(context, place, set, edge) {
    const { scale, left, top } = place;
    if (scale / dots() < NUMBERS_FROM) return;
    const size = Math.round(Math.min(scale / 5.4, 13 * dots()));
    context.font = `${size}px ui-monospace, "DejaVu Sans Mono", monospace`;
    context.textAlign = "center";
    context.textBaseline = "middle";
    const x0 = Math.max(0, Math.floor(-left / scale));
    const y0 = Math.max(0, Math.floor(-top / scale));
    const x1 = Math.min(width, Math.ceil((context.canvas.width - left) / scale));
    const y1 = Math.min(height, Math.ceil((context.canvas.height - top) / scale));
    for (let y = y0; y < y1; y++) {
      for (let x = x0; x < x1; x++) {
        const centre = left + (x + 0.5) * scale;
        const own = set ?? (state.mode === "wipe" ? (centre < edge ? state.ref : state.set) : null);
        writePixel(context, linesOf(own, y * width + x), centre, top + (y + 0.5) * scale, size);
      }
    }
  }

  function linesOf(set, i) {
    if (set === null || set === undefined) return [differenceAt(i)].filter((v) => v !== null);
    const map = state.map && mapKeyOf(set) && have(mapKeyOf(set));
    const planes = map || have(keyOf(set) ?? "");
    return planes ? planes.map((plane) => plane[i]) : [];
  }

  function writePixel(context, values, x, y, size) {
    values.forEach((value, n) => {
      const at = y + (n - (values.length - 1) / 2) * size * 1.15;
      context.lineWidth = size / 5;
      context.strokeStyle = "#000c";
      context.fillStyle = "#fff";
      const text = short(value);
      context.strokeText(text, x, at);
      context.fillText(text, x, at);
    });
  }

  // ------------------------------------------------------------------------------------- values

  /** The fewest digits, at least 6, that give the same float32 again. */
  function exact(value) {
    if (!Number.isFinite(value)) return value > 0 ? "∞" : value < 0 ? "−∞" : "NaN";
    let text = "";
    for (let digits = 6; digits <= 9; digits++) {
      text = value.toPrecision(digits);
      if (Math.fround(Number(text)) === value) break;
    }
    return Object.is(value, -0) ? "−0" : String(Number(text)).replace(/-/g, "−");
  }

  function short(value) {
    if (!Number.isFinite(value)) return exact(value);
    const size = Math.abs(value);
    const text = size !== 0 && (size < 1e-3 || size >= 1e4) ? value.toExponential(1)
      : String(Number(value.toPrecision(3)));
    return text.replace(/-/g, "−").replace("e+", "e");
  }

  /** The planes of the reference and of the shown set; undefined or null: missing. */
  const bothPlanes = () => [keyOf(state.ref), keyOf(state.set)].map((key) => key && have(key));

  function differenceAt(i) {
    const [reference, shown] = bothPlanes();
    return reference && shown ? differenceOf(reference, shown, i) : null;
  }

  const values = el("div", { class: "values", role: "region", "aria-label": "Values",
    tabindex: 0 });

  function valueRow(set, i) {
    const planes = have(keyOf(set) ?? "");
    const map = state.map && mapKeyOf(set) ? have(mapKeyOf(set)) : null;
    const columns = quantityNamed(state.quantity).planes;
    const cells = Array.from({ length: columns }, (_, c) => el("td", {},
      i < 0 || !planes ? "" : exact(planes[c][i])));
    if (state.map)
      cells.push(el("td", {}, i < 0 || !map ? "" : map.map((plane) => exact(plane[i])).join(" ")));
    return el("tr", { class: set === state.set ? "shown" : null }, rowHead(labelOf(set)), cells);
  }

  function differenceRow(i) {
    const [reference, shown] = bothPlanes();
    const columns = quantityNamed(state.quantity).planes;
    if (data.sets.length < 2 || !reference || !shown) return null;
    return row(rowHead(`${state.set + 1} − ${state.ref + 1}`),
      Array.from({ length: columns }, (_, c) => el("td", {},
        i < 0 ? "" : short(shown[c][i] === reference[c][i] ? 0 : shown[c][i] - reference[c][i]))));
  }

  function showValues() {
    const { px, py } = state;
    const i = px < 0 ? -1 : py * width + px;
    const quantity = quantityNamed(state.quantity);
    const names = quantity.planes === 3 ? ["R", "G", "B"] : ["Z"];
    const unit = data.is_picture ? "linear display value" : quantity.unit;
    const shown = table(null, ["Set", ...names, ...(state.map ? [state.map] : [])].map((name) =>
      colHead(name)), [data.sets.map((_, s) => valueRow(s, i)), differenceRow(i)]);
    shown.prepend(el("caption", {}, i < 0
      ? "Point at a pixel, or move the cursor with the arrow keys, for values"
      : `Pixel ${px}, ${py} from the upper left: ${quantity.name} [${unit}]`));
    values.replaceChildren(shown);
  }

  // ------------------------------------------------------------------------------------- address

  const NUMERIC = ["mix", "ev", "gain", "frame", "zoom", "x", "y", "wipe", "px", "py", "ref",
    "set", "view"];
  const round = (value) => Math.round(value * 1000) / 1000;

  function writeAddress() {
    const written = (value) => (typeof value === "number" ? round(value) : value);
    const words = Object.keys(START).filter((name) => state[name] !== START[name])
      .map((name) => `${name}=${written(state[name])}`);
    const hash = words.length > 0 ? `#${words.join("&")}` : "#";
    if (hash !== (location.hash || "#")) history.replaceState(null, "", hash);
  }

  let isWritten = true;
  let writtenAt = -Infinity;

  /** Writes the address, at most once in ADDRESS_MS: browsers stop a page that changes its address
   * too often. */
  function keepAddress() {
    if (!isWritten) return;
    const wait = writtenAt + ADDRESS_MS - performance.now();
    isWritten = wait <= 0;
    if (isWritten) {
      writtenAt = performance.now();
      writeAddress();
    } else {
      setTimeout(() => {
        isWritten = true;
        change(() => {});
      }, wait);
    }
  }

  /** Sets the state from the address; invalid values are ignored or clamped. */
  function readAddress() {
    Object.assign(state, START);
    for (const [name, text] of new URLSearchParams(location.hash.slice(1))) {
      if (NUMERIC.includes(name) && text && Number.isFinite(Number(text)))
        state[name] = Number(text);
      if (["mode", "quantity", "map"].includes(name)) state[name] = text;
    }
    keepInside();
  }

  function keepInside() {
    const whole = (name, count) => {
      state[name] = clamp(Math.round(state[name]), 0, count - 1);
    };
    if (!MODES.some(([mode]) => mode === state.mode)) state.mode = START.mode;
    if (!quantityNamed(state.quantity)) state.quantity = START.quantity;
    if (!overlayNamed(state.map)) state.map = "";
    for (const [name, count] of [["ref", data.sets.length], ["set", data.sets.length],
      ["frame", data.frames], ["view", VIEWS.length]]) whole(name, count);
    state.gain = Math.round(state.gain);
    for (const [name, low, high] of [["ev", -32, 32], ["gain", -40, 40], ["mix", 0, 1],
      ["wipe", 0, 1], ["x", 0, width], ["y", 0, height]])
      state[name] = clamp(state[name], low, high);
    state.zoom = state.zoom > 0 ? clamp(state.zoom, ZOOMS[0], ZOOMS.at(-1)) : 0;
    if (state.px < 0 || state.py < 0) Object.assign(state, { px: -1, py: -1 });
    else for (const [name, count] of [["px", width], ["py", height]]) whole(name, count);
  }

  // ------------------------------------------------------------------------------------- controls

  const redo = []; // functions that update a control from the state

  function button(text, title, run, pressed) {
    const element = el("button", { type: "button", title, "aria-label": title }, text);
    element.addEventListener("click", () => change(run));
    if (pressed)
      redo.push(() => element.setAttribute("aria-pressed", String(pressed())));
    return element;
  }

  let controls = 0;
  function labelled(text, element) {
    const id = `control-${++controls}`;
    element.id = id;
    return el("span", { class: "group" }, el("label", { for: id }, text), element);
  }

  /** A labelled control of the value `name` of the state. */
  function bound(text, element, event, name, convert, show = String) {
    element.addEventListener(event, () => change(() => { state[name] = convert(element.value); }));
    redo.push(() => { element.value = show(state[name]); });
    return labelled(text, element);
  }

  const select = (text, options, name, convert) => bound(text, el("select", {},
    options.map(([value, label]) => el("option", { value }, label))), "change", name, convert);

  const slider = (text, max, step, name) => bound(text,
    el("input", { type: "range", min: 0, max, step }), "input", name, Number);

  const exposureControl = () => bound("Exposure [EV]",
    el("input", { type: "number", min: -32, max: 32, step: 0.5 }), "change", "ev",
    (value) => (value === "" ? START.ev : Number(value)), (ev) => String(round(ev)));

  function shownWhen(element, holds) {
    redo.push(() => { element.hidden = !holds(); });
    return element;
  }

  const several = data.sets.length > 1;
  const setOptions = data.sets.map((_, s) => [s, labelOf(s)]);

  function setStrip() {
    return several && el("div", { class: "strip" },
      el("span", { class: "group", role: "group", "aria-label": "Layout of the sets" },
        MODES.map(([mode, text, key]) => button(text, `${text} (${key})`,
          () => { state.mode = mode; }, () => state.mode === mode))),
      select("Reference", setOptions, "ref", Number),
      select("Shown", setOptions, "set", Number),
      shownWhen(slider("Wipe", 1, 0.01, "wipe"), () => state.mode === "wipe"));
  }

  function settingsStrip() {
    return el("div", { class: "strip settings" },
      select("Quantity", quantities.map(({ name }) => [name, name]), "quantity", String),
      data.overlays.length > 0 && select("Overlay", [["", "none"],
        ...data.overlays.map(({ name, help }) => [name, `${name}: ${help}`])], "map", String),
      data.overlays.length > 0 && shownWhen(slider("Opacity", 1, 0.05, "mix"),
        () => state.map !== ""),
      VIEWS.length > 1 && select("Colours", VIEWS.map((name, v) => [v, name]), "view", Number),
      exposureControl(),
      shownWhen(el("span", { class: "group" }, el("span", {}, "Scale"),
        button("÷2", "Half the colour scale ([)", () => { state.gain -= 1; }),
        button("×2", "Twice the colour scale (])", () => { state.gain += 1; })),
      () => state.mode === "difference" || state.map !== ""),
      el("span", { class: "group" }, el("span", {}, "Zoom"),
        button("−", "Zoom out (−)", () => zoomBy(-1)), button("+", "Zoom in (+)", () => zoomBy(1)),
        button("Fit", "The whole frame (z)", () => { state.zoom = 0; })),
      button("? Keys", "List of keys (?)", () => help.showModal()));
  }

  function timeStrip() {
    const place = el("output", {});
    redo.push(() => {
      place.textContent = `frame ${data.first_number + state.frame} of ${data.first_number} to `
        + `${data.first_number + data.frames - 1}`;
    });
    return el("div", { class: "strip time" },
      button("◂◂", "Back by four frames (<)", () => step(-4)),
      button("◂", "Back by one frame (,)", () => step(-1)),
      button("Play", "Play (k)", () => play(0, data.frames), () => playing?.count === data.frames),
      button("Cycle", "Play four frames from here (c)", playCycle,
        () => playing !== null && playing.count !== data.frames),
      button("▸", "Forward by one frame (.)", () => step(1)),
      button("▸▸", "Forward by four frames (>)", () => step(4)),
      slider("Time", data.frames - 1, 1, "frame"), place);
  }

  // ------------------------------------------------------------------------------------- time

  const step = (count) => { state.frame = (state.frame + count + 8 * data.frames) % data.frames; };
  const play = (first, count) => { playing = playing?.count === count ? null : { first, count }; };

  const playCycle = () => play(Math.min(state.frame, Math.max(0, data.frames - 4)),
    Math.min(4, data.frames));

  /** Starts the timer of the next played frame, or of the other side of a flip. */
  function keepTime() {
    clearTimeout(timer);
    if (playing && data.frames > 1) {
      timer = setTimeout(() => change(() => {
        const { first, count } = playing;
        state.frame = first + ((state.frame - first + 1 + count) % count);
      }), 1000 / data.rate_hz);
    } else if (state.mode === "flip") {
      timer = setTimeout(() => change(() => { flipped = !flipped; }), FLIP_MS);
    }
  }

  // ------------------------------------------------------------------------------------- keys

  const moveCursor = (x, y) => ({ shiftKey }) => {
    const [dx, dy] = shiftKey ? [10 * x, 10 * y] : [x, y];
    const isSet = state.px >= 0;
    state.px = clamp(isSet ? state.px + dx : Math.floor(width / 2), 0, width - 1);
    state.py = clamp(isSet ? state.py + dy : Math.floor(height / 2), 0, height - 1);
    if (state.zoom === 0) return;
    const box = panes[0].canvas.getBoundingClientRect();
    const half = [box.width, box.height].map((side) => (side * dots()) / state.zoom / 2 - 1);
    state.x = clamp(state.x, state.px - half[0], state.px + half[0] + 1);
    state.y = clamp(state.y, state.py - half[1], state.py + half[1] + 1);
  };

  const cycle = (list, now) => list[(list.indexOf(now) + 1) % list.length];

  const chooseSet = (name) => (event) => {
    const set = Number(event.code.slice(-1)) - 1;
    if (set >= 0 && set < data.sets.length) state[name] = set;
  };

  // For each entry of the list of keys: its keys, its description, and its actions by event.key.
  const KEYS = [
    ["?", "this list", { "?": () => (help.open ? help.close() : help.showModal()) }],
    ["1 … 9", "show the set of this number", { "1–9": chooseSet("set") }],
    ["Shift 1 … 9", "make the set the reference", { "Shift 1–9": chooseSet("ref") }],
    ...MODES.map(([mode, , key, text]) => [key, text, { [key]: () => { state.mode = mode; } }]),
    ["Space", "exchange the reference and the shown set",
      { " ": () => { [state.ref, state.set] = [state.set, state.ref]; } }],
    ["q", "next quantity", { q: () => {
      state.quantity = cycle(quantities.map(({ name }) => name), state.quantity);
    } }],
    ["o", "next overlay, or none", { o: () => {
      state.map = cycle(["", ...data.overlays.map(({ name }) => name)], state.map);
    } }],
    ["v", "next colour view", { v: () => { state.view = (state.view + 1) % VIEWS.length; } }],
    ["e  Shift E", "half a stop brighter, darker",
      { e: () => { state.ev += 0.5; }, E: () => { state.ev -= 0.5; } }],
    ["[  ]", "half, twice the colour scale",
      { "[": () => { state.gain -= 1; }, "]": () => { state.gain += 1; } }],
    ["r", "reset exposure and scale",
      { r: () => Object.assign(state, { ev: START.ev, gain: 0 }) }],
    ["+  −", "zoom in, out (also the wheel)", { "+": () => zoomBy(1), "=": () => zoomBy(1),
      "-": () => zoomBy(-1), "−": () => zoomBy(-1) }],
    ["z", "the whole frame", { z: () => { state.zoom = 0; } }],
    ["arrows", "move the cursor by a pixel; with Shift by ten",
      { ArrowLeft: moveCursor(-1, 0), ArrowRight: moveCursor(1, 0), ArrowUp: moveCursor(0, -1),
        ArrowDown: moveCursor(0, 1) }],
    [",  .", "back, forward by one frame", { ",": () => step(-1), ".": () => step(1) }],
    ["<  >", "back, forward by four frames", { "<": () => step(-4), ">": () => step(4) }],
    ["Home  End", "first, last frame",
      { Home: () => { state.frame = 0; }, End: () => { state.frame = data.frames - 1; } }],
    ["k", "play, or stop", { k: () => play(0, data.frames) }],
    ["c", "play four frames from the current one, or stop", { c: playCycle }],
  ];

  function keyName(event) {
    if (/^Digit[1-9]$/.test(event.code)) return event.shiftKey ? "Shift 1–9" : "1–9";
    return event.key;
  }

  /** Whether the focused control handles the key itself. */
  function belongsTo(target, key) {
    if (target.matches("select, input[type=number]")) return key !== "?";
    if (target.matches("input[type=range]")) return /^(Arrow|Home|End)/.test(key);
    return target.matches("button, a") && (key === " " || key === "Enter");
  }

  document.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const key = keyName(event);
    const run = KEYS.map(([, , runs]) => runs[key]).find((one) => one);
    if (!run || belongsTo(event.target, event.key) || (help.open && key !== "?")) return;
    event.preventDefault();
    change(() => run(event));
  });

  const help = el("dialog", { "aria-labelledby": "help-title" });
  const shut = el("button", { type: "button" }, "Close");
  shut.addEventListener("click", () => help.close());
  help.append(el("h2", { id: "help-title" }, "Keys"),
    el("dl", {}, KEYS.map(([name, text]) => el("div", {},
      el("dt", {}, name.split("  ").map((key, n) => [n > 0 && " ", el("kbd", {}, key)])),
      el("dd", {}, text)))),
    el("p", { class: "small" }, "Drag to move the frame or the wipe line. The address of this page "
      + "contains the current view: a copy of the address shows the same view. Values are equal to "
      + "the values in the files, bit for bit. ", data.cube
      ? `${data.cube.name} is OpenColorIO's view as a table, with an error of `
        + `${data.cube.error_mean.toFixed(2)} of 255 codes on average and `
        + `${data.cube.error_max.toFixed(1)} at most; sRGB is exact.`
        + (data.cube.not_numbers > 0 ? ` It has ${data.cube.not_numbers} `
          + "colours that are NaN, which are shown as 0." : "")
      : "Colours are OpenColorIO's sRGB display, exactly."),
    shut);

  // ------------------------------------------------------------------------------------- pointer

  function listen(pane) {
    let held = null; // {wipes, x, y}: whether the wipe line is dragged, and the last place
    const { canvas } = pane;
    canvas.addEventListener("pointerdown", (event) => {
      const box = canvas.getBoundingClientRect();
      const edge = box.left + state.wipe * box.width;
      const wipes = state.mode === "wipe" && Math.abs(event.clientX - edge) < 12;
      held = { wipes, x: event.clientX, y: event.clientY };
      canvas.setPointerCapture(event.pointerId);
      stage.focus({ focusVisible: false, preventScroll: true });
    });
    canvas.addEventListener("pointerup", () => { held = null; });
    canvas.addEventListener("pointercancel", () => { held = null; });
    canvas.addEventListener("pointermove", (event) => change(() => {
      const box = canvas.getBoundingClientRect();
      if (held?.wipes) state.wipe = clamp((event.clientX - box.left) / box.width, 0, 1);
      else if (held) drag(held, event, box);
      point(pane, event);
    }));
    canvas.addEventListener("click", (event) => change(() => point(pane, event)));
    canvas.addEventListener("wheel", (event) => {
      event.preventDefault();
      change(() => {
        zoomBy(event.deltaY < 0 ? 1 : -1, ...pointIn(pane, event));
        point(pane, event);
      });
    }, { passive: false });
  }

  function drag(held, event, box) {
    const scale = zoomIn(box) / dots();
    if (state.zoom === 0)
      Object.assign(state, { zoom: zoomIn(box), x: width / 2, y: height / 2 });
    state.x = clamp(state.x - (event.clientX - held.x) / scale, 0, width);
    state.y = clamp(state.y - (event.clientY - held.y) / scale, 0, height);
    Object.assign(held, { x: event.clientX, y: event.clientY });
  }

  function point(pane, event) {
    const [x, y] = pointIn(pane, event).map(Math.floor);
    if (x >= 0 && y >= 0 && x < width && y < height) Object.assign(state, { px: x, py: y });
  }

  // ------------------------------------------------------------------------------------- the page

  let isDue = false;
  function change(run) {
    run();
    if (isDue) return;
    isDue = true;
    document.documentElement.dataset.ready = "no";
    requestAnimationFrame(render);
  }

  /** Loads missing planes, and renders again after each. Returns whether any are missing. */
  function fetchMissing() {
    const missing = [...keysNeeded(), ...(playing ? [] : keysOfValues())]
      .filter((key) => !have(key) && !failures.has(key));
    const isMissing = missing.length > 0;
    for (const key of new Set(missing))
      want(key, key === "cube" ? data.cube.side ** 3 : pixels)
        .catch((error) => failures.set(key, error.message))
        .then(() => change(() => {}));
    return isMissing;
  }

  function render() {
    isDue = false;
    for (const bring of redo) bring();
    layPanes();
    panes.forEach(drawPane);
    showValues();
    keepAddress();
    const isMissing = fetchMissing();
    document.documentElement.dataset.ready = isMissing || !isWritten ? "no" : "yes";
    if (!isMissing || !playing) keepTime();
  }

  document.title = data.title;
  const size = data.bytes >= 1e5 ? `${(data.bytes / 1e6).toFixed(1)} MB`
    : `${Math.ceil(data.bytes / 1e3)} kB`;
  main.replaceChildren(
    el("div", { class: "strip" }, el("h1", {}, data.title), el("span", { class: "soft" },
      `${width} × ${height} pixels, ${data.frames === 1 ? "1 frame" : `${data.frames} frames`}, `
      + `${size} of floats, made ${data.created_utc.slice(0, 10)} by neph ${data.neph_version}`)),
    setStrip() || "", settingsStrip(), stage, values, data.frames > 1 ? timeStrip() : "", help);
  const skip = document.querySelector(".skip");
  skip.textContent = "Skip to the frame";
  skip.addEventListener("click", (event) => {
    event.preventDefault();
    stage.focus();
  });
  new ResizeObserver(() => change(() => {})).observe(stage);
  window.addEventListener("hashchange", () => change(readAddress));
  readAddress();
  change(() => {});
})();
