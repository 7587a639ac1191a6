#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""`neph post`: display images of frames, their names, and refused arguments."""
import json
import math
import pathlib
import struct
import unittest

import frames
import neph_case
from neph_case import ROOT

WIDTH, HEIGHT = 8, 4


def reds(path):
    return frames.read_exr(path)[2]["R"]


def srgb(linear):
    return 12.92 * linear if linear <= 0.0031308 else 1.055 * linear ** (1 / 2.4) - 0.055


class Post(neph_case.NephCase):
    in_folder = True

    def setUp(self):
        super().setUp()
        self.values = [i / (WIDTH * HEIGHT) for i in range(WIDTH * HEIGHT)]
        self.frame = self.folder / "in" / "frame.0003.exr"
        self.frame.parent.mkdir()
        self.write(self.frame, self.values)

    def write(self, path, values):
        frames.grey_exr(path, WIDTH, HEIGHT, values, Z=[100.0] * len(values))

    def test_the_list_teaches_every_stage_and_setting(self):
        listed = json.loads(self.neph("post", "--list", "--json").stdout)
        names = [stage["name"] for stage in listed["stages"]]
        self.assertLess(names.index("tone mapping"), names.index("upscale"))
        settings = {setting["name"] for setting in listed["settings"]}
        for stage in listed["stages"]:
            self.assertIn(stage["setting"], settings)
        text = self.neph("post", "--list").stdout
        for word in [*names, *settings, *(preset["name"] for preset in listed["presets"])]:
            self.assertIn(word, text)

    def test_output_equals_the_display(self):
        out = self.folder / "out"
        self.neph("post", self.frame, "-s", "tone=on", "-s", "tone_map=none", "--png", "-q", "-o",
                  out)
        shown = reds(out / self.frame.name)
        for value, seen in zip(self.values, shown):
            self.assertAlmostEqual(seen, value, delta=2e-6)  # encoded and back, in float32
        codes = [round(255 * srgb(value)) for value in self.values]
        for y, row in enumerate(frames.png_rows(out / "frame.0003.png")):
            for x in range(WIDTH):
                self.assertEqual(row[3 * x], codes[y * WIDTH + x])
        self.assertEqual(list(frames.read_exr(out / self.frame.name)[2]["Z"]),
                         [100.0] * WIDTH * HEIGHT)
        # It is a display image: it can neither be mapped twice nor be compared with radiance.
        self.neph("post", out / self.frame.name, "-p", "plain", "-q", "-o", "2",
                  code=65, said="display")
        self.neph("compare", self.frame, out / self.frame.name, code=65)

    def test_sizes_and_times_are_reported(self):
        [result] = self.json("post", self.frame, "-s", "upscale=bilinear", "-s",
                             "screen_percent=50", "-o", "out")
        self.assertEqual((result["width_px"], result["height_px"]), (2 * WIDTH, 2 * HEIGHT))
        self.assertEqual([stage["name"] for stage in result["stages"]], ["upscale"])
        self.assertEqual(len(reds(self.folder / "out" / self.frame.name)),
                         4 * WIDTH * HEIGHT)

    def test_grain_depends_on_frame_and_seed(self):
        self.write(self.folder / "in" / "frame.0004.exr", self.values)
        words = ["-p", "plain", "-s", "grain=16", "-q"]
        for name, seed in (("a", 1), ("b", 1), ("c", 2)):
            self.neph("post", self.folder / "in", *words, "--seed", seed, "-o", self.folder / name)
        first, same, other = (reds(self.folder / name / "frame.0003.exr")
                              for name in "abc")
        later = reds(self.folder / "a" / "frame.0004.exr")
        self.assertEqual(first, same)
        self.assertNotEqual(first, other)
        self.assertNotEqual(first, later)

    def test_the_eye_adapts_from_frame_to_frame(self):
        """A frame 4 EV brighter than the previous one: 3 EV in a second, and no further."""
        for number, ev in ((3, 0), (4, 4), (5, 4)):
            self.write(self.folder / "in" / f"frame.000{number}.exr", [2.0 ** ev] * WIDTH * HEIGHT)
        words = ["-p", "plain", "-s", "auto_exposure=on", "-s", "adapt_near_ev=0.5", "-s",
                 "exposure_ev=-1", "--repeat", "3"]  # repetitions do not adapt the next frame
        found = self.json("post", self.folder / "in", *words, "--fps", "2", "-o", "out")
        evs = [result["adapted_ev"] for result in found]
        for seen, expected in zip(evs, (0.0, 1.5, 3.0)):
            self.assertAlmostEqual(seen, expected, places=5)
        shown = [reds(self.folder / "out" / f"frame.000{n}.exr")[0] for n in (3, 4, 5)]
        for seen, expected in zip(shown, (0.09, 0.09 * 2 ** 2.5, 0.18)):
            self.assertAlmostEqual(seen, expected, places=4)

    def test_bloom_keeps_the_light(self):
        values = [0.0] * (WIDTH * HEIGHT)
        values[5] = 32.0
        self.write(self.frame, values)
        self.neph("post", self.frame, "-s", "bloom=conserving", "-q", "-o", "out")
        spread = reds(self.folder / "out" / self.frame.name)
        self.assertAlmostEqual(sum(spread), 32.0, places=4)
        self.assertGreater(min(spread), 0.0)

    def test_hdr_output_is_light_of_its_display(self):
        values = [8.0 * v for v in self.values]  # up to 1573 cd/m^2, of which 1000 are shown
        self.write(self.frame, values)
        self.neph("post", self.frame, "-s", "tone=on", "-s", "tone_map=none", "-s", "encode=pq",
                  "--png", "-q", "-o", "out")
        for value, seen in zip(values, reds(self.folder / "out" / self.frame.name)):
            self.assertAlmostEqual(seen, min(203 * value / 1000, 1.0), delta=2e-4)
        packed = (self.folder / "out" / "frame.0003.png").read_bytes()
        self.assertEqual(packed[24], 16)
        self.assertIn(b"sBIT\x0a\x0a\x0a", packed)
        self.assertIn(b"cICP\x09\x10\x00\x01", packed)
        # With the curve for HDR displays no value clips.
        self.neph("post", self.frame, "-p", "hdr", "-q", "-o", "hdr")
        rolled = reds(self.folder / "hdr" / self.frame.name)
        self.assertTrue(all(a < b for a, b in zip(rolled, rolled[1:])))

    def test_a_png_has_the_requested_bits(self):
        for bits in (8, 10, 16):
            self.neph("post", self.frame, "-p", "plain", "--png", "--bits", bits, "-q", "-o",
                      self.folder / str(bits))
            packed = (self.folder / str(bits) / "frame.0003.png").read_bytes()
            self.assertEqual(packed[24], 8 if bits == 8 else 16)
            self.assertIn(b"sRGB", packed)

    def chain(self, text):
        path = self.folder / "chain.yaml"
        path.write_text(text)
        return path

    def test_a_chain_is_run_where_the_camera_is(self):
        """A camera moves out of a box with -1 EV, one metre per frame, over 10 m of blending."""
        scene = self.folder / "walk.yaml"
        scene.write_text("""
name: walk
title: a walk
description: none
camera:
  keys:
    - {frame: 0, position_m: [0, 1, 0], look_at_m: [100, 1, 0]}
    - {frame: 20, position_m: [20, 1, 0], look_at_m: [120, 1, 0]}
  vertical_fov_deg: 60
sun: {direction: [0, 1, 0], irradiance_w_per_m2: [1, 1, 1]}
scattering: none
media:
  - homogeneous: {extinction_per_m: 0.01, albedo: [1, 1, 1],
                  bounds: {min_m: [60, 0, 0], max_m: [70, 9, 9]}}
""")
        chain = self.chain("""
preset: plain
settings: {encode: linear}
passes: [{pass: tone_mapping}, {pass: fxaa}]
volumes:
  - name: tunnel
    blend_radius_m: 10
    box: {minimum_m: [-5, 0, -5], maximum_m: [5, 5, 5]}
    settings: {exposure_ev: -1}
""")
        self.neph("post", self.frame, "--chain", chain, code=64)  # the camera is unknown
        for number, ev in ((0, -1), (5, -1), (10, -0.5), (15, 0), (20, 0)):
            frame = self.folder / "walking" / f"frame.{number:04}.exr"
            frame.parent.mkdir(exist_ok=True)
            self.write(frame, [0.5] * WIDTH * HEIGHT)
            other = self.folder / "walking" / f"frame.{number + 1:04}.exr"
            self.write(other, [0.5] * WIDTH * HEIGHT)
            self.neph("post", frame, other, "--chain", chain, "--scene", scene, "-q", "-o",
                      "out")
            seen = reds(self.folder / "out" / frame.name)[0]
            self.assertAlmostEqual(seen, 0.5 * 2 ** ev, places=5, msg=str(number))

    WALK = """
name: walk
title: a walk
description: none
camera:
  keys:
    - {frame: 0, position_m: [0, 1, 0], look_at_m: [100, 1, 0]}
    - {frame: 2, position_m: [20, 1, 0], look_at_m: [120, 1, 0]}
  vertical_fov_deg: 60
frames: {count: 3}
background_w_per_m2_sr: [0.4, 0.4, 0.4]
scattering: none
media:
  - homogeneous: {extinction_per_m: 0.01, albedo: [1, 1, 1],
                  bounds: {min_m: [60, 0, 0], max_m: [70, 9, 9]}}
"""
    TUNNEL = """
preset: unreal
passes: [{pass: exposure}, {pass: tone_mapping}, {pass: sharpening}, {pass: upscale}]
settings: {auto_exposure: 'on', sharpen: cas%s}
volumes:
  - name: tunnel
    blend_radius_m: 10
    box: {minimum_m: [-5, 0, -5], maximum_m: [5, 5, 5]}
    settings: {exposure_ev: -1%s}
"""

    def test_a_scene_is_shown_by_its_chain(self):
        """Next to each frame the output of `neph post` for it, including camera, grain and
        adaptation."""
        self.chain(self.TUNNEL % ("", ""))
        scene = self.folder / "walk.yaml"
        scene.write_text(self.WALK + "display: {chain: chain.yaml}\n")
        words = ["-e", "march", "-s", "steps=2", "--size", "16x8", "--frames", "3", "--seed", "5"]
        found = self.json("render", scene, *words, "-o", self.folder / "shown")
        self.neph("render", scene, *words, "-q", "--chain", "off", "-o", "plain")
        self.assertFalse((self.folder / "plain" / "shown").exists())
        self.neph("post", self.folder / "plain", "--chain", self.folder / "chain.yaml", "--scene",
                  scene, "--seed", "5", "--png", "-q", "-o", "posted")
        levels = set()
        for result in found:
            picture = pathlib.Path(result["shown"])
            frame = self.folder / "plain" / picture.name
            self.assertEqual(reds(self.folder / "shown" / picture.name), reds(frame))
            posted = self.folder / "posted" / picture.name
            self.assertEqual(reds(picture), reds(posted))
            self.assertEqual(picture.with_suffix(".png").read_bytes(),
                             posted.with_suffix(".png").read_bytes())
            self.assertIn("shown_tone_mapping_gpu_ms", result["stats"])
            levels.add(round(max(reds(picture)), 3))
        self.assertEqual(len(levels), 3)  # inside, half way, outside

    def test_a_chain_that_enlarges_makes_frames_smaller(self):
        scene = self.folder / "walk.yaml"
        scene.write_text(self.WALK)
        enlarging = ", upscale: bilinear, screen_percent: 67"
        words = ["render", scene, "-s", "steps=2", "--size", "17x9", "-q", "--chain",
                 self.chain(self.TUNNEL % (enlarging, "")), "-o", "out"]
        self.neph(*words)
        name = "walk_march_0000.exr"
        self.assertEqual(frames.read_exr(self.folder / "out" / name)[:2], (12, 7))
        self.assertEqual(frames.read_exr(self.folder / "out" / "shown" / name)[:2], (17, 9))
        self.chain(self.TUNNEL % ("", enlarging))
        self.assertIn("volume 'tunnel'", self.neph(*words, code=64).stderr)
        self.chain("passes: [{pass: fxaa}]")
        self.assertIn("are off", self.neph(*words, code=64).stderr)
        scene.write_text(self.WALK + "display: {chain: none.yaml}\n")
        self.neph("render", scene, "-o", "out", code=66,
                  said=str(self.folder / "none.yaml"))

    def test_the_scene_of_the_manual(self):
        scene = ROOT / "scenes" / "studies" / "display" / "walk_out.yaml"
        [result] = self.json("render", scene, "-s", "steps=2", "--size", "25x15", "--frame", "60",
                             "-o", self.folder / "out")
        self.assertEqual(result["size_px"], [17, 11])
        self.assertEqual(frames.read_exr(pathlib.Path(result["shown"]))[:2], (25, 15))
        stages = [name for name in result["stats"] if name.startswith("shown_")]
        self.assertEqual(stages[0], "shown_light_meter_gpu_ms")
        self.assertEqual(stages[-2:], ["shown_upscale_gpu_ms", "shown_sharpening_gpu_ms"])

    def test_engines_list_the_passes_after_them(self):
        [listed] = json.loads(self.neph("engines", "realtime", "--json").stdout)
        stages = [stage["name"] for stage in listed["display_stages"]]
        chain = json.loads(self.neph("post", "--list", "--json").stdout)
        self.assertEqual(stages, [stage["name"] for stage in chain["stages"]])
        text = self.neph("engines", "realtime").stdout
        self.assertLess(text.index("anti-aliasing"), text.index("secondary upscale"))

    def test_a_chain_lists_itself_and_its_faults(self):
        chain = self.chain("passes: [{pass: upscale}, {pass: exposure, on: false},\n"
                           "         {pass: tone_mapping}]\n"
                           "preset: unreal\nsettings: {upscale: lanczos, auto_exposure: 'on'}\n")
        listed = json.loads(self.neph("post", "--list", "--chain", chain, "--json").stdout)
        self.assertEqual(listed["stages"], ["upscale", "table of colours", "tone mapping"])
        self.neph("post", "--list", "--chain", chain, "-p", "unreal", code=64)
        done = self.neph("post", self.frame, "--chain", self.chain("settings: {grain: 99}\n"),
                         code=65)
        for word in ("chain.yaml:1", "99", "0 to 64"):
            self.assertIn(word, done.stderr)

    def test_a_crop_keeps_its_attributes(self):
        rational = struct.pack("<iI", 24000, 1001)
        further = [("framesPerSecond", "rational", rational),
                   ("colorInteropID", "string", b"lin_rec709_scene"),
                   ("capDate", "string", b"2026:11:28 12:00:00"),
                   ("worldToCamera", "m44f", struct.pack("<16f", *range(16))),
                   ("a_name_of_more_than_31_characters", "v3f", struct.pack("<3f", 1, 2, 3))]

        def write(left):
            path = self.folder / f"at_{left}.exr"
            half = WIDTH * HEIGHT // 2
            channels = {c: self.values for c in "RGB"} | {
                "Z": [0.0, 1e10] * half, "A": [0.25, 0.75] * half, "id.r": [math.nan, 3.0] * half}
            path.write_bytes(frames.exr_bytes(WIDTH, HEIGHT, channels, further, pixel_aspect=2,
                                              corner=(left, 3), display=(20, 12)))
            return path

        def attribute(path, name, kind):
            data, start = path.read_bytes(), name.encode() + b"\0" + kind.encode() + b"\0"
            at = data.index(start) + len(start)
            size, = struct.unpack_from("<i", data, at)
            return data[at + 4:at + 4 + size]
        for settings, scale in ((["tone=on"], 1), (["exposure_ev=1", "upscale=bilinear",
                                                    "screen_percent=50"], 2)):
            out = self.folder / f"out{scale}"
            options = [word for setting in settings for word in ("-s", setting)]
            for left in (4, 5):
                self.neph("post", write(left), *options, "-q", "-o", out)
            made = out / "at_4.exr"
            self.assertEqual(struct.unpack("<4i", attribute(made, "dataWindow", "box2i")),
                             (4 * scale, 3 * scale, (4 + WIDTH) * scale - 1,
                              (3 + HEIGHT) * scale - 1))
            self.assertEqual(struct.unpack("<4i", attribute(made, "displayWindow", "box2i")),
                             (0, 0, 20 * scale - 1, 12 * scale - 1))
            self.assertEqual(attribute(made, "pixelAspectRatio", "float"), struct.pack("<f", 2))
            for name, kind, value in further:
                self.assertEqual(attribute(made, name, kind), value, name)
            self.assertNotIn(b"crop\0string", made.read_bytes())
            self.neph("compare", made, out / "at_5.exr", "--window", "strict", code=65,
                      said="the images differ in the place")
            self.neph("compare", made, made, "-m", "mae")
        kept = frames.read_exr(self.folder / "out1/at_4.exr")[2]
        self.assertEqual([*kept["Z"][:2], *kept["A"][:2], kept["id.r"][1]],
                         [0.0, 1e10, 0.25, 0.75, 3.0])
        self.assertTrue(math.isnan(kept["id.r"][0]))
        self.assertEqual(set(frames.read_exr(self.folder / "out2/at_4.exr")[2]), set("RGB"))
        named = self.folder / "ap1.exr"
        named.write_bytes(frames.exr_bytes(WIDTH, HEIGHT, {c: self.values for c in "RGB"},
                                           [("colorInteropID", "string", b"lin_ap1_scene")]))
        self.neph("post", named, "-s", "tone=on", "-o", "no", code=65,
                  said="lin_ap1_scene")

    def test_contradictions_are_refused(self):
        for words, said in (
                (["post", self.frame, "-s", "auto_exposure=on"], "tone is off"),
                (["post", self.frame, "-p", "plain", "-s", "auto_exposure=on", "-s",
                  "meter_low_percent=95"], "meter_high_percent"),
                (["post"], "which frames"),
                (["post", self.frame], "all stages of the chain are off"),
                (["post", self.frame, "-p", "none_such"], "unreal"),
                (["post", self.frame, "-s", "upscale=cubic"], "catmull_rom"),
                (["post", self.frame, "-p", "hdr", "--png", "--bits", "8"], "ST 2084"),
                (["post", self.frame, "-s", "sharpen=rcas"], "tone is off"),
                (["post", self.frame, "-s", "fxaa=console"], "tone=on"),
                (["post", self.frame, "-p", "plain", "-o", self.frame.parent], "over itself"),
                (["post", "--list", self.frame], "has no operands")):
            self.neph(*words, code=64, said=said)
        other = self.folder / "other" / self.frame.name
        other.parent.mkdir()
        self.write(other, self.values)
        self.neph("post", self.frame, other, "-p", "plain", "-o", "out", code=64,
                  said="both be")
        self.assertFalse((self.folder / "out").exists())


if __name__ == "__main__":
    unittest.main()
