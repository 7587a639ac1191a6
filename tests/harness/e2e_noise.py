#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""`neph compare --z`: noise or bias between two renders, with variances from layers, from second
moments and from repeats. The statistics are tested in tests/metrics/test_z_test.c."""
import json
import pathlib
import random
import unittest
import xml.etree.ElementTree

import frames
import neph_case

WIDTH, HEIGHT, SAMPLES = 40, 32, 16
PIXELS = WIDTH * HEIGHT


def light(i):
    """Radiance of a pixel: objects below a sky without noise."""
    x, y = i % WIDTH, i // WIDTH
    return 0.0 if y < 4 else 0.5 + x / WIDTH


class Noise(neph_case.NephCase):
    def means(self, seed, bias=lambda i: 1.0):
        """(mean, mean square) of the samples of each pixel: exponential, which is skewed."""
        draw = random.Random(seed)
        samples = [[light(i) * bias(i) * draw.expovariate(1) if light(i) else 1.0
                    for _ in range(SAMPLES)] for i in range(PIXELS)]
        return ([sum(values) / SAMPLES for values in samples],
                [sum(value * value for value in values) / SAMPLES for values in samples])

    def put_exr(self, name, **channels):
        path = self.folder / name
        path.parent.mkdir(exist_ok=True)
        path.write_bytes(frames.exr_bytes(WIDTH, HEIGHT, {key.replace("_of_", "."): values
                                                          for key, values in channels.items()}))
        return path

    def layered(self, name, seed, bias=lambda i: 1.0, tint=1.0):
        """A render with its variances. `tint`: factor of blue."""
        mean, square = self.means(seed, bias)
        variance = [max(0.0, s - m * m) / (SAMPLES - 1) for m, s in zip(mean, square)]
        blue = [tint * value for value in mean]
        return self.put_exr(name, R=mean, G=mean, B=blue, variance_of_R=variance,
                            variance_of_G=variance,
                            variance_of_B=[tint ** 2 * v for v in variance])

    def repeats(self, folder, seeds, bias=lambda i: 1.0):
        for seed in seeds:
            mean, _ = self.means(seed, bias)
            self.put_exr(f"{folder}/seed_{seed}.exr", Y=mean)
        return self.folder / folder

    def test_variance_layers(self):
        old, new = self.layered("old.exr", 1), self.layered("new.exr", 2)
        done = self.neph("compare", "--z", old, new)
        lines = done.stdout.splitlines()
        self.assertRegex(lines[0], r"^noise: no bias found, p = [\d.]+; a bias of [\d.]+ % in the "
                                   r"mean, of [\d.]+ % of the mean in a tile of 4 px or [\d.]+ % "
                                   r"in a pixel would be found with 80 %$")
        self.assertLessEqual(len(lines), 10)
        found = self.json("compare", "--z", old, new)
        self.assertEqual(found["verdict"], "noise")
        self.assertEqual([plane["plane"] for plane in found["planes"]], ["luminance"])  # grey
        plane = found["planes"][0]
        self.assertEqual(plane["noisy_pixels"], PIXELS - 4 * WIDTH)
        self.assertEqual(set(plane["tests"]), {"mean", "chi_squared", "tile", "pixel", "blob"})
        self.assertEqual(plane["contrary_pixels"], 0)
        # The least bias: 2.05 + 0.84 standard errors, 1.96 of which are half of the interval.
        self.assertAlmostEqual(plane["least_bias"] / ((plane["high"] - plane["low"]) / 2),
                               2.8954 / 1.96, delta=0.01)

    def test_bias_of_the_mean(self):
        old = self.layered("old.exr", 1)
        bright = self.layered("bright.exr", 2, lambda i: 1.06)
        junit, maps = self.folder / "junit.xml", self.folder / "maps"
        done = self.neph("compare", "--z", old, bright, "-q", "--junit", junit, "--maps", maps,
                         code=1, said="the test is biased against the reference")
        self.assertRegex(done.stdout, r"^bias: more than noise, p = \S+: luminance of the test: "
                                      r"its mean is \S+ % higher \(95 %: \S+ % to \S+ %\)\n$")
        self.assertIsNotNone(xml.etree.ElementTree.parse(junit).find(".//failure"))
        width, height, channels, _ = frames.read_exr(maps / "z.exr")
        self.assertEqual((width, height, list(channels)), (WIDTH, HEIGHT, ["Y"]))
        self.assertTrue((maps / "z.png").exists())

    def test_bias_of_a_place_and_of_a_colour(self):
        old = self.layered("old.exr", 1)
        spot = self.layered("spot.exr", 2, lambda i: 2 if 8 <= i % WIDTH < 14 and
                            8 <= i // WIDTH < 14 else 1)
        done = self.neph("compare", "--z", old, spot, code=1, said="biased")
        self.assertRegex(done.stdout, "^bias: more than noise")
        blue = self.layered("blue.exr", 3, tint=1.2)
        found = self.json("compare", "--z", old, blue, code=1)
        self.assertEqual(len(found["planes"]), 4)
        self.assertLess(found["planes"][3]["tests"]["mean"]["adjusted_p"], 0.05)
        self.assertGreater(found["planes"][1]["tests"]["mean"]["adjusted_p"], 0.05)

    def test_constant_pixels_must_agree(self):
        old = self.layered("old.exr", 1)
        width, height, channels, _ = frames.read_exr(self.layered("new.exr", 2))
        for name in "RGB":
            channels[name] = [1.01] * 20 + list(channels[name][20:])
        path = self.folder / "sky.exr"
        path.write_bytes(frames.exr_bytes(width, height, channels))
        done = self.neph("compare", "--z", old, path, code=1, said="biased")
        self.assertIn("bias: 20 pixels that have no noise in either render differ", done.stdout)

    def test_repeats(self):
        old, new = self.repeats("old", range(10, 13)), self.repeats("new", (20, 25, 27, 31))
        found = self.json("compare", "--z", "-r", old, new)
        self.assertEqual(found["verdict"], "noise")
        self.assertEqual(found["test"], {"files": 4, "source": "repeats", "doubt": None})
        bright = self.repeats("bright", (41, 42, 43), lambda i: 1.05)
        self.neph("compare", "--z", "-r", old, bright, code=1, said="biased")
        # Layers on one side, repeats on the other.
        found = self.json("compare", "--z", old, self.layered("layered.exr", 2))
        self.assertEqual(found["verdict"], "noise")
        self.put_exr("old/seed_99.exr", Y=self.means(10)[0])
        self.neph("compare", "--z", old, new, code=65, said="repeats need different seeds")

    def test_second_moments(self):
        files = []
        for seed, bias in (1, 1.0), (2, 1.0), (3, 1.06):
            mean, square = self.means(seed, lambda i, bias=bias: bias)
            named = {f"path_of_{c}": mean for c in "XYZ"} | {f"m2_path_of_{c}": square
                                                             for c in "XYZ"}
            files.append(self.put_exr(f"{seed}.exr", R=mean, G=mean, B=mean, **named))
        self.neph("compare", "--z", *files[:2], code=2, said="name them by --samples N")
        found = self.json("compare", "--z", *files[:2], "--samples", SAMPLES)
        self.assertEqual((found["verdict"], found["test"]["source"]), ("noise", "second moments"))
        same = self.json("compare", "--z", self.layered("a.exr", 1), self.layered("b.exr", 2))
        for key in "bias", "low", "least_bias":
            self.assertAlmostEqual(found["planes"][0][key], same["planes"][0][key], delta=1e-5)
        self.neph("compare", "--z", files[0], files[2], "--samples", SAMPLES, code=1, said="biased")

    def test_refusals(self):
        old = self.layered("old.exr", 1)
        plain = self.put_exr("plain.exr", Y=self.means(2)[0])
        negative = self.put_exr("negative.exr", Y=self.means(2)[0],
                                variance_of_Y=[-1.0] * PIXELS)
        png = self.folder / "image.png"
        png.write_bytes(frames.png_bytes(WIDTH, HEIGHT, bytes(3 * PIXELS)))
        for words, code, said in (
                ((old, old), 65, "both renders have the same random numbers"),
                ((old, plain), 2, "the noise of '"),
                ((old, plain, "--variance", "noise"), 2, "has no channels noise.R G B"),
                ((old, negative), 1, "are negative, 0 allowed; first 'variance.Y'"),
                ((old, negative, "--negative-ok"), 1, "the variance layer at pixel (0, 0) is -1"),
                ((png, old), 65, "is an image for a display"),
                ((old, old, "--mask", "sky"), 64, "--z takes no --mask"),
                ((old, old, "--samples", "1"), 64, "samples"),
                (("-r", old, plain, negative), 64, "--z compares one test with the reference")):
            self.neph("compare", "--z", *words, code=code, said=said)
        self.neph("flicker", "--z", old, old, code=64, said="use `neph compare --z`")


DROPLETS = """
name: droplets
title: a thin cloud of droplets, 30 degrees beside the sun
description: a forward peak thousands of times as bright as an even one
camera: {position_m: [0, 0, 0], look_at_m: [0, 100, -60], vertical_fov_deg: 30}
sun: {direction: [0, 0.866, 0.5], irradiance_w_per_m2: [3, 3, 3]}
scattering: multiple
media:
  - homogeneous:
      extinction_per_m: 0.03
      albedo: [1, 1, 1]
      PHASE
      bounds: {min_m: [-1.0e+4, 10, -1.0e+4], max_m: [1.0e+4, 30, 1.0e+4]}
"""
# Directions around the sun are drawn by other phase functions than this.
PEAK = "phase: henyey_greenstein\n      asymmetry_g: 0.98"
TABLE = f"""phase: table
      phase_table: {neph_case.ROOT}/scenes/catalog/fogbow_droplets.csv"""
EVEN = "phase: henyey_greenstein\n      asymmetry_g: 0.5"
DOUBT = "error bar not trusted: a few paths make most of it"


class Doubt(neph_case.NephCase):
    """Frames of both path tracers say when their error bar is not to be trusted."""

    def render(self, phase, engine, samples, **expected):
        scene = self.put("droplets.yaml", DROPLETS.replace("PHASE", phase))
        found = self.json("render", scene, "-e", engine, "-s", f"samples={samples}", "--size",
                          "16x9", "--seed", 1, "-q", "-o", self.folder / f"{engine}_{samples}",
                          **expected)
        return found[0]["noise_doubt"], found[0]["exr"]

    def test_frames(self):
        for engine, samples in ("tracer", 1024), ("oracle", 64):
            doubt, path = self.render(PEAK, engine, samples, said=DOUBT)
            self.assertGreater(doubt, 0.1)
            attributes = frames.read_exr(pathlib.Path(path))[3]
            self.assertEqual(float(attributes["neph.noise.doubt"]), doubt)
            self.assertGreater(float(attributes["neph.noise.doubtful_pixels"]), 0.01)
            for phase in EVEN, TABLE:
                doubt, _ = self.render(phase, engine, 64)
                self.assertLess(doubt, 0.01 if phase == EVEN else 0.1)

    def test_verdicts(self):
        _, one = self.render(PEAK, "tracer", 1024)
        _, other = self.render(PEAK, "oracle", 64)
        done = self.neph("compare", "--z", one, other, "-q", code=None)
        self.assertIn(DOUBT, done.stdout)
        self.assertGreater(self.json("compare", "--z", one, other, code=None)["test"]["doubt"], 0.1)
        out = self.folder / "report"
        done = self.neph("validate", self.folder / "droplets.yaml", "-e", "oracle,tracer", "-s",
                         "oracle:samples=64", "-s", "tracer:samples=1024", "--size", "16x9", "-q",
                         "-o", out, code=None)
        self.assertIn(DOUBT, done.stdout)
        self.assertIn("with an error bar that is not to be trusted of", done.stdout)
        frame = json.loads(next(out.rglob("data.json")).read_text())["scenes"][0]["frames"][0]
        self.assertIn(DOUBT, frame["noise"]["warning"])


if __name__ == "__main__":
    unittest.main()
