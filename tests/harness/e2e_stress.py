#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""`neph validate --suite stress` as a user runs it: verdicts, failure of a run, reuse, refused
arguments, and planted faults that it must find. NEPH_STRESS_TIER=full plants all of them."""
import json
import os
import pathlib
import re
import shutil
import signal
import subprocess
import tempfile
import unittest

import neph_case
import night
from neph_case import ROOT, VALIDATED, NephCase

FULL = os.environ.get("NEPH_STRESS_TIER", os.environ.get("NEPH_FAILURE_TIER")) == "full"
MUTATIONS = json.loads((ROOT / "tests/harness/stress_mutations.json").read_text())
FAULT = "fixed+override=parallel"


def neph(*arguments, **environment):
    return neph_case.run(*arguments, surroundings=VALIDATED, timeout_s=None if FULL else 300,
                         **environment)


def suite(folder, *arguments, **environment):
    return neph("validate", "--suite", "stress", "-q", "-o", folder, *arguments, **environment)


def cells(done):
    """{(scene, measure, over, preset or engine): result} of its file."""
    return {(r["scene"], r["measure"], r["over"], r["column"]): r
            for r in json.loads(done.stdout)["results"] if r["point"] == ""}


def page_of(folder):
    """The data of the page."""
    return json.loads((folder / "report/data.json").read_text())


def data_of(folder, *own):
    """A copy of the project's data folder in which the files `own` may be rewritten."""
    data = folder / "data"
    for path in [ROOT / "scripts", ROOT / "renderer/blue_noise.png", *(ROOT / "scenes").rglob("*")]:
        place = data / path.relative_to(ROOT)
        if path.is_dir() and path.name != "scripts":
            place.mkdir(parents=True, exist_ok=True)
        elif str(path.relative_to(ROOT)) not in own:
            place.parent.mkdir(parents=True, exist_ok=True)
            place.symlink_to(path)
    return data


def data_with(folder, expectations):
    """A copy with other expectations."""
    name = "scenes/studies/stress_expectations.json"
    data = data_of(folder, name)
    (data / name).write_text(json.dumps(
        {"format": "neph-failure-expectations-1", "expectations": expectations}))
    return data


def data_planted(folder, mutation):
    """A copy with an injected fault in a scenario, or with other words in its file."""
    name = f"scenes/stress/{mutation['scene']}.yaml"
    data = data_of(folder, name)
    text = (ROOT / name).read_text()
    for old, new in mutation.get("change", {}).items():
        assert old in text, f"{name} does not say {old!r}"
        text = text.replace(old, new)
    if "inject" in mutation:
        text += f"inject: {json.dumps(mutation['inject'])}\n"
    (data / name).write_text(text)
    return data


def expectation(kind, preset, measure):
    return {"scene": "fence_tiles", "presets": [preset], "measure": measure, "is": kind,
            "reason": "because of the test"}


# One store for all tests.
TEMPORARY = tempfile.TemporaryDirectory()


class Runs(unittest.TestCase):
    """Two scenarios with a preset and a planted fault, by two processes; later tests only read."""

    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(TEMPORARY.name)
        cls.words = ["--only", "fence_tiles", "--only", "fog_none", "--preset", "fixed",
                     "--preset", FAULT]
        cls.done = suite(cls.folder, *cls.words, "--jobs", "2", "--json")
        cls.written = json.loads((cls.folder / "stress.json").read_text())  # before other runs

    def entries(self):
        return {path: path.stat().st_mtime_ns for path in (self.folder / "store/frames").iterdir()}

    def with_expectations(self, *expectations, words=None):
        """The same run, entirely from the store, with other expectations."""
        before = self.entries()
        with tempfile.TemporaryDirectory() as folder:
            data = data_with(pathlib.Path(folder), expectations)
            done = suite(self.folder, *(words or self.words), "--json", NEPH_DATA_DIR=str(data))
        self.assertEqual(self.entries(), before)
        return done

    def test_a_planted_fault_fails_where_the_preset_passes(self):
        self.assertEqual(self.done.returncode, 1, self.done.stderr)
        found = cells(self.done)
        self.assertEqual(found["fence_tiles", "error", "all", "fixed"]["verdict"], "pass")
        self.assertEqual(found["fence_tiles", "error", "all", FAULT]["verdict"], "fail")
        for preset in ("fixed", FAULT):
            self.assertEqual(found["fog_none", "error", "all", preset]["value"], 0.0)
            self.assertEqual(found["fog_none", "bad_values", "all", preset]["value"], 0.0)

    def test_static_scenes_have_no_floor(self):
        for found in cells(self.done).values():
            self.assertEqual((found["floor_column"], found["floor"], found["times_floor"]),
                             (None, None, None))

    def test_comparisons_are_counted(self):
        document = json.loads(self.done.stdout)
        verdicts = [r["verdict"] for r in document["results"]]
        self.assertEqual(document["compared"], len(verdicts))
        self.assertEqual(document["counts"], {v: verdicts.count(v) for v in document["counts"]})
        self.assertEqual(self.written["results"], document["results"])

    def test_the_table_for_people(self):
        before = self.entries()
        done = suite(self.folder, *self.words)
        self.assertEqual((done.returncode, self.entries()), (1, before), done.stderr)
        for word in ("period_4/all", "FAIL", "symptom: all gaps blink", "verdict: fail",
                     f"{json.loads(self.done.stdout)['compared']} comparisons in 2 scenarios"):
            self.assertIn(word, done.stdout)
        self.assertIn("stress_expectations.json", done.stderr)
        # The worst first, the page at the end.
        lines = done.stdout.splitlines()
        self.assertIn("FAIL", lines[1])
        self.assertEqual(lines[-1], f"report: {self.folder}/report/index.html")
        self.assertTrue((self.folder / "report/index.html").exists())

    def test_the_page_has_evidence_and_commands(self):
        suite(self.folder, *self.words)
        page = page_of(self.folder)
        self.assertEqual((page["state"], page["verdict"]), ("finished", "fail"))
        failing = {(r["scene"], r["column"]) for r in page["results"]
                   if r["verdict"] in ("fail", "known_fail", "flake", "unexpected_pass")}
        shown = {(e["scene"], e["column"]): e for e in page["evidence"]}
        self.assertEqual(set(shown), failing)
        fault = shown["fence_tiles", FAULT]
        self.assertEqual((fault["slice_count"], fault["flip_count"]), (32, 4))
        for name in ("worst", "worst_reference", "worst_difference", "slice", "slice_reference",
                     "slice_difference", "flip_0", "flip_3", "flip_reference_0",
                     "seen_contrast_radiance"):
            self.assertIn(f"{name}.png", fault["pictures"])
        for item in page["evidence"]:
            for name in item["pictures"]:
                self.assertEqual((self.folder / "report" / item["folder"] / name).read_bytes()[:4],
                                 b"\x89PNG")
        sizes = sum(path.stat().st_size for path in (self.folder / "report/images").rglob("*.png"))
        self.assertEqual(page["pictures"]["bytes"], sizes)
        self.assertIn("neph render fog_none -e realtime --preset fixed ",
                      page["commands"]["fog_none"]["fixed"])

    def test_evidence_images_are_selected(self):
        before = self.entries()
        for word, scenes in (("none", set()), ("changed", {("fence_tiles", FAULT)})):
            suite(self.folder, *self.words, "--pictures", word)
            self.assertEqual({(e["scene"], e["column"]) for e in page_of(self.folder)["evidence"]},
                             scenes)
        self.assertEqual(self.entries(), before)

    def test_known_failures_pass_and_a_known_failure_that_passes_fails(self):
        known = [expectation("fails", "fixed", "period_4")]
        words = ["--only", "fence_tiles", "--preset", "fixed"]
        done = self.with_expectations(*known, words=words)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        found = cells(done)["fence_tiles", "period_4", "all", "fixed"]
        self.assertEqual((found["verdict"], found["why"]), ("known_fail", "because of the test"))
        done = self.with_expectations(*known, expectation("fails", "fixed", "error"), words=words)
        self.assertEqual(done.returncode, 1)
        self.assertEqual(cells(done)["fence_tiles", "error", "all", "fixed"]["verdict"],
                         "unexpected_pass")

    def test_nothing_compared_is_a_failure(self):
        skips = [expectation("skips", "fixed", m) for m in ("error", "period_4", "bad_values")]
        done = self.with_expectations(*skips, words=["--only", "fence_tiles", "--preset", "fixed"])
        self.assertEqual((done.returncode, json.loads(done.stdout)["compared"]), (1, 0))
        self.assertIn("nothing was compared", done.stderr)

    def test_bad_values_are_counted_on_the_device(self):
        before = self.entries()
        done = suite(self.folder, "--on-device", "--only", "ray_bad", "--preset", "fixed",
                     "--preset", "fixed+validity=off", "--preset", "off", "--size", "32x18",
                     "--json")
        self.assertEqual((done.returncode, self.entries()), (1, before), done.stderr)
        found = {r["column"]: r for r in json.loads(done.stdout)["results"]}
        self.assertEqual(found["fixed"]["value"], 0.0)
        self.assertEqual(found["off"]["value"], 0.0)  # which has no images except its frame
        self.assertGreater(found["fixed+validity=off"]["value"], 0.0)

    def test_unstored_frames_are_rendered_once(self):
        """By any process: each prints one line for each of its results."""
        done = neph("validate", "--suite", "stress", "-o", self.folder, "--on-device", "--only",
                    "ray_bad", "--only", "fog_none", "--preset", "fixed", "--size", "32x18",
                    "--jobs", "2", "--json")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(json.loads(done.stdout)["frames"], 64)
        self.assertEqual(done.stderr.count(": measured"), 2, done.stderr)

    def test_other_sizes_judge_only_bad_values(self):
        done = suite(self.folder, "--only", "fog_none", "--preset", "fixed", "--size", "32x18",
                     "--json")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual([r["measure"] for r in json.loads(done.stdout)["results"]],
                         ["bad_values"])


class Floors(unittest.TestCase):
    """A number in motion is beside the number of every pixel marched in every frame."""

    def test_the_floor_is_the_number_of_its_preset(self):
        """A preset that is the floor of both is rendered once, and its ratio is 1."""
        done = suite(TEMPORARY.name, "--only", "sun_flash", "--preset", "fixed", "--preset",
                     "off+taa=on", "--jobs", "2", "--json")
        found = cells(done)
        fixed, floor = (found["sun_flash", "lag", "all", preset]
                        for preset in ("fixed", "off+taa=on"))
        self.assertEqual((fixed["floor_column"], fixed["floor"]), ("off+taa=on", floor["value"]))
        self.assertEqual(fixed["times_floor"], fixed["value"] / floor["value"])
        self.assertEqual(floor["times_floor"], 1.0)
        self.assertIsNone(found["sun_flash", "bad_values", "all", "fixed"]["floor_column"])
        frames = json.loads(done.stdout)["scenes"][0]["frames"]
        self.assertEqual(json.loads(done.stdout)["frames"], 2 * frames)

    def test_a_floor_has_no_verdict(self):
        """Its numbers are in no count and its column is in no list."""
        done = suite(TEMPORARY.name, "--only", "sun_flash", "--preset", "fixed", "--json")
        document = json.loads(done.stdout)
        self.assertEqual({r["column"] for r in document["results"]}, {"fixed"})
        self.assertEqual(document["compared"], len(document["results"]))
        self.assertEqual(document["floors"],
                         [{"column": "fixed", "floors": ["off+taa=on", "off+taa=on"]}])
        self.assertIsNotNone(cells(done)["sun_flash", "lag", "all", "fixed"]["floor"])


class Engines(unittest.TestCase):
    """Engines next to presets, in the scenarios with fog."""

    def test_an_engine_is_compared_with_exact(self):
        done = suite(TEMPORARY.name, "--only", "fog_none", "-e", "march", "--preset", "fixed",
                     "--json")
        self.assertEqual(done.returncode, 0, done.stderr)
        found = cells(done)
        for measure in ("error", "bad_values"):
            self.assertEqual(found["fog_none", measure, "all", "march"]["value"], 0.0)
        # Measures of a history are for presets only.
        self.assertNotIn(("fog_none", "flicker", "all", "march"), found)
        self.assertIn(("fog_none", "flicker", "all", "fixed"), found)

    def test_three_frames_of_moving_scenes(self):
        """The first, the middle and the last frame, each against its own moment."""
        done = suite(TEMPORARY.name, "--only", "elevator", "-e", "march", "--json")
        self.assertEqual((done.returncode, json.loads(done.stdout)["frames"]), (0, 3), done.stderr)
        self.assertLess(cells(done)["elevator", "error", "all", "march"]["value"], 1e-3)

    def test_a_missing_engine_has_no_verdict(self):
        done = suite(TEMPORARY.name, "--only", "fog_none", "-e", "povray", "--json",
                     PATH="/nowhere")
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertIn("nothing was compared", done.stderr)
        found = cells(done)["fog_none", "error", "all", "povray"]
        self.assertEqual((found["verdict"], found["value"]), ("missing", None))
        self.assertIn("povray", found["why"])

    def test_non_physical_fog(self):
        """Faults from their controls are found, and no others."""
        scenes = [f"fog_look_{name}" for name in ("below", "none", "start", "cutoff", "glow")]
        words = [word for scene in scenes for word in ("--only", scene)]
        done = suite(TEMPORARY.name, "--tier", "full", "-e", "fog_look", *words, "--json")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        results = json.loads(done.stdout)["results"]
        self.assertEqual({r["verdict"] for r in results}, {"pass", "known_fail"})
        failing = {(r["scene"], r["point"]) for r in results if r["verdict"] != "pass"}
        self.assertEqual({scene for scene, _ in failing},
                         {"fog_look_start", "fog_look_cutoff", "fog_look_glow"})
        self.assertFalse(failing & {("fog_look_start", "start_distance_m=0"),
                                    ("fog_look_cutoff", "cutoff_distance_m=0")})

    @night.of_the_night
    def test_the_witnesses_in_the_fog(self):
        """In the seam of the height fog and in the elevator scene they are within its limits, and
        they report unsupported scenes."""
        words = ["--tier", "full", "-e", "march", "-e", "cycles", "-e", "povray", "--only",
                 "fog_seam", "--only", "fog_below", "--only", "elevator"]
        done = suite(TEMPORARY.name, *words, "--json")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        results = json.loads(done.stdout)["results"]
        passing = {(r["scene"], r["column"]) for r in results
                   if (r["verdict"], r["measure"]) == ("pass", "error")}
        self.assertEqual(passing, {(s, c) for s in ("fog_seam", "elevator")
                                   for c in ("march", "cycles", "povray")})
        cannot = {(r["scene"], r["point"], r["column"]) for r in results
                  if r["verdict"] == "cannot"}
        for column in ("cycles", "povray"):
            self.assertIn(("fog_below", "falloff_per_m=2", column), cannot)
            self.assertIn(("fog_seam", "falloff_per_m=2", column), cannot)


class Quick(unittest.TestCase):
    @night.of_the_night
    def test_the_quick_tier_passes_and_is_the_same_twice(self):
        """By one process, and by four at a time."""
        documents = []
        for jobs in ("1", "4"):
            with tempfile.TemporaryDirectory() as folder:
                done = suite(folder, "--pictures", "none", "--jobs", jobs, "--json")
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
            documents.append(json.loads(done.stdout)["results"])
        self.assertGreater(len(documents[0]), 100)
        self.assertEqual(documents[0], documents[1])


class Results(unittest.TestCase):
    """scripts/stress on results in the suite's format."""

    @staticmethod
    def result(value, verdict, **changes):
        return {"scene": "fence", "point": "", "measure": "error", "over": "all", "limit": 1.0,
                "column": "ue", "value": value, "infinite": False, "verdict": verdict, **changes}

    def ask(self, verb, *runs):
        with tempfile.TemporaryDirectory() as name:
            paths = [pathlib.Path(name, f"{i}.json") for i in range(len(runs))]
            for path, results in zip(paths, runs):
                path.write_text(json.dumps({"device": "d", "seconds": 1.0, "results": results}))
            return subprocess.run([ROOT / "scripts/stress", verb, *paths], capture_output=True,
                                  text=True, check=False)

    def test_runs_are_the_same_or_not(self):
        one = self.result(0.5, "pass")
        never = self.result(None, "fail", infinite=True)
        for runs, told, code in (
                (([one], [one]), "1 cells, 0 verdicts differ, 0 numbers", 0),
                (([never], [never]), "0 verdicts differ, 0 numbers", 0),
                (([one], [self.result(0.6, "pass")]), "0 verdicts differ, 1 numbers", 0),
                (([one], [self.result(1.5, "fail")]), "error/all: 0.5 pass, 1.5 fail, limit 1", 1),
                (([one], [one], [never]), "1 verdicts differ", 1),
                (([one], []), "alone", 1),
                (([], []), "0 cells", 1),
                (([one],), "", 1)):
            done = self.ask("same", *runs)
            self.assertEqual(done.returncode, code, done.stdout + done.stderr)
            self.assertIn(told, done.stdout)

    def test_a_draft_has_no_reason_and_is_refused(self):
        bad, worse = self.result(2.0, "fail"), self.result(3.0, "fail", column="unity")
        lines = self.ask("draft", [bad, worse, self.result(0.5, "unexpected_pass", scene="wind")],
                         [self.result(0.9, "pass"), worse]).stdout.splitlines()
        entries = json.loads("[" + "".join(lines[:-1]) + "]")
        self.assertEqual([(e["presets"], e["is"], e["seen"]) for e in entries],
                         [(["unity"], "fails", {"unity": "3 3 of 1"}),
                          (["ue"], "flakes", {"ue": "2 0.9 of 1"})])
        self.assertEqual(lines[-1], "// wind, ue: error/all: 0.5, unexpected_pass")
        with tempfile.TemporaryDirectory() as folder:
            data = data_with(pathlib.Path(folder), entries)
            done = suite(folder, "--only", "fog_none", NEPH_DATA_DIR=str(data))
        self.assertEqual(done.returncode, 65, done.stderr)
        self.assertIn("has no 'reason'", done.stderr)


class OldNames(unittest.TestCase):
    """The failure suite, the name of the stress tests until one release ago."""

    def test_old_names_are_read(self):
        words = ["--only", "fence_tiles", "--preset", "fixed", "--pictures", "none", "--json"]
        now = suite(TEMPORARY.name, *words)
        self.assertIn("known_fail", now.stdout)
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            data = data_of(folder)
            for new, old in (("stress", "failure"), ("studies/stress_expectations.json",
                                                     "studies/failure_expectations.json")):
                (data / "scenes" / new).rename(data / "scenes" / old)
            store = pathlib.Path(TEMPORARY.name, "store")
            (folder / "store").symlink_to(store)
            entries = set((store / "frames").iterdir())
            done = neph("validate", "--suite", "failure", "-q", "-o", folder, *words,
                        NEPH_DATA_DIR=str(data))
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertEqual(set((store / "frames").iterdir()), entries)
            warning, report = done.stderr.splitlines()
            self.assertIn("--suite failure is called --suite stress now", warning)
            self.assertIn("report: ", report)
            self.assertEqual(sorted(path.name for path in folder.glob("*.json")), ["failure.json"])
            same = subprocess.run([ROOT / "scripts/failure", "same", folder, TEMPORARY.name],
                                  capture_output=True, text=True, check=False)
        self.assertEqual(same.returncode, 0, same.stdout + same.stderr)
        self.assertIn("scripts/failure is called scripts/stress now", same.stderr)
        self.assertIn("0 verdicts differ, 0 numbers", same.stdout)


class Interrupted(NephCase):
    ONE = ["--only", "fog_none", "--preset", "fixed", "--preset", FAULT]
    TWO = [*ONE, "--only", "history_first", "--only", "ray_bad", "--jobs", "2"]
    SIZES = ("32x18", "64x36", "128x72", "256x144")

    def interrupted(self, words, when):
        """Interrupts a run as soon as `when` holds, and returns the words of that run. A run may
        end before this process is scheduled again; it is then repeated with larger frames."""
        for size in self.SIZES:
            shutil.rmtree(self.folder, ignore_errors=True)
            sized = [*words, "--size", size]
            child = self.start("validate", "--suite", "stress", "-q", "-o", self.folder, *sized,
                               niceness=10)
            self.wait_until(when, child)
            child.send_signal(signal.SIGINT)
            out, err = child.communicate(timeout=120)
            if child.returncode != 0 or size == self.SIZES[-1]:
                break
        self.assertEqual((child.returncode, out), (130, ""), err)
        self.assertEqual(page_of(self.folder)["state"], "interrupted")
        self.assertIn("report so far", err)
        return sized

    def test_finished_frames_are_reused(self):
        store = self.folder / "store/frames"
        words = self.interrupted(self.ONE, lambda: store.exists() and any(store.iterdir()))
        kept = self.stamps(store)
        done = suite(self.folder, *words, "--json")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertGreaterEqual(len(kept), 1)
        self.assertEqual({path: path.stat().st_mtime_ns for path in kept}, kept)

    def test_the_page_is_of_all_processes(self):
        """While they run: the process that updates it does not render."""
        data = self.folder / "report/data.json"
        words = self.interrupted(
            self.TWO, lambda: data.exists() and page_of(self.folder)["compared"] > 0)
        told = [r for r in page_of(self.folder)["results"] if r["verdict"] != "not_yet"]
        whole = json.loads(suite(self.folder, *words, "--json").stdout)["results"]
        self.assertGreater(len(whole), len(told))
        for result in told:
            self.assertIn(result, whole)


class Words(NephCase):
    def test_wrong_commands_are_usage_errors(self):
        self.check_refusals(
            (64, ("nobody", "neph scenes"), ("--suite", "stress", "--only", "nobody")),
            (64, ("nope", "off, seed"), ("--suite", "stress", "--preset", "nope")),
            (64, "zzz", ("--suite", "stress", "--preset", "ours+zzz=1")),
            (64, "--only", ("--suite", "stress", "fence_tiles")),
            (64, "--preset", ("--suite", "stress", "-e", "realtime")),
            (64, "reference of engines", ("--suite", "stress", "-e", "exact")),
            (64, ("nobody", "neph engines"), ("--suite", "stress", "-e", "nobody")),
            (64, "NAME+KEY=VALUE", ("--suite", "stress", "--set", "march:steps=4")),
            (64, ("for engines", "fog_seam"),
             ("--suite", "stress", "--only", "fence_tiles", "-e", "march")),
            (64, "failed, changed, all", ("--suite", "stress", "--pictures", "some")),
            (64, "page-limit", ("--suite", "stress", "--page-limit", "0")),
            (64, "--suite stress", ("--page-limit", "3")),
            (64, "--suite physics, i3rc and stress", ("--only", "fence_tiles")),
            (64, "--suite stress", ("--on-device",)),
            (64, "jobs", ("--suite", "stress", "--jobs", "0")),
            before=("validate", "-q", "-o", self.folder))

    def test_a_scene_shows_its_planted_fault(self):
        done = neph("scenes", "fence_tiles")
        for word in ("fails ", "symptom ", "limit       period_4 over all <= 0.002", "pitch_m"):
            self.assertIn(word, done.stdout)
        shown = json.loads(neph("scenes", "fence_tiles", "--json").stdout)["failure"]
        self.assertEqual((len(shown["points"]), shown["engines"]), (1 + 6 * 3 * 4, False))
        self.assertIn("presets all and engines", neph("scenes", "fog_seam").stdout)
        self.assertIsNone(json.loads(neph("scenes", "fence_sky", "--json").stdout)["failure"])


class Mutations(unittest.TestCase):
    """Each planted fault fails its own measure, which its preset passes."""

    @night.of_the_night
    def test_planted_faults_are_found(self):
        chosen = [m for m in MUTATIONS["mutations"] if FULL or m["tier"] == "quick"]
        self.assertGreater(len(chosen), 0)
        for mutation in chosen:
            with self.subTest(mutation=mutation):
                self.plant(mutation)

    def plant(self, mutation):
        """`preset` unchanged, then with the fault in its settings or in the scenario."""
        kind = "-e" if mutation.get("engine") else "--preset"
        column = mutation.get("engine") or mutation["preset"]
        mutant = column + "".join(f"+{s}" for s in mutation.get("settings", "").split())
        key = mutation["scene"], mutation["measure"], mutation.get("over", "all")
        with tempfile.TemporaryDirectory() as folder:
            data = data_planted(pathlib.Path(folder), mutation)
            for name, verdict, where in ((column, "pass", {}),
                                         (mutant, "fail", {"NEPH_DATA_DIR": str(data)})):
                done = suite(TEMPORARY.name, "--only", mutation["scene"], kind, name, "--json",
                             **where)
                self.assertIn(done.returncode, (0, 1), done.stderr)
                found = cells(done)[*key, name]
                self.assertEqual(found["verdict"], verdict, found)


class Proofs(unittest.TestCase):
    """A scenario that no preset fails proves nothing; these scenarios are listed. An engine may
    fail for another reason."""

    def test_each_scenario_fails_or_is_listed(self):
        listed = json.loads((ROOT / "scenes/studies/stress_expectations.json").read_text())
        engines = {"cycles", "povray"}  # witnesses; looks and the march are tested themselves
        proven = ({e["scene"] for e in listed["expectations"]
                   if e["is"] == "fails" and not engines & set(e["presets"])}
                  # a single step is a fault of the march: it proves neither history nor mask
                  | {m["scene"] for m in MUTATIONS["mutations"]
                     if m.get("settings") != "steps=1" or m["measure"] == "energy"})
        scenarios = {path.stem for path in (ROOT / "scenes/stress").glob("*.yaml")}
        self.assertEqual(scenarios - proven, set(MUTATIONS["unproven"]))

    def test_each_scenario_is_documented(self):
        told = set(re.findall(r"`(\w+)`", (ROOT / "docs/stress.md").read_text()))
        scenarios = {path.stem for path in (ROOT / "scenes/stress").glob("*.yaml")}
        self.assertEqual(scenarios - told, set())


def tearDownModule():
    TEMPORARY.cleanup()


if __name__ == "__main__":
    unittest.main()
