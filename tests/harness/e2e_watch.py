#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The main job while it runs: a page from the first scene on, a page that reports an interrupted
run, several processes at a time, and tiers by name."""
import json
import math
import pathlib
import re
import struct
import unittest

import frames
from neph_case import NephCase

SCENES = ["scattering_slab_above", "absorbing_slab", "height_fog_level"]
PATIENCE_S = 300  # for a busy machine; nothing here takes seconds


def without_times(value, folder):
    """A document without times, memory and the run's folder."""
    if isinstance(value, dict):
        return {key: without_times(item, folder) for key, item in value.items()
                if key not in ("render_s", "wall_s", "cpu_s", "seconds", "created_utc",
                               "peak_memory_bytes")}
    if isinstance(value, list):
        return [without_times(item, folder) for item in value]
    return value.replace(str(folder), "") if isinstance(value, str) else value


class Watch(NephCase):
    def setUp(self):
        super().setUp()
        self.out = self.folder / "out"

    def data(self):
        """The data of the page; each read gets a complete file, whatever the run is doing."""
        path = self.out / "report/data.json"
        try:
            return json.loads(path.read_text())
        except FileNotFoundError:  # not yet there, or being replaced
            return None

    def wait_for_page(self, child):
        self.wait_until(self.data, child, PATIENCE_S)
        page = self.data()
        self.assertTrue(page, "no page while the run went on")
        return page

    def test_a_page_is_there_from_the_first_scene_on_and_after_an_interruption(self):
        # The last scene is large enough that it is unfinished when the page of the first is read.
        child = self.start("validate", *SCENES, "-e", "exact", "-e", "oracle", "--size", "192x108",
                           "-q", "-o", self.out)
        page = self.wait_for_page(child)
        self.assertEqual(page["verdict"], "running")
        self.assertGreaterEqual(len(page["scenes"]), 1)
        self.assertLess(len(page["scenes"]), len(SCENES))
        self.assertLess(page["progress"]["done"], page["progress"]["total"])
        self.assertGreater(page["progress"]["left_s"], 0)
        self.assertTrue(
            (self.out / "report" / page["scenes"][0]["frames"][0]["picture"]).is_file())
        self.interrupt(child)
        page = self.data()
        self.assertEqual(page["verdict"], "interrupted")
        self.assertGreaterEqual(len(page["scenes"]), 1)

    def test_a_finished_page_is_no_longer_running(self):
        self.neph("validate", SCENES[0], "-e", "exact", "-e", "oracle", "--size", "32x18", "-q",
                  "-o", self.out)
        self.assertNotIn("progress", self.data())
        self.assertEqual(self.data()["verdict"], "pass")

    def test_results_do_not_depend_on_the_number_of_jobs(self):
        command = ["validate", *SCENES, "-e", "exact", "-e", "oracle", "-e", "march", "--size",
                   "16x9"]
        made = []
        for jobs in (1, 3):
            self.out = self.folder / f"jobs_{jobs}"
            done = self.neph(*command, "--jobs", jobs, "-o", self.out)
            steps = re.findall(r"^\[(\d+)/(\d+)\] (.*): (\w+),", done.stderr, re.MULTILINE)
            made.append((without_times(self.data(), self.out),
                         sorted((what, outcome) for *_, what, outcome in steps),
                         [(int(step), int(count)) for step, count, *_ in steps]))
        self.assertEqual(made[0], made[1])
        self.assertEqual(made[1][2], [(n + 1, len(made[1][2])) for n in range(len(made[1][2]))])
        self.neph(*command, "--jobs", 2, "-q", "-o", self.out)
        frames = [frame for scene in self.data()["scenes"] for frame in scene["frames"]]
        self.assertEqual({frame["reused"] for frame in frames
                          if frame["status"] == "rendered"}, {True})

    def test_an_interrupted_run_of_several_jobs_has_a_page_and_goes_on(self):
        command = ("validate", *SCENES, "-e", "exact", "-e", "oracle", "--jobs", "2", "-q", "-o",
                   self.out, "--size", "96x54")
        child = self.start(*command)
        self.wait_for_page(child)
        self.interrupt(child)
        self.assertEqual(self.data()["verdict"], "interrupted")
        self.neph(*command)
        self.assertEqual(len(self.data()["scenes"]), len(SCENES))

    def test_noise_is_that_between_two_seeds(self):
        self.neph("validate", SCENES[0], "-e", "exact", "-e", "oracle", "-e", "march", "--size",
                  "32x18", "-q", "-o", self.out)
        found = {frame["engine"]: frame for frame in self.data()["scenes"][0]["frames"]}
        self.assertEqual((found["exact"]["noise"], found["march"]["noise"]), (None, None))
        oracle = found["oracle"]
        first, second = (frames.read_exr(pathlib.Path(oracle[key]))[2]
                         for key in ("exr", "exr_second"))
        pairs = [pair for c in "RGB" for pair in zip(first[c], second[c])]
        noise = math.sqrt(0.5 * sum((a - b) ** 2 for a, b in pairs) / sum(a * b for a, b in pairs))
        self.assertEqual(oracle["noise"]["unit"], "1")
        self.assertAlmostEqual(oracle["noise"]["value"] / noise, 1, places=9)  # sums of doubles
        self.assertIn(f"{100 * noise:.2g} % of the rms radiance", oracle["noise"]["text"])

    def test_scenes_of_the_quick_tier_have_sizes_of_their_own(self):
        # Only `exact`, which is fast at any size and has no engine to be compared with.
        command = ("validate", "-e", "exact", "--no-charts", "-q", "-o", self.out)
        self.neph(*command, code=1)
        sizes = {scene["name"]: scene["size_px"] for scene in self.data()["scenes"]}
        self.assertEqual((sizes["cumulus"], sizes["colonnade"]), ([320, 180], [320, 180]))
        self.assertEqual(sizes["scattering_slab_above"], [96, 54])
        for scene in self.data()["scenes"]:
            for frame in (frame for frame in scene["frames"] if frame["picture"]):
                picture = (self.out / "report" / frame["picture"]).read_bytes()
                self.assertEqual(list(struct.unpack(">II", picture[16:24])), scene["size_px"])
                self.assertIsNone(frame["speed"])
        counts = self.data()["counts"]
        self.assertEqual((counts["expected"], counts["reported"]), (len(sizes), len(sizes)))
        self.neph(*command, "--size", "16x9", code=1)
        self.assertEqual({tuple(scene["size_px"]) for scene in self.data()["scenes"]}, {(16, 9)})

    def test_tiers_have_names(self):
        self.check_refusals(
            (64, "quick and full", ("--tier", "sloth")),
            (64, "either", ("--tier", "full", "--suite", "catalog")),
            (64, "budget '0'", ("--budget", "0")), (64, "budget 'soon'", ("--budget", "soon")),
            before=("validate", "-o", self.out))


if __name__ == "__main__":
    unittest.main(verbosity=2)
