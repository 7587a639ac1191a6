#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""`neph conform`: a device against itself agrees, and whatever is changed in a folder is found."""
import json
import os
import pathlib
import shutil
import subprocess
import tempfile
import unittest

import frames

NEPH = os.environ["NEPH"]


def conform(*arguments):
    return subprocess.run([NEPH, "conform", *arguments], timeout=300, capture_output=True,
                          text=True)


class Conform(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.folder.cleanup)
        cls.made = os.path.join(cls.folder.name, "a")
        cls.rendered = conform("--scene", "height_fog_level", "-e", "march", "--size", "32x18",
                               "-o", cls.made)

    def changed(self):
        """A copy of the folder, to be changed."""
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        return shutil.copytree(self.made, os.path.join(folder.name, "b"))

    def rewrite(self, folder, change):
        path = os.path.join(folder, "height_fog_level.json")
        with open(path, encoding="utf-8") as file:
            scene = json.load(file)
        change(scene)
        with open(path, "w", encoding="utf-8") as file:
            json.dump(scene, file)

    def refused(self, folder, *words):
        for first, second in ((self.made, folder), (folder, self.made)):
            done = conform(first, second)
            self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
            for word in words:
                self.assertIn(word, done.stdout)
            self.assertIn("0 of 1 pictures agree", done.stdout)

    def test_all_pictures_are_counted(self):
        self.assertEqual(self.rendered.returncode, 0, self.rendered.stderr)
        self.assertEqual(self.rendered.stdout, "1 of 1 pictures are finite and nowhere negative\n")
        self.assertIn("[1/1] height_fog_level_march: rendered", self.rendered.stderr)
        self.assertEqual(sorted(os.listdir(self.made)),
                         ["height_fog_level.json", "height_fog_level_march.exr"])

    def test_a_device_agrees_with_itself(self):
        done = conform("--json", self.made, self.made)
        self.assertEqual(done.returncode, 0, done.stderr)
        report = json.loads(done.stdout)
        self.assertEqual((report["expected"], report["agreeing"]), (1, 1))
        channels = {c["channel"]: c for c in report["pictures"][0]["channels"]}
        self.assertEqual(len(channels), 11)
        self.assertEqual({c["worst"] for c in channels.values()}, {0.0})

    def test_a_part(self):
        for part in (("-e", "tracer"), ("--scene", "voxel_grid")):
            done = conform(*part, self.made, self.made)
            self.assertEqual(done.returncode, 1)
            self.assertIn("nothing to compare", done.stderr)
        folder = self.changed()
        self.rewrite(folder, lambda scene: scene["pictures"].append(
            {**scene["pictures"][0], "picture": "height_fog_level_tracer", "engine": "tracer"}))
        self.assertEqual(conform(self.made, folder).returncode, 1)
        done = conform("-e", "march", "--scene", "height_fog_level", self.made, folder)
        self.assertEqual(done.returncode, 0, done.stdout)
        self.assertIn("1 of 1 pictures agree", done.stdout)

    def test_other_pixels(self):
        folder = self.changed()
        path = os.path.join(folder, "height_fog_level_march.exr")
        width, height, channels, *_ = frames.read_exr(pathlib.Path(path))
        values = list(channels["G"])
        for i in range(3):  # one may differ: 0.2 % of 576
            values[7 * i] *= 1.001
        channels["G"] = values
        with open(path, "wb") as file:
            file.write(frames.exr_bytes(width, height, channels))
        self.refused(folder, "height_fog_level_march: G: 3 pixels beyond the bound")

    def test_another_mean(self):
        folder = self.changed()

        def change(scene):
            scene["pictures"][0]["channels"][0]["mean"] *= 1.001
        self.rewrite(folder, change)
        self.refused(folder, "means")

    def test_a_missing_picture_and_a_missing_scene(self):
        folder = self.changed()
        self.rewrite(folder, lambda scene: scene["pictures"].clear())
        self.refused(folder, "folder has it")
        empty = os.path.join(self.folder.name, "empty")
        os.makedirs(empty, exist_ok=True)
        self.assertEqual(conform(self.made, empty).returncode, 65)
        self.assertEqual(conform(self.made, empty + "/none").returncode, 66)

    def test_what_cannot_be_compared(self):
        for key, value, words in (("engine", 7, "engines differ"),
                                  ("settings", "steps=8", "settings differ"),
                                  ("size_px", [64, 36], "sizes differ"),
                                  ("outcome", "failed", "one rendered it")):
            with self.subTest(key):
                folder = self.changed()
                self.rewrite(folder, lambda scene: scene["pictures"][0].update({key: value}))
                self.refused(folder, words)
        folder = self.changed()
        self.rewrite(folder, lambda scene: scene.update(scene_hash="0"))
        self.refused(folder, "scenes of that name differ")

    def test_a_scene_whose_data_is_absent_is_left_out_unless_it_is_asked_for(self):
        data = tempfile.TemporaryDirectory()
        self.addCleanup(data.cleanup)
        catalog = pathlib.Path(data.name, "scenes", "catalog")
        catalog.mkdir(parents=True)
        pathlib.Path(data.name, "scenes", "stress").mkdir()
        for name in ("disney_cloud", "height_fog_level"):
            shutil.copy(pathlib.Path(os.environ["NEPH_SOURCE_DIR"], "scenes", "catalog",
                                     f"{name}.yaml"), catalog)
        environment = {**os.environ, "NEPH_DATA_DIR": data.name}
        environment.pop("NEPH_DISNEY_CLOUD", None)
        request = [NEPH, "conform", "-e", "march", "--size", "32x18", "-o",
                   os.path.join(data.name, "out")]
        done = subprocess.run(request, timeout=300, capture_output=True, text=True, env=environment)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("disney_cloud: left out: ", done.stdout)
        self.assertIn("NEPH_DISNEY_CLOUD is not set", done.stdout)
        self.assertIn("1 of 1 pictures are finite", done.stdout)
        done = subprocess.run([*request, "--scene", "disney_cloud"], timeout=300,
                              capture_output=True, text=True, env=environment)
        self.assertEqual(done.returncode, 66, done.stderr)

    def test_nothing_rendered_is_no_success(self):
        done = conform("--scene", "white_furnace", "-e", "march", "--size", "8x8", "-o",
                       os.path.join(self.folder.name, "none"))
        self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
        self.assertIn("0 of 0", done.stdout)

    def test_wrong_requests(self):
        for arguments in (("-e", "cycles", "-o", self.folder.name + "/x"), ("-o", ""),
                          (self.made,)):
            with self.subTest(arguments):
                self.assertEqual(conform(*arguments).returncode, 64)


if __name__ == "__main__":
    unittest.main()
