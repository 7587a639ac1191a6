#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Nightly runs of a user's renderer in CI systems: the files to copy, their script, JUnit."""
import json
import os
import pathlib
import shutil
import subprocess
import unittest
import xml.etree.ElementTree

import yaml

import neph_case
import night

ROOT = neph_case.ROOT
EXAMPLES = ROOT / "docs/examples/ci"
CACHED = ["neph-out", "neph-program"]
SCENE = """title: Even fog before a wall
camera: {position_m: [0, 0, 9], look_at_m: [0, 0, 0], vertical_fov_deg: 40}
scattering: none
solids: [{box: {min_m: [-50, -50, -1], max_m: [50, 50, 0], albedo: [0, 0, 0]}}]
media:
  - homogeneous: {extinction_per_m: 0.05, albedo: [0, 0, 0],
      bounds: {min_m: [-40, -40, -9], max_m: [40, 40, 40]}}
gates:
  - {engine: command, quantity: transmittance, metric: max_abs, maximum: 0.001, reason: of a test}
"""


def read(name):
    return yaml.safe_load((EXAMPLES / name).read_text())


def cases(path):
    """{"group: name": None, or ("failure" or "skipped", message, file, line)} of a JUnit file."""
    found = {}
    for case in xml.etree.ElementTree.parse(path).getroot():
        name = f"{case.get('classname')}: {case.get('name')}"
        assert name not in found, name
        said = list(case)
        found[name] = (said[0].tag, said[0].get("message"), case.get("file"),
                       case.get("line")) if said else None
    return found


class Files(unittest.TestCase):
    def test_both_run_one_script(self):
        github, gitlab = read("github.yml"), read("gitlab.yml")["nephelometer"]
        runs = [step["run"] for step in github["jobs"]["night"]["steps"] if "run" in step]
        self.assertEqual(gitlab["script"], ["bash nephelometer/scripts/ci"])
        self.assertEqual(runs[1:], gitlab["script"])
        self.assertTrue((ROOT / "scripts/ci").stat().st_mode & 0o100)
        self.assertEqual(github["jobs"]["night"]["container"], gitlab["image"])

    def test_variables_are_those_of_the_script(self):
        github, gitlab = read("github.yml"), read("gitlab.yml")["nephelometer"]
        script = (ROOT / "scripts/ci").read_text()
        variables = [name for name in github["env"]]
        self.assertEqual(variables, [name for name in gitlab["variables"]
                                     if name.startswith("NEPH")])
        for name in variables:
            self.assertIn(f"#   {name} ", script)
        self.assertIn("accept", github[True]["workflow_dispatch"]["inputs"])  # "on" of YAML 1.1

    def test_one_line_is_to_be_edited(self):
        for name in ("github.yml", "gitlab.yml"):
            text = (EXAMPLES / name).read_text()
            self.assertEqual(text.count("EDIT"), 1)
            self.assertIn("NEPH_COMMAND: ./render.sh # EDIT", text)

    def test_cached_and_kept_folders(self):
        github, gitlab = read("github.yml"), read("gitlab.yml")["nephelometer"]
        steps = github["jobs"]["night"]["steps"]
        named = {step["uses"].split("@")[0]: step for step in steps if "uses" in step}
        restore, save = named["actions/cache/restore"], named["actions/cache/save"]
        self.assertEqual(restore["with"]["path"].split(), CACHED)
        self.assertEqual(save["with"]["path"].split(), CACHED)
        self.assertEqual(save["with"]["key"], restore["with"]["key"])
        self.assertTrue(save["with"]["key"].startswith(restore["with"]["restore-keys"]))
        self.assertEqual(gitlab["cache"]["paths"], CACHED)
        # Also after a failed run: the store has its frames, and the page has the reason.
        self.assertEqual(save["if"], "always()")
        self.assertEqual(named["actions/upload-artifact"]["if"], "always()")
        self.assertEqual((gitlab["cache"]["when"], gitlab["artifacts"]["when"]),
                         ("always", "always"))
        reports = gitlab["artifacts"]["reports"]
        self.assertEqual(reports["junit"], ["neph-out/nightly/junit.xml", "neph-out/scenes.xml"])
        self.assertEqual(reports["codequality"], "neph-out/code-quality.json")


class Annotations(neph_case.NephCase):
    def test_formats(self):
        junit = self.put("junit.xml", """<testsuite name="n" tests="3">
  <testcase classname="validate fog" name="a"></testcase>
  <testcase classname="validate fog" name="radiance, 50%" file="scenes/fog.yaml" line="12">
    <failure message="0.2 is above&#10;the limit: 0.1"/></testcase>
  <testcase classname="c" name="d"><failure message="e"/></testcase>
</testsuite>""")
        done = subprocess.run(["python3", ROOT / "scripts/ci_annotations.py", "--file", "render.sh",
                               "--code-quality", self.folder / "q.json", junit,
                               self.folder / "none.xml"],
                              capture_output=True, text=True, check=True)
        self.assertEqual(done.stdout.splitlines(), [
            "::error file=scenes/fog.yaml,line=12,title=validate fog%3A radiance%2C 50%25::"
            "0.2 is above%0Athe limit: 0.1",
            "::error file=render.sh,line=1,title=c%3A d::e"])
        found = json.loads((self.folder / "q.json").read_text())
        self.assertEqual([row["location"] for row in found],
                         [{"path": "scenes/fog.yaml", "lines": {"begin": 12}},
                          {"path": "render.sh", "lines": {"begin": 1}}])
        self.assertEqual(len({row["fingerprint"] for row in found}), 2)
        for row in found:
            self.assertEqual(sorted(row), ["check_name", "description", "fingerprint", "location",
                                           "severity"])


class OnlyEngine(neph_case.NephCase):
    in_folder = True
    surroundings = {**os.environ, "NEPH_COMMAND": str(ROOT / "docs/examples/fog.py")}

    def validate(self, *words, **options):
        return self.neph("validate", "even_fog.yaml", "--size", "24x16", "-o", "out", "-q",
                         "--junit", "junit.xml", *words, **options)

    def test_only_the_engine_and_the_reference_are_rendered(self):
        self.put("even_fog.yaml", SCENE)
        document = json.loads(self.validate("-e", "command", "--only-engine", "-s",
                                            "command:a=0.05", "--json").stdout)
        frames = {frame["engine"]: frame for frame in document["scenes"][0]["frames"]}
        self.assertEqual({name: frame["status"] for name, frame in frames.items()},
                         {"exact": "rendered", "command": "rendered"})
        self.assertEqual(document["counts"], {"expected": 2, "reported": 2, "compared": 1})
        found = cases(self.folder / "junit.xml")
        self.assertEqual(found, {
            "validate even_fog: exact renders": None,
            "validate even_fog: command renders": None,
            "validate even_fog: command radiance within a factor of two of the reference": None,
            "validate even_fog: command transmittance max_abs over all": None,
            "validate: verdict": None})

    def test_a_failed_gate_names_its_line(self):
        self.put("even_fog.yaml", SCENE)
        self.validate("-e", "command", "--only-engine", "-s", "command:a=0.06", code=1)
        kind, message, file, line = cases(self.folder / "junit.xml")[
            "validate even_fog: command transmittance max_abs over all"]
        self.assertEqual((kind, file, line), ("failure", "even_fog.yaml", "9"))
        self.assertIn("is above the limit, 0.001: of a test", message)

    def test_where_the_first_reference_cannot(self):
        self.put("even_fog.yaml", SCENE.replace("scattering: none", "scattering: multiple")
                 .replace("0.05, albedo: [0, 0, 0]", "0.05, albedo: [0.5, 0.5, 0.5]"))
        document = json.loads(self.validate("-e", "command", "--only-engine", "--json",
                                            code=None).stdout)
        rendered = [frame["engine"] for frame in document["scenes"][0]["frames"]
                    if frame["status"] == "rendered"]
        self.assertEqual(rendered, ["tracer", "command"])

    def test_refusals(self):
        self.check_refusals(
            (64, "--only-engine needs -e", ("validate", "--only-engine")),
            (64, "--only-engine is of scenes", ("validate", "--suite", "physics", "-e", "exact",
                                                "--only-engine")),
            (64, "--only-engine needs -e", ("nightly", "--only-engine")))

    def test_a_nightly_run_of_one_engine(self):
        listed = self.neph("nightly", "--list", "-e", "command", "--only-engine").stdout
        for line in listed.splitlines():
            self.assertTrue(line.startswith("catalog "), line)
            self.assertTrue(line.endswith("--only-engine --no-charts --budget 60 -e command"), line)

    def test_junit_of_the_suites(self):
        self.neph("validate", "--suite", "stress", "--only", "fog_none", "--preset", "off", "-q",
                  "-o", "stress", "--junit", "stress.xml")
        self.assertEqual(cases(self.folder / "stress.xml"),
                         {"stress fog_none: off error over all": None,
                          "stress fog_none: off flicker over all": None,
                          "stress fog_none: off bad_values over all": None,
                          "stress: verdict": None})
        self.neph("validate", "--suite", "physics", "--only", "single_slab_thin", "-e",
                  "exact,march", "--samples", "16", "-q", "-o", "physics", "--junit", "physics.xml")
        found = cases(self.folder / "physics.xml")
        for name in ("exact", "march"):
            self.assertIsNone(found[f"physics single_slab_thin: {name}"])
        self.assertIsNone(found["physics phase functions: rayleigh g 0"])


@night.of_the_night
class Script(unittest.TestCase):
    """The script part of both files, on runners that start with only the cache."""

    def setUp(self):
        self.folder = neph_case.scratch(self.addCleanup)
        self.cache = self.folder / "cache"

    def run_job(self, name, extinction="0.05", code=0, **environment):
        """A checkout, the cached folders, the script, and the saved cache."""
        checkout = self.folder / name
        (checkout / "nephelometer").mkdir(parents=True)
        for part in ("scripts", "docs"):
            shutil.copytree(ROOT / part, checkout / "nephelometer" / part,
                            ignore=shutil.ignore_patterns("node_modules"))
        shutil.copy(ROOT / "docs/examples/fog.py", checkout)
        (checkout / "render.sh").write_text(
            "#!/bin/sh\nif [ \"$1\" = --version ]; then echo mine " + extinction + "; exit; fi\n"
            f"sed -i 's/\"a\": [^,}}]*/\"a\": {extinction}/' \"$1\"\n"
            f"exec python3 {checkout}/fog.py \"$1\"\n")
        (checkout / "render.sh").chmod(0o755)
        (checkout / "even_fog.yaml").write_text(SCENE)
        for part in CACHED:
            if (self.cache / part).exists():
                shutil.copytree(self.cache / part, checkout / part)
        job = read("gitlab.yml")["nephelometer"]
        words = job["script"][0] + " --only height_fog_down"
        variables = {**{key: str(value) for key, value in job["variables"].items()},
                     "NEPH_SCENES": "even_fog.yaml", "NEPH": neph_case.NEPH, **environment}
        done = subprocess.run(["bash", "-c", words], cwd=checkout, capture_output=True, text=True,
                              env={**os.environ, **variables}, timeout=900)
        self.assertEqual(done.returncode, code, (done.stdout, done.stderr))
        for part in CACHED:
            shutil.rmtree(self.cache / part, ignore_errors=True)
            if (checkout / part).exists():
                shutil.copytree(checkout / part, self.cache / part)
        for path in (job["artifacts"]["reports"]["codequality"],
                     *job["artifacts"]["reports"]["junit"]):
            self.assertTrue((checkout / path).exists(), path)
        return done, json.loads((checkout / "neph-out/code-quality.json").read_text())

    def test_nightly_runs_on_fresh_runners(self):
        first, entries = self.run_job("first", code=1)
        self.assertIn("NEPH_ACCEPT='the reason'", first.stderr)
        self.assertEqual([entry["description"] for entry in entries],
                         ["nightly: something is compared: nothing was compared"])
        accepted, entries = self.run_job("second", NEPH_ACCEPT="looked at")
        self.assertIn("is the baseline of all series", accepted.stdout)
        self.assertEqual(entries, [])
        third, entries = self.run_job("third")
        self.assertIn("passes", third.stdout)
        self.assertEqual(entries, [])
        summary = self.folder / "summary.md"
        broken, entries = self.run_job("fourth", extinction="0.2", code=1,
                                       GITHUB_STEP_SUMMARY=str(summary))
        self.assertIn("::error file=even_fog.yaml,line=9,title=validate even_fog%3A command "
                      "transmittance max_abs over all::", broken.stdout)
        self.assertTrue(any("height_fog_down" in entry["description"] and
                            entry["location"]["path"] == "render.sh" for entry in entries), entries)
        self.assertIn("worse", summary.read_text())

    def test_without_a_program(self):
        done = subprocess.run(["bash", ROOT / "scripts/ci"], cwd=self.folder, capture_output=True,
                              text=True, env={**os.environ, "NEPH_COMMAND": "./none"})
        self.assertEqual(done.returncode, 64)
        self.assertIn("NEPH_COMMAND is './none', and no program is there", done.stderr)


if __name__ == "__main__":
    unittest.main()
