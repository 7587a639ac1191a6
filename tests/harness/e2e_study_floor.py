#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Floors of `neph study flicker` as a user sees them, with tiny frames."""
import csv
import unittest

from neph_case import StudyCase

SCENE = """
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
PLAIN = "off+taa=on"


class StudyFloor(StudyCase):
    def command(self, *arguments):
        return ("study", "flicker", self.put("rest.yaml", SCENE), "--preset", f"fixed,ours,{PLAIN}",
                "--takes", "flicker", "--size", "24x16", "--steps", 3, "--frames", 16, "--seeds", 1,
                *arguments)

    def test_each_preset_over_its_floor(self):
        found = self.json(*self.command("--csv", "all.csv", "-q"))
        of_ours = found["floors"][1]["floors"]
        self.assertEqual([floor["floors"] for floor in found["floors"]],
                         [[PLAIN, PLAIN], [of_ours[0], PLAIN], [PLAIN, PLAIN]])
        self.assertIn("off+taa=on+", of_ours[0])
        # two frames of the reference; three presets, of which one is a floor, and one more floor
        store = self.stamps(self.folder / "out/study/store/frames")
        self.assertEqual(len(store), 2 + 3 + 1)
        values = {(row["preset"], row["metric"]): row["value"] for row in found["results"]
                  if row["mask"] == "all"}
        ratios = [row for row in found["times_floor"]
                  if (row["mask"], row["rate_hz"], row["pixels_per_degree"]) == ("all", 30, 60)]
        for row in ratios:
            metric = row["metric"]
            if row["preset"] == PLAIN:
                self.assertEqual((row["times"], row["alike"]), (1.0, 1))
            elif metric == "rel_rmse":
                floor = min(values[words, metric] for words in
                            (of_ours if row["preset"] == "ours" else [PLAIN]))
                self.assertAlmostEqual(row["floor"], floor, delta=1e-9 * floor)
                self.assertAlmostEqual(row["times"], values[row["preset"], metric] / floor,
                                       delta=1e-9)
        self.assertEqual({row["preset"] for row in ratios}, {"fixed", "ours", PLAIN})
        pairs = {word for pair in found["pairs"] for word in (pair["first"], pair["second"])}
        self.assertEqual(pairs, {"fixed", "ours", PLAIN})
        with open(self.folder / "all.csv", newline="") as file:
            for row in csv.DictReader(file):
                self.assertEqual(row["is_floor"] == "1", row["preset"] == of_ours[0], row)
        self.check_answer(store)

    def check_answer(self, store):
        """From the store; without floors nothing else changes."""
        text = self.neph(*self.command()).stdout
        self.assertRegex(text, r"\nFlicker seen, contrast over threshold: (\S+) \S+, floor \S+: "
                               r"\S+ times \(every pixel marched, 1 scene\)\n"
                               r"\1 over its floor: error")
        self.assertRegex(text, r"^Flicker seen.*: \S+ \S+ \(floor \S+\), \S+ \S+ \(floor \S+\): ")
        self.assertLessEqual(text.count("\n"), 10)
        text = self.neph(*self.command("--all")).stdout
        self.assertIn("| floor of fixed, off+taa=on | floor of ours |", text)
        text = self.neph(*self.command("--no-floor")).stdout
        self.assertIn("\nwithout floors (--no-floor)\n", text)
        self.assertNotIn("(floor ", text)
        self.assertEqual(self.stamps(self.folder / "out/study/store/frames"), store)


if __name__ == "__main__":
    unittest.main()
