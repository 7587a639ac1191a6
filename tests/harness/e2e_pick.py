#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""`neph pick`: closed forms first, nothing for motion where nothing moves, and what it says when
nothing is good enough. Its file is what `neph render --config` takes."""
import json
import os
import pathlib
import re
import subprocess
import tempfile
import unittest

import night

NEPH = os.environ["NEPH"]
SOURCE = pathlib.Path(os.environ["NEPH_SOURCE_DIR"])


def run(*arguments):
    return subprocess.run([NEPH, *arguments], capture_output=True, text=True, timeout=900)


EVEN = """name: even
title: Even fog before the sky
physics: Homogeneous. Truth is exact.
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
physics: A Gaussian cloud across the light, all orders of scattering. Truth is the tracer.
camera: {position_m: [0, 0, 600], look_at_m: [0, 0, 0], vertical_fov_deg: 30}
sun: {direction: [1, 0.3, 0], irradiance_w_per_m2: [10, 10, 10]}
scattering: multiple
media:
  - gaussian: {center_m: [0, 0, 0], width_m: 40, extinction_per_m: EXTINCTION, albedo: [1, 1, 1],
               phase: isotropic}
"""


class Pick(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.out = folder.name

    def pick(self, scene, *arguments):
        done = run("pick", scene, "--size", "64x36", "-o", self.out, "-q", "--json", *arguments)
        return done, json.loads(done.stdout) if done.stdout else None

    def test_a_fog_is_a_closed_form(self):
        done, found = self.pick("height_fog_level", "--error", "0.01")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertTrue(found["found"])
        self.assertEqual((found["engine"], found["evaluations"]), ("exact", 0.0))
        self.assertLess(found["error"], 0.01)
        march, = found["left_out"]
        self.assertGreater(march["with"]["evaluations"], 1.0)
        # The file renders, and what it renders is the choice.
        config = str(pathlib.Path(self.out, "pick.json"))
        done = run("render", "height_fog_level", "--config", config, "--size", "64x36", "-o",
                   self.out, "-q")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("height_fog_level_exact_0000.exr", done.stdout)
        done = run("render", "height_fog_level", "--config", config, "--preset", "ours")
        self.assertEqual(done.returncode, 64)
        pathlib.Path(config).write_text('{"format": "neph-configuration-1", "engine": "march", '
                                        '"settings": "steps=-3"}')
        done = run("render", "height_fog_level", "--config", config, "-o", self.out)
        self.assertEqual(done.returncode, 65)
        self.assertIn("1..65536", done.stderr)

    def test_even_fog_is_a_closed_form(self):
        """Its truth is the same closed form; a march, which is not, comes to the same."""
        scene = pathlib.Path(self.out, "even.yaml")
        scene.write_text(EVEN)
        done, found = self.pick(str(scene), "--error", "0.01")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual((found["engine"], found["evaluations"]), ("exact", 0.0))
        march, = found["left_out"]
        self.assertLess(march["with"]["error"], 1e-3)
        self.assertGreater(march["with"]["evaluations"], 30.0)

    def cloud(self, optical_depth, *arguments):
        scene = pathlib.Path(self.out, "cloud.yaml")
        scene.write_text(CLOUD.replace("EXTINCTION", repr(optical_depth / (40.0 * 2.5066283))))
        done, found = self.pick(str(scene), "--error", "0.3", *arguments)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertLessEqual(found["error"], 0.3)
        return found

    @night.of_the_night
    def test_a_thin_cloud_leaves_out_all_orders(self):
        found = self.cloud(0.05)
        self.assertEqual(found["scattering"], "single")
        # What all orders would have bought: nothing, as the lights that stand for them are off.
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
        done = run("pick", "sky_earth", "--size", "32x18", "--error", "0.1", "-o", self.out, "-q",
                   "--json")
        self.assertEqual(done.returncode, 0, done.stderr)
        found = json.loads(done.stdout)
        left = {entry["what"]: entry["with"] for entry in found["left_out"]}
        # Marched through the air in eight steps it would be off by 1.
        self.assertLess(left["a ray for every pixel, every frame"]["error"], 0.1)

    def test_the_shipped_preset_is_the_point_of_the_front_that_was_asked_for(self):
        def pick(*arguments):
            done = run("pick", "gaussian_blob", "--presets", "fixed,ours", "--size", "32x18",
                       "--frames", "16", "-o", self.out, "-q", "--json", *arguments)
            return done, json.loads(done.stdout)
        done, found = pick("--least", "flicker", "--half-life", "8")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual((found["preset"], found["found"]), ("ours", True))
        fixed, ours = found["candidates"]
        self.assertTrue(ours["on_front"])
        # The file renders what the preset does.
        for name, words in (("a", ("--config", str(pathlib.Path(self.out, "pick.json")))),
                            ("b", ("-e", "realtime", "--preset", "ours", "-s", "steps=8"))):
            done = run("render", "gaussian_blob", *words, "--size", "32x18", "--frames", "4", "-q",
                       "-o", str(pathlib.Path(self.out, name)))
            self.assertEqual(done.returncode, 0, done.stderr)
        a, b = (pathlib.Path(self.out, name, "gaussian_blob_realtime_0003.exr") for name in "ab")
        done = run("compare", str(a), str(b), "-m", "error", "--fail-above", "max_abs=0")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        # What only the other one has is not within what was asked for.
        self.assertLess(3.0 * ours["flicker"], fixed["flicker"])
        done, none = pick("--flicker", str(0.5 * ours["flicker"]))
        self.assertEqual((done.returncode, none["found"]), (1, False))

    @night.of_the_night
    def test_presets_over_scenes(self):
        def pick(*arguments):
            done = run("pick", "gaussian_blob", "fence_sky", "--presets", "ours,fixed,ours+taa=off",
                       "--size", "48x27", "--frames", "16", "-o", self.out, "-q", "--json",
                       "--jobs", "2", *arguments)
            return done, json.loads(done.stdout) if done.stdout else None
        done, found = pick("--least", "error")
        self.assertEqual(done.returncode, 0, done.stderr)
        rows = {row["preset"]: row for row in found["candidates"]}
        best = min(rows.values(), key=lambda row: row["error"])
        self.assertEqual(found["preset"], best["preset"])
        self.assertTrue(best["on_front"])
        # Without anti-aliasing nothing lags so little; a budget that only it is in takes it.
        quick = rows["ours+taa=off"]
        self.assertEqual(min(row["lag"] for row in rows.values()), quick["lag"])
        done, again = pick("--lag", str(1.01 * quick["lag"]))
        self.assertEqual((again["preset"], again["found"]), ("ours+taa=off", True))
        self.assertIn("taa=off", again["settings"])
        self.assertTrue(pathlib.Path(self.out, "flicker_lag.svg").exists())
        done, none = pick("--lag", str(0.5 * quick["lag"]))
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertFalse(none["found"])
        # The file is what `neph render` takes.
        done = run("render", "gaussian_blob", "--config", str(pathlib.Path(self.out, "pick.json")),
                   "--size", "16x9", "-o", self.out, "-q")
        self.assertEqual(done.returncode, 0, done.stderr)

    def test_a_cloud_at_rest(self):
        scene = pathlib.Path(self.out, "small.yaml")
        text = (SOURCE / "scenes" / "catalog" / "gaussian_blob.yaml").read_text()
        scene.write_text(re.sub(r"^name: .*$", "name: small", text, flags=re.M))
        done, found = self.pick(str(scene), "--error", "0.5", "--flicker", "20", "--jobs", "2")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(found["engine"], "realtime")
        self.assertLessEqual(found["error"], 0.5)
        self.assertLessEqual(found["flicker"], 20.0)
        for off in ("wind=off", "cut_reset=off", "reject_depth=0 ", "taa_motion=centre"):
            self.assertIn(off, found["settings"] + " ")
        left = {entry["what"]: entry for entry in found["left_out"]}
        motion = left["parts that only motion needs"]
        self.assertEqual(motion["because"], "nothing moves")
        self.assertAlmostEqual(motion["with"]["error"], found["error"], delta=0.1 * found["error"])
        # Nothing is there that the cloud could throw a shadow on.
        shadows = left["a shadow map of the clouds"]
        self.assertIn("no cloud stands", shadows["because"])
        self.assertEqual(shadows["with"]["error"], found["error"])
        self.assertNotIn("cloud_shadow=map", found["settings"])
        every = left["a ray for every pixel, every frame"]["with"]
        self.assertGreater(every["evaluations"], 10.0 * found["evaluations"])
        # The same again, from the store, by one process; and nothing is good enough for a hair's
        # breadth.
        done, again = self.pick(str(scene), "--error", "0.5", "--flicker", "20")
        self.assertEqual(again, found)
        done, best = self.pick(str(scene), "--error", "1e-6", "--flicker", "20")
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertFalse(best["found"])
        self.assertIn("good enough", done.stderr)

    def test_what_is_refused(self):
        self.assertEqual(run("pick", "voxel_grid").returncode, 64)
        self.assertEqual(run("pick", "voxel_grid", "--error", "-1").returncode, 64)
        for words, said in ((("voxel_grid", "--error", "1", "--suite", "tuning"), "--presets"),
                            (("--presets", "ours", "--suite", "test"), "what is reported"),
                            (("--presets", "ours", "--least", "x", "-o", self.out), "half-life"),
                            (("--presets", "ours", "--ms", "9", "--jobs", "2"), "at a time"),
                            (("voxel_grid", "fence_sky", "--error", "1"), "one scene")):
            done = run("pick", *words)
            self.assertEqual(done.returncode, 64, done.stderr)
            self.assertIn(said, done.stderr)
        done = run("pick", "no_such_scene", "--error", "1", "-o", self.out)
        self.assertEqual(done.returncode, 66)

    def test_without_a_driver(self):
        words = [NEPH, "pick", "gaussian_blob", "--error", "1", "--json", "-o", self.out]
        done = subprocess.run(words, env=dict(os.environ, VK_DRIVER_FILES="/nonexistent"),
                              capture_output=True, text=True)
        self.assertEqual((done.returncode, done.stdout), (69, ""), done.stderr)
        self.assertIn("apt-get install", done.stderr)


if __name__ == "__main__":
    unittest.main()
