#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""`neph fly` on a virtual display: the screen's content, the effect of keys, its files and its
exit."""
import collections
import math
import os
import pathlib
import shutil
import struct
import subprocess
import unittest

import frames
import neph_case

HAS_WINDOW = os.environ["NEPH_HAS_WINDOW"] == "1"
WIDTH, HEIGHT = 32, 18
SIZE = f"{WIDTH}x{HEIGHT}"
ZOOM = 20  # which makes the window 640 pixels wide

# Fog before a tower under a bright sky, with the same shaders as e2e_realtime.
TOWER = """
name: tower
title: a test
description: a test
camera: {position_m: [0, 2, 0], look_at_m: [0, 2, -10], vertical_fov_deg: 40}
frames: {count: 6, rate_hz: 30}
sun: {direction: [0.6, 0.75, 0.3], irradiance_w_per_m2: [6, 6, 6]}
background_w_per_m2_sr: [0.5, 0.25, 0.125]
scattering: single
solids:
  - box: {min_m: [1, -6, -21], max_m: [3, 6, -20], albedo: [0, 0, 0]}
media:
  - height_fog:
      layers: [{extinction_per_m: 0.02, falloff_per_m: 0.1, height_m: 0}]
      albedo: [1, 1, 1]
"""

OUTSIDE = {name: value for name, value in os.environ.items()
           if name not in ("DISPLAY", "WAYLAND_DISPLAY") and not name.startswith("SDL_")}
OUTSIDE["NEPH_VULKAN_VALIDATION"] = "1"


class Screen:
    """An X server whose screen is a file."""

    def __init__(self, folder):
        self.file = folder / "Xvfb_screen0"
        told, tell = os.pipe()
        self.server = subprocess.Popen(
            ["Xvfb", "-displayfd", str(tell), "-screen", "0", "800x600x24", "-nolisten", "tcp",
             "-fbdir", str(folder)], pass_fds=[tell], stderr=subprocess.DEVNULL)
        os.close(tell)
        with os.fdopen(told) as display:
            self.name = ":" + display.readline().strip()

    def close(self):
        self.server.terminate()
        self.server.wait()

    def pixels(self):
        data = self.file.read_bytes()
        header = struct.unpack(">25I", data[:100])  # the XWD format
        size, width, height, bits, line, colour_count = (header[0], header[4], header[5],
                                                         header[11], header[12], header[19])
        assert bits == 32 and width == 800 and height == 600 and line == 4 * width
        return memoryview(data)[size + 12 * colour_count:][:height * line]

    def colours(self):
        """How many pixels of the screen have each colour."""
        count = collections.Counter()
        for pixel, times in collections.Counter(self.pixels().cast("I")).items():
            count[pixel & 0xffffff] += times
        return count

    def is_black(self):
        pixels = bytes(self.pixels())
        return not any(pixels[byte::4].strip(b"\0") for byte in range(3))


class Refusals(neph_case.NephCase):
    surroundings = OUTSIDE

    def refuse(self, code, *words, scene=TOWER, arguments=(), **environment):
        self.neph("fly", self.put("tower.yaml", scene), "--size", SIZE, "-o", self.folder,
                  *arguments, **environment, code=code, said=words, silent=True)

    @unittest.skipIf(HAS_WINDOW, "this neph has windows")
    def test_without_sdl_it_says_how_to_get_it(self):
        self.refuse(69, "built without SDL 2", "apt-get install libsdl2-dev")

    @unittest.skipUnless(HAS_WINDOW, "this neph has no windows")
    def test_without_a_display_it_says_so(self):
        self.refuse(69, "no window can be opened", "xvfb-run")

    def test_keys_that_are_none(self):
        self.refuse(64, "'w60'", "key*frames", arguments=["--keys", "p w60"])

    def test_an_orthographic_camera_stands_still(self):
        self.refuse(2, "orthographic", scene=TOWER.replace("vertical_fov_deg: 40",
                                                           "orthographic_height_m: 5"))


@unittest.skipUnless(HAS_WINDOW, "this neph has no windows")
class Flight(neph_case.NephCase):
    surroundings = OUTSIDE

    @classmethod
    def setUpClass(cls):
        if not shutil.which("Xvfb"):
            raise unittest.SkipTest("no Xvfb: apt-get install xvfb")
        cls.screen = Screen(neph_case.scratch(cls.addClassCleanup))
        cls.addClassCleanup(cls.screen.close)
        cls.environment = {"DISPLAY": cls.screen.name, "SDL_RENDER_DRIVER": "software",
                           "SDL_VIDEODRIVER": "x11"}

    def setUp(self):
        super().setUp()
        self.scene = self.put("tower.yaml", TOWER)

    def fly(self, keys, frame_count, *arguments):
        return self.json("fly", self.scene, "--size", SIZE, "--seed", 1, "-o", self.folder, "-s",
                         "steps=16", "--keys", keys, "--frames", frame_count, *arguments,
                         **self.environment)

    def channels(self, name):
        width, height, channels, _ = frames.read_exr(self.folder / name)
        self.assertEqual((width, height), (WIDTH, HEIGHT))
        return channels

    def test_the_recording_renders_the_flight(self):
        flown = self.fly("k w*3 d*2 p k", 10)
        self.assertEqual(flown["frames"], 10)
        self.assertEqual(flown["engine"], "realtime ours")
        self.assertGreater(flown["frame_median_s"], 0)
        self.assertEqual([pathlib.Path(file).name for file in flown["files"]],
                         ["tower_fly.exr", "tower_fly.png", "tower_path.yaml"])
        # 5 m/s, a frame is 1/30 s.
        for actual, expected in zip(flown["camera"]["position_m"], (1 / 3, 2, -1 / 2)):
            self.assertAlmostEqual(actual, expected, places=12)
        self.neph("render", self.folder / "tower_path.yaml", "-e", "realtime", "-p", "ours", "-s",
                  "warm_up=0", "-s", "steps=16", "--size", SIZE, "--seed", 1, "--frames", 7, "-o",
                  self.folder, **self.environment)
        picture = self.channels("tower_fly.exr")
        self.assertGreater(max(picture["R"]), 0.1)
        self.assertEqual(picture, self.channels("tower_path_realtime_0006.exr"))
        self.assertNotEqual(picture, self.channels("tower_path_realtime_0000.exr"))

    def test_no_file_is_replaced_and_leaving_ends_it(self):
        flown = self.fly("p p k k k k 2 t h esc", 100)
        self.assertEqual(flown["frames"], 9)
        self.assertIn("steps=16", flown["settings"])
        names = {path.name for path in self.folder.iterdir()}
        self.assertEqual(names, {"tower.yaml", "tower_fly.exr", "tower_fly.png", "tower_fly_2.exr",
                                 "tower_fly_2.png", "tower_path.yaml", "tower_path_2.yaml"})

    def test_the_error_is_against_march_which_a_wipe_has_on_its_right(self):
        """Preset off, every pixel in every frame, equals the march: no error, and equal sides of
        the wipe."""
        for preset, name, is_march in (("0", "off", True), ("1", "seed", False)):
            for picture in self.folder.glob("tower_fly*"):
                picture.unlink()
            flown = self.fly(f"{preset} p c p c w x", 8)  # still converging: one ray a pixel
            self.assertEqual(flown["engine"], f"realtime {name}")
            self.assertEqual(flown["error"]["rays_per_px"], 1)
            self.assertEqual(flown["error"]["rel_bias"] == 0, is_march)
            self.assertEqual(flown["error"]["rel_rmse"] == 0, is_march)
            alone, beside = ((self.folder / name).read_bytes()
                             for name in ("tower_fly.png", "tower_fly_2.png"))
            self.assertEqual(alone == beside, is_march, preset)

    def test_static_march_against_more_rays(self):
        flown = self.fly("m x", 6)
        self.assertEqual(flown["engine"], "march")
        self.assertEqual(flown["error"]["rays_per_px"], 16)
        self.assertGreater(flown["error"]["rel_rmse"], 0)

    def test_flicker_needs_static_frames(self):
        self.assertIsNone(self.fly("1 f .*8 d", 21)["flicker"])
        flicker = self.fly("1 f", 20)["flicker"]
        self.assertEqual(flicker["frames"], 16)
        self.assertTrue(math.isfinite(flicker["a4_mean"]) and flicker["a4_mean"] > 0)

    def test_a_time_is_between_two_frames(self):
        self.assertIsNone(self.fly(".", 1)["frame_median_s"])

    def test_the_screen_shows_it_and_ctrl_c_loses_nothing(self):
        flight = self.start("fly", self.scene, "--size", SIZE, "-o", self.folder, "--keys", "k w h",
                            **self.environment)
        self.wait_until(lambda: not self.screen.is_black(), flight)
        colours = self.screen.colours()
        shown = 800 * 600 - colours[0]
        self.assertGreater(shown, 0.7 * WIDTH * HEIGHT * ZOOM**2)  # the tower is black, text dark
        self.assertGreater(len(colours), 20)
        self.assertGreater(colours.get(0xffffff, 0), 100)  # letters
        out, _ = self.interrupt(flight)
        self.assertIn("tower_path.yaml", out)
        self.neph("scenes", self.folder / "tower_path.yaml")


if __name__ == "__main__":
    unittest.main()
