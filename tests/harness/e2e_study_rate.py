#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""`neph study flicker --fps` as a user sees it, with tiny frames."""
import csv
import unittest

from neph_case import StudyCase

# A camera, a wind and a box, each with a key at 0 s and one 0.6 s later.
SCENE = """
name: moves
title: a test
description: a test
camera:
  vertical_fov_deg: 40
  keys:
    - {{frame: 0, position_m: [0, 2, 0], look_at_m: [0, 2, -10]}}
    - {{frame: {last}, position_m: [1, 2, 0], look_at_m: [0, 2, -10]}}
frames: {{count: {count}, rate_hz: {rate}}}
sun: {{direction: [0.6, 0.75, 0.3], irradiance_w_per_m2: [6, 6, 6]}}
wind:
  keys:
    - {{frame: 0, velocity_m_per_s: [2, 0, 0]}}
    - {{frame: {last}, velocity_m_per_s: [4, 0, 0]}}
background_w_per_m2_sr: [0.5, 0.25, 0.125]
scattering: single
solids:
  - box:
      min_m: [0.1, -6, -21]
      max_m: [3, 6, -20]
      albedo: [0.2, 0.2, 0.2]
      motion:
        keys:
          - {{frame: 0, move_m: [0, 0, 0]}}
          - {{frame: {last}, move_m: [2, 0, 0]}}
media:
  - gaussian: {{center_m: [-2, 3, -30], width_m: 3, extinction_per_m: 0.3, albedo: [1, 1, 1]}}
"""
PAUSED = SCENE.replace("rate_hz: {rate}", "rate_hz: {rate}, pauses: [{{frame: 2, count: 3}}]")


class StudyRate(StudyCase):
    words = ("study", "flicker")
    small = ("--preset", "fixed", "--takes", "flicker", "--size", "24x16", "--steps", 2, "--seeds",
             1, "--no-floor", "--frames", 16, "--fps", 60, "-q")

    def test_a_scene_at_another_rate_is_the_scene_with_its_keys_moved(self):
        slow = self.put("slow/moves.yaml", SCENE.format(count=20, rate=30, last=18))
        found = self.json(slow, *self.small, "--csv", "all.csv")
        self.assertEqual((found["fps"], found["frames"]), (60, 32))
        self.assertEqual(found["scenes"][0]["frames"], 32)
        self.assertEqual({len(row["at_displays"]) for row in found["results"]
                          if row["metric"].startswith("seen")}, {2})
        with open(self.folder / "all.csv", newline="") as file:
            self.assertEqual([key for key in next(csv.reader(file)) if key.startswith("at_")],
                             ["at_60_hz_60_ppd", "at_60_hz_30_ppd"])
        store = self.stamps(self.folder / "out/study/store/frames")
        fast = self.put("fast/moves.yaml", SCENE.format(count=40, rate=60, last=36))
        self.assertEqual(self.json(fast, *self.small)["results"], found["results"])
        self.assertEqual(self.stamps(self.folder / "out/study/store/frames"), store)

    def test_a_scene_that_counts_frames_is_left_out(self):
        paused = self.put("moves.yaml", PAUSED.format(count=20, rate=30, last=18))
        found = self.json(paused, *self.small)
        self.assertIn("frames.pauses", found["scenes"][0]["left_out"])
        self.assertEqual(found["results"], [])

    def test_rates_that_are_refused(self):
        self.check_refusals((64, "15..240", ("--fps", "5")),
                            (64, "less than 16", ("--fps", "15", "--frames", "28")))


if __name__ == "__main__":
    unittest.main()
