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

NEPH = os.environ["NEPH"]
SOURCE = pathlib.Path(os.environ["NEPH_SOURCE_DIR"])


def run(*arguments):
    return subprocess.run([NEPH, *arguments], capture_output=True, text=True, timeout=900)


class Pick(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.out = self.folder.name

    def tearDown(self):
        self.folder.cleanup()

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

    def test_a_cloud_at_rest(self):
        scene = pathlib.Path(self.out, "small.yaml")
        text = (SOURCE / "scenes" / "catalog" / "gaussian_blob.yaml").read_text()
        scene.write_text(re.sub(r"^name: .*$", "name: small", text, flags=re.M))
        done, found = self.pick(str(scene), "--error", "0.5", "--flicker", "20")
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
        every = left["a ray for every pixel, every frame"]["with"]
        self.assertGreater(every["evaluations"], 10.0 * found["evaluations"])
        # The same again, from the store: and nothing is good enough for a hair's breadth.
        done, again = self.pick(str(scene), "--error", "0.5", "--flicker", "20")
        self.assertEqual(again, found)
        done, best = self.pick(str(scene), "--error", "1e-6", "--flicker", "20")
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertFalse(best["found"])
        self.assertIn("good enough", done.stderr)

    def test_what_is_refused(self):
        self.assertEqual(run("pick", "voxel_grid").returncode, 64)
        self.assertEqual(run("pick", "voxel_grid", "--error", "-1").returncode, 64)
        done = run("pick", "no_such_scene", "--error", "1", "-o", self.out)
        self.assertEqual(done.returncode, 66)


if __name__ == "__main__":
    unittest.main()
