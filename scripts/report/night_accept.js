// SPDX-License-Identifier: MIT
//
// Accepting changes from the page of a nightly run. From disk the page shows the command, with a
// button that copies it. Served by `neph serve` it asks that for the state of the run
// (harness/serve/approval.h) and has a form for each change as well.
(function () {
  "use strict";

  const { el, small, signed, fact, unique } = window.NephPage;
  const ASK = "../approval"; // of the server, from the folder of the page
  // Findings of which a series can be accepted.
  const KINDS = ["worse", "worse elsewhere", "better", "moved", "missing", "lost", "blank picture"];

  /** The series of a group of findings that can be accepted. */
  const seriesOf = (group) => unique(group.filter((finding) => finding.metric
    && finding.kind !== "mean" && KINDS.includes(finding.found)).map(({ series }) => series));

  /** The text as one word of a shell. */
  const quoted = (text) => (/^[\w./:=@+-]+$/.test(text) ? text
    : `'${text.replaceAll("'", "'\\''")}'`);

  /** The command of an acceptance; it is refused until a reason is written into it. */
  const command = (night, series) => ["neph baseline accept", `--night ${night.night}`,
    night.output && `-o ${quoted(night.output)}`, ...series.filter((name) => name !== "*")
      .map(quoted), "--why \"\""].filter((word) => word).join(" ");

  // ------------------------------------------------------------------------------------- clipboard

  function select(element) {
    const range = document.createRange();
    range.selectNodeContents(element);
    const selection = window.getSelection();
    selection.removeAllRanges();
    selection.addRange(range);
  }

  /** Copies the text of an element; where the browser forbids that, it is left selected. */
  async function copy(element, said) {
    let copied = false;
    try {
      await navigator.clipboard.writeText(element.textContent);
      copied = true;
    } catch {
      select(element);
      copied = document.execCommand("copy");
    }
    said.textContent = copied ? " copied" : " selected: copy it with the keys of your system";
  }

  /** A row of facts: a command with a button that copies it. */
  function copied(name, text) {
    const code = el("code", null, text);
    const said = el("span", { class: "small", role: "status" });
    const button = el("button", { type: "button", "aria-label": `Copy the command: ${name}` },
      "Copy");
    button.addEventListener("click", () => copy(code, said));
    return fact(name, [code, " ", button, said]);
  }

  // ------------------------------------------------------------------------------------------ form

  const places = []; // {box, series, title}: where forms stand
  let state = null; // the last answer of the server

  /** An empty box, which gets the form of these series when the page is served. */
  function place(series, title) {
    if (series.length === 0) return null;
    const box = el("div", { class: "accept", "data-series": series.join("\n") });
    places.push({ box, series, title });
    return box;
  }

  const acceptanceOf = (series) => {
    const last = series.map((name) => state.acceptances.findLast((one) =>
      one.series === name || one.series === "*"));
    return last.every((one) => one) ? last.at(-1) : null;
  };

  function show({ box, series, title }) {
    const done = acceptanceOf(series);
    box.replaceChildren(done
      ? el("p", { class: "accepted", tabindex: "-1" }, signed("✓", "accepted", "pass-word"),
        ` by ${done.who}, ${done.when_utc}: ${done.why}`)
      : form({ box, series, title }));
  }

  const showAll = () => places.forEach(show);

  async function ask(options) {
    const answer = await fetch(ASK, { cache: "no-store", ...options });
    const json = await answer.json();
    if (!answer.ok) throw new Error(json.error ?? `the server answers ${answer.status}`);
    return json;
  }

  async function accept({ box, series, title }, why, said) {
    said.textContent = "…";
    try {
      state = await ask({ method: "POST", headers: { "Content-Type": "application/json" },
        body: JSON.stringify({ nonce: state.nonce, night: state.night, series, why }) });
    } catch (error) {
      said.textContent = `Not accepted: ${error.message}.`;
      return;
    }
    showAll();
    box.querySelector(".accepted")?.focus();
  }

  function form(where) {
    const reason = el("input", { type: "text", required: "", maxlength: "1000",
      autocomplete: "off" });
    const said = el("p", { class: "small", role: "status" });
    const made = el("form", null, el("label", null, "Reason ", reason),
      el("button", { type: "submit" }, "Accept"), said);
    made.addEventListener("submit", (event) => {
      event.preventDefault();
      if (reason.value.trim()) accept(where, reason.value.trim(), said);
      else said.textContent = "Why is it accepted? A reason is needed.";
    });
    return el("details", null, el("summary", null, `Accept ${where.title} as the baseline`), made,
      small("Later runs are compared with this run. Nothing is overwritten."));
  }

  /** Fills the places when the page is served, and of the last finished run. */
  async function start(night) {
    if (!location.protocol.startsWith("http") || night.state !== "finished") return;
    try {
      state = await ask({});
    } catch {
      return; // another server: the commands remain
    }
    if (state.format === "neph-approval-1" && state.night === night.night) showAll();
    document.documentElement.dataset.approval = "yes";
  }

  window.NephAccept = { seriesOf, command, copied, place, start, quoted };
})();
