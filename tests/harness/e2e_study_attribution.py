#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""`neph study attribution` as a user runs it, with tiny frames."""
import csv
import itertools
import math
import unittest

from neph_case import StudyCase

SCENE = """
name: drift
title: a test
description: a test
camera: {position_m: [0, 2, 0], look_at_m: [0, 2, -10], vertical_fov_deg: 40}
frames: {count: 16, rate_hz: 30}
wind: {velocity_m_per_s: [12, 0, 0]}
sun: {direction: [0.6, 0.75, 0.3], irradiance_w_per_m2: [6, 6, 6]}
background_w_per_m2_sr: [0.5, 0.25, 0.125]
scattering: single
solids:
  - box: {min_m: [0.1, -6, -21], max_m: [0.5, 6, -20], albedo: [0.2, 0.2, 0.2]}
media:
  - gaussian: {center_m: [-2, 3, -30], width_m: 3, extinction_per_m: 0.3, albedo: [1, 1, 1]}
"""
CHILDREN = ["reprojection", "disocclusion", "box", "noise"]
PARTS = ["rays", *CHILDREN, "upscale", "blur", "aliasing"]


class StudyAttribution(StudyCase):
    words = ("study", "attribution")

    def command(self, *arguments):
        return (self.put("drift.yaml", SCENE), "--size", "48x27", "--steps", 4, "--frames", 16,
                "--seeds", 1, *arguments)

    def check_shares(self, found):
        """Shares are means over all orders."""
        values = {frozenset(row["real"]): row["seen"] ** 2 for row in found["values"]}
        self.assertEqual((len(found["values"]), len(values)), (136, 136))
        self.assertEqual(values[frozenset()], 0.0)
        orders = [order for order in itertools.permutations(PARTS)
                  if all(order.index("rays") < order.index(child) for child in CHILDREN)]
        self.assertEqual((len(orders), found["orders"]), (8064, 8064))
        shares = dict.fromkeys(PARTS, 0.0)
        for order in orders:
            for i, part in enumerate(order):
                shares[part] += (values[frozenset(order[:i + 1])] - values[frozenset(order[:i])])
        rows = {row["part"]: row for row in found["results"]}
        squared = found["scenes"][0]["squared"]
        self.assertAlmostEqual(squared, values[frozenset(PARTS)], delta=1e-12 * squared)
        self.assertGreater(squared, 0.0)
        for part in PARTS:
            self.assertAlmostEqual(rows[part]["share"], shares[part] / 8064, delta=1e-9 * squared)
            without = frozenset(PARTS) - {part} - set(CHILDREN if part == "rays" else ())
            self.assertAlmostEqual(rows[part]["seen_if_ideal"], math.sqrt(values[without]),
                                   delta=1e-9)
        alone = sum(values[frozenset({"rays", part}) if part in CHILDREN else frozenset({part})]
                    - (values[frozenset({"rays"})] if part in CHILDREN else 0) for part in PARTS)
        self.assertAlmostEqual(rows["interaction"]["alone"], squared - alone, delta=1e-9 * squared)
        self.assertAlmostEqual(sum(rows[part]["share"] for part in PARTS), squared,
                               delta=1e-12 * squared)
        self.assertEqual(found["scenes"][0]["explained"], abs(squared - alone) <= 0.15 * squared)
        return rows

    def test_a_scene_is_divided_and_resumed(self):
        found = self.json(*self.command("--csv", "all.csv", "-q"))
        rows = self.check_shares(found)
        self.assertEqual(found["format"], "neph-attribution-1")
        self.assertEqual([part["part"] for part in found["parts"]], PARTS)
        self.assertEqual(len({row["settings"] for row in found["sequences"]}), 34)
        suite = [row["part"] for row in found["suite"]]
        self.assertEqual(suite[:3], found["worst"])
        self.assertEqual(suite[:8], sorted(PARTS, key=lambda part: -rows[part]["percent"]))
        with open(self.folder / "all.csv", newline="") as file:
            lines = list(csv.DictReader(file))
        self.assertEqual([line["part"] for line in lines], [*PARTS, "interaction"])
        blur = found["scenes"][0]["blur_px"]
        self.assertTrue(0.0 < blur <= 1.5, blur)
        for line in lines:  # tables have nine digits
            self.assertAlmostEqual(float(line["blur_px"]), blur, delta=1e-8 * blur)
        output = self.folder / "out/study"
        store = self.stamps(output / "store/frames")
        self.assertEqual(list((output / "store/tmp").glob("*")), [])
        maps = {path.name for path in (output / "maps").iterdir()}
        self.assertEqual(maps, {f"drift_{part}.png" for part in found["worst"]})
        size = (output / "maps" / maps.pop()).read_bytes()[16:24]
        self.assertEqual(size, (2 * 48 + 4).to_bytes(4, "big") + (27).to_bytes(4, "big"))
        self.check_answer(found, output, store)

    def check_answer(self, found, output, store):
        """From the store, in which nothing is rendered again."""
        done = self.neph(*self.command())
        self.assertLessEqual(done.stdout.count("\n"), 10)
        self.assertTrue(done.stdout.startswith("the worst causes of the squared flicker of ours: "
                                               f"{found['worst'][0]} "), done.stdout)
        self.assertRegex(done.stdout, r"\nthe parts explain [01] of 1 scenes within 15 %; ")
        text = self.neph(*self.command("--all")).stdout
        self.assertIn("\n| interaction | - | ", text)
        self.assertIn(f"; blur {found['scenes'][0]['blur_px']:.2f} px; ", text)
        self.assertEqual(self.stamps(output / "store/frames").keys(), store.keys())
        self.assertIn(">aliasing</text>", (output / "attribution.svg").read_text())

    def test_refused_arguments(self):
        """Refused before anything is rendered."""
        scene = self.put("drift.yaml", SCENE)
        self.check_refusals((64, "(split=none)", (scene, "--preset", "off")),
                            (64, "(atrous=on)", (scene, "--preset", "svgf")),
                            (64, "nonesuch", (scene, "--preset", "nonesuch")),
                            (64, "no multiple of 4", (scene, "--frames", 18)),
                            (64, "not both", (scene, "--suite", "motion")),
                            (64, "no suite", ("--suite", "nonesuch")),
                            (66, "nonesuch", ("nonesuch",)))
        self.assertFalse((self.folder / "out").exists())


if __name__ == "__main__":
    unittest.main()
