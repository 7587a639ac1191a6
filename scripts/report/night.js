// SPDX-License-Identifier: MIT
//
// The page of a nightly run, from window.NEPH_NIGHT (data.js; README.md in this folder describes
// its format). The data list the worst finding first, and the page keeps this order. Strings of the
// data reach the page as text nodes and attribute values only, never as markup.
(function () {
  "use strict";

  const night = window.NEPH_NIGHT;
  const { el, small, bold, svg, line, label, plural, unique, signed, section, colHead, rowHead,
    numHead, words, row, table, scrolling, fact, entry, listed, link, hasData, withoutPlus, hole,
    pixels, fit, show, colourBar } = window.NephPage;
  const { seriesOf, command, copied, place, start, quoted } = window.NephAccept;

  // Findings that fail a run. Each finding is shown by a sign, a word and a colour, so that it can
  // be read without the colour.
  const FAILING = ["step failed", "history damaged", "not the same bits", "reference stale",
    "blank picture", "missing", "lost", "another size", "worse", "worse elsewhere", "edited"];
  const JUDGED = { worse: "wrong", better: "agrees", moved: "known" };
  const KINDS = {
    fixed: "the same program gives the same bits, so every change is significant; an interval " +
      "is over the pixels of the frame",
    drawn: "a random estimate; the 95 % interval is of this run",
    timed: "multiples of the duration of the calibration kernel; the range contains 95 % of the " +
      "runs without a change",
    mean: "relative to the accepted run; the range contains 95 % of the runs without a change",
    picture: "range of the radiance, divided by its mean",
  };
  const FAILED = ["failed", "timeout"];
  const LISTED = 16, SHOWN = 8; // unfolded groups of findings in the verdict and below it

  // -------------------------------------------------------------------------------------- numbers

  function written(value, digits = 4) {
    const text = withoutPlus(window.NephPage.written(value, digits, 1e6));
    return text.includes("e") ? text : text.replace("-", "−");
  }

  /** A rounded number, with all digits in its tooltip. */
  const number = (value, digits) => el("data", { value, "data-value": value, title: value },
    written(value, digits));

  const percent = (value, sign = true) => (sign && value > 0 ? "+" : "") +
    `${written(100 * value, 3)} %`;

  const fails = (found) => FAILING.includes(found);
  const word = (found) => (fails(found) ? signed("✗", found, "fail-word")
    : found === "better" ? signed("✓", found, "pass-word") : signed("○", found, "open-word"));

  // --------------------------------------------------------------------------------------- groups

  const sceneName = (scene) => scene.split(/[ @]/)[0];
  const sceneText = (scene) => scene.split("@")[0];

  /** The subject of a finding: an engine in a scene, a mean, a step or a reference. */
  const ofFinding = (finding) => (finding.kind === "mean" || !finding.scene ? finding.series
    : [finding.suite, finding.scene, finding.engine].join("/"));

  /** Groups of findings of one engine in one scene, in the order of their worst finding. */
  const groups = () => [...Map.groupBy(night.findings, (finding) =>
    `${finding.found}\n${ofFinding(finding)}`).values()];

  function titleOf([first]) {
    if (first.kind === "mean" || !first.scene) return first.series;
    return `${first.engine} in ${sceneText(first.scene)}` +
      `${first.suite === "catalog" ? "" : `, ${first.suite}`}`;
  }

  // ----------------------------------------------------------------------------------------- head

  const STATES = { running: "Running", interrupted: "Interrupted" };
  const VERDICTS = { pass: ["Pass", "pass"], fail: ["Fail", "fail"],
    "nothing compared": ["No verdict", "open"] };

  function sentence() {
    const bad = groups().filter(([first]) => fails(first.found));
    if (night.state !== "finished")
      return `${night.steps.filter((step) => step.outcome !== "not run").length} of ` +
        `${plural(night.steps.length, "step", "steps")} have ended; changes are listed at the end` +
        `${night.state === "interrupted" ? ". The same command continues the run" : ""}.`;
    if (night.compared === 0)
      return "Nothing was compared: accept a run, and later runs are compared with it.";
    if (bad.length === 0)
      return `No number is worse in ${plural(night.compared, "comparison", "comparisons")} with ` +
        `run ${night.baseline}.`;
    const { found, words } = bad[0][0];
    return `${titleOf(bad[0])} is ${found === "worse" ? "the worst" : found}: ` +
      `${bad[0][0].metric && found === "worse" ? `${bad[0][0].metric} ` : ""}${words}` +
      `${bad.length > 1 ? `; ${plural(bad.length - 1, "other", "others")} below` : ""}.`;
  }

  function counts() {
    const found = unique(night.findings.map((finding) => finding.found));
    return [`${plural(night.compared, "comparison", "comparisons")}, ${night.chances} of them ` +
      "with random errors", found.map((name) => `; ${night.findings.filter((finding) =>
      finding.found === name).length} ${name}`), `; ${night.new} new, ${night.elsewhere} of ` +
      `another environment, ${night.young} with too few runs, ${night.not_run} not run.`];
  }

  /** The line of group `n` in the verdict. */
  function newsItem(group, n) {
    const [first] = group;
    return el("li", null, word(first.found), " ",
      link(`#finding-${n + 1}`, titleOf(group)),
      first.change !== null && [": ", first.kind !== "mean" && first.metric && `${first.metric} `,
        bold(changeText(first))],
      group.length > 1 && `, and ${plural(group.length - 1, "number", "numbers")} more`);
  }

  const news = () => night.state === "finished" && listed(groups().map(newsItem), LISTED);

  function verdict() {
    const running = night.state !== "finished";
    const [said, kind] = running ? [STATES[night.state] ?? night.state, "open"]
      : VERDICTS[night.compared === 0 ? "nothing compared" : night.passes ? "pass" : "fail"];
    return el("div", { class: `verdict ${kind}` },
      el("p", { class: "word" }, said),
      el("div", { class: "said" }, el("p", null, bold(sentence())),
        !running && el("p", { class: "small" }, counts())),
      news());
  }

  function head() {
    const done = night.steps.filter((step) => step.done).length;
    return window.NephPage.head("Nephelometer nightly run", `Nightly run ${night.night}`, verdict(),
      fact("Compared with", night.baseline > 0 ? `run ${night.baseline}` : "no run yet"),
      fact("Tier", night.tier), night.revision && fact("Revision", night.revision),
      fact("Program", night.program), fact("Host", night.host),
      fact("Steps", `${done} of ${night.steps.length}, ${written(night.seconds / 60, 3)} min`),
      fact("Written", night.created_utc), fact("Version", `neph ${night.neph_version}`));
  }

  // --------------------------------------------------------------------------------------- trends

  const PLOT = { width: 300, height: 84, left: 8, right: 10, top: 8, bottom: 18 };

  /** A plot of a number over the runs: this run is a large dot, the accepted run an open ring. */
  function trend(finding) {
    const points = (finding.trend ?? []).filter(({ value }) => value !== null);
    if (points.length < 2) return el("p", { class: "small soft" }, "There are no earlier runs.");
    const nights = points.map((point) => point.night);
    const reach = (point) => 1.96 * (point.standard_error ?? 0);
    const values = points.flatMap((point) => [point.value - reach(point),
      point.value + reach(point)]);
    if (finding.range) values.push(finding.range.low, finding.range.high);
    const [low, high] = [Math.min(...values), Math.max(...values)];
    const [first, last] = [Math.min(...nights), Math.max(...nights)];
    const room = PLOT.width - PLOT.left - PLOT.right;
    const x = (n) => PLOT.left + room * (n - first) / (last - first);
    const y = (value) => PLOT.top + (PLOT.height - PLOT.top - PLOT.bottom) *
      (high > low ? (high - value) / (high - low) : 0.5);
    const course = points.map((point, n) =>
      `${n ? "L" : "M"}${x(point.night).toFixed(1)} ${y(point.value).toFixed(1)}`);
    const tonight = points[points.length - 1];
    return svg("svg", { class: "plot trend", role: "img", width: PLOT.width, height: PLOT.height,
      viewBox: `0 0 ${PLOT.width} ${PLOT.height}`,
      "aria-label": `${finding.metric ?? finding.series} over ${points.length} runs, from ` +
        `${written(points[0].value)} to ${written(tonight.value)}` },
    finding.range && svg("rect", { class: "zone", x: PLOT.left, y: y(finding.range.high),
      width: PLOT.width - PLOT.left - PLOT.right,
      height: Math.max(1, y(finding.range.low) - y(finding.range.high)) }),
    svg("path", { d: course.join(""), class: "course" }),
    points.map((point) => point.standard_error && line("course", x(point.night),
      y(point.value - reach(point)), x(point.night), y(point.value + reach(point)))),
    points.map((point) => svg("circle", { cx: x(point.night), cy: y(point.value),
      r: point === tonight ? 4.5 : point.night === finding.accepted_night ? 4 : 2,
      class: point === tonight ? "tonight" : point.night === finding.accepted_night ? "accepted"
        : point.judgement ? "aside" : "night" })),
    svg("text", { x: PLOT.left, y: PLOT.height - 4 }, `run ${first}`),
    label(PLOT.width - PLOT.right, PLOT.height - 4, "end", `run ${last}`));
  }

  // ------------------------------------------------------------------------------------- findings

  const figure = (frame, alt, caption, size) => frame && el("figure", null,
    frame.picture ? pixels(frame.picture, alt, size) : hole("the limit of the page is reached"),
    el("figcaption", null, caption));

  const differenceScale = (scale) => el("figure", { class: "difference-scale" },
    colourBar(night.difference_colours, "from darker to brighter in this run",
      `−${written(scale, 1)} darker`, "0", `+${written(scale, 1)} brighter`));

  function pictures({ shown, found, kind, scene, series }) {
    if (!shown) return null;
    const what = kind === "mean" ? `${series}, shown by ${sceneText(scene)}` : sceneText(scene);
    const { accepted, tonight, difference, size_px: size } = shown;
    const made = fit(el("div", { class: "pictures" },
      figure(accepted, `${what}: the accepted run`, "accepted run", size),
      figure(tonight, `${what}: this run`, "this run", size),
      difference?.scale > 0 && figure(difference, `${what}: this run minus the accepted run`,
        ["this run − accepted run, luminance: ", `${percent(difference.mean, false)} on average, `,
          `${percent(difference.changed, false)} of the pixels differ`], size)), size);
    return [made, difference?.scale > 0 && differenceScale(difference.scale),
      difference?.scale === 0 && el("p", { class: "small" }, "No pixel of this frame changed: " +
        (found === "moved" ? "the number changed with another frame."
          : "the number also depends on other data.")),
      accepted && !tonight && el("p", { class: "small" }, "This run has no such frame.")];
  }

  function rangeText(finding) {
    if (finding.interval)
      return [`95 % interval${finding.kind === "fixed" ? " over the pixels" : ""} `,
        number(finding.interval[0]), " to ", number(finding.interval[1])];
    if (finding.range)
      return ["range of 95 % of the runs without a change: ", number(finding.range.low), " to ",
        number(finding.range.high), ` (${finding.range.nights} runs)`];
    return finding.kind === "fixed" ? "no interval: the number has no random error" : null;
  }

  /** The words of a finding, without the two numbers where these are shown above the words. */
  const changeText = ({ words, tonight, baseline }) => (tonight !== null && baseline !== null
    ? words.slice(words.indexOf(": ") + 2) : words);

  const hasFloor = (one) => typeof one.preset_floor === "number";

  /** The floor of a number in motion, and the number over it. */
  const floorText = (one) => ["floor ", number(one.preset_floor),
    typeof one.times_preset_floor === "number" && ` (${written(one.times_preset_floor, 3)} times)`];

  function numbers(group) {
    const own = group.filter((finding) => finding.tonight !== null || finding.change !== null
      || (finding.trend ?? []).length > 0);
    if (own.length === 0)
      return group.map((finding) => el("p", null, `${finding.words}.`));
    return el("div", { class: "changes" }, own.map((finding) => el("div", { class: "change" },
      el("div", null,
        el("p", { class: "what" }, bold(finding.metric ?? finding.series),
          finding.truth && finding.truth !== "none" && `, reference ${finding.truth}`),
        finding.tonight !== null && finding.baseline !== null
          ? el("p", null, el("span", { class: "big" }, number(finding.tonight)), " accepted ",
            number(finding.baseline))
          : null,
        hasFloor(finding) && el("p", null, floorText(finding)),
        el("p", null, changeText(finding)),
        el("p", { class: "small soft" }, rangeText(finding),
          finding.floor !== null && [rangeText(finding) ? "; " : "", "detectable from ",
            percent(finding.floor, false)])),
      el("div", null, trend(finding)))));
  }

  function commands(group, shown) {
    const [first] = group;
    const series = seriesOf(group);
    const look = shown?.accepted?.exr && shown?.tonight?.exr
      && `neph view ${quoted(shown.accepted.exr)} ${quoted(shown.tonight.exr)} -o look`;
    const step = night.steps.find(({ name }) => name === first.step);
    return el("dl", { class: "facts commands" },
      first.command && fact("Repeat", el("code", null, first.command)),
      look && fact("View", el("code", null, look)),
      series.length > 0 && copied("Accept", command(night, series)),
      step?.log && fact("Log", link(`../${step.log}`, step.log)));
  }

  function groupArticle(group, n) {
    const [first] = group;
    const shown = group.map((finding) => finding.shown).find((one) => one) ?? null;
    const title = first.scene && night.scenes?.[sceneName(first.scene)]?.title;
    return el("article", { class: "exhibit finding-group", id: `finding-${n + 1}`,
      "data-of": ofFinding(first), "data-found": first.found },
      el("h3", null, word(first.found), " ", titleOf(group)),
      title && title !== sceneName(first.scene) && el("p", { class: "small soft" }, title),
      numbers(group),
      pictures({ ...first, shown }),
      commands(group, shown), place(seriesOf(group), titleOf(group)));
  }

  /** Acceptance of the whole run. */
  const wholeRun = () => el("article", { class: "exhibit", id: "whole-run" },
    el("h3", null, "All numbers of this run"),
    el("dl", { class: "facts commands" }, copied("Accept", command(night, ["*"]))),
    place(["*"], "all numbers of this run"));

  function changes() {
    if (night.state !== "finished") return null;
    const all = groups();
    const made = all.map(groupArticle);
    return section("changes", "What changed",
      all.length === 0 && el("p", null, night.compared > 0
        ? `Nothing: ${plural(night.compared, "number is", "numbers are")} as accepted.`
        : "There are no comparisons before a run is accepted."),
      made.slice(0, SHOWN),
      made.length > SHOWN && el("details", null,
        el("summary", null, `${made.length - SHOWN} more, less severe`), made.slice(SHOWN)),
      wholeRun());
  }

  const help = () => window.NephPage.help(
    entry("Worse", "The change is significant after a correction for all comparisons of the ",
      "run, and large enough to matter."),
    entry("Trend", "The number over the last runs: the open ring is the accepted run, the ",
      "large dot this run. Faint dots are runs that were found to have changed; the range ",
      "of durations excludes them."),
    entry("Frames", "Both runs at the exposure of the scene; of a sequence, the last frame. ",
      "Blue is darker in this run, red is brighter. Cyan and yellow are beyond the scale."),
    entry("Numbers", unique(night.findings.map((finding) => finding.kind).filter((kind) =>
      KINDS[kind])).map((kind) => `${kind}: ${KINDS[kind]}. `),
    "“Detectable from”: the smallest change that this run could detect."),
    entry("Floor", "The same measure of a scene in motion, every pixel marched in every frame: ",
      "the lower number of the anti-aliasing of the preset and the default one."),
    entry("Every number", "Point at a number of the tables below for all its digits, the ",
      "accepted number and the smallest detectable change."),
    entry("Intended change", "It is accepted by the command below it, with a reason, or here when ",
      "the page is served by ", el("code", null, "neph serve"), ": later runs are compared with ",
      "this run. Nothing is overwritten."));

  // --------------------------------------------------------------------------------------- scenes

  function numberCell(result) {
    if (!result) return el("td", { class: "num soft" }, "·");
    return el("td", { class: `num ${JUDGED[result.judged] ?? ""}` },
      result.tonight !== null && el("data", { value: result.tonight, "data-value": result.tonight,
        title: [String(result.tonight), result.why, result.baseline !== null
          && `accepted ${result.baseline}`, result.floor !== null
          && `detectable from ${percent(result.floor, false)}`].filter((text) => text)
          .join("; ") }, written(result.tonight, 3)),
      ["worse", "better", "moved"].includes(result.judged)
        && small(`${result.judged}, ${percent(result.change)}`),
      hasFloor(result) && small(floorText(result)),
      result.judged === "not judged" && small("not judged"));
  }

  function sceneTable(suite, scene, rows) {
    const metrics = unique(rows.map(({ metric }) => metric));
    const engines = unique(rows.map(({ engine }) => engine));
    return scrolling(`${scene}, ${suite}`, table("findings",
      [colHead("Engine"), metrics.map((metric) => numHead(metric))],
      engines.map((engine) => row(rowHead(engine), metrics.map((metric) =>
        numberCell(rows.find((one) => one.engine === engine && one.metric === metric)))))));
  }

  function sceneCard(suite, scene, rows) {
    const of = `${suite}/${scene}/`;
    const shown = Object.keys(night.pictures ?? {}).filter((key) => key.startsWith(of)
      && night.pictures[key]);
    const counted = rows.filter((row) => row.metric !== "contrast");
    if (counted.length === 0) return null;
    const changed = rows.filter((row) => ["worse", "better"].includes(row.judged));
    const size = shown.length > 0 && night.pictures[shown[0]].size_px;
    return el("details", { class: "scene", open: changed.length > 0 && suite === "catalog" },
      el("summary", null, sceneText(scene), changed.length > 0
        && ` · ${plural(changed.length, "number", "numbers")} changed`),
      shown.length > 0 && fit(el("div", { class: "pictures" }, shown.map((key) => el("figure", null,
        pixels(night.pictures[key].picture, `${sceneText(scene)} by ${key.slice(of.length)}`,
          night.pictures[key].size_px), el("figcaption", null, key.slice(of.length))))), size),
      sceneTable(suite, scene, counted));
  }

  function scenes() {
    const rows = (night.series ?? []).map((row) => {
      const [suite, scene, engine, metric] = row.series.split("/");
      return { ...row, suite, scene, engine, metric };
    });
    return rows.length > 0 && section("scenes", "All numbers of this run",
      [...Map.groupBy(rows, (row) => row.suite)].map(([suite, own]) => [el("h3", null, suite),
        [...Map.groupBy(own, (row) => row.scene)].map(([scene, its]) =>
          sceneCard(suite, scene, its))]));
  }

  function steps() {
    const failed = night.steps.filter((step) => FAILED.includes(step.outcome));
    const stepRow = (step) => el("tr", { class: FAILED.includes(step.outcome) ? "failing" : null },
      rowHead(step.name),
      el("td", null, step.outcome, step.log && [" ", link(`../${step.log}`, "log")]),
      words(step.reason));
    return section("steps", "Steps",
      failed.length > 0 && el("ul", null, failed.map((step) => el("li", null, step.name, ": ",
        step.outcome, ", ", step.reason, " ", step.log && link(`../${step.log}`, "log")))),
      el("details", { open: night.state !== "finished" },
        el("summary", null, plural(night.steps.length, "step", "steps")),
        scrolling("Steps", table(null, ["Step", "Outcome", "Reason"].map((name) => colHead(name)),
          night.steps.map(stepRow)))));
  }

  // ----------------------------------------------------------------------------------------- page

  /** Opens the folded block that contains the target of a link. */
  function unfold(href) {
    if (!href?.startsWith("#")) return;
    const details = document.getElementById(href.slice(1))?.closest("details");
    if (details) details.open = true;
  }

  const foot = () => el("footer", null,
    night.page.left_out > 0 && el("p", null, "The limit of the page is reached: ",
      plural(night.page.left_out, "image is", "images are"), " left out."),
    el("p", null, "Every number of this page is in ", link("data.json"),
      "; the numbers without the images are in ", link("../nightly.json", "nightly.json"), "."));

  const main = document.getElementById("main");
  if (!hasData(main, night, "neph-night-page-1")) return;
  document.title = `Nightly run ${night.night}: ` + (night.state !== "finished" ? night.state
    : night.compared === 0 ? "nothing compared" : night.passes ? "pass" : "fail");
  show(main, head(), changes(), help(), scenes(), steps(), foot());
  main.addEventListener("click", ({ target }) => unfold(target.getAttribute?.("href")));
  start(night);
  document.documentElement.dataset.ready = "yes";
})();
