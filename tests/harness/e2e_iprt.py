#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""neph validate --suite iprt, with files that the test writes: droplets without a sharp peak, and
results that are read from the suite's own answer."""
import json
import math
import os
import unittest

import neph_case

ANGLES = [180 - a for a in range(181)]


def henyey_greenstein(g, degrees):
    """With the integral 4 pi."""
    return (1 - g * g) / (1 + g * g - 2 * g * math.cos(math.radians(degrees))) ** 1.5


class Iprt(neph_case.NephCase):
    in_folder = True

    def put_phase(self, g=0.5):
        values = " ".join(f"{henyey_greenstein(g, a):.6e}" for a in ANGLES)
        self.put("data/watercloud.mie.dat", "# Scattering angles:\n" + " ".join(map(str, ANGLES)) +
                 "\n# Phase matrix P1:\n" + values + "\n")

    def put_results(self, radiance=lambda row: 0.01, name="a5_plane_code.dat"):
        """The sun at 50 degrees; the principal plane, below and above."""
        rows = [(height, zenith, azimuth) for height in (0, 1) for zenith in (95, 130, 170)
                for azimuth in (0, 180)]
        self.put(f"data/{name}", "# zout sza saa va phi I Q U V Istd\n" + "".join(
            f"{z}.0 50.0 0.0 {va}.0 {phi}.0 {radiance(i):.8e} 0 0 0 1e-5\n"
            for i, (z, va, phi) in enumerate(rows)))

    def run_suite(self, code):
        done = self.neph("validate", "--suite", "iprt", "--samples", 640, "--json", "-o", "out",
                         code=code, NEPH_IPRT_DATA="data")
        return json.loads(done.stdout)

    def test_results_are_compared(self):
        self.put_phase()
        self.put_results()
        first = self.run_suite(1)
        self.assertEqual((first["compared"], first["failed"]), (12, 12))
        rows = first["rows"]
        for row in rows:  # two methods
            self.assertLess(abs(row["oracle"] / row["doubling"] - 1),
                            0.01 + 5 * row["oracle_standard_error"] / row["doubling"], row)
        near, = [row["from_sun_deg"] for row in rows if row["from_sun_deg"] <= 5]
        self.assertLess(near, 1e-6)
        self.put_results(lambda i: rows[i]["doubling"], "iprt_case_A5_CODE.dat")
        (self.folder / "data/a5_plane_code.dat").unlink()
        again = self.run_suite(0)
        self.assertEqual((again["compared"], again["failed"]), (12, 0))
        self.assertAlmostEqual(again["rows"][3]["theirs_standard_deviation"], 1e-5)
        # 1 % beyond 5 degrees, 2 % within: row 2 is that towards the sun.
        self.put_results(name="iprt_case_A5_CODE.dat",
                         radiance=lambda i: rows[i]["doubling"] * (1.015 if i in (2, 5) else 1))
        failed = self.run_suite(1)
        self.assertEqual([row["agrees"] for row in failed["rows"]].index(False), 5)
        self.assertEqual(failed["failed"], 1)

    def test_what_is_missing_or_damaged(self):
        here = {"surroundings": {k: v for k, v in os.environ.items() if k != "NEPH_IPRT_DATA"}}
        done = self.neph("validate", "--suite", "iprt", "-o", "out", code=1,
                         said=("nothing was compared", "NEPH_IPRT_DATA=FOLDER"), **here)
        self.assertIn("not here: NEPH_IPRT_DATA names no folder", done.stdout)
        self.put_phase()
        words = ("validate", "--suite", "iprt", "-o", "out")
        self.neph(*words, code=1, said="nothing was compared", NEPH_IPRT_DATA="data")
        for text, said in (("0 50 0 130 x 1\n", "a5_bad.dat:1:12: 'x' is not"),
                           ("# c\n0 50 0 130 0 -1\n", "a5_bad.dat:2:14: -1 is not"),
                           ("0 50 0 130\n0 50 0 140 0 0.01\n", "the line ends where an azimuth"),
                           ("", "it is empty")):
            self.put("data/a5_bad.dat", text)
            self.neph(*words, code=65, said=said, NEPH_IPRT_DATA="data")
        self.put("data/watercloud.mie.dat",
                 "# Scattering angles:\n0 90 180\n# Phase matrix P1:\n1 1\n")
        self.neph(*words, code=65, said="3 angles, and 2 values of P1", NEPH_IPRT_DATA="data")
        self.neph(*words, "-e", "tracer", code=64, said="the IPRT suite has its own scene")


if __name__ == "__main__":
    unittest.main()
