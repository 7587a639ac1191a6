#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""`neph bake` as a user runs it: files, the printed error, and refused arguments."""
import math
import pathlib
import shutil
import struct
import unittest

import frames
import neph_case
import night

NEPH = pathlib.Path(neph_case.NEPH)

# The camera looks along z, and a pixel of 11 x 9 is 0.5 m wide.
SCENE = """name: NAME
title: A block of voxels against a uniform sky
description: absorption alone
camera: {position_m: [1, 2, 20], look_at_m: [1, 2, 0], orthographic_height_m: 4.5}
background_w_per_m2_sr: [1, 1, 1]
scattering: none
media:
  - MEDIUM
"""


def node(i, j, k):
    return 0.1 + 0.05 * ((i * 3 + j * 5 + k * 7) % 11)


# Neither the block nor its voxels are cubes.
VALUES = [node(i, j, k) for k in range(5) for j in range(6) for i in range(7)]
GRID = ("grid: {size: [7, 6, 5], origin_m: [-0.5, 0.75, -1], spacing_m: [0.5, 0.5, 0.75], "
        f"extinction_per_m: 0.8, albedo: [0, 0, 0], values: {VALUES}}}")


class Bake(neph_case.NephCase):
    def write_scene(self, name, medium):
        path = self.folder / f"{name}.yaml"
        path.write_text(SCENE.replace("NAME", name).replace("MEDIUM", medium))
        return path

    def transmittance(self, name, medium, engine="exact", *settings):
        """The transmittance of each pixel, first row on top."""
        self.neph("render", self.write_scene(name, medium), "-e", engine, "--size", "11x9", "-q",
                  "-o", self.folder / "out", *settings)
        frame = self.folder / "out" / f"{name}_{engine}_0000.exr"
        return frames.read_exr(frame)[2]["transmittance.G"]

    def baked_entry(self, file):
        found = self.json("bake", self.write_scene("block", GRID), self.folder / file)
        entry = found["scene_entry"]
        self.assertIn(entry, self.neph("bake", self.folder / "block.yaml",
                                       self.folder / file).stdout)
        return entry

    def assert_close(self, found, expected, delta):
        self.assertEqual(len(found), len(expected))
        self.assertLess(max(abs(a - b) for a, b in zip(found, expected)), delta)

    def test_error_falls_with_resolution_and_is_printed(self):
        errors = []
        for resolution in (32, 64):
            found = self.json("bake", "gaussian_blob", "--resolution", resolution,
                              self.folder / "blob.vdb")
            result = found
            self.assertEqual(max(result["size"]), resolution)
            errors.append(result["error"]["extinction_rms_relative"])
        self.assertAlmostEqual(errors[0] / errors[1], 4.0, delta=0.4)  # second order
        done = self.neph("bake", "gaussian_blob", self.folder / "blob.vdb")
        for word in ("64 x 64 x 64", "extinction", "optical depth", "transmittance"):
            self.assertIn(word, done.stdout)
        self.assertEqual((self.folder / "blob.vdb").read_bytes()[:4], b" BDV")

    def test_a_grid_goes_into_df3_as_it_is(self):
        path = self.folder / "grid.df3"
        found = self.json("bake", "voxel_grid", path)
        result = found
        self.assertEqual((result["size"], result["is_copy"]), ([4, 3, 5], True))
        self.assertEqual(result["extinction_of_density_1_per_m"], 6.0)
        data = path.read_bytes()
        size = struct.unpack(">3H", data[:6])
        codes = struct.unpack(f">{(len(data) - 6) // 4}I", data[6:])
        self.assertEqual((size, len(codes)), ((6, 5, 7), 6 * 5 * 7))
        node = lambda i, j, k: codes[((k + 1) * 5 + j + 1) * 6 + i + 1] / (2**32 - 1)
        self.assertEqual((node(0, 0, 0), node(-1, 0, 0), node(0, 2, 4)), (1.0, 0.0, 1.0))
        self.assertAlmostEqual(node(2, 0, 0), 0.2, delta=1e-7)  # a float32 in the grid

    def test_a_baked_file_is_the_medium_again(self):
        expected = self.transmittance("block", GRID)
        column = sum(node(3, 3, k) for k in range(5)) * 0.75 * 0.8
        middle = 4 * 11 + 5  # the pixel at (1, 2), halfway between rows of nodes
        below = sum(node(3, 2, k) for k in range(5)) * 0.75 * 0.8
        self.assertAlmostEqual(expected[middle], math.exp(-0.5 * (column + below)), delta=1e-6)
        for file in ("block.df3", "block.vdb"):
            entry = self.baked_entry(file).replace("}", ", albedo: [0, 0, 0]}")
            found = self.transmittance("again", entry)
            self.assert_close(found, expected, 1e-7)  # codes of 2^-32, densities of 2^-24

    def test_a_df3_keeps_its_shape(self):
        """Voxels are cubes of 0.5 m with `longest_side_m`; `size_m` makes the block a cube."""
        path = self.folder / "cloud.df3"
        codes = [round(value * (2**32 - 1)) for value in VALUES]
        path.write_bytes(struct.pack(">3H", 7, 6, 5) + struct.pack(f">{len(codes)}I", *codes))
        depth = 0.5 * (sum(node(3, 3, k) for k in range(5)) + sum(node(3, 2, k) for k in range(5)))
        for size, voxel_m in (("longest_side_m: 3.5", 0.5), ("size_m: [3.5, 3.5, 3.5]", 0.7)):
            found = self.transmittance("shape", f"volume: {{file: cloud.df3, center_m: [1, 2, 0], "
                                       f"{size}, extinction_per_m: 1, albedo: [0, 0, 0]}}")
            self.assertAlmostEqual(found[4 * 11 + 5], math.exp(-depth * voxel_m), delta=1e-6)

    def turned(self):
        """Returns the scene entry of the block turned on its side, where node (i, j, k) is at (i,
        k, -j), and its transmittance by engine exact. The block has three different sides."""
        entry = self.baked_entry("block.vdb").replace(
            "}", ", up: z, origin_m: [0, 2, 2.5], albedo: [0, 0, 0]}")
        return entry, self.transmittance("turned", entry)

    def test_engines_see_a_turned_volume_in_one_place(self):
        entry, expected = self.turned()
        # the pixel at (1, 2) sees node i = 3, k = 4/3 of 0.75 m each
        low, high = (sum(node(3, j, k) for j in range(6)) for k in (1, 2))
        self.assertAlmostEqual(expected[4 * 11 + 5],
                               math.exp(-0.5 * 0.8 * (2 / 3 * low + 1 / 3 * high)), delta=1e-6)
        self.assert_close(self.transmittance("turned", entry, "march"), expected, 1e-5)

    @night.of_the_night
    def test_other_engines_see_it_there_too(self):
        entry, expected = self.turned()
        # A neighbouring node would differ by 1e-2. Float engines: 1.2e-7 and 4e-6 were measured.
        # POV-Ray sums steps: 2.4e-5.
        for engine, delta in (("tracer", 1e-6), ("cycles", 4e-5), ("povray", 2e-4)):
            with self.subTest(engine):
                self.assert_close(self.transmittance("turned", entry, engine), expected, delta)

    @unittest.skipUnless(shutil.which("povray"), "POV-Ray is not installed")
    def test_the_cost_of_baking_stands_beside_the_frame(self):
        request = ("validate", "gaussian_blob", "-e", "exact", "-e", "povray", "--size", "16x9",
                   "--no-charts", "-q", "-o", self.folder)
        found = self.json(*request)
        bakes = {frame["engine"]: frame["bake"]
                 for frame in found["scenes"][0]["frames"]}
        self.assertIsNone(bakes["exact"])
        self.assertEqual(bakes["povray"]["grid"], "64 x 64 x 64 nodes")
        self.assertGreater(bakes["povray"]["transmittance_max"], 1e-5)
        self.assertLess(bakes["povray"]["transmittance_max"], 1e-2)
        # from the store
        self.assertIn("of 64 x 64 x 64 nodes: errors: transmittance up to",
                      self.neph(*request).stdout)

    def test_wrong_requests_say_the_way_out(self):
        out = self.folder / "out.vdb"
        for arguments, code, words in (
            (("gaussian_blob", "blob.raw"), 64, ".vdb"),
            (("gaussian_blob", "--medium", "2", out), 64, "1..1"),
            (("gaussian_blob", "--resolution", "1", out), 64, "2..1024"),
            (("gaussian_blob", "--resolution", "1024", out), 65, "MiB"),
            (("gaussian_blob", self.folder / "no_folder" / "x.vdb"), 74, "no_folder"),
            (("no_such_scene", out), 66, "neph scenes"),
        ):
            self.neph("bake", *arguments, code=code, said=words)
        self.assertEqual(list(self.folder.iterdir()), [])

    def test_neph_vdb_is_found_beside_neph_and_missed_in_words(self):
        copied = self.folder / "neph"
        shutil.copy(NEPH, copied)
        shutil.copy(NEPH.with_name("neph-vdb"), self.folder / "neph-vdb")
        self.neph("bake", "voxel_grid", self.folder / "grid.vdb", program=copied)
        done = self.neph("bake", "voxel_grid", self.folder / "other.vdb",
                         NEPH_VDB="/nowhere/neph-vdb", code=69)
        for words in ("/nowhere/neph-vdb", "copy it"):
            self.assertIn(words, done.stderr)


if __name__ == "__main__":
    unittest.main()
