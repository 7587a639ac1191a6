#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""`neph droplets`: its numbers in all forms, and refused arguments."""
import csv
import math
import unittest
import xml.etree.ElementTree

from neph_case import NephCase

SMALL = ("--effective-radius", 2, "--wavelength", "610,465")


class Droplets(NephCase):
    def test_all_forms_agree(self):
        found = self.json("droplets", *SMALL, "--water", 0.25)
        text = self.neph("droplets", *SMALL, "--water", 0.25, "--csv",
                         self.folder / "phase.csv").stdout.splitlines()
        rows = list(csv.DictReader((self.folder / "phase.csv").read_text().splitlines()))
        self.assertEqual([float(row["angle_deg"]) for row in rows],
                         [round(angle, 2) for angle in found["angles_deg"]])
        self.assertEqual((rows[0]["angle_deg"], rows[-1]["angle_deg"]), ("0.00", "180.00"))
        for result, line, mixed in zip(found["results"], text[1:3], text[3:]):
            self.assertEqual(line.split()[0], f"{result['wavelength_nm']:g}")
            self.assertEqual(float(line.split()[-1]), round(result["asymmetry"], 4))
            column = f"phase_per_sr_{result['wavelength_nm']:g}nm"
            for row, value in zip(rows, result["phase_per_sr"]):
                self.assertAlmostEqual(float(row[column]) / value, 1.0, delta=1e-8)
            extinction = 0.25 * result["extinction_m2_per_g"]
            self.assertAlmostEqual(result["extinction_per_m"], extinction, delta=1e-12)
            self.assertAlmostEqual(result["visibility_2_percent_m"],
                                   math.log(50) / extinction, delta=1e-9)
            self.assertIn(f"extinction {extinction:.4g} /m", mixed)

    def test_the_phase_function_is_normalised(self):
        """By the trapezoidal rule."""
        found = self.json("droplets", *SMALL)
        angles = [math.radians(angle) for angle in found["angles_deg"]]
        for result in found["results"]:
            values = [2 * math.pi * value * math.sin(angle)
                      for value, angle in zip(result["phase_per_sr"], angles)]
            total = sum((b - a) * (f + g) / 2 for a, b, f, g in
                        zip(angles, angles[1:], values, values[1:]))
            mean = sum((b - a) * (f * math.cos(a) + g * math.cos(b)) / 2 for a, b, f, g in
                       zip(angles, angles[1:], values, values[1:]))
            self.assertAlmostEqual(total, 1.0, delta=2e-3)  # steps of 0.5 degrees
            self.assertAlmostEqual(mean, result["asymmetry"], delta=2e-3)

    def test_the_plot_has_a_curve_for_each_wavelength(self):
        self.neph("droplets", *SMALL, "--plot", self.folder / "phase.svg")
        paths = xml.etree.ElementTree.parse(self.folder / "phase.svg").iter(
            "{http://www.w3.org/2000/svg}path")
        curves = [path for path in paths if path.get("d").count("L") > 100]
        self.assertEqual(len(curves), 3)  # the first is Henyey-Greenstein
        self.assertEqual([path.get("stroke-dasharray") for path in curves],
                         ["5 4", "none", "none"])

    def test_size_distributions_differ(self):
        gamma, normal = (self.json("droplets", *SMALL, "--distribution", name)["results"][0]
                         for name in ("gamma", "log-normal"))
        self.assertAlmostEqual(gamma["extinction_efficiency"] / normal["extinction_efficiency"],
                               1.0, delta=0.02)  # the same effective radius and variance
        self.assertNotEqual(gamma["asymmetry"], normal["asymmetry"])

    def test_refusals(self):
        self.check_refusals(
            (65, ("1.2 um", "--index"), ("--wavelength", 1200)),
            (65, "size parameter", ("--effective-radius", 1000, "--wavelength", 300)),
            (65, "refractive index", ("--index", "1.3,-1")),
            (64, "1.33,1e-5", ("--index", "1.3")),
            (64, "log-normal", ("--distribution", "normal")),
            (64, "0.0001", ("--effective-variance", 0)),
            (64, "--effective-radius", ("--effective-radius", "x")),
            (64, "--water", ("--water", -1)),
            before=("droplets",))


if __name__ == "__main__":
    unittest.main(verbosity=2)
