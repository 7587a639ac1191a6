// SPDX-License-Identifier: MIT
//
// Lays out a run of the stress tests from window.NEPH_STRESS (data.js; README.md beside this file
// defines its format). The results are sorted, the worst first, and the page keeps this order.
// Strings of the data reach the page only as text nodes and attribute values, never as markup.
(function () {
  "use strict";

  const run = window.NEPH_STRESS;
  const { el, small, bold, svg, line, label, plural, unique, folded, signed, section, colHead,
    rowHead, numHead, row, table, scrolling, fact, entry, listed, link, hasData, withoutPlus, sized,
    fit, show, colourBar } = window.NephPage;

  // Each verdict has a sign and a word, so that it can be read without its colour.
  const VERDICTS = {
    fail: ["✗", "fails", "fail-word"],
    no_number: ["✗", "no number", "fail-word"],
    unexpected_pass: ["◆", "passes: unexpected", "fail-word"],
    flake: ["≈", "near to the limit", "open-word"],
    known_fail: ["△", "fails, known", "open-word"],
    not_rendered: ["○", "not rendered", "open-word"],
    pass: ["✓", "passes", "pass-word"],
    skip: ["○", "skipped", "soft"],
    cannot: ["○", "cannot", "soft"],
    missing: ["○", "missing", "soft"],
    not_yet: ["○", "not yet", "soft"],
  };
  const NEWS = ["fail", "no_number", "unexpected_pass"];
  const TINTS = { fail: "wrong", no_number: "wrong", unexpected_pass: "wrong", flake: "known",
    known_fail: "known", pass: "agrees" };
  const MASKS = { ...window.NephPage.MASKS, non_edge: "away from edges" };
  const MEASURES = {
    error: "relative RMS error against the reference",
    flicker: "visible flicker, 1 at the threshold",
    period_4: "flicker with a period of four frames, RMS relative to the display's white",
    lag: "frames until 95 % of the pixels are within 10 %",
    edge_ratio: "error at edges in depth over error elsewhere",
    never_seen: "fraction of pixels that do not converge",
    energy: "light gained or lost, relative",
    bad_values: "number of values that are negative or not finite",
  };
  const STATES = { running: ["Running", "open"], interrupted: ["Interrupted", "open"] };
  const OVER = { pass: ["Pass", "pass"], fail: ["Fail", "fail"] };
  const SERIES = [["#0072b2", ""], ["#d55e00", "6 3"], ["#009e73", "2 3"], ["#cc79a7", "8 3 2 3"],
    ["#56b4e9", "4 2"], ["#7a6a00", "1 3"], ["#5a5f63", "10 4"]];
  const LISTED = 12; // unexpected results in the verdict; more are folded
  const FLIPS_HZ = 30, SLOW_HZ = 2;

  // -------------------------------------------------------------------------------------- numbers

  const written = (value) => withoutPlus(window.NephPage.written(value));

  const hasNumber = (result) => result.value !== null || result.infinite;

  /** The number of a result, rounded; its title has all digits. */
  function numberOf(result) {
    if (result.infinite) return el("span", { title: "infinite" }, "∞");
    if (result.value === null) return null;
    return el("data", { value: result.value, "data-value": result.value, title: result.value },
      written(result.value));
  }

  /** The floor of a number in motion, and the number over it; null: it has no floor. */
  function floorOf(result) {
    if (!result.floor_column) return null;
    const number = result.floor_infinite ? "∞" : el("data", { value: result.floor,
      "data-value": result.floor, title: result.floor_column }, written(result.floor));
    return ["floor ", number,
      result.times_floor !== null && ` (${written(result.times_floor)} times)`];
  }

  const withFloor = (result) => result.floor_column && [", ", floorOf(result)];

  const limitOf = (result) => el("data", { value: result.limit, title: result.limit },
    written(result.limit));

  function word(verdict, short) {
    const [sign, text, kind] = VERDICTS[verdict] ?? ["○", verdict, "open-word"];
    return signed(sign, short ? text.split(/[,:]/)[0] : text, kind);
  }

  // ------------------------------------------------------------------------------------- look-ups

  const results = run?.results ?? [];
  const columns = (run?.columns ?? []).filter(({ name }) =>
    results.some((result) => result.column === name));
  const sceneNamed = (name) => run.scenes.find((scene) => scene.name === name);
  const order = unique(results.map((result) => result.scene)); // the worst first
  const of = (scene, column) => results.filter((result) => result.scene === scene
    && (column === undefined || result.column === column));
  const measuresOf = (list) => unique(list.map(({ measure, over }) => `${measure} ${over}`));
  const anchor = (name) => `scene-${name}`;
  const evidenceOf = (scene) => run.evidence.filter((item) => item.scene === scene);
  const maskText = (over) => (over === "all" ? "" : `, ${MASKS[over] ?? over}`);
  const maskOf = (result) => maskText(result.over);

  // ----------------------------------------------------------------------------------------- head

  const megabytes = (bytes) => (bytes < 1e6 ? `${Math.ceil(bytes / 1e3)} kB`
    : `${(bytes / 1e6).toFixed(bytes < 1e7 ? 1 : 0)} MB`);

  /** The unexpected results; several points of a sweep are one item, at the worst point. */
  function news() {
    const kin = Map.groupBy(results.filter((one) => NEWS.includes(one.verdict)),
      ({ scene, column, measure, over, verdict }) =>
        [scene, column, measure, over, verdict].join("\n"));
    return [...kin.values()].map(newsItem);
  }

  const newsItem = ([result, ...more]) => el("li", null, word(result.verdict, true), " ",
    link(`#${anchor(result.scene)}`, result.scene), result.point && ` at ${result.point}`, " · ",
    bold(result.column), ` · ${result.measure}${maskOf(result)}: `,
    hasNumber(result) ? [numberOf(result), ", limit ", limitOf(result), withFloor(result)]
      : result.why,
    more.length > 0 && `, and at ${plural(more.length, "more point", "more points")}`);

  function verdict() {
    const [said, kind] = STATES[run.state] ?? OVER[run.verdict] ?? [run.verdict, "open"];
    const list = news();
    const left = run.progress.left_s;
    return el("div", { class: `verdict ${kind}` },
      el("p", { class: "word" }, said),
      el("div", { class: "said" },
        el("p", null, `${plural(run.compared, "comparison", "comparisons")} made in ` +
          `${plural(run.scenes.length, "scenario", "scenarios")} over ` +
          `${plural(run.frames, "frame", "frames")}; ` +
          (run.news === 0 ? "all as expected." : `${run.news} not as expected.`),
        run.compared === 0 && " Without comparisons there is no verdict."),
        run.state !== "finished" && el("p", null,
          `${run.progress.done} of ${run.progress.total} steps` +
          `${run.state === "running" && left > 0 ? `, about ${Math.ceil(left)} s left` : ""}: ` +
          "the page shows the results so far.")),
      listed(list, LISTED));
  }

  function pictureFact() {
    const { bytes, limit_bytes: limit, left_out: left } = run.pictures;
    return [`${megabytes(bytes)} of images, limit of the page ${megabytes(limit)}`,
      left > 0 && ["; ", el("span", { class: "open-word" }, "the limit is reached"),
        `: ${plural(left, "cell has", "cells have")} no images`]];
  }

  const head = () => window.NephPage.head("Nephelometer stress tests", "Where methods fail",
    verdict(), fact("Tier", run.tier), fact("Device", run.device),
    fact("Created", run.created_utc), fact("Duration", `${written(run.seconds)} s`),
    fact("Version", `neph ${run.neph_version}`),
    fact("Floor", run.floors ? "measured, where a scenario moves"
      : "not measured (--tier full, or --only NAME)"),
    fact("Page", pictureFact()));

  // --------------------------------------------------------------------------------------- matrix

  const notAsked = () => el("td", { class: "num soft" }, small("not tested"));

  /** A cell of the matrix, which shows the worst of its numbers. */
  function matrixCell(scene, column) {
    const own = of(scene, column.name);
    if (own.length === 0) return notAsked();
    const worst = own[0];
    const failing = own.filter((result) => !["pass", "not_yet"].includes(result.verdict)).length;
    return el("td", { class: `num ${TINTS[worst.verdict] ?? ""}` }, numberOf(worst),
      small(word(worst.verdict)), hasNumber(worst) && small("limit ", limitOf(worst)),
      worst.floor_column && small(floorOf(worst)),
      small(`${worst.measure}${maskOf(worst)}`), worst.point && small(worst.point),
      own.length > 1 && hasNumber(worst) && worst.verdict !== "pass"
        && small(`${failing} of ${own.length} numbers`));
  }

  const matrixRow = (scene) => row(
    rowHead(link(`#${anchor(scene)}`, scene), small(sceneNamed(scene).title)),
    columns.map((column) => matrixCell(scene, column)));

  const headCell = (column) => numHead(column.name, column.preset ? "preset" : "engine");

  function matrix() {
    const told = order.filter((scene) => of(scene).some(hasNumber));
    const silent = order.filter((scene) => !told.includes(scene));
    return section("matrix", "Verdicts",
      told.length > 0 && scrolling("Verdicts", table("wide matrix findings",
        [colHead("Scenario"), columns.map(headCell)], told.map(matrixRow))),
      el("p", { class: "note small soft" }, "Each cell shows the worst of its numbers: the " +
        "value, the verdict, the limit (the largest allowed value), and the measure."),
      silent.length > 0 && el("p", { class: "small" }, "Scenarios without a number so far: ",
        silent.map((scene, n) => [n > 0 && ", ", `${scene} (`,
          unique(of(scene).map((result) => VERDICTS[result.verdict]?.[1] ?? result.verdict))
            .join(", "), ")"]), "."));
  }

  const help = () => window.NephPage.help(
    entry("Verdicts", "✗ fails: above its limit, and not expected. △ fails, known: an " +
      "expected failure, recorded with its reason. ◆ passes, unexpected: recorded as a failure, " +
      "but now below its limit; this also counts as not expected."),
    entry("Floor", "The same measure with every pixel marched in every frame: the lower number " +
      "of the anti-aliasing of the preset and the default one. The rest is caused by the " +
      "division over frames. Scenarios without motion have no floor."),
    entry("Engines", "Presets are settings of the real-time method with history. Engines that " +
      "render each frame independently are tested in the fog scenarios only: they are compared " +
      "with engine exact, without the measures of a history. “Cannot” and “missing” are not " +
      "verdicts."),
    entry("Images", "Each cell with evidence shows its worst frame, and the row of pixels with " +
      "the largest error over all frames; time runs down. Differences have one fixed scale: " +
      "blue is too dark, red is too bright, cyan and yellow are beyond the scale."),
    entry("Flip-book", "Consecutive frames beside their reference. The button plays them; the " +
      "playback is slow if the device is set to reduced motion."));

  // ------------------------------------------------------------------------------------- pictures

  const pixels = (item, name, alt, size) => window.NephPage.pixels(`${item.folder}/${name}.png`,
    alt, size, `${name}.png is not in this page's folder`);
  const has = (item, name) => item.pictures.includes(`${name}.png`);

  const figure = (item, name, alt, caption, size) => has(item, name) && sized(el("figure", null,
    pixels(item, name, alt, size), el("figcaption", null, caption)), size);

  function stack(item, names, what, size) {
    const frames = names.map((name, n) => pixels(item, name, `${what}, frame ${n + 1}`, size));
    return { element: el("div", { class: "stack" }, frames),
      show: (n) => frames.forEach((frame, f) => { frame.hidden = f !== n % frames.length; }) };
  }

  const calm = window.matchMedia("(prefers-reduced-motion: reduce)");

  /** The button plays and pauses the frames; the slider selects one and stops the playback. */
  function flipbook(item, title, size, beside) {
    const count = item.flip_count;
    const numbers = [...Array(count).keys()];
    const test = stack(item, numbers.map((n) => `flip_${n}`), title, size);
    const references = numbers.filter((n) => has(item, `flip_reference_${n}`))
      .map((n) => `flip_reference_${n}`);
    const reference = references.length > 0 && stack(item, references, "reference", size);
    const slider = el("input", { type: "range", min: 1, max: count, value: 1,
      "aria-label": `Frame of ${title}` });
    const button = el("button", { type: "button", "aria-pressed": "false" }, "▶ play");
    let timer = null;
    const show = () => {
      for (const one of [test, reference]) if (one) one.show(Number(slider.value) - 1);
    };
    const press = (isPlaying, text) => {
      button.setAttribute("aria-pressed", String(isPlaying));
      button.textContent = text;
    };
    const stop = () => {
      window.clearTimeout(timer);
      timer = null;
      press(false, "▶ play");
    };
    const turn = () => {
      slider.value = (Number(slider.value) % count) + 1;
      show();
      timer = window.setTimeout(turn, 1000 / (calm.matches ? SLOW_HZ : FLIPS_HZ));
    };
    button.addEventListener("click", () => {
      if (timer !== null) return stop();
      press(true, calm.matches ? "⏸ pause (slowed)" : "⏸ pause");
      return turn();
    });
    slider.addEventListener("input", () => { stop(); show(); });
    show();
    const pair = el("div", { class: "pictures flips" },
      [[test, `frames ${item.flip_first} to ${item.flip_first + count - 1}`],
        [reference, "reference"]].map(([one, caption]) => one && el("figure", null, one.element,
        el("figcaption", null, caption))), beside);
    return el("div", { class: "flipbook", role: "group", "aria-label": `Flip-book of ${title}` },
      pair, el("div", { class: "wipe" }, button, slider));
  }

  const differenceScale = (item) => el("div", { class: "legend" }, el("figure", null,
    el("figcaption", null, "Differences of radiance, a tenth of the display's white at the ends"),
    colourBar(run.difference_colours, "Colour scale from below the reference to above it",
      `−${written(item.scale)} darker`, "agrees", `brighter ${written(item.scale)}`)));

  function evidence(item) {
    const size = item.size_px;
    const strip = [size[0], item.slice_count];
    const title = `${item.scene} by ${item.column}`;
    const rows = `row ${item.row}, frames ${item.slice_first} to ` +
      `${item.slice_first + item.slice_count - 1}, time runs down`;
    const flicker = figure(item, "seen_contrast_radiance", `${title}: visible flicker`,
      "visible flicker: black is none, green is above 10 times the threshold", size);
    const shown = el("div", { class: "evidence" },
      item.flip_count > 1 && flipbook(item, title, size, flicker),
      el("div", { class: "pictures" },
        figure(item, "worst", `${title}: worst frame`,
          `worst frame, ${item.worst_frame * item.frame_step}`, size),
        figure(item, "worst_reference", `${title}: its reference`, "its reference", size),
        figure(item, "worst_difference", `${title}: signed difference`, "frame − reference", size)),
      item.slice_count > 0 && el("div", { class: "pictures" },
        figure(item, "slice", `${title}: a row of pixels over time`, rows, strip),
        figure(item, "slice_reference", `${title}: the same row of the reference`,
          "the same row of the reference", strip),
        figure(item, "slice_difference", `${title}: difference of this row`,
          "frames − reference", strip)),
      has(item, "worst_difference") && differenceScale(item));
    const worst = of(item.scene, item.column).find((result) => result.point === item.point);
    return el("article", { class: "exhibit" },
      el("h4", null, item.column, item.point && ` at ${item.point}`),
      worst && el("p", { class: "small" }, word(worst.verdict), ": ", worst.measure, maskOf(worst),
        " ", numberOf(worst), ", limit ", limitOf(worst), withFloor(worst),
        worst.why && `. ${worst.why}`),
      fit(shown, size));
  }

  // --------------------------------------------------------------------------------------- curves

  const PLOT = { width: 640, height: 240, left: 56, right: 12, top: 12, bottom: 40 };

  /** About five ticks for a range, in steps of 1, 2 or 5 times a power of ten. */
  function evenTicks(low, high) {
    const rough = (high - low) / 4;
    const power = 10 ** Math.floor(Math.log10(rough));
    const step = [1, 2, 5, 10].map((digit) => digit * power).find((one) => one >= rough);
    const ticks = [];
    for (let n = Math.ceil(low / step); n * step <= high; n++) ticks.push(n * step);
    return ticks;
  }

  /** The vertical axis: logarithmic if all values are above 0 and their ratio exceeds 30. */
  function axis(values, hasEndless) {
    const [low, high] = [Math.min(...values), Math.max(...values)];
    const isLog = low > 0 && high / low > 30;
    const put = isLog ? Math.log10 : (value) => value;
    const [a, b] = isLog ? [put(low) - 0.1, put(high) + (hasEndless ? 0.5 : 0.1)]
      : [Math.min(0, low), high === 0 ? 1 : high * (hasEndless ? 1.3 : 1.08)];
    const ticks = isLog
      ? [...Array(Math.floor(b) - Math.ceil(a) + 1).keys()].map((n) => 10 ** (Math.ceil(a) + n))
      : evenTicks(a, b);
    const place = (value) => PLOT.height - PLOT.bottom
      - ((put(value) - a) / (b - a)) * (PLOT.height - PLOT.bottom - PLOT.top);
    return { ticks, place };
  }

  const MARKS = [
    (x, y) => svg("circle", { cx: x, cy: y, r: 3.4 }),
    (x, y) => svg("rect", { x: x - 3, y: y - 3, width: 6, height: 6 }),
    (x, y) => svg("path", { d: `M${x - 4} ${y + 3}h8l-4 -7z` }),
    (x, y) => svg("path", { d: `M${x} ${y - 4.5}l4.5 4.5l-4.5 4.5l-4.5 -4.5z` }),
    (x, y) => svg("path", { d: `M${x - 4} ${y - 3}h8l-4 7z` }),
  ];

  /** The curve of one column with its marks; infinite values are marked at the top. */
  function series(own, n, across, place) {
    const [colour, dash] = SERIES[n % SERIES.length];
    const spots = own.map((one, p) => ({ x: across(p), one })).filter(({ one }) => one);
    const points = spots.filter(({ one }) => one.value !== null)
      .map(({ x, one }) => [x, place(one.value)]);
    const endless = spots.filter(({ one }) => one.infinite).map(({ x }) => [x + 9 * n]);
    const course = points.map(([x, y], i) => `${i ? "L" : "M"}${x.toFixed(1)} ${y.toFixed(1)}`);
    return svg("g", { fill: colour, stroke: colour },
      svg("path", { d: course.join(""), fill: "none", "stroke-width": 1.5,
        "stroke-dasharray": dash || null }),
      points.map(([x, y]) => MARKS[n % MARKS.length](x, y)),
      endless.map(([x]) => [MARKS[n % MARKS.length](x, PLOT.top + 6),
        svg("text", { x, y: PLOT.top + 24, "text-anchor": "middle", stroke: "none" }, "∞")]));
  }

  /** The floor of one column: dots in its colour. */
  function floorSeries(own, n, across, place) {
    const course = own.map((one, p) => [across(p), one?.floor ?? null])
      .filter(([, floor]) => floor !== null)
      .map(([x, floor], i) => `${i ? "L" : "M"}${x.toFixed(1)} ${place(floor).toFixed(1)}`);
    return svg("path", { d: course.join(""), fill: "none", stroke: SERIES[n % SERIES.length][0],
      "stroke-dasharray": "1 4", "stroke-width": 1.5 });
  }

  function curveKey(names, hasFloor) {
    return el("p", { class: "small curve-key" }, names.map((name, n) => {
      const [colour, dash] = SERIES[n % SERIES.length];
      return el("span", null, svg("svg", { width: 34, height: 12, "aria-hidden": "true" },
        svg("g", { fill: colour, stroke: colour },
          svg("path", { d: "M0 6H34", "stroke-width": 1.5, "stroke-dasharray": dash || null }),
          MARKS[n % MARKS.length](17, 6))), ` ${name} `);
    }), el("span", null, svg("svg", { width: 34, height: 12, "aria-hidden": "true" },
      svg("path", { class: "limit", d: "M0 6H34" })), " limit"),
    hasFloor && " · dots in the colour of a preset: its floor");
  }

  /** The label of a point of a sweep: its value; null if the sweep has several parameters. */
  const tickName = (point) => (point === "" ? "file" : point.includes(" ") ? null
    : point.replace(/^[^=]*=/, ""));

  function curve(scene, measure, over) {
    const { points } = sceneNamed(scene);
    const own = of(scene).filter((result) => result.measure === measure && result.over === over);
    const names = columns.map(({ name }) => name).filter((name) =>
      own.some((result) => result.column === name && hasNumber(result)));
    if (names.length === 0) return null;
    const { limit } = own[0];
    const resultAt = (name, point) => own.find((result) => result.column === name
      && result.point === point);
    const hasFloor = own.some((result) => typeof result.floor === "number");
    const values = own.flatMap((result) => [result.value, result.floor ?? null])
      .filter((value) => value !== null);
    const scale = axis([...values, limit].filter((value, n, all) => value > 0
      || Math.min(...all) <= 0), own.some((result) => result.infinite));
    const room = PLOT.width - PLOT.left - PLOT.right;
    const across = (p) => PLOT.left + (room * (p + 0.5)) / points.length;
    const level = (className, value) => line(className, PLOT.left, scale.place(value),
      PLOT.width - PLOT.right, scale.place(value));
    return el("figure", { class: "curve" },
      el("figcaption", { class: "small" }, bold(measure), maskText(over),
        `: ${MEASURES[measure] ?? ""}, over ${points.length} points of the sweep`),
      el("div", { class: "scroll" }, svg("svg", { class: "plot", role: "img",
        viewBox: `0 0 ${PLOT.width} ${PLOT.height}`, width: PLOT.width, height: PLOT.height,
        "aria-label": `${measure} over the points of the sweep; the numbers are in the table` },
      scale.ticks.map((tick) => [level("tick", tick),
        label(PLOT.left - 6, scale.place(tick) + 4, "end", written(tick))]),
      points.map((point, p) => label(across(p), PLOT.height - PLOT.bottom + 16, "middle",
        tickName(point) ?? String(p))),
      label(PLOT.left + room / 2, PLOT.height - 6, "middle",
        points.some((point) => point.includes(" ")) ? "number of the point in the table"
          : (points[1] ?? "").replace(/\+?=.*$/, "")),
      level("limit", limit),
      names.map((name, n) => series(points.map((point) => resultAt(name, point)), n, across,
        scale.place)),
      hasFloor && names.map((name, n) => floorSeries(points.map((point) => resultAt(name, point)),
        n, across, scale.place)))),
      curveKey(names, hasFloor));
  }

  // --------------------------------------------------------------------------------------- scenes

  function numberCell(scene, column, point, measure, over) {
    const result = of(scene, column.name).find((one) => one.point === point
      && one.measure === measure && one.over === over);
    if (!result) return notAsked();
    return el("td", { class: `num ${TINTS[result.verdict] ?? ""}`, title: result.why || null },
      numberOf(result), small(word(result.verdict)),
      result.floor_column && small(floorOf(result)));
  }

  function numbers(scene, points, label) {
    const rows = points.flatMap(({ point, number }) =>
      measuresOf(of(scene).filter((result) => result.point === point))
        .map((key) => ({ point, number, key })));
    return scrolling(label, table("findings",
      [colHead("Measure"), numHead("Limit"), columns.map(headCell)],
      rows.map(({ point, number, key }) => {
        const [measure, over] = key.split(" ");
        const own = of(scene).find((result) => result.measure === measure && result.over === over
          && result.point === point);
        return row(rowHead(measure, maskText(over),
          small(point ? `${number}: ${point}` : MEASURES[measure])),
        el("td", { class: "num", title: own.reason }, limitOf(own)),
        columns.map((column) => numberCell(scene, column, point, measure, over)));
      })));
  }

  /** The reasons of the verdicts, each once with its columns and measures. */
  function reasons(scene) {
    const told = Map.groupBy(of(scene).filter((result) => result.why),
      ({ verdict, why }) => `${verdict}\n${why}`);
    const named = (own, key) => unique(own.map((result) => result[key])).join(", ");
    return told.size > 0 && el("ul", { class: "small" }, [...told.values()].map((own) =>
      el("li", null, word(own[0].verdict), " ", bold(named(own, "column")), ", ",
        named(own, "measure"), `: ${own[0].why}`)));
  }

  function limits(scene) {
    const list = Map.groupBy(of(scene), ({ measure, over, limit, reason }) =>
      JSON.stringify([measure, over, limit, reason]));
    return folded("Sources of the limits", el("ul", { class: "small" },
      [...list.values()].map(([{ measure, over, limit, reason }]) => el("li", null, bold(measure),
        maskText(over), ` ≤ ${written(limit)}: `, reason))));
  }

  function commands(scene) {
    const own = run.commands[scene] ?? {};
    const shown = evidenceOf(scene).map((item) => item.column);
    const names = columns.map(({ name }) => name).filter((name) => own[name]
      && !shown.includes(name));
    return names.length > 0 && folded("Commands of the columns without evidence",
      el("ul", { class: "small" }, names.map((name) => el("li", null, bold(name), ": ",
        el("code", null, own[name])))));
  }

  function sceneSection(name) {
    const scene = sceneNamed(name);
    const points = scene.points.map((point, number) => ({ point, number }));
    const shown = evidenceOf(name);
    return section(anchor(name), scene.title,
      el("p", null, scene.fails),
      el("dl", { class: "facts" },
        fact("Scenario", el("span", { class: "mono" }, name)), fact("Symptom", scene.symptom),
        fact("Known to fail", scene.known),
        fact("Reference of presets", scene.truth === "exact" ? "engine exact"
          : "march, 16 rays per pixel"),
        columns.some((column) => !column.preset && of(name, column.name).length > 0)
          && fact("Reference of engines", "engine exact"),
        fact("Sequence",
          `${scene.frames} frames of ${scene.width_px} × ${scene.height_px} pixels`)),
      of(name).some(hasNumber) ? numbers(name, points.slice(0, 1), `Numbers of ${name}`)
        : el("p", { class: "soft" }, "Nothing was measured so far."),
      reasons(name),
      points.length > 1 && [
        el("h3", null, "Over the sweep"),
        measuresOf(of(name)).filter((key) => !key.startsWith("bad_values")).map((key) => curve(name,
          ...key.split(" "))),
        folded(`The numbers of ${points.length - 1} points`,
          numbers(name, points.slice(1), `Numbers of ${name} over its sweep`))],
      limits(name),
      shown.length > 0 && [el("h3", null, "Evidence"), shown.map(evidence)],
      commands(name));
  }

  // ----------------------------------------------------------------------------------------- page

  const foot = () => el("footer", null, el("p", null, "Every number of this page is in ",
    link("data.json"), "; command of the suite: ",
    el("code", null, "neph validate --suite stress"), "."));

  const main = document.getElementById("main");
  if (!hasData(main, run, "neph-failure-2")) return;
  document.title = `Stress tests: ${run.state === "finished" ? run.verdict : run.state}`;
  show(main, head(), matrix(), help(), order.map(sceneSection), foot());
  if (location.hash)
    document.getElementById(decodeURIComponent(location.hash.slice(1)))?.scrollIntoView();
  document.documentElement.dataset.ready = "yes";
})();
