#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Files of frames that other programs write: data windows that differ, depth by name, parts."""
import array
import math
import pathlib
import random
import shutil
import struct
import unittest
import zlib

import frames
import neph_case
import night

NEPH = pathlib.Path(neph_case.NEPH)


class Windows(neph_case.NephCase):
    """Frames with a display window of 20x12 pixels."""
    display = (20, 12)

    def write(self, name, corner, size, value_at, display=None, **further):
        """value_at is called with places in the display window."""
        path = self.folder / name
        path.parent.mkdir(exist_ok=True)
        places = [(x, y) for y in range(corner[1], corner[1] + size[1])
                  for x in range(corner[0], corner[0] + size[0])]
        values = [value_at(x, y) for x, y in places]
        channels = {c: values for c in "RGB"} | {
            channel: [at(x, y) for x, y in places] for channel, at in further.items()}
        path.write_bytes(frames.exr_bytes(*size, channels, corner=corner,
                                          display=display or self.display))
        return path

    def mae(self, *words, quantity="radiance"):
        """The mean absolute error, its pixels, and what is said of the windows."""
        found = self.json("compare", *words, "-m", "mae")
        row = next(row for row in found["measurements"]
                   if (row["quantity"], row["mask"]) == (quantity, "all"))
        return row["value"], row["pixel_count"], found["window"]

    def inside(self, x, y):
        return 0.5 if 4 <= x < 16 and 3 <= y < 9 else 0.0

    def test_a_tight_box_is_compared_with_the_whole(self):
        whole = self.write("whole.exr", (0, 0), self.display, self.inside)
        box = self.write("box.exr", (4, 3), (12, 6), lambda x, y: 0.625)
        value, count, window = self.mae(whole, box)
        self.assertEqual((value, count), (0.125 * 12 * 6 / 240, 240))
        self.assertEqual(window, {"mode": "union", "differ": True, "measured": {
            "corner_px": [0, 0], "size_px": [20, 12], "display_px": [20, 12]}})
        said = self.neph("compare", whole, box).stdout
        self.assertIn("the data windows differ: of 20x12 measured pixels 12x6 are in all", said)
        self.assertEqual(self.mae(whole, box, "--window", "intersection")[:2], (0.125, 72))
        self.neph("compare", whole, box, "--window", "strict", code=65,
                  said=("(4, 3) of 20x12", "hint: --window union or intersection"))
        self.neph("compare", whole, box, "--window", "box", code=64, said="strict")

    def test_equal_crops_are_compared_as_they_are(self):
        crop = self.write("crop.exr", (4, 3), (12, 6), lambda x, y: 0.5)
        value, count, window = self.mae(crop, crop)
        self.assertEqual((value, count, window["measured"]), (0, 72, None))
        self.assertNotIn("--window", self.neph("compare", crop, crop).stdout)

    def test_crops_of_different_places(self):
        value_at = lambda x, y: 0.25 + x / 64
        a, b = (self.write(name, (left, 3), (12, 6), value_at)
                for name, left in (("a.exr", 4), ("b.exr", 5)))
        edges = (value_at(4, 0) + value_at(16, 0)) / 13
        value, count, window = self.mae(a, b)
        self.assertEqual((count, window["measured"]["corner_px"]), (13 * 6, [4, 3]))
        self.assertAlmostEqual(value, edges, delta=1e-7)  # floats of the files
        self.assertEqual(self.mae(a, b, "--window", "intersection")[:2], (0, 11 * 6))
        apart = self.write("apart.exr", (17, 3), (3, 3), value_at)
        self.assertIn("none is in all files", self.neph("compare", a, apart).stdout)
        self.neph("compare", a, apart, "--window", "intersection", code=65,
                  said="no pixel of the display window is in every data window")

    def test_overscan_is_cut_to_the_display_window(self):
        value_at = lambda x, y: 0.5 if 0 <= x < 20 and 0 <= y < 12 else 9.0
        wide = self.write("wide.exr", (-2, -1), (24, 14), value_at)
        plain = self.write("plain.exr", (0, 0), self.display, lambda x, y: 0.5)
        for words in ((wide, plain), (plain, wide), (wide, wide)):
            self.assertEqual(self.mae(*words)[:2], (0, 240))
        self.assertIn("reach beyond the display window", self.neph("compare", wide, wide).stdout)
        self.assertEqual(self.mae(wide, wide, "--window", "strict")[:2], (0, 24 * 14))

    def test_display_windows_that_differ_are_refused(self):
        a = self.write("a.exr", (4, 3), (4, 4), lambda x, y: 0.5)
        b = self.write("b.exr", (4, 3), (4, 4), lambda x, y: 0.5, display=(30, 12))
        png = self.folder / "c.png"
        png.write_bytes(frames.png_bytes(21, 12, [0] * (3 * 21 * 12)))
        for words in ((a, b), ("--window", "intersection", a, b), (a, png)):
            self.neph("compare", *words, code=65, said="the size of the display window changes")
        huge = self.write("huge.exr", (0, 0), (1, 1), lambda x, y: 0.5, display=(40000, 1))
        far = self.write("far.exr", (39999, 0), (1, 1), lambda x, y: 0.5, display=(40000, 1))
        self.neph("compare", huge, far, code=65, said="together have 40000x1 pixels")

    def test_outside_is_the_sky_and_transparent(self):
        near = lambda x, y: 2.0
        layers = {"Z": near, **{f"transmittance.{c}": lambda x, y: 0.5 for c in "RGB"}}
        whole = self.write("whole.exr", (0, 0), self.display, self.inside, **{
            "Z": lambda x, y: 2.0 if self.inside(x, y) else 1e10,
            **{f"transmittance.{c}": lambda x, y: 0.5 if self.inside(x, y) else 1.0
               for c in "RGB"}})
        box = self.write("box.exr", (4, 3), (12, 6), lambda x, y: 0.5, **layers)
        for pair in ((whole, box), (box, whole)):
            found = self.json("compare", *pair, "-m", "mae")
            self.assertEqual({row["value"] for row in found["measurements"]} - {None}, {0})
            counts = {row["mask"]: row["pixel_count"] for row in found["measurements"]
                      if row["quantity"] == "radiance"}
            self.assertEqual((counts["all"], counts["sky"]), (240, 240 - 72))

    def test_a_window_that_changes_from_frame_to_frame(self):
        value_at = lambda x, y: 0.5 + (x + y) % 3 / 16 if 2 <= x < 6 and 1 <= y < 5 else 0.0
        for t in range(16):
            corner, size = (1 + t % 2, 1), (6 - t % 2, 4)
            self.write(f"reference/f.{t:02}.exr", corner, size, value_at, display=(8, 6))
            self.write(f"test/f.{t:02}.exr", corner, size, display=(8, 6),
                       value_at=lambda x, y: value_at(x, y) and value_at(x, y) + t % 3 / 1024)
        folders = "-r", self.folder / "reference", self.folder / "test"
        found = self.json("compare", *folders, "-m", "mae")
        rows = [row for row in found["measurements"] if "frame" in row]
        self.assertEqual(len(rows), 16)
        for row in rows:
            t, places = row["frame"], 16 / 24  # with content, of 6x4 in the union
            self.assertAlmostEqual(row["value"], t % 3 / 1024 * places, delta=1e-7)
        self.assertIn("of 6x4 measured pixels 5x4", self.neph("flicker", *folders).stdout)
        done = self.neph("flicker", *folders, "--window", "strict", code=65).stderr
        self.assertIn("the data window changes", done)
        self.assertNotIn("mask", done)
        page = self.json("view", *folders, "-o", self.folder / "page")
        self.assertEqual(page["window"]["measured"]["size_px"], [6, 4])
        self.assertEqual((page["width_px"], page["height_px"]), (6, 4))
        self.neph("view", *folders, "--window", "strict", "-o", self.folder / "page", code=65)

    def test_a_mask_has_the_frames_windows(self):
        whole = self.write("whole.exr", (0, 0), self.display, lambda x, y: x / 32)
        box = self.write("box.exr", (4, 3), (12, 6), lambda x, y: x / 32 + 1)
        masks = [self.write("small.exr", (4, 3), (2, 2), lambda x, y: 1.0),
                 self.write("full.exr", (0, 0), self.display,
                            lambda x, y: 1.0 if 4 <= x < 6 and 3 <= y < 5 else 0.0)]
        (self.folder / "mask.png").write_bytes(frames.png_bytes(20, 12, [
            255 * (4 <= x < 6 and 3 <= y < 5) for y in range(12) for x in range(20)
            for _ in "RGB"]))
        for mask in (*masks, self.folder / "mask.png"):
            for mode in ("union", "intersection"):
                found = self.json("compare", whole, box, "-m", "mae", "--mask", mask, "--window",
                                  mode)["measurements"][0]
                self.assertEqual((found["value"], found["pixel_count"]), (1.0, 4), (mask, mode))

    def test_noise_of_renders_with_different_windows(self):
        variances = {f"variance.{c}": lambda x, y: 1e-6 if self.inside(x, y) else 0.0
                     for c in "RGB"}
        wave = lambda x, y: 1e-3 * math.sin(x * 7 + y * 13)
        whole = self.write("whole.exr", (0, 0), self.display, **variances,
                           value_at=lambda x, y: self.inside(x, y) and 0.5 + wave(x, y))
        box = self.write("box.exr", (4, 3), (12, 6), lambda x, y: 0.5 - wave(y, x), **variances)
        self.assertIn("of 20x12 measured pixels 12x6",
                      self.neph("compare", "--z", whole, box).stdout)
        found = self.json("compare", "--z", whole, box)
        self.assertTrue(found["window"]["differ"])
        self.assertEqual(found["planes"][0]["noisy_pixels"], 72)


class Depth(neph_case.NephCase):
    def write(self, name, **channels):
        grey = {c: [0.5] * 64 for c in "RGB"}
        (self.folder / name).write_bytes(frames.exr_bytes(8, 8, grey | channels))
        return self.folder / name

    def depth_error(self, *words):
        """The mean absolute error of depth over the pixels that are solid, and their number."""
        found = self.json("compare", *words, "--depth", "ViewLayer.Depth.Z", "-m", "mae")
        return next((row["value"], row["pixel_count"]) for row in found["measurements"]
                    if (row["quantity"], row["mask"]) == ("depth", "all"))

    def test_depth_by_name(self):
        def blender(value, sky=1e10):
            return {"ViewLayer.Depth.Z": [value] * 32 + [sky] * 32,
                    **{f"ViewLayer.Combined.{c}": [0.5] * 64 for c in "RGBA"}}
        plain = self.write("plain.exr", Z=[5.0] * 32 + [math.inf] * 32)
        vector = self.write("vector.exr", **blender(5.25), **{c: [1.0] * 64 for c in "XYZ"})
        test, other = (self.write(name, **blender(depth))
                       for name, depth in (("test.exr", 5.5), ("other.exr", 6.5)))
        for words, expected in (((plain, test), 0.5), ((test, other), 1.0), ((plain, vector), 0.25),
                                ((test, other, "--layer", "ViewLayer.Combined"), 1.0)):
            self.assertEqual(self.depth_error(*words), (expected, 32), words)
        for sky in (0.0, 65504.0, 65535.0, 1e9, 1e11):
            sky = self.write("sky.exr", **blender(5.0, sky))
            self.assertEqual(self.depth_error(test, sky), (0.5, 32), sky)
        self.neph("view", plain, test, "--depth", "ViewLayer.Depth.Z", "-q", "-o",
                  self.folder / "page")
        self.neph("compare", plain, self.write("none.exr"), "--depth", "Depth.Z", code=65,
                  said=("none.exr' has no channel 'Depth.Z'", "hint: its channels are B G R"))


class Colours(neph_case.NephCase):
    AP1 = (0.713, 0.293, 0.165, 0.83, 0.128, 0.044, 0.32168, 0.33767)
    # ACEScg to linear Rec.709: "Utility - Linear - sRGB" of the ACES 1.x configurations
    TO_REC709 = ((1.70505, -0.62179, -0.08326), (-0.13026, 1.14080, -0.01055),
                 (-0.02400, -0.12897, 1.15297))

    # IEC 61966-2-1, of the linear values
    TO_XYZ = ((0.4124, 0.3576, 0.1805), (0.2126, 0.7152, 0.0722), (0.0193, 0.1192, 0.9505))

    def write(self, name, pixels, *attributes, channels="RGB"):
        (self.folder / name).write_bytes(frames.exr_bytes(
            8, 8, dict(zip(channels, zip(*pixels))), attributes))
        return self.folder / name

    def test_cie_xyz_is_converted_when_asked(self):
        light = [(0.2 + i / 128, 0.3 + i / 100, 0.5 - i / 200) for i in range(64)]
        xyz = [[sum(m * v for m, v in zip(row, pixel)) for row in self.TO_XYZ] for pixel in light]
        plain = self.write("plain.exr", light)
        test = self.write("xyz.exr", xyz, channels="XYZ")
        self.neph("compare", plain, test, code=65, said=("CIE XYZ", "hint: --convert"))
        found = self.json("compare", plain, test, "--convert", "-m", "max_abs")
        self.assertLess(found["measurements"][0]["value"], 4e-4)  # digits of the matrix
        self.assertEqual(found["converted"]["test"], "lin_ciexyzd65_scene")
        wide = self.write("wide.exr", xyz, ("colorInteropID", "string", b"acescct"),
                          channels="XYZ")
        self.neph("compare", plain, wide, "--convert", code=65, said="acescct")

    def test_spaces_are_converted_when_asked(self):
        given = [(0.2 + i / 128, 0.3 + i / 100, 0.5 - i / 200) for i in range(64)]
        expected = [[sum(m * v for m, v in zip(row, pixel)) for row in self.TO_REC709]
                    for pixel in given]
        plain = self.write("plain.exr", expected)
        drawn = "chromaticities", "chromaticities", struct.pack("<8f", *self.AP1)
        named = "colorInteropID", "string", b"lin_ap1_scene"
        for at, attributes in enumerate(((drawn,), (named,), (named, drawn))):
            test = self.write(f"test{at}.exr", given, *attributes)
            self.neph("compare", plain, test, code=65, said="--convert")
            for words, side in (((plain, test), "test"), ((test, plain), "reference")):
                found = self.json("compare", *words, "--convert", "-m", "max_abs")
                value = found["measurements"][0]["value"]
                self.assertLess(value, 2e-5, attributes)  # digits of the matrix
                self.assertIn(side, [side for side, space in found["converted"].items() if space])
        self.assertIn("converted to linear Rec.709: the test from lin_ap1_scene",
                      self.neph("compare", plain, test, "--convert").stdout)
        self.neph("view", plain, test, "--convert", "-q", "-o", self.folder / "page")
        self.neph("compare", "--z", plain, test, "--convert", code=64, said="takes no --convert")
        other = self.write("other.exr", given, ("colorInteropID", "string", b"acescct"))
        both = self.write("both.exr", given, drawn,
                          ("colorInteropID", "string", b"lin_rec2020_scene"))
        for path, words in ((other, "'acescct' cannot be converted"), (both, "are not those of")):
            self.neph("compare", plain, path, "--convert", code=65, said=(path.name, words))


class Parts(neph_case.NephCase):
    def test_parts_beside_files_without(self):
        grey = lambda value: {c: [value] * 64 for c in "RGB"}
        plain, parts, png = (self.folder / name for name in ("plain.exr", "parts.exr", "a.png"))
        plain.write_bytes(frames.exr_bytes(8, 8, grey(1.0), [("name", "string", b"one")]))
        parts.write_bytes(frames.multipart_exr_bytes(8, 8, {
            "left": grey(1.5), "right": grey(2.0), "mask": {"Y": [1.0] * 8 + [0.0] * 56}}))
        png.write_bytes(frames.png_bytes(8, 8, [0] * 192))
        mae = lambda *words: self.json("compare", *words, "-m", "mae")["measurements"][0]
        self.assertEqual(mae(plain, parts, "--part", "right")["value"], 1.0)
        self.assertEqual(mae(plain, plain, "--part", "one")["value"], 0.0)
        self.assertEqual(mae(plain, plain, "--part", 0)["value"], 0.0)
        for path in (plain, png):
            for words in (("compare", path, path), ("view", path), ("post", path, "-s", "tone=on")):
                self.neph(*words, "--part", "right", code=65, cwd=self.folder,
                          said=("no file has the part 'right'", "hint: leave out --part"))
        found = mae(parts, parts, "--part", "mask", "--mask", parts)
        self.assertEqual(found["pixel_count"], 8)


class Animations(neph_case.NephCase):
    width, height = 7, 5

    def shots(self, random, count, bits):
        """Rectangles with all ways to draw and to dispose of them, on an opaque first frame."""
        most = 2 ** bits - 1
        for at in range(count):
            w = random.randint(1, self.width) if at else self.width
            h = random.randint(1, self.height) if at else self.height
            x, y = random.randint(0, self.width - w), random.randint(0, self.height - h)
            alphas = [0, most, random.randint(1, most)] if at else [most]
            blend = random.randint(0, 1) if at else 0
            codes = [c for _ in range(w * h) for c in (
                *(random.randint(0, most) for _ in range(3)),
                random.choice(alphas) if blend else most)]
            # A cleared rectangle would be transparent: the next frame fills it.
            yield x, y, w, h, codes, (1, 24), 2 * random.randint(0, 1) if at else 0, blend

    def compose(self, shots, most):
        """The frames, by the specification."""
        canvas = [[(0, 0, 0, 0)] * self.width for _ in range(self.height)]
        for x, y, w, h, codes, _, dispose, blend in shots:
            before = [list(row) for row in canvas]
            for i in range(w * h):
                row, column = y + i // w, x + i % w
                *colour, alpha = codes[4 * i:4 * i + 4]
                under = canvas[row][column]
                if blend and alpha < most:
                    share = alpha / most
                    colour = [int(new * share + old * (1 - share) + 0.5)
                              for new, old in zip(colour, under)]
                canvas[row][column] = (*colour, most)
            yield [c for row in canvas for pixel in row for c in pixel[:3]]
            if dispose == 1:
                for row in range(y, y + h):
                    canvas[row][x:x + w] = [(0, 0, 0, 0)] * w
            elif dispose == 2:
                canvas = before

    def write(self, name, data):
        (self.folder / name).write_bytes(data)
        return self.folder / name

    def test_frames_are_composed_by_the_specification(self):
        for seed, bits in ((1, 8), (2, 16), (3, 8)):
            dice = random.Random(seed)
            shots = list(self.shots(dice, 12, bits))
            if seed == 3:  # the canvas is cleared, and drawn as a whole
                x, y, w, h, codes, delay, _, blend = shots[4]
                shots[4] = (x, y, w, h, codes, delay, 1, blend)
                shots[5] = (0, 0, self.width, self.height, shots[0][4], delay, 0, 0)
            still = [9] * (4 * self.width * self.height) if seed == 2 else None
            clip = self.write(f"clip{seed}.png", frames.apng_bytes(self.width, self.height, shots,
                                                                   bits, still))
            for at, codes in enumerate(self.compose(shots, 2 ** bits - 1)):
                if bits == 16:  # frames.png_bytes() writes 8
                    expected = frames.apng_bytes(self.width, self.height, [(
                        0, 0, self.width, self.height, [c for i in range(0, len(codes), 3)
                                                        for c in (*codes[i:i + 3], 65535)],
                        (1, 24), 0, 0)], 16)
                else:
                    expected = frames.png_bytes(self.width, self.height, codes)
                self.write(f"f.{at:02}.png", expected)
            found = self.json("compare", "-r", self.folder / "f.%02d.png", clip, "-m", "mae")
            rows = [row for row in found["measurements"] if "frame" in row]
            self.assertEqual([row["value"] for row in rows], [0] * 12, seed)
            single = self.json("compare", self.folder / "f.07.png", clip / "0007.png", "-m", "mae")
            self.assertEqual(single["measurements"][0]["value"], 0)

    def test_animations_are_sequences(self):
        def clip(name, amplitude, delay, count=24):
            shots = [(0, 0, 8, 8, [*[100 + amplitude * (t % 2)] * 3, 255] * 64,
                      (50 if t == count - 1 else delay, 30), 0, 0) for t in range(count)]
            return self.write(name, frames.apng_bytes(8, 8, shots))
        before, after = clip("v1.png", 20, 1), clip("v2.png", 5, 1)
        said = self.neph("flicker", before, after).stdout
        self.assertRegex(said, "^v2.png: .*; better, p = ")
        found = self.json("flicker", "-r", before, after)
        self.assertEqual((found["frames"], found["test"]["first"]), (24, f"{after}/0000.png"))
        self.assertEqual(found["measurements"][0]["viewing"]["frame_rate_hz"], 30)
        found = self.json("view", before, after, "-o", self.folder / "page")
        self.assertEqual(found["frames"], 24)
        self.neph("compare", before, clip("short.png", 5, 1, 20), code=65, said="24")
        uneven = [(0, 0, 8, 8, [t, t, t, 255] * 64, (1 + t % 2, 30), 0, 0) for t in range(24)]
        uneven = self.write("uneven.png", frames.apng_bytes(8, 8, uneven))
        found = self.json("flicker", "-r", uneven, uneven)
        self.assertEqual(found["measurements"][0]["viewing"]["frame_rate_hz"], 60)
        (self.folder / "folder").mkdir()
        before.rename(self.folder / "folder/a.png")
        self.neph("compare", self.folder / "folder", self.folder / "folder", code=65,
                  said=("is an animated PNG: it has 24 frames", "hint: name it by itself"))

    def test_damaged_animations(self):
        grey = [128, 128, 128, 255]
        shots = [(0, 0, 4, 4, grey * 16, (1, 30), 0, 0), (1, 1, 2, 2, grey * 4, (1, 30), 0, 0)]
        good = frames.apng_bytes(4, 4, shots)
        last = good.index(b"fdAT")
        bare = frames.apng_bytes(4, 4, [(0, 0, 2, 2, grey * 4, (1, 30), 0, 0), shots[1]],
                                 still=grey * 16)
        huge = bytearray(good)
        huge[16:24] = struct.pack(">II", 16384, 16384)
        huge[29:33] = struct.pack(">I", zlib.crc32(huge[12:29]))
        for data, words in (
                (good[:last], "ends too early"), (good[:-12], "ends too early"),
                (good[:last + 8] + b"?" + good[last + 9:], "checksum"),
                (good[:last - 42] + good[last - 4:], "out of order"),  # without its fcTL
                (frames.apng_bytes(4, 4, [shots[0], (3, 3, 2, 2, grey * 4, (1, 30), 0, 0)]),
                 "not inside"), (bare, "translucent"), (huge, "too small")):
            path = self.write("bad.png", bytes(data))
            self.neph("compare", path, path, code=65, said=words, timeout_s=5)


@unittest.skipUnless(NEPH.with_name("neph-image").exists(), "neph was built without OpenImageIO")
class OtherFormats(neph_case.NephCase):
    """Files as their specifications have them, without a library."""
    def write(self, name, data):
        (self.folder / name).write_bytes(data)
        return self.folder / name

    def tiff(self, codes, width, height, bits=8, channels=3, kind=1, further=()):
        """Uncompressed, one strip; kind 1: integers, 3: floats (TIFF 6.0)."""
        pixels = array.array({(8, 1): "B", (16, 1): "H", (32, 3): "f"}[bits, kind], codes)
        start, data = 8, pixels.tobytes()
        tags = sorted([(256, 4, width), (257, 4, height), (258, 3, bits), (259, 3, 1),
                       (262, 3, 2 if channels > 1 else 1), (273, 4, start), (277, 3, channels),
                       (278, 4, height), (279, 4, len(data)), (339, 3, kind), *further])
        directory = struct.pack("<H", len(tags)) + b"".join(
            struct.pack("<HHII", tag, form, 1, value) for tag, form, value in tags)
        return (b"II*\0" + struct.pack("<I", start + len(data)) + data + directory +
                struct.pack("<I", 0))

    def damaged_tiff(self, compression):
        """Its pixels are not of that compression: OpenImageIO 2.4 reads them without an error."""
        return self.tiff([100] * 72, 6, 4).replace(struct.pack("<HHII", 259, 3, 1, 1),
                                                   struct.pack("<HHII", 259, 3, 1, compression))

    def mae(self, *words):
        return self.json("compare", *words, "-m", "mae")["measurements"][0]["value"]

    def test_formats_by_their_specifications(self):
        codes = [(7 * i) % 256 for i in range(6 * 4 * 3)]
        png = self.write("a.png", frames.png_bytes(6, 4, codes))
        ppm = self.write("a.ppm", b"P6\n6 4\n255\n" + bytes(codes))
        tiff = self.write("a.tif", self.tiff(codes, 6, 4))
        self.assertLess(max(self.mae(png, ppm), self.mae(png, tiff)), 1e-7)  # codes as floats
        light = [i / 64 for i in range(6 * 4 * 3)]
        planes = {c: light[k::3] for k, c in enumerate("RGB")}
        exr = self.write("a.exr", frames.exr_bytes(6, 4, planes))
        rows = [light[18 * y:18 * (y + 1)] for y in range(4)]
        pfm = self.write("a.pfm", b"PF\n6 4\n-1.0\n" + b"".join(
            struct.pack("<18f", *row) for row in reversed(rows)))  # from the last row on
        floats = self.write("b.tif", self.tiff(light, 6, 4, 32, kind=3))
        self.assertEqual((self.mae(exr, pfm), self.mae(exr, floats)), (0, 0))
        self.neph("compare", exr, ppm, code=65, said="no common scale")
        self.neph("view", png, ppm, "-q", "-o", self.folder / "page")

    def refuse(self, path, words):
        done = self.neph("compare", path, path, code=65, said=(path.name, words), timeout_s=10)
        self.assertEqual(done.stdout, "")

    def test_what_is_refused(self):
        self.refuse(self.write("wide.tif", self.tiff([30000] * 72, 6, 4, 16)),
                    "integers of 16 bits, and no word about their colour")
        short = self.write("short.ppm", b"P6\n6 4\n255\n" + bytes(20))
        self.refuse(short, "damaged")
        self.neph("compare", short, short, NEPH_IMAGE="/nowhere/neph-image", code=69,
                  said=("/nowhere/neph-image", "libopenimageio-dev"))
        self.neph("compare", short, short, "--part", "left", code=65, said="numbered from 0")

    def test_one_process_reads_a_sequence(self):
        program, starts = self.folder / "counted", self.folder / "starts"
        helper = NEPH.with_name("neph-image")
        program.write_text(f'#!/bin/sh\necho >> {starts}\nexec {helper} "$@"\n')
        program.chmod(0o755)
        for side, grey in (("a", 100), ("b", 101)):
            (self.folder / side).mkdir()
            for t in range(6):
                self.write(f"{side}/f.{t}.tif", self.tiff([grey + t] * 72, 6, 4))
        words = "compare", "-r", self.folder / "a", self.folder / "b", "-m", "mae"
        self.neph(*words, NEPH_IMAGE=program)
        self.assertEqual(len(starts.read_text()), 1)
        self.write("b/f.3.tif", self.damaged_tiff(5))
        self.neph(*words, code=65, said=("b/f.3.tif': ", "damaged"), silent=True)

    def test_pixels_that_are_not_there(self):
        """OpenImageIO itself reads these, with zeros or grey for what the file has not."""
        jpeg = (pathlib.Path(__file__).parent / "../fuzz/corpus/whole/grey.jpg").read_bytes()
        wide = self.tiff([100] * 72, 6, 4).replace(struct.pack("<HHII", 256, 4, 1, 6),
                                                   struct.pack("<HHII", 256, 4, 1, 16384))
        for name, data, words in (("cut.jpg", jpeg[:-20], "no end-of-image marker"),
                                  ("wide.tif", wide, "196608 bytes, and its strips have 72")):
            path = self.write(name, data)
            self.neph("compare", path, path, code=65, said=(name, words), silent=True,
                      NEPH_IMAGE="/nowhere")  # refused before any program starts

    @night.of_the_night
    def test_what_else_is_refused(self):
        self.refuse(self.write("cut.tif", self.tiff([100] * 72, 6, 4)[:60]), "damaged")
        for compression in (7, 8, 34712):
            self.refuse(self.write("code.tif", self.damaged_tiff(compression)), "damaged")
        self.refuse(self.write("text.hdr", b"#?RADIANCE\n\nnonsense"), "damaged")
        for side, words in ((16384, "damaged"), (100000, "allowed are 1 to 16384 per side")):
            self.refuse(self.write("large.ppm", b"P6\n%d %d\n255\n" % (side, side) + bytes(20)),
                        words)


class Videos(neph_case.NephCase):
    width, height = 8, 6

    def codes(self, t):
        """Limited Y'CbCr of each pixel: a grey that changes, then colours."""
        return [((16 + (9 * i + 5 * t) % 220), 128 + 20 * (i % 3 - 1), 128 - 15 * (i % 5 - 2))
                for i in range(self.width * self.height)]

    def y4m(self, name, count=20, head="C444"):
        data = b"YUV4MPEG2 W%d H%d F%d:1 Ip A%d:1 %s\n" % (self.width, self.height, 24, 1,
                                                         head.encode())
        for t in range(count):
            planes = zip(*self.codes(t))
            data += b"FRAME\n" + b"".join(bytes(plane) for plane in planes)
        (self.folder / name).write_bytes(data)
        return self.folder / name

    def expected(self, t):
        """RGB of 16 bits by ITU-R BT.601-7, 2.5.1 and 2.5.2, clamped."""
        made = []
        for y, b, r in self.codes(t):
            luma, cb, cr = (y - 16) / 219, (b - 128) / 224, (r - 128) / 224
            red, blue = luma + 1.402 * cr, luma + 1.772 * cb
            green = (luma - 0.299 * red - 0.114 * blue) / 0.587
            made += [round(65535 * min(max(c, 0), 1)) for c in (red, green, blue)] + [65535]
        return made

    @unittest.skipUnless(shutil.which("ffmpeg"), "ffmpeg is not installed")
    def test_frames_of_a_video(self):
        video = self.y4m("a.y4m")
        for t in range(20):
            (self.folder / f"f.{t:02}.png").write_bytes(frames.apng_bytes(
                self.width, self.height,
                [(0, 0, self.width, self.height, self.expected(t), (1, 24), 0, 0)], 16))
        words = "-r", self.folder / "f.%02d.png", video
        found = self.json("compare", *words, "-m", "mae,max_abs")
        values = [row["value"] for row in found["measurements"] if "frame" in row]
        self.assertEqual(len(values), 40)
        # Both round to 16 bits, which a code in the middle may do differently.
        self.assertLess(max(values), 2.4 / 65535)
        self.assertEqual(found["video"]["test"], "rawvideo, yuv444p, limited range (not stated), "
                                                 "matrix BT.601 (not stated)")
        said = self.neph("flicker", *words).stdout
        self.assertIn("decoded as sRGB: the test from rawvideo, yuv444p, limited range", said)
        self.assertIn("24 frames a second", said)
        self.assertIn("as sRGB: both from rawvideo", self.neph("compare", video, video).stdout)

    @unittest.skipUnless(shutil.which("ffmpeg"), "ffmpeg is not installed")
    def test_broken_videos(self):
        video = self.y4m("a.y4m")
        cut = self.folder / "cut.y4m"
        cut.write_bytes(video.read_bytes()[:300])
        huge = self.folder / "huge.y4m"
        huge.write_bytes(video.read_bytes().replace(b"W8 H6", b"W99999 H99999"))
        for path in (huge, self.put("none.mp4", "\0\0\0\x14ftypisom" + "x" * 50)):
            self.neph("compare", path, path, code=65, said=path.name, timeout_s=20)
        self.neph("compare", video, cut, code=65)

    def test_without_ffmpeg(self):
        video = self.y4m("a.y4m", 2)
        self.neph("compare", video, video, code=69, PATH="/nowhere",
                  said=("ffprobe", "apt-get install ffmpeg"))


if __name__ == "__main__":
    unittest.main()
