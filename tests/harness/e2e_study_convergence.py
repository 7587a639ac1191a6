#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""`neph study convergence` as a user runs it."""
import csv
import json
import os
import pathlib
import subprocess
import tempfile
import unittest

NEPH = os.environ["NEPH"]
ENVIRONMENT = {**os.environ, "NEPH_VULKAN_VALIDATION": "1"}
# The second has neither history nor noise: all of its frames of a static scene are the same.
PRESETS = ("ours", "ours+split=none+taa=off+ray_dither=none")
LITTLE = ("--size", "32x18", "--frames", "16", "--steps", "4", "-q", "--presets",
          ",".join(PRESETS))


class StudyConvergence(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def run_neph(self, *arguments):
        return subprocess.run([NEPH, "study", "convergence", *arguments], cwd=self.folder,
                              env=ENVIRONMENT, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                              text=True, timeout=170)

    def test_errors_of_frames_are_the_same_for_any_number_of_jobs(self):
        scenes = ("fence_backlit", "height_fog_up")
        done = self.run_neph(*scenes, *LITTLE, "--json", "-o", "one", "--csv", "a.csv")
        self.assertEqual(done.returncode, 0, done.stderr)
        rows = json.loads(done.stdout)["rows"]
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
        parallel = self.run_neph(*scenes, *LITTLE, "--json", "-o", "two", "--jobs", "2")
        self.assertEqual(parallel.stdout, done.stdout, parallel.stderr)

    def test_what_is_refused(self):
        for arguments, code, word in ((("nonesuch",), 66, "nonesuch"), ((), 64, "which scenes?"),
                                      (("fence_sky", "--presets", "ours,ours"), 64, "twice"),
                                      (("fence_sky", "--presets", "nonesuch"), 64, "nonesuch")):
            done = self.run_neph(*arguments)
            self.assertEqual(done.returncode, code, done.stderr)
            self.assertIn(word, done.stderr)


if __name__ == "__main__":
    unittest.main()
