#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""`neph scaling`: counted costs grow as expected, on any device. No absolute times: machines
differ."""
import json
import unittest

import night
from neph_case import NephCase



class Scaling(NephCase):
    in_folder = True
    words = ("scaling",)

    @night.of_the_night
    def test_a_cloud(self):
        document = self.json("voxel_grid", "--size", "32x18", "-q")
        self.assertEqual(document["format"], "neph-scaling-1")
        self.assertFalse(document["has_closed_form"])
        lines = {(line["series"], line["axis"]): line for line in document["lines"]}
        self.assertEqual(len(lines), 10)
        for (series, axis), line in lines.items():
            self.assertIsNone(line["missing"])
            for point in line["points"]:
                self.assertGreater(point["seconds"], 0.0, (series, axis))
            # Such a small frame has few tiles, and whether rays hit the cloud depends on chance.
            if axis != "pixels":
                self.assertEqual(line["work"]["verdict"], "as expected", (series, axis))
        least, *_, most = lines["march", "steps"]["points"]
        self.assertAlmostEqual(most["evaluations"] / least["evaluations"], 16.0, delta=0.5)
        self.check_against(document)

    def check_against(self, here):
        """Another device, twice as slow in everything; and files that are no such result."""
        other = json.loads(json.dumps(here))
        other["device"] = "a slow one"
        for line in other["lines"]:
            for point in line["points"]:
                point["seconds"] *= 2.0
        self.put("there.json", json.dumps(other))
        words = ("voxel_grid", "--size", "32x18", "-q", "--all", "--other-device", "there.json")
        done = self.neph(*words)
        table = done.stdout.split("there/here\n")[1].splitlines()
        self.assertEqual(len(table), sum(len(line["points"]) for line in here["lines"]))
        stored = [row for row in table if " pictures " not in row]  # timed on every run
        for row in stored:
            self.assertAlmostEqual(float(row.split()[-1]), 2.0, places=2, msg=row)
        other["scene"] = "another"
        self.put("there.json", json.dumps(other))
        self.neph(*words, code=65, said="of scene another")

    @night.of_the_night
    def test_fog_has_no_voxels(self):
        words = ("height_fog_level", "--size", "32x18", "-q", "--all", "--untimed")
        done = self.neph(*words)
        self.assertIn("none: height_fog_level has fog alone, which has no voxels", done.stdout)
        self.assertIn("engine exact marches no ray", done.stdout)
        self.assertNotIn("not as expected", done.stdout)
        several = self.neph(*words, "-o", "other", "--jobs", "2")
        self.assertEqual(several.stdout, done.stdout)

    def test_refused_arguments(self):
        self.check_refusals((64, "", ()), (66, "", ("no_such_scene",)),
                            (64, "1..4096 pixels", ("voxel_grid", "--size", "5000x9")),
                            (64, "mine", ("voxel_grid", "--preset", "mine")))


if __name__ == "__main__":
    unittest.main()
