// SPDX-License-Identifier: MIT
//
// Common parts of the pages of neph: elements, tables, help, images, interactive charts. Every page
// loads this script before its own. Strings of the data reach a page as text nodes and
// attribute values only, never as markup.
(function () {
  "use strict";

  // ------------------------------------------------------------------------------------- elements

  function append(element, children) {
    for (const child of children.flat(Infinity))
      if (child !== null && child !== undefined && child !== false) element.append(child);
    return element;
  }

  function attributed(element, attributes) {
    for (const [name, value] of Object.entries(attributes ?? {}))
      if (value !== null && value !== undefined && value !== false)
        element.setAttribute(name, String(value));
    return element;
  }

  /** An element; strings and numbers among the children become text, null and false nothing. */
  const el = (tag, attributes, ...children) =>
    append(attributed(document.createElement(tag), attributes), children);

  const svg = (tag, attributes, ...children) => append(attributed(
    document.createElementNS("http://www.w3.org/2000/svg", tag), attributes), children);

  // Names of masks for readers.
  const MASKS = { all: "whole frame", sky: "sky", medium: "inside the medium",
    depth_edge: "at depth edges", solid: "solids",
    non_edge: "away from depth edges", thin: "thin objects", cloud: "clouds", fog: "fog",
    sun: "the sun" };

  const line = (className, x1, y1, x2, y2) => svg("line", { class: className, x1, x2, y1, y2 });
  const label = (x, y, anchor, ...text) => svg("text", { x, y, "text-anchor": anchor }, text);

  const plural = (count, one, many) => `${count} ${count === 1 ? one : many}`;
  const unique = (list) => [...new Set(list)];

  const hidden = (text) => el("span", { class: "hidden" }, text);
  const small = (...children) => el("small", null, children);
  const bold = (...children) => el("b", null, children);
  const folded = (title, ...content) => el("details", null, el("summary", null, title), content);

  /** A verdict as a sign and a word, so that it can be read without its colour. */
  const signed = (sign, text, kind) => el("span", { class: kind },
    el("span", { "aria-hidden": "true" }, `${sign} `), text);

  // --------------------------------------------------------------------------------------- tables

  const colHead = (...children) => el("th", { scope: "col" }, children);
  const rowHead = (...children) => el("th", { scope: "row" }, children);
  const numHead = (name, note) => el("th", { scope: "col", class: "num" }, name,
    note !== undefined && small(note));
  const num = (...children) => el("td", { class: "num" }, children);
  const words = (...children) => el("td", { class: "words" }, children);
  const row = (...cells) => el("tr", null, cells);

  const table = (className, heads, rows) => el("table", { class: className },
    el("thead", null, row(heads)), el("tbody", null, rows));

  /** Puts a table into a block that scrolls sideways, also by keyboard. Each cell gets the head of
   * its column in data-label, for narrow screens, where the table is shown as a list of rows. */
  function scrolling(label, wide, note) {
    const heads = [...wide.querySelectorAll("thead th")].map((head) => head.dataset.label
      ?? head.firstChild?.data ?? head.textContent);
    for (const line of wide.querySelectorAll("tbody tr"))
      [...line.children].forEach((cell, n) => {
        if (cell.tagName === "TD" && heads[n]) cell.setAttribute("data-label", heads[n]);
      });
    wide.prepend(el("caption", { class: "hidden" }, label));
    return [
      el("div", { class: "scroll", role: "region", "aria-label": `Table: ${label}`, tabindex: "0" },
        wide),
      note && el("p", { class: "note small soft" }, note),
    ];
  }

  // ------------------------------------------------------------------------------ parts of a page

  /** A section with a heading; `id` is its anchor. */
  const section = (id, title, ...content) => el("section", { "aria-labelledby": id },
    el("h2", { id }, title), content);

  const fact = (name, value) => el("div", null, el("dt", null, name), el("dd", null, value));
  const entry = (term, ...text) => el("div", null, el("dt", null, term), el("dd", null, text));

  const head = (eyebrow, title, verdict, ...facts) => el("header", null,
    el("p", { class: "eyebrow" }, eyebrow), el("h1", null, title), verdict,
    el("dl", { class: "facts" }, facts));

  const help = (...entries) => el("aside", { class: "help", "aria-labelledby": "help" },
    el("h2", { id: "help" }, "How to read this"), el("dl", null, entries));

  /** A list of `most` items; further items are folded. */
  const listed = (items, most, rest, className) => [
    items.length > 0 && el("ul", { class: className }, items.slice(0, most)),
    items.length > most && el("details", { class: className },
      el("summary", null, rest ?? `${items.length - most} more`),
      el("ul", null, items.slice(most)))];

  const link = (href, text) => el("a", { href }, text ?? href);

  function complain(main, title, ...text) {
    main.replaceChildren(el("h1", null, title), ...text.map((line) => el("p", null, line)));
  }

  /** Whether the page has data of this format; if not, it shows an error. */
  function hasData(main, data, format) {
    if (!data)
      complain(main, "This page has no data",
        "data.js in the folder of this page is missing or cannot be read.");
    else if (data.format !== format)
      complain(main, "The data of this page have another version",
        `The format of data.js is “${data.format}”; this page reads “${format}”.`);
    return data?.format === format;
  }

  /** A number with `digits` digits; with a power of ten below 0.001 and from `most` up. */
  function written(value, digits = 3, most = 1e5) {
    const size = Math.abs(value);
    return size !== 0 && (size < 1e-3 || size >= most) ? value.toExponential(digits - 1)
      : String(Number(value.toPrecision(digits)));
  }

  const withoutPlus = (text) => text.replace("e+", "e").replace("e-", "e−");

  // --------------------------------------------------------------------------------------- images

  const hole = (text) => el("div", { class: "hole" }, el("span", null, text));

  function pixels(source, alt, size, missing, className = "pixels") {
    const image = el("img", { class: className, src: source, alt, width: size[0],
      height: size[1], draggable: "false" });
    image.addEventListener("error", () => image.replaceWith(hole(missing
      ?? `${source} is not in this page's folder`)));
    return image;
  }

  const fitted = []; // {element, width, most}: images scaled to whole device pixels per pixel

  function sized(element, size) {
    element.style.setProperty("--image-width", size[0]);
    element.style.setProperty("--image-height", size[1]);
    return element;
  }

  /** Scales the images of an element, of `size` pixels, to at most `most` CSS pixels of width. */
  function fit(element, size, most = 300) {
    fitted.push({ element, width: size[0], most });
    return sized(element, size);
  }

  function fitImages(main) {
    const style = getComputedStyle(main);
    const room = main.clientWidth - parseFloat(style.paddingLeft) - parseFloat(style.paddingRight);
    const dots = window.devicePixelRatio || 1;
    for (const { element, width, most } of fitted)
      element.style.setProperty("--scale",
        Math.max(1, Math.floor((Math.min(room, most) * dots) / width)) / dots);
  }

  /** Shows the parts, and fits the images again when the window changes. */
  function show(main, ...parts) {
    main.replaceChildren();
    append(main, parts);
    fitImages(main);
    window.addEventListener("resize", () => fitImages(main));
  }

  /** The colour bar of a difference, with its ticks. */
  function colourBar(colours, label, ...ticks) {
    const bar = el("div", { class: "bar", role: "img", "aria-label": label });
    bar.style.background = `linear-gradient(to right, ${colours.join(", ")})`;
    return [bar, el("div", { class: "ticks" }, ticks.map((tick) => el("span", null, tick)))];
  }

  // ---------------------------------------------------------------------------- interactive charts

  const VENDORED = ["vendor/vega.min.js", "vendor/vega-lite.min.js", "vendor/vega-embed.min.js"];

  function load(path) {
    return new Promise((resolve, reject) => {
      const script = el("script", { src: path });
      script.addEventListener("load", resolve);
      script.addEventListener("error", () => reject(new Error(`${path} could not be read`)));
      document.head.append(script);
    });
  }

  async function loadVega() {
    for (const path of VENDORED) await load(path);
  }

  const refuse = (uri) => Promise.reject(new Error(`a chart requests ${uri}`));

  let tooltip = null;
  function showTooltip(_handler, event, _item, value) {
    tooltip?.remove();
    tooltip = null;
    if (value === null || value === undefined || value === "") return;
    const lines = typeof value === "object" ? Object.entries(value) : [["", value]];
    tooltip = el("div", { class: "tooltip" }, el("table", null, lines.map(([name, text]) =>
      row(rowHead(name), el("td", null, text)))));
    document.body.append(tooltip);
    const box = tooltip.getBoundingClientRect();
    const place = (at, size, room) => `${Math.max(4, Math.min(at + 14, room - size - 8))}px`;
    tooltip.style.left = place(event.clientX, box.width, window.innerWidth);
    tooltip.style.top = place(event.clientY, box.height, window.innerHeight);
  }

  /** Draws a chart into the .live of its figure, from the specification of its image. */
  async function drawLive(figure, specification) {
    const spec = JSON.parse(JSON.stringify(specification));
    delete spec.usermeta;
    await window.vegaEmbed(figure.querySelector(".live"), spec, {
      mode: "vega-lite",
      renderer: "svg",
      ast: true, // expressions are interpreted: text of the data never runs as code
      // Without warnings: a layer may have no rows (when no interval reaches zero).
      logLevel: window.vega.Error,
      actions: false,
      defaultStyle: false,
      tooltip: showTooltip,
      loader: { load: refuse, sanitize: refuse },
    });
    // Vega names each group of marks by its layer. For screen readers the chart is an image with
    // the alternative text of the chart's image.
    const live = figure.querySelector(".live");
    live.setAttribute("role", "img");
    live.setAttribute("aria-label", figure.querySelector("img")?.alt
      || figure.querySelector("h3, figcaption")?.textContent || "chart");
    for (const drawing of live.querySelectorAll("svg")) drawing.setAttribute("aria-hidden", "true");
    figure.setAttribute("data-state", "interactive");
  }

  window.NephPage = { MASKS, append, el, svg, line, label, plural, unique, hidden, small, bold,
    folded, signed, colHead, rowHead, numHead, num, words, row, table, scrolling, section, fact,
    entry, head, help, listed, link, complain, hasData, written, withoutPlus, hole, pixels, sized,
    fit, show, colourBar, loadVega, drawLive };
})();
