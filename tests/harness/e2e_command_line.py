#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The command line as a user runs it: results, errors, exit codes, kill -9, missing engines."""
import json
import pathlib
import shutil
import signal
import subprocess
import time
import unittest

import neph_case
import night
from neph_case import NEPH, ROOT

# The truth and another engine, both without Vulkan
ON_THE_CPU = ["-e", "exact", "-e", "oracle", "--no-charts", "-q", "--size"]


class CommandLine(neph_case.NephCase):
    surroundings = neph_case.VALIDATED

    def test_help_of_every_verb_has_an_example(self):
        for verb in ("validate", "render", "export", "compare", "flicker", "conform", "metrics",
                     "bake", "study", "ablate", "benchmark", "scenes", "engines", "doctor",
                     "fly", "view"):
            done = self.neph(verb, "--help")
            self.assertIn("Example", done.stdout, verb)

    def test_unknown_verb_engine_setting_and_scene_are_usage_errors_that_help(self):
        self.neph("flee", code=64)
        self.neph("render", "absorbing_slab", "-e", "magic", code=64, said="neph engines")
        self.neph("render", "absorbing_slab", "-s", "steps=0", code=64, said="1..")
        self.neph("render", "no_such_scene", code=66, said="neph scenes")
        config = self.put("a.json", json.dumps({
            "format": "neph-configuration-1", "engine": "march", "settings": "stepz=3",
            "scattering": "single"}))
        self.neph("render", "absorbing_slab", "--config", config, code=65,
                  said=(str(config), "hint: settings of engine march: steps, "))

    def test_wrong_value_names_file_line_column_and_range(self):
        text = (ROOT / "scenes/catalog/scattering_slab_above.yaml").read_text()
        scene = self.put("scattering_slab_above.yaml",
                         text.replace("extinction_per_m: 1", "extinction_per_m: -1"))
        line = next(i for i, row in enumerate(scene.read_text().splitlines(), 1) if ": -1" in row)
        self.neph("scenes", scene, code=65, said=(f"{scene}:{line}:", "-1", "0"))

    def test_an_infinite_radiance_ends_a_render_with_3_and_names_the_pixel(self):
        scene = self.folder / "lamp_in_fog.yaml"
        text = """name: lamp_in_fog
title: A light in fog on the ray of the middle pixel
description: the integral of 1/d^2 has no bound there
camera: {position_m: [0, 0, 5], look_at_m: [0, 0, 0], vertical_fov_deg: 30}
lights: [{position_m: [0, 0, LIGHT], intensity_w_per_sr: [1, 1, 1]}]
scattering: single
media:
  - homogeneous:
      extinction_per_m: 1
      albedo: [1, 1, 1]
      bounds: {min_m: [-1, -1, -1], max_m: [1, 1, 1]}
"""
        scene.write_text(text.replace("LIGHT", "0.5"))
        for engine in "exact", "oracle", "tracer", "march", "realtime":
            self.neph("render", scene, "-e", engine, "--size", "15x9", "-o", self.folder / "out",
                      code=3, said=("pixel (7, 4) is infinite", "lights[0]"))
            self.assertEqual(list(self.folder.glob("out/*.exr")), [])
        # no ray of this frame meets a light
        self.neph("render", scene, "-e", "exact", "--size", "16x9", "-o", self.folder / "out")
        scene.write_text(text.replace("LIGHT", "3"))
        self.neph("render", scene, "-e", "exact", "--size", "15x9", "-o", self.folder / "out")

    def test_a_variant_is_a_scene_file(self):
        done = self.neph("scenes", "height_fog_level", "--variant", "sun_step", "--at", "3",
                         "--frames", "9")
        scene = self.folder / "height_fog_level_sun_step.yaml"
        self.assertIn(scene.name, done.stderr)
        scene.write_text(done.stdout)
        done = self.neph("scenes", scene, "--json")
        self.assertEqual(json.loads(done.stdout)["frames"], 9)
        self.check_refusals(
            (2, "moves already", ("sun_step", "--variant", "sun_step")),
            (64, "sun_sine", ("height_fog_level", "--variant", "sun")),
            (64, "1..8", ("height_fog_level", "--variant", "camera_cut", "--at", "9", "--frames",
                          "9")),
            (64, "one scene", ("--variant", "sun_step")),
            (64, "--variant", ("height_fog_level", "--at", "3")), before=("scenes",))

    def test_tracers_go_on_from_a_checkpoint(self):
        options = ["--size", "16x9", "-q", "-o", self.folder]
        by_oracle = ["-e", "oracle", *options]
        sums = self.folder / "sums"
        for samples in (8, 24):  # a finished render gets more samples
            self.neph("render", "voxel_grid", *by_oracle, "-s", f"samples={samples}",
                      "--checkpoint", sums)
        in_two = self.folder / "in_two.exr"
        (self.folder / "voxel_grid_oracle_0000.exr").rename(in_two)
        self.neph("render", "voxel_grid", *by_oracle, "-s", "samples=24")
        found = self.json("compare", in_two, self.folder / "voxel_grid_oracle_0000.exr")
        worst = [row["value"] for row in found["measurements"]
                 if row["metric"] == "max_abs" and row["quantity"] == "radiance"]
        self.assertEqual(set(worst), {0.0})
        sums.write_bytes(sums.read_bytes()[:-9])
        for engine, code, words in (("oracle", 65, str(sums)), ("tracer", 65, str(sums)),
                                    ("march", 64, "oracle")):
            self.neph("render", "voxel_grid", *options, "-e", engine, "--checkpoint", sums,
                      code=code, said=words)

    def test_scenes_without_data_are_skipped(self):
        environment = {"NEPH_DISNEY_CLOUD": ""}
        listed = self.neph("scenes", **environment)
        self.assertRegex(listed.stdout, r"disney_cloud +not here: .*NEPH_DISNEY_CLOUD")
        self.assertIn("white_furnace", listed.stdout)
        self.neph("scenes", "disney_cloud", **environment, code=66, said="export NEPH_DISNEY_CLOUD")

    def test_validate_reuses_finished_frames(self):
        runs = [self.json("validate", "scattering_slab_above", *ON_THE_CPU, "32x18", "-o",
                          self.folder) for _ in range(2)]
        reused = [[f["reused"] for f in run["scenes"][0]["frames"]] for run in runs]
        self.assertEqual(reused, [[False, False], [True, True]])
        report = self.folder / "report"
        self.assertTrue((report / "index.html").exists())
        self.assertEqual(json.loads((report / "data.json").read_text())["format"], "neph-report-1")

    def test_failing_gate_exits_with_1_and_is_named(self):
        text = (ROOT / "scenes/catalog/scattering_slab_above.yaml").read_text()
        scene = self.put("scattering_slab_above.yaml", text.replace(
            "engine: march", "engine: oracle").replace("maximum: 1.0e-3", "maximum: 0"))
        found = self.json("validate", scene, *ON_THE_CPU, "32x18", "-o", self.folder, code=1)
        verdicts = [g["verdict"] for g in found["scenes"][0]["gates"]]
        self.assertIn("fail", verdicts)

    def test_missing_engines_are_reported_and_the_others_go_on(self):
        found = self.json("validate", "scattering_slab_above", "--no-charts", "--size", "32x18",
                          "-q", "-o", self.folder, PATH="/nonexistent",
                          VK_ICD_FILENAMES="/nonexistent.json")
        frames = {f["engine"]: f for f in found["scenes"][0]["frames"]}
        self.assertEqual(frames["exact"]["status"], "rendered")
        for engine in ("march", "cycles", "povray"):
            self.assertEqual(frames[engine]["status"], "missing")
            self.assertIn("apt-get install", frames[engine]["reason"])
        self.neph("doctor", PATH="/nonexistent", code=69)

    def test_kill_leaves_no_finished_entry(self):
        command = [NEPH, "validate", "scattering_slab_above", "absorbing_slab", *ON_THE_CPU,
                   "128x72", "-o", str(self.folder)]
        for delay_s in (0.1, 0.2, 0.4, 0.8):
            child = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            time.sleep(delay_s)
            child.send_signal(signal.SIGKILL)
            child.wait()
            for entry in (self.folder / "store/frames").glob("*"):
                record = json.loads((entry / "job.json").read_text())
                digest = subprocess.run(["b2sum", "-l", "256", entry / "frame.exr"],
                                        capture_output=True, text=True)
                self.assertEqual(digest.stdout.split()[0], record["frame_blake2b"])
        done = subprocess.run(command, capture_output=True, text=True, timeout=600)
        self.assertIn(done.returncode, (0, 1), done.stderr)
        self.assertEqual(list((self.folder / "store/tmp").iterdir()), [])
        self.assertTrue((self.folder / "report/index.html").exists())

    def test_interrupt_keeps_finished_frames(self):
        child = subprocess.Popen([NEPH, "validate", "--no-charts", "-q", "-e", "exact", "--size",
                                  "640x360", "-o", str(self.folder)], stdout=subprocess.DEVNULL)
        time.sleep(2)
        child.send_signal(signal.SIGINT)
        self.assertEqual(child.wait(timeout=20), 130)
        self.assertEqual(list((self.folder / "store/tmp").iterdir()), [])

    @unittest.skipUnless(shutil.which("chromium"),
                         "chromium is not installed: the page is not looked at")
    @night.of_the_night
    def test_a_full_report_in_a_browser(self):
        done = self.neph("validate", "scattering_slab_above", "--no-charts", "--size", "32x18",
                         "-q", "-o", self.folder, code=None)
        self.assertIn(done.returncode, (0, 1), done.stderr)
        checked = subprocess.run(["node", ROOT / "scripts/report/check_report.mjs", "--quick",
                                  self.folder / "report"],
                                 capture_output=True, text=True, timeout=300)
        self.assertEqual(checked.returncode, 0, checked.stdout + checked.stderr)

    def test_hostile_names_are_data(self):
        hostile = self.folder / "$(touch pwned); import os #.yaml"
        hostile.write_text((ROOT / "scenes/catalog/absorbing_slab.yaml").read_text())
        self.neph("scenes", hostile, code=None)
        self.neph("export", hostile, "-e", "povray", "-o", self.folder / "x; touch pwned",
                  code=None)
        self.assertFalse(list(self.folder.rglob("pwned")) or pathlib.Path("pwned").exists())


if __name__ == "__main__":
    unittest.main()
