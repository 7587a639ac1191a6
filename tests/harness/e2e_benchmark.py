#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""`neph benchmark`: relations between its numbers. No absolute times: machines differ."""
import json
import math
import unittest

import frames
import night
from neph_case import ROOT, NephCase

SCENES = ROOT / "scenes/catalog"

MARCHERS = ("march", "march_octaves", "march_horizon", "march_traced", "march_slab")


class Benchmark(NephCase):
    def benchmark(self, *arguments, **expected):
        done = self.neph("benchmark", *arguments, "-q", "-o", self.folder / "out", **expected)
        self.assertEqual(list(self.folder.glob("out/*")), [])
        return done

    def measured(self, *arguments):
        """Returns its JSON and stderr."""
        done = self.benchmark(*arguments, "--json")
        return json.loads(done.stdout), done.stderr

    def error_of_black(self, scene, size):
        """The relative RMSE of a black frame: the RMS of the march's frame over its mean."""
        self.neph("render", scene, "-e", "march", "--size", size, "-o", self.folder)
        channels = frames.read_exr(self.folder / f"{scene}_march_0000.exr")[2]
        values = [value for name in "RGB" for value in channels[name]]
        return math.sqrt(sum(v * v for v in values) * len(values)) / sum(values)

    @night.of_the_night
    def test_two_unbiased_tracers(self):
        document, _ = self.measured("gaussian_blob", "--resolution", "12", "-e", "oracle,tracer",
                                    "--size", "64x36", "--seconds", "0.05")
        self.assertEqual(document["format"], "neph-benchmark-1")
        oracle, tracer = document["engines"]
        self.assertEqual((oracle["engine"], tracer["engine"]), ("oracle", "tracer"))
        self.assertEqual(oracle["times"], {"value": 1.0, "low": 1.0, "high": 1.0})
        for engine in (oracle, tracer):
            with self.subTest(engine["engine"]):
                rungs = engine["rungs"]
                self.assertEqual(len(rungs), 4)
                for rung in rungs:
                    # Noise only. Two seeds of 2304 pixels, a quarter of them with noise, determine
                    # its variance to 8 %; the number of samples depends on the machine's speed.
                    self.assertLess(abs(rung["error2"] / rung["noise2"] - 1.0), 0.5)
                    self.assertGreater(rung["render_s"], 0.0)
                # Noise^2 x samples is constant.
                work = [rung["noise2"] * rung["samples"] for rung in rungs]
                self.assertLess(max(work) / min(work), 2.0)
                for name in ("cost_s", "times"):
                    value = engine[name]
                    self.assertTrue(0.0 < value["low"] <= value["value"] <= value["high"])
                # Unbiased: Student's t with 7 degrees of freedom exceeds 3 x 2.4 standard errors
                # once in 5000.
                bias = engine["bias"]
                half = bias["high"] - bias["value"]
                self.assertLess(abs(bias["value"]), 3.0 * half)
                self.check_rmse_times(engine)
        ratio = tracer["cost_s"]["value"] / oracle["cost_s"]["value"]
        self.assertAlmostEqual(tracer["times"]["value"] / ratio, 1.0, places=6)

    def check_rmse_times(self, engine):
        """A time within the measured range lies between the longest measurement with a larger error
        and the next one. On a busy machine more samples may take less time, so the order is by
        time."""
        self.assertEqual([t["rmse"] for t in engine["rmse_times"]], [0.03, 0.01])
        for time in engine["rmse_times"]:
            errors = sorted((r["render_s"], r["error2"]) for r in engine["rungs"])
            worse = [s for s, e in errors if e > time["rmse"] ** 2]
            better = [s for s, e in errors if e <= time["rmse"] ** 2]
            if time["found"] == "within":
                self.assertLessEqual(worse[-1], time["render_s"] * (1 + 1e-9))
                following = min((s for s in better if s > worse[-1]), default=worse[-1])
                self.assertGreaterEqual(following, time["render_s"] * (1 - 1e-9))
            elif time["found"] == "before":
                self.assertEqual(worse, [])
            elif time["found"] == "beyond":
                self.assertGreater(errors[-1][1], time["rmse"] ** 2)
            else:  # the bias of an unbiased engine is never known to be 1 %
                self.assertEqual(time["found"], "unknown")
                self.assertTrue(errors[-1][1] > time["rmse"] ** 2 or not worse)

    def test_the_table_says_what_it_found(self):
        done = self.benchmark("gaussian_blob", "--resolution", "12", "-e", "tracer,oracle",
                              "--size", "16x9", "--seconds", "0.3", "--set", "oracle:samples=4",
                              "--all")
        self.assertIn("noise^2 x time", done.stdout)
        self.assertIn("times the time of tracer for the same noise", done.stdout)
        for words in ("  3 % error", "  1 % error", "noise^2 falls as time^"):
            self.assertEqual(done.stdout.count(words), 2, done.stdout)

    def test_the_answer_is_which_engine_is_faster(self):
        """At most ten lines, the verdict first, with its interval; -q prints only the verdict."""
        words = ("gaussian_blob", "--resolution", "12", "-e", "tracer,oracle", "--size", "16x9",
                 "--seconds", "0.1")
        number = "[0-9.e+-]+"
        verdict = (rf"(not told apart: )?(tracer|oracle): {number} times "
                   rf"\({number} to {number}\) as fast as (oracle|tracer) for the same noise\n")
        self.assertRegex(self.benchmark(*words).stdout, f"^{verdict}$")
        lines = self.neph("benchmark", *words, "-o", self.folder / "out").stdout
        self.assertRegex(lines, f"^{verdict}")
        self.assertLessEqual(lines.count("\n"), 10)
        self.assertIn("all numbers: --all or --json", lines.splitlines()[-1])

    def test_the_answer_of_frames(self):
        lines = self.neph("benchmark", "voxel_grid", "-e", "march,realtime", "--size", "16x9",
                          "--repeat", "4", "--no-ceilings", "-o", self.folder / "out").stdout
        self.assertRegex(lines, r"^(not told apart: )?(march|realtime): [0-9.e+]+ times as fast as "
                                r"(realtime|march), [0-9.e+-]+ ms a frame against [0-9.e+-]+ ms\n")
        self.assertLessEqual(lines.count("\n"), 10)

    def test_a_ladder_up_to_a_stated_error(self):
        """The reported errors are within the measured range, whatever the machine's speed."""
        found, _ = self.measured("gaussian_blob", "--resolution", "12", "-e", "oracle", "--size",
                                 "16x9", "--error", "0.01")
        engine, = found["engines"]
        self.assertEqual([(t["rmse"], t["found"]) for t in engine["rmse_times"]],
                         [(0.03, "within"), (0.01, "within")])
        samples = [rung["samples"] for rung in engine["rungs"]]
        self.assertTrue(all(b >= 2 * a for a, b in zip(samples, samples[1:])), samples)

    def test_one_thing_ends_a_ladder(self):
        self.benchmark("gaussian_blob", "--error", "0.01", "--seconds", "1", code=64,
                       said="--seconds and --error")

    def passes(self, scene, *settings):
        """The milliseconds per frame of the passes of preset fixed, by name."""
        words = [word for setting in settings for word in ("-s", f"realtime:{setting}")]
        found, _ = self.measured(scene, "-e", "realtime", "--preset", "fixed", "--size", "32x18",
                                 "--repeat", "8", *words)
        engine, = found["engines"]
        self.check_arithmetic(engine, found["ceilings"])
        return {p["pass"]: 1e3 * p["gpu_s"]["median"] for p in engine["passes"]}

    def check_arithmetic(self, engine, ceilings):
        """The arithmetic fits the time of all passes with counted evaluations, whatever the density
        is."""
        march, = [p for p in engine["passes"] if p["pass"] == "march"]
        names = ["march", *filter(None, march["evaluations_with"].split(", "))]
        seconds = sum(p["gpu_s"]["median"] for p in engine["passes"] if p["pass"] in names)
        self.assertAlmostEqual(march["multiply_adds"] * march["density_evaluations"] /
                               (ceilings["multiply_adds_per_s"] * seconds), 1.0, places=9)

    def test_a_shadow_map_has_a_line_of_its_own(self):
        """With a moving sun the whole map is filled for each frame."""
        passes = self.passes("shadow_crawl", "cloud_shadow=map", "sun=marched",
                             "cloud_shadow_texels=64")
        self.assertGreater(passes["cloud shadow"], 0.0)

    def test_a_scene_that_rests_is_timed_when_that_is_known(self):
        """Few timed frames are enough; all are of one kind."""
        found, told = self.measured("gaussian_blob", "-e", "realtime", "-p", "ours", "--size",
                                    "32x18", "--repeat", "3", "--no-ceilings", "--seconds", "1")
        self.assertIn("--seconds has no effect", told)
        engine, = found["engines"]
        march, = [p for p in engine["passes"] if p["pass"] == "march"]
        self.assertEqual((march["ceiling"], march["share"]), (None, None))  # a formula
        self.assertEqual((engine["preset"], engine["changes"], engine["steady_from"]),
                         ("ours", "", 0))
        self.assertNotIn("gradient", [p["pass"] for p in engine["passes"]])
        gains = {p["pass"]: p["variant_gain"] for p in engine["passes"]}
        self.assertGreater(gains["anti-aliasing"], 0.0)
        self.assertIsNone(gains["march"])

    def test_who_cannot_does_not_stop_the_others(self):
        found, told = self.measured("slab_multiple_thin", "-e", "realtime,march,tracer", "--size",
                                    "8x5", "--seconds", "0.02", "--repeat", "2")
        self.assertIn("--repeat has no effect", told)
        self.assertEqual([e["engine"] for e in found["engines"]], ["tracer"])
        self.assertEqual([(e["engine"], e["hint"]) for e in found["cannot"]],
                         [("realtime", "-s realtime:lighting=octaves"), ("march", "")])
        self.assertEqual(found["cannot"][1]["reason"],
                         "march cannot: multiple scattering; march_octaves could")

    @night.of_the_night
    def test_froxels_have_lines_of_their_own(self):
        passes = self.passes("lamp_fog", "froxels=on")
        for name in ("froxel light", "froxel sum", "froxel composition", "lamp peaks"):
            self.assertGreater(passes[name], 0.0, name)
        self.assertNotIn("lamp peaks", self.passes("fence_backlit", "froxels=on"))

    def test_pictures_in_flight(self):
        document, _ = self.measured(
            "voxel_grid", "-e", "march,realtime,tracer", "--size", "32x18", "--repeat", "4",
            "--seconds", "0.02", "--preset", "fixed", "-s", "realtime:transmittance=marched", "-s",
            "realtime:grid_sampling=texture", "-s", "realtime:grid_format=r8")
        self.assertEqual(document["format"], "neph-benchmark-both-1")
        self.assertEqual(document["cannot"], [])
        tracer, = document["noise"]["engines"]
        self.assertEqual((tracer["engine"], tracer["preset"], tracer["changes"]),
                         ("tracer", None, ""))
        for rung in tracer["rungs"]:
            self.assertAlmostEqual(rung["paths_per_s"] * rung["render_s"] /
                                   (32 * 18 * rung["samples"]), 1.0, places=9)
        flown = document["frames"]
        self.assertEqual(flown["format"], "neph-benchmark-frames-1")
        for ceiling in ("copy_bytes_per_s", "buffer_samples_per_s", "buffer_chain_per_s",
                        "multiply_adds_per_s", "exponentials_per_s"):
            self.assertGreater(flown["ceilings"][ceiling], 0.0)
        # Of the formats that any engine samples.
        textures = flown["ceilings"]["texture_samples_per_s"]
        self.assertEqual((textures["r32f"], textures["r16f"]), (None, None))
        self.assertGreater(textures["r8"], 0.0)
        chains = flown["ceilings"]["texture_chain_per_s"]
        self.assertEqual((chains["r32f"], chains["r16f"]), (None, None))
        march, realtime = flown["engines"]
        self.assertEqual((march["preset"], march["changes"]), (None, ""))
        self.assertEqual((realtime["preset"], realtime["changes"]),
                         ("fixed", "transmittance=marched grid_sampling=texture grid_format=r8"))
        self.assertEqual(march["error"], 0.0)  # its defaults are the reference
        self.assertGreater(realtime["error"], 0.0)
        self.assertLess(realtime["error"], self.error_of_black("voxel_grid", "32x18"))
        self.assertEqual([p["pass"] for p in march["passes"]], ["march"])
        self.assertIn("reconstruction", [p["pass"] for p in realtime["passes"]])
        for engine, samples, ceiling, chain in (
                (march, "buffer samples", flown["ceilings"]["buffer_samples_per_s"],
                 flown["ceilings"]["buffer_chain_per_s"]),
                (realtime, "r8 texture samples", textures["r8"], chains["r8"])):
            with self.subTest(engine["engine"]):
                self.assertTrue(1 <= engine["frames"] <= 4)
                self.assertEqual(engine["reference"], "march")
                for times in (engine["frame_s"], engine["gpu_s"], engine["cpu_s"],
                              *(p["gpu_s"] for p in engine["passes"])):
                    self.assertTrue(0.0 <= times["low"] <= times["median"] <= times["high"])
                rays = [p for p in engine["passes"] if p["pass"] == "march"][0]
                self.assertEqual(rays["ceiling"], samples)
                self.assertGreater(rays["density_evaluations"], 0)
                share = rays["density_evaluations"] / rays["gpu_s"]["median"] / ceiling
                self.assertAlmostEqual(rays["share"] / share, 1.0, places=9)
                self.assertAlmostEqual(rays["chain_share"] * chain / (share * ceiling), 1.0,
                                       places=9)
                self.assertAlmostEqual(rays["multiply_adds"] * share * ceiling /
                                       flown["ceilings"]["multiply_adds_per_s"], 1.0, places=9)
        # One ray per 4 x 4 pixels.
        counts = [[p["density_evaluations"] for p in e["passes"] if p["pass"] == "march"][0]
                  for e in (march, realtime)]
        self.assertLess(counts[1], counts[0] / 8)
        for engine in (march, realtime):
            self.assertGreater(engine["device_bytes"], 32 * 18 * 64)  # a result of each pixel

    @night.of_the_night
    def test_a_screen_has_a_line_for_each_pass(self):
        """Its error is against its own defaults."""
        found, _ = self.measured("surface_rough", "-e", "screen", "-p", "fast", "--size", "32x18",
                                 "--repeat", "4", "--no-ceilings")
        engine, = found["engines"]
        self.assertIsNone(found["ceilings"]["copy_bytes_per_s"])
        passes = {p["pass"]: p["gpu_s"] for p in engine["passes"]}
        self.assertIn("reflections of all", passes)
        self.assertEqual((engine["frames"], engine["reference"]), (4, "screen"))
        self.assertGreater(engine["error"], 0.0)
        for times in (engine["gpu_s"], *passes.values()):
            self.assertTrue(0.0 < times["low"] <= times["median"] <= times["high"])
        self.assertAlmostEqual(sum(t["median"] for t in passes.values()) /
                               engine["gpu_s"]["median"], 1.0, delta=0.5)

    @night.of_the_night
    def test_a_chain_has_a_line_for_each_stage(self):
        """The scene's own chain: its frames are two thirds of the size. Adaptation, bloom, the
        lookup table, FXAA, upscale and sharpening are nine stages."""
        scene = SCENES.parent / "studies/display/walk_out.yaml"
        words = (scene, "-e", "march", "--size", "48x27", "--repeat", "5", "--no-ceilings",
                 "-s", "march:steps=4")
        found, _ = self.measured(*words)
        chain = found["engines"][0]["chain"]
        self.assertEqual(found["size_px"], [33, 19])
        self.assertEqual((chain["repeats"], len(chain["stages"])), (5, 9))
        self.assertIn("upscale", [stage["name"] for stage in chain["stages"]])
        for times in (chain["all"], *chain["stages"]):
            self.assertTrue(0 < times["least_ms"] <= times["low_ms"] <= times["ms"] <=
                            times["high_ms"])
        self.assertLessEqual(sum(stage["least_ms"] for stage in chain["stages"]),
                             chain["all"]["least_ms"])
        found, _ = self.measured(*words, "--chain", "off")
        self.assertIsNone(found["engines"][0]["chain"])
        self.assertEqual(found["size_px"], [48, 27])

    @night.of_the_night
    def test_evaluations_of_several_passes_are_in_the_time_of_all(self):
        ground = ("solids: [box: {min_m: [-9, -2, -9], max_m: [9, -1, 9], albedo: [1, 1, 1]}]\n"
                  "media:\n")
        text = (SCENES / "voxel_grid.yaml").read_text()
        scene = self.put("grounded.yaml", text.replace("name: voxel_grid", "name: grounded")
                         .replace("media:\n", ground, 1))
        found, _ = self.measured(scene, "-e", "realtime", "--size", "32x18", "--repeat", "1",
                                 "--preset", "fixed")
        march, scene = [[p for p in found["engines"][0]["passes"] if p["pass"] == name][0]
                        for name in ("march", "scene")]
        self.assertEqual((march["ceiling"], march["evaluations_with"]),
                         ("buffer samples", "scene"))
        seconds = march["gpu_s"]["median"] + scene["gpu_s"]["median"]
        self.assertAlmostEqual(march["share"] * seconds *
                               found["ceilings"]["buffer_samples_per_s"] /
                               march["density_evaluations"], 1.0, places=9)

    def test_wrong_requests_are_refused_in_words(self):
        for arguments, code, word in (
                (("slab_multiple_thin", "-e", "exact"), 64, "is deterministic"),
                (("slab_multiple_thin", "-e", "magic"), 64, "neph engines"),
                (("slab_multiple_thin", "--seconds", "nan"), 64, "0.01..10000"),
                (("slab_multiple_thin", "-e", "march", "--repeat", "0"), 64, "1.."),
                (("slab_multiple_thin", "-e", "realtime", "-p", "magic"), 64, "magic"),
                (("slab_multiple_thin", "-e", "march,tracer", "-p", "ours"), 64,
                 "none of the engines has presets"),
                (("slab_multiple_thin", "-e", ",".join(MARCHERS)), 64,
                 "more than 4 engines with frames"),
                (("slab_multiple_thin", "-e", ",".join((*MARCHERS[:4], "tracer")), "-s", "steps"),
                 64, "ENGINE:KEY=VALUE"),
                (("voxel_grid", "-e", "march", "-s", "march:rays_per_px=4", "--size", "16x9"), 2,
                 "rays_per_px=1"),
                (("slab_multiple_thin", "-e", "march"), 2, "multiple scattering"),
                (("slab_multiple_thin", "--resolution", "1"), 64, "2.."),
                (("slab_multiple_thin", "--set", "povray:samples=3"), 64, "ENGINE:KEY=VALUE"),
                (("slab_multiple_thin", "-e", "tracer", "--chain", "a.yaml"), 64, "in flight"),
                (("voxel_grid", "-e", "march", "--chain", "no_such.yaml"), 66, "no_such.yaml"),
                (("no_such_scene",), 66, "neph scenes")):
            with self.subTest(arguments):
                self.benchmark(*arguments, code=code, said=word)

    def test_help_teaches(self):
        done = self.neph("benchmark", "--help")
        for word in ("Example", "noise", "cores"):
            self.assertIn(word, done.stdout)


if __name__ == "__main__":
    unittest.main()
