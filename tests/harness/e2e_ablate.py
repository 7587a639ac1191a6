#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""`neph ablate` as a user runs it, with small frames: effects of parts, files, reuse, refused
arguments."""
import csv
import json
import math
import unittest
import xml.etree.ElementTree

from neph_case import StudyCase

# A wall in half of the frame, before a blob that fills the frame: an edge, and a medium on every
# ray.
REST = """
name: rest
title: a test
description: a test
camera: {position_m: [0, 2, 0], look_at_m: [0, 2, -10], vertical_fov_deg: 20}
frames: {count: 16, rate_hz: 30}
sun: {direction: [0.6, 0.75, 0.3], irradiance_w_per_m2: [6, 6, 6]}
background_w_per_m2_sr: [0.5, 0.25, 0.125]
scattering: single
solids:
  - box: {min_m: [0.1, -6, -41], max_m: [30, 6, -40], albedo: [0.2, 0.2, 0.2]}
media:
  - gaussian: {center_m: [-2, 3, -30], width_m: 9, extinction_per_m: 0.03, albedo: [1, 1, 1]}
"""
BACKLIT = REST.replace("rest", "backlit").replace("[0.6, 0.75, 0.3]", "[-0.3, 0.4, -0.85]")
SIZE = ("--size", "32x16", "--steps", "3", "--frames", "16", "--seeds", "1", "-q")


class Ablate(StudyCase):
    def setUp(self):
        super().setUp()
        self.scenes = [self.put("rest.yaml", REST), self.put("backlit.yaml", BACKLIT)]

    def ablate(self, *arguments):
        done = self.neph("ablate", *arguments, "--only", "split", *SIZE)
        return done.stdout, json.loads((self.folder / "out/ablate/ablation.json").read_text())

    def stored(self):
        return self.stamps(self.folder / "out/ablate/store/frames")

    @staticmethod
    def effect(found, part, place, measure):
        part, = (p for p in found["parts"] if p["part"] == part)
        effect, = (e for e in part["effects"] if (e["place"], e["measure"]) == (place, measure))
        return effect

    def test_the_split_saves_15_rays_of_16_and_is_the_pair_of_the_study(self):
        arguments = (*self.scenes, "--takes", "flicker")
        text, found = self.ablate(*arguments, "--all")
        for word in ("preset ours, 32x16, 3 steps", "Scenes: rest backlit.", "\n| split | ",
                     "not in this preset: upscale_dither"):
            self.assertIn(word, text)
        self.assertRegex(text, r"\n- split: lowers [^;]*density evaluations per pixel \(-94 %\)")
        # One ray in 4x4 pixels; the number of steps of a ray is unchanged.
        evaluations = self.effect(found, "split", "in_preset", "evaluations")
        for decades in evaluations["scenes"].values():
            self.assertAlmostEqual(decades, -math.log10(16), delta=1e-9)
        self.assertEqual((evaluations["better"], evaluations["verdict"]), (2, "buys"))
        for measure in ("traffic", "gpu_ms"):
            self.assertEqual(len(self.effect(found, "split", "in_preset", measure)["scenes"]), 2)
        self.assertEqual((found["format"], found["plain"].count("taa=off")),
                         ("neph-ablation-1", 1))
        self.check_files()
        entries = self.stored()
        again, _ = self.ablate(*arguments, "--all")
        self.assertEqual((again, self.stored()), (text, entries))
        verdict, _ = self.ablate(*arguments)  # -q
        self.assertEqual(verdict, "ours: keep: split (2 scenes, 1 seed, 95 % intervals)\n")
        study = self.json("study", "flicker", self.scenes[0], "--preset", "ours,ours+split=none",
                          "--takes", "flicker", "--no-floor", *SIZE)
        for measure, metric, mask in (("error", "rel_rmse", "all"),
                                      ("edge_flicker", "seen_contrast", "depth_edge")):
            pair = next(p for p in study["pairs"]
                        if (p["metric"], p["mask"], p["rate_hz"], p["pixels_per_degree"]) ==
                        (metric, mask, 30.0, 60.0))
            effect = self.effect(found, "split", "in_preset", measure)
            self.assertAlmostEqual(effect["scenes"]["rest"], pair["decades"], delta=1e-12)

    def check_files(self):
        out = self.folder / "out/ablate"
        with open(out / "ablation.csv", newline="") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual({row["part"] for row in rows}, {"all", "split"})
        self.assertEqual({row["scene"] for row in rows}, {"", "rest", "backlit"})
        svg = xml.etree.ElementTree.parse(out / "ablation.svg").getroot()
        width, height = (float(svg.get(name)) for name in ("width", "height"))
        for text in svg.iter("{http://www.w3.org/2000/svg}text"):
            self.assertTrue(0 <= float(text.get("x")) <= width and
                            0 < float(text.get("y")) < height, text.text)

    def test_a_step_has_a_half_life(self):
        _, found = self.ablate(self.scenes[0], "--takes", "step", "--jobs", "2")
        half_life = self.effect(found, "split", "in_preset", "half_life")
        self.assertEqual((list(half_life["scenes"]), half_life["interval"]), (["rest"], None))
        self.assertGreater(half_life["decades"], 0.0)  # every pixel has the new light at once

    def test_the_list_has_claims_and_sources(self):
        done = self.neph("ablate", "--list", "--preset", "ue")
        self.assertIn("F. Bauer, SIGGRAPH 2019", done.stdout)
        override = done.stdout.split("\noverride ")[1]
        self.assertIn("not in this preset", override.split("\nsteady_depth")[0])

    def test_wrong_words(self):
        rest = self.scenes[0]
        self.check_refusals(
            (64, ("best", "tuning"), ("--suite", "best")),
            (64, ("motion_test is shut", "no preset is measured", "--open-shut-suite"),
             ("--suite", "motion_test")),
            (64, "not both", ("--suite", "test", rest)),
            (64, ("nope", "off, seed"), (rest, "--preset", "nope")),
            (64, ("'bux'", "box"), (rest, "--only", "box,bux")),
            (64, "'box' is twice", (rest, "--only", "box,box")),
            (64, ("override=none", "--list"), (rest, "--preset", "ue", "--only", "override")),
            (64, ("'sine'", "flicker or step"), (rest, "--takes", "sine")),
            (64, "multiple of 4", (rest, "--frames", "18")),
            (64, ("'0'", "1..64"), (rest, "--seeds", "0")),
            (66, "no_such", ("no_such",)),
            (2, ("multiple scattering", "--preset"), ("slab_multiple_thin",)),
            before=("ablate", "-q"))


if __name__ == "__main__":
    unittest.main()
