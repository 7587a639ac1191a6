#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Engine realtime on the command line: `neph render` of sequences, presets, given depths, costs."""
import json
import math
import pathlib
import unittest

import frames
import neph_case
import night

INF = math.inf

# Fog in front of a black tower, under a sky with radiance: the radiance behind the media is known.
# Sun and camera move. Only fog, as in test_realtime_pipeline, whose compiled shaders are in the
# cache.
MOVING = """
name: moving
title: a test
description: a test
camera:
  keys:
    - {frame: 0, position_m: [0, 2, 0], look_at_m: [0, 2, -10]}
    - {frame: 4, position_m: [1, 2, 0], look_at_m: [1, 2, -10]}
  vertical_fov_deg: 40
frames: {count: 6, rate_hz: 30}
sun:
  keys:
    - {frame: 0, direction: [0.6, 0.75, 0.3], irradiance_w_per_m2: [6, 6, 6]}
    - {frame: 5, direction: [0.6, 0.75, -0.3], irradiance_w_per_m2: [3, 3, 3]}
background_w_per_m2_sr: [0.5, 0.25, 0.125]
scattering: single
solids:
  - box: {min_m: [1, -6, -21], max_m: [3, 6, -20], albedo: [0, 0, 0]}
media:
  - height_fog:
      layers: [{extinction_per_m: 0.02, falloff_per_m: 0.1, height_m: 0}]
      albedo: [1, 1, 1]
"""
# The camera inside a box of haze: every step of every ray is lit through haze.
BOX = MOVING[:MOVING.index("solids:")].replace("moving", "box") + """
media:
  - gaussian:
      {center_m: [0, 0, 0], width_m: 9, extinction_per_m: 0.02, albedo: [1, 1, 1],
       bounds: {min_m: [-9, -9, -9], max_m: [9, 9, 9]}}
"""
# Frames 2 to 5 are static; from 6 on half the size; a cut between 8 and 9; from 10 on 5/4 of the
# size.
BROKEN = MOVING.replace("moving", "broken").replace("frames: {count: 6, rate_hz: 30}", """
frames:
  {count: 12, rate_hz: 30, pauses: [{frame: 2, count: 3}],
   sizes: [{frame: 6, scale: 0.5}, {frame: 10, scale: 1.25}]}
""").replace("  vertical_fov", """\
    - {frame: 6, position_m: [5, 3, 0], look_at_m: [0, 2, -10], cut: true}
  vertical_fov""")


def with_cloud(scene):
    """The scene with a blob that drifts in its fog."""
    return scene.replace("background", "wind: {velocity_m_per_s: [9, 0, 0]}\nbackground") + (
        "  - gaussian: {center_m: [-2, 3, -20], width_m: 3, extinction_per_m: 0.3, albedo: [1, 1, "
        "1]}\n")


def divided_up(size, divisor):
    return math.prod(-(-side // divisor) for side in size)


def differing(a, b, channels=None):
    """Names of the channels whose bits differ, or that only one image has."""
    return {name for name in channels or {*a, *b} if name not in a or name not in b
            or a[name].tobytes() != b[name].tobytes()}


class Realtime(neph_case.NephCase):
    def setUp(self):
        super().setUp()
        self.moving, self.box, self.broken = (
            self.put(f"{name}.yaml", text)
            for name, text in (("moving", MOVING), ("box", BOX), ("broken", BROKEN)))

    def render(self, name, scene, *options, engine="realtime", size=(48, 36), layers="1"):
        """Renders into a folder of this name and returns results of the frames; `channels` and
        `texts` are read from the files. The validation layers check each path through the pipeline
        once."""
        results = self.json("render", scene, "-e", engine, "-s", "steps=4", "--size",
                            "%dx%d" % size, "-o", self.folder / name, *options,
                            NEPH_VULKAN_VALIDATION=layers)
        for result in results:
            *size_px, result["channels"], result["texts"] = frames.read_exr(
                pathlib.Path(result["exr"]))
            self.assertEqual(result["size_px"], size_px)
        return results

    def refuse(self, code, *words, scene=None, options=()):
        self.neph("render", scene or self.moving, "--size", "16x12", "-q", "-o",
                  self.folder / "refused", *options, code=code, said=words, silent=True)

    def given(self, name, size=(48, 36), **channels):
        path = self.folder / name
        path.write_bytes(frames.exr_bytes(*size,
                                          {c: [v] * math.prod(size) if isinstance(v, float) else v
                                           for c, v in channels.items()}))
        return path

    # ---- the march -------------------------------------------------------------------------------

    def test_off_is_march_bit_by_bit(self):
        settings = ("-s", "sun=marched", "-s", "sun_steps=3", "-s", "transmittance=marched")
        march = self.render("march", self.moving, "--frames", 2, *settings, engine="march")
        off = self.render("off", self.moving, "--frames", 2, "-p", "off", *settings)
        for a, b in zip(march, off, strict=True):
            self.assertEqual(differing(a["channels"], b["channels"]), set())
            counts = [{name: n for name, n in result["stats"].items()
                       if not name.endswith("_ms")} for result in (a, b)]
            self.assertEqual(*counts)
            self.assertEqual((b["stats"]["rays"], b["stats"]["view_steps"]),
                             (48 * 36, 48 * 36 * 4))

    def test_a_sixteenth_of_the_density_evaluations(self):
        size = (61, 35)
        split = self.render("split", self.moving, "--frames", 2, size=size)
        for result in split:
            stats = result["stats"]
            self.assertGreater(math.prod(size) * 4 / stats["density_evaluations"], 14)
            self.assertEqual(stats["rays"], divided_up(size, 4))
            self.assertEqual(stats["view_steps"], stats["rays"] * 4)
            # the sun's optical depth is a closed form
            self.assertEqual(stats["density_evaluations"], stats["rays"] * 4)
            # written with 15 digits
            self.assertAlmostEqual(stats["density_evaluations_per_pixel"],
                                   stats["rays"] * 4 / math.prod(size), delta=1e-14)
        self.check_device_times(split[0])
        self.check_bytes(split[-1]["stats"], size, 2, 8, 8)
        marched, = self.render("marched", self.box, "-s", "sun=marched", "-s", "sun_steps=3")
        self.assertEqual(marched["stats"]["density_evaluations"], 12 * 9 * 4 * (1 + 3))

    def check_device_times(self, result):
        """Each pass has a duration, and they sum to the total."""
        stats, settings = result["stats"], result["texts"]["neph.settings"].split()
        engine, = self.json("engines", "realtime")
        names = [entry["name"].replace(" ", "_").replace("-", "_")
                 for entry in engine["passes"] if entry["condition"] in settings]
        names.remove("motion")  # nothing moves here
        names.remove("lamp_peaks")  # and there are no froxels
        names.remove("composition")  # on a CPU the upscale composes
        self.assertEqual(len(names), 7)
        times = [stats[f"{name}_gpu_ms"] for name in names]
        self.assertTrue(all(t > 0 for t in times), times)
        # each is written with 15 digits
        self.assertAlmostEqual(sum(times) / stats["gpu_ms"], 1, delta=1e-13)
        self.assertLess(stats["gpu_ms"], stats["wall_ms"])

    # ---- counters --------------------------------------------------------------------------------

    @night.of_the_night
    def test_bytes_are_those_of_the_formats(self):
        size = (50, 38)
        for format, *texel_bytes in (("float", 4, 16, 16), ("half", 2, 8, 8)):
            words = ("-s", f"target_format={format}")
            stats = self.render("bytes", self.moving, "--frames", 2, *words, size=size)[-1]["stats"]
            self.check_bytes(stats, size, *texel_bytes)

    def check_bytes(self, stats, size, depth_bytes, color_bytes, taa_bytes):
        """Table 1A of the frame split: texels of each target times the bytes of its format."""
        full, half, tile = (divided_up(size, divisor) for divisor in (1, 2, 4))
        depth, behind, color, taa = 4 * full, 16 * full, 16 * full, taa_bytes * full
        half_depth, history, state = 4 * half, color_bytes * half, 2 * depth_bytes * half
        tiles, ray, distance = 2 * depth_bytes * tile, color_bytes * tile, depth_bytes * tile
        volume, volume_distance = color_bytes * full, depth_bytes * full
        passes = {
            "scene": depth + behind + depth,
            "depth map": depth + half_depth,
            "tile index": half_depth + tiles,
            "march": tiles + half_depth + ray + distance,
            "reconstruction": tiles + ray + distance + 2 * half_depth + 2 * history + 2 * state,
            "upscale": depth + half_depth + history + state + volume + volume_distance,
            "and composition": behind + color,
            "anti-aliasing": color + depth + 2 * taa,
        }
        self.assertEqual(stats["traffic_bytes"], sum(passes.values()))
        self.assertEqual(stats["history_bytes"], half_depth + history + state + taa)
        self.assertEqual(stats["target_bytes"],
                         2 * depth + behind + color + 2 * (half_depth + history + state + taa) +
                         tiles + ray + distance + volume + volume_distance)

    def test_stats_as_a_table(self):
        words = ("render", self.moving, "--stats", "-q", "-o", self.folder)
        done = self.neph(*words, "-e", "realtime", "-s", "steps=65536", "-s", "warm_up=1",
                         "--size", "32x24")
        table = {line.split()[0]: line.split()[1:]
                 for line in done.stdout.splitlines() if len(line.split()) == 4}
        self.assertEqual(table["density_evaluations"], [str(8 * 6 * 65536)] * 3)  # all digits
        none = self.neph(*words, "-e", "exact", "--size", "4x3")
        self.assertIn("counts nothing", none.stdout)

    # ---- presets and settings ----------------------------------------------------------------

    @night.of_the_night
    def test_every_preset_renders_and_is_another(self):
        engine, = self.json("engines", "realtime")
        defaults = {option["name"]: option["default"] for option in engine["options"]}
        plain = self.render("plain", self.moving, "--frames", 3, "-s", "warm_up=2", size=(41, 30))
        seen = {}
        for preset in engine["presets"]:
            results = self.render(preset["name"], self.moving, "--frames", 3, "-p", preset["name"],
                                  "-s", "warm_up=2", size=(41, 30))
            self.assertEqual([result["frame"] for result in results], list(range(3)))
            for result in results:
                for name, samples in result["channels"].items():
                    far = name in ("Z", "volume.distance")
                    self.assertTrue(all(math.isfinite(v) or far and v == INF for v in samples),
                                    (preset, name))
                    self.assertGreaterEqual(min(samples), 0, (preset, name))
            written = dict(word.split("=") for word in results[0]["texts"]["neph.settings"].split())
            for assignment in preset["settings"].split():
                key, value = assignment.split("=")
                self.assertNotEqual(str(defaults[key]), value, "a preset repeats a default")
                if key != "warm_up":
                    self.assertEqual(written[key], value)
            if preset["name"] == "fixed":
                self.assertEqual([differing(a["channels"], b["channels"]) for a,
                                  b in zip(plain, results, strict=True)], [set()] * 3)
            if preset["name"] == "seed":
                self.check_same_command_same_bits(results)
            seen[results[-1]["channels"]["R"].tobytes()] = preset["name"]
        self.assertEqual(len(seen), len(engine["presets"]), seen)

    def check_same_command_same_bits(self, first):
        command = (self.moving, "--frames", 3, "-p", "seed", "-s", "warm_up=2")
        second = self.render("second", *command, size=(41, 30), layers="0")
        other = self.render("other", *command, "--seed", 2, size=(41, 30), layers="0")
        for a, b, c in zip(first, second, other, strict=True):
            self.assertEqual(differing(a["channels"], b["channels"]), set())
            timeless = [{name: text for name, text in result["texts"].items()
                         if not name.endswith(("_s", "_ms"))} for result in (a, b)]
            self.assertEqual(*timeless)
            self.assertIn("R", differing(a["channels"], c["channels"]))

    def test_set_wins_over_the_preset_wherever_it_stands(self):
        result, = self.render("won", self.moving, "-s", "warm_up=3", "-s", "taa_alpha=0.5", "-p",
                              "off", "-s", "taa_alpha=0.25")
        written = result["texts"]["neph.settings"].split()
        for word in ("warm_up=3", "split=none", "taa=off", "taa_alpha=0.25", "steps=4"):
            self.assertIn(word, written)
        for unknown in ("_bytes", "anti_aliasing"):  # of passes that did not run
            self.assertNotIn(unknown, " ".join(result["stats"]))

    def test_settings_that_are_gone_are_ignored_with_one_warning(self):
        done = self.neph("render", self.moving, "-q", "-o", self.folder, "-e", "realtime", "--size",
                         "32x24", *("-s", "steps=4", "-s", "warm_up=0"),
                         *("-s", "taa_rest_px=1", "-s", "taa_rest_px=2", "-s", "taa_format=float"))
        self.assertEqual(done.stderr.splitlines(), [
            "warning: engine realtime: setting taa_rest_px was removed and is ignored: it was "
            "0.02 in every preset",
            "warning: engine realtime: setting taa_format was removed and is ignored: "
            "target_format is the format of all images"])

    def test_the_list_of_settings_can_be_read(self):
        lines = self.neph("engines", "realtime").stdout.splitlines()
        rows = [line for line in lines if line.startswith("    box_transmittance ")]
        self.assertEqual(len(rows), 1)
        column = rows[0].index(rows[0].split()[1])
        for line in lines:
            if "one of:" in line or ", default " in line:
                self.assertEqual(len(line) - len(line.lstrip()), column, line)
        self.assertFalse([line for line in lines if line and not line.strip()])

    def test_wrong_words(self):
        real = ("-e", "realtime")
        for code, words, options in (
                (64, ("nope", "off, seed"), (*real, "-p", "nope")),
                (64, ("engine march", "realtime"), ("-p", "off")),
                (64, ("'jitter'", "taa_jitter,"), (*real, "-s", "jitter=none")),
                (64, ("'zzz'", "neph engines realtime"), (*real, "-s", "zzz=1")),
                (64, ("min_max, variance", "neph engines realtime"), (*real, "-s", "box=big")),
                (64, ("0..1024",), (*real, "-s", "warm_up=1025")),
                (64, ("key=value",), (*real, "-s", "steps")),
                (64, ("1..6", "ends with frame 5"), ("-e", "march", "--frames", "7")),
                (64, ("0..5",), (*real, "--frame", "6")),
                (64, ("oracle",), (*real, "--checkpoint", "sums")),
                (64, ("4096",), (*real, "--size", "5000x8")),
        ):
            self.refuse(code, *words, options=options)
        self.refuse(2, "channels", scene="coloured_fog", options=real)
        multiple = self.put("multiple.yaml",
                            MOVING.replace("moving", "multiple").replace("single", "multiple"))
        self.refuse(2, "multiple", "lighting=octaves", scene=multiple, options=real)
        self.assertFalse((self.folder / "refused").exists()
                         and list((self.folder / "refused").iterdir()))

    def test_faults_that_are_asked_for_end_in_words(self):
        """Without its guard, anti-aliasing makes NaN of black under black; no such frame is
        written."""
        dark = self.put("dark.yaml", MOVING.replace("moving", "dark")
                        .replace("[0.5, 0.25, 0.125]", "[0, 0, 0]")
                        .replace("[1, 1, 1]", "[0, 0, 0]"))
        out = self.folder / "dark"
        done = self.neph("render", dark, "-e", "realtime", "-s", "taa_guard=off", "--size", "16x12",
                         "-q", "-o", out, code=3, said="non-finite")
        self.assertNotIn("logs", done.stderr)
        self.assertEqual(list(out.iterdir()), [])

    def test_blue_noise_is_read_where_a_dither_needs_it(self):
        command = ("render", self.moving, "-e", "realtime", "--size", "16x12", "-q", "-o",
                   self.folder)
        data = {"NEPH_DATA_DIR": str(self.folder)}
        self.neph(*command, "-p", "off", **data)
        noise = "renderer/blue_noise.png"
        self.neph(*command, code=66, said=[f"{self.folder}/{noise}", "set NEPH_DATA_DIR"], **data)
        whole = (neph_case.ROOT / noise).read_bytes()
        for damaged in (whole[:-1], whole[:1000] + b"?" + whole[1001:], b""):
            (self.folder / "renderer").mkdir(exist_ok=True)
            (self.folder / noise).write_bytes(damaged)
            self.neph(*command, code=65, said=[f"{self.folder}/{noise}", "damaged",
                                               "set NEPH_DATA_DIR"], **data)
        (self.folder / noise).write_bytes(whole)
        self.neph(*command, **data)

    # ---- given depths ------------------------------------------------------------------------

    def test_a_given_depth_is_as_good_as_the_scenes_own(self):
        """The march's depth and the known radiance behind the media, in place of rays into the
        scene."""
        # given rays are not jittered
        options = ("--frames", 5, "-s", "taa_jitter=none")
        for result in self.render("march", self.moving, "--frames", 5, engine="march"):
            depth_m = result["channels"]["Z"]
            self.given(f"depth.{result['frame']}.exr", Z=depth_m,
                       **{c: [behind if z == INF else 0.0 for z in depth_m] for c,
                          behind in zip("RGB", (0.5, 0.25, 0.125))})
        own = self.render("own", self.moving, *options)
        given = self.render("given", self.moving, *options, "--depth", self.folder / "depth.%d.exr")
        for a, b in zip(own, given, strict=True):
            self.assertEqual(differing(a["channels"], b["channels"]), set(), a["frame"])

    def test_one_given_depth_serves_all_frames_and_hides_what_is_behind(self):
        wall = self.given("wall.exr", Z=5.0)
        results = self.render("wall", self.moving, "--frames", 3, "--depth", wall)
        sky = self.render("sky", self.moving, "--depth",
                          self.given("sky.exr", Z=INF, R=1.0, G=1.0, B=1.0))
        for result in results:
            self.assertEqual(set(result["channels"]["Z"]), {5.0})
            # only the fog, at most 0.02 * e^0.4 per metre over at most 5 m / cos 28 degrees (the
            # corners)
            self.assertGreater(min(result["channels"]["transmittance.R"]),
                               math.exp(-0.02 * 1.5 * 5.7))
            self.assertLess(max(result["channels"]["transmittance.R"]), 1)
        self.assertEqual(set(sky[0]["channels"]["Z"]), {INF})
        # all of the fog: the part behind the wall absorbs more than the part in front of it
        self.assertLess(max(sky[0]["channels"]["transmittance.R"]),
                        min(results[0]["channels"]["transmittance.R"]))

    def test_wrong_depths(self):
        good = {"size": (16, 12), "Z": 5.0}
        radiance = {"R": 1.0, "G": 1.0}
        for name, code, word, file in (
                ("small", 65, "8x6 px, the frame to render 16x12", {**good, "size": (8, 6)}),
                ("no_z", 65, "no channel Z", {"size": (16, 12), "R": 1.0}),
                ("negative", 65, "-1 m", {**good, "Z": -1.0}),
                ("zero", 65, "0 m", {**good, "Z": 0.0}),
                ("nan", 65, "nan", {**good, "Z": math.nan}),
                ("dark", 65, "-2", {**good, **radiance, "B": -2.0}),
                ("bright", 65, "inf", {**good, **radiance, "B": INF}),
        ):
            path = self.given(f"{name}.exr", **file)
            self.refuse(code, word, str(path), options=("-e", "realtime", "--depth", path))
        good = self.given("good.0.exr", **good)
        self.given("good.1.exr", size=(16, 12), Z=5.0)
        both = self.folder / "good.%d.exr"
        self.refuse(66, "lost.exr", options=("-e", "realtime", "--depth", self.folder / "lost.exr"))
        self.refuse(64, "2 files", "3", options=("-e", "realtime", "--frames", 3, "--depth", both))
        self.refuse(64, "2 files", options=("-e", "realtime", "--depth", both))
        self.refuse(64, "realtime", "march", options=("-e", "march", "--depth", good))
        self.refuse(2, "split=four", options=("-e", "realtime", "-p", "off", "--depth", good))
        junk = self.put("junk.exr", "no picture")
        self.refuse(65, "junk.exr", options=("-e", "realtime", "--depth", junk))

    def test_a_wrong_depth_in_the_middle_is_named_and_what_is_finished_stays(self):
        for frame, depth_m in enumerate((5.0, 5.0, -5.0, 5.0)):
            self.given(f"depth.{frame}.exr", (16, 12), Z=depth_m)
        self.neph("render", self.moving, "-e", "realtime", "--size", "16x12", "--frames", 4, "-q",
                  "--depth", self.folder / "depth.%d.exr", "-o", self.folder / "out", code=65,
                  said="depth.2.exr")
        self.assertEqual(sorted(path.name for path in (self.folder / "out").iterdir()),
                         ["moving_realtime_0000.exr", "moving_realtime_0001.exr"])

    # ---- sequences ---------------------------------------------------------------------------

    def test_a_sequence_with_pause_sizes_and_cut(self):
        results = self.render("broken", self.broken, "--frames", 12, "--scene-layers", "-s",
                              "taa_jitter=none", size=(40, 32))
        self.assertEqual([r["size_px"] for r in results],
                         [[40, 32]] * 6 + [[20, 16]] * 4 + [[50, 40]] * 2)
        speeds_px = []
        for result in results:
            channels = result["channels"]
            self.assertLessEqual({"volume.distance", "motion.x", "motion.y", "motion.depth",
                                  "mask.fog"}, set(channels))
            speeds_px.append(max(map(abs, channels["motion.x"])))
        # of 0.25 m per frame at the tower, 20 m away, 40 degrees high; key frames 0 1 2 2 2 2 3 4 5
        # 6 ..
        px_per_frame = 0.25 / 20 * 32 / 2 / math.tan(math.radians(20))
        for frame, expected in {0: 0, 1: 1, 2: 1, 3: 0, 4: 0, 5: 0, 6: 0.5, 7: 0.5, 8: 0,
                                11: 0}.items():
            # doubles around 32 px, then a float
            self.assertAlmostEqual(speeds_px[frame], expected * px_per_frame, delta=1e-6, msg=frame)
        for frame in (3, 4, 5):  # time does not advance
            self.assertEqual(differing(results[2]["channels"], results[frame]["channels"],
                                       ["Z", "mask.fog"]), set())
        self.assertEqual(set(results[9]["channels"]["motion.x"]), {1e6})  # across the cut: none
        self.assertEqual(set(results[9]["channels"]["motion.depth"]), {0.0})
        self.assertEqual({r["stats"]["rays"] for r in results}, {80, 20, 130})

    def test_off_stands_still_in_a_pause(self):
        self.broken.write_text(with_cloud(BROKEN))
        results = self.render("still", self.broken, "--frame", 2, "--frames", 5, "-p", "off",
                              "--scene-layers")
        self.assertIn("mask.cloud", results[0]["channels"])
        for result in results[1:4]:
            self.assertLessEqual(differing(results[0]["channels"], result["channels"]),
                                 {"motion.x", "motion.y"})  # of the camera, which has stopped
        self.assertNotEqual(results[3]["size_px"], results[4]["size_px"])

    def test_a_cut_voids_the_past_and_nothing_else_does(self):
        kept, reset = (self.render(word, self.broken, "--frame", 6, "--frames", 4, "-s",
                                   f"cut_reset={word}", layers="0")
                       for word in ("off", "on"))
        differences = [differing(a["channels"], b["channels"], "RGB") for a,
                       b in zip(kept, reset, strict=True)]
        self.assertEqual(differences, [set()] * 3 + [set("RGB")])

    def test_the_past_is_used(self):
        """Frames differ from the first frame of a sequence that begins there. A sequence continues
        after the scene's last frame."""
        alone, = self.render("alone", self.moving, "--frame", 4, "-s", "warm_up=1", layers="0")
        warm = self.render("warm", self.moving, "--frame", 4, "--frames", 5, "-s", "warm_up=5")
        sequence = self.render("sequence", self.moving, "--frames", 5, "-s", "warm_up=1",
                               layers="0")
        self.assertEqual(differing(sequence[4]["channels"], warm[0]["channels"]), set())
        self.assertEqual(differing(alone["channels"], warm[0]["channels"]) & {"R", "volume.R"},
                         {"R", "volume.R"})
        self.assertEqual([int(result["texts"]["neph.frame"]) for result in warm],
                         [4, 5, 6, 7, 8])

    def test_interrupted_sequences_keep_what_is_finished(self):
        folder = self.folder / "out"
        child = self.start("render", self.moving, "-e", "realtime", "--frames", "100000", "--size",
                           "96x54", "--json", "-q", "-o", folder)
        self.wait_until(lambda: len(list(folder.glob("*.exr"))) >= 3, child)
        out, _ = self.interrupt(child)
        listed = [pathlib.Path(result["exr"]) for result in json.loads(out)]
        self.assertGreaterEqual(len(listed), 3)
        self.assertEqual(sorted(folder.iterdir()), listed)  # no partial files, no scratch
        for path in (listed[0], listed[-1]):
            self.assertEqual(frames.read_exr(path)[:2], (96, 54))

    # ---- with other engines ----------------------------------------------------------------------

    def test_validate_runs_it_only_when_it_is_named(self):
        options = ("validate", self.moving, "--size", "16x12", "--no-charts", "-q", "-o",
                   self.folder / "out")
        scene, = self.json(*options, "-e", "exact", "-e", "realtime")["scenes"]
        self.assertEqual([(f["engine"], f["status"]) for f in scene["frames"]],
                         [("exact", "rendered"), ("realtime", "rendered")])
        scene, = self.json(*options, PATH="/nonexistent",
                           VK_ICD_FILENAMES="/nonexistent.json")["scenes"]
        engines = [frame["engine"] for frame in scene["frames"]]
        self.assertIn("march", engines)
        self.assertNotIn("realtime", engines)


if __name__ == "__main__":
    unittest.main()
