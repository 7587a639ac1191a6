#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""`neph study light` as a user runs it, with tiny frames: tables, files, reuse, a fit, refused
arguments."""
import csv
import json
import unittest
import xml.etree.ElementTree

import night
from neph_case import StudyCase

# Optical depth 6 along the vertical: half of the frame is dense.
SLAB = """
name: slab
title: a test
description: a test
camera: {position_m: [0, 8, 0], look_at_m: [1, 0, -4], vertical_fov_deg: 40}
sun: {direction: [0.6, 0.75, 0.3], irradiance_w_per_m2: [6, 6, 6]}
background_w_per_m2_sr: [0.5, 0.25, 0.125]
scattering: multiple
media:
  - homogeneous:
      extinction_per_m: 2
      albedo: [0.9, 0.9, 0.9]
      bounds: {min_m: [-1000, -3, -1000], max_m: [1000, 0, 1000]}
"""
DARK = SLAB.replace("slab", "dark").replace("sun:", "# sun:")
LITTLE = ("--size", "12x8", "--steps", "32", "--noise-limit", "0.5", "--samples", "4")


class StudyLight(StudyCase):
    words = ("study", "light", *LITTLE)

    def setUp(self):
        super().setUp()
        self.put("slab.yaml", SLAB)
        self.put("dark.yaml", DARK)

    def test_models_files_and_reuse(self):
        table, lines = self.folder / "light.md", self.folder / "light.csv"
        fit = self.folder / "fit.inc"
        models = "march,march_horizon"
        arguments = ("slab.yaml", "--model", models, "--suns", "50:180", "--albedo", "1,0.9",
                     "--csv", lines, "--markdown", table, "--fit", fit)
        found = self.json(*arguments)
        self.assertEqual([c["albedo"] for c in found["cells"]], [1, 0.9])
        bias = {}
        for cell in found["cells"]:
            self.assertAlmostEqual(cell["sun_elevation_deg"], 50)
            self.assertAlmostEqual(abs(cell["sun_azimuth_deg"]), 180)
            once, horizon = cell["models"]
            self.assertTrue(once["scattered_once"])
            self.assertIn("Horizon", horizon["because"])
            self.assertGreater(cell["optical_depth"], 6)
            self.assertGreater(once["dense"]["pixels"], 40)
            # single scattering is a part of all orders; in a thick white slab a small one
            self.assertLess(once["dense"]["bias"], -0.3)
            bias[cell["albedo"]] = once["dense"]["bias"]
        self.assertLess(bias[1], bias[0.9])
        self.assertEqual([v["look"] for v in found["verdicts"]], [False, True])
        self.assertEqual([v["all"]["cells"] for v in found["verdicts"]], [2, 0])
        # every pixel with media is in a bin of each map
        for model, maps in enumerate(found["maps"]):
            for name in ("eye_sun", "eye_angle"):
                pixels = sum(b["pixels"] for row in maps[name] for b in row)
                self.assertEqual(pixels, sum(c["models"][model]["all"]["pixels"]
                                             for c in found["cells"]))
        with lines.open(newline="") as file:
            self.assertEqual(len(list(csv.DictReader(file))), 4)
        self.assertIn("| march | dense parts | 2 |", table.read_text())
        xml.etree.ElementTree.parse(self.folder / "out/study" / "light.svg")
        self.assertIn(".attenuation = {", fit.read_text())
        store = self.folder / "out/study" / "store" / "frames"
        before = self.stamps(store)
        self.assertEqual(self.json(*arguments), found)
        self.assertEqual(self.stamps(store), before)

    def test_results_do_not_depend_on_the_number_of_jobs(self):
        def results(jobs):
            found = self.json("slab.yaml", "--model", "march", "--albedo", "1,0.9", "--jobs",
                              jobs, "-o", f"out{jobs}")
            for cell in found["cells"]:
                del cell["tracer_s"], cell["models"][0]["render_s"]
            return found, (self.folder / f"out{jobs}" / "light.svg").read_bytes()
        self.assertEqual(results(1), results(2))

    @night.of_the_night
    def test_a_sinking_sun_affects_histories(self):
        bias = {}
        for speed in (0, 50):
            found = self.json("slab.yaml", "--model", "realtime+lighting=octaves,march_octaves",
                              "--suns", "8:0", "--sun-speed", speed)
            self.assertEqual(found["sun_speed_deg_per_s"], speed)
            bias[speed] = [m["all"]["bias"] for m in found["cells"][0]["models"]]
        self.assertEqual(bias[0][1], bias[50][1])
        # Half a second ago the sun was at 34 degrees, now it is at 8: its old light is too bright.
        self.assertGreater(bias[50][0], bias[0][0] + 0.02)

    def test_refusals(self):
        self.check_refusals(
            (64, "there is no suite 'both'", ("--suite", "both")),
            (64, "a suite or scenes by name", ("--suite", "test", "slab.yaml")),
            (64, "evaluates fits", ("--fit", "x.inc")),
            (64, "are of a SCENE", ("--suns", "50:180")),
            (64, "no elevation and azimuth", ("slab.yaml", "--suns", "50")),
            (64, "--sun-speed", ("slab.yaml", "--sun-speed", "51")),
            (64, "is no number", ("slab.yaml", "--g", "much")),
            (64, "is no lighting model", ("slab.yaml", "--model", "tracer")),
            (64, "outside -0.999..0.999", ("slab.yaml", "--g", "1.5")),
            (66, "nowhere", ("nowhere",)))

    def test_unlit_cells_and_laws(self):
        table = self.folder / "laws.md"
        done = self.neph("dark.yaml", "--model", "march_octaves_fitted,march_horizon", "--laws",
                         "--markdown", table, "--json", "--jobs", 2)
        self.assertIn("[2/2] part", done.stderr)  # the laws are a part, too
        found = json.loads(done.stdout)
        cell, = found["cells"]
        self.assertIn("no sun", cell["left_out"])
        self.assertEqual([m["dense"]["pixels"] for m in cell["models"]], [0, 0])
        # Fitted octaves are non-physical: reciprocal, but energy is lost in a white slab.
        of = {(law["law"], law["optical_depth"], law["albedo"]): law for law in found["laws"]}
        through = of["transmitted, slab", 16, 1]
        octaves, horizon = through["models"]
        self.assertTrue(octaves["look"])
        self.assertIsNone(horizon["value"])
        self.assertAlmostEqual(through["truth"] + of["reflected, slab", 16, 1]["truth"], 1, 6)
        self.assertTrue(0.1 < octaves["value"] < 0.4)
        self.assertAlmostEqual(of["reciprocity, slab", 4, 1]["models"][0]["value"], 1, 2)
        self.assertLess(of["R + T + A, slab", 4, 1]["models"][0]["value"], 0.9)
        self.assertIn("| white furnace, ball | 1 |", table.read_text())


if __name__ == "__main__":
    unittest.main()
