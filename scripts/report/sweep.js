// SPDX-License-Identifier: MIT
//
// Lays out a sweep from window.NEPH_SWEEP (data.js; README.md beside this file is the contract).
// Strings of the data reach the page as text nodes and attribute values alone, never as markup.
(function () {
  "use strict";

  const sweep = window.NEPH_SWEEP;
  const VENDORED = ["vendor/vega.min.js", "vendor/vega-lite.min.js", "vendor/vega-embed.min.js"];
  const NARROW = "(max-width: 42rem)";
  const COLUMNS = [
    ["ms", (point) => scaled(point.seconds, 1e3), null],
    ["evaluations / px", (point) => point.evaluations, null],
    ["error", (point) => point.error.value, "error"],
    ["shortcut", (point) => point.shortcut.value, "shortcut"],
    ["flicker", (point) => point.flicker.value, "flicker"],
    ["four", (point) => point.four.value, "four"],
    ["half-life", (point) => point.half_life.value, "half_life"],
  ];

  function el(tag, attributes, ...children) {
    const element = document.createElement(tag);
    for (const [name, value] of Object.entries(attributes ?? {}))
      if (value !== null && value !== false) element.setAttribute(name, String(value));
    for (const child of children.flat(Infinity))
      if (child !== null && child !== undefined) element.append(child);
    return element;
  }

  const scaled = (value, factor) => (value === null ? null : value * factor);

  function number(value) {
    if (value === null) return "";
    const size = Math.abs(value);
    return size !== 0 && (size < 1e-3 || size >= 1e5) ? value.toExponential(2)
      : String(Number(value.toPrecision(3)));
  }

  // ------------------------------------------------------------------------------------- charts

  function figure(chart) {
    const { wide, narrow } = chart;
    const still = wide.svg
      ? el("picture", { class: "still" }, el("source", { media: NARROW, srcset: narrow.svg }),
        el("img", { class: "chart", src: wide.svg, alt: `${chart.title}: ${chart.caption}` }))
      : el("p", { class: "still" }, "This chart was not drawn; its numbers are in the table.");
    return el("figure", { class: "chart-figure", id: chart.id },
      el("div", { class: "frame" }, still, el("div", { class: "live" })),
      el("figcaption", { class: "small" }, chart.caption,
        el("span", { class: "upgrade soft" })));
  }

  function load(path) {
    return new Promise((resolve, reject) => {
      const script = el("script", { src: path });
      script.onload = resolve;
      script.onerror = () => reject(new Error(`${path} cannot be read`));
      document.head.append(script);
    });
  }

  const refuse = (uri) => Promise.reject(new Error(`a chart asks for ${uri}`));

  let tooltip = null;
  function showTooltip(_handler, event, _item, value) {
    tooltip?.remove();
    tooltip = null;
    if (!value) return;
    tooltip = el("div", { class: "tooltip", role: "status" }, el("table", null,
      Object.entries(value).map(([name, text]) =>
        el("tr", null, el("th", null, name), el("td", null, String(text))))));
    document.body.append(tooltip);
    const room = document.documentElement.clientWidth - tooltip.offsetWidth - 8;
    tooltip.style.left = `${Math.max(4, Math.min(event.clientX + 12, room)) + window.scrollX}px`;
    tooltip.style.top = `${event.clientY + 14 + window.scrollY}px`;
  }

  /** Each chart from the specification that drew the still one. */
  async function upgrade(charts) {
    if (!sweep.interactive) return;
    try {
      for (const path of VENDORED) await load(path);
    } catch {
      return; // the still charts stand
    }
    const narrow = window.matchMedia(NARROW).matches;
    for (const chart of charts) {
      const place = document.getElementById(chart.id);
      const spec = JSON.parse(JSON.stringify((narrow ? chart.narrow : chart.wide).spec));
      await window.vegaEmbed(place.querySelector(".live"), spec, {
        mode: "vega-lite",
        renderer: "svg",
        ast: true, // expressions are interpreted: nothing in the data is ever run as code
        logLevel: window.vega.Error,
        actions: false,
        defaultStyle: false,
        tooltip: showTooltip,
        loader: { load: refuse, sanitize: refuse },
      });
      place.setAttribute("data-state", "interactive");
      place.querySelector(".upgrade").append(" Point at a mark for its numbers and its command; " +
        "drag to pan, shift and wheel to zoom, double click to return.");
    }
  }

  // ------------------------------------------------------------------------------------- points

  function cell(point, [, read, front]) {
    const on = front !== null && point[front].on_front;
    return el("td", { class: on ? "front" : null }, number(read(point)), on ? "*" : "");
  }

  function row(point) {
    return el("tr", null, el("th", { scope: "row" }, `${point.series} ${point.label}`),
      COLUMNS.map((column) => cell(point, column)));
  }

  function table(points) {
    return el("div", { class: "scroll" }, el("table", { class: "wide" },
      el("thead", null, el("tr", null, el("th", { scope: "col" }, "point"),
        COLUMNS.map(([name]) => el("th", { scope: "col" }, name)))),
      el("tbody", null, points.map(row))));
  }

  // ------------------------------------------------------------------------ equal cost and number

  const COST_NAMES = { seconds: "time", evaluations: "evaluations" };

  /** "1.7 x", or what is said where there is no such point. */
  const ratio = (value) => (value === null ? "beyond" : `${number(value)} x`);

  function equals(rows) {
    if (rows.length === 0) return null;
    return [el("h2", null, "At equal error, and at equal cost"),
      el("p", { class: "small" }, "Each series at its best point, over what the series that it " +
        "is held against has there. Beyond: nothing between two points of that is so good, or " +
        "so dear."),
      el("div", { class: "scroll" }, el("table", { class: "wide" },
        el("thead", null, el("tr", null,
          ["series", "against", "number", "cost", "cost at that number", "number at that cost"]
            .map((name) => el("th", { scope: "col" }, name)))),
        el("tbody", null, rows.map((row) => el("tr", null,
          el("th", { scope: "row" }, row.series), el("td", null, row.against),
          el("td", null, row.number), el("td", null, COST_NAMES[row.cost]),
          el("td", null, ratio(row.cost_ratio)), el("td", null, ratio(row.number_ratio)))))))];
  }

  function commands(points) {
    return el("details", null, el("summary", null, "The command of each point"),
      el("ul", null, points.map((point) => el("li", null, `${point.series} ${point.label}: `,
        el("code", null, point.command)))));
  }

  function missing(points) {
    if (points.length === 0) return null;
    return [el("h2", null, "Not rendered"), el("ul", null, points.map((point) =>
      el("li", null, `${point.series} ${point.label}: ${point.missing}`)))];
  }

  // ------------------------------------------------------------------------------------- page

  function head() {
    const noise = sweep.truth_noise > 0 ? `, whose noise is ${number(sweep.truth_noise)}` : "";
    return [el("p", { class: "eyebrow" }, "Nephelometer sweep"),
      el("h1", null, sweep.scene),
      el("p", null, `${sweep.title}: ${sweep.measured} of ${sweep.expected} points measured at ` +
        `${sweep.width_px} x ${sweep.height_px} on ${sweep.device}. Errors are relative RMSE ` +
        `over ${sweep.error_mask} against ${sweep.truth}${noise}; flicker is contrast seen over ` +
        `threshold, over ${sweep.flicker_mask}.`)];
  }

  const points = sweep.points.filter((point) => point.missing === null);
  document.title = `${sweep.scene}: sweep`;
  document.getElementById("report").append(...[
    head(),
    sweep.charts.map((chart) => [el("h2", null, chart.title), figure(chart)]),
    el("h2", null, "All points"),
    el("p", { class: "small" }, "*: on the front of its column: nothing cheaper is as good."),
    table(points), equals(sweep.equal), commands(points),
    missing(sweep.points.filter((point) => point.missing !== null)),
  ].flat(Infinity).filter((part) => part !== null));
  upgrade(sweep.charts);
})();
