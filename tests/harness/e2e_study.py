#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""`neph study flicker` and `neph study steps` as a user runs them, with small frames: references,
reuse, refused arguments, Ctrl-C, several processes."""
import csv
import json
import unittest
import xml.etree.ElementTree

from neph_case import StudyCase

# A wall half in front of a blob: at the edge a pixel's 16 rays differ from its centre ray.
REST = """
name: rest
title: a test
description: a test
camera: {position_m: [0, 2, 0], look_at_m: [0, 2, -10], vertical_fov_deg: 40}
frames: {count: 16, rate_hz: 30}
sun: {direction: [0.6, 0.75, 0.3], irradiance_w_per_m2: [6, 6, 6]}
background_w_per_m2_sr: [0.5, 0.25, 0.125]
scattering: single
solids:
  - box: {min_m: [0.1, -6, -21], max_m: [30, 6, -20], albedo: [0.2, 0.2, 0.2]}
media:
  - gaussian: {center_m: [-2, 3, -30], width_m: 3, extinction_per_m: 0.3, albedo: [1, 1, 1]}
"""
MOVES = REST.replace("rest", "moves").replace("background",
                                              "wind: {velocity_m_per_s: [9, 0, 0]}\nbackground")
MULTIPLE = REST.replace("rest", "multiple").replace("scattering: single", "scattering: multiple")


def without_times(document):
    if isinstance(document, dict):
        return {key: without_times(value) for key, value in document.items()
                if not key.endswith(("cpu_s", "wall_s"))}
    return list(map(without_times, document)) if isinstance(document, list) else document


class Study(StudyCase):
    def setUp(self):
        super().setUp()
        self.rest, self.moves, self.multiple = (
            self.put(f"{name}.yaml", text)
            for name, text in (("rest", REST), ("moves", MOVES), ("multiple", MULTIPLE)))

    def command(self, *arguments, frames=16, floors=False):
        return ("study", "flicker", *arguments, "--size", "32x18", "--steps", "3", "--frames",
                frames, "--seeds", 1, "-q", *(() if floors else ("--no-floor",)))

    def study(self, *arguments, **options):
        return self.json(*self.command(*arguments, **options))

    def test_static_and_moving_scenes_are_alike(self):
        """`off` is the march through pixel centres: its error is zero against centres, and not zero
        against the reference."""
        found = self.study(self.rest, self.moves, self.multiple, "--preset", "off,fixed",
                           "--takes", "flicker", frames=20)
        rest, moves, multiple = found["scenes"]
        self.assertEqual([s["reference"] for s in (rest, moves)],
                         ["march, 16 rays a pixel, 3 steps"] * 2)
        self.assertEqual([s["moves"] for s in (rest, moves)], [False, True])
        # motion ends with the scene
        self.assertEqual([s["frames"] for s in (rest, moves)], [20, 16])
        self.assertEqual([s["reference_pictures"] for s in (rest, moves)], [2, 32])
        self.assertIn("multiple", multiple["left_out"])
        for scene in ("rest", "moves"):
            cell, = (r for r in found["results"] if (r["scene"], r["preset"],
                                                     r["metric"]) == (scene, "off", "rel_rmse"))
            self.assertEqual(cell["against_centre_rays"], 0.0)
            self.assertGreater(cell["value"], 1e-3)
        self.assertEqual({p["scenes"] for p in found["pairs"] if p["metric"] == "rel_rmse"}, {2})
        for preset in found["presets"]:
            self.assertIn("steps=3 ", preset["settings"])
        views = {(p["rate_hz"], p["pixels_per_degree"]) for p in found["pairs"]}
        self.assertEqual(views, {(f, ppd) for f in (24, 30, 60) for ppd in (30, 60)})

    def interrupted(self, *arguments):
        """Interrupts after three finished captures or frames; returns the time at which each was
        written."""
        store = self.folder / "out/study/store/frames"
        child = self.start(*self.command(*arguments))
        self.wait_until(lambda: store.exists() and len(list(store.iterdir())) >= 3, child)
        out, err = self.interrupt(child)
        self.assertEqual(out, "")
        self.assertIn("continues from there", err)
        kept = self.stamps(store)
        self.assertGreaterEqual(len(kept), 3)
        return kept

    def test_output_files_and_reuse(self):
        arguments = (self.rest, "--preset", "fixed,fixed+taa=off", "--takes", "flicker,step")
        kept = self.interrupted(*arguments)
        done = self.neph(*self.command(*arguments, "--csv", "all.csv", "--markdown", "all.md",
                                       "--all"))
        self.assertEqual((self.folder / "all.md").read_text(), done.stdout)
        for word in ("march, 16 rays a pixel, 3 steps", "| first | second |", "Ranking by",
                     "16 frames resolve periods of 2 to 4"):
            self.assertIn(word, done.stdout)
        with open(self.folder / "all.csv", newline="") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual({row["preset"] for row in rows}, {"fixed", "fixed+taa=off"})
        for row in rows:
            self.assertTrue(row["value"] or row["because"], row)
            self.assertEqual(row["counts"] == "0", bool(row["because"]), row)
        xml.etree.ElementTree.parse(self.folder / "out/study" / "flicker_lag.svg")
        store = self.folder / "out/study" / "store" / "frames"
        entries = self.stamps(store)
        # a static frame, two frames of the step, each averaged and not averaged; captures
        self.assertEqual(len(entries), 2 + 4 + 4)
        self.assertEqual({path: entries[path] for path in kept}, kept)
        lines = self.neph(*self.command(*arguments)).stdout
        self.assertRegex(lines, r"^Flicker seen, contrast over threshold: fixed\S* [0-9.e+-]+, "
                                r"fixed\S* [0-9.e+-]+: [0-9.e+-]+ times: not told apart, p = 1, "
                                r".* \(1 scene, 1 seed\)\n")
        self.assertLessEqual(lines.count("\n"), 10)
        again = self.study(*arguments)
        self.assertIn("taa=off", again["presets"][1]["settings"])
        self.assertEqual(len(again["results"]), len(rows))
        self.assertEqual(self.stamps(store), entries)
        by_one, by_two = (self.study(*arguments[:-1], "flicker", "-o", folder, "--jobs", jobs,
                                     floors=True)
                           for folder, jobs in (("out/study", 1), ("two", 2)))
        self.assertEqual(without_times(by_two), without_times(by_one))

    def test_seeds_begin_with_the_first(self):
        words = (self.rest, "--preset", "fixed", "--takes", "flicker")
        both, second = (self.json(*self.command(*words), *seeds)["results"]
                        for seeds in (("--seeds", 2), ("--seed", 2)))
        self.assertEqual([row for row in both if row["seed"] == 2], second)
        self.assertEqual({row["seed"] for row in both}, {1, 2})

    def test_steps_do_not_depend_on_how_many_processes_render_them(self):
        found = []
        for jobs in "12":
            done = self.neph("study", "steps", "march", self.rest, "--size", "8x4", "--json",
                             "--jobs", jobs, "-o", jobs)
            self.assertEqual("part 5: done" in done.stderr, jobs == "2", done.stderr)
            found.append(without_times(json.loads(done.stdout)))
        self.assertEqual(found[0], found[1])
        self.assertEqual(len(found[0]["levels"]), 5)

    def test_wrong_words(self):
        rest = self.rest
        self.check_refusals(
            (64, ("best", "tuning"), ("--suite", "best")),
            (64, ("motion_test is shut", "no preset is measured", "--open-shut-suite"),
             ("--suite", "motion_test")),
            (64, "not both", ("--suite", "test", rest)),
            (64, ("nope", "off, seed"), (rest, "--preset", "nope")),
            (64, "'ours' is twice", (rest, "--preset", "ours,fixed,ours")),
            (64, "'zzz'", (rest, "--preset", "ours+zzz=1")),
            (64, ("'turn'", "sine"), (rest, "--takes", "turn")),
            (64, "multiple of 4", (rest, "--frames", "18")),
            (66, "no_such", ("no_such",)), before=("study", "flicker", "-q"))

    def test_kinds_are_listed(self):
        text = self.neph("study", "--help").stdout
        self.assertIn("flicker", text)
        self.assertIn("steps", text)
        self.neph("study", "flickers", code=64, said="steps, flicker")


if __name__ == "__main__":
    unittest.main()
