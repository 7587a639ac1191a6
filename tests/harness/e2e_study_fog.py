#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""`neph study fog` and the non-physical engines as a user runs them: files, images, refused
arguments."""
import csv
import unittest

from frames import read_exr
from neph_case import StudyCase

LITTLE = ("--size", "12x8", "--directions", "64")


class StudyFog(StudyCase):
    def test_a_table_and_its_files(self):
        found = self.json("study", "fog", "fog_look_evening", *LITTLE, "--csv", "a.csv",
                          "--markdown", "a.md")
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
        self.check_refusals(
            (64, "'unity'", ("study", "fog", "fog_look_ridge", "--model", "unity")),
            (2, "second layer", ("study", "fog", "fog_look_evening", "--model", "filament")),
            (2, "without the key fog_look", ("study", "fog", "height_fog_up")),
            (66, "nowhere", ("study", "fog", "nowhere")))

    def test_a_control_alone_is_what_it_says(self):
        pictures = {}
        for controls in ("none", "max_opacity", "cutoff_distance"):
            self.neph("render", "fog_look_evening", "-e", "fog_look", "-s",
                      f"controls={controls}", "--size", "12x8", "-o", controls)
            path, = (self.folder / controls).glob("*.exr")
            pictures[controls] = read_exr(path)[2]
        through = {name: channels["transmittance.G"] for name, channels in pictures.items()}
        for plain, held, cut, depth_m in zip(*through.values(), pictures["none"]["Z"]):
            self.assertAlmostEqual(held, max(plain, 0.1), 6)
            if not 4000 <= depth_m <= 5500:
                self.assertAlmostEqual(cut, 1 if depth_m > 5500 else plain, 6)

    def test_a_scene_is_told_in_three_worlds(self):
        done = self.neph("scenes", "fog_look_ridge")
        for words in ("physical               Unreal                 Filament", "655.36",
                      "controls of the fog model without a counterpart",
                      "properties of the medium without a counterpart"):
            self.assertIn(words, done.stdout)
        fog = self.json("scenes", "fog_look_ridge")["fog"]
        on = [control["name"] for control in fog["look"]["controls"] if control["on"]]
        self.assertEqual(on, ["sky_light", "max_opacity", "volumetric_fog_distance",
                              "observer_height_max"])


if __name__ == "__main__":
    unittest.main()
