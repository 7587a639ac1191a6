#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""`neph study convergence` as a user runs it."""
import csv
import re
import unittest

from neph_case import StudyCase

# The second has neither history nor noise: all of its frames of a static scene are equal.
PRESETS = ("ours", "ours+split=none+taa=off+ray_dither=none")
LITTLE = ("--size", "32x18", "--frames", "16", "--steps", "4", "-q", "--preset",
          ",".join(PRESETS))


class StudyConvergence(StudyCase):
    words = ("study", "convergence")

    def test_errors_of_frames_are_the_same_for_any_number_of_jobs(self):
        scenes = ("fence_backlit", "height_fog_up")
        found = self.json(*scenes, *LITTLE, "-o", "one", "--csv", "a.csv")
        rows = found["rows"]
        self.assertEqual([(row["scene"], row["preset"]) for row in rows],
                         [(scene, preset) for scene in scenes
                          for preset in PRESETS])
        for row in rows:
            self.assertGreater(row["final_error"], 0)
            self.assertIsNone(row["error_32"])
            if row["preset"] == PRESETS[1]:
                self.assertEqual(row["settled_frame"], 1)
                self.assertEqual(len({row[f"error_{i}"] for i in (1, 2, 4, 8, 16)}), 1)
        with open(self.folder / "a.csv", newline="") as file:
            lines = list(csv.DictReader(file))
        self.assertEqual([line["settled_frame"] and float(line["settled_frame"]) for line in lines],
                         [row["settled_frame"] or "" for row in rows])
        self.assertEqual(self.json(*scenes, *LITTLE, "-o", "two", "--jobs", "2"), found)
        lines = self.neph(*scenes, *LITTLE, "-o", "one").stdout
        self.assertRegex(lines, f"^(not told apart from the next: )?{re.escape(PRESETS[1])}: "
                                "settled at frame 1, final error ")
        self.assertLessEqual(lines.count("\n"), 10)

    def test_refused_arguments(self):
        """Refused before anything is rendered."""
        self.check_refusals((66, "nonesuch", ("fence_sky", "nonesuch")), (64, "which scenes?", ()),
                            (64, "twice", ("fence_sky", "--preset", "ours,ours")),
                            (64, "nonesuch", ("fence_sky", "--preset", "ours,nonesuch")),
                            (64, "1..4096 pixels", ("fence_sky", "--size", "5000x9")),
                            (2, "multiple scattering", ("fence_sky", "slab_multiple_thin")))
        frames = self.folder / "out/study/store/frames"
        self.assertFalse(frames.exists() and any(frames.iterdir()))


if __name__ == "__main__":
    unittest.main()
