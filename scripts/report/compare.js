// SPDX-License-Identifier: MIT
//
// The page of a comparison, from window.NEPH_COMPARE (data.js; README.md in this folder describes
// its format). Strings of the data reach the page as text nodes and attribute values only, never as
// markup.
(function () {
  "use strict";

  const data = window.NEPH_COMPARE;
  const main = document.getElementById("main");
  const { el, section, colHead, rowHead, numHead, num, row, table, scrolling, fact, folded, hasData,
    written, withoutPlus, pixels, fit, show, colourBar, loadVega, drawLive } =
    window.NephPage;
  if (!hasData(main, data, "neph-compare-1")) return;

  const number = (value) => (value === null || value === undefined ? ""
    : withoutPlus(written(value)));
  const { compared } = data;
  const [test, other] = data.names;

  // ----------------------------------------------------------------------------------------- head

  const files = ({ first, count }) => `${first}, ${count} ${count === 1 ? "file" : "files"}`;

  const head = () => window.NephPage.head(data.verb, data.verdict[0] ?? "Nothing was measured",
    data.verdict.length > 1 && el("ul", { class: "small" },
      data.verdict.slice(1).map((line) => el("li", null, line))),
    fact("Reference", compared.reference ? files(compared.reference) : "none"),
    fact("Test", files(compared.test)),
    fact("Measured", `${compared.frames} frames, ${compared.frozen} frozen`),
    fact("Version", `neph ${compared.version}`));

  // --------------------------------------------------------------------------------------- charts

  const chart = (series, n) => el("figure", { class: "chart-figure", id: `chart-${n}` },
    el("div", { class: "frame" },
      el("img", { class: "chart still", src: `charts/${series.id}.svg`,
        alt: `${series.id} of each frame: ${series.title}` }), el("div", { class: "live" })),
    el("figcaption", { class: "small" }, `${series.id}: ${series.title}`));

  const charts = () => data.charts.length > 0
    && section("time", "Over time", data.charts.map((_, n) => chart(data.series[n], n)));

  async function upgrade() {
    if (!data.interactive || data.charts.length === 0) return;
    try {
      await loadVega();
    } catch {
      return; // the images of the charts stay
    }
    for (const [n, spec] of data.charts.entries())
      await drawLive(document.getElementById(`chart-${n}`), spec);
  }

  // ----------------------------------------------------------------------------------------- maps

  function swatch(colour, text) {
    const box = el("span", { "aria-hidden": "true" }, "\u2003");
    box.style.background = colour;
    return el("span", { class: "small" }, box, ` ${text}\u2003`);
  }

  function legend(map) {
    const colours = map.is_signed ? data.differences : data.amounts;
    const end = number(map.scale);
    const ticks = map.is_signed ? [`−${end}`, "0", `+${end}`] : ["0", "", end];
    return el("div", { class: "legend" }, el("figure", null,
      colourBar(colours.stops, `from ${ticks[0]} to ${ticks[2]}`, ...ticks),
      map.is_signed && swatch(colours.below, `below −${end}`),
      swatch(colours.above, `above ${end}`), swatch(colours.none, "no value")));
  }

  function card(title, source, size) {
    const made = el("article", { class: "card" }, el("header", null, el("h4", null, title)),
      pixels(source, title, size));
    made.style.gridRow = "span 2";
    return made;
  }

  const pictures = (size, cards) => fit(el("div", { class: "pictures" }, cards), size, 640);

  function mapsNamed(name) {
    const maps = data.maps.filter((map) => map.name === name);
    const size = maps[0].size_px;
    const block = maps[0].block_px;
    return [el("h3", null, maps[0].title), block > 1 && el("p", { class: "small soft" },
      `A pixel of the map is the largest value of ${block} x ${block} pixels.`), legend(maps[0]),
    pictures(size, maps.map((map) => card(data.names[map.side], map.src, size)))];
  }

  const maps = () => data.maps.length > 0 && section("maps", "Maps",
    el("p", { class: "small soft" }, compared.frames > 1 && data.series[0]?.id !== "movement"
      ? `Maps of the worst frame, ${data.frames[0]?.frame}.` : "Maps of all frames."),
    [...new Set([...data.maps].sort((a, b) => a.place - b.place).map((map) => map.name))]
      .map(mapsNamed));

  // ------------------------------------------------------------------------------------ the worst

  function frame(item) {
    const [x, y, width, height] = item.part;
    return [el("h3", null, `Frame ${item.frame}: ${data.series[0].id} ${number(item.value)}`),
      el("p", { class: "small soft" }, `${item.file}, ${width} x ${height} pixels from ` +
        `(${x}, ${y}); differences: `, `colours end at ±${number(item.difference_scale)}`),
      pictures([width, height], item.images.map((image) =>
        card(image.what, image.src, [width, height])))];
  }

  const worst = () => data.frames.length > 0 && section("worst", "The worst frames",
    el("div", { class: "legend" }, el("figure", null, colourBar(data.differences.stops,
      "differences, from darker to brighter", "darker", "0", "brighter"),
    swatch(data.differences.below, "below the scale"),
    swatch(data.differences.above, "above the scale"))),
    data.frames.map(frame));

  // -------------------------------------------------------------------------------------- numbers

  const bounds = (pair) => (pair ? `${number(pair[0])} to ${number(pair[1])}` : "");

  const versusRow = (item) => row(rowHead(item.metric), el("td", null, item.quantity),
    el("td", null, item.mask), num(number(item.test)), num(number(item.other)),
    num(number(item.difference)), num(bounds(item.interval)), num(number(item.p_holm)),
    el("td", null, item.unit));

  const numberRow = (item) => row(rowHead(item.metric), el("td", null, item.quantity),
    el("td", null, item.mask), num(item.value === null ? "" : number(item.value)),
    num(bounds(item.interval)), el("td", null, item.unit), el("td", null,
      item.undefined_because ?? ""));

  const HEADS = ["metric", "quantity", "mask"].map((name) => colHead(name));

  function numbers() {
    const overall = compared.measurements;
    return section("numbers", "All numbers",
      compared.versus && folded(`${test} and ${other}: ${compared.versus.length} numbers`,
        scrolling("both tests", table("wide", [...HEADS, numHead(test), numHead(other),
          numHead("difference"), numHead("95 % interval"), numHead("p (Holm)"), colHead("unit")],
        compared.versus.map(versusRow)))),
      folded(`${test ?? "test"}: ${overall.length} numbers`, scrolling("the test",
        table("wide", [...HEADS, numHead("value"), numHead("95 % interval"), colHead("unit"),
          colHead("reason if undefined")], overall.map(numberRow)))),
      el("p", { class: "small" }, "All digits: ", el("a", { href: "data.json" }, "data.json"),
        ". Numbers of each frame: use --csv FILE or --json."));
  }

  document.title = `${data.verb}: ${data.verdict[0] ?? ""}`;
  show(main, head(), charts(), maps(), worst(), numbers());
  upgrade();
})();
