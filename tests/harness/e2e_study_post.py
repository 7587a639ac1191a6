#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""`neph study post` as a user runs it: tables, files, refused arguments."""
import csv
import math
import unittest
import xml.etree.ElementTree as ElementTree

import night
from neph_case import StudyCase

LITTLE = ("--size", "32x18", "--frames", "16", "--warm-up", "4", "--steps", "4")


class StudyPost(StudyCase):
    words = ("study", "post")

    @night.of_the_night
    def test_a_table_and_its_files(self):
        [scene] = self.json("railings", *LITTLE, "-q", "--csv", "a.csv", "--markdown",
                            "a.md")["scenes"]
        chains = {chain["name"]: chain for chain in scene["chains"]}
        curve, additive = chains["Unreal's curve"], chains["bloom, additive"]
        self.assertGreater(curve["scene_error"], 0)
        self.assertEqual(chains["cas"]["scene_error"], curve["scene_error"])
        # Light scattered over the frame counts as correct, too.
        self.assertLess(additive["scene_error"], curve["scene_error"])
        # Sharpening amplifies flicker, too.
        self.assertGreater(chains["rcas"]["luma_change"], 1.5 * curve["luma_change"])
        with open(self.folder / "a.csv", newline="") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual([row["chain"] for row in rows], list(chains))
        self.assertAlmostEqual(float(rows[1]["flip"]), curve["flip"], places=7)
        chart = (self.folder / "out/study" / "post.svg").read_text()
        root = ElementTree.fromstring(chart)
        marks = root.findall("{http://www.w3.org/2000/svg}path[@transform]")
        # The legend's mark, but no FLIP of HDR; marks of light only for chains that change it.
        changed = [abs(math.log2(chain[number] / curve[number])) > 1e-3
                   for chain in chains.values() for number in ("scene_error", "scene_change")]
        self.assertGreater(sum(changed), 10)
        self.assertEqual(len(marks), 3 * len(chains) + sum(changed))
        lines = self.neph("railings", *LITTLE).stdout
        change = {name: chain["seen"] / curve["seen"] for name, chain in chains.items()
                  if chain["seen"] and name != "Unreal's curve"}
        most = max(change, key=change.get)
        self.assertTrue(lines.startswith(f"most flicker: {most}, {change[most]:.3g} times"), lines)
        self.assertLessEqual(lines.count("\n"), 10)
        text = (self.folder / "a.md").read_text()
        for name in chains:
            self.assertIn(f"| {name} |", text)

    def test_a_few_chains_of_another_seed(self):
        """The chain with only the curve is always present; the frames depend on the seed."""
        def curve_and_grain(seed):
            found = self.json("railings", *LITTLE, "--only", "grain", "--seed", seed, "-q",
                              "-o", f"out{seed}")
            chains = found["scenes"][0]["chains"]
            self.assertEqual([chain["name"] for chain in chains],
                             ["Unreal's curve", "grain", "without grain"])
            self.assertEqual(found["seed"], seed)
            return chains[0]["scene_error"]
        first, other = curve_and_grain(1), curve_and_grain(2)
        root = ElementTree.parse(self.folder / "out1" / "post.svg").getroot()
        marks = root.findall("{http://www.w3.org/2000/svg}path[@transform]")
        # Grain does not change light; the full chain has bloom: FLIP, flicker and milliseconds of
        # three chains, and two measures of light of the last one.
        self.assertEqual(len(marks), 1 + 3 * 3 + 2)
        self.assertNotEqual(first, other)
        self.assertLess(abs(first - other), 0.3 * first)

    def test_contradictions_are_refused(self):
        self.check_refusals(
            (64, "which scenes", ()),
            (64, "multiples of 4", ("railings", "--frames", "18")),
            (64, "'nonsense'", ("railings", "--only", "grain,nonsense")),
            (64, "none_such", ("railings", "--preset", "none_such", *LITTLE)),
            (64, "1 GiB", ("railings", "--size", "3000x2000", "--frames", "64")),
            (66, "no_such_scene", ("railings", "no_such_scene", *LITTLE)))
        frames = self.folder / "out/study/store/frames"
        self.assertFalse(frames.exists() and any(frames.iterdir()))


if __name__ == "__main__":
    unittest.main()
