#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""`--jobs` of `neph compare` and `neph flicker`: the same bits with any number of threads, and the
same errors, although frames are read ahead."""
import random
import shutil
import unittest

import frames
import neph_case

WIDTH, HEIGHT, FRAMES = 80, 60, 16
LARGE = 180, 176  # enough for ms_ssim


def put_frame(path, seed, width, height):
    """A frame with noise, and an edge of depth."""
    draw = random.Random(seed)
    values = [0.2 + 1e-4 * i + 0.2 * draw.random() for i in range(width * height)]
    depths = [5.0 if i % width < width // 3 else 500.0 for i in range(width * height)]
    path.parent.mkdir(exist_ok=True)
    frames.grey_exr(path, width, height, values, Z=depths)
    return path


class Jobs(neph_case.NephCase):
    @classmethod
    def setUpClass(cls):
        cls.made = neph_case.scratch(cls.addClassCleanup)
        for name, step in ("reference", 0), ("test", 1):
            for frame in range(FRAMES):
                put_frame(cls.made / name / f"f.{frame:04}.exr", step * frame, WIDTH, HEIGHT)

    def setUp(self):
        super().setUp()
        shutil.copytree(self.made, self.folder, dirs_exist_ok=True)
        self.reference, self.test = self.folder / "reference", self.folder / "test"

    def assert_same(self, *words):
        """The output for people and as JSON has the same bytes with 1, 2 and 5 threads."""
        for form in (), ("--json",):
            found = {self.neph(*words, *form, "--jobs", jobs).stdout for jobs in (1, 2, 5)}
            self.assertEqual(len(found), 1, words)
            self.assertGreater(len(found.pop()), 100)

    def test_flicker(self):
        self.assert_same("flicker", "-r", self.reference / "f.0000.exr", self.test, "--frozen-ok",
                         "--all")

    def test_compare(self):
        pattern = "f.000[0-3].exr"
        self.assert_same("compare", "-r", self.reference / pattern, self.test / pattern, "--all")
        large = [put_frame(self.folder / f"{seed}.exr", seed, *LARGE) for seed in (1, 2)]
        self.assert_same("compare", *large, "-m", "flip,hdr_flip,ssim,ms_ssim,pu21,stops,shift")

    def test_a_damaged_frame(self):
        path = self.test / "f.0009.exr"
        path.write_bytes(path.read_bytes()[:-1000])
        errors = set()
        for jobs in 1, 2, 5:
            done = self.neph("flicker", "-r", self.reference, self.test, "-q", "--frozen-ok",
                             "--jobs", jobs, code=65, said="f.0009.exr")
            errors.add(done.stderr)
        self.assertEqual(len(errors), 1, errors)

    def test_frozen_frames(self):
        (self.test / "f.0005.exr").write_bytes((self.test / "f.0004.exr").read_bytes())
        for jobs in 1, 5:
            self.neph("flicker", "-r", self.reference, self.test, "-q", "--jobs", jobs, code=1,
                      said=f"1 of {FRAMES} test frames are bit for bit the frame before, first "
                           f"'{self.test}/f.0005.exr'")

    def test_range(self):
        for jobs in 0, 257, "x":
            self.neph("compare", self.reference, self.test, "--jobs", jobs, code=64, said="jobs")


if __name__ == "__main__":
    unittest.main()
