// SPDX-License-Identifier: MIT
//
// node check_report.mjs [--data | --quick] [--screenshots DIR] REPORT_DIR
//
// Opens a finished report from disk in headless Chromium and holds the page against data.json:
// every number shown is the number in the data, every number and every reason in the data is
// shown, every picture is there, strings stayed text, nothing was asked of a network, and the page
// is readable (contrast, names, nothing wider than its place at 1280 and 390 px). --data looks at
// data.json alone, without a browser; --quick at one window alone; without
// it also at a dark, a narrow, a printed page and one without scripts.
// Exit status: 0 the report holds, 1 it does not (findings on stdout), 2 wrong use.
// $CHROMIUM names another browser than /usr/bin/chromium.
import { existsSync } from "node:fs";
import { join } from "node:path";
import { pathToFileURL } from "node:url";
import { address, browse, checkAccess, conclude, faintTexts, find, readArguments, readJson }
  from "./check_page.mjs";

const STATUSES = ["rendered", "cannot", "missing", "failed", "timeout", "interrupted",
  "over_budget"];
const RUNS = ["pass", "fail", "running", "interrupted"];
const VERDICTS = ["pass", "fail", "not_measured"];
const RUNGS = ["exact", "tracer", "witness", "model"];
const FINDINGS = ["agrees", "off", "not_measured"];
const PAIRS = ["agree", "differ", "cannot tell: noise"];
const BROKEN = ["failed", "timeout", "interrupted"];
const COSTS = ["render_s", "wall_s", "cpu_s", "peak_memory_bytes"];
const RANKING = [["radiance", "rel_rmse"], ["transmittance", "rmse"], ["depth", "rel_rmse"]];
const WORST_SHOWN = 3;
const SHOWN_MOST = 80; // findings; one mistake often repeats in every scene

// ------------------------------------------------------------------------------------------ data

const isNumber = (value) => typeof value === "number" && Number.isFinite(value);
const isPath = (value) => typeof value === "string" && /^(images|charts)\/[\w.\-/]+$/.test(value)
  && !value.includes("..");

/** Whether the data have the form that README.md promises, and its files exist. */
function checkForm(data, folder) {
  const need = (holds, path, what) => { if (!holds) find(`data.json: ${path} ${what}`); };
  const text = (object, path, ...keys) => {
    for (const key of keys)
      need(typeof object?.[key] === "string", `${path}${key}`, "is not a string");
  };
  const numeric = (object, path, ...keys) => {
    for (const key of keys) need(object?.[key] === null || isNumber(object?.[key]), `${path}${key}`,
      "is neither a number nor null");
  };
  const file = (value, path) => {
    if (value === null) return;
    need(isPath(value), path, `is not a path inside images/ or charts/: ${value}`);
    if (isPath(value))
      need(existsSync(join(folder, value)), path, `names ${value}, which does not exist`);
  };
  const list = (value, path) => {
    need(Array.isArray(value), path, "is not a list");
    return Array.isArray(value) ? value : [];
  };

  need(data.format === "neph-report-1", "format", "is not neph-report-1");
  text(data, "", "title", "created_utc", "neph_version");
  need(RUNS.includes(data.verdict), "verdict", `is not a verdict: ${data.verdict}`);
  need(["running", "interrupted"].includes(data.verdict) === isRecord(data.progress), "progress",
    `does not go with the verdict ${data.verdict}`);
  numeric(data, "", "seconds");
  if (data.counts !== undefined) {
    numeric(data.counts, "counts/", "expected", "reported", "compared");
    const held = resultCount(data);
    need(data.counts.reported === held, "counts/reported",
      `is ${data.counts.reported} though the report holds ${held}`);
    need((data.counts.reported === data.counts.expected && data.counts.compared > 0)
      || data.verdict !== "pass", "verdict",
      "is pass though results were lost or nothing was compared");
  }
  numeric(data.host, "host/", "cores", "memory_bytes");
  need(Array.isArray(data.size_px) && data.size_px.length === 2
    && data.size_px.every(Number.isInteger), "size_px", "is not [width, height]");
  const names = new Set();
  list(data.engines, "engines").forEach((engine, n) => {
    const path = `engines/${n}/`;
    text(engine, path, "name", "summary", "version", "device", "missing", "install_line");
    need(RUNGS.includes(engine.rung), `${path}rung`, `is not a rung: ${engine.rung}`);
    need(!names.has(engine.name), `${path}name`, `stands twice: ${engine.name}`);
    names.add(engine.name);
    need(engine.available || engine.missing !== "", `${path}missing`,
      "does not say why the engine is not available");
  });
  if (data.screen) need(existsSync(join(folder, data.screen)), "screen",
    `names ${data.screen}, which does not exist`);
  list(data.scenes, "scenes").forEach((scene, s) => {
    const path = `scenes/${s}/`;
    text(scene, path, "name", "title", "physics", "hash");
    if (scene.viewer) need(existsSync(join(folder, scene.viewer)), `${path}viewer`,
      `names ${scene.viewer}, which does not exist`);
    numeric(scene, path, "exposure_ev");
    numeric(scene.difference_scale, `${path}difference_scale/`, "radiance", "transmittance");
    const seen = new Set();
    list(scene.frames, `${path}frames`).forEach((frame, f) => {
      const at = `${path}frames/${f}/`;
      text(frame, at, "engine", "reason", "settings");
      need(names.has(frame.engine), `${at}engine`, `is not among the engines: ${frame.engine}`);
      need(!seen.has(frame.engine), `${at}engine`, `stands twice in its scene: ${frame.engine}`);
      seen.add(frame.engine);
      need(STATUSES.includes(frame.status), `${at}status`, `is not a status: ${frame.status}`);
      need(frame.status === "rendered" || frame.reason !== "", `${at}reason`,
        `does not say why: ${frame.engine} ${frame.status}`);
      numeric(frame, at, ...COSTS);
      file(frame.picture, `${at}picture`);
      file(frame.difference?.radiance ?? null, `${at}difference/radiance`);
      file(frame.difference?.transmittance ?? null, `${at}difference/transmittance`);
      checkStudy(frame.study ?? null, `${at}study/`, { need, text, numeric, list });
      list(frame.measurements, `${at}measurements`).forEach((row, m) => {
        const here = `${at}measurements/${m}/`;
        text(row, here, "quantity", "metric", "mask", "unit");
        numeric(row, here, "value", "pixel_count");
        need(row.interval === null || (Array.isArray(row.interval) && row.interval.length === 2
            && row.interval.every(isNumber)), `${here}interval`, "is neither null nor [low, high]");
      });
    });
    checkAttribution(scene.attribution ?? null, `${path}attribution/`, seen,
      { need, text, numeric, list });
    need(scene.truth === null || seen.has(scene.truth?.engine), `${path}truth`,
      "names no frame of the scene");
    list(scene.gates, `${path}gates`).forEach((gate, g) => {
      const at = `${path}gates/${g}/`;
      text(gate, at, "engine", "quantity", "metric", "mask", "reason");
      numeric(gate, at, "value", "maximum");
      need(VERDICTS.includes(gate.verdict), `${at}verdict`, `is not a verdict: ${gate.verdict}`);
      need(gate.value === null ? gate.verdict !== "pass" : gate.verdict !== "not_measured",
        `${at}verdict`, `is ${gate.verdict} though the value is ${gate.value}`);
      need(gate.verdict !== "fail" || data.verdict !== "pass", "verdict",
        `is ${data.verdict} though ${at.slice(0, -1)} fails`);
    });
  });
  checkRanking(data, { need, text, list });
  checkSequences(data, { need, text, numeric, list, file });
  if (data.physics) checkPhysics(data, names, { need, text, numeric, list, file });
  list(data.absent ?? [],
    "absent").forEach((entry, n) => text(entry, `absent/${n}/`, "scene", "reason", "hint"));
  list(data.charts, "charts").forEach((chart, c) => {
    text(chart, `charts/${c}/`, "id", "title", "caption");
    file(chart.svg, `charts/${c}/svg`);
    need(chart.svg !== null || typeof chart.missing === "string", `charts/${c}/missing`,
      "does not say why there is no static chart");
  });
}

/** The measurement that ranks a frame, over the whole picture, or null. */
const rankingNumber = (frame) => RANKING.map(([quantity, metric]) => frame.measurements
  .find((row) => row.quantity === quantity && row.metric === metric && row.mask === "all"
    && row.value !== null)).find((row) => row) ?? null;

/** Every frame that is compared with a truth, the largest error first. */
const comparedFrames = (data) => data.scenes.filter((scene) => scene.truth).flatMap((scene) =>
  scene.frames.filter((frame) => frame.engine !== scene.truth.engine && rankingNumber(frame))
    .map((frame) => ({ scene, engine: frame.engine, found: rankingNumber(frame) })))
  .sort((a, b) => b.found.value - a.found.value);

function checkRanking(data, { need, text, list }) {
  if (data.ranking === undefined) return;
  const compared = comparedFrames(data);
  const rows = list(data.ranking, "ranking");
  need(rows.length === compared.length, "ranking",
    `has ${rows.length} frames, ${compared.length} were compared`);
  rows.forEach((row, n) => {
    const path = `ranking/${n}/`;
    text(row, path, "scene", "engine", "quantity", "metric", "mask", "cause");
    const entry = compared.find(({ scene, engine }) => scene.name === row.scene
      && engine === row.engine);
    need(entry && entry.found.value === row.value, `${path}value`,
      `is not the error of ${row.engine} in ${row.scene}`);
    const fails = data.scenes.find((scene) => scene.name === row.scene)?.gates
      .some((gate) => gate.engine === row.engine && gate.verdict === "fail");
    need(row.failing === Boolean(fails), `${path}failing`, "does not go with the gates");
    const before = rows[n - 1];
    need(!before || before.failing > row.failing || (before.failing === row.failing
      && before.value >= row.value), `${path}value`, "is larger than the one before it");
    need(row.cause !== "", `${path}cause`, "is empty");
  });
}

const isInterval = (value) => Array.isArray(value) && value.length === 2 && value.every(isNumber)
  && value[0] <= value[1];

function checkAttribution(found, path, engines, { need, text, list }) {
  if (found === null) return;
  text(found, path, "mask", "sentence");
  need(found.odd_one_out === null || engines.has(found.odd_one_out), `${path}odd_one_out`,
    `is no engine of the scene: ${found.odd_one_out}`);
  list(found.pairs, `${path}pairs`).forEach((pair, n) => {
    const at = `${path}pairs/${n}/`;
    for (const key of ["first", "second"])
      need(engines.has(pair[key]), `${at}${key}`, `is no engine of the scene: ${pair[key]}`);
    for (const key of ["mean_difference", "rms_difference", "noise_floor"])
      need(isNumber(pair[key]), `${at}${key}`, "is not a number");
    need(isInterval(pair.interval), `${at}interval`, "is not [low, high]");
    need(PAIRS.includes(pair.verdict), `${at}verdict`, `is not a verdict: ${pair.verdict}`);
    const rows = found.pairs.filter((other) => [other.first,
        other.second].includes(found.odd_one_out));
    need(rows.every((other) => other.verdict === "differ"), `${path}odd_one_out`,
      "does not differ from all others");
  });
}

function checkSequences(data, { need, text, numeric, list, file }) {
  list(data.sequences ?? [], "sequences").forEach((sequence, q) => {
    const path = `sequences/${q}/`;
    text(sequence, path, "scene", "title", "physics");
    text(sequence.reference, `${path}reference/`, "engine", "settings", "text", "status", "reason");
    numeric(sequence, path, "frames", "rate_hz", "exposure_ev");
    const counts = new Set();
    list(sequence.rows, `${path}rows`).forEach((row, r) => {
      const at = `${path}rows/${r}/`;
      text(row, at, "engine", "preset", "status", "reason", "settings");
      need(STATUSES.includes(row.status), `${at}status`, `is not a status: ${row.status}`);
      need(row.status === "rendered" || row.reason !== "", `${at}reason`,
        `does not say why: ${row.preset} ${row.status}`);
      need((row.status === "rendered") === (row.measurements.length > 0), `${at}measurements`,
        `do not go with the status ${row.status}`);
      if (row.measurements.length > 0)
        counts.add(row.measurements.map((m) => [m.quantity, m.metric, m.mask].join()).join());
      list(row.pictures, `${at}pictures`).forEach((name, n) => file(name, `${at}pictures/${n}`));
      file(row.map, `${at}map`);
    });
    need(counts.size <= 1, `${path}rows`, "do not all measure the same");
  });
}

function checkStudy(study, path, { need, text, numeric, list }) {
  if (study === null) return;
  text(study, path, "option");
  numeric(study, path, "order", "observed_order", "limit", "tolerance");
  const levels = list(study.levels, `${path}levels`);
  levels.forEach((level, n) => numeric(level, `${path}levels/${n}/`, "setting", "radiance", "noise",
      "bias", "bias_noise", "wall_s"));
  need(Number.isInteger(study.chosen) && study.chosen >= 0 && study.chosen < levels.length,
    `${path}chosen`, `is not one of the levels: ${study.chosen}`);
}

function checkPhysics(data, engines, { need, text, numeric, list, file }) {
  const { physics } = data;
  numeric(physics, "physics/", "family_alpha", "tests", "critical_z", "seconds");
  const rungs = list(physics.rungs, "physics/rungs").map((rung) => rung.name);
  const views = new Map();
  list(physics.checks, "physics/checks").forEach((check, c) => {
    const path = `physics/checks/${c}/`;
    text(check, path, "name", "rung", "what");
    need(!views.has(check.name), `${path}name`, `stands twice: ${check.name}`);
    need(rungs.includes(check.rung), `${path}rung`, `is none of the rungs: ${check.rung}`);
    views.set(check.name, list(check.views, `${path}views`));
    check.views.forEach((view, v) => {
      need(Array.isArray(view.size_px) && view.size_px.length === 2
        && view.size_px.every(Number.isInteger), `${path}views/${v}/size_px`,
        "is not [width, height]");
      numeric(view, `${path}views/${v}/`, "exposure_ev", "difference_scale");
      file(view.picture, `${path}views/${v}/picture`);
    });
  });
  list(physics.phase_functions ?? [], "physics/phase_functions").forEach((row, n) => {
    text(row, `physics/phase_functions/${n}/`, "phase", "verdict");
    numeric(row, `physics/phase_functions/${n}/`, "g", "integral", "mean_cosine",
      "sampled_mean_cosine");
    need(FINDINGS.includes(row.verdict), `physics/phase_functions/${n}/verdict`,
      `is not a verdict: ${row.verdict}`);
  });
  let tests = 0;
  list(physics.rows, "physics/rows").forEach((row, r) => {
    const path = `physics/rows/${r}/`;
    text(row, path, "check", "rung", "participant", "engine", "reason", "settings", "sentence");
    numeric(row, path, "deviation", "standard_error", "step_bound", "rounding", "z", "pixel_z_mean",
      "pixel_z_variance", "wall_s");
    need(engines.has(row.engine), `${path}engine`, `is not among the engines: ${row.engine}`);
    need(views.has(row.check), `${path}check`, `is none of the checks: ${row.check}`);
    need(STATUSES.includes(row.status), `${path}status`, `is not a status: ${row.status}`);
    need(FINDINGS.includes(row.verdict), `${path}verdict`, `is not a verdict: ${row.verdict}`);
    need(row.status === "rendered" || row.reason !== "", `${path}reason`,
      `does not say why: ${row.participant} ${row.status}`);
    need((row.deviation === null) === (row.verdict === "not_measured"), `${path}verdict`,
      `is ${row.verdict} though the deviation is ${row.deviation}`);
    tests += row.deviation !== null;
    if (row.deviation !== null) {
      need(isInterval(row.interval), `${path}interval`, "is not [low, high]");
      if (isInterval(row.interval))
        need((row.interval[0] <= 0 && row.interval[1] >= 0) === (row.verdict === "agrees"),
        `${path}interval`, `does not go with the verdict ${row.verdict}`);
      for (const kind of ["pictures", "differences"])
        need(row[kind]?.length === views.get(row.check)?.length, `${path}${kind}`,
        "are not one per view");
    }
    for (const kind of ["pictures", "differences"])
      list(row[kind], `${path}${kind}`).forEach((name, v) => file(name, `${path}${kind}/${v}`));
    const broken = BROKEN.includes(row.status) && row.status !== "interrupted";
    need(!(broken || finding(data, row) === "wrong" && isOurs(data, row.engine))
      || data.verdict === "fail", "verdict",
      `is ${data.verdict} though ${row.participant} is ${row.verdict} in ${row.check}`);
  });
  need(physics.tests === tests, "physics/tests",
    `is ${physics.tests}, there are ${tests} deviations`);
}

const isOurs = (data, name) => ["exact",
  "tracer"].includes(data.engines.find((engine) => engine.name === name)?.rung);

/** What the page must call a row of the physics suite. */
function finding(data, row) {
  if (row.verdict !== "off") return row.verdict;
  return isOurs(data,
    row.engine) ? "wrong" : row.lowered || row.look ? "gap" : row.cause ? "known" : "wrong";
}

const isRecord = (value) => typeof value === "object" && value !== null;

/** The first path at which two JSON values differ, or null. */
function difference(a, b, path = "") {
  if (!isRecord(a) || !isRecord(b)) return Object.is(a, b) ? null : path || "(the whole)";
  for (const key of new Set([...Object.keys(a), ...Object.keys(b)])) {
    const inner = difference(a[key], b[key], path ? `${path}/${key}` : key);
    if (inner !== null) return inner;
  }
  return null;
}

const lookUp = (data, path) => path.split("/").reduce((node, key) => node?.[key], data);

/** Every number of the data that a reader must be able to find on the page. */
function numbersToShow(data) {
  const paths = ["seconds", "host/cores", "host/memory_bytes"];
  if ((data.scenes ?? []).length > 0) paths.push("size_px/0", "size_px/1");
  (data.scenes ?? []).forEach((scene, s) => {
    paths.push(`scenes/${s}/exposure_ev`);
    for (const kind of ["radiance", "transmittance"]) {
      if (scene.frames.some((frame) => frame.difference?.[kind]))
        paths.push(`scenes/${s}/difference_scale/${kind}`);
    }
    scene.frames.forEach((frame, f) => {
      for (const key of COSTS) paths.push(`scenes/${s}/frames/${f}/${key}`);
      for (const key of ["render_s", "low_s", "high_s", "start_s"])
        if (isNumber(frame.speed?.[key]) && frame.measurements.some((row) => row.value !== null))
          paths.push(`scenes/${s}/frames/${f}/speed/${key}`);
      frame.measurements.forEach((row, m) => {
        if (row.value === null) return; // said in words
        paths.push(`scenes/${s}/frames/${f}/measurements/${m}/value`);
        if (row.interval) paths.push(`scenes/${s}/frames/${f}/measurements/${m}/interval/0`,
          `scenes/${s}/frames/${f}/measurements/${m}/interval/1`);
      });
      paths.push(...numbersWithin(frame.bake, `scenes/${s}/frames/${f}/bake`));
      if (!frame.study) return;
      paths.push(...["limit", "order",
          "tolerance"].map((key) => `scenes/${s}/frames/${f}/study/${key}`));
      paths.push(...numbersWithin(frame.study.levels, `scenes/${s}/frames/${f}/study/levels`));
    });
    paths.push(...numbersWithin(scene.attribution, `scenes/${s}/attribution`));
    scene.gates.forEach((_, g) => paths.push(`scenes/${s}/gates/${g}/value`,
        `scenes/${s}/gates/${g}/maximum`));
  });
  paths.push(...numbersWithin(data.progress, "progress")
    .filter((path) => data.verdict === "running" || !path.endsWith("left_s")));
  (data.sequences ?? []).forEach((sequence, q) => {
    paths.push(...["frames", "rate_hz", "exposure_ev"].map((key) => `sequences/${q}/${key}`));
    sequence.rows.forEach((row, r) =>
      row.measurements.forEach((one, m) => paths.push(
        ...["value", "against_centre_rays", ...(row.floors?.length ? ["floor", "times_floor"] : [])]
          .map((key) => `sequences/${q}/rows/${r}/measurements/${m}/${key}`))));
  });
  if (!data.physics) return paths;
  for (const key of ["family_alpha", "tests", "critical_z"]) paths.push(`physics/${key}`);
  data.physics.checks.forEach((check, c) => check.views.forEach((view, v) => {
    for (const key of ["exposure_ev", ...(view.picture ? ["difference_scale"] : [])])
      paths.push(`physics/checks/${c}/views/${v}/${key}`);
  }));
  paths.push(...numbersWithin(data.physics.phase_functions, "physics/phase_functions"));
  data.physics.rows.forEach((row, r) => {
    paths.push(...numbersWithin(row, `physics/rows/${r}`)
      .filter((path) => row.deviation !== null || !path.endsWith("/rounding")));
  });
  return paths;
}

/** The paths of all numbers inside a value of the data. */
function numbersWithin(value, path) {
  if (isNumber(value)) return [path];
  return isRecord(value) ? Object.entries(value)
    .flatMap(([key, inner]) => numbersWithin(inner, `${path}/${key}`)) : [];
}

/** Every string that must stand on the page, letter for letter. */
function stringsToShow(data) {
  const texts = [data.title, data.created_utc, data.neph_version];
  for (const engine of data.engines)
    texts.push(engine.name, engine.summary, engine.bias, ...(engine.available ? [engine.version,
        engine.device] : [engine.missing, engine.install_line]));
  for (const scene of data.scenes) {
    texts.push(scene.title, scene.physics, scene.name, scene.truth?.engine);
    for (const frame of scene.frames) texts.push(frame.reason.replace(/^cannot:\s*/, ""),
      frame.settings, ...frame.measurements.map((row) => row.unit).filter((unit) => unit !== "1"));
    for (const gate of scene.gates) texts.push(gate.reason);
    texts.push(scene.attribution?.sentence,
      ...(scene.attribution?.pairs ?? []).map((pair) => `${pair.first} − ${pair.second}`));
    for (const frame of scene.frames) if (frame.study) texts.push(frame.study.option);
  }
  for (const scene of data.scenes) for (const frame of scene.frames) texts.push(frame.note);
  const measured = new Set(data.scenes.flatMap((scene) => scene.frames)
    .flatMap((frame) => frame.measurements.filter((row) => row.value !== null)
      .map((row) => row.metric)));
  for (const metric of data.metrics ?? []) if (measured.has(metric.name)) texts.push(metric.help);
  for (const sequence of data.sequences ?? []) {
    texts.push(sequence.title, sequence.physics, sequence.reference.settings,
      sequence.reference.text);
    for (const row of sequence.rows) texts.push(row.preset, row.reason.replace(/^cannot:\s*/, ""),
      ...row.findings.map((finding) => finding.text));
  }
  for (const row of (data.ranking ?? []).slice(0, WORST_SHOWN)) texts.push(row.cause);
  for (const entry of data.absent ?? []) texts.push(entry.scene, entry.reason, entry.hint);
  const present = new Set((data.physics?.checks ?? []).map((check) => check.rung));
  for (const rung of data.physics?.rungs ?? []) if (present.has(rung.name)) texts.push(rung.title);
  for (const check of data.physics?.checks ?? [])
    texts.push(check.name, check.what.slice(1), ...check.views.map((view) => view.what?.slice(1)));
  for (const row of data.physics?.rows ?? []) texts.push(row.participant, row.settings,
    row.verdict === "off" ? row.cause : row.reason.replace(/^cannot:\s*/, ""));
  for (const chart of data.charts)
    texts.push(chart.title, chart.caption, chart.svg === null ? chart.missing : "");
  return [...new Set(texts.filter(Boolean))];
}

// ------------------------------------------------------------------------------------------ page

/** What a shown number says: its value and half a unit of its last digit. */
function read(text) {
  const plain = text.replace(/[\u202f\u00a0]/g, "").replace(/−/g, "-").replace(/^\+/, "");
  const match = /^-?\d+(?:\.(\d+))?(?:e(-?\d+))?$/.exec(plain);
  if (!match) return null;
  return { value: Number(plain),
    half: 0.5 * 10 ** (Number(match[2] ?? 0) - (match[1] ?? "").length) };
}

function checkNumbers(data, shown) {
  for (const { path, value, scale, text } of shown) {
    const truth = lookUp(data, path);
    if (truth === null || truth === undefined) {
      if (value !== "null") find(`${path}: the page shows ${text} where data.json has no number`);
      continue;
    }
    if (Number(value) !== truth) {
      find(`${path}: the page says ${value}, data.json says ${truth}`);
      continue;
    }
    const said = read(text);
    const meant = truth * scale;
    if (!said) find(`${path}: "${text}" is not a number`);
    // Half a unit of the last digit, and three digits at least (trailing zeros may be left out).
    else if (Math.abs(said.value - meant) > Math.min(said.half,
        0.0051 * Math.abs(meant)) * (1 + 1e-9))
      find(`${path}: the page reads ${text}, the value is ${meant}`);
  }
  const paths = new Set(shown.map(({ path }) => path));
  for (const path of numbersToShow(data)) if (!paths.has(path))
    find(`${path}: not shown anywhere on the page`);
}

/** Frames and rows in a report, of which a verdict says that none was lost. */
const resultCount = (data) => data.scenes.flatMap((scene) => scene.frames)
  .length + (data.physics?.rows ?? []).length;

function checkCounts(data, counted) {
  const gates = data.scenes.flatMap((scene) => scene.gates);
  const truth = {
    absent: (data.absent ?? []).length,
    "counts.expected": data.counts?.expected,
    "counts.reported": resultCount(data),
    "counts.compared": data.counts?.compared,
    gates: gates.length,
    "gates.fail": gates.filter((gate) => gate.verdict === "fail").length,
    "gates.not_measured": gates.filter((gate) => gate.verdict === "not_measured").length,
    "frames.ungated": data.scenes.flatMap((scene) => scene.frames.filter((frame) =>
      frame.measurements.some((row) => row.quantity === "radiance" && row.metric === "rel_bias"
        && row.mask === "all" && row.value !== null)
      && !scene.gates.some((gate) => gate.engine === frame.engine
        && gate.quantity === "radiance"))).length,
    "frames.broken": data.scenes.flatMap((scene) => scene.frames)
      .filter((frame) => BROKEN.includes(frame.status)).length,
    "frames.over_budget": data.scenes.flatMap((scene) => scene.frames)
      .filter((frame) => frame.status === "over_budget").length,
  };
  const rows = data.physics?.rows ?? [];
  for (const [name, side] of [["ours", true], ["others", false]]) {
    const list = rows.filter((row) => isOurs(data, row.engine) === side
      && row.verdict !== "not_measured");
    truth[`physics.${name}`] = list.length;
    for (const state of ["agrees", "known", "gap", "wrong"])
      truth[`physics.${name}.${state}`] = list.filter((row) => finding(data, row) === state).length;
  }
  for (const row of rows) {
    const measured = rows.filter((other) => other.participant === row.participant
      && other.verdict !== "not_measured");
    truth[`physics.of/${row.participant}`] = measured.length;
    truth[`physics.of/${row.participant}/agrees`] = measured.filter((other) =>
      other.verdict === "agrees").length;
  }
  truth["physics.open"] = rows.filter((row) => row.verdict === "not_measured").length;
  for (const { what, value, text } of counted) {
    if (truth[what] === undefined)
      find(`the page counts "${what}", which this check does not know`);
    else if (Number(value) !== truth[what] || text !== String(truth[what]))
      find(`the page counts ${text} ${what}, the data have ${truth[what]}`);
  }
}

/** Runs in the page: all that the checks need to see of it. */
function survey() {
  const all = (selector) => [...document.querySelectorAll(selector)];
  const attribute = (element, name) => element.getAttribute(name);

  // Digits in a numeric cell that belong to no number of the data.
  const stray = [];
  for (const cell of all("td.num")) {
    const walker = document.createTreeWalker(cell, NodeFilter.SHOW_TEXT);
    for (let node = walker.nextNode(); node; node = walker.nextNode()) {
      if (/\d/.test(node.data)
        && !node.parentElement.closest("[data-path], [data-derived], .reason, .unit"))
        stray.push(node.data);
    }
  }

  const levels = all("h1, h2, h3, h4, h5, h6").map((heading) => Number(heading.tagName[1]));
  const ids = all("[id]").map((element) => element.id);
  return {
    title: document.title,
    text: document.querySelector("main").textContent,
    numbers: all("[data-path]")
      .map((e) => ({ path: attribute(e, "data-path"), value: attribute(e, "data-value"),
          scale: Number(attribute(e, "data-scale") ?? 1), text: e.textContent.trim() })),
    counted: all("[data-derived]").map((e) => ({ what: attribute(e, "data-derived"),
          value: attribute(e, "data-value"), text: e.textContent.trim() })),
    stray,
    heat: all(".heat tbody tr").map((row) => ({ scene: attribute(row, "data-scene"),
      cells: [...row.querySelectorAll("td")].map((cell) => ({
        engine: attribute(cell, "data-engine"), text: cell.textContent,
        value: cell.querySelector("[data-value]")?.dataset.value ?? null,
        heat: [...cell.classList].find((name) => /^heat-\d$/.test(name)) ?? null })) })),
    heatSwatches: all(".heat-key .swatch").length,
    named: document.querySelector(".verdict .worst")?.parentElement.textContent ?? "",
    worst: all("ol.worst > li").map((e) => e.textContent),
    bareTimes: all("td [data-path$='_s']:not([data-value='null'])").filter((e) =>
      !e.closest("td").querySelector(".unit")).map((e) => attribute(e, "data-path")),
    mapsWithoutKey: all("img.pixels").filter((e) => /_difference|_seen/.test(attribute(e, "src"))
      && !e.closest("figure")?.querySelector(".map-key .bar")).map((e) => attribute(e, "src")),
    keysWithoutBeyond: all(".map-key").filter((e) => !e.querySelector(".beyond .swatch")).length,
    images: all("img").map((e) => ({
      src: attribute(e, "src"), alt: attribute(e, "alt"), width: e.naturalWidth,
      height: e.naturalHeight, pixels: e.classList.contains("pixels"),
      shown: e.getBoundingClientRect().width * devicePixelRatio,
      rendering: getComputedStyle(e).imageRendering,
    })),
    figures: all(".chart-figure").map((e) => ({ state: attribute(e, "data-state"),
          marks: e.querySelectorAll(".live svg .mark-group path, .live svg .mark-group text")
          .length, note: e.querySelector(".upgrade")?.textContent })),
    scripts: all("script")
      .map((e) => attribute(e, "src") ?? `inline: ${e.textContent.slice(0, 60)}`),
    handlers: all("*").filter((e) => e.getAttributeNames().some((name) => name.startsWith("on")))
      .map((e) => e.outerHTML.slice(0, 120)),
    unexpected: all("iframe, object, embed, base, form:not(.vega-bindings), main style, main link, "
      + "main meta").map((e) => e.outerHTML.slice(0, 120)),
    links: all("a[href]").map((e) => attribute(e, "href")),
    brokenAnchors: all("a[href^='#']").map((e) => attribute(e, "href").slice(1))
      .filter((id) => !document.getElementById(id)),
    repeatedIds: ids.filter((id, n) => ids.indexOf(id) !== n),
    skippedLevels: levels.filter((level, n) => level > (levels[n - 1] ?? 0) + 1).length,
    heads: levels.filter((level) => level === 1).length,
    nameless: all("input, button, [role=region], [role=img]").filter((e) => !attribute(e,
        "aria-label") && !e.labels?.length && !e.textContent.trim()).length,
    unscoped: all("main th:not([scope])").filter((e) => !e.closest(".tooltip")).length,
    width: document.documentElement.scrollWidth,
    window: window.innerWidth,
    data: window.NEPH_REPORT,
  };
}

const look = async (page) => ({ ...await page.evaluate(survey),
  faint: await page.evaluate(faintTexts) });

async function open(browser, folder, where, options) {
  const context = await browser.newContext({ viewport: { width: 1280, height: 900 }, ...options });
  await context.setOffline(true);
  const page = await context.newPage();
  // The page without scripts names a chart that a report may lack; its alternative text says so.
  if (!existsSync(join(folder, "charts/speed_accuracy.svg")))
    await page.route("**/charts/speed_accuracy.svg",
    (route) => route.fulfill({ contentType: "image/svg+xml",
        body: '<svg xmlns="http://www.w3.org/2000/svg"/>' }));
  page.on("console", (message) => {
    if (["error", "warning"].includes(message.type()))
      find(`${where}: console ${message.type()}: ${message.text()}`);
  });
  page.on("pageerror", (error) => find(`${where}: script error: ${error.message}`));
  page.on("dialog", (dialog) => {
    find(`${where}: a dialog opened: ${dialog.message()}`);
    dialog.dismiss();
  });
  page.on("popup", () => find(`${where}: a window opened`));
  page.on("requestfailed", (request) =>
    find(`${where}: could not load ${request.url().replace(pathToFileURL(folder).href, "")}`));
  page.on("request", (request) => {
    if (!/^(file|data|blob):/.test(request.url()))
      find(`${where}: asked the network for ${request.url()}`);
  });
  await page.goto(address(folder));
  if (options.javaScriptEnabled !== false) {
    await page.waitForSelector("html[data-ready=yes]",
      { timeout: 60000 }).catch(() => find(`${where}: the page did not become ready`));
  }
  return { context, page };
}

/** What must hold in each window. */
function checkWindow(where, seen) {
  if (seen.width > seen.window)
    find(`${where}: the page scrolls sideways (${seen.width} px in a window of ${seen.window} px)`);
  for (const text of seen.faint) find(`${where}: too little contrast: ${text}`);
  for (const image of seen.images) {
    if (image.width === 0) find(`${where}: ${image.src} does not show`);
    if (!image.pixels || image.width === 0) continue;
    if (image.rendering !== "pixelated") find(`${where}: ${image.src} is smoothed`);
    const scale = image.shown / image.width;
    if (Math.abs(scale - Math.round(scale)) > 1e-3)
      find(`${where}: ${image.src} is shown at ${scale.toFixed(4)} device pixels per pixel`);
  }
}

function checkContent(data, seen) {
  const apart = difference(data, JSON.parse(JSON.stringify(seen.data ?? null)));
  if (apart !== null) find(`data.js and data.json differ at ${apart}`);
  checkNumbers(data, seen.numbers);
  checkFront(data, seen);
  checkCounts(data, seen.counted);
  for (const text of seen.stray)
    find(`a number that is not from the data stands in a table: "${text}"`);
  for (const text of stringsToShow(data)) if (!seen.text.includes(text))
    find(`not shown on the page: "${text}"`);

  const sources = new Set(seen.images.map((image) => image.src));
  const expected = new Set();
  const sizes = new Map(); // of pictures with a size of their own
  for (const scene of data.scenes) for (const frame of scene.frames)
    for (const path of [frame.picture, frame.difference?.radiance,
      frame.difference?.transmittance]) {
      if (!path) continue;
      expected.add(path);
      if (scene.size_px) sizes.set(path, scene.size_px);
    }
  for (const check of data.physics?.checks ?? []) {
    check.views.forEach((view, v) => {
      const own = data.physics.rows.filter((row) => row.check === check.name);
      for (const path of [view.picture,
          ...own.flatMap((row) => [row.pictures?.[v], row.differences?.[v]])]) {
        if (!path) continue;
        expected.add(path);
        sizes.set(path, view.size_px);
      }
    });
  }
  for (const sequence of data.sequences ?? []) {
    for (const row of sequence.rows) {
      for (const path of [...row.pictures, row.map]) {
        if (!path) continue;
        expected.add(path);
        sizes.set(path, sequence.size_px);
      }
    }
  }
  for (const path of expected) if (!sources.has(path))
    find(`${path} is in the data and not on the page`);
  for (const chart of data.charts) if (chart.svg) expected.add(chart.svg);
  for (const image of seen.images) {
    if (!expected.has(image.src)) find(`an image that the data do not name: ${image.src}`);
    if (image.alt === null) find(`${image.src} has no alternative text`);
    const size = sizes.get(image.src) ?? data.size_px;
    if (image.pixels && image.width > 0 && (image.width !== size[0] || image.height !== size[1]))
      find(`${image.src} has ${image.width} x ${image.height} pixels, not ${size.join(" x ")}`);
  }

  const interactive = data.interactive !== false;
  if (seen.figures.length !== data.charts.length)
    find(`${seen.figures.length} charts on the page, ${data.charts.length} in the data`);
  seen.figures.forEach((figure, n) => {
    const wanted = interactive && data.charts[n]?.spec ? "interactive" : "static";
    if (figure.state !== wanted)
      find(`chart ${data.charts[n]?.id} is ${figure.state}, not ${wanted}: ${figure.note}`);
    if (wanted === "interactive" && figure.marks === 0)
      find(`chart ${data.charts[n].id} drew no marks`);
  });

  if (data.screen && !seen.links.includes(data.screen))
    find(`no link leads to ${data.screen}`);
  for (const scene of data.scenes)
    if (scene.viewer && !seen.links.includes(scene.viewer))
      find(`no link leads to the viewer ${scene.viewer}`);
  const known = /^(data|page|report)\.js$|^vendor\/vega(-lite|-embed)?\.min\.js$/;
  for (const script of seen.scripts) if (!known.test(script)) find(`an unknown script: ${script}`);
  for (const link of seen.links)
    if (!/^#|^data\.json$|^vendor\/LICENSES\.txt$|^charts\/[\w.-]+$/.test(link)
      && !/^(view\/[\w.-]+|screen)\/index\.html$/.test(link))
    find(`an unexpected link: ${link}`);
  for (const html of [...seen.handlers, ...seen.unexpected])
    find(`markup that is none of the page's: ${html}`);
  for (const id of seen.brokenAnchors) find(`a link to nowhere: #${id}`);
  for (const id of seen.repeatedIds) find(`an id that stands twice: ${id}`);
  if (seen.heads !== 1) find(`${seen.heads} first-level headings`);
  if (seen.skippedLevels > 0) find("the headings skip a level");
  if (seen.nameless > 0) find(`${seen.nameless} controls or regions without a name`);
  if (seen.unscoped > 0) find(`${seen.unscoped} table headings without a scope`);
}

const isFalling = (list) => list.every((value, n) => n === 0 || list[n - 1] >= value);

/** The first screen: every scene by every engine, the worst first, and named. */
function checkFront(data, seen) {
  const compared = comparedFrames(data);
  const largest = (holds) => Math.max(-1, ...compared.filter(holds)
    .map(({ found }) => found.value));
  const names = seen.heat.map(({ scene }) => scene);
  for (const scene of data.scenes)
    if (names.filter((name) => name === scene.name).length !== 1)
      find(`the heat map does not have scene ${scene.name} once`);
  for (const { scene, cells } of seen.heat) {
    for (const engine of data.engines)
      if (cells.filter((cell) => cell.engine === engine.name).length !== 1)
        find(`the heat map does not have engine ${engine.name} once in scene ${scene}`);
    for (const { found, ...entry } of compared.filter((one) => one.scene.name === scene)) {
      const cell = cells.find(({ engine }) => engine === entry.engine);
      if (Number(cell?.value) !== found.value || cell?.heat === null)
        find(`the heat map has no error of ${entry.engine} in scene ${scene}`);
      else if (found.metric === "rel_rmse" && !cell.text.includes("%"))
        find(`the heat map has an error without its unit: ${entry.engine} in scene ${scene}`);
    }
  }
  if (!isFalling(names.map((name) => largest(({ scene }) => scene.name === name)))
    || !isFalling((seen.heat[0]?.cells ?? []).map(({ engine }) =>
      largest((entry) => entry.engine === engine))))
    find("the heat map is not sorted by RMSE");
  if (seen.heat.length > 0 && seen.heatSwatches < 3) find("the heat map has no legend");
  const [worst] = compared;
  if (worst && !(seen.named.includes(worst.engine) && seen.named.includes(worst.scene.title)))
    find(`the verdict does not name the worst: ${worst.engine} in ${worst.scene.title}`);
  const ranking = (data.ranking ?? []).slice(0, WORST_SHOWN);
  if (seen.worst.length !== ranking.length)
    find(`${seen.worst.length} frames are called the worst, not ${ranking.length}`);
  ranking.forEach((row, n) => {
    if (!seen.worst[n]?.includes(row.engine) || !seen.worst[n].includes(row.cause))
      find(`number ${n + 1} of the worst is not ${row.engine} in ${row.scene}, with its cause`);
  });
  for (const path of seen.bareTimes) find(`a time without a unit: ${path}`);
  for (const path of seen.mapsWithoutKey) find(`a map without its scale: ${path}`);
  if (seen.keysWithoutBeyond > 0)
    find(`${seen.keysWithoutBeyond} scales do not say what colours beyond them mean`);
}

/** With all that is folded open: still as wide as the window, also each table, and to be read. */
async function checkUnfolded(page, where) {
  await page.evaluate(async () => {
    for (const details of document.querySelectorAll("details")) details.open = true;
    await new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));
  });
  const { wide, width, window } = await page.evaluate(() => ({
    wide: [...document.querySelectorAll(".scroll")].filter((e) => e.scrollWidth > e.clientWidth + 1)
      .map((e) => `${e.getAttribute("aria-label")} (${e.scrollWidth} in ${e.clientWidth} px)`),
    width: document.documentElement.scrollWidth, window: innerWidth }));
  for (const text of wide) find(`${where}: wider than its place: ${text}`);
  if (width > window) find(`${where}, unfolded: the page scrolls sideways (${width} px)`);
  for (const text of await page.evaluate(faintTexts))
    find(`${where}, unfolded: too little contrast: ${text}`);
  const bare = await page.evaluate(() => [...document.querySelectorAll(".scroll tbody tr")]
    .filter((row) => row.querySelector("[data-value='null'], .absent")
      && ![...row.querySelectorAll("td [data-value], td")].some((e) =>
        /\d/.test(e.textContent) || e.matches(".words") && e.textContent.trim()))
    .map((row) => row.querySelector("th")?.textContent));
  for (const head of bare) find(`${where}: a row without a number: ${head}`);
}

/** The moving parts: slider, pointer, click, tooltip. */
async function checkMoves(page, where) {
  const stack = page.locator(".stack.wipes").first();
  if (await stack.count()) {
    const slider = page.locator(".wipe input").first();
    const wipe = () => stack.evaluate((element) =>
      parseFloat(element.style.getPropertyValue("--wipe") || "0"));
    await slider.focus();
    await page.keyboard.press("End");
    if ((await wipe()) !== 100) find(`${where}: the slider does not wipe`);
    await page.keyboard.press("Home");
    await stack.scrollIntoViewIfNeeded();
    const box = await stack.boundingBox();
    await page.mouse.move(box.x + box.width / 4, box.y + box.height / 2);
    if (Math.abs((await wipe()) - 25) > 1) find(`${where}: the pointer does not wipe`);
    await page.mouse.move(0, 0);
    if ((await wipe()) !== 0)
      find(`${where}: the picture does not come back when the pointer leaves`);
    await stack.click({ position: { x: 5, y: 5 } });
    if ((await wipe()) !== 100) find(`${where}: a click does not swap`);
    await stack.click({ position: { x: 5, y: 5 } });
  }
  const mark = page.locator(".live .mark-symbol.role-mark path").first();
  if (await mark.count()) {
    await mark.hover({ force: true });
    const text = await page.locator(".tooltip").textContent({ timeout: 5000 }).catch(() => "");
    if (!text) find(`${where}: a mark of a chart shows no numbers when pointed at`);
    await page.mouse.move(0, 0);
  }
}

async function checkPage(folder, data, { quick, screenshots }) {
  const keep = async (page, name) => {
    if (screenshots)
      await page.screenshot({ path: join(screenshots, `${name}.png`), fullPage: true });
  };
  await browse(async (browser) => {
    const wide = await open(browser, folder, "page", { colorScheme: "light" });
    const seen = await look(wide.page);
    checkContent(data, seen);
    checkWindow("page", seen);
    await keep(wide.page, "light");
    await checkUnfolded(wide.page, "page");
    await checkAccess(wide.page, "page");
    await checkMoves(wide.page, "page");
    await wide.page.setViewportSize({ width: 390, height: 844 });
    await checkUnfolded(wide.page, "page of 390 px");
    await wide.page.setViewportSize({ width: 1280, height: 900 });
    if (!quick) {
      await wide.page.emulateMedia({ media: "print" });
      const hidden = await wide.page.evaluate(() => {
        for (const details of document.querySelectorAll("details")) details.open = false;
        return [...document.querySelectorAll("details > :not(summary)")]
          .filter((e) => !e.checkVisibility({ contentVisibilityAuto: true })).length;
      });
      if (hidden > 0) find(`print without its events: ${hidden} folded parts are hidden`);
      await wide.page.evaluate(() => window.dispatchEvent(new Event("beforeprint")));
      if (await wide.page.locator("details:not([open])").count())
        find("print: folded parts stay folded");
      await wide.page.pdf({ format: "A4", preferCSSPageSize: true,
          ...(screenshots ? { path: join(screenshots, "print.pdf") } : {}) });
    }
    await wide.context.close();
    if (quick) return;

    for (const [where, options] of [
      ["dark", { colorScheme: "dark" }],
      ["narrow", { colorScheme: "light", viewport: { width: 390, height: 844 },
          deviceScaleFactor: 3, hasTouch: true }],
      ["between",
        { colorScheme: "dark", viewport: { width: 820, height: 1180 }, deviceScaleFactor: 1.25 }],
    ]) {
      const { context, page } = await open(browser, folder, where, options);
      checkWindow(where, await look(page));
      if (options.colorScheme === "dark") {
        const bright = await page.evaluate(() => [...document.querySelectorAll(".chart-figure"
          + " .frame")].filter((e) => getComputedStyle(e).filter === "none").length);
        if (bright > 0) find(`${where}: ${bright} charts stay white`);
      }
      await keep(page, where);
      await checkUnfolded(page, where);
      if (where !== "between") await checkAccess(page, where);
      await context.close();
    }

    const still = await open(browser, folder, "without scripts", { javaScriptEnabled: false });
    const words = await still.page.locator("main").innerText();
    if (!words.includes("data.json"))
      find("without scripts: the page does not say where the numbers are");
    if (existsSync(join(folder, "charts/speed_accuracy.svg"))
      && !(await still.page.locator("main img").evaluate((image) => image.naturalWidth)))
      find("without scripts: the chart does not show");
    await still.context.close();
  });
}

// ------------------------------------------------------------------------------------------ main

function checkFiles(folder) {
  for (const name of ["index.html", "report.css", "page.js", "report.js", "data.json", "data.js"])
    if (!existsSync(join(folder, name))) find(`${name} is missing from ${folder}`);
}

/** Data that can be held against the page; null: they are not there or have another form. */
function readData(folder) {
  if (!existsSync(join(folder, "data.json"))) return null;
  try {
    const data = readJson(folder, "data.json");
    checkForm(data, folder);
    if (data.interactive !== false && (data.charts ?? []).some((chart) => chart.spec))
      for (const name of ["vega.min.js", "vega-lite.min.js", "vega-embed.min.js", "LICENSES.txt"])
        if (!existsSync(join(folder, "vendor", name)))
          find(`vendor/${name} is missing; without the bundle write "interactive": false`);
    return data;
  } catch (error) {
    find(`data.json cannot be checked: ${error.message}`);
    return null;
  }
}

const options = readArguments(
  "node check_report.mjs [--data | --quick] [--screenshots DIR] REPORT_DIR", 1, ["data", "quick"]);
const [folder] = options.places;

await conclude(folder, SHOWN_MOST, async () => {
  checkFiles(folder);
  const data = readData(folder);
  if (data && !options.data && existsSync(join(folder, "index.html")))
    await checkPage(folder, data, options);
});
