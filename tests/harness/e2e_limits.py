#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""`neph limits`: a file of limits from repeated runs, and `--limits FILE` of compare and flicker.
The statistics are tested in tests/metrics/test_run_limit.c."""
import json
import random
import unittest
import xml.etree.ElementTree

import frames
import neph_case

WIDTH, HEIGHT = 24, 16
PIXELS = WIDTH * HEIGHT
DEVICE = ("neph.device", "string", b"a device"), ("neph.engine_version", "string", b"driver 1")


class Limits(neph_case.NephCase):
    def run_of(self, name, seed, bias=1.0, noise=0.1, attributes=DEVICE, size=(WIDTH, HEIGHT)):
        """A frame with independent noise."""
        draw = random.Random(seed)
        path = self.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        count = size[0] * size[1]
        values = [bias * (0.5 + i / count) * draw.uniform(1 - noise, 1 + noise)
                  for i in range(count)]
        path.write_bytes(frames.exr_bytes(*size, {"Y": values}, attributes))
        return path

    def runs(self, count=11, **given):
        return [self.run_of(f"runs/seed_{seed}.exr", seed, **given) for seed in range(count)]

    def limits(self, *words, **given):
        """The file of limits and its content."""
        found = self.json("limits", *words, "-o", self.folder / "out", **given)
        path = self.folder / "out/limits.json"
        self.assertEqual(json.loads(path.read_text()), found)
        return path, found

    def test_limits_hold_on_others(self):
        runs = self.runs()
        path, found = self.limits(*runs)
        self.assertEqual((found["runs"], found["frames"], found["size"]), (10, 1, [WIDTH, HEIGHT]))
        self.assertEqual(found["environment"], "driver 1, a device")
        self.assertAlmostEqual(found["alarm_rate"], 0.0025, delta=1e-12)
        self.assertEqual(found["reference"]["first"], str(runs[0]))
        for limit in found["limits"]:
            self.assertEqual((limit["runs"], limit["confidence"]), (10, 0.95), limit)
            if limit["fails"] == "above":
                largest = max(abs(limit["lowest"]), abs(limit["highest"]))
                self.assertGreater(limit["limit"], largest, limit)
            else:
                self.assertLess(limit["limit"], limit["lowest"], limit)
        # 20 runs at an alarm rate of 0.0025: more than one alarm has a probability of 0.001.
        alarms = 0
        for seed in range(100, 120):
            done = neph_case.run("compare", "-r", runs[0], self.run_of("new.exr", seed),
                                 "--limits", path)
            self.assertIn(done.returncode, (0, 1), done.stderr)
            alarms += done.returncode
        self.assertLessEqual(alarms, 1)
        self.assertRegex(done.stdout, r"^PASS all \d+ limits of '.*limits.json', from 10 runs\n")
        self.assertLessEqual(len(done.stdout.splitlines()), 10)

    def test_change_is_found(self):
        runs = self.runs()
        path, found = self.limits(*runs, "-m", "rel_bias,rel_rmse")
        self.assertEqual({(limit["metric"], limit["mask"]) for limit in found["limits"]},
                         {("rel_bias", "all"), ("rel_rmse", "all")})
        biased = self.run_of("biased.exr", 200, bias=1.05)
        junit = self.folder / "junit.xml"
        done = self.neph("compare", "-r", runs[0], biased, "--limits", path, "--junit", junit,
                         code=1, said="above the limit")
        self.assertRegex(done.stdout, r"^FAIL rel_bias \S+ > \S+\n")
        self.assertRegex(done.stdout, r"\nFAIL \d of 2 limits of '")
        self.assertEqual(len(xml.etree.ElementTree.parse(junit).findall(".//testcase")), 2)
        answer = self.json("compare", "-r", runs[0], biased, "--limits", path, code=1)["limits"]
        self.assertEqual((answer["count"], answer["runs"]), (2, 10))
        self.assertIn("rel_bias", [limit["metric"] for limit in answer["failed"]])
        # The factor for two numbers of 10 runs, by hand: t(9; 1 - 0.0025 / 4) sqrt(1.1) for a
        # signed number; 4.7808 is of a table of Student's t for 0.0005, 4.4988 of 0.00075.
        values = [self.json("compare", runs[0], run, "-m", "rel_bias")["measurements"]
                  for run in runs[1:]]
        values = [number["value"] for numbers in values for number in numbers
                  if (number["metric"], number["mask"]) == ("rel_bias", "all")]
        mean = sum(values) / 10
        deviation = (sum((v - mean) ** 2 for v in values) / 9) ** 0.5
        limit = next(l["limit"] for l in found["limits"] if l["metric"] == "rel_bias")
        factor = (limit - abs(mean)) / deviation / 1.1 ** 0.5
        self.assertTrue(4.4988 < factor < 4.7808, factor)

    def test_equal_runs(self):
        runs = [self.run_of(f"runs/{i}.exr", 1) for i in range(6)]
        path, found = self.limits(*runs, "-m", "mae,max_abs")
        self.assertEqual({limit["limit"] for limit in found["limits"]}, {0.0})
        self.assertEqual({limit["confidence"] for limit in found["limits"]}, {None})
        self.assertEqual(found["alarm_rate"], 0.0)
        done = self.neph("limits", *runs, "-o", self.folder / "out", "-q")
        self.assertIn("all runs are equal, and a further run has to be, too", done.stdout)
        self.neph("compare", *runs[:2], "--limits", path)
        self.neph("compare", runs[0], self.run_of("other.exr", 2), "--limits", path, code=1,
                  said="above the limit 0")

    def test_a_given_reference_and_text(self):
        reference = self.run_of("reference.exr", 0, noise=0.0)
        runs = self.runs(10)
        done = self.neph("limits", "-r", reference, *runs, "-o", self.folder / "out", "-m",
                         "rel_rmse,ssim_mean,pu_psnr", "--environment", "CI")
        lines = done.stdout.splitlines()
        self.assertRegex(lines[0], r"^3 limits of 10 runs in '")
        self.assertRegex(lines[1], r"^with 95 % confidence at least 95 % of further runs are "
                                   r"within all of them; .* with probability 0.0025 at most$")
        self.assertIn("environment: CI", lines)
        self.assertIn("rel_rmse", done.stdout)
        test = self.run_of("new.exr", 300)
        done = self.neph("compare", reference, test, "--limits", self.folder / "out/limits.json")
        self.assertIn("were measured in 'CI', the test is from 'driver 1, a device'", done.stderr)
        done = self.neph("compare", runs[0], test, "--limits", self.folder / "out/limits.json",
                         code=1, said="the limit")
        self.assertRegex(done.stderr, "are for the reference '.*reference.exr', not for")

    def test_sequences_without_a_reference(self):
        for run in range(9):
            for frame in range(16):
                self.run_of(f"runs/{run}/f.{frame:04}.exr", 100 * run + frame, size=(16, 16))
        runs = sorted((self.folder / "runs").iterdir())
        path, found = self.limits("--temporal", *runs[:8], "-m", "std_p95,a4_p95")
        self.assertIsNone(found["reference"])
        self.assertEqual((found["runs"], found["frames"]), (8, 16))
        self.neph("flicker", runs[8], "--limits", path)
        restless = self.folder / "restless"
        for frame in range(16):
            self.run_of(f"restless/f.{frame:04}.exr", 900 + frame, noise=0.4, size=(16, 16))
        self.neph("flicker", restless, "--limits", path, code=1, said="above the limit")
        self.neph("flicker", restless, "--limits", path, "--warm-up", 1, code=65,
                  said="are for 16 frames after a warm-up of 0, the comparison has 15 after 1")
        self.neph("flicker", restless, "--limits", path, "--fps", 30, code=65, said="say --fps 60")
        self.neph("limits", "--temporal", *runs, "-m", "rel_rmse", code=64,
                  said="error needs a reference")

    def test_refusals(self):
        runs = self.runs(7)
        out = ("-o", self.folder / "out")
        more = self.run_of("more/f.0001.exr", 50), self.run_of("more/f.0002.exr", 51)
        for words, code, said in (
                ((), 64, "0 runs are named, at least 6 are needed: the first is the reference"),
                (runs[:5], 64, "5 runs are named, at least 6 are needed"),
                (("-r", *runs[:5]), 64, "4 runs are named, at least 5 are needed"),
                (("-r", *runs, runs[0]), 64, "is the reference and a run"),
                ((*runs, self.folder / "none"), 66, "none"),
                ((*runs, more[0].parent), 65, "has 1 frames, "),
                ((*runs, runs[-1]), 65, "have the same numbers, others differ"),
                ((*runs, "--share", "1"), 64, "--share"),
                ((*runs, "-m", "no_metric"), 64, "there is no extractor or metric 'no_metric'"),
                ((*runs, self.run_of("small.exr", 1, size=(8, 8))), 65, "8x8")):
            self.neph("limits", *words, *out, code=code, said=said)
        self.assertFalse((self.folder / "out").exists())

    def test_files_that_are_no_limits(self):
        runs = self.runs(6)
        path, found = self.limits(*runs, "-m", "mae")
        small = self.run_of("small.exr", 1, size=(8, 8))
        self.neph("compare", small, small, "--limits", path, code=65,
                  said=f"are for frames of {WIDTH}x{HEIGHT} pixels, the test has 8x8")
        self.neph("compare", "--z", *runs[:2], "--limits", path, code=64, said="no --limits")
        self.neph("compare", *runs[:2], "--limits", self.folder / "no.json", code=66,
                  said="no.json")
        limit = found["limits"][0]
        for text, said in (
                ("{", "is not a file of limits"),
                ("[]", "is not a file of limits"),
                (json.dumps({**found, "neph_limits": 2}), "the version of the format, is not 1"),
                (json.dumps({**found, "limits": []}), "it has no limits"),
                (json.dumps({**found, "limits": [{**limit, "metric": "mea"}]}), "radiance:mea@all"),
                (json.dumps({**found, "limits": [{**limit, "limit": -1}]}), "limit 1 is not valid"),
                (json.dumps({**found, "limits": [limit, {"metric": "mae"}]}), "limit 2 is not"),
                (json.dumps({**found, "limits": [{**limit, "fails": "no"}]}), "above or below"),
                (json.dumps({key: value for key, value in found.items() if key != "viewing"}),
                 "viewing")):
            self.neph("compare", *runs[:2], "--limits", self.put("bad.json", text), code=65,
                      said=said)


if __name__ == "__main__":
    unittest.main()
