#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""`neph study fog` and the engine of looks as a user runs them: files, pictures, refusals."""
import csv
import json
import os
import pathlib
import subprocess
import tempfile
import unittest

from frames import read_exr

NEPH = os.environ["NEPH"]
ENVIRONMENT = {**os.environ, "NEPH_VULKAN_VALIDATION": "1"}
LITTLE = ("--size", "12x8", "--directions", "64")


class StudyFog(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def run_neph(self, *arguments):
        return subprocess.run([NEPH, *map(str, arguments)], cwd=self.folder, env=ENVIRONMENT,
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                              timeout=120)

    def test_a_table_and_its_files(self):
        done = self.run_neph("study", "fog", "fog_look_evening", *LITTLE, "--json", "--csv",
                             "a.csv", "--markdown", "a.md")
        self.assertEqual(done.returncode, 0, done.stderr)
        found = json.loads(done.stdout)
        rows = {row["controls"]: row for row in found["rows"]}
        self.assertEqual({row["model"] for row in found["rows"]}, {"unreal"})  # it has two layers
        self.assertAlmostEqual(rows["cutoff_distance"]["transmittance_jump_m"], 5000, 3)
        self.assertGreater(rows["cutoff_distance"]["transmittance_jump"], 0.9)
        self.assertLess(rows["none"]["transmittance_worst"], 1e-5)
        with open(self.folder / "a.csv", newline="") as file:
            lines = list(csv.DictReader(file))
        self.assertEqual([line["controls"] for line in lines], list(rows))
        self.assertEqual(len(found["rows"]), len(rows))
        text = (self.folder / "a.md").read_text()
        for line, (name, row) in zip(lines, rows.items()):
            self.assertIn(f"| unreal | {name} | {row['transmittance_bias']:+.4f} |", text)
            for number, value in row.items():
                if number not in ("model", "controls"):
                    self.assertEqual(line[number], "" if value is None else f"{value:.9g}", number)

    def test_refusals(self):
        for code, words, arguments in ((64, "'unity'", ("fog_look_ridge", "--model", "unity")),
                                       (2, "second layer",
                                        ("fog_look_evening", "--model", "filament")),
                                       (2, "without a look", ("height_fog_up",)),
                                       (66, "nowhere", ("nowhere",))):
            done = self.run_neph("study", "fog", *arguments)
            self.assertEqual(done.returncode, code, done.stderr)
            self.assertIn(words, done.stderr)

    def test_a_control_alone_is_what_it_says(self):
        pictures = {}
        for controls in ("none", "max_opacity", "cutoff_distance"):
            done = self.run_neph("render", "fog_look_evening", "-e", "fog_look", "-s",
                                 f"controls={controls}", "--size", "12x8", "-o", controls)
            self.assertEqual(done.returncode, 0, done.stderr)
            path, = (self.folder / controls).glob("*.exr")
            pictures[controls] = read_exr(path)[2]
        through = {name: channels["transmittance.G"] for name, channels in pictures.items()}
        for plain, held, cut, depth_m in zip(*through.values(), pictures["none"]["Z"]):
            self.assertAlmostEqual(held, max(plain, 0.1), 6)
            if not 4000 <= depth_m <= 5500:
                self.assertAlmostEqual(cut, 1 if depth_m > 5500 else plain, 6)

    def test_a_scene_is_told_in_three_worlds(self):
        done = self.run_neph("scenes", "fog_look_ridge")
        self.assertEqual(done.returncode, 0, done.stderr)
        for words in ("physical               Unreal                 Filament", "655.36",
                      "of the look no medium has:", "of the medium no look has:"):
            self.assertIn(words, done.stdout)
        fog = json.loads(self.run_neph("scenes", "fog_look_ridge", "--json").stdout)["fog"]
        on = [control["name"] for control in fog["look"]["controls"] if control["on"]]
        self.assertEqual(on, ["sky_light", "max_opacity", "volumetric_fog_distance",
                              "observer_height_max"])


if __name__ == "__main__":
    unittest.main()
