#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""`neph view`: floats on the page are bit-exact, sets of different size are refused, and the page
works in a browser (check_view.mjs)."""
import array
import base64
import json
import math
import random
import shutil
import unittest
import zlib

import frames
import neph_case
import night
import pages

PAGE = pages.PAGE
WIDTH, HEIGHT, COUNT = 24, 16, 20
PIXELS = WIDTH * HEIGHT
# Positions that are read from the page, and the values planted there: floats that a shorter text
# would change.
PLANTED = {(0, 0): 1e-7, (23, 15): 65504.0, (5, 3): 0.1, (11, 7): 1e-45, (2, 9): 16777217.0 / 3,
           (13, 2): 0.5, (20, 12): 0.0031308}


# Swaps red and blue, then a root: no table of curves could do it.
OCIO = """ocio_profile_version: 2
roles: {default: linear, scene_linear: linear}
file_rules:
  - !<Rule> {name: Default, colorspace: default}
displays:
  screen:
    - !<View> {name: swapped, colorspace: swapped}
colorspaces:
  - !<ColorSpace> {name: linear}
  - !<ColorSpace>
    name: swapped
    from_scene_reference: !<GroupTransform>
      children:
        - !<MatrixTransform> {matrix: [0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 0, 0, 0, 0, 1]}
        - !<ExponentTransform> {value: [2, 2, 2, 1], direction: inverse}
"""


def single(value):
    """The value as a float of 32 bits."""
    return array.array("f", [value])[0]


def picture(seed, frame, planted):
    """R G B of noise on a gradient that changes with the frame, and the planted values in R."""
    random.seed(f"{seed} {frame}")
    rgb = {name: [0.2 + 0.02 * (i % WIDTH) + 0.05 * random.random() + 0.02 * ((frame + i) % 4 == 0)
                  for i in range(PIXELS)] for name in "RGB"}
    for (x, y), value in planted.items():
        rgb["R"][y * WIDTH + x] = value
    return rgb


def layers(seed, frame, planted):
    depth = [math.inf if i < 3 * WIDTH else 10.0 + i for i in range(PIXELS)]
    shares = {f"transmittance.{c}": [math.exp(-0.001 * i - k) for i in range(PIXELS)]
              for k, c in enumerate("RGB")}
    return {**picture(seed, frame, planted), **shares, "Z": depth}


def write(path, channels):
    path.parent.mkdir(exist_ok=True)
    path.write_bytes(frames.exr_bytes(WIDTH, HEIGHT, channels))


def opened(page, key):
    """The floats of a file of the page, by base/packed.h."""
    text = (page / "frames" / f"{key}.js").read_text()
    name, packed = json.loads(f"[{text.split('(', 1)[1].rsplit(')', 1)[0]}]")
    assert name == key
    data = zlib.decompress(base64.b64decode(packed))
    count = len(data) // 4
    bits, floats = 0, array.array("f")
    words = array.array("I")
    for i in range(count):
        bits = (bits + int.from_bytes(data[i::count], "big")) & 0xffffffff
        words.append(bits)
    floats.frombytes(words.tobytes())
    return floats


class View(neph_case.NephCase):
    words = ("view",)

    def setUp(self):
        pass  # all in the folder of the class

    @classmethod
    def setUpClass(cls):
        cls.folder = neph_case.scratch(cls.addClassCleanup)
        cls.reference = layers("reference", 0, PLANTED)
        write(cls.folder / "reference.exr", cls.reference)
        cls.tests = []
        for frame in range(COUNT):
            planted = {place: value + step for (place, value), step in
                       zip(PLANTED.items(), (0, -9.0, 0.5, 1e-44, 0.5, -0.4, 1.0))}
            cls.tests.append(layers("test", frame, planted))
            write(cls.folder / "test" / f"frame.{frame:04d}.exr", cls.tests[-1])
        cls.page = cls.folder / "page"
        (cls.folder / "config.ocio").write_text(OCIO)
        cls.done = neph_case.run("view", cls.folder / "reference.exr", cls.folder / "test", "-o",
                                 cls.page, "--ocio", cls.folder / "config.ocio")

    def test_every_float_of_the_files_is_in_the_page(self):
        self.assertEqual(self.done.returncode, 0, self.done.stderr)
        self.assertIn(f"2 sets, {COUNT} frames of {WIDTH}x{HEIGHT}", self.done.stdout)
        data = json.loads((self.page / "data.json").read_text())
        self.assertEqual(data["sets"][1]["quantities"], ["radiance", "transmittance", "depth"])
        for key, channels, names in (
                ("0_0_radiance", self.reference, "RGB"),
                ("1_7_radiance", self.tests[7], "RGB"),
                ("1_19_transmittance", self.tests[19], [f"transmittance.{c}" for c in "RGB"]),
                ("1_0_depth", self.tests[0], "Z")):
            wanted = array.array("f", [v for name in names for v in channels[name]])
            self.assertEqual(opened(self.page, key).tobytes(), wanted.tobytes(), key)
        files = [path for path in (self.page / "frames").iterdir()]
        self.assertEqual(data["bytes"], sum(path.stat().st_size for path in files))
        self.assertFalse((self.page / "maps").exists())

    def test_maps_are_those_of_compare(self):
        maps = self.folder / "maps"
        neph_case.run("compare", self.folder / "reference.exr", self.folder / "test", "-m", "flip",
                      "-m", "error", "--maps", maps, "-q", "--csv", self.folder / "x.csv",
                      "--by-position").check_returncode()
        for key, name, channels in (("1_3_map_flip", "flip_radiance_0003", "Y"),
                                    ("1_19_map_relative", "relative_radiance_0019", "RGB")):
            planes = frames.read_exr(maps / f"{name}.exr")[2]
            wanted = b"".join(planes[c].tobytes() for c in channels)
            self.assertEqual(opened(self.page, key).tobytes(), wanted, key)
        data = json.loads((self.page / "data.json").read_text())
        self.assertEqual([(row["name"], row["sets"]) for row in data["overlays"]],
                         [("relative", [1]), ("flip", [1]), ("a4", [1])])

    def refused(self, code, told, *arguments):
        place = self.folder / "refused"
        self.neph(*arguments, "-o", place, code=code, said=told)
        self.assertFalse(place.exists())
        self.assertEqual([path.name for path in self.folder.iterdir()
                          if path.name.startswith(".neph")], [])

    def test_refused_input_leaves_no_files(self):
        reference = self.folder / "reference.exr"
        frames.grey_exr(self.folder / "small.exr", 4, 4, [0.5] * 16)
        write(self.folder / "depth.exr", {"Z": [1.0] * PIXELS})
        (self.folder / "picture.png").write_bytes(
            frames.png_bytes(WIDTH, HEIGHT, [7] * 3 * PIXELS))
        self.refused(66, "there is no file", reference, self.folder / "nobody.exr")
        self.refused(65, "24x16 pixels in", reference, self.folder / "small.exr")
        self.refused(65, "has no radiance: its channels are Z", self.folder / "depth.exr")
        self.refused(65, "is a display image", reference, self.folder / "picture.png")
        self.refused(65, "larger than 0.002 MB", reference, "--page-limit", "0.002")
        self.refused(64, "there is no map 'flop'", reference, reference, "--overlay", "flop")
        self.refused(64, "there is no quantity 'colour'", reference, "--quantity", "colour")
        self.refused(66, "no OpenColorIO config", reference, "--ocio", self.folder / "x.ocio")
        self.refused(65, "has no view 'film'; it has swapped", reference, "--ocio",
                     self.folder / "config.ocio", "--view", "film")
        self.refused(64, "are of a config", reference, "--view", "film")
        # An unknown name is reported before frames are read: this one is no frame.
        self.refused(64, "there is no map 'flop'", self.folder / "picture.png", reference,
                     "--overlay", "flop")
        self.refused(65, "has no view 'film'", self.folder / "depth.exr", "--ocio",
                     self.folder / "config.ocio", "--view", "film")
        self.refused(64, "24 sets", *[reference] * 25)
        mine = self.put("mine/letter").parent
        self.neph(reference, "-o", mine, code=64)
        self.assertEqual([path.name for path in mine.iterdir()], ["letter"])

    def test_a_page_that_cannot_fit_is_refused_by_its_first_frames(self):
        folder = self.folder / "long"
        folder.mkdir()
        for i in range(12):
            write(folder / f"frame.{i:04d}.exr", picture("long", i, {}))
        # The last frame, which is invalid, is not reached.
        (folder / "frame.0011.exr").write_bytes(b"no frame")
        self.refused(65, "larger than 0.02 MB: about 0.0", folder, "--page-limit", "0.02")
        self.refused(65, "frame.0011.exr", folder)

    def test_a_table_with_nan_is_reported(self):
        self.put("torn.cube", "LUT_3D_SIZE 2\n" + "0 1 0\n" * 7 + "nan 0 0\n")
        self.put("torn.ocio", OCIO.replace(
            "!<MatrixTransform> {matrix: [0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 0, 0, 0, 0, 1]}",
            "!<FileTransform> {src: torn.cube, interpolation: best}"))
        page = self.folder / "torn"
        self.neph(self.folder / "reference.exr", "-o", page, "--ocio", self.folder / "torn.ocio",
                  said="has 1 colours that are no numbers")
        self.assertEqual(json.loads((page / "data.json").read_text())["cube"]["not_numbers"], 1)

    def test_display_images_are_decoded(self):
        codes = [(7 * i) % 256 for i in range(3 * PIXELS)]
        (self.folder / "codes.png").write_bytes(frames.png_bytes(WIDTH, HEIGHT, codes))
        page = self.folder / "png"
        told = self.json(self.folder / "codes.png", "-o", page)
        self.assertEqual((told["width_px"], told["sets"], told["frames"]), (WIDTH, 1, 1))
        least = [-math.inf] + json.loads((page / "data.json").read_text())["display_codes"]
        values = opened(page, "0_0_radiance")
        for i in range(PIXELS):  # the display's table gives the codes
            for c in range(3):
                code = max(k for k in range(256) if values[c * PIXELS + i] >= least[k])
                self.assertEqual(code, codes[3 * i + c])

    def expectations(self):
        """Expected values at the planted positions, of both sets, two frames and all quantities."""
        def probe(number, frame, channels, quantity, names, place):
            i = place[1] * WIDTH + place[0]
            return {"set": number, "frame": frame, "quantity": quantity, "x": place[0],
                    "y": place[1], "values": [single(channels[name][i]) for name in names]}
        pixels = [probe(number, 0, channels, "radiance", "RGB", place) for place in PLANTED
                  for number, channels in ((0, self.reference), (1, self.tests[0]))]
        pixels.append(probe(1, 11, self.tests[11], "radiance", "RGB", (17, 4)))
        pixels.append(probe(1, 2, self.tests[2], "transmittance",
                            [f"transmittance.{c}" for c in "RGB"], (4, 14)))
        pixels.append(probe(0, 0, self.reference, "depth", "Z", (9, 9)))
        flip = opened(self.page, "1_3_map_flip")
        a4 = opened(self.page, "1_all_map_a4")
        maps = [{"set": 1, "frame": 3, "map": "flip", "x": 6, "y": 5,
                 "values": [flip[5 * WIDTH + 6]]},
                {"set": 1, "frame": 8, "map": "a4", "x": 6, "y": 5, "values": [a4[5 * WIDTH + 6]]}]
        views = [{"set": 0, "x": x, "y": y, "ev": ev,
                  "codes": [255 * math.sqrt(min(1, max(0, self.reference[name][y * WIDTH + x])
                                                * 2 ** ev)) for name in "BGR"]}
                 for x, y in (*PLANTED, (17, 4)) for ev in (0, 2, -5)]
        # JSON has no infinity; the sky is checked by the floats above.
        return {"pixels": pixels, "maps": maps, "views": views}

    def in_the_browser(self, page, expected, *options):
        pages.skip_without_a_browser("the page of neph view")
        path = self.put("expected.json", json.dumps(expected, allow_nan=False))
        return pages.node(PAGE / "check_view.mjs", *options, page, path)

    def test_values_and_colours_in_a_browser(self):
        some = {"pixels": self.expectations()["pixels"][::5]}
        done = self.in_the_browser(self.page, some, "--quick")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    @night.of_the_night
    def test_the_whole_page_in_a_browser(self):
        done = self.in_the_browser(self.page, self.expectations())
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    @night.of_the_night
    def test_each_of_several_faults_is_found(self):
        """Independent faults in one page."""
        page = self.folder / "faults"
        shutil.copytree(self.page, page)
        for name, right, wrong in (
                ("view_planes.js", "bits[i] = before;", "bits[i] = before & ~1;"),
                ("view_paint.js", "codeOf(b);", "codeOf(b * 1.1);"),
                ("view_paint.js", "(z * side + y) * side + x", "(x * side + y) * side + z"),
                ("view_paint.js", "rgb = colours.below", "rgb = colours.above"),
                ("view.js", "state.ev -= 0.5", "state.ev -= 1"),
                ("view.js", "() => step(4) }],", "() => step(3) }],"),
                ("view.js", "Math.min(4, data.frames))", "Math.min(5, data.frames))"),
                ("view.js", '"wipe", "px", "py"', '"px", "py"'),
                ("view.js", "...pointIn(pane, event)", ""),
                ("view.js", "const ADDRESS_MS = 200;", "const ADDRESS_MS = 0;"),
                ("view.css", "outline-offset: -3px; }", "outline: none !important; }"),
                ("view.css", ".values caption { text-align: left; color: var(--soft);",
                 ".values caption { text-align: left; color: #aaa;")):
            text = (page / name).read_text()
            self.assertIn(right, text)
            (page / name).write_text(text.replace(right, wrong))
        done = self.in_the_browser(page, self.expectations())
        self.assertEqual(done.returncode, 1)
        for what, told in (
                ("a lost bit", "pixel 5, 3: the page reads"),
                ("a wrong colour", "at 0 EV: code"),
                ("a table read the wrong way", "by swapped on screen: code"),
                ("a wrong end of a scale", "the difference at"),
                ("a key with a wrong step", "key Shift+E: ev"),
                ("three frames for four", "key >: frame"),
                ("a cycle of five", "frames of the cycle from 5 on"),
                ("a wipe that the address forgets", "the words of an address: 14, not 15"),
                ("a zoom about the centre", "the pixel under the wheel stays"),
                ("an address that changes all the time", "changes of the address"),
                ("a focus that is not seen", "does not show its focus"),
                ("faint text", "too little contrast")):
            with self.subTest(what):
                self.assertIn(told, done.stdout)


if __name__ == "__main__":
    unittest.main()
