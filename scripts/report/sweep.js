// SPDX-License-Identifier: MIT
//
// The page of a sweep, from window.NEPH_SWEEP (data.js; README.md in this folder describes its
// format). Strings of the data reach the page as text nodes and attribute values only, never as
// markup.
(function () {
  "use strict";

  const sweep = window.NEPH_SWEEP;
  const { el, append, small, written, folded, colHead, rowHead, row, table, loadVega, drawLive } =
    window.NephPage;
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

  const scaled = (value, factor) => (value === null ? null : value * factor);

  const number = (value) => (value === null ? "" : written(value));

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

  /** Draws each chart interactively, from the specification of its image. */
  async function upgrade(charts) {
    if (!sweep.interactive) return;
    try {
      await loadVega();
    } catch {
      return; // the images of the charts stay
    }
    const narrow = window.matchMedia(NARROW).matches;
    for (const chart of charts) {
      const place = document.getElementById(chart.id);
      await drawLive(place, (narrow ? chart.narrow : chart.wide).spec);
      place.querySelector(".upgrade").append(" Point at a mark for its numbers and its command; " +
        "drag to pan, shift and wheel to zoom, double click to return.");
    }
  }

  // ------------------------------------------------------------------------------------- points

  function cell(point, [, read, front]) {
    const on = front !== null && point[front].on_front;
    const floor = front === null ? null : point[front].floor ?? null;
    return el("td", { class: on ? "front" : null }, number(read(point)), on ? "*" : "",
      floor !== null && small(`floor ${number(floor)}`));
  }

  /** A table that may be wider than the screen. */
  const wide = (heads, rows) => el("div", { class: "scroll" },
    table("wide", heads.map((name) => colHead(name)), rows));

  const allPoints = (points) => wide(["point", ...COLUMNS.map(([name]) => name)], points.map(
    (point) => row(rowHead(`${point.series} ${point.label}`),
      COLUMNS.map((column) => cell(point, column)))));

  // ------------------------------------------------------------------------ equal cost and number

  const COST_NAMES = { seconds: "time", evaluations: "evaluations" };

  /** "1.7 x"; "beyond" for null. */
  const ratio = (value) => (value === null ? "beyond" : `${number(value)} x`);

  function equals(rows) {
    if (rows.length === 0) return null;
    return [el("h2", null, "At equal error, and at equal cost"),
      el("p", { class: "small" }, "Each series at its best point, divided by the value of the " +
        "series that it is compared with (the other). Beyond: no two points of the other series " +
        "enclose the number or cost."),
      wide(["series", "other", "number", "cost", "cost at that number", "number at that cost"],
        rows.map((one) => row(rowHead(one.series), [one.against, one.number, COST_NAMES[one.cost],
          ratio(one.cost_ratio), ratio(one.number_ratio)].map((text) => el("td", null, text)))))];
  }

  function commands(points) {
    return folded("The command of each point", el("ul", null, points.map((point) => el("li", null,
      `${point.series} ${point.label}: `, el("code", null, point.command)))));
  }

  function missing(points) {
    if (points.length === 0) return null;
    return [el("h2", null, "Not rendered"), el("ul", null, points.map((point) =>
      el("li", null, `${point.series} ${point.label}: ${point.missing}`)))];
  }

  // ------------------------------------------------------------------------------------- page

  function head() {
    const noise = sweep.truth_noise > 0 ? ` with noise ${number(sweep.truth_noise)}` : "";
    return [el("p", { class: "eyebrow" }, "Nephelometer sweep"),
      el("h1", null, sweep.scene),
      el("p", null, `${sweep.title}: ${sweep.measured} of ${sweep.expected} points measured at ` +
        `${sweep.width_px} x ${sweep.height_px} on ${sweep.device}. Errors are relative RMSE ` +
        `over ${sweep.error_mask}; reference: ${sweep.truth}${noise}. Flicker is visible ` +
        `contrast in units of the eye's threshold, over ${sweep.flicker_mask}.`)];
  }

  const points = sweep.points.filter((point) => point.missing === null);
  document.title = `${sweep.scene}: sweep`;
  append(document.getElementById("main"), [
    head(),
    sweep.charts.map((chart) => [el("h2", null, chart.title), figure(chart)]),
    el("h2", null, "All points"),
    el("p", { class: "small" }, "*: on the Pareto front of its column: no cheaper point is " +
      "as good. Floor: the number of every pixel marched in every frame, for presets in a " +
      "scene that moves."),
    allPoints(points), equals(sweep.equal), commands(points),
    missing(sweep.points.filter((point) => point.missing !== null)),
  ]);
  upgrade(sweep.charts);
})();
