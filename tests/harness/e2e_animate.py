#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""scripts/animate: every pixel of the animation is the pixel of a frame that it should show, the
palette comes by the limit, and wrong input leaves no file."""
import contextlib
import importlib.machinery
import importlib.util
import io
import random
import unittest
from unittest import mock

import frames
import neph_case

LOADER = importlib.machinery.SourceFileLoader("animate", str(neph_case.ROOT / "scripts/animate"))
animate = importlib.util.module_from_spec(importlib.util.spec_from_loader("animate", LOADER))
LOADER.exec_module(animate)

WIDTH, HEIGHT = 40, 24
LEFT, TOP, SHOWN_WIDTH, SHOWN_HEIGHT, ZOOM = 3, 2, 31, 20, 2
NAMES = ("march", "floor", "fixed", "ours")
NUMBERS = range(98, 103)  # 100 follows 99, not 10
CROP = f"{SHOWN_WIDTH}x{SHOWN_HEIGHT}+{LEFT}+{TOP}"


def colour(name, number, x, y):
    """One of 200 colours, in no order."""
    i = hash((NAMES.index(name), number, x, y)) % 200
    return (i + 40, 255 - i, i * 7 % 256)


class AnimateCase(unittest.TestCase):
    def setUp(self):
        self.folder = neph_case.scratch(self.addCleanup)
        self.output = self.folder / "motion.png"

    def put_frames(self, name, numbers=NUMBERS, size=(WIDTH, HEIGHT), pixel=colour):
        folder = self.folder / name
        folder.mkdir(exist_ok=True)
        for number in numbers:
            rgb = [code for y in range(size[1]) for x in range(size[0])
                   for code in pixel(name, number, x, y)]
            (folder / f"scene2_{name}_{number}.png").write_bytes(frames.png_bytes(*size, rgb))
        return f"{name}={folder}"

    def animate(self, *words, code=0):
        """The answer, or the message of an error."""
        stdout, stderr = io.StringIO(), io.StringIO()
        with contextlib.redirect_stdout(stdout), contextlib.redirect_stderr(stderr):
            try:
                found = animate.main(["-o", str(self.output), *map(str, words)])
            except SystemExit as end:
                found = end.code
        self.assertEqual(found, code, stderr.getvalue())
        self.assertEqual((self.output.exists(), bool(stdout.getvalue())), (code == 0, code == 0))
        self.assertEqual([path.name for path in self.folder.iterdir() if path.name[0] == "."], [])
        return (stderr if code else stdout).getvalue()


class CommandLine(AnimateCase):
    def test_without_pillow_the_message_says_what_to_install(self):
        with mock.patch.object(animate, "Image", None):
            self.assertIn("apt-get install python3-pil", self.animate("a=a", "b=b", code=69))

    def test_wrong_words_are_refused(self):
        for said, words in (("not LABEL=FOLDER", ["out"]), ("two to four", ["a=a"]),
                            ("two to four", ["a=a"] * 5),
                            ("not WIDTHxHEIGHT+LEFT+TOP", ["a=a", "b=b", "--crop", "0x5+1+1"]),
                            ("not FIRST-LAST", ["a=a", "b=b", "--frames", "5-5"]),
                            ("0 < x", ["a=a", "b=b", "--zoom", "0"])):
            self.assertIn(said, self.animate(*words, code=2))


@unittest.skipUnless(animate.Image, "Pillow (package python3-pil) is not installed")
class Animation(AnimateCase):
    def check_pixels(self, numbers, columns):
        with animate.Image.open(self.output) as file:
            self.assertEqual((file.n_frames, file.info["loop"]), (len(numbers), 0))
            for place, number in enumerate(numbers):
                file.seek(place)
                self.assertEqual(file.info["duration"], 40)
                canvas = file.convert("RGB")
                for i, name in enumerate(NAMES):
                    left = i % columns * (ZOOM * SHOWN_WIDTH + animate.GAP_PX)
                    top = animate.LABEL_PX + i // columns * (
                        ZOOM * SHOWN_HEIGHT + animate.LABEL_PX + animate.GAP_PX)
                    panel = canvas.crop((left, top, left + ZOOM * SHOWN_WIDTH,
                                         top + ZOOM * SHOWN_HEIGHT))
                    self.assertEqual(list(panel.getdata()), [
                        colour(name, number, LEFT + x // ZOOM, TOP + y // ZOOM)
                        for y in range(panel.height) for x in range(panel.width)])

    def test_every_pixel_is_that_of_its_frame(self):
        words = [self.put_frames(name) for name in NAMES]
        words += ["--crop", CROP, "--zoom", ZOOM, "--fps", 25]
        answer = self.animate(*words)
        self.assertRegex(answer, "5 frames of 128x116, 40 ms each, 0.0. MB, all colours")
        self.check_pixels(NUMBERS, columns=2)
        words += ["--frames", "99-101", "--columns", 4]
        self.animate(*words)
        # Below this size only with a palette, which has all of these colours.
        answer = self.animate(*words, "--limit", (self.output.stat().st_size - 1) / 1e6)
        self.assertIn("256 colours (RMS error 0.00, largest 0 of 255)", answer)
        self.check_pixels(range(99, 102), columns=4)

    def test_labels_are_drawn_in_white_on_black(self):
        self.animate(*(self.put_frames(name) for name in NAMES[:2]), "--columns", 1, "--zoom", 8)
        with animate.Image.open(self.output) as file:
            for top in (0, animate.LABEL_PX + 8 * HEIGHT + animate.GAP_PX):
                strip = file.convert("RGB").crop((0, top, file.width, top + animate.LABEL_PX))
                self.assertEqual({colour for _, colour in strip.getcolors()},
                                 {(0, 0, 0), (255, 255, 255)})

    def test_the_palette_shrinks_until_the_file_is_below_the_limit(self):
        random.seed(7)
        words = [self.put_frames(name, range(4), (32, 24),
                                 lambda *_: [random.randrange(256) for _ in range(3)])
                 for name in NAMES[:2]] + ["--limit"]
        errors, limit = {}, 1.0
        for count in ("all", "256", "128", "64", "32"):
            answer = self.animate(*words, limit)
            self.assertIn(f" {count} colours", answer)
            size = self.output.stat().st_size
            self.assertLessEqual(size, 1e6 * limit)
            if count != "all":
                errors[count] = float(answer.split("RMS error ")[1].split(",")[0])
            limit = (size - 1) / 1e6
        # 32 boxes of equal volume have sides of 255 / 32^(1/3): an RMS of 23 in each channel.
        self.assertEqual(sorted(errors.values()), list(errors.values()))
        self.assertTrue(10 < errors["32"] < 30, errors)
        self.output.unlink()
        self.assertIn("fewer frames or a smaller crop", self.animate(*words, limit, code=65))

    def test_wrong_frames_are_refused(self):
        march, ours = self.put_frames("march"), self.put_frames("ours", range(99, 102))
        small = self.put_frames("small", size=(6, 4), pixel=lambda *_: (1, 2, 3))
        (self.folder / "empty").mkdir()
        damaged = self.put_frames("fixed")
        (self.folder / "fixed/scene2_fixed_100.png").write_bytes(b"no frame")
        twice = self.put_frames("floor")
        (self.folder / "floor/other_0100.png").write_bytes(b"")
        for code, said, words in (
                (66, "ours has no frame 98: it has 99 to 101", [march, ours]),
                (66, "march has no frame 103", [march, ours, "--frames", "103-104"]),
                (66, "neph post FRAMES --png", [march, f"ours={self.folder}/empty"]),
                (65, "has 6x4 pixels, the first frame 40x24", [march, small]),
                (65, "frames have 40x24 pixels", [march, march, "--crop", "5x5+36+0"]),
                (65, "scene2_fixed_100.png: ", [march, damaged]),
                (65, "have the same number", [march, twice]),
                (74, "Is a directory", [march, march, "-o", self.folder / "empty"])):
            self.assertIn(said, self.animate(*words, code=code))


if __name__ == "__main__":
    unittest.main()
