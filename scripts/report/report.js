// SPDX-License-Identifier: MIT
//
// Lays out a report from window.NEPH_REPORT (data.js; README.md of this folder specifies it).
// Strings of the data reach the page only as text nodes and attribute values, never as markup.
// Every number on the page has its path in the data (data-path) and its exact value (data-value;
// data-scale is the factor of a changed unit). A number that this script counts has the name of
// the count instead (data-derived). check_report.mjs compares these numbers with data.json.
(function () {
  "use strict";

  const report = window.NEPH_REPORT;
  const { append, el, small, bold, svg, line, label, hidden, folded, section, colHead, rowHead,
    numHead, num, words, row: tr, table, scrolling, fact, entry, listed, link, complain, hole, fit,
    show, colourBar, loadVega, drawLive, MASKS } = window.NephPage;

  // ---------------------------------------------------------------------------------- vocabulary

  const RUNGS = {
    exact: "exact: closed form or converged quadrature",
    tracer: "tracer: the unbiased path tracer of this project",
    witness: "witness: external renderer, from another project",
    model: "model: real-time method under test",
  };
  const QUANTITIES = { radiance: "Radiance", transmittance: "Transmittance", depth: "Depth",
    volume: "Light of the medium only" };
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
  // The state of the whole run: its word, and the class of its colour.
  const RUNS = {
    pass: ["Pass", "pass"],
    fail: ["Fail", "fail"],
    running: ["Running", "open"],
    interrupted: ["Interrupted", "open"],
  };
  // The result of a participant of the physics suite in a check.
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
  // The test of each group of checks of the physics suite, in plain words.
  const QUESTIONS = {
    furnace: "A medium without absorption, in uniform light from all directions, is invisible: "
      + "as much light is scattered into each ray as out of it. Every pixel must have the "
      + "radiance of the environment. If an engine creates or loses energy, the medium is visible.",
    single: "Light that is scattered exactly once has formulas and integrals that can be "
      + "computed to many digits. These checks test extinction, phase functions, the path of "
      + "sunlight through the medium, and the integral along the view ray.",
    slab: "Light that is scattered any number of times. For an infinite slab, the adding-doubling "
      + "method computes it: it adds thin layers and doubles thick ones. This method follows no "
      + "light paths, so it shares no errors with path tracing.",
    fog: "Light that is scattered any number of times in fog whose density decreases with height. "
      + "This fog must reflect the same light as a slab of the same optical depth.",
    "half-space": "A slab so thick that no light leaves it below. S. Chandrasekhar (1950) solved "
      + "its light analytically.",
    conservation: "All light that enters a medium without absorption must leave it: reflected, "
      + "transmitted and unscattered light must add up to the incoming light.",
    "step-cloud": "A cloud of thin columns beside thick columns, a case of the Intercomparison of "
      + "3D Radiation Codes (I3RC). Light passes through the sides of the columns; an engine that "
      + "assumes horizontal layers computes this wrongly. The reference is a separate Monte Carlo "
      + "program for columns. The stated error includes its noise.",
    reciprocity: "Light paths are reversible. When camera and sun change places, the reflection "
      + "must stay the same.",
  };
  // The one error of a scene and engine in the summary: the first of these that was measured.
  const HEADLINES = [
    ["radiance", "rel_mse", "all"],
    ["radiance", "rmse", "all"],
    ["transmittance", "rmse", "all"],
    ["transmittance", "max_abs", "all"],
    ["depth", "rmse", "all"],
  ];
  // The number that ranks a frame: the first of these that was measured, over the whole frame.
  const RANKING = [
    ["radiance", "rel_rmse", "all"],
    ["transmittance", "rmse", "all"],
    ["depth", "rel_rmse", "all"],
  ];
  // The columns of a scene's card: head, note below it, and metrics; the first measured is shown.
  const CARD = [
    ["Radiance RMSE", "of the mean", [["radiance", "rel_rmse"], ["radiance", "rmse"]]],
    ["Radiance bias", "of the mean", [["radiance", "rel_bias"]]],
    ["FLIP", "mean, 0 to 1", [["radiance", "flip_mean"]]],
    ["Transmittance", "largest error, 0 to 1", [["transmittance", "max_abs"]]],
  ];
  // Lower bounds of the error classes of the heat map, without the first class.
  const HEAT = [0.001, 0.003, 0.01, 0.03, 0.1, 0.3];
  const MANY_ENGINES = 6; // a heat map of more engines has the full width
  const WORST_SHOWN = 3; // frames on the first screen
  const CAUSES_SHOWN = 3; // frames beside a scene's description
  const WORTH_A_LOOK = 0.01; // the list of troubles names ungated frames from this relative RMSE on
  const WORTH_MOST = 5; // ungated frames in that list; the cards of the scenes have the others
  // From -scale to +scale. The difference maps of neph interpolate them linearly in sRGB codes.
  const DIFFERENCE_COLOURS = ["#053061", "#4393c3", "#f7f7f7", "#d6604d", "#67001f"];
  const BEYOND_COLOURS = { below: "#00e5ff", above: "#ffd500", not_a_number: "#ff00ff" };
  // Units of ratios, which have no unit in the data.
  const RATIO_UNITS = { seen_contrast: "× threshold", std_p95: "of white" };
  const BROKEN = ["failed", "timeout", "interrupted"];
  const SCENES_NAMED = 8; // in the table of contents; a longer list is folded
  const LISTED = 12; // entries of the list of troubles; the others are folded

  // ------------------------------------------------------------------------------------- elements

  const absent = (text) => el("span", { class: "absent" },
    el("span", { "aria-hidden": "true" }, "—"), hidden(text ?? "not measured"));
  const plural = (count, one, many) => (count === 1 ? one : many);

  function word(table, key) {
    const [text, className] = table[key] ?? [key, "open-word"];
    return el("span", { class: className || null }, text);
  }

  /** The reason of a frame's status, without the status word "cannot". */
  const why = (frame) => String(frame.reason ?? "").replace(/^cannot:\s*/, "").trim();

  /** The first line of the reason. A longer reason (a child's log) gets a link to the full text. */
  function briefly(frame) {
    const [first, ...rest] = why(frame).split("\n");
    return [first, rest.length > 0 && ids.has(frame) && [" … ", link(`#${ids.get(frame)}`, "log")]];
  }

  /** A path that stays inside the report, or null. */
  const inside = (path) => (typeof path === "string" && /^(images|charts)\/[\w.@\-/]+$/.test(path)
    && !path.includes("..") ? path : null);

  /** The path of the scene's neph view page inside the report, or null. */
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

  const paths = new WeakMap(); // object or list of the data -> its path, with a final slash
  function findPlaces(node, path) {
    paths.set(node, path);
    for (const [key, child] of Object.entries(node))
      if (typeof child === "object" && child !== null) findPlaces(child, `${path}${key}/`);
  }
  if (report) findPlaces(report, "");

  const grouped = (digits) => digits.replace(/\B(?=(\d{3})+(?!\d))/g, "\u202f");

  /** The text of a number with `digits` significant digits; integers below 1e6 in full. */
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
      // Exact numbers, such as limits, are not measurements: they have no trailing zeros.
      if (exact && text.includes(".")) text = text.replace(/\.?0+(?=e|$)/, "");
    }
    return text.replace("e-", "e−");
  }

  // Powers in units become superscripts: W m^-2 sr^-1.
  const SUPERSCRIPTS = { "-": "⁻", 1: "¹", 2: "²", 3: "³", 4: "⁴" };
  const raised = (unit) => unit.replace(/\^(-?[1-4])(?!\d)/g, (_, power) => [...power]
    .map((digit) => SUPERSCRIPTS[digit]).join(""));
  const unitText = (unit) => el("span", { class: "unit" }, "\u00a0" + raised(unit));

  /** The number `key` of an object or list of the data. */
  function number(node, key, options) {
    const { scale = 1, unit = "", signed = false, exact = false, digits = 3 } = options ?? {};
    const path = `${paths.get(node)}${key}`;
    const value = node[key];
    if (typeof value !== "number" || !Number.isFinite(value)) {
      const dash = absent();
      dash.setAttribute("data-path", path);
      dash.setAttribute("data-value", "null");
      return dash;
    }
    const shown = value * scale;
    const sign = shown < 0 ? "−" : signed && shown > 0 ? "+" : "";
    const element = el("data", { value, "data-path": path, "data-value": value,
        title: `${value}${scale === 1 ? "" : ` × ${scale}`}`,
        "data-scale": scale === 1 ? null : scale },
      sign + written(Math.abs(shown), exact, digits));
    return unit ? [element, unitText(unit)] : element;
  }

  const percent = (node, key, options) => number(node, key,
    { scale: 100, signed: true, ...options });
  const share = (node, key) => percent(node, key, { signed: false, unit: "%" });
  const limitShare = (node, key) => percent(node, key, { signed: false, unit: "%", exact: true });
  const exposure = (node) => number(node, "exposure_ev", { signed: true, unit: "EV", exact: true });

  /** The pair of numbers `interval` of an object, in brackets. */
  const interval = ({ interval: ends }, options) => ends
    && ["[", number(ends, 0, options), ", ", number(ends, 1, options), "]"];

  /** A number counted by this script; check_report.mjs counts it again. */
  const derived = (what, count) => el("span", { "data-derived": what, "data-value": count },
    String(count));

  /** The data have ratios as plain numbers; the page shows them in percent. */
  const isRatio = (unit) => unit === "" || unit === "1" || unit === null || unit === undefined;
  function reading(metric, unit) {
    const signed = /bias$/.test(metric);
    return ["rel_bias", "rel_rmse"].includes(metric) && isRatio(unit)
      ? { scale: 100, signed, unit: "%" } : { signed, unit: isRatio(unit) ? "" : unit };
  }

  // ------------------------------------------------------------------------------------- look-ups

  const scenes = report?.scenes ?? [];
  const engines = report?.engines ?? [];
  const sequences = report?.sequences ?? [];
  const framesOf = (scene) => scene.frames ?? [];
  const gatesOf = (scene) => scene.gates ?? [];
  const measurementsOf = (frame) => frame.measurements ?? [];
  const physics = report?.physics ?? null;
  const rows = physics?.rows ?? [];
  const ids = new Map(); // scene, frame (its log), check or rung -> its anchor
  for (const scene of scenes) ids.set(scene, anchor("scene", scene.name));
  for (const scene of scenes)
    for (const frame of framesOf(scene))
      ids.set(frame, anchor("log", `${scene.name}-${frame.engine}`));
  const checks = physics?.checks ?? [];
  for (const check of checks) ids.set(check, anchor("check", check.name));
  const checksOf = (rung) => checks.filter((check) => check.rung === rung.name);
  const rungs = (physics?.rungs ?? []).filter((rung) => checksOf(rung).length > 0);
  for (const rung of rungs) ids.set(rung, anchor("rung", rung.name));
  const metricNames = (report?.metrics ?? [])
    .map((metric) => metric.name); // in the order of their tables
  const isTruth = (scene, engine) => scene.truth?.engine === engine;
  const engineNamed = (name) => engines.find((engine) => engine.name === name);
  const frameBy = (scene, name) => framesOf(scene).find((frame) => frame.engine === name);

  const measurementOf = (frame, quantity, metric, mask = "all") => measurementsOf(frame)
    .find((row) => row.quantity === quantity && row.metric === metric && row.mask === mask
      && row.value !== null);
  const biasOf = (frame) => measurementOf(frame, "radiance", "rel_bias");
  const readNumber = (row) => number(row, "value", reading(row.metric, row.unit));
  const rankingNumber = (frame) => RANKING.map((name) => measurementOf(frame, ...name))
    .find((found) => found) ?? null;
  const sizeOf = (frame) => rankingNumber(frame)?.value ?? -1;

  const unitOf = (scene, quantity, metric) => framesOf(scene).flatMap(measurementsOf)
    .find((m) => m.quantity === quantity && m.metric === metric && m.unit)?.unit ?? "";

  const maskName = (mask) => MASKS[mask] ?? mask;
  const measured = (gate) => `${gate.quantity} ${gate.metric}, ${maskName(gate.mask)}`;

  function gateValue(scene, gate, key) {
    const { scale, signed, unit } = reading(gate.metric,
      unitOf(scene, gate.quantity, gate.metric));
    return number(gate, key,
      { scale, unit, signed: signed && key === "value", exact: key === "maximum" });
  }

  // ----------------------------------------------------------------------------------------- head

  const head = () => el("header", { class: "brief" }, el("h1", null, report.title), verdict());

  /** Date, duration, version and host of the run: below the first screen. */
  function facts() {
    const size = report.size_px ?? [];
    return el("dl", { class: "facts" },
      fact("Written", report.created_utc),
      fact("Took", number(report, "seconds", { unit: "s" })),
      fact("Version", ["neph ", report.neph_version]),
      fact("Host", [report.host.cpu, " · ", number(report.host, "cores"), " cores · ",
        number(report.host, "memory_bytes", { scale: 1 / 2 ** 30, unit: "GiB" })]),
      report.counts && fact("Results", [derived("counts.reported", report.counts.reported), " of ",
        derived("counts.expected", report.counts.expected), " are in this report, ",
        derived("counts.compared", report.counts.compared), " compared with a reference; no ",
        "gate limits the radiance of ", derived("frames.ungated", ungated().length)]),
      scenes.length > 0 && fact("Frame size",
        size.length ? [number(size, 0), " × ", number(size, 1), " pixels"] : absent()),
      report.screen === "screen/index.html" && fact("Also",
        link("screen/index.html", "pixels that no screen-space method can compute")));
  }

  const item = (...children) => el("li", {}, children);

  /** An entry of the list of troubles: status word, scene or check, engine or participant. */
  const finding = (sign, where, engine, ...rest) => item(sign, " ", where, " · ", bold(engine),
    rest);

  /** Failed gates, sorted by value / limit, the largest first. */
  function failedGates(all) {
    const over = ({ gate }) => (typeof gate.value === "number"
      ? Math.abs(gate.value) / gate.maximum : Infinity);
    return all.filter(({ gate }) => gate.verdict === "fail").sort((a, b) => over(b) - over(a));
  }

  const failedLines = (failing) => failing.map(({ gate, scene }) => finding(word(VERDICTS, "fail"),
    sceneLink(scene), gate.engine, " · ", measured(gate), ": ", gateValue(scene, gate, "value"),
    ", limit ", gateValue(scene, gate, "maximum"), gate.reason ? ` (${gate.reason})` : "",
    "; to repeat: ", el("code", {}, `neph validate ${scene.name}`)));

  const brokenFrames = () => scenes.flatMap((scene) => framesOf(scene)
    .filter((frame) => BROKEN.includes(frame.status)).map((frame) => ({ scene, frame })));

  /** Frames that were not compared because they exceeded the time budget of their engine. */
  const unfitted = () => scenes.flatMap((scene) => framesOf(scene)
    .filter((frame) => frame.status === "over_budget").map((frame) => ({ scene, frame })));

  const broken = (frame, where, name) => finding(word(STATUSES, frame.status), where, name,
    why(frame) && [": ", briefly(frame)]);

  function physicsLines() {
    const phases = (physics?.phase_functions ?? []).filter((row) => row.verdict === "off")
      .map((row) => item(word(FINDINGS, "wrong"), " ", link("#phase-functions",
        "Phase function"), " ", spoken(row.phase)));
    const size = (row) => Math.abs(row.deviation ?? 0);
    const wrong = rows.filter((row) => findingOf(row) === "wrong").sort((a, b) => size(b) - size(a))
      .map((row) => finding(word(FINDINGS, "wrong"), checkLink(row.check), row.participant, " by ",
        deviation(row)));
    return [...phases, ...wrong, ...rows.filter((row) => BROKEN.includes(row.status))
      .map((row) => broken(row, checkLink(row.check), row.participant))];
  }

  /** Compared frames, the largest error first. */
  const compared = () => scenes.flatMap((scene) => framesOf(scene)
    .filter((frame) => !isTruth(scene, frame.engine))
    .map((frame) => ({ scene, frame, found: rankingNumber(frame) })))
    .filter(({ found }) => found).sort((a, b) => b.found.value - a.found.value);

  /** Compared frames whose radiance was measured, but has no gate. */
  const ungated = () => compared().filter(({ scene, frame, found }) =>
    found.quantity === "radiance" && !gatesOf(scene).some((gate) =>
      gate.engine === frame.engine && gate.quantity === "radiance"));

  /** A ranking number in words: "RMSE 7.0 % of the mean radiance". */
  const rankedWords = (found) => (found.metric === "rel_rmse"
    ? ["RMSE ", readNumber(found), ` of the mean ${found.quantity}`]
    : [`${found.quantity} RMSE `, readNumber(found)]);

  const ungatedLines = (list) => list
    .filter(({ found }) => found.value >= WORTH_A_LOOK).slice(0, WORTH_MOST)
    .map(({ scene, frame, found }) => finding(el("span", { class: "open-word" }, "◇ not gated"),
      sceneLink(scene), frame.engine, " · ", rankedWords(found)));

  const openLines = (open) => open.map(({ gate, scene }) => finding(word(VERDICTS, "not_measured"),
    sceneLink(scene), gate.engine, " · ", measured(gate), gate.reason ? `: ${gate.reason}` : ""));

  const absentLines = () => (report.absent ?? []).map((entry) => item(
    el("span", { class: "open-word" }, "○ left out"), " ", bold(entry.scene),
    entry.reason ? `: ${entry.reason}` : "",
    entry.hint && el("span", { class: "soft" }, ` (${entry.hint})`)));

  function gateSentence(all, failing, open) {
    const total = derived("gates", all.length);
    const [first] = failing;
    return [all.length === 0 ? [total, " gates: no number had a limit."]
      : failing.length > 0
        ? [derived("gates.fail", failing.length), " of ", total, plural(all.length, " gate",
          " gates"), plural(failing.length, " is", " are"), " over the limit, the worst: ",
          bold(first.gate.engine), " in ", sceneLink(first.scene), " (", measured(first.gate), " ",
          gateValue(first.scene, first.gate, "value"), ", limit ",
          gateValue(first.scene, first.gate, "maximum"), ")."]
        : open.length === 0
          ? [plural(all.length, "The one gate is", "All gates are"), " within the limit (",
            total, ")."]
          : ["No gate is over its limit (", total, " in all)."],
    open.length > 0 && [" ", derived("gates.not_measured", open.length),
      " could not be measured."]];
  }

  /** The largest error of the run, independent of gates and bias. */
  function worstSentence([first]) {
    if (!first) return null;
    const { scene, frame, found } = first;
    const bias = measurementOf(frame, found.quantity, "rel_bias");
    const isGated = gatesOf(scene).some((gate) => gate.engine === frame.engine
      && gate.quantity === found.quantity);
    return [" The largest error: ", el("b", { class: "worst" }, frame.engine), " in ",
      sceneLink(scene), ", ", rankedWords(found), bias && [", bias ", readNumber(bias)],
      frame.look ? ", a non-physical model" : !isGated && ", which no gate limits", "."];
  }

  /** Engines and frames that are not part of the verdict. */
  function withoutSentence(late) {
    const missing = engines.filter((engine) => !engine.available && !engine.broken);
    return [missing.length > 0 && [" Not installed, so not compared: ",
      bold(missing.map((engine) => engine.name).join(", ")), "."],
    late.length > 0 && [" ", derived("frames.over_budget", late.length),
      plural(late.length, " rendering", " renderings"),
      " exceeded the time budget: not compared."]];
  }

  function verdict() {
    const all = scenes.flatMap((scene) => gatesOf(scene).map((gate) => ({ gate, scene })));
    const failing = failedGates(all);
    const open = all.filter(({ gate }) => gate.verdict === "not_measured");
    const unfinishedFrames = brokenFrames();
    const late = unfitted();
    const missing = report.absent ?? [];
    const [said, colour] = RUNS[report.verdict] ?? [report.verdict, "open"];
    return el("section", { class: `verdict ${colour}`, "aria-label": "Verdict" },
      el("p", { class: "word" }, said),
      el("div", { class: "said" }, unfinished(), physics && physicsVerdict(),
        (scenes.length > 0 || !physics) && el("p", {}, gateSentence(all, failing, open),
        unfinishedFrames.length > 0 && [" ", derived("frames.broken", unfinishedFrames.length),
          plural(unfinishedFrames.length, " rendering", " renderings"), " did not finish."],
        worstSentence(compared()), withoutSentence(late),
        missing.length > 0 && [" ", derived("absent", missing.length), plural(missing.length,
            " scene was", " scenes were"), " left out: data files are missing on this machine."])));
  }

  /** List of failed, ungated, unmeasured and missing results. */
  function troubles() {
    const all = scenes.flatMap((scene) => gatesOf(scene).map((gate) => ({ gate, scene })));
    const open = all.filter(({ gate }) => gate.verdict === "not_measured");
    const lines = [...failedLines(failedGates(all)), ...[...brokenFrames(), ...unfitted()].map(
      ({ scene, frame }) => broken(frame, sceneLink(scene), frame.engine)), ...physicsLines(),
    ...ungatedLines(ungated()), ...openLines(open), ...absentLines()];
    return lines.length > 0 && section("troubles",
      "Failed, ungated and missing results",
      listed(lines, LISTED, "The other entries", "small troubles"));
  }

  /** A sentence about the progress of a run that is running or was interrupted. */
  function unfinished() {
    const { progress } = report;
    if (!progress) return null;
    const isRunning = report.verdict === "running";
    return el("p", {}, isRunning
      ? "The run updates this page: reload it to see more. "
      : "The run was interrupted; the same command continues it. ",
      number(progress, "done"), " of ", number(progress, "total"), " steps are finished",
      typeof progress.left_s === "number" && isRunning ? [", about ",
        number(progress, "left_s", { unit: "s", digits: 2 }), " are left."] : ".");
  }

  const titleOf = (scene) => scene.title || scene.name;
  const sceneLink = (scene) => link(`#${ids.get(scene)}`, titleOf(scene));

  function contents() {
    const place = (id, text) => item(link(`#${id}`, text));
    const all = scenes.map((scene) => item(sceneLink(scene)));
    const isLong = all.length > SCENES_NAMED;
    return el("nav", { "aria-label": "Contents" }, el("ul", {},
      scenes.length > 0 && place("heat", "Errors at a glance"),
      (report.charts ?? []).length > 0 && place("charts", "Speed against accuracy"),
      physics && place("physics", "Physics: agreement"),
      rungs.map((rung) => place(ids.get(rung), sentenceCase(rung.name))),
      !isLong && all,
      sequences.length > 0 && place("over-time", "Over time"),
      (scenes.length > 0 || !physics) && place("summary", "All in one table"),
      physics?.phase_functions?.length > 0 && place("phase-functions", "Phase functions"),
      place("engines", "Engines"), place("help", "How to read this")),
    isLong && folded("All scenes", el("ul", {}, all)));
  }

  // -------------------------------------------------------------------------------- first screen

  /** The class of an error in the heat map: 0 for the smallest errors. */
  const heatOf = (value) => HEAT.filter((least) => value >= least).length;

  /** The error of each engine in each scene; worst scene at the top, worst engine on the left. */
  function heatMap() {
    const largest = (list) => Math.max(-1, ...list.map(sizeOf));
    const columns = engines.map((engine) => ({ engine, size: largest(scenes
      .map((scene) => frameBy(scene, engine.name)).filter((frame) => frame)) }))
      .sort((a, b) => b.size - a.size);
    const list = scenes.map((scene) => ({ scene, size: largest(framesOf(scene)) }))
      .sort((a, b) => b.size - a.size);
    return [
      scrolling("RMSE of each scene and engine", table("wide heat",
        [colHead("Scene, worst first"), columns.map(({ engine }) => engineHead(engine.name))],
        list.map(({ scene }) => el("tr", { "data-scene": scene.name },
          rowHead(sceneLink(scene)),
          columns.map(({ engine }) => heatCell(scene, engine.name)))))),
      heatLegend()];
  }

  /** A column head in which a long name can break after an underscore. */
  const engineHead = (name) => el("th", { scope: "col", class: "num", "data-label": name },
    name.split(/(?<=_)/).map((part, n) => [n > 0 && el("wbr"), part]));

  function heatCell(scene, name) {
    const frame = frameBy(scene, name);
    const found = frame && rankingNumber(frame);
    const cell = (className, ...content) => el("td", { class: `num ${className}`,
      "data-engine": name }, content);
    if (!frame) return cell("plain", el("span", { class: "soft" }, "not run"));
    if (frame.status !== "rendered") return cell("plain", word(STATUSES, frame.status));
    if (isTruth(scene, name)) return cell("plain", el("span", { class: "soft" }, "reference"));
    if (!found) return cell("plain", notMeasured());
    const verdicts = gatesOf(scene).filter((gate) => gate.engine === name)
      .map((gate) => gate.verdict);
    return cell(`heat-${heatOf(found.value)}`, readNumber(found), small(
      found.quantity !== "radiance" && `${found.quantity} `,
      verdicts.includes("fail") ? "✗ fails" : verdicts.includes("pass") ? "✓ passes"
        : frame.look ? "non-physical" : "no gate"));
  }

  const heatLegend = () => el("p", { class: "heat-key small soft" },
    "RMSE over the frame, relative to the mean of the reference: ",
    ["", ...HEAT].map((least, n) => el("span", { class: `swatch heat-${n}` },
      n === 0 ? `under ${100 * HEAT[0]} %` : n === HEAT.length ? `${100 * least} % or more`
        : `${Number((100 * least).toPrecision(2))} % or more`)));

  /** Rows of the ranking with their scene, frame and error. */
  const ranked = () => (report.ranking ?? []).map((row) => {
    const scene = scenes.find(({ name }) => name === row.scene);
    const frame = scene && frameBy(scene, row.engine);
    return { row, scene, frame, found: frame && rankingNumber(frame) };
  }).filter(({ found }) => found);

  /** The first entries of the ranking, each with the place and the cause of its error. */
  function worst() {
    const list = ranked().slice(0, WORST_SHOWN);
    return list.length > 0 && el("section", { class: "worst-part", "aria-labelledby": "worst" },
      el("h2", { id: "worst" }, `Largest ${list.length === 1 ? "error" : "errors"} and causes`),
      el("ol", { class: "worst" }, list.map(({ row, scene, frame, found }) => {
        const bias = measurementOf(frame, found.quantity, "rel_bias");
        const transmittance = measurementOf(frame, "transmittance", "max_abs");
        return item(bold(frame.engine), " in ", sceneLink(scene), ": ", rankedWords(found),
          bias && [", bias ", readNumber(bias)],
          transmittance && [", largest error of transmittance ", number(transmittance, "value")],
          row.failing && [" ", word(VERDICTS, "fail")], ". ",
          el("span", { class: "cause" }, row.cause));
      })));
  }

  /** The first screen below the verdict: heat map, worst frames and the first chart. */
  function front() {
    const [first] = report.charts ?? [];
    if (scenes.length === 0) return first && el("div", { class: "front" }, chartSection([first]));
    return el("div", { class: engines.length > MANY_ENGINES ? "front many" : "front" },
      el("section", { class: "heat-part", "aria-labelledby": "heat" },
        el("h2", { id: "heat" }, "Errors at a glance"), heatMap()),
      worst(),
      first && chartSection([first]));
  }

  // -------------------------------------------------------------------------------------- summary

  /** The first headline that at least half as many frames have as the most frequent headline. */
  function commonHeadline() {
    const counts = HEADLINES.map((headline) => scenes.flatMap(framesOf)
      .filter((frame) => measurementOf(frame, ...headline)).length);
    return HEADLINES[counts.findIndex((count) => count > 0 && count * 2 >= Math.max(...counts))]
      ?? HEADLINES[0];
  }

  function summary() {
    if (scenes.length === 0 && physics) return null;
    const common = commonHeadline();
    const order = [common, ...HEADLINES.filter((headline) => headline !== common)];
    const unit = scenes.map((scene) => unitOf(scene, common[0], common[1]))
      .find((unit) => !isRatio(unit)) ?? "";
    const attributed = scenes.some((scene) => scene.attribution);
    return section("summary", "All scenes and engines in one table",
      folded("The table", scrolling("Summary", table("wide matrix",
        [colHead("Scene"), engines.map((engine) => numHead(engine.name,
          engine.available ? engine.rung : "not installed")),
        attributed && colHead("Odd one out")],
        scenes.map((scene) => tr(
          rowHead(sceneLink(scene), el("small", { class: "mono" }, scene.name)),
          engines.map((engine) => num(summaryCell(scene, engine, order, unit))),
          attributed && el("td", {}, standsAlone(scene))))),
      [`The number is the ${common[1]} of the ${common[0]} over the ${maskName(common[2])}`,
        unit && `, in ${unit},`, " against the reference of the scene. A cell with another ",
        "metric names it. Below the number: relative bias (+ is too bright), result of the gates. ",
        attributed && "“Odd one out” is the engine that differs from all others; no reference is "
          + "used. ",
        "A dash is a number that was not measured."])));
  }

  function standsAlone(scene) {
    if (!scene.attribution) return absent("not computed");
    if (scene.attribution.odd_one_out)
      return el("span", { class: "open-word" }, `≠ ${scene.attribution.odd_one_out}`);
    return el("span", { class: "soft small" }, scene.attribution.sentence);
  }

  function summaryCell(scene, { name }, order, commonUnit) {
    const verdicts = gatesOf(scene).filter((gate) => gate.engine === name)
      .map((gate) => gate.verdict);
    const worst = ["fail", "not_measured", "pass"].find((verdict) => verdicts.includes(verdict));
    const gated = worst && small(word(VERDICTS, worst));
    const gate = gated ?? small("no gate");
    const frame = frameBy(scene, name);
    if (!frame) return [el("span", { class: "soft" }, "not in this run"), gated];
    if (frame.status !== "rendered")
      return [word(STATUSES, frame.status), el("small", { class: "reason" }, briefly(frame)),
        gated];
    if (isTruth(scene, name))
      return [el("span", {}, "reference"), small(frame.rung), gated];
    const headline = order.find((candidate) => measurementOf(frame, ...candidate));
    if (!headline) return [absent(), gate];
    const shown = measurementOf(frame, ...headline);
    const bias = measurementOf(frame, headline[0], "rel_bias", headline[2]);
    return [number(shown, "value", { ...reading(headline[1], shown.unit), unit: "" }),
      headline !== order[0] && small(`${headline[0]} ${headline[1]}`),
      !isRatio(shown.unit) && shown.unit !== commonUnit
        && el("small", { class: "unit" }, shown.unit),
      bias && small("bias ", readNumber(bias)), stepBias(frame, headline[0]),
      frame.bake && small("with a baked grid"), gate];
  }

  const help = () => el("section", { class: "help", "aria-labelledby": "help" },
    el("h2", { id: "help" }, "How to read this"),
    folded("Comparisons, gates, images, numbers", el("dl", {},
      physics && physicsHelp(),
      (scenes.length > 0 || !physics) && sceneHelp(),
      entry("Difference maps", "Engine minus reference on a fixed scale, shown below each "
        + "map: blue is below the reference, red is above it, white is equal. Cyan is below the "
        + "lower end of the scale, yellow is above its upper end, magenta is not a number."),
      entry("RMSE and bias", "RMSE is the root of the mean squared error over the pixels: all "
        + "errors count. Bias is the difference of the means: errors of opposite sign cancel, so "
        + "an engine with a bias near 0 can have large errors. The page ranks by RMSE."),
      entry("Times", "Warm frame: the wall time of one frame of an engine that is already running, "
        + "with its interval and the number of repeats, as “neph benchmark” measures it. Start-up "
        + "has its own column. “Not measured”: there was no time for repeats."),
      entry("Numbers", "1.2e−4 means 0.00012. In [brackets]: the 95\u00a0% interval, unless "
        + "another one is named. A dash: not measured. “Cannot”: the engine does not support a "
        + "feature of the scene. Move the pointer over a number to see all its digits."),
    )));

  const sceneHelp = () => [
    entry("Comparisons", "Each scene isolates one part of the physics of light in fog or cloud. "
      + "Several engines render it from the same file, with the same camera and light. Each "
      + "engine is compared with the reference of the scene."),
    entry("Reference and level", "The reference is the highest level of the reference hierarchy "
      + "that can render the scene: exact (closed form), then tracer (the unbiased path tracer of "
      + "this project). External renderers (level witness) and real-time methods (level model) "
      + "are never the reference."),
    entry("Gates", "A gate is a limit, set before the run, for one metric of one engine. ✓: "
      + "within the limit. ✗: over the limit. ○: not measured, with the reason."),
    entry("Images", "All images of a scene have the same fixed exposure, so their brightness can "
      + "be compared. Move over an image, or use the slider below it, to wipe to the reference; a "
      + "click swaps the two. Numbers are computed from linear data, never from these images."),
    entry("Odd one out", "Every pair of engines is also compared, without any reference. Two "
      + "independent frames of each engine make it possible to subtract the noise. The odd one "
      + "out differs from all other engines, while the others agree with each other."),
    entry("Step bias", "External renderers march through heterogeneous media in steps. Smaller "
      + "steps reduce this error, more samples do not. A step study halves the step repeatedly, "
      + "extrapolates to step 0, and shows the remaining bias."),
  ];

  // --------------------------------------------------------------------------------------- scenes

  /** A scene's card: description, findings, main numbers of each engine, images; details folded. */
  function sceneSection(scene) {
    const { truth } = scene;
    const viewer = viewerOf(scene);
    const causes = ranked().filter((entry) => entry.scene === scene).slice(0, CAUSES_SHOWN);
    return section(ids.get(scene), titleOf(scene),
      el("div", { class: "beside" }, el("div", {},
        el("p", {}, scene.physics),
        el("p", { class: "small soft" }, el("span", { class: "mono" }, scene.name), " · ",
          truth ? ["compared with ", bold(truth.engine), ` (${truth.rung})`]
            : "no reference: no engine of level exact or tracer rendered it",
          " · exposure ", exposure(scene),
          scene.size_px && [" · ", number(scene.size_px, 0), " × ", number(scene.size_px, 1),
            " pixels"],
          viewer && [" · ", link(viewer, "all frames in the viewer")],
          !viewer && scene.no_viewer && [" · not in the viewer: ", scene.no_viewer]),
        scene.attribution?.odd_one_out && el("p", { class: "finding odd" },
          el("b", { "aria-hidden": "true" }, "≠ "), scene.attribution.sentence),
        notRendered(scene)),
      causes.length > 0 && el("ul", { class: "causes small" },
        causes.map(({ row, frame, found }) => item(bold(frame.engine), ", ", rankedWords(found),
          ". ", row.cause)))),
      cardTable(scene),
      pictures(scene, "radiance"),
      folded("All numbers, maps of transmittance, steps, costs, gates of this scene",
        numbers(scene), transmittanceMaps(scene), baked(framesOf(scene), "engine"),
        attribution(scene), studies(scene), runs(scene), gates(scene)));
  }

  // ---------------------------------------------------------------------------- table of the card

  /** The results of an engine's gates by quantity, and the quantities without a gate. */
  function gatedWords(scene, frame) {
    const own = gatesOf(scene).filter((gate) => gate.engine === frame.engine);
    const sorts = [["fail", "✗ ", "fail-word", " fails"], ["pass", "✓ ", "pass-word", " passes"],
      ["not_measured", "○ ", "open-word", " not measured"]];
    const named = new Set();
    const said = [];
    for (const [verdict, sign, className, ending] of sorts)
      for (const { quantity } of own.filter((gate) => gate.verdict === verdict)) {
        if (!named.has(quantity))
          said.push(el("span", { class: className }, sign, quantity, ending));
        named.add(quantity);
      }
    const bias = biasOf(frame);
    for (const quantity of ["radiance", "transmittance"])
      if (!own.some((gate) => gate.quantity === quantity)
        && measurementsOf(frame).some((row) => row.quantity === quantity))
        said.push(el("span", { class: "soft" }, quantity, quantity === "radiance" && bias
          && [" bias ", readNumber(bias)], " not gated"));
    return said.map((part, n) => [n > 0 && "; ", part]);
  }

  function cardTable(scene) {
    const columns = CARD.map(([head, note, names]) => ({ head, note, find: (frame) => names
      .map((name) => measurementOf(frame, ...name)).find((found) => found) }))
      .filter(({ find }) => framesOf(scene).some(find));
    const list = framesOf(scene).filter((frame) => columns.some(({ find }) => find(frame)))
      .sort((a, b) => sizeOf(b) - sizeOf(a));
    if (list.length === 0)
      return el("p", { class: "soft" }, "Nothing was measured in this scene.");
    const isNoisy = list.some((frame) => typeof frame.noise?.value === "number");
    const noise = (frame) => (typeof frame.noise?.value === "number"
      ? number(frame.noise, "value", { scale: 100, unit: "%" })
      : el("span", { class: "soft" }, "none"));
    const isFailing = ({ engine }) => gatesOf(scene)
      .some((gate) => gate.engine === engine && gate.verdict === "fail");
    return scrolling(`${titleOf(scene)}: main numbers`, table("wide five",
      [colHead("Engine, worst first"), columns.map(({ head, note }) => numHead(head, note)),
        isNoisy && numHead("Noise left", "per pixel, of the RMS"),
        numHead("Warm frame", "wall time"), numHead("Start-up", "wall time"), colHead("Gates")],
      list.map((frame) => el("tr", { class: isFailing(frame) ? "failing" : null },
        rowHead(frame.engine, small(frame.rung)),
        columns.map(({ find }) => num(cardNumber(find(frame)))),
        isNoisy && num(noise(frame)), num(speed(frame)), num(startUp(frame)),
        words(gatedWords(scene, frame), frame.note
          && el("div", { class: "small" }, frame.note), frame.noise?.warning
          && el("div", { class: "small" }, frame.noise.warning))))),
    speedNote(scene));
  }

  const cardNumber = (found) => (found ? readNumber(found) : absent());

  const notMeasured = () => el("span", { class: "soft" }, "not measured");

  const warmFrame = ({ speed: found }) => (typeof found?.render_s === "number"
    ? number(found, "render_s", { unit: "s" }) : notMeasured());

  /** The time of a frame of an engine that is already running, with its interval and repeats. */
  function speed(frame) {
    const found = frame.speed;
    if (typeof found?.render_s !== "number") return notMeasured();
    return [warmFrame(frame), small(
      typeof found.low_s === "number" && ["[", number(found, "low_s"), ", ",
        number(found, "high_s"), "]", unitText("s")],
      typeof found.repeats === "number" && [" of ", number(found, "repeats")])];
  }

  const startUp = ({ speed: found }) => (typeof found?.start_s === "number"
    ? number(found, "start_s", { unit: "s" }) : notMeasured());

  function speedNote(scene) {
    const timed = framesOf(scene).filter((frame) => typeof frame.speed?.render_s === "number");
    const kinds = [...new Set(timed.map((frame) => frame.speed.interval))].map((kind) =>
      `${kind} (${timed.filter((frame) => frame.speed.interval === kind)
        .map((frame) => frame.engine).join(", ")})`);
    return [kinds.length > 0 && `Intervals of times: ${kinds.join("; ")}. `,
      "The folded part of each scene lists the run time of each frame of this page."];
  }

  // --------------------------------------------------------------------------------------- images

  function notRendered(scene) {
    const rest = framesOf(scene).filter((frame) => frame.status !== "rendered");
    return rest.length > 0 && el("p", { class: "small soft not-rendered" }, "No frame from ",
      rest.map((frame, n) => [n > 0 && "; ", bold(frame.engine), " (",
        word(STATUSES, frame.status), why(frame) && [": ", briefly(frame)], ")"]), ".");
  }

  const drawnFrames = (scene) => framesOf(scene).filter((frame) => frame.status === "rendered")
    .sort((a, b) => isTruth(scene, b.engine) - isTruth(scene, a.engine));
  const mapsOf = (scene, kind) => framesOf(scene).some((frame) => frame.difference?.[kind]);

  /** The image of each engine beside the image of the reference, and the difference map. */
  function pictures(scene, kind) {
    const drawn = drawnFrames(scene);
    const truthFrame = framesOf(scene).find((frame) => isTruth(scene, frame.engine));
    if (drawn.length === 0) return el("p", {}, "No engine rendered this scene.");
    return [
      el("h3", {}, "Images, and the difference in radiance"),
      pictureGrid(scene, drawn.map((frame) => card(scene, frame, truthFrame, kind)))];
  }

  function transmittanceMaps(scene) {
    const kind = "transmittance";
    const drawn = drawnFrames(scene).filter((frame) => frame.difference?.[kind]);
    return drawn.length > 0 && [
      el("h3", {}, "Difference in transmittance"),
      pictureGrid(scene, drawn.map((frame) => pictureCard(frame.engine, frame.rung,
        differenceFigure(scene, frame, kind))))];
  }

  const isColour = (text) => /^#[0-9a-f]{6}$/i.test(text ?? "");
  const isColours = (list) => Array.isArray(list) && list.length > 1 && list.every(isColour);

  /** A square of a colour and its meaning. */
  function swatch(colour, text) {
    const square = el("span", { class: "square", "aria-hidden": "true" });
    square.style.background = colour;
    return el("span", { class: "swatch" }, square, text);
  }

  /** The key of the colours beyond a map's scale, with their names for colour-blind readers. */
  const beyondKey = (colours, names) => el("div", { class: "beyond" },
    Object.entries(names).map(([key, text]) => isColour(colours?.[key])
      && swatch(colours[key], text)));

  /** The scale of a difference map, shown below every map, with the colours beyond the scale. */
  function differenceKey(node, key, unit) {
    const given = report.difference_colours;
    return el("div", { class: "map-key" },
      colourBar(isColours(given) ? given : DIFFERENCE_COLOURS,
        "Colour scale from below the reference to above it",
        number(node, key, { scale: -1, exact: true, unit }), "0",
        number(node, key, { signed: true, exact: true, unit })),
      beyondKey(report.difference_beyond ?? BEYOND_COLOURS, { below: "cyan: lower",
        above: "yellow: higher", not_a_number: "magenta: not a number" }));
  }

  function legend(scene, kind) {
    const unit = unitOf(scene, kind, "bias");
    return differenceKey(scene.difference_scale, kind, isRatio(unit) ? "" : unit);
  }

  const sizeOfScene = (scene) => scene.size_px ?? report.size_px ?? [192, 108];
  const pictureGrid = (scene, cards) => fit(el("div", { class: "pictures" }, cards),
    sizeOfScene(scene), 400);

  const notHere = (path) => `${path} is not in this report's folder`;
  const pixels = (path, alt, size = report.size_px, className = "") => window.NephPage.pixels(path,
    alt, size, notHere(path), `pixels${className}`);

  const below = (text) => el("div", { class: "wipe" }, text);

  function card(scene, frame, truthFrame, kind) {
    const own = inside(frame.picture);
    const reference = isTruth(scene, frame.engine);
    const other = reference ? null : inside(truthFrame?.picture);
    const title = titleOf(scene);
    return pictureCard(frame.engine, reference ? `reference · ${frame.rung}` : frame.rung,
      !own ? [hole("no image: this engine computed no radiance"), below()]
        : other ? wipe(own, other, frame.engine, scene.truth.engine, title, sizeOfScene(scene))
          : [el("div", { class: "stack" }, pixels(own, `${title}, by ${frame.engine}`,
            sizeOfScene(scene))),
            below(reference ? "the reference of this scene" : "no reference to compare with")],
      mapsOf(scene, kind) && !reference && differenceFigure(scene, frame, kind));
  }

  function differenceFigure(scene, frame, kind) {
    const path = inside(frame.difference?.[kind]);
    return el("figure", {}, path ? pixels(path,
      `${titleOf(scene)}: signed ${kind} difference of ${frame.engine} from the reference`,
      sizeOfScene(scene))
      : hole(scene.truth ? `no difference: ${frame.engine} or the reference computed no ${kind}`
        : "no reference in this scene"),
    el("figcaption", {}, `${frame.engine} − ${scene.truth?.engine ?? "reference"}, ${kind}`,
      path && legend(scene, kind)));
  }

  function wipe(own, other, engine, truth, title, size) {
    const stack = el("div", { class: "stack wipes", title: `Move: wipe to ${truth}. Click: swap.` },
      pixels(own, `${title}, by ${engine}`, size), pixels(other, "", size, " over"),
      el("span", { class: "edge" }),
      el("span", { class: "tag left", "aria-hidden": "true" }, truth), el("span",
        { class: "tag right", "aria-hidden": "true" }, engine));
    const slider = el("input", { type: "range", min: 0, max: 100, value: 0,
        "aria-label": `Wipe the image of ${engine} to the image of ${truth}` });
    const show = (percent) => {
      stack.style.setProperty("--wipe", `${percent}%`);
      stack.classList.toggle("wiping", percent > 0);
    };
    const showSlider = () => show(Number(slider.value));
    slider.addEventListener("input", showSlider);
    stack.addEventListener("pointermove", (event) => {
      const box = stack.getBoundingClientRect();
      show(Math.min(100, Math.max(0, (100 * (event.clientX - box.left)) / box.width)));
    });
    stack.addEventListener("pointerleave", showSlider);
    stack.addEventListener("click", () => {
      slider.value = Number(slider.value) >= 50 ? 0 : 100;
      showSlider();
    });
    return [stack, el("div", { class: "wipe" }, el("span", { "aria-hidden": "true" }, engine),
        slider, el("span", { "aria-hidden": "true" }, truth))];
  }

  // -------------------------------------------------------------------------------- numbers table

  const rank = (names, name) => (names.includes(name) ? names.indexOf(name) : names.length);

  function numbers(scene) {
    const measured = framesOf(scene).filter((frame) => measurementsOf(frame).length > 0);
    if (measured.length === 0) return null;
    const columns = measured.filter((frame) => !isTruth(scene, frame.engine));
    const cells = columns.flatMap((frame) => frame.measurements
      .filter((row) => typeof row.value === "number").map((row) => ({ frame, row })));
    const order = ({ row: { quantity, mask } }) => 100 * rank(Object.keys(QUANTITIES), quantity)
      + rank(Object.keys(MASKS), mask);
    const groups = [...Map.groupBy(cells, ({ row }) => JSON.stringify([row.quantity, row.mask]))
      .values()].sort(([a], [b]) => order(a) - order(b));
    const whole = groups.filter(([{ row }]) => row.mask === "all");
    const parts = groups.filter(([{ row }]) => row.mask !== "all");
    const truths = measured.filter((frame) => isTruth(scene, frame.engine));
    return [
      el("h3", {}, "Numbers"),
      whole.length > 0 && numbersTable(scene, columns, whole,
        `Errors over the whole image; reference: ${scene.truth?.engine ?? "none"}`),
      parts.length > 0 && el("details", { open: whole.length === 0 },
        el("summary", {}, "Numbers by part of the image: ",
          [...new Set(parts.map(([{ row }]) => maskName(row.mask)))].join(", ")),
        numbersTable(scene, columns, parts, "Errors by part of the image")),
      truths.map(ofItself),
      unmeasured(measured),
    ];
  }

  /** The numbers of the reference, which is compared with no other engine, in one line. */
  function ofItself(frame) {
    const list = frame.measurements.filter((row) => typeof row.value === "number");
    return list.length > 0 && el("p", { class: "small soft" },
      `Numbers of ${frame.engine}, the reference: `,
      list.map((row, n) => [n > 0 && ", ", `${row.quantity} ${row.metric} (${maskName(row.mask)}) `,
        number(row, "value", reading(row.metric, row.unit)),
        row.interval && [" ", interval(row)]]), ".");
  }

  /** The reasons for missing numbers, each once. */
  function unmeasured(columns) {
    const missing = columns.flatMap(measurementsOf).filter((row) => typeof row.value !== "number");
    const reasons = Map.groupBy(missing, (row) => row.undefined_because || "no reason is given");
    const names = (list) => [...new Set(list.map((row) => `${row.quantity} ${row.metric}`))];
    return reasons.size > 0 && el("ul", { class: "small soft" }, [...reasons]
      .map(([reason, list]) => item(`Not measured: ${names(list).join(", ")} (${reason}).`)));
  }

  function numbersTable(scene, columns, groups, label) {
    const explained = new Set(); // each measure is explained in its first row
    const bodies = groups.map((group, n) => {
      const [{ row: { quantity, mask } }] = group;
      const metrics = [...Map.groupBy(group, ({ row }) => row.metric)]
        .sort(([a], [b]) => rank(metricNames, a) - rank(metricNames, b));
      return el("tbody", {},
        el("tr", { class: "group" }, el("th", { scope: "rowgroup", colspan: columns.length + 1 },
            `${QUANTITIES[quantity] ?? quantity}, ${maskName(mask)}`)),
        metrics.map(([metric, cells]) => metricRow(scene, columns, metric, cells, explained)),
        tr(rowHead("pixels", n === 0 && small("included in the numbers above")),
          columns.map((frame) => {
            const first = firstIn(frame, quantity, mask);
            return num(first ? number(first, "pixel_count") : absent());
          })));
    });
    return scrolling(`${titleOf(scene)}: ${label}`, el("table", {}, el("thead", {},
      tr(colHead("Measure"),
        columns.map((frame) => numHead(frame.engine, frame.rung)))), bodies));
  }

  const firstIn = (frame, quantity, mask) => frame.measurements.find((row) =>
    row.quantity === quantity && row.mask === mask && typeof row.value === "number");

  function metricRow(scene, columns, metric, cells, explained) {
    const rowUnit = cells[0].row.unit;
    const meaning = !explained.has(metric) && report.metrics?.[rank(metricNames, metric)]?.help;
    explained.add(metric);
    return tr(
      rowHead(metric, ` [${reading(metric, rowUnit).unit || (isRatio(rowUnit) ? "1" : rowUnit)}]`,
        meaning && small(meaning)),
      columns.map((frame) => {
        const own = cells.filter((cell) => cell.frame === frame);
        return num(own.length > 0 ? own.map(({ row }) => measurement(scene, frame, row, rowUnit))
          : absent());
      }));
  }

  function measurement(scene, frame, row, rowUnit) {
    const { scale, signed, unit } = reading(row.metric, row.unit);
    const gate = gatesOf(scene).find((one) => one.verdict === "fail" && one.engine === frame.engine
      && one.quantity === row.quantity && one.metric === row.metric && one.mask === row.mask);
    const value = number(row, "value", { scale, signed, unit: row.unit === rowUnit ? "" : unit });
    return [
      gate ? el("span", { class: "fail-word" }, "✗ ", value) : value,
      row.interval && small(interval(row, { scale })),
      row.metric === "rel_bias" && row.mask === "all" && stepBias(frame, row.quantity),
      gate && small("limit ", number(gate, "maximum", { scale, exact: true })),
      row.pixel_count !== firstIn(frame, row.quantity, row.mask).pixel_count
        && small("over ", number(row, "pixel_count"), " px"),
    ];
  }

  // ------------------------------------------------------------------ disagreement, steps, baking

  // The axis of all interval plots: linear within ±0.01 %, logarithmic beyond, ±100 % at its ends.
  const AXIS = { width: 168, height: 16, fine: 1e-4, most: 1,
    ticks: [-1, -0.1, -0.01, -0.001, 0, 0.001, 0.01, 0.1, 1] };
  const across = (value) => {
    const place = Math.asinh(value / AXIS.fine) / Math.asinh(AXIS.most / AXIS.fine);
    return (AXIS.width / 2) * (1 + 0.94 * Math.max(-1, Math.min(1, place)));
  };
  const plot = (kind, ...parts) => svg("svg", { class: `whisker${kind}`, width: AXIS.width,
    height: AXIS.height, viewBox: `0 0 ${AXIS.width} ${AXIS.height}`, "aria-hidden": "true" },
  ...parts);

  /** The head of a column of interval plots: the names of the ticks. */
  const TICK_NAMES = [[-0.1, "−10 %"], [-0.001, "−0.1"], [0.001, "0.1"], [0.1, "10 %"]];
  const axisHead = () => el("th", { scope: "col", class: "plot" },
    hidden("Plot of the interval"), plot("", TICK_NAMES.map(([tick, text]) =>
      label(across(tick), 11, "middle", text))));

  /** Plots a value and its interval about zero; the numbers are beside it in the same row. */
  function whisker(value, range, state, zone) {
    const cell = el("td", { class: "plot" });
    if (typeof value !== "number") return cell;
    const middle = AXIS.height / 2;
    const [low, high] = Array.isArray(range) ? range : [value, value];
    return append(cell, [plot(` ${state}`,
      zone > 0 && svg("rect", { class: "zone", x: across(-zone), y: 0,
          width: across(zone) - across(-zone), height: AXIS.height }),
      AXIS.ticks.map(across).map((x, n) => line(AXIS.ticks[n] === 0 ? "zero" : "tick", x, 0, x,
        AXIS.height)),
      line("range", across(low), middle, across(high), middle),
      [low, high].map(across).map((x) => line("range", x, middle - 3, x, middle + 3)),
      svg("circle", { class: "value", cx: across(value), cy: middle, r: 3.2 }))]);
  }

  const PAIR_STATES = { differ: "known", agree: "agrees" };
  const pairRow = (pair, found) => tr(rowHead(`${pair.first} − ${pair.second}`),
    el("td", { class: "tight" }, word(PAIRS, pair.verdict)),
    num(percent(pair, "mean_difference", { unit: "%" })),
    num(interval(pair, { scale: 100, signed: true }), unitText("%")),
    whisker(pair.mean_difference, pair.interval, PAIR_STATES[pair.verdict] ?? "open",
      found.mean_meant),
    num(share(pair, "rms_difference")), num(share(pair, "noise_floor")));

  function attribution(scene) {
    const { attribution: found } = scene;
    const title = el("h3", {}, "Disagreement between engines");
    if (found === undefined) return null;
    if (found === null)
      return [title, el("p", { class: "soft" }, "The outlier cannot be determined: fewer than "
          + "three engines rendered this scene, or too little of it is lit.")];
    const [kind, sign] = found.odd_one_out ? ["odd", "≠ "]
      : /^cannot tell/.test(found.sentence) ? ["silent", "○ "] : ["calm", "· "];
    return [
      title,
      el("p", { class: `finding ${kind}` }, el("b", { "aria-hidden": "true" }, sign),
        found.sentence),
      scrolling(`${titleOf(scene)}: disagreement between engines`, table("wide",
        [colHead("Pair"), colHead("Finding"), numHead("Mean difference"),
          numHead("Interval"), axisHead(),
          numHead("Pixel by pixel", "RMS, noise subtracted"),
          numHead("Noise", "RMS per pixel")],
        (found.pairs ?? []).map((pair) => pairRow(pair, found)))),
      el("p", { class: "note small soft" }, "Radiance over ", number(found, "pixel_count"),
        ` pixels (${maskName(found.mask)}), relative to its mean. `,
        typeof found.mean_meant === "number"
          && ["Two engines agree if their difference is certainly below ",
            limitShare(found, "mean_meant"), " in the mean (the band in the plots) and below ",
            limitShare(found, "rms_meant"), " pixel by pixel. They differ if it is certainly "
            + "larger. Otherwise there is too much noise for a finding. "],
        typeof found.family_alpha === "number"
          && ["If all engines agree, the intervals still show a difference in ",
            limitShare(found, "family_alpha"), " of runs."]),
    ];
  }

  /** The bias of a frame by its step study, shown beside the bias that was measured. */
  function stepBias({ study }, quantity) {
    const level = study?.levels?.[study.chosen];
    return quantity === "radiance" && level && small("step bias ",
      percent(level, "bias", { unit: "%" }),
      level.bias_noise > 0 && [" ± ", share(level, "bias_noise")]);
  }

  function studies(scene) {
    const studied = framesOf(scene).filter((frame) => frame.study?.levels?.length > 0);
    return studied.length > 0 && [
      el("h3", {}, "Step error of the external renderers"),
      el("p", { class: "small soft" },
        "Mean radiance of the image at finer and finer steps, compared with the extrapolated limit "
        + "at step size zero. The frame uses the first setting that is accurate enough."),
      studied.map((frame) => study(scene, frame)),
    ];
  }

  const levelRow = (level, isChosen, tolerance) => el("tr", { class: isChosen ? "chosen" : null },
    rowHead(number(level, "setting", { exact: true }), isChosen && small("▸ chosen")),
    num(number(level, "radiance", { digits: 5 }), " ± ", number(level, "noise"),
      unitText("W m⁻² sr⁻¹")),
    num(percent(level, "bias", { unit: "%" }), " ± ", share(level, "bias_noise")),
    whisker(level.bias, [level.bias - 2 * level.bias_noise, level.bias + 2 * level.bias_noise],
      "known", tolerance),
    num(number(level, "wall_s", { unit: "s" })));

  // The class of a study's verdict, its word, and the text before and after the tolerance.
  const STUDIED = {
    within: ["pass-word", "✓ within ", "", ", noise included."],
    noise: ["open-word", "○ not certain", ": noise hides whether it is within ", "."],
    off: ["fail-word", "✗ off", ": even the finest step is not within ",
      ", or its error does not decrease at the expected order."],
  };

  function study(scene, { engine, study }) {
    const chosen = study.levels[study.chosen];
    const [kind, sign, before, after] = STUDIED[study.verdict] ?? STUDIED.off;
    return [
      el("p", {}, bold(engine), ` was rendered with ${study.option} = `,
        number(chosen, "setting", { exact: true }),
        study.shipped ? " (from a study that comes with neph). The bias of this step is "
          : ". The bias of this step is ",
        percent(chosen, "bias", { unit: "%" }), " ± ",
        percent(chosen, "bias_noise", { signed: false, unit: "%" }), ": ",
        el("span", { class: kind }, sign), before, limitShare(study, "tolerance"), after),
      scrolling(`${titleOf(scene)}: step error of ${engine}`, table(null,
        [colHead(study.option), numHead("Mean radiance", "± noise"), numHead("Bias", "± noise"),
          axisHead(), numHead("Wall time", "with start-up")],
        study.levels.map((level) => levelRow(level, level === chosen, study.tolerance)))),
      el("p", { class: "note small soft" }, "Limit ",
        number(study, "limit", { digits: 5, unit: "W m⁻² sr⁻¹" }),
        " by order ", number(study, "order", { exact: true }),
        typeof study.observed_order === "number" ? [" (observed ", number(study, "observed_order"),
          ")"] : " (the observed order is hidden by noise)",
        Array.isArray(study.size_px) && ["; images of ", number(study.size_px, 0), " × ",
          number(study.size_px, 1), " pixels"],
        ". Plots: ± twice the noise; band: the tolerance."),
    ];
  }

  const spoken = (key) => BAKED[key] ?? String(key).replace(/_/g, " ");

  /** Any value of the data in words: numbers keep their data path, other values are text. */
  function told(node, key) {
    const value = node[key];
    if (typeof value === "number") return number(node, key);
    if (Array.isArray(value)) return value.map((_, n) => [n > 0 && " × ", told(value, n)]);
    if (typeof value === "object" && value !== null) return Object.keys(value)
      .map((name, n) => [n > 0 && "; ", spoken(name), " ", told(value, name)]);
    return value === true ? "yes" : value === false ? "no" : value ?? absent();
  }

  /** Media that were baked to a grid for an engine: the error of the grid for each of `owners`. */
  function baked(owners, nameKey) {
    const list = owners.filter((owner) => owner.bake);
    return list.length > 0 && [
      el("h3", {}, "Baked media"),
      el("p", { class: "small soft" },
        "These engines cannot evaluate the medium themselves and rendered a grid of it. The error "
        + "of the grid is part of their difference above:"),
      el("ul", { class: "small" },
        list.map((owner) => item(bold(owner[nameKey]), ": ", told(owner, "bake")))),
    ];
  }

  // ------------------------------------------------------------------------------- runs and gates

  function runRow(frame) {
    const engine = engineNamed(frame.engine);
    return tr(rowHead(frame.engine, small(frame.rung)),
      words(word(STATUSES, frame.status), frame.reused && " · taken from the store",
        why(frame) && el("pre", { class: "log", id: ids.get(frame), tabindex: "0" }, why(frame)),
        frame.note && el("div", { class: "small" }, frame.note),
        frame.step_optical_depth > 1 && el("div", { class: "small" },
          bold("Steps too long: "), "one step spans an optical depth of up to ",
          number(frame, "step_optical_depth"), "; detail within a step is not resolved."),
        frame.status === "rendered" && typeof frame.seed === "number"
          && el("div", { class: "small soft" }, `seed ${frame.seed}`),
        frame.settings && el("div", { class: "small soft" }, frame.settings),
        frame.status === "missing" && engine?.install_line
          && el("div", {}, el("code", {}, engine.install_line))),
      versionCell(engine),
      ["render_s", "wall_s", "cpu_s"].map((key) => num(number(frame, key, { unit: "s" }))),
      num(number(frame, "peak_memory_bytes", { scale: 1 / 2 ** 20, unit: "MiB" })));
  }

  const versionCell = (engine) => words(engine?.version || absent("not known"),
    engine?.device && el("div", { class: "small soft" }, engine.device));

  const runs = (scene) => framesOf(scene).length > 0 && [
    el("h3", {}, "Runs and their costs"),
    scrolling(`${titleOf(scene)}: runs and their costs`, table("wide",
      [["Engine", "State", "Version and device"].map((name) => colHead(name)),
        ["Radiance pass", "All passes", "Processor", "Memory"].map((name) => numHead(name))],
      framesOf(scene).map(runRow)),
    "Costs of one rendering in this run; they are not comparable between engines. The radiance "
      + "pass excludes start-up if the engine measures it. All passes include the start-up of "
      + "engines that run as a new process. Processor time is the sum over all threads. Memory "
      + "is the peak."),
  ];

  const gates = (scene) => [
    el("h3", {}, "Gates"),
    gatesOf(scene).length === 0 ? el("p", { class: "soft" }, "This scene sets no limits.")
      : scrolling(`${titleOf(scene)}: gates`, table("wide",
        [["Verdict", "Engine", "Number"].map((name) => colHead(name)), numHead("Value"),
          numHead("Limit"), colHead("Reason")],
        gatesOf(scene).map((gate) => el("tr", { class: gate.verdict === "fail" ? "failing" : null },
          el("td", { class: "tight" }, word(VERDICTS, gate.verdict)),
          rowHead(gate.engine), el("td", {}, measured(gate)),
          num(gateValue(scene, gate, "value")), num(gateValue(scene, gate, "maximum")),
          words(gate.reason || el("span", { class: "soft" }, "none given")))))),
  ];

  // ------------------------------------------------------------------------------- physics suite

  const isOurs = (row) => ["exact", "tracer"].includes(engineNamed(row.engine)?.rung);

  /** The tests of the phase functions, which need no medium. */
  function phaseFunctions() {
    const list = physics?.phase_functions ?? [];
    return list.length > 0 && section("phase-functions", "Phase functions",
      el("p", {}, "A phase function is the distribution of the directions of scattered light. Its "
        + "integral over all directions must be 1, and its mean cosine must be g. The mean cosine "
        + "of directions that are sampled from it must also be g."),
      folded(list.some((row) => row.verdict === "off") ? "Some are off: the numbers"
        : "All agree: the numbers", scrolling("Phase functions", table(null,
        [colHead("Phase function"), colHead("Finding"), numHead("g", ""),
          numHead("Integral", "must be 1"), numHead("Mean cosine", "must be g"),
          numHead("Sampled mean cosine", "must be g")], list.map(phaseRow)))));
  }

  const phaseRow = (row) => el("tr", { class: row.verdict === "off" ? "failing" : null },
    rowHead(spoken(row.phase)),
    el("td", { class: "tight" }, word(FINDINGS, row.verdict === "off" ? "wrong" : row.verdict)),
    num(number(row, "g", { exact: true })),
    ["integral", "mean_cosine", "sampled_mean_cosine"].map((key) =>
      num(number(row, key, { digits: 10 }))));

  const sentenceCase = (text) => text.charAt(0).toUpperCase() + text.slice(1);

  /** The finding of a row: agrees, known, gap, wrong (FINDINGS) or open. */
  function findingOf(row) {
    if (row.verdict === "agrees") return "agrees";
    if (row.verdict !== "off") return "open";
    if (isOurs(row)) return "wrong";
    return row.lowered || row.look ? "gap" : row.cause ? "known" : "wrong";
  }

  const findingWord = (row) => (findingOf(row) === "open" ? word(STATUSES,
      row.status === "rendered" ? "not measured" : row.status) : word(FINDINGS, findingOf(row)));
  const deviation = (row) => percent(row, "deviation", { unit: "%" });
  function checkLink(name) {
    const found = checks.find((check) => check.name === name);
    return found ? link(`#${ids.get(found)}`, name) : name;
  }

  const participants = () => [...new Map(rows.map((row) => [row.participant, row])).values()];
  const enumerated = (items) => items.map((item, n) =>
    [n > 0 && (n === items.length - 1 ? " and " : ", "), item]);
  const isMeasured = (row) => row.verdict !== "not_measured";

  // The findings of engines that are not reference engines: for one measurement, and for more.
  const COUNTED = [["agrees", " agrees", " agree"],
    ["known", " is off for a known cause", " are off for a known cause"],
    ["gap", " is off by light that the engine does not model",
      " are off by light that the engine does not model"],
    ["wrong", " is off for an unknown cause", " are off for an unknown cause"]];

  function physicsVerdict() {
    const ours = rows.filter((row) => isOurs(row) && isMeasured(row));
    const others = rows.filter((row) => !isOurs(row) && isMeasured(row));
    const counted = (list, state) => list.filter((row) => findingOf(row) === state).length;
    const names = participants().filter(isOurs).map((row) => bold(row.participant));
    const wrong = counted(ours, "wrong");
    const open = rows.length - ours.length - others.length;
    return [
      el("p", {}, "Every engine renders scenes whose light is known without a renderer. ",
        names.length > 0 && ["The reference engines (", enumerated(names), ") ",
          wrong === 0 ? "agree with the known light in all "
            : ["are off in ", derived("physics.ours.wrong", wrong), " of "],
          derived("physics.ours", ours.length), " measurements. "],
        others.length > 0 && ["Of ", derived("physics.others", others.length),
          " measurements of the other engines ",
          enumerated(COUNTED.map(([state, ...words]) => [state, counted(others, state), words])
            .filter(([, count]) => count > 0).map(([state, count, words]) =>
              [derived(`physics.others.${state}`, count), plural(count, ...words)])), ". "],
        open > 0 && [derived("physics.open", open), plural(open, " measurement", " measurements"),
          " could not be made; the tables give the reasons."]),
      el("p", { class: "small soft" }, "A measurement is off if it differs from the truth by more "
        + "than ", number(physics, "critical_z"), " standard errors, in addition to bounded step "
        + "and rounding errors. This limit is for ", number(physics, "tests"), " measurements: if "
        + "all engines are correct, any of them is called off with a probability of ",
        limitShare(physics, "family_alpha"), " (Šidák)."),
    ];
  }

  const physicsHelp = () => [
    entry("What is compared",
      "The scenes are simple: their light is known from formulas, from integrals or from another "
      + "numerical method. The truth of every pixel is computed without a renderer."),
    entry("Findings",
      "✓ agrees: the interval contains 0. △ off, cause known. ◇ model gap: the engine does not "
      + "model this light: it rendered single scattering only, or is a non-physical model. ✗ off: "
      + "the cause is unknown, or the engine is a reference engine."),
    entry("z", "The difference in standard errors. Engines without noise have a bound of their "
      + "step error instead, from two step sizes. A measurement with a large z can agree: if the "
      + "rounding error of the engine's numbers is larger than its noise."),
    entry("Interval plots",
      "The dot is the difference, the bar its uncertainty by noise, step and rounding. The scale "
      + "is logarithmic: ticks at 0.1, 1, 10 and 100\u00a0% on both sides of zero."),
    entry("Small images",
      "The images have few pixels, because a test needs only the mean of a few hundred. They are "
      + "enlarged without smoothing. Wipe to the truth with the pointer or the slider. The mean "
      + "has less noise than the image. Difference maps end at a tenth of the mean truth."),
  ];

  function agreements({ participant }) {
    const measured = rows.filter((row) => row.participant === participant && isMeasured(row));
    const agreeing = measured.filter((row) => row.verdict === "agrees").length;
    return num(measured.length === 0 ? absent()
      : [derived(`physics.of/${participant}/agrees`, agreeing), " of ",
        derived(`physics.of/${participant}`, measured.length)]);
  }

  function physicsMatrix() {
    if (!physics) return null;
    const columns = participants();
    return section("physics", "Physics: agreement by check and engine",
      scrolling("Physics: agreement by check and engine",
        el("table", { class: "wide matrix findings" },
        el("thead", {}, tr(colHead("Check"), columns.map((row) => numHead(row.participant,
          row.look ? "non-physical" : engineNamed(row.engine)?.rung ?? row.engine)))),
        el("tbody", {},
          el("tr", { class: "total" }, rowHead("Agrees in"), columns.map(agreements))),
        rungs.map((rung) => el("tbody", {},
          el("tr", { class: "group" }, el("th", { scope: "rowgroup", colspan: columns.length + 1 },
            link(`#${ids.get(rung)}`, sentenceCase(rung.name)), `: ${rung.title}`)),
          checksOf(rung).map((check) => tr(rowHead(el("a",
            { href: `#${ids.get(check)}`, class: "mono", title: check.what }, check.name)),
          columns.map((column) => physicsCell(rows.find((row) => row.check === check.name
            && row.participant === column.participant)))))))),
      "Difference from the truth over the whole check (+ is too bright), and the finding. Point at "
        + "a check for its description. Empty: the engine does not take part."));
  }

  const physicsCell = (row) => (!row ? num() : el("td", { class: `num ${findingOf(row)}` },
    isMeasured(row) && [deviation(row), el("br")], findingWord(row)));

  const rungSection = (rung) => section(ids.get(rung), sentenceCase(rung.title),
    QUESTIONS[rung.name] && el("p", {}, QUESTIONS[rung.name]),
    folded("Each check: numbers and images", checksOf(rung).map(checkSection)));

  function checkSection(check) {
    const own = rows.filter((row) => row.check === check.name);
    const id = ids.get(check);
    return el("section", { class: "check", "aria-labelledby": id },
      el("h3", { id, class: "mono" }, check.name),
      check.what && el("p", {}, sentenceCase(check.what), "."),
      scrolling(`Check ${check.name}`, table("wide",
        [colHead("Participant"), colHead("Finding"), numHead("Difference", "[interval]"),
          axisHead(), numHead("Error", "one σ, or step"), numHead("z", "pixels: mean, var."),
          colHead("In words")], own.map(checkRow))),
      baked(own, "participant"),
      checkPictures(check, own));
  }

  function checkRow(row) {
    const state = findingOf(row);
    const there = typeof row.deviation === "number";
    const [kind, unit] = typeof row.standard_error === "number" ? ["standard_error", "σ"]
      : ["step_bound", "step"];
    return el("tr", { class: state === "wrong" ? "failing" : null },
      rowHead(row.participant,
        small(row.look ? "non-physical model" : engineNamed(row.engine)?.rung)),
      el("td", { class: "tight" }, findingWord(row)),
      num(percent(row, "deviation", { unit: "%" }), there && Array.isArray(row.interval)
        && small(interval(row, { scale: 100, signed: true }), unitText("%"))),
      whisker(row.deviation, row.interval, state, 0),
      num(there ? [share(row, kind), unitText(unit)] : absent(),
        there && typeof row.rounding === "number" && small("rounding ",
          percent(row, "rounding", { signed: false, exact: true, unit: "%" }))),
      num(number(row, "z", { signed: true }), typeof row.pixel_z_mean === "number"
        && small(number(row, "pixel_z_mean", { signed: true }), ", ",
          number(row, "pixel_z_variance"))),
      words(rowWords(row), el("div", { class: "small soft" },
        row.settings && `${row.settings} · `, number(row, "wall_s", { unit: "s" }))));
  }

  function rowWords(row) {
    if (!isMeasured(row)) return why(row) || "no reason is given";
    return [
      row.verdict === "agrees" ? "" : row.cause ? `${row.participant} is off because ${row.cause}.`
        : `${row.participant} is off; the cause is not known.`,
      row.lowered && el("div", { class: "small" },
        "It rendered single scattering of sunlight only: it does not support the rest."),
    ];
  }

  function checkPictures(check, own) {
    const views = (check.views ?? []).map((view, v) => viewPictures(check, v, own));
    if (views.length <= 2) return views;
    return [views[0], folded("The other views of this check", views.slice(1))];
  }

  function viewPictures(check, v, own) {
    const view = check.views[v];
    const size = view.size_px;
    const truth = inside(view.picture);
    const title = `${check.name}, view ${v + 1}`;
    const drawn = own.filter((row) => inside(row.pictures?.[v]));
    const cards = el("div", { class: "pictures small-pictures" },
      truth && pictureCard("truth", "computed without a renderer",
        el("div", { class: "stack" }, pixels(truth, `${title}, the truth`, size)),
        below("all engines are compared with it")),
      drawn.map((row) => {
        const own = inside(row.pictures[v]);
        const map = inside(row.differences?.[v]);
        return pictureCard(row.participant, [findingWord(row), " ", deviation(row)],
          truth ? wipe(own, truth, row.participant, "truth", title, size)
            : [el("div", { class: "stack" }, pixels(own, `${title}, by ${row.participant}`, size)),
              below()],
          el("figure", {}, map ? pixels(map,
              `${title}: signed difference of ${row.participant} from the truth`, size)
            : hole("no difference map"),
          el("figcaption", {}, `${row.participant} − truth, radiance`,
            map && differenceKey(view, "difference_scale", "W m⁻² sr⁻¹"))));
      }));
    return [
      el("p", { class: "small soft" }, check.views.length > 1
        && `View ${v + 1} of ${check.views.length}. `, view.what && `${sentenceCase(view.what)}. `,
        "Exposure ", exposure(view), "."),
      fit(cards, size, size[0] > 3 * size[1] ? 400 : 216), // a strip needs its whole length
    ];
  }

  function pictureCard(title, subtitle, ...parts) {
    const card = el("article", { class: "card" },
      el("header", {}, el("h4", {}, title), el("p", {}, subtitle)), parts);
    card.style.gridRow = `span ${Math.max(4, card.childElementCount)}`;
    return card;
  }

  // ------------------------------------------------------------------------------------ over time

  const overTime = () => sequences.length > 0
    && section("over-time", "Over time", sequences.map(sequenceSection));

  function sequenceSection(sequence) {
    const { reference } = sequence;
    return [
      el("h3", {}, sequence.title || sequence.scene),
      el("div", { class: "beside" }, el("div", {},
        el("p", {}, sequence.physics),
        el("p", { class: "small soft" }, number(sequence, "frames"), " frames of ",
          number(sequence.size_px, 0), " × ", number(sequence.size_px, 1), " pixels, displayed at ",
          number(sequence, "rate_hz", { unit: "Hz", exact: true }), ", exposure ",
          exposure(sequence), `. Reference: ${reference.text}, `,
          number(reference, "cpu_s", { unit: "s" }), " of processor time."),
        folded("Settings of the reference", el("p", { class: "small soft" }, reference.settings))),
      el("ul", { class: "causes small" }, sequence.rows.some((row) => row.floors?.length > 0)
        ? sequence.rows.map(seenOverFloor)
        : sequence.rows.length > 0 && item("floor: not measured (--tier full)"),
        sequence.rows.map((row) => (row.status === "rendered"
        ? row.findings.map((found) => item(bold(row.preset),
          `, ${maskName(found.mask)}: ${found.text}`))
        : item(bold(row.preset), " ", word(STATUSES, row.status), " ", why(row)))))),
      reference.status !== "rendered" && el("p", {}, word(STATUSES, reference.status),
        ` ${why(reference)}`),
      sequence.rows.length > 0 && sequencePictures(sequence),
      sequence.rows.some((row) => row.measurements.length > 0)
        && folded("All numbers of the flicker", sequenceNumbers(sequence)),
    ];
  }

  /** The visible flicker of the whole frame beside its floor. */
  function seenOverFloor(row) {
    const seen = row.measurements.find(({ metric, mask }) => metric === "seen_contrast"
      && mask === "all");
    return seen && typeof seen.floor === "number" && item(bold(row.preset),
      `, visible flicker: ${written(seen.value)} × threshold; with every pixel marched in every ` +
      `frame (the floor) ${written(seen.floor)}`);
  }

  const sequencePictures = (sequence) => fit(el("div", { class: "pictures small-pictures" },
    sequence.rows.filter((row) => row.pictures.length > 0).map((row) => pictureCard(row.preset,
      [`${row.engine} · warm frame: `, warmFrame(row), " · all frames, rendered once: ",
        number(row, "render_s", { unit: "s" })],
      flipbook(row, sequence), row.map && el("figure", {}, pixels(row.map,
        `${sequence.scene}: amplitude of the flicker of ${row.preset}`, sequence.size_px),
      el("figcaption", {}, "visible flicker, in multiples of the visibility threshold",
        sequence.map_scale && flickerKey(sequence.map_scale)))))),
  sequence.size_px, 400);

  /** The labels between the ends of a logarithmic scale, one per power of ten. */
  const decades = (scale) => Array.from(
    { length: Math.max(0, Math.round(Math.log10(scale.high / scale.low)) - 1) },
    (_, n) => `${Number((scale.low * 10 ** (n + 1)).toPrecision(1))} ×`);

  /** The scale of a flicker map: logarithmic, the same for all presets. */
  const flickerKey = (scale) => el("div", { class: "map-key decades" },
    isColours(scale.colours) && colourBar(scale.colours,
      "Colour scale of visible flicker, logarithmic",
      [number(scale, "low", { exact: true }), " ×"], ...decades(scale),
      [number(scale, "high", { exact: true }), " ×"]),
    beyondKey(scale.beyond, { above: "green: more", not_a_number: "teal: no number" }));

  /** The frames of one cycle: the slider selects one, the checkbox plays all. */
  function flipbook(row, sequence) {
    const frames = row.pictures.map((path, n) => pixels(path,
        `${sequence.scene} by ${row.preset}, frame ${n + 1} of the cycle`, sequence.size_px));
    const slider = el("input", { type: "range", min: 1, max: frames.length, value: 1,
        "aria-label": `Frame of the cycle, ${row.preset}` });
    const play = el("input", { type: "checkbox", "aria-label": `Play the cycle of ${row.preset}` });
    const show = () => frames.forEach((frame, n) => {
      frame.hidden = n + 1 !== Number(slider.value);
    });
    const turn = () => {
      if (!play.checked) return;
      slider.value = (Number(slider.value) % frames.length) + 1;
      show();
      window.setTimeout(turn, 1000 / sequence.rate_hz);
    };
    slider.addEventListener("input", show);
    play.addEventListener("change", turn);
    show();
    return [el("div", { class: "stack" }, frames), el("div", { class: "wipe" },
      el("label", {}, play, " play"), slider, el("span", { "aria-hidden": "true" }, "frame"))];
  }

  function sequenceNumbers({ scene, rows }) {
    const first = rows.find((row) => row.measurements.length > 0);
    return scrolling(`Flicker of ${scene}`, table(null,
      [colHead("Measure"), rows.map((row) => numHead(row.preset))],
      first.measurements.map((measurement, m) => tr(
        rowHead(measurement.metric, small(maskName(measurement.mask))),
        rows.map((row) => num(row.measurements.length === 0
          ? absent() : flickerNumber(row.measurements[m], row.floors)))))),
      "Radiance as displayed, 1 is white. In brackets: 95\u00a0% interval over the image. Then the "
        + "same number, compared with a reference of centre rays only, where edges move in steps; "
        + "and the floor: every pixel marched in every frame, the lower number of two kinds of "
        + "anti-aliasing. "
        + "The amplitude over four frames and its map contain only flicker of this period; the "
        + "deviation contains flicker of all periods.");
  }

  function flickerNumber(measurement, floors) {
    const unit = isRatio(measurement.unit) ? RATIO_UNITS[measurement.metric] ?? ""
      : measurement.unit;
    return [number(measurement, "value", { unit }),
      measurement.interval && small(interval(measurement), unit && unitText(unit)),
      small("centre rays ", number(measurement, "against_centre_rays", { unit })),
      floors?.length > 0 && small("floor ", number(measurement, "floor", { unit }), " (",
        number(measurement, "times_floor"), " times)")];
  }

  // --------------------------------------------------------------------------------------- charts

  const chartSection = (list) => section("charts", "Speed against accuracy", list.map(chart));

  /** The charts that are not on the first screen. */
  function moreCharts() {
    const rest = (report.charts ?? []).slice(1);
    return rest.length > 0 && section("more-charts", "More charts",
      el("div", { class: "charts" }, rest.map(chart)));
  }

  function chart(entry) {
    const still = inside(entry.svg);
    const image = still && el("img",
      { class: "chart", src: still, alt: `${entry.title}. ${entry.caption ?? ""}` });
    image?.addEventListener("error", () => image.replaceWith(hole(notHere(still))));
    return el("figure", { class: "chart-figure", "data-state": "static" },
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
          still && ["Also available as ", link(still, "SVG"), ". "])));
  }

  /** Makes each chart interactive, from the specification of the static chart. */
  async function upgrade(figures) {
    const work = (report.charts ?? []).map((entry, n) => ({ entry, figure: figures[n] }))
      .filter(({ entry }) => entry.spec);
    if (work.length === 0 || report.interactive === false) return;
    const vega = loadVega();
    for (const { entry, figure } of work) {
      try {
        await vega;
        await drawLive(figure, entry.spec);
        const moves = JSON.stringify(entry.spec).includes('"bind":"scales"');
        figure.querySelector(".upgrade").append("Point at a mark for its numbers",
          moves ? "; drag to pan, shift and wheel to zoom, double click to return." : ".");
      } catch (error) {
        figure.setAttribute("data-state", "failed");
        figure.querySelector(".upgrade")
          .append(`The interactive chart is not available: ${error.message}.`);
      }
    }
  }

  // -------------------------------------------------------------------------------------- engines

  const engineTable = () => section("engines", "Engines",
    folded("Versions, devices, known biases", scrolling("Engines", table("wide",
      ["Engine", "Reference level", "Version and device", "Known bias"].map((name) =>
        colHead(name)),
      engines.map((engine) => tr(rowHead(engine.name, small(engine.summary)),
        words(RUNGS[engine.rung] ?? engine.rung),
        engine.available ? words(versionCell(engine),
          engine.can && el("div", { class: "small" }, engine.can),
          engine.warning && el("div", { class: "small" }, `Warning: ${engine.warning}`))
          : words(word(STATUSES, engine.broken ? "failed" : "missing"),
            el("div", { class: "small" }, engine.missing),
            engine.install_line && !engine.broken && el("div", { class: "small" }, "To install: ",
              el("code", {}, engine.install_line))),
        words(engine.bias || el("span", { class: "soft" }, "none known"))))))));

  const foot = () => el("footer", {},
    el("p", {}, "Every number of this page is in ", link("data.json"),
    (report.charts ?? []).some((entry) => entry.spec) && report.interactive !== false
      && [". The charts are drawn by Vega and Vega-Lite (",
      link("vendor/LICENSES.txt", "licences"), ")"], "."));

  // ------------------------------------------------------------------------------------- the page

  /** Shows a table as a list of its rows if it is wider than its container. */
  function fitTables() {
    for (const region of document.querySelectorAll(".scroll")) {
      region.classList.remove("stacked");
      region.classList.toggle("stacked", region.scrollWidth > region.clientWidth + 1);
    }
  }

  /** Unfolds the element that the address's fragment names, and scrolls to it. */
  function reveal() {
    const target = document.getElementById(decodeURIComponent(location.hash.slice(1)));
    for (let element = target; element; element = element.parentElement)
      if (element.tagName === "DETAILS") element.open = true;
    target?.scrollIntoView();
  }

  /** Unfolds all parts of the page for printing. Some programs print without the events of a print
   * dialogue: for these, the style sheet unfolds the parts. */
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

  const main = document.getElementById("main");
  const complaint = (title, text) => complain(main, title, text,
    ["The numbers may still be in ", link("data.json"), "."]);
  if (!report)
    return complaint("This report has no data",
      "data.js is missing or cannot be read. It must be in the same folder as this page.");
  if (report.format !== "neph-report-1")
    return complaint("This report has an unsupported version",
      `The format of its data is “${report.format}”; this page reads “neph-report-1”.`);
  try {
    document.title = `${report.title}: ${report.verdict}`;
    fit(document.documentElement, report.size_px ?? [192, 108], 400);
    show(main, head(), front(), facts(), contents(), troubles(), moreCharts(), physicsMatrix(),
      rungs.map(rungSection), scenes.map(sceneSection), overTime(), summary(), phaseFunctions(),
      engineTable(), help(), foot());
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
    complaint("This report cannot be shown",
      `The data do not have the expected form: ${error.message}.`);
    throw error;
  }
})();
