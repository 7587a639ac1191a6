#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""`neph study sky` as a user runs it, with tiny frames: tables, files, reuse, refused arguments."""
import json
import unittest

from neph_case import StudyCase

TABLES = "altitudes=8+suns=24+above=4+below=2+around=3+table_steps=8+orders=4"


class StudySky(StudyCase):
    words = ("study", "sky", "--size", "8x8", "--truth", "oracle", "--samples", "64")

    def test_cells_files_and_reuse(self):
        models = (f"sky+{TABLES},sky+multiple=closure+{TABLES},march,"
                  f"sky+on=device+{TABLES}")
        table = self.folder / "sky.md"
        arguments = ("--elevations", "30,-30", "--altitudes", "2", "--model", models, "--markdown",
                     table, "--json")
        done = self.neph(*arguments)
        found = json.loads(done.stdout)
        day, night = found["cells"]
        self.assertEqual([day["held"], night["held"]], [True, False])
        self.assertEqual(day["directions"], 2 * 2 * 2)
        orders, closure, march, device = day["models"].values()
        # An eighth of a direction's noise, at 64 samples of 16 pixels, remains in the mean.
        self.assertLess(abs(orders["bias"]), 0.05 + day["noise"])
        self.assertGreater(orders["mean"], 0.0)
        self.assertGreaterEqual(orders["worst"], orders["mean"])
        self.assertNotEqual(orders["bias"], closure["bias"])
        self.assertAlmostEqual(device["bias"], orders["bias"], delta=1e-5)
        self.assertIn("multiple scattering", march["cannot"])
        text = table.read_text()
        self.assertIn("| 30 | 0.002 |", text)
        self.assertIn("cannot: multiple scattering", text)
        self.assertIn("no light", text)
        self.assertEqual(self.neph(*arguments).stdout, done.stdout)

    def test_results_do_not_depend_on_the_number_of_jobs(self):
        def results(jobs):
            done = self.neph("--elevations", "30,5", "--altitudes", "2", "--samples", 2, "--model",
                             f"sky+degree=0+{TABLES}", "--jobs", jobs, "-o", f"out{jobs}",
                             "--json")
            found = json.loads(done.stdout)
            for cell in found["cells"]:
                for model in cell["models"].values():
                    del model["render_s"]
            return found, done.stderr
        one, two = results(1), results(2)
        self.assertEqual(one[0], two[0])
        self.assertIn("[2/2] part", two[1])

    def test_finer_tables_are_a_truth(self):
        cell, = self.json("--elevations", "30", "--altitudes", "2", "--truth", f"sky+{TABLES}",
                          "--model", f"sky+{TABLES},sky+{TABLES}+degree=0")["cells"]
        same, coarser = cell["models"].values()
        self.assertEqual([cell["noise"], same["mean"], same["worst"]], [0, 0, 0])
        self.assertGreater(coarser["mean"], 0.001)

    def test_refusals(self):
        self.check_refusals((64, "no number", ("--elevations", "high")),
                            (64, "sun 91 degrees", ("--elevations", "91")),
                            (64, "altitude of 0 m", ("--altitudes", "0")),
                            (64, "not a truth", ("--truth", "march")),
                            (64, "degree", ("--model", "sky+degree=9")),
                            (2, "no planet", ("fence_backlit",)))


if __name__ == "__main__":
    unittest.main()
