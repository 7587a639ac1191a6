#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The main job while it runs: a page from the first scene on, one that says so when it was cut
short, several processes at a time, and tiers by name."""
import json
import os
import pathlib
import re
import signal
import subprocess
import tempfile
import time
import unittest

NEPH = os.environ["NEPH"]
SCENES = ["scattering_slab_above", "absorbing_slab", "height_fog_level"]
PATIENCE_S = 300  # of a machine that is busy with other things; nothing here takes seconds


def neph(*arguments):
    return subprocess.run([NEPH, *map(str, arguments)], capture_output=True, text=True,
                          timeout=PATIENCE_S)


def without_times(value, folder):
    """A document, but for times, memory and where the run lies."""
    if isinstance(value, dict):
        return {key: without_times(item, folder) for key, item in value.items()
                if key not in ("render_s", "wall_s", "cpu_s", "seconds", "created_utc",
                               "peak_memory_bytes")}
    if isinstance(value, list):
        return [without_times(item, folder) for item in value]
    return value.replace(str(folder), "") if isinstance(value, str) else value


class Watch(unittest.TestCase):
    def setUp(self):
        self.scratch = tempfile.TemporaryDirectory(prefix="neph-watch-")
        self.folder = pathlib.Path(self.scratch.name) / "out"

    def tearDown(self):
        self.scratch.cleanup()

    def data(self):
        """What the page shows; each look sees a whole file, whatever the run is doing."""
        path = self.folder / "report" / "data.json"
        try:
            return json.loads(path.read_text())
        except FileNotFoundError:  # not yet, or being exchanged
            return None

    def wait_for_page(self, child):
        end = time.monotonic() + PATIENCE_S
        while time.monotonic() < end and child.poll() is None:
            data = self.data()
            if data:
                return data
            time.sleep(0.01)
        self.fail("no page while the run went on")

    def test_a_page_is_there_from_the_first_scene_on_and_after_an_interruption(self):
        # The last scene is large enough to be still at work when the page of the first is read.
        child = subprocess.Popen([NEPH, "validate", *SCENES, "-e", "exact", "-e", "oracle",
                                  "--size", "192x108", "-q", "-o", self.folder],
                                 stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
        page = self.wait_for_page(child)
        self.assertEqual(page["verdict"], "running")
        self.assertGreaterEqual(len(page["scenes"]), 1)
        self.assertLess(len(page["scenes"]), len(SCENES))
        self.assertLess(page["progress"]["done"], page["progress"]["total"])
        self.assertGreater(page["progress"]["left_s"], 0)
        self.assertTrue(
            (self.folder / "report" / page["scenes"][0]["frames"][0]["picture"]).is_file())

        child.send_signal(signal.SIGINT)
        errors = child.communicate(timeout=PATIENCE_S)[1].decode()
        self.assertEqual(child.returncode, 130, errors)
        page = self.data()
        self.assertEqual(page["verdict"], "interrupted")
        self.assertGreaterEqual(len(page["scenes"]), 1)

    def test_a_finished_page_is_no_longer_running(self):
        done = neph("validate", SCENES[0], "-e", "exact", "-e", "oracle", "--size", "32x18", "-q",
                    "-o", self.folder)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertNotIn("progress", self.data())
        self.assertEqual(self.data()["verdict"], "pass")

    def test_results_do_not_depend_on_the_number_of_jobs(self):
        command = ["validate", *SCENES, "-e", "exact", "-e", "oracle", "-e", "march", "--size",
                   "16x9"]
        made = []
        for jobs in (1, 3):
            self.folder = pathlib.Path(self.scratch.name) / f"jobs_{jobs}"
            done = neph(*command, "--jobs", jobs, "-o", self.folder)
            self.assertEqual(done.returncode, 0, done.stderr)
            steps = re.findall(r"^\[(\d+)/(\d+)\] (.*): (\w+),", done.stderr, re.MULTILINE)
            made.append((without_times(self.data(), self.folder),
                         sorted((what, outcome) for *_, what, outcome in steps),
                         [(int(step), int(count)) for step, count, *_ in steps]))
        self.assertEqual(made[0], made[1])
        self.assertEqual(made[1][2], [(n + 1, len(made[1][2])) for n in range(len(made[1][2]))])
        again = neph(*command, "--jobs", 2, "-q", "-o", self.folder)
        self.assertEqual(again.returncode, 0, again.stderr)
        frames = [frame for scene in self.data()["scenes"] for frame in scene["frames"]]
        self.assertEqual({frame["reused"] for frame in frames
                          if frame["status"] == "rendered"}, {True})

    def test_an_interrupted_run_of_several_jobs_has_a_page_and_goes_on(self):
        command = [NEPH, "validate", *SCENES, "-e", "exact", "-e", "oracle", "--jobs", "2", "-q",
                   "-o", self.folder, "--size", "96x54"]
        child = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
        self.wait_for_page(child)
        child.send_signal(signal.SIGINT)
        errors = child.communicate(timeout=PATIENCE_S)[1].decode()
        self.assertEqual(child.returncode, 130, errors)
        self.assertEqual(self.data()["verdict"], "interrupted")
        done = neph(*command[1:])
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(len(self.data()["scenes"]), len(SCENES))

    def test_tiers_have_names(self):
        for wrong, said in ((["--tier", "sloth"], "quick and full"),
                            (["--tier", "full", "--suite", "catalog"], "either"),
                            (["--budget", "0"], "budget '0'"),
                            (["--budget", "soon"], "budget 'soon'")):
            done = neph("validate", *wrong, "-o", self.folder)
            self.assertEqual(done.returncode, 64, wrong)
            self.assertIn(said, done.stderr)


if __name__ == "__main__":
    unittest.main(verbosity=2)
