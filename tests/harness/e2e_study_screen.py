#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""`neph study screen` as a user runs it, in tiny pictures: tables, files, reuse, refusals."""
import json
import os
import pathlib
import subprocess
import tempfile
import unittest

NEPH = os.environ["NEPH"]
ENVIRONMENT = {**os.environ, "NEPH_VULKAN_VALIDATION": "1"}


class StudyScreen(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def run_neph(self, *arguments):
        return subprocess.run([NEPH, "study", "screen", *arguments], cwd=self.folder,
                              env=ENVIRONMENT, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                              text=True, timeout=120)

    def test_a_table_and_its_files(self):
        # Slices know the step, whose foot is in the picture; nothing of it is behind anything.
        words = ("surface_step", "surface_rough", "--size", "24x14", "--samples", "64", "--models",
                 "screen+gi=off+frames=1+ssr_rays=1,screen+preset=slices+gi=off+ssr=off+frames=1",
                 "--markdown", "a.md", "--quiet")
        done = self.run_neph(*words, "--json")
        self.assertEqual(done.returncode, 0, done.stderr)
        found = json.loads(done.stdout)["scenes"]
        step = found["surface_step"]["ambient occlusion"]
        few, many = step["models"].values()
        self.assertLess(many["error"], 0.03)
        self.assertLess(step["lost"], 0.1 * step["pixels"])
        self.assertEqual(found["surface_step"]["far"]["behind"], 0.0)
        self.assertGreater(found["surface_rough"]["near"]["thin"], 0.01)
        self.assertEqual(found["surface_step"]["reflections"]["pixels"], 0)
        metal = found["surface_rough"]["reflections"]
        self.assertGreater(metal["pixels"], 200)
        first, second = metal["models"].values()
        self.assertGreater(first["error"], 0.0)
        self.assertIsNone(second["error"])  # it has none
        table = (self.folder / "a.md").read_text()
        self.assertIn("**ambient occlusion** [% of the hemisphere]", table)
        self.assertIn("| surface_rough | *no model can* |", table)
        again = self.run_neph(*words)
        self.assertEqual((self.folder / "a.md").read_text(), table)
        self.assertIn(table, again.stdout)

    def test_refusals(self):
        for code, words, arguments in ((64, "no screen", ("--models", "march")),
                                       (2, "without solids", ("height_fog_up",)),
                                       (66, "nowhere", ("nowhere",))):
            done = self.run_neph("--size", "4x4", "--samples", "2", *arguments)
            self.assertEqual(done.returncode, code, done.stderr)
            self.assertIn(words, done.stderr)


if __name__ == "__main__":
    unittest.main()
