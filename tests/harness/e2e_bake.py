#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""`neph bake`, run as a user would: files, the printed error, and what goes wrong."""
import json
import os
import pathlib
import shutil
import struct
import subprocess
import tempfile
import unittest

NEPH = pathlib.Path(os.environ["NEPH"])


def neph(*arguments, program=NEPH, **environment):
    return subprocess.run([program, *map(str, arguments)], capture_output=True, text=True,
                          timeout=60, env={**os.environ, **environment})


class Bake(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def test_help_teaches(self):
        done = neph("bake", "--help")
        self.assertEqual((done.returncode, "Examples:" in done.stdout), (0, True))

    def test_error_falls_with_resolution_and_is_printed(self):
        errors = []
        for resolution in (32, 64):
            done = neph("bake", "gaussian_blob", "--resolution", resolution, "-o",
                        self.folder / "blob.vdb", "--json")
            self.assertEqual(done.returncode, 0, done.stderr)
            result = json.loads(done.stdout)
            self.assertEqual(max(result["size"]), resolution)
            errors.append(result["error"]["extinction_rms_relative"])
        self.assertAlmostEqual(errors[0] / errors[1], 4.0, delta=0.4)  # second order
        done = neph("bake", "gaussian_blob", "-o", self.folder / "blob.vdb")
        self.assertEqual(done.returncode, 0, done.stderr)
        for word in ("64 x 64 x 64", "extinction", "optical depth", "transmittance"):
            self.assertIn(word, done.stdout)
        self.assertEqual((self.folder / "blob.vdb").read_bytes()[:4], b" BDV")

    def test_a_grid_goes_into_df3_as_it_is(self):
        path = self.folder / "grid.df3"
        done = neph("bake", "voxel_grid", "-o", path, "--json")
        self.assertEqual(done.returncode, 0, done.stderr)
        result = json.loads(done.stdout)
        self.assertEqual((result["size"], result["is_copy"]), ([4, 3, 5], True))
        self.assertEqual(result["extinction_of_density_1_per_m"], 6.0)
        data = path.read_bytes()
        size = struct.unpack(">3H", data[:6])
        codes = struct.unpack(f">{(len(data) - 6) // 4}I", data[6:])
        self.assertEqual((size, len(codes)), ((6, 5, 7), 6 * 5 * 7))
        node = lambda i, j, k: codes[((k + 1) * 5 + j + 1) * 6 + i + 1] / (2**32 - 1)
        self.assertEqual((node(0, 0, 0), node(-1, 0, 0), node(0, 2, 4)), (1.0, 0.0, 1.0))
        self.assertAlmostEqual(node(2, 0, 0), 0.2, delta=1e-7)  # a float32 in the grid

    @unittest.skipUnless(shutil.which("povray"), "POV-Ray is not installed")
    def test_the_cost_of_baking_stands_beside_the_frame(self):
        request = ("validate", "gaussian_blob", "-e", "exact", "-e", "povray", "--size", "16x9",
                   "--no-charts", "-q", "-o", self.folder)
        done = neph(*request, "--json")
        self.assertEqual(done.returncode, 0, done.stderr)
        bakes = {frame["engine"]: frame["bake"]
                 for frame in json.loads(done.stdout)["scenes"][0]["frames"]}
        self.assertIsNone(bakes["exact"])
        self.assertEqual(bakes["povray"]["grid"], "64 x 64 x 64 nodes")
        self.assertGreater(bakes["povray"]["transmittance_max"], 1e-5)
        self.assertLess(bakes["povray"]["transmittance_max"], 1e-2)
        # now from the store
        self.assertIn("of 64 x 64 x 64 nodes: off by up to", neph(*request).stdout)

    def test_wrong_requests_say_the_way_out(self):
        out = self.folder / "out.vdb"
        for arguments, code, words in (
            (("gaussian_blob", "-o", "blob.raw"), 64, ".vdb"),
            (("gaussian_blob", "--medium", "2", "-o", out), 64, "1..1"),
            (("gaussian_blob", "--resolution", "1", "-o", out), 64, "2..1024"),
            (("gaussian_blob", "--resolution", "1024", "-o", out), 65, "MiB"),
            (("gaussian_blob", "-o", self.folder / "no_folder" / "x.vdb"), 74, "no_folder"),
            (("no_such_scene", "-o", out), 66, "neph scenes"),
        ):
            done = neph("bake", *arguments)
            self.assertEqual(done.returncode, code, (arguments, done.stderr))
            self.assertIn(words, done.stderr)
        self.assertEqual(list(self.folder.iterdir()), [])

    def test_neph_vdb_is_found_beside_neph_and_missed_in_words(self):
        copied = self.folder / "neph"
        shutil.copy(NEPH, copied)
        shutil.copy(NEPH.with_name("neph-vdb"), self.folder / "neph-vdb")
        done = neph("bake", "voxel_grid", "-o", self.folder / "grid.vdb", program=copied)
        self.assertEqual(done.returncode, 0, done.stderr)
        done = neph("bake", "voxel_grid", "-o", self.folder / "other.vdb",
                    NEPH_VDB="/nowhere/neph-vdb")
        self.assertEqual(done.returncode, 69, done.stderr)
        for words in ("/nowhere/neph-vdb", "copy it"):
            self.assertIn(words, done.stderr)


if __name__ == "__main__":
    unittest.main()
