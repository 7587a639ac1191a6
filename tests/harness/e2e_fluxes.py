#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""`neph fluxes`: a slab against published values, both engines against each other, all forms; and
the I3RC suite from the command line."""
import csv
import math
import os
import signal
import subprocess
import time
import unittest
import xml.etree.ElementTree

from neph_case import NEPH, NephCase

# Conservative slab, Henyey-Greenstein 0.85, cosine of the sun 0.7: reflectance by optical depth,
# from adding-doubling, which cdisort with 128 streams confirms to 7 digits.
SLABS = {1: 0.0907, 4: 0.3109}
SCENE = """name: {name}
title: A slab over a ground
description: Homogeneous, endless to the sides.
camera: {{position_m: [0, 50, 0], look_at_m: [0, 0, 0], up: [0, 0, -1], vertical_fov_deg: 60}}
sun: {{direction: [0.714143, 0.7, 0], irradiance_w_per_m2: [2, 2, 2]}}
scattering: multiple
media:
  - homogeneous:
      extinction_per_m: {extinction}
      albedo: [{albedo}, {albedo}, {albedo}]
      phase: henyey_greenstein
      asymmetry_g: 0.85
      bounds: {{min_m: [-1000000, 0, -1000000], max_m: [1000000, 10, 1000000]}}
{solids}"""
GROUND = """solids:
  - box: {{min_m: [-1000000, -1, -1000000], max_m: [1000000, 0, 1000000],
           albedo: [{0}, {0}, {0}]}}
"""
CELLS = """name: cells
title: Two clouds and a gap
description: Constant cells, repeated without end.
camera: {position_m: [0, 50, 0], look_at_m: [0, 0, 0], up: [0, 0, -1], vertical_fov_deg: 60}
sun: {direction: [-0.8, 0.6, 0], irradiance_w_per_m2: [1, 1, 1]}
scattering: multiple
media:
  - grid:
      size: [4, 2, 1]
      origin_m: [5, 2.5, 0]
      spacing_m: [10, 5, 10]
      repeat: [0, 1, 0]
      interpolation: constant
      values: [0, 1, 3, 1, 0, 0, 2, 4]
      extinction_per_m: 0.1
      albedo: [0.9, 0.9, 0.9]
      phase: henyey_greenstein
      asymmetry_g: 0.6
"""


class Fluxes(NephCase):
    def slab(self, depth, albedo=1, ground=None):
        name = f"slab_{depth}{'_ground' if ground else ''}"
        return self.put(f"{name}.yaml", SCENE.format(
            name=name, extinction=depth / 10, albedo=albedo,
            solids=GROUND.format(ground) if ground is not None else ""))

    def fluxes(self, scene, *arguments):
        return self.json("fluxes", scene, "-q", *arguments)["fluxes"]

    def check(self, flux, expected, error=0.0):
        """Within four standard errors."""
        found, own = flux["mean"][0], flux["standard_error"][0]
        self.assertLess(abs(found - expected), 4 * math.hypot(own, error) + 1e-9)

    def test_a_slab(self):
        for depth, reflected in SLABS.items():
            found = self.fluxes(self.slab(depth), "--samples", 20000)
            self.check(found["reflected"], reflected, 5e-5)  # four digits
            self.check(found["transmitted"], 1 - reflected, 5e-5)
            self.assertAlmostEqual(found["direct"]["mean"][0], math.exp(-depth / 0.7), delta=1e-6)
            self.assertLess(found["reflected"]["standard_error"][0], 0.005)

    def test_a_ground_reflects(self):
        found = self.fluxes(self.slab(2, 0.95, 0.3), "--samples", 20000, "--columns", "2x1")
        down = found["transmitted"]
        self.check(found["upward"], 0.3 * down["mean"][0], 0.3 * down["standard_error"][0])
        self.check(found["horizontal"], 0.0)
        self.assertGreater(found["absorbed"]["mean"][0], 0.05)

    def test_the_tracer_agrees_with_the_photons(self):
        scene = self.put("cells.yaml", CELLS)
        photons = self.fluxes(scene, "--columns", "4x1", "--samples", 100000)
        paths = self.fluxes(scene, "--columns", "4x1", "--samples", 6000, "-e", "tracer")
        for name, flux in photons.items():
            for column in range(4):
                a, b = flux["columns"][0][column], paths[name]["columns"][0][column]
                error = math.hypot(flux["column_errors"][0][column],
                                   paths[name]["column_errors"][0][column])
                self.assertLess(abs(a - b), 4.5 * error + 1e-6, (name, column, a, b))
        self.check(photons["horizontal"], 0.0)
        self.check(paths["horizontal"], 0.0)

    def test_all_forms_agree(self):
        scene = self.put("cells.yaml", CELLS)
        arguments = ("fluxes", scene, "--columns", "4x2", "--samples", 256, "-q")
        found = self.json(*arguments, "--csv", self.folder / "f.csv", "--exr",
                          self.folder / "f.exr", "--plot", self.folder / "f.svg")
        rows = list(csv.DictReader((self.folder / "f.csv").read_text().splitlines()))
        self.assertEqual(len(rows), 8)
        self.assertEqual([float(row["x_m"]) for row in rows[:4]], [5, 15, 25, 35])
        self.assertTrue(found["domain"]["repeats_x"] and found["domain"]["repeats_z"])
        for name, flux in found["fluxes"].items():
            for row, value in zip(rows, flux["columns"][0]):
                self.assertAlmostEqual(float(row[name]), value, delta=1e-6)
        root = xml.etree.ElementTree.parse(self.folder / "f.svg").getroot()
        self.assertIn("absorbed", "".join(root.itertext()))
        text = self.neph(*arguments).stdout
        self.assertIn(f"{found['fluxes']['reflected']['mean'][0]:.5f}", text)
        self.json(*arguments, "--exr", self.folder / "g.exr")
        self.neph("compare", self.folder / "g.exr", "-r", self.folder / "f.exr", "--layer",
                  "zenith_error", "-q")
        again = self.json(*arguments, NEPH_THREADS="3")
        self.assertEqual(again["fluxes"], found["fluxes"])

    def test_doubtful_errors_are_told(self):
        self.neph("fluxes", self.slab(4), "--samples", 16, "-q", said="not to be trusted")

    def test_an_interruption_ends_it(self):
        """Each batch would take minutes."""
        with subprocess.Popen([NEPH, "fluxes", self.slab(4), "--samples", "100000000", "-q"],
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE) as running:
            time.sleep(1)
            running.send_signal(signal.SIGINT)
            self.assertEqual(running.communicate(timeout=60)[0], b"")
            self.assertEqual(running.returncode, 130)

    def test_refusals(self):
        slab = self.slab(1)
        self.check_refusals(
            (64, ("march", "-e oracle"), (slab, "-e", "march")),
            (64, "1..1024", (slab, "--columns", "2000x1")),
            (64, "--samples", (slab, "--samples", 1)),
            (65, "between the levels", (slab, "--top", 5)),
            (65, "no sun", ("white_furnace",)),
            (66, "missing", ("missing",)),
            before=("fluxes",))
        bad = self.put("cells.yaml", CELLS.replace("constant", "nearest"))
        self.neph("fluxes", bad, code=65, said=("interpolation", "trilinear", "constant"))


class I3rc(NephCase):
    def validate(self, *arguments, **options):
        return self.neph("validate", "--suite", "i3rc", "-o", self.folder / "out", "-q",
                         *arguments, **options)

    def test_without_files(self):
        done = self.validate("--only", "case2", code=1, NEPH_I3RC_DATA="")
        self.assertIn("not here", done.stdout)
        self.assertIn("https://github.com/", done.stdout)
        self.assertIn("no verdict", done.stderr)
        self.assertTrue((self.folder / "out" / "i3rc.json").exists())

    def test_a_consensus_that_differs(self):
        """Case 1 has its cloud without files; its reflectance is 0.3277 (truth/step_cloud.h)."""
        for value, code in ((0.3277, 0), (0.9, 1)):
            self.put("data/case1_exp1_R.txt", f"  {value:.5E}\n" * 32)
            self.validate("--only", "case1_exp1", "--samples", 300, code=code,
                          NEPH_I3RC_DATA=str(self.folder / "data"))

    def test_bad_files(self):
        self.put("data/case1_exp1_R.txt", "0.3\n0.2 x\n")
        self.validate("--only", "case1_exp1", code=65, said=("case1_exp1_R.txt:2:5", "'x'"),
                      NEPH_I3RC_DATA=str(self.folder / "data"))
        self.validate("--only", "case9", code=64, said="case9")
        self.validate("step_cloud", code=64, said="own scenes")

    @unittest.skipUnless(os.environ.get("NEPH_I3RC_DATA"), "NEPH_I3RC_DATA names no folder")
    def test_the_radar_cloud(self):
        self.validate("--only", "case2_exp1", "--samples", 800)


if __name__ == "__main__":
    unittest.main(verbosity=2)
