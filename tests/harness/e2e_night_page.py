#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The page of a nightly run, opened from disk in a browser as by a reader.

Builds a small page with every kind of finding, missing values and hostile strings, and checks it
against its data with check_night.mjs. Then it plants known faults in the page, which the checker
must find. By night it also makes real nightly runs: a changed threshold of the upscale and a
changed phase function are found, named and displayed.

    e2e_night_page.py                  run the tests
    e2e_night_page.py --fixture DIR    only write the page, for inspection
    e2e_night_page.py --sample DIR     only make the runs: DIR/nightly/report is a real page
"""
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

import night
from pages import (HOSTILE, HOSTILE_SCRIPT, PAGE, PageCase, lay_out, node, skip_without_a_browser,
                   write_png)

SIZE = [96, 54]


# ----------------------------------------------------------------------------------------- data

def course(values, error=None):
    return [{"night": 3 + n, "value": value, "standard_error": error, "environment": "llvmpipe",
             "judgement": "worse" if n == 2 else ""} for n, value in enumerate(values)]


def frame(name):
    return {"picture": f"images/{name}.png", "exr": f"/store of frames/{name}/frame.exr"}


def shown(changed=0.25):
    difference = {"picture": "images/c.png" if changed else None, "scale": 0.02 if changed else 0.0,
                  "mean": 0.0125, "changed": changed}
    return {"accepted": frame("a"), "tonight": frame("b"), "size_px": SIZE, "exposure_ev": 0.0,
            "difference": difference}


def finding(found, series, words="", **more):
    parts = dict(zip(("suite", "scene", "engine", "metric", "truth"), series.split("/")))
    if len(parts) < 4:
        parts = {}
    values = {key: parts.get(key) for key in ("suite", "scene", "engine", "metric", "truth")}
    values.update(found=found, fails=found not in ("better", "moved", "environment"), series=series,
                  step="catalog fog", words=words, tonight=None, baseline=None, change=None, p=None,
                  floor=None, example=series if parts else "", accepted_night=3, interval=None,
                  range=None, kind="fixed", trend=[], shown=None,
                  command=f"neph validate fog -s 'march:{HOSTILE}'")
    values.update(more)
    return values


def findings():
    fog = "catalog/fog@15da7c6d"
    return [
        finding("step failed", f"sweep {HOSTILE}", f"failed: it broke {HOSTILE_SCRIPT}", step="",
                command=None),
        finding("blank picture", f"{fog}/oracle/contrast", "all its pixels are equal",
                shown={**shown(), "difference": None}, kind="picture",
                trend=course([2.0, 2.0, 0.0])),
        finding("missing", f"{fog}/cycles/radiance p99/exact", "tonight has not measured it",
                shown={**shown(), "tonight": None, "difference": None}, trend=course([0.5])),
        finding("worse", f"{fog}/march/radiance rel_rmse/exact",
                "0.0446166, accepted 0.000528605: +8340.44 %", tonight=0.0446166,
                baseline=0.000528605, change=83.4, p=0.0, floor=0.005,
                interval=[0.03882, 0.05042], trend=course([0.00052, 0.00052, 0.02, 0.0446], 0.001),
                shown=shown()),
        finding("worse", f"{fog}/march/radiance rel_bias/exact",
                "-0.02, accepted 0.0002: by 20 % of 0.001 further from 0", tonight=-0.02,
                baseline=0.0002, change=20.2, p=0.0, floor=0.005, trend=course([2e-4, -0.02])),
        finding("worse", "failure/sea@15da7c6d/ours/error over all",
                "0.0375, accepted 0.025: +50 %", tonight=0.0375, baseline=0.025, change=0.5, p=0.0,
                floor=0.005, preset_floor=0.0125, times_preset_floor=3.0,
                trend=course([0.025, 0.0375])),
        finding("worse", "speed/fog@15da7c6d/march/time", "1.25, accepted 1.0: +25 %",
                tonight=1.25, baseline=1.0, change=0.25, p=1e-5, floor=0.08, kind="timed",
                range={"low": 0.95, "high": 1.06, "nights": 5}, accepted_night=3,
                trend=course([1.0, 1.01, 1.3, 0.99, 1.25])),
        finding("worse", "cycles, radiance p99, mean of 12 scenes", "+3.25 %, p 2e-05",
                kind="mean", example=f"{fog}/cycles/radiance p99/exact", engine="cycles",
                suite="catalog", scene="fog@15da7c6d", metric="radiance p99", change=0.0325,
                p=2e-5, floor=0.01, range={"low": 0.98, "high": 1.02, "nights": 4},
                trend=course([1.0, 1.01, 0.99, 1.0325]), shown=shown()),
        finding("better", f"{fog}/realtime/radiance p99/exact", "0.1, accepted 0.2: -50 %",
                tonight=0.1, baseline=0.2, change=-0.5, p=0.0, floor=0.005, shown=shown(0.0),
                trend=course([0.2, 0.1])),
        finding("environment", f"llvmpipe 16 {HOSTILE}", "12 series are not compared", step="",
                command=None, kind=None),
    ]


def row(series, judged="same", tonight=0.5, why=""):
    return {"series": series, "step": "catalog fog", "judged": judged, "why": why,
            "tonight": tonight, "baseline": 0.5, "change": 0.01, "p": None, "floor": 0.005,
            "nights": 3}


def page_data():
    fog = "catalog/fog@15da7c6d"
    rows = [row(f"{fog}/march/radiance rel_rmse/exact", "worse", 0.0446166),
            row(f"{fog}/march/radiance rel_bias/exact", "worse", -0.02),
            row(f"{fog}/march/contrast", "not judged", 2.0, "a picture"),
            row(f"{fog}/realtime/radiance p99/exact", "better", 0.1),
            row("physics/slab_thin/tracer/deviation/theory", "same", 1.25e-4),
            row("speed/fog@15da7c6d/march/time", "worse", 1.25),
            {**row("failure/sea@15da7c6d/ours/error over all", "worse", 0.0375),
             "preset_floor": 0.0125, "times_preset_floor": 3.0},
            row("failure/sea@15da7c6d/ours/error over all floor", "same", 0.0125)]
    steps = [{"name": "catalog fog", "done": True, "outcome": "done", "reason": "",
              "arguments": ["validate", "fog"], "log": "logs/catalog_fog.log"},
             {"name": f"sweep {HOSTILE}", "done": False, "outcome": "failed",
              "reason": f"it broke {HOSTILE_SCRIPT}", "arguments": ["sweep"],
              "log": "logs/sweep_fog.log"},
             {"name": "physics slab", "done": False, "outcome": "not run", "reason": "",
              "arguments": ["validate"], "log": None}]
    return {"format": "neph-night-page-1", "night": 7, "baseline": 3, "tier": "full",
            "revision": f"v1 {HOSTILE}", "program": "0123456789abcdef", "host": "EPYC x 2",
            "resumed": False, "passes": False, "seconds": 610.5, "compared": 41, "chances": 9,
            "new": 2, "elsewhere": 12, "young": 0, "not_run": 5, "steps": steps,
            "findings": findings(), "series": rows, "state": "finished",
            "created_utc": "2026-11-25T02:10:00Z", "neph_version": "0.1.0",
            "output": f"out/{HOSTILE}", "summary": "Night 7 fails.",
            "difference_colours": ["#053061", "#4393c3", "#f7f7f7", "#d6604d", "#67001f"],
            "pictures": {f"{fog}/march": {"picture": "images/b.png", "size_px": SIZE},
                         f"{fog}/realtime": None},
            "scenes": {"fog": {"title": f"A fog {HOSTILE}", "exposure_ev": 0.0}},
            "page": {"limit_bytes": 50000000, "bytes": 49999000, "left_out": 3}}


# --------------------------------------------------------------------------------------- layout

def build(folder, data=None):
    lay_out(folder, "night", "NEPH_NIGHT", data or page_data(), before=["night_accept.js"])
    for name, shade in (("a", 60), ("b", 90), ("c", 200)):
        write_png(folder / "images" / f"{name}.png",
                  lambda i, j, shade=shade: (shade + i // 2, shade, 160 - j), *SIZE)


# ---------------------------------------------------------------------------------------- tests

class Page(PageCase):
    """The page in headless Chromium."""
    NAME = "night"
    build = staticmethod(build)

    def test_a_good_page_has_no_faults(self):
        self.assert_page_is_good(self.good, "--quick")

    @night.of_the_night
    def test_in_all_windows(self):
        self.assert_page_is_good(self.good)

    @night.of_the_night
    def test_pages_of_running_and_first_runs(self):
        for name, more in (("running", {"state": "running", "findings": [], "series": []}),
                           ("stopped", {"state": "interrupted", "findings": [], "series": []}),
                           ("first", {"compared": 0, "findings": [], "baseline": 0})):
            with self.subTest(name):
                self.assert_page_is_good(self.built(name, {**page_data(), **more}), "--quick")

    @night.of_the_night
    def test_each_of_several_faults_is_found(self):
        """Independent faults in one page."""
        folder = self.copy_with((
            ("el(\"code\", null, first.command)", "el(\"code\", null, \"neph\")"),
            ("el(\"div\", null, trend(finding))", "el(\"div\")"),
            ("el(\"p\", null, `${finding.words}.`)",
             "Object.assign(el(\"p\"), { innerHTML: finding.words })")))
        (folder / "images/c.png").unlink()
        data = page_data()
        data["findings"][3]["tonight"] *= 1.001
        data["series"][4]["tonight"] *= 1.001
        data["findings"][5]["preset_floor"] *= 1.001
        (folder / "data.json").write_text(json.dumps(data))
        self.assert_finds(self.check(folder, "--quick"), (
            ("a command that is not shown", "its command is not shown"),
            ("a course that is not drawn", "its course is not drawn"),
            ("markup from data", "markup that is none of the page's"),
            ("a missing picture", "images/c.png"),
            ("a number that differs", "its number of tonight is not shown"),
            ("a floor that differs", "its floor is not shown"),
            ("another", "slab_thin/tracer/deviation/theory: its number")))


GUEST = """#!{python}
# A march of another house, whose phase function is off by setting a.
import json, pathlib, re, subprocess, sys
if sys.argv[1:] == ["--version"]:
    print("march of another house, 1")
    sys.exit()
job = json.load(open(sys.argv[1]))
text = pathlib.Path(job["scene_file"]).read_text()
text = re.sub(r"asymmetry_g: ([-0-9.]+)",
              lambda g: f"asymmetry_g: {{float(g[1]) + float(job['settings']['a'])}}", text)
pathlib.Path(job["scene"] + ".yaml").write_text(text)
subprocess.run(["{neph}", "render", job["scene"] + ".yaml", "-e", "march", "--size",
                "{{}}x{{}}".format(*job["size_px"]), "-o", "."], check=True)
[made] = pathlib.Path(".").glob("*_march_*.exr")
made.rename("frame.exr")
"""


STEPS = ["--tier", "full", "--only", "catalog turned_solids", "--only", "catalog gaussian_blob",
         "-e", "command", "-q", "--once"]


def neph(folder, *arguments):
    """Returns its exit code and all its output, without external renderers."""
    environment = {**os.environ, "PATH": "/nonexistent", "NEPH_COMMAND": str(folder / "guest")}
    done = subprocess.run([os.environ["NEPH"], *arguments, "-o", str(folder)],
                          capture_output=True, text=True, timeout=300, env=environment)
    return done.returncode, done.stdout + done.stderr


def plant(folder):
    """Nightly runs. The third upscales with a depth threshold of 35 % instead of 25 %, and its
    renderer has a phase function with g + 0.01. Yields the output of each."""
    guest = folder / "guest"
    guest.write_text(GUEST.format(python=sys.executable, neph=os.environ["NEPH"]))
    guest.chmod(0o755)
    yield neph(folder, "nightly", *STEPS)
    yield neph(folder, "baseline", "accept", "--why", "looked at")
    yield neph(folder, "nightly", *STEPS)
    yield neph(folder, "nightly", *STEPS, "-s", "realtime:upscale_depth=0.35", "-s",
               "command:a=0.01")


class PlantedChanges(unittest.TestCase):
    @night.of_the_night
    def test_both_are_found_named_and_shown(self):
        skip_without_a_browser("the page of a night")
        with tempfile.TemporaryDirectory() as folder:
            self.folder = pathlib.Path(folder)
            for wanted, (code, said) in zip((1, 0, 0, 1), plant(self.folder)):
                self.assertEqual(code, wanted, said)
                if wanted == 0 and "Night 2" in said:  # nothing changed, nothing is found
                    self.assertEqual(self.data()["findings"], [])
            self.hold(self.data())
            told = node(PAGE / "check_night.mjs", self.folder / "nightly/report")
            self.assertEqual(told.returncode, 0, told.stdout + told.stderr)

    def data(self):
        return json.loads((self.folder / "nightly/report/data.json").read_text())

    def hold(self, data):
        self.assertEqual(data["state"], "finished")
        worse = [found for found in data["findings"] if found["found"] == "worse"]
        self.assertEqual({found["scene"].split("@")[0] + " " + found["engine"] for found in worse},
                         {"turned_solids realtime", "gaussian_blob command"})
        # The phase function affects the whole blob, the threshold affects pixels at edges.
        blob = next(found for found in worse if found["scene"].startswith("gaussian_blob"))
        solids = next(found for found in worse if found["engine"] == "realtime")
        self.assertGreater(blob["shown"]["difference"]["changed"], 0.5)
        self.assertLess(solids["shown"]["difference"]["changed"], 0.2)
        for found in (blob, solids):
            self.assertEqual([point["night"] for point in found["trend"]], [1, 2, 3])
            self.assertEqual(found["trend"][0]["value"], found["trend"][1]["value"])
            self.assertEqual(found["trend"][2]["value"], found["tonight"])
            self.assertEqual(len(found["interval"]), 2)
            self.assertIn("neph validate " + found["scene"].split("@")[0], found["command"])
            self.assertIn("-s realtime:upscale_depth=0.35", found["command"])
            for side in ("accepted", "tonight"):
                self.assertTrue(pathlib.Path(found["shown"][side]["exr"]).is_file())
                self.assertTrue((self.folder / "nightly/report" /
                                 found["shown"][side]["picture"]).is_file())


if __name__ == "__main__":
    if len(sys.argv) == 3 and sys.argv[1] == "--fixture":
        build(pathlib.Path(sys.argv[2]))
    elif len(sys.argv) == 3 and sys.argv[1] == "--sample":
        sample = pathlib.Path(sys.argv[2]).resolve()
        sample.mkdir(parents=True)
        for _, words in plant(sample):
            print(words)
    else:
        unittest.main(verbosity=2)
