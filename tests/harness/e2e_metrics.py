#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""`neph compare`, `neph flicker` and `neph metrics` as a user of another renderer runs them."""
import csv
import json
import math
import random
import signal
import struct
import subprocess
import time
import unittest

import frames
import neph_case
import night

NEPH = neph_case.NEPH
WIDTH, HEIGHT = 64, 48
INF = math.inf


def values_of(document, **only):
    """{(metric, mask): value} of all frames, or of the only frame."""
    rows = document["measurements"]
    overall = [row for row in rows if "frame" not in row] or rows
    return {(row["metric"], row["mask"]): row["value"] for row in overall
            if all(row[key] == value for key, value in only.items())}


class Metrics(neph_case.NephCase):
    def write(self, name, value_at, depth_at=None, width=WIDTH, height=HEIGHT):
        path = self.folder / name
        path.parent.mkdir(exist_ok=True)
        places = [(x, y) for y in range(height) for x in range(width)]
        further = {"Z": [depth_at(x, y) for x, y in places]} if depth_at else {}
        frames.grey_exr(path, width, height, [value_at(x, y) for x, y in places], **further)
        return path

    # ---- compare -----------------------------------------------------------------------------

    def test_error_by_hand_in_json_csv_and_maps(self):
        reference = self.write("reference.exr", lambda x, y: 1.0)
        test = self.write("test.exr", lambda x, y: 1.25 if x < 16 else 1.0)
        found = self.json("compare", reference, test, "--csv", self.folder / "out.csv", "--maps",
                          self.folder / "maps", "--metric", "error")
        values = values_of(found, quantity="radiance")
        self.assertAlmostEqual(values["mae", "all"], 0.0625, delta=1e-15)
        self.assertAlmostEqual(values["rmse", "all"], 0.125, delta=1e-15)
        # 1 + (0.01)^2
        self.assertAlmostEqual(values["rel_mse", "all"], 0.015625 / 1.0001, delta=1e-8)
        with (self.folder / "out.csv").open() as file:
            rows = list(csv.DictReader(file))
        row = next(row for row in rows if row["metric"] == "rmse")
        self.assertEqual((float(row["value"]), int(row["pixel_count"])), (0.125, WIDTH * HEIGHT))
        text = self.neph("compare", reference, test, "--csv", "-", "--metric", "error").stdout
        self.assertEqual(text, (self.folder / "out.csv").read_text())
        self.neph("compare", reference, test, "--csv", "-", "--json", code=64)
        maps = {path.name for path in (self.folder / "maps").iterdir()}
        self.assertLessEqual({"difference_radiance.exr", "difference_radiance.png"}, maps)

    def test_every_record_has_its_format(self):
        reference = self.write("reference.exr", lambda x, y: 1 + x / WIDTH,
                               lambda x, y: 2.0 if x < 20 else INF)
        test = self.write("test.exr", lambda x, y: 1 + x / WIDTH + 0.01 * (y % 3),
                          lambda x, y: 2.0 if x < 20 else INF)
        found = self.json("compare", reference, test, "--fps", 30, "--ppd", 40, "--exposure", -1)
        rows = found["measurements"]
        self.assertGreater(len(rows), 50)
        for row in rows:
            self.assertEqual(row["viewing"], {"frame_rate_hz": 30.0, "pixels_per_degree": 40.0,
                                              "exposure_ev": -1.0, "white_cd_per_m2": 100.0})
            for key in ("unit", "mask", "pixel_count", "n", "interval_kind"):
                self.assertIsNotNone(row[key], row)
            self.assertTrue(row["value"] is not None or row.get("undefined_because"), row)
            if row["interval"]:
                self.assertTrue(row["interval"][0] <= row["value"] <= row["interval"][1], row)

    def test_bad_frames_are_refused_before_any_number(self):
        good = self.write("good.exr", lambda x, y: 1.0)
        for name, value, code in (("nan.exr", math.nan, 1), ("negative.exr", -0.5, 1)):
            bad = self.write(name, lambda x, y: value if (x, y) == (5, 7) else 1.0)
            for pair in ((good, bad), (bad, good)):
                self.neph("compare", *pair, "--json", code=code, said=(name, "(5, 7)"), silent=True)
        small = self.write("small.exr", lambda x, y: 1.0, width=8, height=8)
        self.neph("compare", good, small, code=65, said="64x48")
        self.neph("compare", self.folder / "no_baseline.exr", good, code=66)
        (self.folder / "noise.exr").write_bytes(bytes(range(256)))
        self.neph("compare", self.folder / "noise.exr", good, code=65)

    def test_metrics_of_sequences_hide_nothing_of_a_single_frame(self):
        reference = self.write("reference.exr", lambda x, y: 1.0)
        test = self.write("test.exr", lambda x, y: 1.25)
        done = self.neph("compare", reference, test, "-m", "mae", "-m", "residual_change",
                         "--all")
        rows = {line.split()[2]: line.split()[3]
                for line in done.stdout.splitlines() if line.startswith("radiance")}
        self.assertEqual((rows.get("mae"), rows.get("residual_change_rms")),
                         ("2.500000e-01", "undefined"), done.stdout)

    def test_conventions_are_selectable(self):
        for name, words in (("motion", ("motion.x, motion.y", "minus its", "y down")),
                            ("lag", ("last crossing", "logarithm")),
                            ("flicker", ("2 / N", "d: luma")),
                            ("seen", ("0.5^(R^2)", "below 0.5 Hz"))):
            text = self.neph("metrics", name).stdout
            document = self.json("metrics", name)
            for word in words:
                self.assertIn(word, text)
                self.assertIn(word, json.dumps(document))

    def test_limits(self):
        reference = self.write("reference.exr", lambda x, y: 1.0)
        test = self.write("test.exr", lambda x, y: 1.25)
        for limit, code in (("rmse=0.3", 0), ("rmse=0.2", 1), ("radiance:rmse@all=0.2", 1),
                            ("depth:rmse=1", 2),
                            ("rmse=x", 64), ("beauty=1", 64), ("rmse@nowhere=1", 2)):
            self.neph("compare", reference, test, "--fail-above", limit, code=code)
        self.neph("compare", reference, test, "--fail-below", "rmse=0.3", code=1)

    def test_a_limit_has_its_metric_measured_and_names_the_worst_frame(self):
        reference = self.write("reference.exr", lambda x, y: 0.5,
                               lambda x, y: 1.0 if x < 32 else 4.0)
        for frame, value in enumerate((0.55, 0.9, 0.6)):
            self.write(f"test/f.{frame}.exr", lambda x, y: value)
        self.neph("compare", reference, self.folder / "test", "--metric", "mae", "--fail-above",
                  "flip_mean=1e-6", code=1, said=("in frame 1", "worst of 4"))
        self.neph("compare", reference, self.folder / "test", "--fail-above", "mae@edge_near_1=1")

    def test_versus_of_flicker_says_how_sure_it_is(self):
        reference = self.write("reference.exr", lambda x, y: 0.5)
        draw = random.Random(20261122)
        for name, height in (("strong", 0.2), ("weak", 0.1), ("twin", 0.2)):
            for frame in range(16):
                self.write(f"{name}/f.{frame:02}.exr", lambda x, y: 0.5 + height *
                           (frame % 4 == 0) + 0.001 * (frame % 3) + draw.gauss(0, 1e-3))
        run = ("flicker", "-r", reference, self.folder / "strong", "-m", "a4_p95", "--mask", "all",
               "--versus")
        row, = self.json(*run, self.folder / "weak")["versus"]
        self.assertEqual((row["metric"], row["interval_kind"], row["n"]),
                         ("a4_p95", "bootstrap over tiles", 192))
        self.assertLess(row["interval"][0], row["difference"])
        self.assertLess(row["difference"], row["interval"][1])
        self.assertLess(row["p_holm"], 1e-6)
        encoded = [1.055 * v ** (1 / 2.4) - 0.055 for v in (0.7, 0.6)]
        self.assertAlmostEqual(row["difference"], (encoded[0] - encoded[1]) / 2, delta=2e-3)
        row, = self.json(*run, self.folder / "twin")["versus"]
        self.assertTrue(row["interval"][0] < 0 < row["interval"][1] and row["p"] > 0.01, row)
        text = self.neph("compare", reference, self.folder / "strong", "-m", "mae", "--versus",
                         self.folder / "weak").stdout
        self.assertRegex(text, r"^strong: mae 0.05.*, weak: 0.02.*; not told apart, lower in \d+ "
                               r"of 16 frames \(16 frames are too few: intervals and p-values")
        text = self.neph("compare", reference, self.folder / "strong/f.04.exr", "-m", "mae",
                         "--versus", self.folder / "weak/f.04.exr").stdout
        self.assertRegex(text, "^strong: mae .*, weak: .*; worse, p < 0.001\n")
        self.neph(*run, self.folder / "nowhere", code=66, silent=True)

    def test_the_answer_comes_first_and_is_short(self):
        reference = self.write("reference.exr", lambda x, y: 1.0)
        test = self.write("test.exr", lambda x, y: 1.25)
        error = "radiance is off by 25 % (RMSE over the mean of the reference), in the mean 25 % " \
                "too bright"
        lines = self.neph("compare", reference, test).stdout.splitlines()
        self.assertEqual(lines[0], error)
        self.assertTrue(len(lines) <= 10 and "--all" in lines[-1], lines)
        self.assertEqual(self.neph("compare", reference, test, "-q").stdout, error + "\n")
        limits = ("--fail-above", "rmse=0.3", "--fail-below", "rmse=0.3")
        lines = self.neph("compare", reference, test, *limits, code=1).stdout.splitlines()
        self.assertEqual(lines[:3], ["PASS rmse 0.25 <= 0.3", "FAIL rmse 0.25 < 0.3", error])
        self.assertLessEqual(len(lines), 10)
        self.assertIn("PASS pu_psnr: the images are equal",
                      self.neph("compare", test, test, "--fail-below", "pu_psnr=40", "-q").stdout)
        table = self.neph("compare", reference, test, "--all").stdout
        self.assertGreater(len(table.splitlines()), 20)
        self.assertRegex(table, r"radiance +all +rel_rmse +2.5000")

    def test_better_and_worse_go_by_the_metric(self):
        # Noise in each pixel, twice as strong in one test: tiles distinguish the two.
        draw = random.Random(42)
        grain = [[draw.gauss(0, 1) for _ in range(WIDTH)] for _ in range(HEIGHT)]
        reference = self.write("reference.exr", lambda x, y: 1.0)
        weak, strong = (self.write(f"{name}.exr", lambda x, y: 1.0 + part * grain[y][x])
                        for name, part in (("weak", 0.02), ("strong", 0.04)))
        for metric in ("rel_rmse", "pu_psnr"):  # smaller is better, larger is better
            for test, other, word in ((weak, strong, "better"), (strong, weak, "worse")):
                text = self.neph("compare", reference, test, "--versus", other, "-m", metric,
                                 "-q").stdout
                self.assertRegex(text, rf"^{test.name}: {metric} [0-9.]+.*, {other.name}: [0-9.]+"
                                       rf"( dB)?; {word}, p < 0.001\n$")
        # No direction: a shift's gain is neither good nor bad.
        text = self.neph("compare", reference, weak, "--versus", strong, "-m", "shift_gain",
                         "-q").stdout
        self.assertRegex(text, "^weak.exr: shift_gain .*; (higher|lower|equal|not told apart)")
        text = self.neph("compare", reference, weak, "--versus", weak, "-m", "mae", "-q").stdout
        self.assertRegex(text, "^test: mae .*, other: .*; equal\n$")

    def test_names_of_masks_and_units_in_csv(self):
        layers = {channel: [0.5] * 256 for channel in "RGB"}
        path = self.folder / "mask.exr"
        path.write_bytes(frames.exr_bytes(16, 16,
                                          {**layers, 'mask.a,"b"': [1.0] * 8 + [0.0] * 248}))
        self.neph("compare", path, path, "-m", "ms_ssim", "-m", "mae", "--csv",
                  self.folder / "a.csv")
        with open(self.folder / "a.csv", newline="") as file:
            rows = {(row["metric"], row["mask"]): row for row in csv.DictReader(file)}
        self.assertEqual(rows["mae", 'a,"b"']["pixel_count"], "8")
        self.assertIn("176 px", rows["ms_ssim", "all"]["undefined_because"])
        picture = self.folder / "a.png"
        picture.write_bytes(frames.png_bytes(4, 4, [100] * 48))
        found = self.json("compare", picture, picture, "-m", "mae")
        units = {row["unit"] for row in found["measurements"]}
        self.assertEqual(units, {"display value"})

    def test_no_error_at_all_keeps_a_limit_on_psnr(self):
        same = self.write("same.exr", lambda x, y: 0.5)
        for limit, code in (("pu_psnr=40", 0), ("ms_ssim=0.9", 1)):
            self.neph("compare", same, same, "--metric", "pu_psnr", "--fail-below", limit,
                      code=code)

    def test_clipped_pixels_are_reported(self):
        half = self.write("half.exr", lambda x, y: 1.5 if x < WIDTH // 2 else 0.5)
        quarter = self.write("quarter.exr", lambda x, y: 2.5 if x < WIDTH // 4 else 0.5)
        done = self.neph("compare", half, quarter, "-m", "flip")
        self.assertIn(
            "50 % of the pixels of the reference and 25 % of the test's are above display white",
            done.stdout)
        document = self.json("compare", half, quarter, "-m", "flip", "-m", "mae")
        found, = (row for row in document["findings"] if row["finding"] == "clipped")
        self.assertEqual(found["clipped"],
                         {"above": "display white", "reference": 0.5, "test": 0.25})
        clipped = {row["metric"]: row.get("clipped")
                   for row in document["measurements"]}
        self.assertEqual((clipped["flip_p95"], clipped["mae"]), (found["clipped"], None))
        self.assertNotIn("above display white",
                         self.neph("compare", half, quarter, "-m", "flip", "--exposure", -2).stdout)
        sun, brighter = self.write("sun.exr", lambda x, y: 500.0), self.write("brighter.exr",
                                                                              lambda x, y: 800.0)
        done = self.neph("compare", sun, brighter, "-m", "pu_psnr", "--fail-below", "pu_psnr=40",
                         code=1)
        self.assertNotIn("no error at all", done.stdout)
        self.assertIn("are above 10000 cd/m2", done.stdout)

    def test_a_half_life_that_is_cut_short_keeps_no_limit(self):
        for frame in range(8):
            self.write(f"lights/f.{frame}.exr", lambda x, y: 0.5 + 0.5 * (frame >= 4))
            self.write(f"stuck/f.{frame}.exr", lambda x, y: 0.5 + 0.001 * frame)
            self.write(f"prompt/f.{frame}.exr",
                       lambda x, y: 0.5 + 0.5 * (frame >= 4) + 0.001 * (frame % 2))
        for test, code in (("stuck", 1), ("prompt", 0)):
            done = self.neph("flicker", "-r", self.folder / "lights", self.folder / test, "-m",
                             "lag", "-s", "lag:step_frame=4", "--fail-above", "half_life_p50=20",
                             code=code)
            self.assertEqual("at least 4" in done.stderr, code == 1, done.stderr)

    def test_crops_of_different_places_are_not_compared(self):
        whole = self.write("whole.exr", lambda x, y: 0.5)
        data = bytearray(whole.read_bytes())
        display = data.index(b"displayWindow\0box2i\0") + len("displayWindow.box2i.") + 4
        data[display + 8] = 2 * WIDTH - 1
        crop = self.folder / "crop.exr"
        crop.write_bytes(data)
        self.neph("compare", whole, crop, code=65, said=f"{2 * WIDTH}x{HEIGHT} in '{crop}'")
        self.neph("compare", crop, crop, "-m", "mae")

    def test_a_comparison_of_nothing_is_an_error(self):
        def write(name, *channels):
            path = self.folder / name
            path.write_bytes(frames.exr_bytes(4, 4, {channel: [0.5] * 16 for channel in channels}))
            return path
        rgb, grey, other = write("rgb.exr", "R", "G",
                                 "B"), write("grey.exr", "Y"), write("other.exr", "left.R", "u")
        for first, second in ((rgb, other), (other, rgb), (other, other)):
            self.neph("compare", first, second, code=65, said="left.R u", silent=True)
        found = self.json("compare", rgb, grey, "--metric", "mae")
        self.assertEqual(values_of(found), {("mae", "all"): 0.0})
        dark = self.folder / "dark.exr"
        dark.write_bytes(frames.exr_bytes(4, 4, {"Y": [-0.5] * 16}))
        self.neph("compare", dark, dark, code=1, said="--negative-ok", silent=True)
        self.neph("compare", rgb, grey, "--mask", "skyy", code=2,
                  said="masks of this reference: all;", silent=True)
        empty = self.write("empty.exr", lambda x, y: 0.0, width=4, height=4)
        self.neph("compare", rgb, grey, "--mask", empty, code=65)

    def test_images_are_decoded_from_srgb(self):
        for name, code in (("a.png", 0), ("b.png", 188)):
            (self.folder / name).write_bytes(frames.png_bytes(8, 8, [code] * 192))
        found = self.json("compare", self.folder / "a.png", self.folder / "b.png", "--metric",
                          "mae")
        linear = ((188 / 255 + 0.055) / 1.055) ** 2.4
        self.assertAlmostEqual(values_of(found)["mae", "all"], linear, delta=1e-7)
        self.neph("compare", self.folder / "a.png",
                  self.write("a.exr", lambda x, y: 1.0, width=8, height=8), code=65)
        self.neph("compare", self.folder / "a.png", self.folder / "b.png", "--exposure", 1, code=65)

    def test_a_mask_of_the_users(self):
        reference = self.write("reference.exr", lambda x, y: 1.0)
        test = self.write("test.exr", lambda x, y: 2.0 if x < 8 else 1.0)
        mask = self.write("mask.exr", lambda x, y: 1.0 if x < 16 else 0.0)
        found = self.json("compare", reference, test, "--mask", mask, "--metric", "mae")
        self.assertEqual(values_of(found), {("mae", "file"): 0.5})
        self.assertEqual(found["measurements"][0]["pixel_count"], 16 * HEIGHT)

    def test_a_layer_of_a_multilayer_file(self):
        def multilayer(name, value):
            path, count = self.folder / name, WIDTH * HEIGHT
            path.write_bytes(frames.exr_bytes(WIDTH, HEIGHT, {
                "R": [9.0] * count,
                **{f"ViewLayer.Combined.{c}": [value] * count for c in "RGBA"}}))
            return path
        pair = multilayer("a.exr", 1.0), multilayer("b.exr", 1.5)
        found = self.json("compare", *pair, "--layer", "ViewLayer.Combined", "-m", "mae")
        self.assertEqual(values_of(found)["mae", "all"], 0.5)
        self.neph("compare", *pair, "--layer", "Combined", code=65, said="ViewLayer.Combined")

    def test_other_names_of_channels(self):
        def write(name, value, names, *further):
            (self.folder / name).write_bytes(frames.exr_bytes(
                8, 8, {channel: [value] * 64 for channel in (*names, *further)}, long_names=True))
            return self.folder / name
        plain, long_name = write("plain.exr", 1.0, "RGB"), "light_path_" * 23 + "A"
        for names in ("rgb", ("red", "green", "blue"), ("rgba.R", "rgba.G", "rgba.B"), "L", "R"):
            test = write("test.exr", 1.25, names, long_name)
            found = self.json("compare", "-r", plain, test, "-m", "mae")
            self.assertEqual(values_of(found)["mae", "all"], 0.25, names)
        self.assertIn(long_name, self.neph("compare", "-r", plain, test, "--all").stdout)

    def test_parts_of_a_file(self):
        def grey(value, *further):
            return {name: [value] * (8 * 8) for name in ("R", "G", "B", *further)}

        def write(name, **parts):
            (self.folder / name).write_bytes(frames.multipart_exr_bytes(8, 8, parts))
            return self.folder / name
        plain = self.write("plain.exr", lambda x, y: 1.0, width=8, height=8)
        one = write("one.exr", beauty=grey(1.25))
        depth = write("depth.exr", depth={"Z": [2.0] * 64}, beauty=grey(1.5))
        eyes = write("eyes.exr", left=grey(2.0), right=grey(3.0, "A"))
        for words, expected in (((one,), 0.25), ((depth,), 0.5), ((eyes, "--part", "left"), 1.0),
                                ((eyes, "--part", 1), 2.0)):
            found = self.json("compare", "-r", plain, *words, "-m", "mae")
            self.assertEqual(values_of(found)["mae", "all"], expected, words)
        said = self.neph("compare", "-r", plain, eyes, code=65).stderr
        for words in ("eyes.exr' has more than one flat part with colour: 0 left (scanlineimage: B "
                      "G R), 1 right (scanlineimage: A B G R)", "--part NAME"):
            self.assertIn(words, said)
        self.neph("compare", "-r", plain, eyes, "--part", "up", code=65, said="no part 'up'")
        self.neph("view", plain, eyes, "-o", self.folder / "page", code=65, said="1 right")
        self.neph("view", plain, eyes, "--part", "right", "-o", self.folder / "page")
        self.neph("post", eyes, "--part", "right", "-s", "tone=on", "-q",
                  "-o", self.folder / "shown")

    def test_colour_metadata_of_files_is_used(self):
        def write(name, channels="RGB", **rest):
            (self.folder / name).write_bytes(
                frames.exr_bytes(4, 4, {channel: [0.5] * 16 for channel in channels}, **rest))
            return self.folder / name
        ap1 = struct.pack("<8f", .713, .293, .165, .83, .128, .044, .32168, .33767)
        rec709 = struct.pack("<8f", .64, .33, .3, .6, .15, .06, .3127, .329)
        plain, wide, alpha = write("plain.exr"), write("wide.exr",
                                                       pixel_aspect=2), write("alpha.exr", "RGBA")
        aces = write("aces.exr", attributes=[("chromaticities", "chromaticities", ap1)])
        named = write("named.exr", attributes=[("chromaticities", "chromaticities", rec709),
                                               ("encoding", "string", b"linear")])
        for pair in ((plain, aces), (aces, plain), (aces, aces)):
            self.neph("compare", *pair, code=65, said="red (0.713, 0.293)", silent=True)
        # a text attribute does not mark a display image
        done = self.neph("compare", plain, named, "--exposure", 1, "-m", "mae")
        self.assertNotIn("alpha", done.stdout)
        self.neph("compare", plain, wide, code=65,
                  said="pixel aspect ratio of the reference is 1, of the other image 2")
        self.assertIn("pixels are taken for square",
                      self.neph("compare", wide, wide, "-m", "mae").stdout)
        for pair in ((plain, alpha), (alpha, plain)):
            self.assertIn("not measured: alpha",
                          self.neph("compare", *pair, "-m", "mae").stdout)
        (self.folder / "some").mkdir()
        for frame in range(3):  # the middle frame has alpha
            write(f"some/f{frame}.exr", "RGBA" if frame == 1 else "RGB")
        self.assertIn("not measured: alpha",
                      self.neph("compare", plain, self.folder / "some", "-m", "mae").stdout)
        layers = write("layers.exr", ["R", "G", "B", "right.R", "depth.Z"])
        self.assertIn("not measured: channels depth.Z right.R: ",
                      self.neph("compare", layers, layers, "-m", "mae").stdout)

    def rgb(self, name, value=0.5, attributes=(), channels="RGB", **rest):
        path = self.folder / name
        path.parent.mkdir(exist_ok=True)
        path.write_bytes(frames.exr_bytes(4, 4, {channel: [value] * 16 for channel in channels},
                                          attributes, **rest))
        return path

    def test_colours_of_another_name_are_not_compared(self):
        def named(name, text, attribute="colorInteropID"):
            return self.rgb(f"{name}.exr", attributes=[(attribute, "string", text.encode())])
        plain, ap1 = self.rgb("plain.exr"), named("ap1", "lin_ap1_scene")
        codes = named("codes", "srgb_rec709_display")
        acescg = named("acescg", "ACEScg", "oiio:ColorSpace")
        white = struct.pack("<f", 203.0)
        bright = self.rgb("bright.exr", attributes=[("whiteLuminance", "float", white)])
        for pair, words in (((plain, ap1), ("lin_rec709_scene", "lin_ap1_scene")),
                            ((codes, plain), ("srgb_rec709_display", "lin_rec709_scene")),
                            ((ap1, codes), ("lin_ap1_scene", "srgb_rec709_display")),
                            ((plain, acescg), ("lin_rec709_scene", "lin_ap1_scene")),
                            ((plain, bright), ("whiteLuminance", "not said", "203"))):
            done = self.neph("compare", *pair, code=65, silent=True)
            for word in (*words, "hint:", pair[1].name):
                self.assertIn(word, done.stderr)
        for pair in ((ap1, acescg), (bright, bright),
                     (plain, named("linear", "Linear", "oiio:ColorSpace")),
                     (plain, named("same", "lin_rec709_scene"))):
            self.neph("compare", *pair, "-m", "mae")
        self.neph("view", plain, ap1, "-o", self.folder / "page", code=65, said="lin_ap1_scene")
        depths = [self.rgb(f"depth{i}.exr", channels="Z", attributes=text) for i, text in enumerate(
            ([], [("colorInteropID", "string", b"lin_ap1_scene")]))]
        self.neph("compare", *depths, "-m", "mae")  # no colours

    def test_the_sky_of_other_renderers(self):
        def write(name, near, far):
            return self.write(name, lambda x, y: 0.5, lambda x, y: near if x < 16 else far,
                              width=32, height=8)
        for far in (0.0, 65504.0, 65535.0, 1e9, 1e10, INF):
            found = self.json("compare", write("reference.exr", 5.0, far),
                              write("test.exr", 5.5, INF), "-m", "mae")
            rows = {(row["quantity"], row["mask"]): row for row in found["measurements"]}
            depth, sky = rows["depth", "all"], rows["radiance", "sky"]
            self.assertEqual((depth["value"], depth["pixel_count"], sky["pixel_count"]),
                             (0.5, 128, 128), far)

    def test_the_frame_rate_of_other_renderers(self):
        noise = self.noise(0.01)
        rate = [("framesPerSecond", "rational", struct.pack("<iI", 24000, 1001))]
        for frame in range(16):
            self.rgb(f"test/f{frame}.exr", 0.5 + noise(), rate)
        still = self.rgb("still.exr", attributes=rate)
        plain = self.rgb("plain.exr")
        for reference, words in ((plain, ()), (still, ()), (plain, ("--fps", 24000 / 1001))):
            done = self.neph("flicker", "-r", reference, self.folder / "test", "-m", "seen", *words)
            self.assertIn("23.976 frames a second", done.stdout)
        self.neph("view", plain, self.folder / "test", "-o", self.folder / "page")
        page = json.loads((self.folder / "page/data.json").read_text())
        self.assertAlmostEqual(page["rate_hz"], 24000 / 1001, delta=1e-9)  # 15 digits

    def test_incomplete_animations_are_refused(self):
        def write(name, *further):
            (self.folder / name).write_bytes(frames.png_bytes(8, 8, [90] * 192, *further))
            return self.folder / name

        def animated(count):
            return (b"acTL", struct.pack(">II", count, 0))
        control = (b"fcTL", struct.pack(">5I2H2B", 0, 8, 8, 0, 0, 1, 30, 0, 0))
        still = write("still.png")
        second = [(b"fdAT", struct.pack(">I", 1) + b"...")]
        for name, before, behind, code, words in (
                ("two.png", [animated(2), control], second, 65, "declares 2 frames and has 1"),
                ("beside.png", [animated(1)], [control, *second], 65, "has 2 frames"),
                ("one.png", [animated(1), control], [], 0, "")):
            self.neph("compare", still, write(name, before, behind), "-m", "mae", code=code,
                      said=words)

    def test_changing_sequences_are_refused(self):
        def sequence(name, odd, **usual):
            for frame in range(4):
                self.rgb(f"{name}/f{frame}.exr", 0.5 + 0.01 * frame,
                         **(odd if frame == 2 else usual))
            return self.folder / name
        space = [("colorInteropID", "string", b"lin_ap1_scene")]
        for name, odd, usual, words in (
                ("window", {"corner": (2, 1), "display": (8, 8)},
                 {"corner": (1, 1), "display": (8, 8)}, ("(1, 1) of 8x8", "(2, 1) of 8x8")),
                ("channels", {}, {"channels": "RGBZ"}, ("f0.exr' has Z", "f2.exr' has not")),
                ("more", {"channels": "RGBZ"}, {}, ("f2.exr' has Z", "f0.exr' has not")),
                ("space", {"attributes": space}, {}, ("lin_rec709_scene", "lin_ap1_scene")),
                ("pixels", {"pixel_aspect": 2}, {}, ("pixel aspect ratio changes",))):
            folder = sequence(name, odd, **usual)
            for verb in ("compare", "flicker"):
                pair = (folder, folder) if verb == "compare" else ("-r", folder, folder)
                done = self.neph(verb, *pair, "-q", "--window", "strict", code=65, silent=True)
                for word in (*words, "hint:"):
                    self.assertIn(word, done.stderr)
                self.assertNotIn("mask", done.stderr)
        masks = sequence("masks", {"channels": ("R", "G", "B", "mask.sun")})
        self.neph("compare", masks, masks, "-m", "mae")
        for frame in range(2):  # reference and test are cropped alike
            (self.folder / "cut").mkdir(exist_ok=True)
            (self.folder / f"cut/f{frame}.exr").write_bytes(frames.exr_bytes(
                4 - frame, 4, {c: [0.5] * (16 - 4 * frame) for c in "RGB"}, display=(8, 8)))
        self.neph("compare", self.folder / "cut", self.folder / "cut", "--window", "strict",
                  code=65, said=("the size changes: it is 4x4 pixels",
                                 "data windows equal to the display window"))

    def test_extra_channels_are_not_gated(self):
        count = WIDTH * HEIGHT
        path = self.folder / "crypto.exr"
        path.write_bytes(frames.exr_bytes(WIDTH, HEIGHT, {**{c: [1.0] * count for c in "RGB"},
                                                          "crypto00.r": [math.nan] * count}))
        found = self.json("compare", path, path, "-m", "mae")
        self.assertEqual(values_of(found)["mae", "all"], 0.0)

    def test_layers_of_only_one_image_are_named(self):
        with_depth = self.write("depth.exr", lambda x, y: 1.0, self.depth)
        without = self.write("plain.exr", lambda x, y: 1.0)
        done = self.neph("compare", with_depth, without, "-m", "rmse")
        self.assertIn("not measured: depth: the test does not have it", done.stdout)
        only_depth = self.folder / "only_depth.exr"
        only_depth.write_bytes(frames.exr_bytes(WIDTH, HEIGHT, {"Z": [1.0] * (WIDTH * HEIGHT)}))
        self.neph("compare", with_depth, only_depth, code=65, said="radiance")

    # ---- flicker -----------------------------------------------------------------------------

    def depth(self, x, y):
        """Bars one pixel wide in front of the sky."""
        return 2.0 if x % 16 == 3 else INF

    def still(self, x, y):
        return 0.2 if x % 16 == 3 else 0.5

    def sequence(self, name, value_at, count=128):
        for t in range(count):
            self.write(f"{name}/frame.{t:04d}.exr", lambda x, y: value_at(x, y, t), self.depth)
        return self.folder / name

    def flicker(self, test, *options):
        reference = self.write("reference.exr", self.still, self.depth)
        found = self.json("flicker", "--reference", reference, test, *options)
        verdicts = {(row["finding"], row["mask"]): row["verdict"]
                    for row in found["findings"]}
        return values_of(found), verdicts

    def noise(self, sigma):
        """Weak noise, independent in every pixel of every frame."""
        draw = random.Random(20261121)
        return lambda: draw.gauss(0.0, sigma)

    def test_a_cycle_of_seven_is_seen(self):
        """At the rate of the frames, unless the user sets another."""
        for t in range(84):
            light = 0.5 + 0.05 * math.cos(2 * math.pi * t / 7 + 1)
            told = [("neph.frame_rate_hz", "string", b"42")]
            (self.folder / f"seven.{t:04d}.exr").write_bytes(
                frames.exr_bytes(32, 16, {"Y": [light] * 512}, attributes=told))
        still = self.folder / "still.exr"
        still.write_bytes(frames.exr_bytes(32, 16, {"Y": [0.5] * 512}))
        for options, rate in (((), 42), (("--fps", "24"), 24)):
            done = self.neph("flicker", "-r", still, self.folder / "seven.*.exr", "-m", "seen",
                             *options)
            self.assertIn(f"display: {rate} frames a second, 67.0206 pixels per degree, 0 EV, "
                          f"white 100 cd/m2, dark surround", done.stdout)
            self.assertRegex(
                done.stdout,
                rf"flicker: seen: seen by most in 100 % of .* at {rate / 7:.2g} Hz "
                r"\(period 7 frames\)")

    def test_a_blinking_fence_is_cyclic_at_edges(self):
        noise = self.noise(1e-5)

        def blink(x, y, t):
            return self.still(x, y) + noise() + (0.3 if (x, y % 8, t % 4) == (35, 0, 0) else 0.0)
        values, verdicts = self.flicker(self.sequence("blink", blink))  # 6 of 3072 pixels
        self.assertEqual(verdicts["flicker", "depth_edge"], "cyclic")
        self.assertEqual(verdicts["flicker", "non_edge"], "calm")
        self.assertEqual(verdicts["half_life", "all"], "not measured")
        self.assertAlmostEqual(values["cyclic_share", "all"], 6 / (WIDTH * HEIGHT), delta=1e-12)

    def test_the_floor_of_the_edge_ratio_is_named(self):
        """Twice the contrast at bars; first far below the visible threshold, then 100 times as
        strong."""
        noise = self.noise(1e-7)
        still = self.write("reference.exr", self.still, self.depth)
        for scale, floored in ((1, True), (100, False)):
            test = self.sequence("test", lambda x, y, t: self.still(x, y) * (1 + scale * (
                2e-4 if self.depth(x, y) < INF else 1e-4) * math.cos(math.pi * t / 2)) + noise(),
                                 32)
            document = self.json("flicker", "--reference", still, test, "-m", "flicker")
            found = next(row for row in document["findings"]
                         if row["finding"] == "edge_ratio")
            self.assertEqual(("quarter of a step" in found["text"],
                              "times as strong" in found["text"]), (floored, not floored), found)

    def test_noise_of_equal_energy_is_restless(self):
        noise = self.noise(0.02)
        _, verdicts = self.flicker(self.sequence("noise",
                                                 lambda x, y, t: self.still(x, y) + noise()))
        self.assertEqual({verdicts["flicker", mask] for mask in ("all", "depth_edge", "non_edge")},
                         {"restless"})

    def test_a_fade_is_calm(self):
        noise = self.noise(1e-6)
        _, verdicts = self.flicker(
            self.sequence("fade", lambda x, y, t: self.still(x, y) * (1 - t / 256) + noise()))
        self.assertEqual({verdicts["flicker", mask] for mask in ("all", "depth_edge", "non_edge")},
                         {"calm"})

    def test_a_declared_cycle_of_seven_frames(self):
        """In uniform grey 0.5 a pulse of 1 % in one of seven frames: 0.01 sqrt(6) / 7 of the step
        of its luma."""
        noise, pulse = self.noise(1e-6), (1.055 * 0.505 ** (1 / 2.4)) - (1.055 * 0.5 ** (1 / 2.4))
        test = self.sequence("test", lambda x, y, t: 0.5 + (0.005 if t % 7 == 0 else 0.0) + noise(),
                             64)
        declared = {name: [0.505 + noise() for _ in range(WIDTH * HEIGHT)] for name in "RGB"}
        declared["Z"] = [self.depth(x, y) for y in range(HEIGHT) for x in range(WIDTH)]
        (test / "frame.0000.exr").write_bytes(
            frames.exr_bytes(WIDTH, HEIGHT, declared,
                             attributes=[("neph.cycles", "string", b"slot 4, TAA jitter 7")]))
        document = self.json("flicker", "-r", self.write("still.exr", lambda x, y: 0.5), test, "-m",
                             "cycles", "--mask", "all", "--fps", 30)
        values = values_of(document)
        self.assertAlmostEqual(values["cycle_7", "all"], pulse * math.sqrt(6) / 7, delta=1e-7)
        texts = [row["text"] for row in document["findings"] if row["finding"] == "cycle"]
        self.assertEqual([text.split(":")[0] for text in texts],
                         ["period 7 frames (4.29 Hz at 30 fps, TAA jitter)"])
        reasons = {row["metric"]: row["undefined_because"]
                   for row in document["measurements"] if row["value"] is None}
        self.assertIn("not above the noise floor", reasons["cycle_8"])
        self.assertIn("longer than an eighth of the frames", reasons["cycle_9"])

    def test_amplitude_of_linear_light_by_hand(self):
        """Luma of 0.5 +- 1 % in frames 0 and 2 of each period: four-frame flicker of the display's
        luma."""
        def srgb(v):
            return 1.055 * v ** (1 / 2.4) - 0.055
        wave = (0.01, 0.0, -0.01, 0.0)
        noise = self.noise(1e-7)
        values, _ = self.flicker(
            self.sequence("wave", lambda x, y, t: self.still(x, y) * (1 + wave[t % 4]) + noise()),
            "--metric", "a4_mean", "-s", "flicker.trend=keep")
        expected = (srgb(0.505) - srgb(0.495)) / 2
        bar = (srgb(0.202) - srgb(0.198)) / 2
        self.assertAlmostEqual(values["a4_mean", "sky"], expected, delta=1e-6)
        self.assertAlmostEqual(values["a4_mean", "solid"], bar, delta=1e-6)

    @night.of_the_night
    def test_lag_under_a_sine_of_the_light_in_words(self):
        """alpha 0.1 at 32 frames, w = pi / 16: gain 0.473586 and a lag of 5.000543 frames."""
        w, gain, lag = math.pi / 16, 0.473586, 5.000543
        noise = self.noise(1e-6)
        lights = self.sequence("lights", lambda x, y, t: 0.5 + 0.2 * math.sin(w * t), 64)
        taa = self.sequence("taa",
                            lambda x, y, t: 0.5 + 0.2 * gain * math.sin(w * (t - lag)) + noise(),
                            64)
        found = self.json("flicker", "--reference", lights, taa, "-s", "follow:period_2=32")
        values = values_of(found)
        findings = {row["finding"]: row for row in found["findings"]}
        self.assertAlmostEqual(values["follow_gain_2_p50", "all"], gain, delta=1e-5)
        self.assertAlmostEqual(values["follow_lag_2_p95", "all"], lag, delta=1e-3)
        self.assertIsNone(values["follow_gain_1_p50", "all"])
        self.assertEqual(findings["follow"]["verdict"], "late")
        self.assertIn("a lag of 5 frames at a period of 32, and 0.474 of its swing",
                      findings["follow"]["text"])
        self.assertNotIn("half_life", findings)  # the lag is known
        few = self.neph("flicker", "--reference", lights, taa, "-s", "follow:period_1=65", "-m",
                        "follow")
        self.assertIn("the sequence is shorter than a period", few.stdout + few.stderr)

    def test_unsettled_pixels_are_reported(self):
        """A quarter of the frame never changes; the other pixels follow with alpha 0.2: below 0.1
        from the 11th frame on."""
        step = 4
        lights = self.sequence("lights", lambda x, y, t: 0.2 if t < step else 0.6, 44)
        taa = self.sequence("taa", lambda x, y, t: 0.2 if t < step
                            or x < WIDTH // 4 else 0.6 - 0.4 * 0.8 ** (t - step + 1), 44)
        found = self.json("flicker", "--reference", lights, taa, "-m", "lag", "-s",
                          f"lag:step_frame={step}", "--frozen-ok")
        values = values_of(found)
        findings = {row["finding"]: row for row in found["findings"]}
        expected = {"ghost_area_1": 1, "ghost_area_8": 1, "ghost_area_16": 0.25,
                    "share_never_settled": 0.25, "step_share": 1,
                    "ghost_area_frames": 0.25 * 32 + 0.75 * 10}
        self.assertEqual({name: values[name, "all"] for name in expected}, expected)
        self.assertEqual(findings["unsettled"]["verdict"], "unsettled")
        self.assertIn("25 % of the frame never settles", findings["unsettled"]["text"])

    def test_ghosts_behind_a_card_in_words(self):
        """A card of 10 px moves right by 2 px a frame in front of a dark wall, followed by an
        average with alpha 0.2."""
        history = [0.2] * WIDTH
        for t in range(40):
            card = [2 * t - 10 <= x < 2 * t for x in range(WIDTH)]
            shown = [0.75 if c else 0.2 for c in card]
            history = [h + 0.2 * (s - h) for h, s in zip(history, shown)]
            for name, row in (("cards", shown), ("taa", history)):
                path = self.folder / name / f"frame.{t:04d}.exr"
                path.parent.mkdir(exist_ok=True)
                frames.grey_exr(path, WIDTH, 4, row * 4,
                                **{"Z": [1.0 if c else 10.0 for c in card] * 4,
                                   "motion.y": [0.0] * 4 * WIDTH,
                                   "motion.x": [-2.0 if c else 0.0 for c in card] * 4})
        document = self.json("flicker", "-r", self.folder / "cards", self.folder / "taa", "-m",
                             "ghost", "--frozen-ok")
        left = (1 - 0.8 ** 5) * 0.8 ** 4
        values = values_of(document)
        self.assertAlmostEqual(values["edge_ghost_residual_4", "all"], left, delta=1e-6)
        found = next(row for row in document["findings"]
                     if row["finding"] == "edge_ghost")
        self.assertEqual((found["verdict"],
                          "27.5 % of the old foreground is left after 4 frames" in found["text"]),
                         ("ghosts", True), found)

    def test_half_life_of_an_exponential_average(self):
        """alpha 0.1: ln(1/2) / ln(0.9) = 6.5788 frames."""
        alpha, step = 0.1, 16
        lights = self.sequence("lights", lambda x, y, t: 0.2 if t < step else 0.6, 80)
        taa = self.sequence(
            "taa", lambda x, y, t: 0.2 if t < step else 0.6 - 0.4 * (1 - alpha) ** (t - step + 1),
            80)
        found = self.json("flicker", "--reference", lights, taa, "-m", "lag", "-s",
                          f"lag:step_frame={step}", "--frozen-ok")
        values = values_of(found)
        for mask in ("all", "depth_edge"):
            self.assertAlmostEqual(values["half_life_mean", mask], math.log(0.5) / math.log(0.9),
                                   delta=1e-6)
            self.assertAlmostEqual(values["frames_to_10_p95", mask], math.log(0.1) / math.log(0.9),
                                   delta=1e-5)

    def test_frozen_frames_do_not_count_as_stable(self):
        frozen = self.sequence("frozen", lambda x, y, t: self.still(x, y), 32)
        reference = self.write("reference.exr", self.still, self.depth)
        done = self.neph("flicker", "--reference", reference, frozen, code=1,
                         said=("31 of 32", "--frozen-ok"))
        self.assertIn("four-frame cycle: frozen", done.stdout)
        done = self.neph("flicker", "--reference", reference, frozen, "--frozen-ok")
        self.assertIn("four-frame cycle: calm", done.stdout)

    def test_the_shell_may_expand_the_pattern(self):
        noise = self.noise(0.01)
        test = self.sequence("test", lambda x, y, t: self.still(x, y) + noise(), 16)
        ref = self.sequence("ref", lambda x, y, t: self.still(x, y) + t * 1e-5, 16)
        together = self.neph("flicker", "--reference", *sorted(ref.iterdir()),
                             *sorted(test.iterdir()), "--json")
        quoted = self.neph("flicker", "--reference", ref, test, "--json")
        self.assertEqual(together.stdout, quoted.stdout)
        (test / "frame.0007.exr").unlink()
        self.neph("flicker", "--reference", ref, test, code=65, said="7")

    def test_frames_belong_together_by_their_numbers(self):
        for frame in range(8):
            for first, name in ((0, "shots/b{}_v2.exr"), (0, "zero/f.{:04d}.exr"),
                                (1, "one/s_{:04d}_v3.exr")):
                self.write(name.format(frame + first),
                           lambda x, y: 0.5 + 0.25 * (frame % 4 == 0) + 1e-4 * frame, width=8,
                           height=8)
        shots, zero, one = (self.folder / name for name in ("shots", "zero", "one"))
        self.neph("flicker", "-r", zero, shots, "-m", "residual_change", "--fail-above",
                  "residual_change_rms=1e-9")
        few = self.neph("flicker", "-r", zero, shots, code=2,
                        said="flicker was not measured: flicker needs at least 16 frames")
        self.assertIn("residual_change_rms", few.stdout)  # available values are printed
        self.neph("flicker", "-r", zero, shots, "-m", "mae", "-m", "motion", code=2)
        for run in (("flicker", "-r", zero, one, "-m", "residual_change"), ("compare", zero, one),
                    ("compare", zero, shots, "--versus", one),
                    ("compare", zero, shots, "--second-reference", one)):
            done = self.neph(*run, "-q", code=65, silent=True)
            self.assertTrue("the frames 0 to 7" in done.stderr and "1 to 8" in done.stderr,
                            done.stderr)
            self.neph(*run, "--by-position", "-q")

    def lagging(self, folder, name, lags):
        """A step in the ninth of 32 frames; the test follows with a half-life of two frames."""
        (self.folder / folder).mkdir()
        for t in range(32):
            level = 0.5 if t < 8 else 1 - 0.5 * 0.5 ** ((t - 7) / 2) if lags else 1.0
            values = [level * (0.5 + 0.0625 * (i % 3)) + 1e-6 * t * (i % 5) * lags
                      for i in range(48)]
            (self.folder / folder / name(t)).write_bytes(
                frames.exr_bytes(8, 6, {channel: values for channel in "RGB"}))
        return self.folder / folder

    def test_time_runs_by_frame_numbers_whatever_the_names(self):
        def signed(number):
            return f"f.{'-' if number < 0 else ''}{abs(number):04d}.exr"

        def numbers(reference, test, *options):
            found = self.json("flicker", "-r", reference, test, "-m", "lag", "-s",
                              "lag:step_frame=8", *options)
            return found["measurements"], values_of(found)
        names = {
            "plain": lambda t: f"f.{t + 1:04d}.exr",
            "negative": lambda t: signed(t - 32),
            "through_0": lambda t: signed(t - 16),
            "ids": lambda t: f"f.{t:04d}.{(t * 2654435761 + 12345) % 2 ** 32:08x}.exr",
            "twos": lambda t: f"f.{2 * t:04d}.exr",
            "gap": lambda t: f"f.{t + 100 * (t > 20):04d}.exr",
        }
        folders = {kind: (self.lagging("r_" + kind, name, False),
                          self.lagging("t_" + kind, name, True)) for kind, name in names.items()}
        plain, values = numbers(*folders["plain"])
        self.assertAlmostEqual(values["half_life_p50", "all"], 2.0, delta=1e-3)  # the slope of 1e-6
        for kind in ("negative", "through_0", "ids"):
            self.assertEqual(numbers(*folders[kind])[0], plain, kind)
        for kind in ("twos", "gap"):
            self.assertEqual(numbers(*folders[kind], "--by-position")[0], plain, kind)
            self.neph("flicker", "-r", *folders[kind], code=65, said="--by-position")
        reference, test = folders["negative"]
        for pattern in ("f.%04d.exr", "f.####.exr", "f.$F4.exr"):
            self.assertEqual(numbers(reference / pattern, test / pattern)[0], plain, pattern)
        mixed = numbers(folders["negative"][0], folders["plain"][1], "--by-position")[0]
        self.assertEqual(mixed, plain)

    @night.of_the_night
    def test_paired_differences(self):
        noise = self.noise(0.02)
        common = {}

        def shared(x, y, t):
            return common.setdefault((x, y, t), noise())
        good = self.sequence("good", lambda x, y, t: self.still(x, y) + shared(x, y, t), 64)
        bad = self.sequence("bad", lambda x, y, t: self.still(x, y) + 1.05 * shared(x, y, t), 64)
        reference = self.write("reference.exr", self.still, self.depth)
        rows = self.json("compare", reference, bad, "--versus", good, "--metric", "rmse", "--mask",
                         "all")["versus"]  # of radiance and of depth: corrected for two comparisons
        row = next(row for row in rows if row["quantity"] == "radiance")
        self.assertAlmostEqual(row["difference"], 0.001, delta=5e-5)
        self.assertLess(row["p_holm"], 1e-6)
        self.assertEqual({(row["metric"], row["mask"]) for row in rows}, {("rmse", "all")})
        self.assertAlmostEqual(row["p_holm"] / row["p"], len(rows), delta=1e-9)

    def test_interrupted_work_keeps_the_finished_frames(self):
        noise = self.noise(0.02)
        test = self.sequence("test", lambda x, y, t: self.still(x, y) + noise(), 64)
        reference = self.write("reference.exr", self.still, self.depth)
        for t in range(64, 4096):  # long enough to be interrupted
            (test / f"frame.{t:04d}.exr").symlink_to(test / f"frame.{t % 64:04d}.exr")
        run = subprocess.Popen([NEPH, "compare", str(reference), str(test), "--json", "-q"],
                               stdout=subprocess.PIPE, text=True)
        time.sleep(2)
        run.send_signal(signal.SIGINT)
        out, _ = run.communicate(timeout=60)
        if run.returncode == 0:
            self.skipTest("it was finished before it could be interrupted")
        self.assertEqual(run.returncode, 130)
        document = json.loads(out)
        self.assertTrue(document["interrupted"])
        frames_seen = {row["frame"] for row in document["measurements"] if "frame" in row}
        self.assertEqual(frames_seen, set(range(document["frames"])))


if __name__ == "__main__":
    unittest.main()
