// SPDX-License-Identifier: MIT
//
// Lays out a report from window.NEPH_REPORT (data.js; README.md beside this file is the contract).
// Strings of the data reach the page as text nodes and attribute values alone, never as markup.
// Every number on the page names its place in the data (data-path) and its exact value
// (data-value; data-scale is the factor of a changed unit), or, where it is counted here, what it
// counts (data-derived), so that check_report.mjs can hold the page against data.json.
(function () {
  "use strict";

  const report = window.NEPH_REPORT;
  const { append, el, svg, hidden, folded, colHead, rowHead, numHead, num, words, row: tr, table,
    scrolling, fact, entry, listed, link, complain, hole, fit, show, colourBar, loadVega,
    drawLive } = window.NephPage;

  // ---------------------------------------------------------------------------------- vocabulary

  const RUNGS = {
    exact: "exact: closed form or converged quadrature",
    tracer: "tracer: our unbiased path tracer",
    witness: "witness: another project's renderer",
    model: "model: a real-time method under test",
  };
  const QUANTITIES = { radiance: "Radiance", transmittance: "Transmittance", depth: "Depth",
    volume: "Light of the medium alone" };
  const MASKS = { all: "whole picture", sky: "sky", medium: "inside the medium",
    depth_edge: "at edges in depth", solid: "solids",
    non_edge: "away from edges in depth", thin: "thin objects", cloud: "clouds", fog: "fog",
    sun: "the sun" };
  const STATUSES = {
    rendered: ["rendered", ""],
    cannot: ["cannot", "open-word"],
    missing: ["not installed", "open-word"],
    failed: ["✗ failed", "fail-word"],
    timeout: ["✗ timed out", "fail-word"],
    interrupted: ["✗ interrupted", "fail-word"],
    over_budget: ["○ did not fit", "open-word"],
  };
  const VERDICTS = {
    pass: ["✓ pass", "pass-word"],
    fail: ["✗ fail", "fail-word"],
    not_measured: ["○ not measured", "open-word"],
  };
  const BAKED = {
    grid: "grid", extinction_rms_relative: "RMS error ÷ RMS of the extinction",
    extinction_max_relative: "largest error ÷ largest extinction",
    optical_depth_rms: "optical depth of random chords, RMS error",
    optical_depth_max: "largest error", optical_depth_mean: "mean error",
    transmittance_max: "transmittance of the chords, largest error",
  };
  // What the whole run has come to: its word, and the class of its colour.
  const RUNS = {
    pass: ["Pass", "pass"],
    fail: ["Fail", "fail"],
    running: ["Running", "open"],
    interrupted: ["Interrupted", "open"],
  };
  // What a participant of the physics suite made of a check.
  const FINDINGS = {
    agrees: ["✓ agrees", "pass-word"],
    known: ["△ off, cause known", "open-word"],
    gap: ["◇ model gap", "open-word"],
    wrong: ["✗ off", "fail-word"],
  };
  const PAIRS = {
    agree: ["✓ agree", "pass-word"],
    differ: ["≠ differ", "open-word"],
    "cannot tell: noise": ["○ cannot tell: noise", "soft"],
  };
  // What a rung of the physics suite asks, in plain words.
  const QUESTIONS = {
    furnace: "A medium that absorbs nothing and is lit evenly from all sides cannot be seen: as "
      + "much light is scattered into every ray as out of it. "
      + "Every pixel must show the surround. An engine that makes or loses energy shows the "
      + "medium.",
    single: "Light that is scattered exactly once has formulas and integrals that can be worked "
      + "out to many digits. This tests extinction, phase functions, "
      + "the sun's own path through the medium, and the sum along the view.",
    slab: "Light scattered any number of times. In an endless slab this is solved by adding thin "
      + "layers and doubling thick ones: another road than following "
      + "light paths, so both cannot share a mistake.",
    fog: "The same for fog that thins out with height: it holds as much matter as a slab of the "
      + "same optical depth, and must reflect the same light.",
    "half-space": "A slab so thick that nothing comes out below. Its light was solved with pen and "
      + "paper by S. Chandrasekhar (1950).",
    conservation: "What enters a medium that absorbs nothing must leave it: reflected, transmitted "
      + "and unscattered light add up to all there was.",
    "step-cloud": "A cloud whose thin and thick columns stand side by side, an exercise of the "
      + "Intercomparison of 3D Radiation Codes (I3RC): light leaks through "
      + "their sides, which no engine gets right that thinks in layers. The truth is a Monte Carlo "
      + "of its own for columns, whose noise is part of the error given.",
    reciprocity: "Light goes the same way back. When camera and sun change places, the reflection "
      + "must stay what it was.",
  };
  // The one error of a scene and engine in the summary: the first of these that was measured.
  const HEADLINES = [
    ["radiance", "rel_mse", "all"],
    ["radiance", "rmse", "all"],
    ["transmittance", "rmse", "all"],
    ["transmittance", "max_abs", "all"],
    ["depth", "rmse", "all"],
  ];
  // From minus to plus the scale; the program's maps interpolate these linearly in sRGB code
  // values.
  // The numbers of a scene's card: head, note below it, and the first of these that is there.
  const CARD = [
    ["Radiance bias", "mean, %", [["radiance", "rel_bias"]]],
    ["Radiance RMSE", "of the mean, %", [["radiance", "rel_rmse"], ["radiance", "rmse"]]],
    ["FLIP", "mean", [["radiance", "flip_mean"]]],
    ["Transmittance", "largest error", [["transmittance", "max_abs"]]],
  ];
  const WORTH_A_LOOK = 0.01; // a relative bias that no gate limits and that the head names
  const WORTH_MOST = 5; // of those, before the rest is left to the cards
  const DIFFERENCE_COLOURS = ["#053061", "#4393c3", "#f7f7f7", "#d6604d", "#67001f"];
  const BROKEN = ["failed", "timeout", "interrupted"];
  const SCENES_NAMED = 8; // in the contents; more are folded there
  const LISTED = 12; // troubles in the verdict before the rest is folded away

  // ------------------------------------------------------------------------------------- elements

  const absent = (text) => el("span", { class: "absent" },
    el("span", { "aria-hidden": "true" }, "—"), hidden(text ?? "not measured"));
  const plural = (count, one, many) => (count === 1 ? one : many);

  function word(table, key) {
    const [text, className] = table[key] ?? [key, "open-word"];
    return el("span", { class: className || null }, text);
  }

  /** The reason of a state, which need not say the state again. */
  const why = (frame) => String(frame.reason ?? "").replace(/^cannot:\s*/, "").trim();

  /** Its first line; a longer one, such as the log of a child, stands whole where `id` is. */
  function briefly(frame, id) {
    const [first, ...rest] = why(frame).split("\n");
    return [first, rest.length > 0 && id && [" … ", el("a", { href: `#${id}` }, "log")]];
  }

  /** A path that stays inside the report, or null. */
  function inside(path) {
    return typeof path === "string" && /^(images|charts)\/[\w.@\-/]+$/.test(path)
      && !path.includes("..") ? path : null;
  }

  /** A page of neph view that lies in the report, or null. */
  const viewerOf = (scene) => (/^view\/[\w.\-]+\/index\.html$/.test(scene.viewer ?? "")
    && !scene.viewer.includes("..") ? scene.viewer : null);

  const taken = new Set();
  function anchor(prefix, name) {
    const base = `${prefix}-${String(name).replace(/[^A-Za-z0-9_-]+/g, "-")}`;
    let id = base;
    for (let n = 2; taken.has(id); n++) id = `${base}-${n}`;
    taken.add(id);
    return id;
  }

  // -------------------------------------------------------------------------------------- numbers

  const grouped = (digits) => digits.replace(/\B(?=(\d{3})+(?!\d))/g, "\u202f");

  /** Three significant digits, or as many as asked for; whole numbers in full. */
  function written(value, exact, digits = 3) {
    const magnitude = Math.abs(value);
    let text;
    if (Number.isInteger(value) && magnitude < 1e6) {
      text = magnitude < 10000 ? String(magnitude) : grouped(String(magnitude));
    } else {
      const rounded = Number(magnitude.toPrecision(digits));
      if (rounded < 1e-3 || rounded >= 1e6)
        text = magnitude.toExponential(digits - 1).replace("e+", "e");
      else if (rounded >= 1000)
        text = rounded >= 10000 ? grouped(magnitude.toFixed(0)) : magnitude.toFixed(0);
      else text = magnitude.toFixed(Math.max(0,
          digits - 1 - Math.floor(Math.log10(rounded) + 1e-12)));
      // A limit is what somebody chose, not a measurement: it has no trailing zeros.
      if (exact && text.includes(".")) text = text.replace(/\.?0+(?=e|$)/, "");
    }
    return text.replace("e-", "e−");
  }

  const at = (path) => path.split("/")
    .reduce((node, key) => (node === null || node === undefined ? undefined : node[key]), report);

  /** The number at `path` of the data. Options: scale, unit, signed, exact, digits. */
  function number(path, options) {
    const { scale = 1, unit = "", signed = false, exact = false, digits = 3 } = options ?? {};
    const value = at(path);
    if (typeof value !== "number" || !Number.isFinite(value)) {
      const dash = absent();
      dash.setAttribute("data-path", path);
      dash.setAttribute("data-value", "null");
      return dash;
    }
    const shown = value * scale;
    const sign = shown < 0 ? "−" : signed && shown > 0 ? "+" : "";
    const element = el("data", { value, "data-path": path, "data-value": value,
        title: `${value}${scale === 1 ? "" : ` × ${scale}`}` },
      sign + written(Math.abs(shown), exact, digits));
    if (scale !== 1) element.setAttribute("data-scale", scale);
    return unit ? [element, unitText(unit)] : element;
  }

  const unitText = (unit) => el("span", { class: "unit" }, "\u00a0" + unit);

  /** A number counted on this page; the checker counts again. */
  const derived = (what, count) => el("span", { "data-derived": what, "data-value": count },
    String(count));

  /** Ratios come as plain numbers; people read percent. */
  const isRatio = (unit) => unit === "" || unit === "1" || unit === null || unit === undefined;
  function reading(metric, unit) {
    const signed = /bias$/.test(metric);
    return metric === "rel_bias" && isRatio(unit) ? { scale: 100, signed, unit: "%" } : { signed,
      unit: isRatio(unit) ? "" : unit };
  }

  // ---------------------------------------------------------------------------- looking things up

  const scenes = report?.scenes ?? [];
  const engines = report?.engines ?? [];
  const sequences = report?.sequences ?? [];
  const framesOf = (scene) => scene.frames ?? [];
  const gatesOf = (scene) => scene.gates ?? [];
  const physics = report?.physics ?? null;
  const rows = physics?.rows ?? [];
  const sceneIds = scenes.map((scene) => anchor("scene", scene.name));
  const logIds = scenes.map((scene) => framesOf(scene).map((frame) => anchor("log",
    `${scene.name}-${frame.engine}`)));
  const checks = (physics?.checks ?? [])
    .map((check, c) => ({ check, c, id: anchor("check", check.name) }));
  const rungs = (physics?.rungs ?? []).filter((rung) => checks.some(({ check }) =>
      check.rung === rung.name)).map((rung) => ({ ...rung, id: anchor("rung", rung.name) }));
  const metricNames = (report?.metrics ?? [])
    .map((metric) => metric.name); // in the order of their tables
  const isTruth = (scene, engine) => scene.truth?.engine === engine;
  const engineNamed = (name) => engines.find((engine) => engine.name === name);

  function measurementOf(s, f, quantity, metric, mask) {
    const list = scenes[s].frames[f].measurements ?? [];
    const m = list.findIndex((row) => row.quantity === quantity && row.metric === metric
      && row.mask === mask && row.value !== null);
    return m < 0 ? null : { path: `scenes/${s}/frames/${f}/measurements/${m}/value`,
      unit: list[m].unit };
  }

  function unitOf(scene, quantity, metric) {
    for (const frame of framesOf(scene)) {
      const row = (frame.measurements ?? [])
        .find((m) => m.quantity === quantity && m.metric === metric && m.unit);
      if (row) return row.unit;
    }
    return "";
  }

  const maskName = (mask) => MASKS[mask] ?? mask;
  const measured = (gate) => `${gate.quantity} ${gate.metric}, ${maskName(gate.mask)}`;

  function gateValue(s, g, key) {
    const gate = scenes[s].gates[g];
    const { scale, signed, unit } = reading(gate.metric,
      unitOf(scenes[s], gate.quantity, gate.metric));
    return number(`scenes/${s}/gates/${g}/${key}`,
      { scale, unit, signed: signed && key === "value", exact: key === "maximum" });
  }

  // ----------------------------------------------------------------------------------------- head

  function head() {
    const size = report.size_px ?? [];
    return window.NephPage.head("Nephelometer report", report.title, verdict(),
      fact("Written", report.created_utc),
      fact("Took", number("seconds", { unit: "s" })),
      fact("Version", ["neph ", report.neph_version]),
      fact("Host", [report.host?.cpu, " · ", number("host/cores"), " cores · ",
        number("host/memory_bytes", { scale: 1 / 2 ** 30, unit: "GiB" })]),
      scenes.length > 0 && fact("Pictures",
        size.length ? [number("size_px/0"), " × ", number("size_px/1"), " pixels"] : absent()),
      report.screen === "screen/index.html" && fact("Beside",
        link("screen/index.html", "what a screen cannot know")));
  }

  const item = (...children) => el("li", {}, children);

  /** Failed gates, farthest over their limit first. */
  function failedGates(all) {
    const over = ({ gate }) => (typeof gate.value === "number"
      ? Math.abs(gate.value) / gate.maximum : Infinity);
    return all.filter(({ gate }) => gate.verdict === "fail").sort((a, b) => over(b) - over(a))
      .map(({ gate, s, g }) => item(word(VERDICTS, "fail"), " ", sceneLink(s), " · ",
        el("b", {}, gate.engine), " · ", measured(gate), ": ", gateValue(s, g, "value"),
        intervalOf(s, gate), ", limit ", gateValue(s, g, "maximum"),
        gate.reason ? ` (${gate.reason})` : "", "; again: ",
        el("code", {}, `neph validate ${scenes[s].name}`)));
  }

  /** Of the number that a gate limits. */
  function intervalOf(s, gate) {
    const f = framesOf(scenes[s]).findIndex((frame) => frame.engine === gate.engine);
    const found = f < 0 ? null : measurementOf(s, f, gate.quantity, gate.metric, gate.mask);
    if (!found || !at(`${found.path}/interval`)) return null;
    const { scale } = reading(gate.metric, found.unit);
    return [" [", number(`${found.path}/interval/0`, { scale }), ", ",
      number(`${found.path}/interval/1`, { scale }), "]"];
  }

  const brokenFrames = () => scenes.flatMap((scene, s) => framesOf(scene)
    .map((frame, f) => ({ frame, s, f })).filter(({ frame }) => BROKEN.includes(frame.status)));

  const brokenLines = () => brokenFrames().map(({ frame, s, f }) => item(
    word(STATUSES, frame.status), " ", sceneLink(s), " · ", el("b", {}, frame.engine),
    why(frame) && [": ", briefly(frame, logIds[s][f])]));

  function physicsLines() {
    const phases = (physics?.phase_functions ?? []).filter((row) => row.verdict === "off")
      .map((row) => item(word(FINDINGS, "wrong"), " ", link("#phase-functions",
        "Phase function"), " ", String(row.phase).replace(/_/g, " ")));
    const size = (r) => Math.abs(rows[r].deviation ?? 0);
    const wrong = [...rows.keys()].filter((r) => findingOf(rows[r]) === "wrong")
      .sort((a, b) => size(b) - size(a)).map((r) => item(word(FINDINGS, "wrong"), " ",
        checkLink(rows[r].check), " · ", el("b", {}, rows[r].participant), " by ", deviation(r)));
    const broken = rows.filter((row) => BROKEN.includes(row.status)).map((row) => item(
      word(STATUSES, row.status), " ", checkLink(row.check), " · ", el("b", {}, row.participant),
      why(row) && [": ", briefly(row)]));
    return [...phases, ...wrong, ...broken];
  }

  /** Frames whose radiance was measured and that no gate of radiance limits, worst first. */
  function ungated() {
    return scenes.flatMap((scene, s) => framesOf(scene).map((frame, f) => ({ frame, s,
      found: measurementOf(s, f, "radiance", "rel_bias", "all") }))
      .filter(({ frame, found }) => found && typeof at(found.path) === "number"
        && !gatesOf(scene).some((gate) => gate.engine === frame.engine
          && gate.quantity === "radiance")))
      .sort((a, b) => Math.abs(at(b.found.path)) - Math.abs(at(a.found.path)));
  }

  const ungatedLines = (list) => list
    .filter(({ found }) => Math.abs(at(found.path)) >= WORTH_A_LOOK).slice(0, WORTH_MOST)
    .map(({ frame, s, found }) => item(el("span", { class: "open-word" }, "◇ not gated"), " ",
      sceneLink(s), " · ", el("b", {}, frame.engine), " · radiance ",
      number(found.path, reading("rel_bias", found.unit))));

  const openLines = (open) => open.map(({ gate, s }) => item(word(VERDICTS, "not_measured"), " ",
    sceneLink(s), " · ", el("b", {}, gate.engine), " · ", measured(gate),
    gate.reason ? `: ${gate.reason}` : ""));

  const absentLines = () => (report.absent ?? []).map((entry) => item(
    el("span", { class: "open-word" }, "○ left out"), " ", el("b", {}, entry.scene),
    entry.reason ? `: ${entry.reason}` : "",
    entry.hint && el("span", { class: "soft" }, ` (${entry.hint})`)));

  function gateSentence(all, failing, open) {
    const total = derived("gates", all.length);
    return [all.length === 0 ? [total, " gates: nothing was held to a limit."]
      : failing.length > 0
        ? [derived("gates.fail", failing.length), " of ", total, plural(all.length, " gate",
          " gates"), plural(failing.length, " is", " are"), " over the limit."]
        : open.length === 0
          ? [plural(all.length, "The one gate is", "All gates are"), " within the limit (",
            total, ")."]
          : ["No gate is over its limit (", total, " in all)."],
    open.length > 0 && [" ", derived("gates.not_measured", open.length),
      " could not be measured."]];
  }

  /** What a pass does not speak of. */
  function ungatedSentence(list) {
    if (list.length === 0) return null;
    const { frame, s, found } = list[0];
    return [" No gate limits the radiance of ", derived("frames.ungated", list.length),
      plural(list.length, " frame: ", " frames; the farthest off is "), el("b", {}, frame.engine),
      " in ", sceneLink(s), ", ", number(found.path, reading("rel_bias", found.unit)), "."];
  }

  function verdict() {
    const all = scenes.flatMap((scene, s) => gatesOf(scene).map((gate, g) => ({ gate, s, g })));
    const failing = all.filter(({ gate }) => gate.verdict === "fail");
    const open = all.filter(({ gate }) => gate.verdict === "not_measured");
    const broken = brokenFrames();
    const missing = report.absent ?? [];
    const free = ungated();
    const [said, colour] = RUNS[report.verdict] ?? [report.verdict, "open"];
    const lines = [...failedGates(all), ...brokenLines(), ...physicsLines(),
      ...ungatedLines(free), ...openLines(open), ...absentLines()];
    return el("section", { class: `verdict ${colour}`, "aria-label": "Verdict" },
      el("p", { class: "word" }, said),
      el("div", { class: "said" }, unfinished(), physics && physicsVerdict(),
        (scenes.length > 0 || !physics) && el("p", {}, gateSentence(all, failing, open),
        broken.length > 0 && [" ", derived("frames.broken", broken.length),
          plural(broken.length, " rendering", " renderings"), " did not finish."],
        missing.length > 0 && [" ", derived("absent", missing.length), plural(missing.length,
            " scene was", " scenes were"), " left out: its data are not on this machine."],
        ungatedSentence(free)),
        report.counts && el("p", { class: "small soft" }, derived("counts.reported",
            report.counts.reported), " of ", derived("counts.expected", report.counts.expected),
          " results are in this report, ", derived("counts.compared", report.counts.compared),
          " compared with a truth.")),
      listed(lines, LISTED, "The rest of the list", "small"));
  }

  /** A page that was written before the run was over says so, and how much of it is here. */
  function unfinished() {
    if (!report.progress) return null;
    return el("p", {}, report.verdict === "running"
      ? "This page is written as the run goes on: load it again to see more. "
      : "The run was cut short; the same command goes on from here. ",
      number("progress/done"), " of ", number("progress/total"), " steps are over",
      typeof report.progress.left_s === "number" && report.verdict === "running" ? [", about ",
        number("progress/left_s", { unit: "s", digits: 2 }), " are left."] : ".");
  }

  const titleOf = (scene) => scene.title || scene.name;
  const sceneLink = (s) => link(`#${sceneIds[s]}`, titleOf(scenes[s]));

  function contents() {
    const place = (id, text) => item(link(`#${id}`, text));
    const all = scenes.map((scene, s) => place(sceneIds[s], titleOf(scene)));
    const isLong = all.length > SCENES_NAMED;
    return el("nav", { "aria-label": "Contents" }, el("ul", {},
      (report.charts ?? []).length > 0 && place("charts", "Speed against accuracy"),
      physics && place("physics", "Physics: who agrees"),
      rungs.map((rung) => place(rung.id, sentenceCase(rung.name))),
      !isLong && all,
      sequences.length > 0 && place("over-time", "Over time"),
      (scenes.length > 0 || !physics) && place("summary", "All in one table"),
      physics?.phase_functions?.length > 0 && place("phase-functions", "Phase functions"),
      place("engines", "Engines"), place("help", "How to read this")),
    isLong && folded("All scenes", el("ul", {}, all)));
  }

  // -------------------------------------------------------------------------------------- summary

  /** The first headline that much of the matrix can show, so that its cells are alike. */
  function commonHeadline() {
    const counts = HEADLINES.map((headline) => {
      let count = 0;
      scenes.forEach((scene, s) => framesOf(scene).forEach((_, f) => {
        if (measurementOf(s, f, ...headline)) count++;
      }));
      return count;
    });
    return HEADLINES[counts.findIndex((count) => count > 0 && count * 2 >= Math.max(...counts))]
      ?? HEADLINES[0];
  }

  function summary() {
    if (scenes.length === 0 && physics) return null;
    const common = commonHeadline();
    const order = [common, ...HEADLINES.filter((headline) => headline !== common)];
    const units = scenes.map((scene) => unitOf(scene, common[0], common[1]))
      .filter((unit) => !isRatio(unit));
    const unit = units[0] ?? "";
    const attributed = scenes.some((scene) => scene.attribution);
    return el("section", { "aria-labelledby": "summary" },
      el("h2", { id: "summary" }, "All scenes and engines in one table"),
      folded("The table", scrolling("Summary", table("wide matrix",
        [colHead("Scene"), engines.map((engine) => numHead(engine.name,
          engine.available ? engine.rung : "not installed")),
        attributed && colHead("Stands alone")],
        scenes.map((scene, s) => tr(
          rowHead(sceneLink(s), el("small", { class: "mono" }, scene.name)),
          engines.map((engine) => num(summaryCell(s, engine, order, unit))),
          attributed && el("td", {}, standsAlone(scene))))),
      [`The number is the ${common[1]} of the ${common[0]} over the ${maskName(common[2])}`,
        unit && `, in ${unit},`, " against the reference of the scene; where another one stands, ",
        "it says which. Below it, the relative bias (+ is too bright) and the word of the gates. ",
        attributed && "“Stands alone” is who differs from all others, without any reference. ",
        "A dash is a number that was not measured."])));
  }

  function standsAlone(scene) {
    if (!scene.attribution) return absent("not asked");
    if (scene.attribution.odd_one_out)
      return el("span", { class: "open-word" }, `≠ ${scene.attribution.odd_one_out}`);
    return el("span", { class: "soft small" }, scene.attribution.sentence);
  }

  function gateWord(scene, engine) {
    const verdicts = gatesOf(scene).filter((gate) => gate.engine === engine)
      .map((gate) => gate.verdict);
    if (verdicts.length === 0) return el("small", {}, "no gate");
    const worst = verdicts.includes("fail") ? "fail" : verdicts.includes("not_measured")
      ? "not_measured" : "pass";
    return el("small", {}, word(VERDICTS, worst));
  }

  function summaryCell(s, engine, order, commonUnit) {
    const scene = scenes[s];
    const f = framesOf(scene).findIndex((frame) => frame.engine === engine.name);
    const gate = gateWord(scene, engine.name);
    const gated = gatesOf(scene).some(({ engine: name }) => name === engine.name) && gate;
    if (f < 0) return [el("span", { class: "soft" }, "not in this run"), gated];
    const frame = scene.frames[f];
    if (frame.status !== "rendered")
      return [word(STATUSES, frame.status), el("small", { class: "reason" },
        briefly(frame, logIds[s][f])), gated];
    if (isTruth(scene, engine.name))
      return [el("span", {}, "reference"), el("small", {}, frame.rung), gated];
    const headline = order.find((candidate) => measurementOf(s, f, ...candidate));
    if (!headline) return [absent(), gate];
    const { path, unit } = measurementOf(s, f, ...headline);
    const bias = measurementOf(s, f, headline[0], "rel_bias", headline[2]);
    return [number(path, { ...reading(headline[1], unit), unit: "" }),
      headline !== order[0] && el("small", {}, `${headline[0]} ${headline[1]}`),
      !isRatio(unit) && unit !== commonUnit && el("small", { class: "unit" }, unit),
      bias && el("small", {}, "bias ", number(bias.path, reading("rel_bias", bias.unit))),
      stepBias(s, f, headline[0]),
      frame.bake && el("small", {}, "saw a baked grid"),
      gate];
  }

  function help() {
    return el("section", { class: "help", "aria-labelledby": "help" },
      el("h2", { id: "help" }, "How to read this"),
      folded("What is compared, gates, pictures, numbers", el("dl", {},
        physics && physicsHelp(),
        (scenes.length > 0 || !physics) && sceneHelp(),
        entry("Difference maps", "Engine minus reference on a fixed scale: blue is below the "
          + "reference, red is above it, white agrees. Cyan and yellow lie beyond the scale below "
          + "and above; magenta is not a number."),
        entry("Numbers", "1.2e−4 means 0.00012. In [brackets]: the 95\u00a0% interval, unless "
          + "another one is named. A dash was not measured. ",
          "“Cannot” is an honest refusal: the engine does not model what the scene asks for. Point "
            + "at a number for all its digits."))));
  }

  function sceneHelp() {
    return [
      entry("What is compared", "Each scene isolates one piece of the physics of light in fog or "
        + "cloud. Several engines render it from the same file, ",
          "camera and light, and each is measured against the scene's reference."),
        entry("Reference and rung", "The reference is the highest rung of the ladder of truth that "
          + "can do the scene: exact (closed form), then tracer (our unbiased path tracer). ",
          "Witnesses (other projects' renderers) and models (real-time methods) are never the "
            + "truth."),
        entry("Gates", "A gate is a limit set beforehand for one number of one engine. ✓ is within "
          + "it, ✗ is over it, ○ could not be measured and says why."),
        entry("Pictures", "All pictures of a scene share one frozen exposure, so brighter means "
          + "brighter. Move over a picture, or use the slider below it, to wipe to the reference; ",
          "a click swaps the two. Numbers are taken from linear data, never from these pictures."),
        entry("Who stands alone", "Every pair of engines is also held against each other, without "
          + "any reference, with the noise taken out by two independent frames each. ",
          "The odd one out differs from all others while these do not differ among themselves."),
        entry("Step bias", "Witnesses march through uneven media in steps. More samples do not "
          + "mend that error, smaller steps do: a study halves the step, extrapolates to none, and "
          + "says what is left."),
    ];
  }

  // --------------------------------------------------------------------------------------- scenes

  /** A card: what it is, what was found, five numbers an engine, the pictures; the rest folded. */
  function sceneSection(scene, s) {
    const truth = scene.truth;
    const viewer = viewerOf(scene);
    return el("section", { "aria-labelledby": sceneIds[s] },
      el("h2", { id: sceneIds[s] }, titleOf(scene)),
      el("p", {}, scene.physics),
      el("p", { class: "small soft" }, el("span", { class: "mono" }, scene.name), " · ",
        truth ? ["held against ", el("b", {}, truth.engine), ` (${truth.rung})`]
          : "no reference: no engine of a trusted rung rendered it",
        " · exposure ",
        number(`scenes/${s}/exposure_ev`, { signed: true, unit: "EV", exact: true }),
        viewer && [" · ", link(viewer, "all frames in the viewer")],
        !viewer && scene.no_viewer && [" · not in the viewer: ", scene.no_viewer]),
      cardTable(scene, s),
      scene.attribution?.odd_one_out && el("p", { class: "finding odd" },
        el("b", { "aria-hidden": "true" }, "≠ "), scene.attribution.sentence),
      notRendered(scene, s),
      pictures(scene, s, "radiance"),
      folded("All numbers, maps of transmittance, steps, costs, gates of this scene",
        numbers(scene, s),
        transmittanceMaps(scene, s),
        baked(framesOf(scene)
          .map((frame, f) => ({ name: frame.engine, path: `scenes/${s}/frames/${f}/bake` }))),
        attribution(scene, s),
        studies(scene, s),
        runs(scene, s),
        gates(scene, s)));
  }

  // ---------------------------------------------------------------------------- five numbers a row

  /** What gates say of an engine, by quantity, and of which quantity none says anything. */
  function gatedWords(scene, s, f) {
    const { engine } = framesOf(scene)[f];
    const own = gatesOf(scene).filter((gate) => gate.engine === engine);
    const sorts = [["fail", "✗ ", "fail-word", " fails"], ["pass", "✓ ", "pass-word", " passes"],
      ["not_measured", "○ ", "open-word", " not measured"]];
    const said = [];
    for (const [verdict, sign, className, ending] of sorts) {
      const others = sorts.slice(0, sorts.findIndex(([name]) => name === verdict))
        .map(([name]) => name);
      const named = [...new Set(own.filter((gate) => gate.verdict === verdict
        && !own.some((other) => other.quantity === gate.quantity
          && others.includes(other.verdict))).map((gate) => gate.quantity))];
      for (const quantity of named)
        said.push(el("span", { class: className }, sign, quantity, ending));
    }
    const free = ["radiance", "transmittance"].filter((quantity) =>
      !own.some((gate) => gate.quantity === quantity)
        && (framesOf(scene)[f].measurements ?? []).some((row) => row.quantity === quantity));
    const bias = measurementOf(s, f, "radiance", "rel_bias", "all");
    for (const quantity of free)
      said.push(el("span", { class: "soft" }, quantity, quantity === "radiance" && bias
        && [" ", number(bias.path, reading("rel_bias", bias.unit))], " not gated"));
    return said.map((part, n) => [n > 0 && "; ", part]);
  }

  function cardTable(scene, s) {
    const columns = CARD.map(([head, note, names]) => ({ head, note, find: (f) => names
      .map(([quantity, metric]) => measurementOf(s, f, quantity, metric, "all"))
      .find((found) => found && typeof at(found.path) === "number") }))
      .filter(({ find }) => framesOf(scene).some((_, f) => find(f)));
    const size = (f) => Math.abs(at(measurementOf(s, f, "radiance", "rel_bias", "all")?.path ?? "")
      ?? -1);
    const list = framesOf(scene).map((frame, f) => ({ frame, f }))
      .filter(({ f }) => columns.some(({ find }) => find(f)))
      .sort((a, b) => size(b.f) - size(a.f));
    if (list.length === 0)
      return el("p", { class: "soft" }, "Nothing was measured in this scene.");
    const isFailing = ({ engine }) => gatesOf(scene)
      .some((gate) => gate.engine === engine && gate.verdict === "fail");
    return scrolling(`${titleOf(scene)}: what matters`, table("wide five",
      [colHead("Engine, worst first"), columns.map(({ head, note }) => numHead(head, note)),
        numHead("Wall", "s"), colHead("Gates")],
      list.map(({ frame, f }) => el("tr", { class: isFailing(frame) ? "failing" : null },
        rowHead(frame.engine, el("small", {}, frame.rung)),
        columns.map(({ find }) => num(cardNumber(find(f)))),
        num(number(`scenes/${s}/frames/${f}/wall_s`)),
        words(gatedWords(scene, s, f), frame.note
          && el("div", { class: "small" }, frame.note))))));
  }

  function cardNumber(found) {
    if (!found) return absent();
    const { metric } = at(found.path.replace(/\/value$/, ""));
    const options = metric === "rel_rmse" ? { scale: 100 } : { ...reading(metric, found.unit),
      unit: "" };
    return [number(found.path, options), metric === "rmse" && unitText(found.unit)];
  }

  // -------------------------------------------------------------------------------------- pictures

  function notRendered(scene, s) {
    const rest = framesOf(scene).map((frame, f) => ({ frame, f }))
      .filter(({ frame }) => frame.status !== "rendered");
    return rest.length > 0 && el("p", { class: "small soft not-rendered" }, "No picture from ",
      rest.map(({ frame, f }, n) => [n > 0 && "; ", el("b", {}, frame.engine), " (",
        word(STATUSES, frame.status), why(frame) && [": ", briefly(frame, logIds[s][f])], ")"]),
      ".");
  }

  const drawnFrames = (scene) => framesOf(scene).filter((frame) => frame.status === "rendered")
    .sort((a, b) => isTruth(scene, b.engine) - isTruth(scene, a.engine));
  const mapsOf = (scene, kind) => framesOf(scene).some((frame) => frame.difference?.[kind]);

  /** Each engine's picture beside the truth's, and what it is off by. */
  function pictures(scene, s, kind) {
    const drawn = drawnFrames(scene);
    const truthFrame = framesOf(scene).find((frame) => isTruth(scene, frame.engine));
    if (drawn.length === 0) return el("p", {}, "No engine rendered this scene.");
    return [
      el("h3", {}, "Pictures, and the difference in radiance"),
      mapsOf(scene, kind) && truthFrame?.status !== "rendered"
        && el("div", { class: "legend" }, legend(scene, s, kind)),
      el("div", { class: "pictures" },
        drawn.map((frame) => card(scene, s, frame, truthFrame, kind)))];
  }

  function transmittanceMaps(scene, s) {
    const kind = "transmittance";
    const drawn = drawnFrames(scene).filter((frame) => frame.difference?.[kind]);
    if (drawn.length === 0) return null;
    const title = titleOf(scene);
    return [
      el("h3", {}, "Difference in transmittance"),
      el("div", { class: "legend" }, legend(scene, s, kind)),
      el("div", { class: "pictures" }, drawn.map((frame) => pictureCard(frame.engine, frame.rung,
        el("figure", {}, differenceMap(scene, frame, kind, title),
          el("figcaption", {}, `${frame.engine} − ${scene.truth?.engine ?? "reference"}`)))))];
  }

  function legend(scene, s, kind) {
    const unit = isRatio(unitOf(scene, kind, "bias")) ? "" : unitOf(scene, kind, "bias");
    return colourScale(`scenes/${s}/difference_scale/${kind}`,
      `${QUANTITIES[kind]}: engine − reference${unit ? ` [${unit}]` : ""}`);
  }

  function colourScale(path, title) {
    const given = report.difference_colours;
    const colours = Array.isArray(given) && given.length > 1
      && given.every((c) => /^#[0-9a-f]{6}$/i.test(c)) ? given : DIFFERENCE_COLOURS;
    return el("figure", {}, el("figcaption", {}, title),
      colourBar(colours, "Colour scale from below the reference to above it",
        [number(path, { scale: -1, exact: true }), " below"], "agrees",
        ["above ", number(path, { signed: true, exact: true })]));
  }

  const notHere = (path) => `${path} is not in this report's folder`;
  const pixels = (path, alt, className, size = report.size_px) => window.NephPage.pixels(path, alt,
    size, notHere(path), `pixels${className ? ` ${className}` : ""}`);

  function card(scene, s, frame, truthFrame, kind) {
    const own = inside(frame.picture);
    const reference = isTruth(scene, frame.engine);
    const other = reference ? null : inside(truthFrame?.picture);
    const title = titleOf(scene);
    const article = el("article", { class: "card" },
      el("header", {},
        el("h4", {}, frame.engine),
        el("p", {}, reference ? `reference · ${frame.rung}` : frame.rung)),
      own
        ? other ? wipe(own, other, frame.engine, scene.truth.engine,
          title) : [el("div", { class: "stack" }, pixels(own, `${title}, by ${frame.engine}`)),
          el("div", { class: "wipe" },
            reference ? "what the others are held against" : "no reference to wipe to")]
        : [hole("no picture: this engine gave no radiance"), el("div", { class: "wipe" })],
      mapsOf(scene, kind) && (reference
        ? el("figure", {}, el("div", { class: "scale" }, legend(scene, s, kind)),
          el("figcaption", {}, "scale of the differences"))
        : el("figure", {}, differenceMap(scene, frame, kind, title), el("figcaption", {},
            `${frame.engine} − ${scene.truth?.engine ?? "reference"}`))));
    article.style.gridRow = `span ${article.childElementCount}`;
    return article;
  }

  function differenceMap(scene, frame, kind, title) {
    const path = inside(frame.difference?.[kind]);
    if (path) return pixels(path,
      `${title}: signed ${kind} difference of ${frame.engine} from the reference`);
    if (!scene.truth) return hole("no reference in this scene");
    return hole(`no difference: ${frame.engine} or the reference gives no ${kind}`);
  }

  function wipe(own, other, engine, truth, title, size) {
    const over = pixels(other, "", "over", size);
    const stack = el("div", { class: "stack wipes", title: `Move: wipe to ${truth}. Click: swap.` },
      pixels(own, `${title}, by ${engine}`, "", size), over, el("span", { class: "edge" }),
      el("span", { class: "tag left", "aria-hidden": "true" }, truth), el("span",
        { class: "tag right", "aria-hidden": "true" }, engine));
    const slider = el("input", { type: "range", min: 0, max: 100, value: 0,
        "aria-label": `Wipe the picture of ${engine} to that of ${truth}` });
    const show = (percent) => {
      stack.style.setProperty("--wipe", `${percent}%`);
      stack.classList.toggle("wiping", percent > 0);
    };
    slider.addEventListener("input", () => show(Number(slider.value)));
    stack.addEventListener("pointermove", (event) => {
      const box = stack.getBoundingClientRect();
      show(Math.min(100, Math.max(0, (100 * (event.clientX - box.left)) / box.width)));
    });
    stack.addEventListener("pointerleave", () => show(Number(slider.value)));
    stack.addEventListener("click", () => {
      slider.value = Number(slider.value) >= 50 ? 0 : 100;
      show(Number(slider.value));
    });
    return [stack, el("div", { class: "wipe" }, el("span", { "aria-hidden": "true" }, engine),
        slider, el("span", { "aria-hidden": "true" }, truth))];
  }

  // -------------------------------------------------------------------------------- numbers table

  function numbers(scene, s) {
    const measured = framesOf(scene).map((frame, f) => ({ frame, f }))
      .filter(({ frame }) => (frame.measurements ?? []).length > 0);
    const columns = measured.filter(({ frame }) => !isTruth(scene, frame.engine));
    const title = el("h3", {}, "Numbers");
    if (measured.length === 0) return null;

    const groups = new Map();
    for (const { frame, f } of columns) {
      frame.measurements.forEach((row, m) => {
        if (typeof row.value !== "number") return;
        const key = JSON.stringify([row.quantity, row.mask]);
        if (!groups.has(key))
          groups.set(key, { quantity: row.quantity, mask: row.mask, metrics: new Map() });
        const { metrics } = groups.get(key);
        if (!metrics.has(row.metric)) metrics.set(row.metric, new Map());
        const cells = metrics.get(row.metric);
        cells.set(f, [...(cells.get(f) ?? []), m]);
      });
    }
    const rank = (names, name) => {
      const n = names.indexOf(name);
      return n < 0 ? names.length : n;
    };
    const ordered = [...groups.values()].sort((a, b) =>
      rank(Object.keys(QUANTITIES), a.quantity) - rank(Object.keys(QUANTITIES),
        b.quantity) || rank(Object.keys(MASKS), a.mask) - rank(Object.keys(MASKS), b.mask));
    const whole = ordered.filter((group) => group.mask === "all");
    const parts = ordered.filter((group) => group.mask !== "all");
    const table = (list, label) => numbersTable(scene, s, columns, list, label);
    return [
      title,
      whole.length > 0 && table(whole,
        `Errors over the whole picture against ${scene.truth?.engine ?? "no reference"}`),
      parts.length > 0 && el("details", { open: whole.length === 0 },
        el("summary", {}, "Numbers by part of the picture: ",
          [...new Set(parts.map((group) => maskName(group.mask)))].join(", ")),
        table(parts, "Errors by part of the picture")),
      measured.filter(({ frame }) => isTruth(scene, frame.engine))
        .map(({ frame, f }) => ofItself(s, f, frame)),
      unmeasured(measured),
    ];
  }

  /** The reference is held against nothing: what is counted in it stands in a line. */
  function ofItself(s, f, frame) {
    const path = (m, key) => `scenes/${s}/frames/${f}/measurements/${m}/${key}`;
    const list = frame.measurements.map((row, m) => ({ row, m }))
      .filter(({ row }) => typeof row.value === "number");
    return list.length > 0 && el("p", { class: "small soft" }, `Of ${frame.engine} itself: `,
      list.map(({ row, m }, n) => [n > 0 && ", ",
        `${row.quantity} ${row.metric} (${maskName(row.mask)}) `,
        number(path(m, "value"), reading(row.metric, row.unit)),
        row.interval && [" [", number(path(m, "interval/0")), ", ", number(path(m, "interval/1")),
          "]"]]), ".");
  }

  /** Why numbers are missing, each reason once. */
  function unmeasured(columns) {
    const reasons = new Map();
    for (const { frame } of columns)
      for (const row of frame.measurements)
        if (typeof row.value !== "number") {
          const reason = row.undefined_because || "no reason is given";
          reasons.set(reason, (reasons.get(reason) ?? new Set())
            .add(`${row.quantity} ${row.metric}`));
        }
    return reasons.size > 0 && el("ul", { class: "small soft" }, [...reasons]
      .map(([reason, names]) => item(`Not measured: ${[...names].join(", ")} (${reason}).`)));
  }

  function numbersTable(scene, s, columns, groups, label) {
    const explained = new Set(); // each measure is explained where it first stands
    const bodies = groups.map((group, n) => {
      const metrics = [...group.metrics.keys()].sort((a, b) => metricRank(a) - metricRank(b));
      return el("tbody", {},
        el("tr", { class: "group" }, el("th", { scope: "rowgroup", colspan: columns.length + 1 },
            `${QUANTITIES[group.quantity] ?? group.quantity}, ${maskName(group.mask)}`)),
        metrics.map((metric) => metricRow(scene, s, columns, group, metric, explained)),
        tr(rowHead("pixels", n === 0 && el("small", {}, "that the numbers above are taken over")),
          columns.map(({ frame, f }) => num(pixelCount(s, f, frame, group) ?? absent()))));
    });
    return scrolling(label, el("table", {}, el("thead", {}, tr(colHead("Measure"),
      columns.map(({ frame }) => numHead(frame.engine,
        isTruth(scene, frame.engine) ? "reference" : frame.rung)))), bodies));
  }

  function metricRank(metric) {
    const n = metricNames.indexOf(metric);
    return n < 0 ? Infinity : n;
  }

  const firstIn = (frame, group) => frame.measurements.findIndex((row) =>
    row.quantity === group.quantity && row.mask === group.mask && typeof row.value === "number");
  function pixelCount(s, f, frame, group) {
    const m = firstIn(frame, group);
    return m < 0 ? null : number(`scenes/${s}/frames/${f}/measurements/${m}/pixel_count`);
  }

  function metricRow(scene, s, columns, group, metric, explained) {
    const cells = group.metrics.get(metric);
    const [f0, [m0]] = [...cells][0];
    const rowUnit = scene.frames[f0].measurements[m0].unit;
    const shownAs = reading(metric, rowUnit);
    const meaning = report.metrics?.[metricRank(metric)]?.help;
    const first = !explained.has(metric);
    explained.add(metric);
    return tr(
      rowHead(metric, ` [${shownAs.unit || (isRatio(rowUnit) ? "1" : rowUnit)}]`,
        first && meaning && el("small", {}, meaning)),
      columns.map(({ frame, f }) => num(cells.get(f)?.map((m) =>
        measurement(scene, s, frame, f, m, rowUnit, group)) ?? absent())));
  }

  function measurement(scene, s, frame, f, m, rowUnit, group) {
    const row = frame.measurements[m];
    const path = `scenes/${s}/frames/${f}/measurements/${m}`;
    const { scale, signed, unit } = reading(row.metric, row.unit);
    const g = gatesOf(scene)
      .findIndex((gate) => gate.verdict === "fail" && gate.engine === frame.engine
      && gate.quantity === row.quantity && gate.metric === row.metric && gate.mask === row.mask);
    const value = number(`${path}/value`,
      { scale, signed, unit: row.unit === rowUnit ? "" : unit });
    const usualCount = frame.measurements[firstIn(frame, group)].pixel_count;
    return [
      g < 0 ? value : el("span", { class: "fail-word" }, "✗ ", value),
      row.interval && el("small", {}, "[", number(`${path}/interval/0`, { scale }), ", ",
        number(`${path}/interval/1`, { scale }), "]"),
      row.metric === "rel_bias" && row.mask === "all" && stepBias(s, f, row.quantity),
      g >= 0 && el("small", {}, "limit ",
        number(`scenes/${s}/gates/${g}/maximum`, { scale, exact: true })),
      row.pixel_count !== usualCount && el("small", {}, "over ", number(`${path}/pixel_count`),
        " px"),
    ];
  }

  // ------------------------------------------------------------------ who disagrees, steps, baking

  // The axis of all interval plots: linear within ±0.01 %, logarithmic beyond, ±100 % at its ends.
  const AXIS = { width: 168, height: 16, fine: 1e-4, most: 1,
    ticks: [-1, -0.1, -0.01, -0.001, 0, 0.001, 0.01, 0.1, 1] };
  const across = (value) => {
    const place = Math.asinh(value / AXIS.fine) / Math.asinh(AXIS.most / AXIS.fine);
    return (AXIS.width / 2) * (1 + 0.94 * Math.max(-1, Math.min(1, place)));
  };

  const grid = () => AXIS.ticks.map((tick) => svg("line", { class: tick === 0 ? "zero" : "tick",
        x1: across(tick), x2: across(tick), y1: 0, y2: AXIS.height }));

  /** Head of a column of interval plots: where the ticks stand. */
  function axisHead() {
    const label = (tick, text) => svg("text", { x: across(tick), y: 11, "text-anchor": "middle" },
      text);
    return el("th", { scope: "col", class: "plot" }, hidden("Picture of the interval"),
      svg("svg", { class: "whisker", width: AXIS.width, height: AXIS.height,
          viewBox: `0 0 ${AXIS.width} ${AXIS.height}`, "aria-hidden": "true" },
        label(-0.1, "−10 %"), label(-0.001, "−0.1"), label(0.001, "0.1"), label(0.1, "10 %")));
  }

  /** A value and its interval against zero; the numbers stand beside it in the same row. */
  function whisker(value, interval, state, zone) {
    const cell = el("td", { class: "plot" });
    if (typeof value !== "number") return cell;
    const middle = AXIS.height / 2;
    const [low, high] = Array.isArray(interval) ? interval : [value, value];
    append(cell, [svg("svg", { class: `whisker ${state}`, width: AXIS.width, height: AXIS.height,
            viewBox: `0 0 ${AXIS.width} ${AXIS.height}`, "aria-hidden": "true" },
      zone > 0 && svg("rect", { class: "zone", x: across(-zone), y: 0,
          width: across(zone) - across(-zone), height: AXIS.height }),
      grid(),
      svg("line", { class: "range", x1: across(low), x2: across(high), y1: middle, y2: middle }),
      [low, high].map((end) => svg("line",
          { class: "range", x1: across(end), x2: across(end), y1: middle - 3, y2: middle + 3 })),
      svg("circle", { class: "value", cx: across(value), cy: middle, r: 3.2 }))]);
    return cell;
  }

  const percent = (path, options) => number(path, { scale: 100, signed: true, ...options });

  const pairRow = (pair, path, found) => tr(rowHead(`${pair.first} − ${pair.second}`),
    el("td", { class: "tight" }, word(PAIRS, pair.verdict)),
    num(percent(`${path}/mean_difference`)),
    num("[", percent(`${path}/interval/0`), ", ", percent(`${path}/interval/1`), "]"),
    whisker(pair.mean_difference, pair.interval, pair.verdict === "differ" ? "known"
      : pair.verdict === "agree" ? "agrees" : "open", found.mean_meant),
    num(percent(`${path}/rms_difference`, { signed: false })),
    num(percent(`${path}/noise_floor`, { signed: false })));

  function attribution(scene, s) {
    const title = el("h3", {}, "Who disagrees with whom");
    if (scene.attribution === undefined) return null;
    if (scene.attribution === null) {
      return [title, el("p", { class: "soft" }, "Fewer than three engines rendered this scene, or "
          + "too little of it is lit: nobody can be called the odd one out.")];
    }
    const found = scene.attribution;
    const path = `scenes/${s}/attribution`;
    const silent = /^cannot tell/.test(found.sentence);
    return [
      title,
      el("p", { class: `finding ${found.odd_one_out ? "odd" : silent ? "silent" : "calm"}` },
        el("b", { "aria-hidden": "true" }, found.odd_one_out ? "≠ " : silent ? "○ " : "· "),
        found.sentence),
      scrolling("Who disagrees with whom", table("wide",
        [colHead("Pair"), colHead("Finding"), numHead("Mean difference", "%"),
          numHead("Interval", "%"), axisHead(),
          numHead("Pixel by pixel", "RMS, noise taken out, %"),
          numHead("Noise", "RMS of a pixel, %")],
        (found.pairs ?? []).map((pair, n) => pairRow(pair, `${path}/pairs/${n}`, found)))),
      el("p", { class: "note small soft" }, "Radiance over ", number(`${path}/pixel_count`),
        ` pixels (${maskName(found.mask)}), relative to its mean. `,
        typeof found.mean_meant === "number"
          && ["Engines agree when they are certainly closer than ", percent(`${path}/mean_meant`,
            { signed: false, unit: "%", exact: true }), " in the mean (the band in the plots) and ",
          percent(`${path}/rms_meant`, { signed: false, unit: "%", exact: true }),
          " pixel by pixel; they differ when they are certainly farther apart; else noise leaves "
          + "it open. "],
        typeof found.family_alpha === "number"
          && ["The intervals are wide enough that engines which all agree are told apart in ",
          percent(`${path}/family_alpha`, { signed: false, unit: "%", exact: true }), " of runs."]),
    ];
  }

  /** What the step study says about a frame, beside its number. */
  function stepBias(s, f, quantity) {
    const study = scenes[s].frames[f].study;
    if (quantity !== "radiance" || !study?.levels?.[study.chosen]) return null;
    const path = `scenes/${s}/frames/${f}/study/levels/${study.chosen}`;
    return el("small", {}, "of its step ", percent(`${path}/bias`, { unit: "%" }),
      at(`${path}/bias_noise`) > 0 && [" ± ", percent(`${path}/bias_noise`, { signed: false })]);
  }

  function studies(scene, s) {
    const studied = framesOf(scene).map((frame, f) => ({ frame, f }))
      .filter(({ frame }) => frame.study?.levels?.length > 0);
    if (studied.length === 0) return null;
    return [
      el("h3", {}, "Step error of the witnesses"),
      el("p", { class: "small soft" },
        "Brightness of the picture at finer and finer steps, against the extrapolated limit of no "
        + "step at all. The first setting that is good enough was used for the frame."),
      studied.map(({ frame, f }) => study(frame, s, f)),
    ];
  }

  const levelRow = (study, level, n, path) => el("tr",
    { class: n === study.chosen ? "chosen" : null },
    rowHead(number(`${path}/setting`, { exact: true }),
      n === study.chosen && el("small", {}, "▸ chosen")),
    num(number(`${path}/radiance`, { digits: 5 }), " ± ", number(`${path}/noise`)),
    num(percent(`${path}/bias`), " ± ", percent(`${path}/bias_noise`, { signed: false })),
    whisker(level.bias, [level.bias - 2 * level.bias_noise, level.bias + 2 * level.bias_noise],
      "known", study.tolerance),
    num(number(`${path}/wall_s`)));

  function study(frame, s, f) {
    const { study } = frame;
    const path = `scenes/${s}/frames/${f}/study`;
    const chosen = `${path}/levels/${study.chosen}`;
    return [
      el("p", {}, el("b", {}, frame.engine), ` was rendered with ${study.option} = `,
        number(`${chosen}/setting`, { exact: true }),
        study.shipped ? " by a study that comes with neph, which is off by " : ", which is off by ",
        percent(`${chosen}/bias`, { unit: "%" }), " ± ",
        percent(`${chosen}/bias_noise`, { signed: false, unit: "%" }), " for its step alone: ",
        study.verdict === "within"
          ? [el("span", { class: "pass-word" }, "✓ within "), percent(`${path}/tolerance`,
              { signed: false, unit: "%", exact: true }), ", noise included."]
          : study.verdict === "noise"
            ? [el("span", { class: "open-word" }, "○ not certain"),
              ": noise hides whether it is within ",
              percent(`${path}/tolerance`, { signed: false, unit: "%", exact: true }), "."]
            : [el("span", { class: "fail-word" }, "✗ off"), ": even the finest step is not within ",
              percent(`${path}/tolerance`, { signed: false, unit: "%", exact: true }),
              ", or its error does not shrink as it should."]),
      scrolling(`Step error of ${frame.engine}`, table(null,
        [colHead(study.option), numHead("Mean radiance", "± noise"), numHead("Bias", "% ± noise"),
          axisHead(), numHead("Wall", "s")],
        study.levels.map((level, n) => levelRow(study, level, n, `${path}/levels/${n}`)))),
      el("p", { class: "note small soft" }, "Limit ", number(`${path}/limit`, { digits: 5 }),
        " by order ", number(`${path}/order`, { exact: true }),
        typeof study.observed_order === "number" ? [" (observed ", number(`${path}/observed_order`),
          ")"] : " (noise hides the observed one)",
        Array.isArray(study.size_px) && ["; pictures of ", number(`${path}/size_px/0`), " × ",
          number(`${path}/size_px/1`), " pixels"],
        ". Plots: ± twice the noise; band: good enough."),
    ];
  }

  const spoken = (key) => BAKED[key] ?? String(key).replace(/_/g, " ");

  /** Any value of the data in words: numbers keep their place, the rest is text. */
  function told(path, value) {
    if (typeof value === "number") return number(path);
    if (Array.isArray(value))
      return value.map((item, n) => [n > 0 && " × ", told(`${path}/${n}`, item)]);
    if (typeof value === "object" && value !== null) return Object.entries(value)
      .map(([key, item], n) => [n > 0 && "; ", spoken(key), " ", told(`${path}/${key}`, item)]);
    return value === true ? "yes" : value === false ? "no" : value ?? absent();
  }

  /** Media that were baked to a grid for an engine: what that cost. `places`: {name, path}. */
  function baked(places) {
    const list = places.filter(({ path }) => at(path));
    if (list.length === 0) return null;
    return [
      el("h3", {}, "Baked media"),
      el("p", { class: "small soft" },
        "These engines cannot evaluate the medium themselves and saw it on a grid. What the grid "
        + "differs by from the medium is part of their difference above:"),
      el("ul", { class: "small" },
        list.map(({ name, path }) => el("li", {}, el("b", {}, name), ": ", told(path, at(path))))),
    ];
  }

  // ------------------------------------------------------------------------------- runs and gates

  function runRow(frame, path, logId) {
    const engine = engineNamed(frame.engine);
    return tr(rowHead(frame.engine, el("small", {}, frame.rung)),
      words(word(STATUSES, frame.status), frame.reused && " · taken from the store",
        why(frame) && el("pre", { class: "log", id: logId }, why(frame)),
        frame.note && el("div", { class: "small" }, frame.note),
        frame.step_optical_depth > 1 && el("div", { class: "small" },
          el("b", {}, "Steps too long: "), "one spans an optical depth of up to ",
          number(`${path}/step_optical_depth`), "; what happens within a step is not seen."),
        frame.status === "rendered" && typeof frame.seed === "number"
          && el("div", { class: "small soft" }, `seed ${frame.seed}`),
        frame.settings && el("div", { class: "small soft" }, frame.settings),
        frame.status === "missing" && engine?.install_line
          && el("div", {}, el("code", {}, engine.install_line))),
      versionCell(engine),
      ["render_s", "wall_s", "cpu_s"].map((key) => num(number(`${path}/${key}`))),
      num(number(`${path}/peak_memory_bytes`, { scale: 1 / 2 ** 20 })));
  }

  const versionCell = (engine) => words(engine?.version || absent("not known"),
    engine?.device && el("div", { class: "small soft" }, engine.device));

  function runs(scene, s) {
    if (framesOf(scene).length === 0) return null;
    return [
      el("h3", {}, "What ran, and what it cost"),
      scrolling("What ran, and what it cost", table("wide",
        [["Engine", "State", "Version and device"].map((name) => colHead(name)),
          [["Render", "s"], ["Wall", "s"], ["CPU", "s"], ["Memory", "MiB"]]
            .map(([name, unit]) => numHead(name, unit))],
        framesOf(scene).map((frame, f) => runRow(frame, `scenes/${s}/frames/${f}`, logIds[s][f]))),
      "Render is the radiance pass alone; wall is everything including start-up; CPU sums all "
        + "threads; memory is the peak."),
    ];
  }

  function gates(scene, s) {
    const title = el("h3", {}, "Gates");
    if (gatesOf(scene).length === 0)
      return [title, el("p", { class: "soft" }, "This scene sets no limits.")];
    return [
      title,
      scrolling("Gates", table("wide",
        [["Verdict", "Engine", "Number"].map((name) => colHead(name)), numHead("Value"),
          numHead("Limit"), colHead("Reason")],
        gatesOf(scene).map((gate, g) => el("tr",
          { class: gate.verdict === "fail" ? "failing" : null },
          el("td", { class: "tight" }, word(VERDICTS, gate.verdict)),
          rowHead(gate.engine), el("td", {}, measured(gate)),
          num(gateValue(s, g, "value")), num(gateValue(s, g, "maximum")),
          words(gate.reason || el("span", { class: "soft" }, "none given")))))),
    ];
  }

  // ------------------------------------------------------------------------------- physics suite

  const isOurs = (engine) => ["exact", "tracer"].includes(engineNamed(engine)?.rung);
  /** Before any medium: the functions that say where light is scattered to. */
  function phaseFunctions() {
    const list = physics?.phase_functions ?? [];
    if (list.length === 0) return null;
    return el("section", { "aria-labelledby": "phase-functions" },
      el("h2", { id: "phase-functions" }, "Phase functions"),
      el("p", {}, "A phase function says where light is scattered to. Over all directions it must "
        + "add up to 1, and its mean cosine must be g; so must that of the directions that are "
        + "drawn from it."),
      folded(list.some((row) => row.verdict === "off") ? "Which, and by how much"
        : "All agree: the numbers", scrolling("Phase functions", table(null,
        [colHead("Phase function"), colHead("Finding"), numHead("g", ""),
          numHead("Integral", "must be 1"), numHead("Mean cosine", "must be g"),
          numHead("Drawn mean cosine", "must be g")],
        list.map((row, n) => phaseRow(row, `physics/phase_functions/${n}`))))));
  }

  const phaseRow = (row, path) => el("tr", { class: row.verdict === "off" ? "failing" : null },
    rowHead(String(row.phase).replace(/_/g, " ")),
    el("td", { class: "tight" }, word(FINDINGS, row.verdict === "off" ? "wrong" : row.verdict)),
    num(number(`${path}/g`, { exact: true })),
    ["integral", "mean_cosine", "sampled_mean_cosine"].map((key) =>
      num(number(`${path}/${key}`, { digits: 10 }))));

  const sentenceCase = (text) => text.charAt(0).toUpperCase() + text.slice(1);

  /** agrees, known, gap, wrong (FINDINGS) or open. */
  function findingOf(row) {
    if (row.verdict === "agrees") return "agrees";
    if (row.verdict !== "off") return "open";
    if (isOurs(row.engine)) return "wrong";
    return row.lowered || row.look ? "gap" : row.cause ? "known" : "wrong";
  }

  const findingWord = (row) => (findingOf(row) === "open" ? word(STATUSES,
      row.status === "rendered" ? "not measured" : row.status) : word(FINDINGS, findingOf(row)));
  const deviation = (r) => percent(`physics/rows/${r}/deviation`, { unit: "%" });
  function checkLink(name) {
    const found = checks.find(({ check }) => check.name === name);
    return found ? link(`#${found.id}`, name) : name;
  }

  const participants = () => [...new Map(rows.map((row) => [row.participant, row])).values()];
  const enumerated = (items) => items.map((item, n) =>
    [n > 0 && (n === items.length - 1 ? " and " : ", "), item]);

  function physicsVerdict() {
    const ours = rows.filter((row) => isOurs(row.engine) && row.verdict !== "not_measured");
    const others = rows.filter((row) => !isOurs(row.engine) && row.verdict !== "not_measured");
    const counted = (list, state) => list.filter((row) => findingOf(row) === state).length;
    const names = participants().filter((row) => isOurs(row.engine)).map((row) => row.participant);
    const wrong = counted(ours, "wrong");
    const open = rows.filter((row) => row.verdict === "not_measured").length;
    return [
      el("p", {}, "Light that is known without any renderer is asked of every engine. ",
        names.length > 0 && ["Those that claim to be the truth (",
          enumerated(names.map((name) => el("b", {}, name))), ") ",
          wrong === 0 ? ["agree with it in all ", derived("physics.ours", ours.length),
            " measurements. "]
            : ["are off in ", derived("physics.ours.wrong", wrong), " of ",
              derived("physics.ours", ours.length), " measurements. "]],
        others.length > 0 && ["Of ", derived("physics.others", others.length),
          " measurements of the others ",
          enumerated([["agrees", " agrees", " agree"],
              ["known", " is off for a known cause", " are off for a known cause"],
            ["gap", " shows light that the engine does not model",
              " show light that the engine does not model"], ["wrong",
              " is off and nobody knows why", " are off and nobody knows why"]]
            .map(([state, one, many]) => ({ state, count: counted(others, state), one, many }))
            .filter(({ count }) => count > 0)
            .map(({ state, count, one, many }) => [derived(`physics.others.${state}`, count),
                plural(count, one, many)])), ". "],
        open > 0 && [derived("physics.open", open), " could not be measured, and say why."]),
      el("p", { class: "small soft" }, "With ", number("physics/tests"),
        " measurements at once chance must not cry wolf: off is what lies more than ",
        number("physics/critical_z"),
        " standard errors from the truth (on top of bounded step and rounding errors), so that a "
          + "run in which all are right calls anyone off with a probability of ",
        percent("physics/family_alpha", { signed: false, unit: "%", exact: true }), " (Šidák)."),
    ];
  }

  function physicsHelp() {
    return [
      entry("What is compared",
        "Scenes so simple that their light is known from formulas, integrals or a solution by "
        + "other means. The truth of every pixel is computed without any renderer."),
      entry("Findings",
        "✓ agrees: the interval holds 0. △ off, and the cause is known. ◇ model gap: the engine "
        + "does not claim this physics; it was given single scattering alone, or is a look. ",
        "✗ off: nobody knows why, or the engine claims to be the truth."),
      entry("z", "The difference in standard errors of chance. Engines without chance have a bound "
        + "of their step error instead, from two step sizes. "
        + "A large z can agree all the same, where the rounding of an engine's own numbers is "
        + "larger than its noise."),
      entry("Interval plots",
        "The dot is the difference, the bar what chance, step and rounding allow. The scale is "
        + "logarithmic: ticks at 0.1, 1, 10 and 100\u00a0% on both sides of zero."),
      entry("Small pictures",
        "A mean over a few hundred pixels tests more than a large picture: these are shown large, "
        + "pixel by pixel. Wipe to the truth with the pointer or the slider. Noise averages out in "
        + "the number, not in the picture; difference maps end at a tenth of the mean truth."),
    ];
  }

  function agreements({ participant }) {
    const measured = rows.filter((row) => row.participant === participant
      && row.verdict !== "not_measured");
    const agreeing = measured.filter((row) => row.verdict === "agrees").length;
    return num(measured.length === 0 ? absent()
      : [derived(`physics.of/${participant}/agrees`, agreeing), " of ",
        derived(`physics.of/${participant}`, measured.length)]);
  }

  function physicsMatrix() {
    if (!physics) return null;
    const who = participants();
    return el("section", { "aria-labelledby": "physics" },
      el("h2", { id: "physics" }, "Physics: who agrees with what"),
      scrolling("Physics: who agrees with what", el("table", { class: "wide matrix findings" },
        el("thead", {}, tr(colHead("Check"), who.map((row) => numHead(row.participant,
          row.look ? "a look" : engineNamed(row.engine)?.rung ?? row.engine)))),
        el("tbody", {}, el("tr", { class: "total" }, rowHead("Agrees in"), who.map(agreements))),
        rungs.map((rung) => el("tbody", {},
          el("tr", { class: "group" }, el("th", { scope: "rowgroup", colspan: who.length + 1 },
            link(`#${rung.id}`, sentenceCase(rung.name)), `: ${rung.title}`)),
          checks.filter(({ check }) => check.rung === rung.name).map(({ check, id }) => tr(
            rowHead(el("a", { href: `#${id}`, class: "mono", title: check.what }, check.name)),
            who.map((column) => physicsCell(rows.findIndex((row) => row.check === check.name
              && row.participant === column.participant)))))))),
      "Difference from the truth over the whole check (+ is too bright), and the finding. Point at "
        + "a check for what it is; empty: does not take part."));
  }

  function physicsCell(r) {
    if (r < 0) return num();
    const row = rows[r];
    return el("td", { class: `num ${findingOf(row)}` },
      row.verdict !== "not_measured" && [deviation(r), el("br")], findingWord(row));
  }

  function rungSection(rung) {
    return el("section", { "aria-labelledby": rung.id },
      el("h2", { id: rung.id }, sentenceCase(rung.title)),
      QUESTIONS[rung.name] && el("p", {}, QUESTIONS[rung.name]),
      folded("Each check: numbers and pictures",
        checks.filter(({ check }) => check.rung === rung.name).map(checkSection)));
  }

  function checkSection({ check, c, id }) {
    const own = [...rows.keys()].filter((r) => rows[r].check === check.name);
    return el("section", { class: "check", "aria-labelledby": id },
      el("h3", { id, class: "mono" }, check.name),
      check.what && el("p", {}, sentenceCase(check.what), "."),
      checkTable(check, own),
      baked(own.map((r) => ({ name: rows[r].participant, path: `physics/rows/${r}/bake` }))),
      checkPictures(check, c, own));
  }

  const checkTable = (check, own) => scrolling(`Check ${check.name}`, table("wide",
    [colHead("Participant"), colHead("Finding"), numHead("Difference", "% [interval]"), axisHead(),
      numHead("Error", "%: one σ, or step"), numHead("z", "pixels: mean, var."),
      colHead("In words")], own.map(checkRow)));

  function checkRow(r) {
    const row = rows[r];
    const path = `physics/rows/${r}`;
    const state = findingOf(row);
    const there = typeof row.deviation === "number";
    const stochastic = typeof row.standard_error === "number";
    return el("tr", { class: state === "wrong" ? "failing" : null },
      rowHead(row.participant,
        el("small", {}, row.look ? "a look, not physics" : engineNamed(row.engine)?.rung)),
      el("td", { class: "tight" }, findingWord(row)),
      num(percent(`${path}/deviation`), there && Array.isArray(row.interval) && el("small", {}, "[",
        percent(`${path}/interval/0`), ", ", percent(`${path}/interval/1`), "]")),
      whisker(row.deviation, row.interval, state, 0),
      num(there
        ? [percent(`${path}/${stochastic ? "standard_error" : "step_bound"}`, { signed: false }),
          unitText(stochastic ? "σ" : "step")] : absent(),
      there && typeof row.rounding === "number" && el("small", {}, "rounding ",
        percent(`${path}/rounding`, { signed: false, exact: true }))),
      num(number(`${path}/z`, { signed: true }), typeof row.pixel_z_mean === "number"
        && el("small", {}, number(`${path}/pixel_z_mean`, { signed: true }), ", ",
          number(`${path}/pixel_z_variance`))),
      words(rowWords(row), el("div", { class: "small soft" },
        row.settings && `${row.settings} · `, number(`${path}/wall_s`, { unit: "s" }))));
  }

  function rowWords(row) {
    if (row.verdict === "not_measured") return why(row) || "no reason is given";
    return [
      row.verdict === "agrees" ? "" : row.cause ? `${row.participant} is off because ${row.cause}.`
        : `${row.participant} is off and the cause is not known.`,
      row.lowered && el("div", { class: "small" },
        "It was given single scattering from the sun alone, since it refuses the rest."),
    ];
  }

  function checkPictures(check, c, own) {
    const views = (check.views ?? []).map((view, v) => viewPictures(check, c, v, own));
    if (views.length <= 2) return views;
    return [views[0], folded("The other views of this check", views.slice(1))];
  }

  function viewPictures(check, c, v, own) {
    const view = check.views[v];
    const path = `physics/checks/${c}/views/${v}`;
    const truth = inside(view.picture);
    const title = `${check.name}, view ${v + 1}`;
    const drawn = own.filter((r) => inside(rows[r].pictures?.[v]));
    const cards = el("div", { class: "pictures small-pictures" },
      truth && pictureCard("truth", "no renderer: computed",
        el("div", { class: "stack" }, pixels(truth, `${title}, the truth`, "", view.size_px)),
        el("div", { class: "wipe" }, "what the others are held against"),
        el("figure", {}, el("div", { class: "scale" },
            colourScale(`${path}/difference_scale`, "Radiance: engine − truth [W m⁻² sr⁻¹]")),
          el("figcaption", {}, "scale of the differences"))),
      drawn.map((r) => {
        const row = rows[r];
        const map = inside(row.differences?.[v]);
        return pictureCard(row.participant, [findingWord(row), " ", deviation(r)],
          truth ? wipe(inside(row.pictures[v]), truth, row.participant, "truth", title,
            view.size_px) : [el("div", { class: "stack" },
              pixels(inside(row.pictures[v]), `${title}, by ${row.participant}`, "", view.size_px)),
            el("div", { class: "wipe" })],
          el("figure", {}, map ? pixels(map,
              `${title}: signed difference of ${row.participant} from the truth`, "", view.size_px)
            : hole("no difference map"), el("figcaption", {}, `${row.participant} − truth`)));
      }));
    fit(cards, view.size_px, view.size_px[0] > 3 * view.size_px[1] ? 400
      : 216); // a strip needs its length to be seen
    return [
      el("p", { class: "small soft" }, check.views.length > 1
        && `View ${v + 1} of ${check.views.length}. `, view.what && `${sentenceCase(view.what)}. `,
        "Exposure ", number(`${path}/exposure_ev`, { signed: true, unit: "EV", exact: true }), "."),
      cards,
    ];
  }

  function pictureCard(title, subtitle, ...parts) {
    const card = el("article", { class: "card" },
      el("header", {}, el("h4", {}, title), el("p", {}, subtitle)), parts);
    card.style.gridRow = `span ${card.childElementCount}`;
    return card;
  }

  // ------------------------------------------------------------------------------------ over time

  function overTime() {
    if (sequences.length === 0) return null;
    return el("section", { "aria-labelledby": "over-time" },
      el("h2", { id: "over-time" }, "Over time"), sequences.map(sequenceSection));
  }

  function sequenceSection(sequence, q) {
    const path = `sequences/${q}`;
    return [
      el("h3", {}, sequence.title || sequence.scene),
      el("p", {}, sequence.physics),
      el("p", { class: "small soft" }, number(`${path}/frames`), " frames of ",
        number(`${path}/size_px/0`), " × ", number(`${path}/size_px/1`), " pixels, as seen at ",
        number(`${path}/rate_hz`, { unit: "Hz", exact: true }),
        ", exposure ", number(`${path}/exposure_ev`, { signed: true, unit: "EV", exact: true }),
        `. Reference: ${sequence.reference.text} (${sequence.reference.settings}), `,
        number(`${path}/reference/cpu_s`, { unit: "s" }), " of processor time. ",
        "Nothing in the scene moves: all that moves in these pictures is the renderer's doing."),
      sequence.reference.status !== "rendered" && el("p", {},
        word(STATUSES, sequence.reference.status), ` ${why(sequence.reference)}`),
      sequence.rows.length > 0 && sequencePictures(sequence, q),
      sequence.rows.some((row) => row.measurements.length > 0)
        && folded("All numbers of the flicker", sequenceNumbers(sequence, q)),
      el("ul", {}, sequence.rows.map((row) => row.status === "rendered"
        ? row.findings.map((finding) => el("li", {}, el("b", {}, row.preset),
            `, ${maskName(finding.mask)}: ${finding.text}`))
        : el("li", {}, el("b", {}, row.preset), " ", word(STATUSES, row.status), " ", why(row)))),
    ];
  }

  function sequencePictures(sequence, q) {
    const drawn = sequence.rows.map((row, r) => ({ row, r }))
      .filter(({ row }) => row.pictures.length > 0);
    const cards = el("div", { class: "pictures small-pictures" },
      drawn.map(({ row, r }) => pictureCard(row.preset,
          [`${row.engine} · `, number(`sequences/${q}/rows/${r}/render_s`, { unit: "s" })],
      flipbook(row, sequence), row.map && el("figure", {}, pixels(row.map,
          `${sequence.scene}: amplitude of the flicker of ${row.preset}`, "", sequence.size_px),
        el("figcaption", {},
          "flicker that is seen: black none, green above 10 times the threshold")))));
    return fit(cards, sequence.size_px, 400);
  }

  /** The frames of one cycle: by the slider, or in turn while the box is ticked. */
  function flipbook(row, sequence) {
    const frames = row.pictures.map((path, n) => pixels(path,
        `${sequence.scene} by ${row.preset}, frame ${n + 1} of the cycle`, "", sequence.size_px));
    const stack = el("div", { class: "stack" }, frames);
    const slider = el("input", { type: "range", min: 1, max: frames.length, value: 1,
        "aria-label": `Frame of the cycle, ${row.preset}` });
    const play = el("input", { type: "checkbox", "aria-label": `Play the cycle of ${row.preset}` });
    const show = () => frames.forEach((frame, n) => {
      frame.hidden = n + 1 !== Number(slider.value);
    });
    slider.addEventListener("input", show);
    play.addEventListener("change", () => {
      const turn = () => {
        if (!play.checked) return;
        slider.value = (Number(slider.value) % frames.length) + 1;
        show();
        window.setTimeout(turn, 1000 / sequence.rate_hz);
      };
      turn();
    });
    show();
    return [stack, el("div", { class: "wipe" }, el("label", {}, play, " play"), slider,
        el("span", { "aria-hidden": "true" }, "frame"))];
  }

  function sequenceNumbers(sequence, q) {
    const first = sequence.rows.find((row) => row.measurements.length > 0);
    return scrolling("Flicker", table(null,
      [colHead("Measure"), sequence.rows.map((row) => numHead(row.preset))],
      first.measurements.map((measurement, m) => tr(
        rowHead(measurement.metric, el("small", {}, maskName(measurement.mask))),
        sequence.rows.map((row, r) => num(row.measurements.length === 0
          ? absent() : flickerNumber(`sequences/${q}/rows/${r}/measurements/${m}`)))))),
      "Radiance as displayed, 1 is white. In brackets: 95\u00a0% interval over the picture; then "
        + "the same number against centre rays alone, which an edge crosses in steps. The "
        + "amplitude over four frames is of that cycle alone, as is its map: what flickers at "
        + "another period stands in the deviation.");
  }

  function flickerNumber(path) {
    return [number(`${path}/value`), at(`${path}/interval`) && el("small", {}, "[",
        number(`${path}/interval/0`), ", ", number(`${path}/interval/1`), "]"),
      el("small", {}, "centre rays ", number(`${path}/against_centre_rays`))];
  }

  // --------------------------------------------------------------------------------------- charts

  function charts() {
    const list = report.charts ?? [];
    if (list.length === 0) return null;
    return el("section", { "aria-labelledby": "charts" },
      el("h2", { id: "charts" }, "Speed against accuracy"),
      list.map(chart));
  }

  function chart(entry) {
    const still = inside(entry.svg);
    const image = still && el("img",
      { class: "chart", src: still, alt: `${entry.title}. ${entry.caption ?? ""}` });
    const figure = el("figure", { class: "chart-figure", "data-state": "static" },
      el("h3", { id: anchor("chart", entry.id) }, entry.title),
      el("div", { class: "frame" },
        el("div", { class: "still" },
          image || hole(entry.missing || "no static chart in this report")),
        el("div", { class: "live" })),
      el("figcaption", {},
        el("p", {}, entry.caption),
        !still && entry.missing && el("p", { class: "small soft" },
          `No static chart: ${entry.missing}`),
        el("p", { class: "small soft upgrade" },
          still && ["Also as ", link(still, "SVG"), ". "])));
    image?.addEventListener("error",
      () => image.replaceWith(hole(notHere(still))));
    return figure;
  }

  /** Makes each chart interactive, from the specification that drew the static one. */
  async function upgrade(figures) {
    const work = (report.charts ?? []).map((entry, n) => ({ entry, figure: figures[n] }))
      .filter(({ entry }) => entry.spec);
    if (work.length === 0 || report.interactive === false) return;
    try {
      await loadVega();
    } catch (error) {
      for (const { figure } of work) failed(figure, error);
      return;
    }
    for (const { entry, figure } of work) {
      try {
        await drawLive(figure, entry.spec);
        const moves = JSON.stringify(entry.spec).includes('"bind":"scales"');
        figure.querySelector(".upgrade").append(
          "Point at a mark for its numbers",
          moves ? "; drag to pan, shift and wheel to zoom, double click to return." : ".");
      } catch (error) {
        failed(figure, error);
      }
    }
  }

  function failed(figure, error) {
    figure.setAttribute("data-state", "failed");
    figure.querySelector(".upgrade")
      .append(`The interactive chart is not available: ${error.message}.`);
  }

  // -------------------------------------------------------------------------------------- engines

  function engineTable() {
    return el("section", { "aria-labelledby": "engines" },
      el("h2", { id: "engines" }, "Engines"),
      folded("Versions, devices, known biases", scrolling("Engines", table("wide",
        ["Engine", "Rung of truth", "Version and device", "Known bias"].map((name) =>
          colHead(name)),
        engines.map((engine) => tr(rowHead(engine.name, el("small", {}, engine.summary)),
          words(RUNGS[engine.rung] ?? engine.rung),
          engine.available ? words(versionCell(engine),
            engine.can && el("div", { class: "small" }, engine.can),
            engine.warning && el("div", { class: "small" }, `Warning: ${engine.warning}`))
            : words(word(STATUSES, engine.broken ? "failed" : "missing"),
              el("div", { class: "small" }, engine.missing),
              engine.install_line && !engine.broken && el("div", { class: "small" }, "To install: ",
                el("code", {}, engine.install_line))),
          words(engine.bias || el("span", { class: "soft" }, "none known"))))))));
  }

  function foot() {
    return el("footer", {},
      el("p", {}, "Every number of this page is in ", link("data.json"),
      (report.charts ?? []).some((entry) => entry.spec) && report.interactive !== false
        && [". The charts are drawn by Vega and Vega-Lite (",
        link("vendor/LICENSES.txt", "licences"), ")"], "."));
  }

  // ------------------------------------------------------------------------------------- the page

  /** A table that would be wider than its place becomes a list of its rows. */
  function fitTables() {
    for (const region of document.querySelectorAll(".scroll")) {
      region.classList.remove("stacked");
      region.classList.toggle("stacked", region.scrollWidth > region.clientWidth + 1);
    }
  }

  /** What an address names is shown, also where it is folded away. */
  function reveal() {
    const target = document.getElementById(decodeURIComponent(location.hash.slice(1)));
    for (let element = target; element; element = element.parentElement)
      if (element.tagName === "DETAILS") element.open = true;
    target?.scrollIntoView();
  }

  function printWhole() {
    const closed = [];
    window.addEventListener("beforeprint", () => {
      for (const details of document.querySelectorAll("details:not([open])")) {
        details.open = true;
        closed.push(details);
      }
    });
    window.addEventListener("afterprint", () => {
      for (const details of closed.splice(0)) details.open = false;
    });
  }

  const main = document.getElementById("report");
  const complaint = (title, text) => complain(main, title, text,
    ["The numbers may still be in ", link("data.json"), "."]);
  if (!report)
    return complaint("This report has no data",
      "data.js, which lies beside this page in a complete report, is missing or cannot be read.");
  if (report.format !== "neph-report-1")
    return complaint("This report is of another version",
      `Its data say “${report.format}”; this page reads “neph-report-1”.`);
  try {
    document.title = `${report.title}: ${report.verdict}`;
    fit(document.documentElement, report.size_px ?? [192, 108], 400);
    show(main, head(), contents(), charts(), physicsMatrix(), rungs.map(rungSection),
      scenes.map(sceneSection), overTime(), summary(), phaseFunctions(), engineTable(), help(),
      foot());
    fitTables();
    printWhole();
    document.addEventListener("toggle", fitTables, true);
    window.addEventListener("resize", fitTables);
    window.addEventListener("hashchange", reveal);
    reveal();
    upgrade([...main.querySelectorAll(".chart-figure")]).finally(() => {
      document.documentElement.dataset.ready = "yes";
    });
  } catch (error) {
    complaint("This report cannot be laid out",
      `The data do not have the expected form: ${error.message}.`);
    throw error;
  }
})();
