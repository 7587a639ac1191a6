#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""`radius_band_um`: a cloud whose droplets differ from voxel to voxel, as media with a phase
function each. Single scattering of layers has a closed form, and tables of one phase function are
the medium without bands."""
import math
import unittest

from frames import read_exr
from neph_case import NephCase

SCENE = """title: layers of droplets
camera: {position_m: [-900, 1800, 700], look_at_m: [0, 0, 0], orthographic_height_m: 10}
sun: {direction: [0.3, 0.8, -0.5], irradiance_w_per_m2: [2, 3, 4]}
scattering: SCATTERING
media:
"""
MEDIUM = """  - volume: {file: cloud.dat, radius_grid: reff, extinction_per_m: 1, repeat: [0, 1, 0],
             albedo: [1, 0.9, 0.8], phase: table, phase_table: TABLE.txtBAND}
"""
# 1/km and um of layers of 100 m, from the ground up: below, at, between and above the peaks.
LAYERS = ((4, 3), (5, 5), (2, 6.5), (7, 10), (3, 13), (6, 40))
PEAKS = (5, 10, 16)
BANDS = ([5, 5, 10], [5, 10, 16], [10, 16, 16])
SLOPES = (-0.5, 0.0, 0.8)  # phase functions (1 + slope cos) / 4 pi, linear in 1 - cos as a table is


def interpolate(radius):
    """The phase functions' slope at a radius."""
    below = [i for i, peak in enumerate(PEAKS) if peak <= radius]
    i = min(below[-1] if below else 0, len(PEAKS) - 2)
    part = min(1, max(0, (radius - PEAKS[i]) / (PEAKS[i + 1] - PEAKS[i])))
    return (1 - part) * SLOPES[i] + part * SLOPES[i + 1]


def unit(*vector):
    length = math.hypot(*vector)
    return [v / length for v in vector]


def layers_radiance():
    """Single scattering, per unit of irradiance and albedo."""
    view, sun = unit(900, -1800, -700), unit(0.3, 0.8, -0.5)
    cosine = sum(a * b for a, b in zip(view, sun))
    mu, mu0 = -view[1], sun[1]
    depth, radiance = 0.0, 0.0
    for extinction, radius in reversed(LAYERS):
        phase = (1 + interpolate(radius) * cosine) / (4 * math.pi)
        thickness = 0.1 * extinction * (1 / mu + 1 / mu0)
        radiance += phase * mu0 / (mu + mu0) * math.exp(-depth) * -math.expm1(-thickness)
        depth += thickness
    return radiance


class RadiusBands(NephCase):
    in_folder = True

    def setUp(self):
        super().setUp()
        heights = " ".join(f"{0.1 * i:.1f}" for i in range(len(LAYERS) + 1))
        self.put("cloud.dat", f"1 1 {len(LAYERS)} 2\n0.1 0.1 {heights}\n" +
                 "".join(f"1 1 {i + 1} {ext} {radius}\n"
                         for i, (ext, radius) in enumerate(LAYERS)))
        for i, slope in enumerate(SLOPES):
            self.put(f"phase_{i}.txt", f"0 {1 + slope:.17g}\n180 {1 - slope:.17g}\n")

    def scene(self, name, media, scattering="single"):
        self.put(name + ".yaml", SCENE.replace("SCATTERING", scattering) + "".join(
            MEDIUM.replace("TABLE", table).replace(
                "BAND", f",\n             radius_band_um: {band}" if band else "").replace(
                    "" if band else "radius_grid: reff, ", "")
            for table, band in media))
        return name + ".yaml"

    def render(self, scene, engine, *further):
        """The first pixel."""
        out = self.folder / f"{scene}.{engine}"
        self.neph("render", scene, "-e", engine, "--size", "8x8", "-o", out, *further)
        [path] = out.rglob("*.exr")
        _, _, frame, _ = read_exr(path)
        return [frame[channel][0] for channel in "RGB"]

    def assert_close(self, found, expected, tolerance):
        for one, other in zip(found, expected):
            self.assertAlmostEqual(one / other, 1.0, delta=tolerance)

    def test_layers_have_interpolated_phase_functions(self):
        scene = self.scene("banded", [(f"phase_{i}", band) for i, band in enumerate(BANDS)])
        expected = [light * albedo * layers_radiance()
                    for light, albedo in zip((2, 3, 4), (1, 0.9, 0.8))]
        # Voxels, their weighted parts and pixels in float.
        self.assert_close(self.render(scene, "exact"), expected, 1e-6)
        self.assert_close(self.render(scene, "march"), expected, 5e-3)  # its steps
        notes = [medium["note"] for medium in self.json("scenes", scene)["densities"]["media"]]
        self.assertIn("radius band 5, 10, 16 um", notes[1])
        self.assertAlmostEqual(sum(float(note.split("it has ")[1].split()[0]) for note in notes),
                               100, delta=1e-3)

    def test_bands_of_one_phase_function_are_the_whole(self):
        for scattering, engine, tolerance in (("single", "exact", 1e-6), ("single", "march", 1e-5)):
            one, three = (self.scene(name, media, scattering) for name, media in
                          (("one", [("phase_2", None)]),
                           ("three", [("phase_2", band) for band in BANDS])))
            self.assert_close(self.render(three, engine), self.render(one, engine), tolerance)

    def test_refusals(self):
        for band, said in (([10, 5, 16], "10, 5, 16 um do not ascend"),
                           ([5, 16, 10], "5, 16, 10 um do not ascend"),
                           ([5, 5, 5], "do not ascend")):
            self.neph("scenes", self.scene("bad", [("phase_0", band)]), code=65, silent=True,
                      said=("volume.radius_band_um", said))
        self.put("bad.yaml", (self.folder / "bad.yaml").read_text().replace("radius_grid: reff, ",
                                                                           ""))
        self.neph("scenes", "bad.yaml", code=65, silent=True,
                  said="radius_band_um: it needs the key radius_grid")


if __name__ == "__main__":
    unittest.main()
