#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""`neph scaling`: what is counted grows as it ought to, on any device. No absolute times: machines
differ."""
import json
import os
import pathlib
import subprocess
import tempfile
import unittest

import night

NEPH = os.environ["NEPH"]


def run(*arguments):
    return subprocess.run([NEPH, *arguments], capture_output=True, text=True, timeout=600)


class Scaling(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.out = folder.name

    @night.of_the_night
    def test_a_cloud(self):
        done = run("scaling", "voxel_grid", "--size", "32x18", "-o", self.out, "-q", "--json")
        self.assertEqual(done.returncode, 0, done.stderr)
        document = json.loads(done.stdout)
        self.assertEqual(document["format"], "neph-scaling-1")
        self.assertFalse(document["has_closed_form"])
        lines = {(line["series"], line["axis"]): line for line in document["lines"]}
        self.assertEqual(len(lines), 10)
        for (series, axis), line in lines.items():
            self.assertIsNone(line["missing"])
            for point in line["points"]:
                self.assertGreater(point["seconds"], 0.0, (series, axis))
            # So small a picture has few tiles, and rays that just meet the cloud or do not.
            if axis != "pixels":
                self.assertEqual(line["work"]["verdict"], "as expected", (series, axis))
        least, *_, most = lines["march", "steps"]["points"]
        self.assertAlmostEqual(most["evaluations"] / least["evaluations"], 16.0, delta=0.5)
        self.check_against(document)

    def check_against(self, here):
        """Another device, twice as slow in everything; and what is none."""
        there = pathlib.Path(self.out, "there.json")
        other = json.loads(json.dumps(here))
        other["device"] = "a slow one"
        for line in other["lines"]:
            for point in line["points"]:
                point["seconds"] *= 2.0
        there.write_text(json.dumps(other))
        words = ("scaling", "voxel_grid", "--size", "32x18", "-o", self.out, "-q", "--against",
                 str(there))
        done = run(*words)
        self.assertEqual(done.returncode, 0, done.stderr)
        table = done.stdout.split("there/here\n")[1].splitlines()
        self.assertEqual(len(table), sum(len(line["points"]) for line in here["lines"]))
        stored = [row for row in table if " pictures " not in row]  # those are timed each time
        for row in stored:
            self.assertAlmostEqual(float(row.split()[-1]), 2.0, places=2, msg=row)
        other["scene"] = "another"
        there.write_text(json.dumps(other))
        done = run(*words)
        self.assertEqual(done.returncode, 65, done.stderr)
        self.assertIn("of scene another", done.stderr)

    @night.of_the_night
    def test_fog_has_no_voxels(self):
        done = run("scaling", "height_fog_level", "--size", "32x18", "-o", self.out, "-q",
                   "--untimed")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("none: height_fog_level has fog alone, which has no voxels", done.stdout)
        self.assertIn("engine exact marches no ray", done.stdout)
        self.assertNotIn("not as expected", done.stdout)
        several = run("scaling", "height_fog_level", "--size", "32x18", "-o", self.out + "/other",
                      "-q", "--untimed", "--jobs", "2")
        self.assertEqual((several.returncode, several.stdout), (0, done.stdout), several.stderr)

    def test_what_is_refused(self):
        self.assertEqual(run("scaling").returncode, 64)
        done = run("scaling", "no_such_scene", "-o", self.out)
        self.assertEqual(done.returncode, 66, done.stderr)
        done = run("scaling", "voxel_grid", "--preset", "mine", "-o", self.out)
        self.assertEqual(done.returncode, 64, done.stderr)
        self.assertIn("mine", done.stderr)


if __name__ == "__main__":
    unittest.main()
