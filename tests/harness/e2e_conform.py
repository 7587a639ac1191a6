#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""`neph conform`: a device agrees with itself, and every change in a folder is found."""
import json
import shutil
import unittest

import frames
import neph_case
from neph_case import ROOT


class Conform(neph_case.NephCase):
    words = ("conform",)

    @classmethod
    def setUpClass(cls):
        cls.made = neph_case.scratch(cls.addClassCleanup) / "a"
        cls.rendered = neph_case.run("conform", "--only", "height_fog_level", "-e", "march",
                                     "--size", "32x18", "-o", cls.made)

    def changed(self, change=lambda scene: None):
        """A copy of the folder, with a change."""
        folder = shutil.copytree(self.made, self.folder / "b", dirs_exist_ok=True)
        path = folder / "height_fog_level.json"
        scene = json.loads(path.read_text())
        change(scene)
        path.write_text(json.dumps(scene))
        return folder

    def refused(self, folder, *words):
        for first, second in ((self.made, folder), (folder, self.made)):
            done = self.neph(first, second, code=1)
            for word in words:
                self.assertIn(word, done.stdout)
            self.assertIn("0 of 1 frames agree", done.stdout)

    def test_all_pictures_are_counted(self):
        self.assertEqual(self.rendered.returncode, 0, self.rendered.stderr)
        self.assertEqual(self.rendered.stdout, "1 of 1 frames are finite and nowhere negative\n")
        self.assertIn("[1/1] height_fog_level_march: rendered", self.rendered.stderr)
        self.assertEqual(sorted(path.name for path in self.made.iterdir()),
                         ["height_fog_level.json", "height_fog_level_march.exr"])

    def test_a_device_agrees_with_itself(self):
        report = self.json(self.made, self.made)
        self.assertEqual((report["expected"], report["agreeing"]), (1, 1))
        channels = {c["channel"]: c for c in report["pictures"][0]["channels"]}
        self.assertEqual(len(channels), 11)
        self.assertEqual({c["worst"] for c in channels.values()}, {0.0})

    def test_a_part(self):
        for part in (("-e", "tracer"), ("--only", "voxel_grid")):
            self.neph(*part, self.made, self.made, code=1, said="nothing to compare")
        folder = self.changed(lambda scene: scene["pictures"].append(
            {**scene["pictures"][0], "picture": "height_fog_level_tracer", "engine": "tracer"}))
        self.neph(self.made, folder, code=1)
        done = self.neph("-e", "march", "--only", "height_fog_level", self.made, folder)
        self.assertIn("1 of 1 frames agree", done.stdout)

    def test_other_pixels(self):
        folder = self.changed()
        path = folder / "height_fog_level_march.exr"
        width, height, channels, *_ = frames.read_exr(path)
        values = list(channels["G"])
        for i in range(3):  # one may differ: 0.2 % of 576
            values[7 * i] *= 1.001
        channels["G"] = values
        path.write_bytes(frames.exr_bytes(width, height, channels))
        self.refused(folder, "height_fog_level_march: G: 3 pixels beyond the bound")

    def test_another_mean(self):
        def change(scene):
            scene["pictures"][0]["channels"][0]["mean"] *= 1.001
        self.refused(self.changed(change), "means")

    def test_a_missing_picture_and_a_missing_scene(self):
        self.refused(self.changed(lambda scene: scene["pictures"].clear()), "folder has it")
        (self.folder / "empty").mkdir()
        self.neph(self.made, self.folder / "empty", code=65)
        self.neph(self.made, self.folder / "none", code=66)

    def test_what_cannot_be_compared(self):
        for key, value, words in (("engine", 7, "engines differ"),
                                  ("settings", "steps=8", "settings differ"),
                                  ("size_px", [64, 36], "sizes differ"),
                                  ("outcome", "failed", "one rendered it")):
            with self.subTest(key):
                self.refused(self.changed(
                    lambda scene: scene["pictures"][0].update({key: value})), words)
        self.refused(self.changed(lambda scene: scene.update(scene_hash="0")),
                     "scenes of that name differ")

    def test_a_scene_whose_data_is_absent_is_left_out_unless_it_is_asked_for(self):
        for name in ("disney_cloud", "height_fog_level"):
            self.put(f"scenes/catalog/{name}.yaml",
                     (ROOT / f"scenes/catalog/{name}.yaml").read_text())
        (self.folder / "scenes/stress").mkdir()
        request = ("-e", "march", "--size", "32x18", "-o", self.folder / "out")
        environment = {"NEPH_DATA_DIR": str(self.folder), "NEPH_DISNEY_CLOUD": ""}
        done = self.neph(*request, **environment)
        self.assertIn("disney_cloud: left out: ", done.stdout)
        self.assertIn("NEPH_DISNEY_CLOUD is not set", done.stdout)
        self.assertIn("1 of 1 frames are finite", done.stdout)
        self.neph(*request, "--only", "disney_cloud", code=66, **environment)

    def test_nothing_rendered_is_no_success(self):
        done = self.neph("--only", "white_furnace", "-e", "march", "--size", "8x8", "-o",
                         self.folder / "none", code=1)
        self.assertIn("0 of 0", done.stdout)

    def test_wrong_requests(self):
        self.check_refusals((64, "", ("-e", "cycles", "-o", self.folder / "x")),
                            (64, "", ("-o", "")), (64, "", (self.made,)))


if __name__ == "__main__":
    unittest.main()
