#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""`neph pick`: closed forms first, no parts for motion in a static scene, and its message if
nothing is good enough. `neph render --config` reads its file."""
import json
import re
import unittest

import night
from neph_case import ROOT, NephCase


EVEN = """name: even
title: Even fog before the sky
description: Homogeneous. Truth is exact.
camera: {position_m: [0, 2, 0], look_at_m: [0, 2, -10], vertical_fov_deg: 50}
sun: {direction: [0.3, 0.6, -0.2], irradiance_w_per_m2: [3, 3, 3]}
background_w_per_m2_sr: [0.5, 0.6, 0.7]
scattering: single
media:
  - homogeneous: {extinction_per_m: 0.05, albedo: [0.9, 0.9, 0.9], phase: isotropic,
                  bounds: {min_m: [-100, -1, -100], max_m: [100, 30, 100]}}
"""

CLOUD = """name: cloud
title: A cloud of some optical depth
description: A Gaussian cloud across the light, all orders of scattering. Truth is the tracer.
camera: {position_m: [0, 0, 600], look_at_m: [0, 0, 0], vertical_fov_deg: 30}
sun: {direction: [1, 0.3, 0], irradiance_w_per_m2: [10, 10, 10]}
scattering: multiple
media:
  - gaussian: {center_m: [0, 0, 0], width_m: 40, extinction_per_m: EXTINCTION, albedo: [1, 1, 1],
               phase: isotropic}
"""


class Pick(NephCase):
    in_folder = True

    def pick(self, scene, *arguments, size="64x36", code=0):
        """Returns its JSON, which equals the file."""
        done = self.neph("pick", scene, "--size", size, "-q", "--json", *arguments, code=code)
        return json.loads(done.stdout), done.stderr

    def render(self, scene, *arguments, **expected):
        return self.neph("render", scene, *arguments, "-q", **expected)

    def test_a_fog_is_a_closed_form(self):
        found, _ = self.pick("height_fog_level", "--error", "0.01")
        self.assertTrue(found["found"])
        self.assertEqual((found["engine"], found["evaluations"]), ("exact", 0.0))
        self.assertLess(found["error"], 0.01)
        march, = found["left_out"]
        self.assertGreater(march["with"]["evaluations"], 1.0)
        # The file renders, and renders the choice.
        config = ("height_fog_level", "--config", "out/pick/pick.json", "--size", "64x36")
        self.assertIn("height_fog_level_exact_0000.exr", self.render(*config).stdout)
        self.render(*config, "--preset", "ours", code=64)
        self.put("out/pick/pick.json", '{"format": "neph-configuration-1", "engine": "march", '
                 '"settings": "steps=-3"}')
        self.render(*config, code=65, said="1..65536")

    def test_even_fog_is_a_closed_form(self):
        """The truth is the same closed form; a march, which is not, agrees with it."""
        found, _ = self.pick(self.put("even.yaml", EVEN), "--error", "0.01")
        self.assertEqual((found["engine"], found["evaluations"]), ("exact", 0.0))
        march, = found["left_out"]
        self.assertLess(march["with"]["error"], 1e-3)
        self.assertGreater(march["with"]["evaluations"], 30.0)

    def cloud(self, optical_depth, *arguments):
        text = CLOUD.replace("EXTINCTION", repr(optical_depth / (40.0 * 2.5066283)))
        found, _ = self.pick(self.put("cloud.yaml", text), "--error", "0.3", *arguments)
        self.assertLessEqual(found["error"], 0.3)
        return found

    @night.of_the_night
    def test_a_thin_cloud_leaves_out_all_orders(self):
        found = self.cloud(0.05)
        self.assertEqual(found["scattering"], "single")
        # All orders of scattering would not help: the lighting models that approximate them are
        # off.
        left = {entry["what"]: entry["with"] for entry in found["left_out"]}
        for light in ("octaves", "fitted octaves"):
            self.assertGreater(left[light]["error"], found["error"])

    @night.of_the_night
    def test_a_thick_cloud_keeps_them(self):
        found = self.cloud(12.0, "--flicker", "8")
        self.assertIsNone(found["scattering"])
        kept = {entry["what"]: entry["without"] for entry in found["kept"]}
        self.assertGreater(kept["light scattered more than once"]["error"], 2.0 * found["error"])

    @night.of_the_night
    def test_a_planets_air_is_tables_for_the_march_beside_it_too(self):
        found, _ = self.pick("sky_earth", "--error", "0.1", size="32x18")
        left = {entry["what"]: entry["with"] for entry in found["left_out"]}
        # If it marched through the air in eight steps, the error would be 1.
        self.assertLess(left["a ray for every pixel, every frame"]["error"], 0.1)

    def test_the_chosen_preset_is_on_the_front(self):
        def pick(*arguments, code=0, presets="fixed,ours"):
            return self.pick("gaussian_blob", "--preset", presets, "--frames", "16",
                             *arguments, size="32x18", code=code)[0]
        found = pick("--least", "flicker", "--half-life", "8")
        self.assertEqual((found["preset"], found["found"]), ("ours", True))
        fixed, ours = found["candidates"]
        self.assertTrue(ours["on_front"])
        # The file renders the same frames as the preset.
        for name, words in (("a", ("--config", "out/pick/pick.json")),
                            ("b", ("-e", "realtime", "--preset", "ours", "-s", "steps=8"))):
            self.render("gaussian_blob", *words, "--size", "32x18", "--frames", "4", "-o", name)
        self.neph("compare", *(f"{name}/gaussian_blob_realtime_0003.exr" for name in "ab"), "-m",
                  "error", "--fail-above", "max_abs=0")
        # No configuration is within a limit that only the other one reaches.
        self.assertLess(3.0 * ours["flicker"], fixed["flicker"])
        self.check_floors(pick, fixed)
        self.assertFalse(pick("--flicker", 0.5 * ours["flicker"], code=1)["found"])

    def test_the_choice_in_motion_has_a_floor(self):
        """Every pixel marched in every frame; a static scene and other candidates have none."""
        text = (ROOT / "scenes/catalog/gaussian_blob.yaml").read_text()
        self.put("dolly.yaml", re.sub("name: .*", "name: dolly", text, count=1).replace(
            "camera: {position_m: [0, 2, 6], look_at_m: [0, 1, 0], vertical_fov_deg: 36}",
            "camera: {keys: [{frame: 0, position_m: [0, 2, 6], look_at_m: [-2, 1, 0]}, {frame: 31, "
            "position_m: [0, 2, 6], look_at_m: [1, 1, 0]}], vertical_fov_deg: 36}\n"
            "frames: {count: 32, rate_hz: 30}"))
        words = ("--error", "0.9", "--flicker", "40", "--only", "ours")
        found, _ = self.pick("dolly.yaml", *words, size="16x9")
        self.assertLess(found["error_floor"], found["error"])
        self.assertLess(found["flicker_floor"], found["flicker"])
        self.assertEqual({entry["with"]["flicker_floor"] for entry in found["left_out"]}, {None})
        said = self.neph("pick", "dolly.yaml", *words, "--size", "16x9", "-q").stdout
        self.assertIn(f"(floor {found['flicker_floor']:.3g})", said)
        still, _ = self.pick("gaussian_blob", *words, size="16x9")
        self.assertEqual((still["error_floor"], still["flicker_floor"]), (None, None))

    def check_floors(self, pick, fixed):
        """The floor of `fixed` is every pixel marched, with its anti-aliasing: the default."""
        again, marched = pick(presets="fixed,off+taa=on")["candidates"]
        for name in ("flicker", "half-life", "lag", "error"):
            self.assertEqual(fixed["floor"][name], marched[name])
            self.assertEqual(again["floor"][name], marched["floor"][name])
        self.assertNotIn("ms", fixed["floor"])

    @night.of_the_night
    def test_presets_over_scenes(self):
        def pick(*arguments, code=0):
            return self.pick("gaussian_blob", "fence_sky", "--preset", "ours,fixed,ours+taa=off",
                             "--frames", "16", "--jobs", "2", *arguments, size="48x27",
                             code=code)[0]
        found = pick("--least", "error")
        rows = {row["preset"]: row for row in found["candidates"]}
        best = min(rows.values(), key=lambda row: row["error"])
        self.assertEqual(found["preset"], best["preset"])
        self.assertTrue(best["on_front"])
        # No other configuration lags so little as without anti-aliasing; a limit that only this one
        # meets selects it.
        quick = rows["ours+taa=off"]
        self.assertEqual(min(row["lag"] for row in rows.values()), quick["lag"])
        again = pick("--lag", 1.01 * quick["lag"])
        self.assertEqual((again["preset"], again["found"]), ("ours+taa=off", True))
        self.assertIn("taa=off", again["settings"])
        self.assertTrue((self.folder / "out/pick/flicker_lag.svg").exists())
        self.assertFalse(pick("--lag", 0.5 * quick["lag"], code=1)["found"])
        # `neph render` reads the file.
        self.render("gaussian_blob", "--config", "out/pick/pick.json", "--size", "16x9")

    def test_a_static_cloud(self):
        text = (ROOT / "scenes/catalog/gaussian_blob.yaml").read_text()
        words = ("--error", "0.5", "--flicker", "20")
        scene = self.put("small.yaml", re.sub(r"^name: .*$", "name: small", text, flags=re.M))
        found, _ = self.pick(scene, *words, size="32x18")
        self.assertEqual(found["engine"], "realtime")
        self.assertLessEqual(found["error"], 0.5)
        self.assertLessEqual(found["flicker"], 20.0)
        for off in ("wind=off", "cut_reset=off", "reject_depth=0 ", "taa_motion=centre"):
            self.assertIn(off, found["settings"] + " ")
        left = {entry["what"]: entry for entry in found["left_out"]}
        motion = left["parts that only motion needs"]
        self.assertEqual(motion["because"], "nothing moves")
        self.assertAlmostEqual(motion["with"]["error"], found["error"], delta=0.1 * found["error"])
        # There is no surface for the cloud's shadow.
        shadows = left["a shadow map of the clouds"]
        self.assertIn("no cloud stands", shadows["because"])
        self.assertEqual(shadows["with"]["error"], found["error"])
        self.assertNotIn("cloud_shadow=map", found["settings"])
        every = left["a ray for every pixel, every frame"]["with"]
        self.assertGreater(every["evaluations"], 10.0 * found["evaluations"])
        # The same results from the store, and by two processes; and nothing is good enough for a
        # tiny error.
        for again in ((), ("--jobs", "2", "-o", "by_two")):
            self.assertEqual(self.pick(scene, *words, *again, size="32x18")[0], found)
        best, said = self.pick(scene, "--error", "1e-6", *words[2:], size="32x18", code=1)
        self.assertFalse(best["found"])
        self.assertIn("within the limits", said)

    def test_configurations_of_some_engines_only(self):
        """The choice is of the requested engine or name, and the first line states it."""
        words = ("--error", "1", "-o", "few")
        for option, engine in ((("-e", "march"), "march"), (("--only", "fixed"), "realtime")):
            found, _ = self.pick("voxel_grid", *words, *option, size="32x18")
            self.assertEqual(found["engine"], engine)
            others = found["left_out"] + found["kept"]
            self.assertEqual({entry.get("with", entry.get("without"))["engine"] for entry in others}
                             if option[0] == "-e" else {engine}, {engine})
            lines = self.neph("pick", "voxel_grid", "--size", "32x18", *words, *option).stdout
            self.assertLessEqual(lines.count("\n"), 10)
            verdict = f"{found['name']}: error {100 * found['error']:.3g} %"
            self.assertEqual(lines[:len(verdict)], verdict)
            self.assertIn("\nneph render voxel_grid --config few/pick.json\n", lines)
        [verdict] = self.neph("pick", "voxel_grid", "--size", "32x18", "--error", "1e-6", "-e",
                              "march", "-o", "few", "-q", code=1).stdout.splitlines()
        self.assertRegex(verdict, "^nothing is good enough for error 0.0001 %: the best of [0-9]+ "
                                  "configurations is march, ")
        frames = self.folder / "none/store/frames"
        self.check_refusals((64, ("'nope'", "realtime, march"), ("-e", "nope")),
                            (64, ("'nope'", "march, scattered once"), ("--only", "nope")),
                            (64, "both", ("-e", "march", "--only", "ours")),
                            before=("pick", "voxel_grid", "--error", "0.5", "-o", "none"))
        self.assertFalse(frames.exists() and any(frames.iterdir()))

    def test_refused_arguments(self):
        self.check_refusals(
            (64, "", ("voxel_grid",)), (64, "", ("voxel_grid", "--error", "-1")),
            (64, "--preset", ("voxel_grid", "--error", "1", "--suite", "tuning")),
            (64, "evaluates a choice", ("--preset", "ours", "--suite", "test")),
            (64, ("motion_test is shut", "--open-shut-suite"),
             ("--preset", "ours", "--suite", "motion_test")),
            (64, "half-life", ("--preset", "ours", "--least", "x")),
            (64, "at a time", ("--preset", "ours", "--ms", "9", "--jobs", "2")),
            (64, "one scene", ("voxel_grid", "fence_sky", "--error", "1")),
            (64, "1..4096 pixels", ("voxel_grid", "--error", "1", "--size", "5000x9")),
            (66, "", ("no_such_scene", "--error", "1")), before=("pick",))

    def test_without_a_driver(self):
        self.neph("pick", "gaussian_blob", "--error", "1", "--json", code=69, silent=True,
                  said="apt-get install", VK_DRIVER_FILES="/nonexistent")


if __name__ == "__main__":
    unittest.main()
