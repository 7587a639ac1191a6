#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Colour spaces of an OpenColorIO config: the same picture in several of them is the same."""
import os
import shutil
import subprocess
import unittest

import frames
import neph_case

WIDTH, HEIGHT = 16, 8
# ACES2065-1 to linear Rec.709, "Linear Rec.709 (sRGB)" of the ACES configs of OpenColorIO.
TO_REC709 = (2.52168618674388, -1.13413098823972, -0.387555198504164, 0,
             -0.276479914229922, 1.37271908766826, -0.096239173438334, 0,
             -0.0153780649660342, -0.152975335867399, 1.16835340083343, 0, 0, 0, 0, 1)
# The primaries of a camera, as linear Rec.709.
CAMERA = (0.7, 0.2, 0.1, 0, 0.15, 0.8, 0.05, 0, 0.05, 0.15, 0.8, 0, 0, 0, 0, 1)
FROM_LIGHT = f"!<MatrixTransform> {{matrix: {list(TO_REC709)}, direction: inverse}}"

CONFIG = f"""ocio_profile_version: 2
search_path: luts
environment: {{SHOT: bend}}
roles: {{aces_interchange: aces, scene_linear: aces, plate: film}}
file_rules:
  - !<Rule> {{name: Default, colorspace: film}}
displays: {{screen: [!<View> {{name: raw, colorspace: light}}]}}
colorspaces:
  - !<ColorSpace> {{name: aces}}
  - !<ColorSpace>
    name: light
    from_scene_reference: !<MatrixTransform> {{matrix: {list(TO_REC709)}}}
  - !<ColorSpace>
    name: Camera Linear
    aliases: [cam_lin, cam]
    to_scene_reference: !<GroupTransform>
      children:
        - !<MatrixTransform> {{matrix: {list(CAMERA)}}}
        - {FROM_LIGHT}
  - !<ColorSpace>
    name: film
    to_scene_reference: !<GroupTransform>
      children:
        - !<LogAffineTransform> {{base: 10, log_side_slope: 0.25, log_side_offset: 0.6,
            lin_side_slope: 0.9, lin_side_offset: 0.05, direction: inverse}}
        - !<MatrixTransform> {{matrix: {list(CAMERA)}}}
        - {FROM_LIGHT}
  - !<ColorSpace>
    name: gamma
    to_scene_reference: !<GroupTransform>
      children:
        - !<ExponentTransform> {{value: [2.2, 2.2, 2.2, 1]}}
        - {FROM_LIGHT}
  - !<ColorSpace>
    name: bent
    to_scene_reference: !<GroupTransform>
      children:
        - !<FileTransform> {{src: "${{SHOT}}.cube", interpolation: linear}}
        - {FROM_LIGHT}
  - !<ColorSpace>
    name: lost
    to_scene_reference: !<FileTransform> {{src: nowhere.cube, interpolation: linear}}
  - !<ColorSpace>
    name: torn
    to_scene_reference: !<FileTransform> {{src: torn.cube, interpolation: linear}}
  - !<ColorSpace>
    name: steep
    to_scene_reference: !<GroupTransform>
      children:
        - !<MatrixTransform> {{matrix: [1.e30, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]}}
        - !<ExponentTransform> {{value: [2, 2, 2, 1]}}
  - !<ColorSpace> {{name: numbers, isdata: true}}
  - !<ColorSpace>
    name: piped
    to_scene_reference: !<FileTransform> {{src: pipe.cube, interpolation: linear}}
  - !<ColorSpace>
    name: endless
    to_scene_reference: !<FileTransform> {{src: /dev/zero, interpolation: linear}}
  - !<ColorSpace>
    name: hen
    to_scene_reference: !<GroupTransform>
      children: [!<ColorSpaceTransform> {{src: egg, dst: aces}}]
  - !<ColorSpace>
    name: egg
    from_scene_reference: !<LookTransform> {{src: aces, dst: aces, looks: warm}}
looks:
  - !<Look>
    name: warm
    process_space: film
    transform: !<ColorSpaceTransform> {{src: hen, dst: light}}
"""
BEND = 0.0, 0.125, 1.0  # the table: codes 0, 1/2 and 1
# Version 1, whose reference is linear Rec.709, without a role for ACES.
OLD_CONFIG = """ocio_profile_version: 1
roles: {default: light}
displays: {screen: [!<View> {name: raw, colorspace: light}]}
colorspaces:
  - !<ColorSpace> {name: light}
  - !<ColorSpace>
    name: stops
    to_reference: !<LogTransform> {base: 2, direction: inverse}
"""

# Roundings are relative, of 2^-24: of a code before its curve (times code / slope * ln 10, at most
# 8), in the argument of the curve (at most 7), in the curve, in a row of the matrix and its
# coefficients (at most 8), and of the expected value.
TOLERANCE = 32 * 2.0 ** -24


def apply(matrix, pixel):
    return [sum(matrix[4 * row + c] * pixel[c] for c in range(3)) for row in range(3)]


def bend(code):
    return BEND[1] * 2 * code if code < 0.5 else BEND[1] + (BEND[2] - BEND[1]) * (2 * code - 1)


# From codes to linear Rec.709, in double precision.
SPACES = {
    "Camera Linear": lambda pixel: apply(CAMERA, pixel),
    "film": lambda pixel: apply(CAMERA, [(10 ** ((c - 0.6) / 0.25) - 0.05) / 0.9 for c in pixel]),
    "gamma": lambda pixel: [c ** 2.2 for c in pixel],
    "bent": lambda pixel: [bend(c) for c in pixel],
}


def has_oiiotool():
    return shutil.which("oiiotool") is not None


class Spaces(neph_case.NephCase):
    # All codes have a positive colour in each of the spaces.
    codes = [(0.3 + 0.6 * i / 127, 0.9 - 0.5 * i / 127, 0.35 + 0.04 * (i % 13))
             for i in range(WIDTH * HEIGHT)]

    def setUp(self):
        super().setUp()
        self.config = self.put("studio.ocio", CONFIG)
        self.put("luts/bend.cube", "LUT_1D_SIZE 3\n" + "".join(3 * f"{v} " + "\n" for v in BEND))
        self.put("luts/torn.cube", "LUT_1D_SIZE 2\n0 0 0\nnan 1 1\n")
        self.put("luts/evil.cube", "LUT_1D_SIZE 2\n0 0 0\n0 0 0\n")

    def write(self, name, pixels, space=None, attribute="oiio:ColorSpace", further=()):
        path = self.folder / name
        path.parent.mkdir(exist_ok=True)
        path.write_bytes(frames.exr_bytes(
            WIDTH, HEIGHT, dict(zip("RGB", zip(*pixels))),
            [*further, *([(attribute, "string", space.encode())] if space else [])]))
        return path

    def assert_same(self, reference, test, largest, *words, **options):
        found = self.json("compare", reference, test, "-m", "max_abs", "--convert", *words,
                          **options)
        self.assertLess(found["measurements"][0]["value"], TOLERANCE * largest, (test, words))
        return found

    def test_spaces_are_linear_rec709(self):
        for space, decode in SPACES.items():
            expected = [decode(pixel) for pixel in self.codes]
            largest = max(map(max, expected))
            plain = self.write("plain.exr", expected)
            test = self.write("test.exr", self.codes, space)
            for words in ((), ("--space", "light")):
                found = self.assert_same(plain, test, largest, "--ocio", self.config, *words)
                self.assertEqual(found["converted"],
                                 {"reference": None, "test": f"{space} of studio.ocio"})
            self.neph("compare", plain, test, code=65,
                      said=(f"of the other image {space.lower()}", "--convert"))
            self.neph("compare", plain, test, "--convert", code=65,
                      said=(f"'{space.lower()}' cannot be converted", "--ocio FILE adds"))

    def test_names_aliases_and_roles_in_any_attribute(self):
        plain = self.write("plain.exr", [SPACES["film"](pixel) for pixel in self.codes])
        film = "film", "FILM", "plate"
        camera = "Camera Linear", "camera linear", "CAM_LIN", "cam"
        linear = self.write("linear.exr", [SPACES["Camera Linear"](p) for p in self.codes])
        for reference, largest, names in ((plain, 18, film), (linear, 1, camera)):
            for i, name in enumerate(names):
                test = self.write("test.exr", self.codes, name,
                                  ("oiio:ColorSpace", "colorInteropID")[i % 2])
                self.assert_same(test, reference, largest, "--ocio", self.config)
        # Two names of one space, chromaticities beside a name, and a name that says nothing
        for further in (("colorInteropID", "string", b"CAM"),
                        ("chromaticities", "chromaticities", bytes(32)),
                        ("colorInteropID", "string", b"unknown")):
            test = self.write("test.exr", self.codes, "cam_lin", further=[further])
            self.assert_same(linear, test, 1, "--ocio", self.config)
        # Names that the config lacks: as without it
        rec2020 = self.write("rec2020.exr", self.codes, "lin_rec2020_scene")
        found = [self.json("compare", linear, rec2020, "--convert", *words)
                 for words in ((), ("--ocio", self.config))]
        self.assertEqual(found[0], found[1])

    def test_old_configs_name_linear_rec709(self):
        old = self.put("old.ocio", OLD_CONFIG)
        plain = self.write("plain.exr", [[2 ** c for c in pixel] for pixel in self.codes])
        test = self.write("test.exr", self.codes, "stops")
        self.assert_same(plain, test, 2, "--ocio", old, "--space", "light")
        words = "compare", plain, test, "--convert", "--ocio"
        self.check_refusals((65, ("no role aces_interchange", "--space; it has light"), [old]),
                            (65, ("no colour space 'lihgt'", "it has light, stops"),
                             [old, "--space", "lihgt"]), before=words)

    def test_the_shell_changes_nothing(self):
        plain = self.write("plain.exr", [SPACES["bent"](pixel) for pixel in self.codes])
        test = self.write("test.exr", self.codes, "bent")
        self.assert_same(plain, test, 1, "--ocio", self.config, SHOT="evil", OCIO="/nonexistent",
                         OCIO_OPTIMIZATION_FLAGS="0", OCIO_INACTIVE_COLORSPACES="bent")

    def test_other_verbs(self):
        for side in "ab":
            for i in range(20):
                pixels = [[v + 1e-3 * (i % 4) for v in pixel] for pixel in self.codes]
                space, pixels = ("film", pixels) if side == "a" else (
                    None, [SPACES["film"](pixel) for pixel in pixels])
                self.write(f"{side}/f.{i:04d}.exr", pixels, space)
        a, b, ocio = self.folder / "a", self.folder / "b", ("--ocio", self.config)
        done = self.neph("flicker", a, b, "--convert", *ocio)
        self.assertIn("converted to linear Rec.709", done.stdout)
        self.neph("flicker", a, b, *ocio, code=64, said="--ocio has colour spaces for --convert")
        self.neph("compare", a, b, "--convert", "--space", "x", code=64, said="--ocio FILE")
        self.neph("compare", "--z", a, b, "--convert", *ocio, code=64, said="no --convert")
        self.neph("view", a, b, "--convert", *ocio, "-q", "-o", self.folder / "page")
        self.neph("view", a, b, *ocio, "-q", "-o", self.folder / "page2", code=65, said="film")
        runs = [self.write(f"runs/{i}.exr", [[v + 1e-3 * i for v in p] for p in self.codes], "film")
                for i in range(6)]
        self.neph("limits", *runs, "--convert", *ocio, "-m", "max_abs", "-q", "-o", self.folder)
        beyond = self.write("beyond.exr", [SPACES["film"]([v + 0.1 for v in pixel])
                                           for pixel in self.codes])
        for test, code in ((runs[3], 0), (beyond, 1)):
            self.neph("compare", runs[0], test, "--convert", *ocio, "--limits",
                      self.folder / "limits.json", code=code)
        self.check_refusals((64, "--ocio has colour spaces", ["a.exr", *ocio]),
                            (64, "--convert is for frames", ["a.json", "--convert"]),
                            before=["limits"])
        one = self.json("compare", b, a, "--convert", *ocio, "-j1")
        self.assertEqual(one, self.json("compare", b, a, "--convert", *ocio, "-j4"))

    def test_what_cannot_be_converted(self):
        plain = self.write("plain.exr", self.codes)
        cases = (("camera lineal", ("has no colour space 'camera lineal'", "hint: the most similar "
                                    "names are Camera Linear, ")),
                 ("lost", ("studio.ocio", "nowhere.cube")), ("torn", "has a table with NaN"),
                 ("steep", "gives no finite number for the pixel (0, 0)"),
                 ("numbers", "is data, no colour"),
                 ("piped", ("pipe.cube", "a pipe is not a regular file")),
                 ("endless", "'/dev/zero': a device is not a regular"),
                 ("hen", "'hen' of the OpenColorIO config is defined by itself"))
        os.mkfifo(self.folder / "luts/pipe.cube")
        bright = [[v + 1 for v in pixel] for pixel in self.codes]
        for i, (space, said) in enumerate(cases):
            sides = [plain, self.write("test.exr", bright, space)][::1 - 2 * (i % 2)]
            self.check_refusals((65, said, sides), before=(
                "compare", "--convert", "--ocio", self.config))
        two = self.write("test.exr", bright, "film",
                         further=[("colorInteropID", "string", b"cam")])
        self.neph("compare", plain, two, "--convert", "--ocio", self.config, code=65,
                  said="names two colour spaces: 'cam' and 'film'")

    def test_configs_that_are_none(self):
        plain = self.write("plain.exr", self.codes)
        huge, pipe = self.folder / "huge.ocio", self.folder / "pipe.ocio"
        with open(huge, "wb") as file:
            file.truncate(17 << 20)
        os.mkfifo(pipe)
        lists = self.put("lists.ocio", "a: " + 100000 * "[")
        self.check_refusals(
            (66, "missing.ocio", [self.folder / "missing.ocio"]),
            (65, "more than the 16 MiB", [huge]), (65, "pipe.ocio", [pipe]),
            (74, str(self.folder), [self.folder]),
            (65, "OpenColorIO, of", [lists]),
            (65, "OpenColorIO, of", [self.put("text.ocio", "- no config\n")]),
            (65, "OpenColorIO, of", [self.put("cut.ocio", CONFIG[:len(CONFIG) // 2])]),
            (65, "OpenColorIO, of", [self.put("new.ocio", CONFIG.replace(": 2", ": 99", 1))]),
            before=("compare", plain, plain, "--convert", "--ocio"))

    @unittest.skipUnless(has_oiiotool(), "no oiiotool in PATH: its colours are not compared")
    def test_oiiotool_converts_to_the_same(self):
        for space in SPACES:
            test = self.write("test.exr", self.codes, space)
            told = self.folder / "oiiotool.exr"
            subprocess.run(["oiiotool", "--colorconfig", self.config, test, "--colorconvert", space,
                            "light", "--eraseattrib", ".*olor.*", "-d", "float", "-o", told],
                           check=True, capture_output=True)
            self.assert_same(told, test, 18 if space == "film" else 1, "--ocio", self.config)


if __name__ == "__main__":
    unittest.main()
