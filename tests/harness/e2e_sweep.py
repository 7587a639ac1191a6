#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""`neph sweep`: a plan of a few points, its numbers against those that `neph compare` gives, its
page, and refused arguments. No absolute times: machines differ."""
import csv
import io
import json
import math
import re
import shlex
import unittest

from neph_case import ROOT, NephCase

PLAN = """title: a small one
light: octaves
width_px: 32
height_px: 18
frames: 32
warm_up: 16
truth_samples: 64
rounds: 2
seeds: 2
series:
- {name: march, engine: march, vary: steps, values: 4 16, order: 2}
- {name: ours, engine: realtime, preset: ours, vary: steps, values: 4 16, flicker: true, lag_at: 16}
- {name: fitted, engine: march_octaves_fitted}
"""


class Sweep(NephCase):
    in_folder = True

    def setUp(self):
        super().setUp()
        self.put("plan.yaml", PLAN)

    def sweep(self, *arguments, scene="voxel_grid", **expected):
        return self.neph("sweep", scene, "--plan", "plan.yaml", "-q", *arguments, **expected)

    def test_a_sweep(self):
        document = json.loads(self.sweep("--json").stdout)
        self.assertEqual(document["format"], "neph-sweep-1")
        self.assertEqual((document["measured"], document["expected"]), (4, 5))
        self.assertEqual(document["seeds"], 2)
        coarse, fine, ours, ours_fine, fitted = document["points"]
        self.assertIn("single scattering", fitted["missing"])
        # More steps cost more work, and reduce the march's error.
        self.assertGreater(coarse["error"]["value"], 2.0 * fine["error"]["value"])
        self.assertAlmostEqual(fine["evaluations"] / coarse["evaluations"], 4.0, delta=0.4)
        self.assertLess(ours["evaluations"], 0.2 * coarse["evaluations"])
        for point in (coarse, fine, ours, ours_fine):
            self.assertGreater(point["seconds"], 0.0)
            self.assertLessEqual(point["seconds_low"], point["seconds"])
            self.assertLessEqual(point["seconds"], point["seconds_high"])
            self.assertLessEqual(point["error"]["low"], point["error"]["value"])
        # A march has no history: no shortcut, no flicker, no lag.
        self.assertIsNone(fine["flicker"]["value"])
        self.assertIsNone(fine["shortcut"]["value"])
        self.assertGreater(ours["flicker"]["value"], 0.0)
        self.assertIsNone(ours["half_life"]["value"])
        self.assertGreater(ours_fine["half_life"]["value"], 0.0)
        # Intervals are over tiles of the frame, as in `neph flicker`, and over seeds.
        for name, point in (("flicker", ours), ("four", ours), ("half_life", ours_fine),
                            ("shortcut", ours)):
            self.assertLess(point[name]["low"], point[name]["high"], name)
            self.assertLessEqual(point[name]["low"], point[name]["value"], name)
            self.assertLessEqual(point[name]["value"], point[name]["high"], name)
        # Without path-traced lighting every point of ours has both costs, next to the march's two.
        held = {(row["number"], row["cost"], row["series"]): row for row in document["equal"]}
        self.assertEqual(held["error", "evaluations", "ours"]["against"], "march")
        self.assertIn((held["error", "evaluations", "ours"]["at_cost"],
                       held["error", "evaluations", "ours"]["at_number"]),
                      [(point["evaluations"], point["error"]["value"])
                       for point in (ours, ours_fine)])
        self.check_command(fine)
        self.check_page(document)
        self.check_again(document)

    def check_command(self, point):
        """The command of a point renders it: its error against `exact` is the point's."""
        command = shlex.split(point["command"])[1:]
        for arguments in (command, ["render", "voxel_grid", "-e", "exact", "--size", "32x18"]):
            self.neph(*arguments, "-o", "frames", "-q")
        found = self.json("compare", *(f"frames/voxel_grid_{engine}_0000.exr"
                                       for engine in ("exact", "march")), "-m", "error")
        numbers = [entry for entry in found["measurements"]
                   if entry["metric"] == "rel_rmse" and entry["mask"] == "all"
                   and entry["quantity"] == "radiance"]
        self.assertAlmostEqual(numbers[-1]["value"], point["error"]["value"], places=9)

    def check_page(self, document):
        page = self.folder / "out/sweep/sweep"
        self.assertTrue((page / "index.html").exists())
        shown = json.loads((page / "data.json").read_text())
        self.assertEqual(shown["points"], document["points"])
        charts = {chart["id"]: chart for chart in shown["charts"]}
        # The chart of lag needs only one point with a lag.
        self.assertEqual(set(charts), {"time_error", "time_shortcut", "time_flicker", "lag_flicker",
                                       "work_error", "work_shortcut", "work_flicker"})
        for chart in charts.values():
            for size in ("wide", "narrow"):
                svg = (page / chart[size]["svg"]).read_text()
                self.assertIn("ours", svg)
                self.assertNotIn("NaN", svg)

    def check_again(self, before):
        """Nothing is rendered twice, and values measured from frames are unchanged."""
        done = self.sweep("--untimed", "--csv", "-")
        rows = list(csv.DictReader(io.StringIO(done.stdout)))
        self.assertEqual(len(rows), 5)
        for row, point in zip(rows[:4], before["points"]):
            self.assertTrue(math.isclose(float(row["error"]), point["error"]["value"],
                                         rel_tol=1e-8))
            self.assertEqual(row["seconds"], "")
        self.assertEqual(rows[4]["outcome"], "missing")

    def test_a_scene_that_moves(self):
        """The truth is for the last frame, and so is every error."""
        self.put("plan.yaml", PLAN.replace("4 16, flicker", "16, flicker")
                 .replace(", lag_at: 16", "") + "- {name: marched, engine: realtime, "
                 "preset: off, set: taa=on, vary: steps, values: 16, flicker: true}\n")
        text = (ROOT / "scenes/catalog/gaussian_blob.yaml").read_text()
        self.put("dolly.yaml", re.sub("name: .*", "name: dolly", text, count=1).replace(
            "camera: {position_m: [0, 2, 6], look_at_m: [0, 1, 0], vertical_fov_deg: 36}",
            "camera: {keys: [{frame: 0, position_m: [0, 2, 6], look_at_m: [-2, 1, 0]}, {frame: 31, "
            "position_m: [0, 2, 6], look_at_m: [1, 1, 0]}], vertical_fov_deg: 36}\n"
            "frames: {count: 32, rate_hz: 30}"))
        def sweep(jobs):
            done = self.sweep("-o", f"out_{jobs}", "--json", "--untimed", "--only",
                              "march,ours,marched", "--jobs", jobs, scene="dolly.yaml")
            found = json.loads(done.stdout)
            found.pop("load")  # of the machine
            return found
        document = sweep(1)
        self.assertEqual(sweep(2), document)
        self.assertEqual((document["frame"], document["frames"]), (31, 32))
        coarse, fine, ours, marched = document["points"]
        self.check_floors(fine, ours, marched)
        self.assertLess(fine["error"]["value"], 0.5 * coarse["error"]["value"])
        # Against the first frame, the error of the last would be large.
        self.assertLess(ours["error"]["value"], 0.5)
        self.assertIn("--frame 31", fine["command"])
        self.assertIn("--frames 32", ours["command"])

    def check_floors(self, fine, ours, marched):
        """Every pixel marched with the default anti-aliasing is its own floor, and no preset's
        floor is above it."""
        self.assertEqual({fine[name]["floor"] for name in ("error", "flicker")}, {None})
        for name in ("error", "shortcut", "flicker", "four"):
            self.assertEqual(marched[name]["floor"], marched[name]["value"])
            self.assertLessEqual(ours[name]["floor"], marched[name]["value"])
        self.assertGreater(ours["error"]["value"], ours["error"]["floor"])

    def test_fronts_of_several_seeds(self):
        document = json.loads(
            self.sweep("--seeds", "2", "--untimed", "--only", "march", "--json").stdout)
        self.assertEqual((document["format"], document["sweeps"], document["moved"]),
                         ("neph-stability-1", 2, 0))
        # A march against an exact truth is deterministic.
        self.assertEqual([(p["label"], p["outcome"]) for p in document["points"]],
                         [("steps=4", "on all"), ("steps=16", "on all")])
        self.assertTrue((self.folder / "out/sweep/seed_2/sweep/index.html").exists())

    def answer(self, *arguments):
        """The lines of the answer, without progress."""
        done = self.neph("sweep", "voxel_grid", "--plan", "plan.yaml", *arguments)
        return done.stdout.splitlines()

    def test_the_answer_is_the_cheapest_series_at_an_error(self):
        """The verdict by its definition, from the values in JSON."""
        self.put("plan.yaml", PLAN.replace("seeds: 2", "seeds: 1").replace(", lag_at: 16", ""))
        words = ("--untimed", "--only", "march,ours")
        points = json.loads(self.sweep(*words, "--json").stdout)["points"]
        errors = sorted(point["error"]["value"] for point in points)
        for error in (1.001 * errors[0], 1.001 * errors[2], 1.001 * errors[-1]):
            good = [point for point in points if point["error"]["value"] <= error]
            least = min(good, key=lambda point: point["evaluations"])
            lines = self.answer(*words, "--error", f"{error:.9f}")
            steps = least["label"].removeprefix("steps=")
            self.assertTrue(lines[0].startswith(f"{least['series']}: {steps} steps for "), lines)
            self.assertIn(f"off by {100 * least['error']['value']:.3g} %", lines[0])
            self.assertLessEqual(len(lines), 10)
            self.assertIn("sweep/index.html", lines[-1])
        words += ("--error", "1e-6")
        self.assertGreater(points[0]["to_finest"]["value"], 0.01)
        [verdict] = self.answer(*words, "-q")
        self.assertRegex(verdict, "^no series is within 0.0001 % of the truth: the nearest is .*: "
                                  f"{100 * errors[0]:.3g} %")
        self.assertIn("front of error", self.sweep(*words, "--all").stdout)

    def test_refused_arguments(self):
        self.put("plan.yaml", PLAN.replace("engine: march,", "engine: marsh,"))
        self.assertRegex(self.sweep(code=65).stderr, r"plan\.yaml:11:\d+: .*no engine 'marsh'")
        self.put("plan.yaml", PLAN)
        self.sweep("--only", "nothing", code=64, said="march, ours, fitted")
        self.sweep("--plan", "no_such", code=66)
        self.sweep("-o", "", code=64)
        self.sweep(scene="camera_dolly", code=2, said="moves for 8 frames")
        self.sweep("--size", "5000x9", code=64, said="march renders sides of 1..4096 pixels")
        # A folder that neph did not create stays unchanged, and the command is refused before
        # rendering.
        mine = self.put("out/sweep/sweep/mine.txt")
        self.sweep("--only", "march", code=64)
        self.assertEqual(mine.read_text(), "mine")
        frames = self.folder / "out/sweep/store/frames"
        self.assertFalse(frames.exists() and any(frames.iterdir()))


if __name__ == "__main__":
    unittest.main()
