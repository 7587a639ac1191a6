#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Each example of each --help can be pasted into a shell. By day all of them are parsed and the
cheap ones run; by night all of them run. Each runs at a small size.

An example runs in a folder with the files that examples name. Words that reduce its cost are
appended: a repeated option has its last value, and lists grow."""
import os
import pathlib
import re
import subprocess
import unittest

import frames
import neph_case
import night
from e2e_flags import ask, verbs
from neph_case import NEPH, ROOT

SIZE = "--size 16x9"
STUDY = f"{SIZE} --steps 4"
# (pattern of the command, appended words, exit codes, whether it runs by day). The first matching
# pattern applies. Exit code 1 is a verdict, 2 an engine or frames that lack data.
RULES = [
    (r"validate .*--suite physics --only", "--samples 2 -q", {0, 1}, False),
    (r"validate .*--suite physics", "--only furnace_box_4 -e exact -q", {0, 1}, True),
    (r"validate .*--suite i3rc", "--samples 20 -q", {1}, True),
    (r"validate .*--suite stress.* povray", "-q", {0, 1}, False),
    (r"validate .*--suite stress", "-q", {0, 1}, False),
    (r"validate .*-e ", f"--no-charts {SIZE} -q", {0, 1}, True),
    (r"validate .*--tier full", "--no-charts --size 8x5 -e exact,march -q", {0, 1}, False),
    (r"validate\b", f"--no-charts {SIZE} -e exact,march -q", {0, 1}, False),
    (r"study steps .*--renew", "absorbing_slab", {0}, False),
    (r"study steps .*cycles", f"{SIZE} -s samples=1", {0, 2, 69}, False),
    (r"study steps", SIZE, {0, 2, 69}, False),
    (r"study flicker .*--suite",
     f"{STUDY} --frames 16 --seeds 1 -q -p fixed --takes flicker --no-floor", {0}, False),
    (r"study flicker", f"{STUDY} --frames 16 --seeds 1 -q --no-floor", {0}, False),
    (r"study attribution .*--suite", f"{STUDY} --frames 16 --seeds 1 -q -p fixed", {0}, False),
    (r"study attribution", f"{STUDY} --frames 16 --seeds 1 -q", {0}, False),
    (r"study light", "--size 8x5 --samples 2 --steps 8 -q", {0}, False),
    (r"study sky", "--size 8x8 --samples 2 --steps 4 -q", {0}, False),
    (r"study fog", f"{SIZE} --directions 64", {0}, True),
    (r"study screen .*--cycles", f"{SIZE} --samples 2 --rays 2 --cycles 1 -q", {0, 69}, False),
    (r"study screen", f"{SIZE} --samples 2 --rays 2 -q", {0}, False),
    (r"study convergence", f"{STUDY} --frames 16 -q", {0}, False),
    (r"study phase", "--optical-depth 1 --nodes 32 -q", {0}, False),
    (r"study post", f"{STUDY} --frames 16 --warm-up 4 -q", {0}, False),
    (r"ablate --list", "", {0}, True),
    (r"ablate", f"{STUDY} --frames 16 --seeds 1 -q", {0}, False),
    (r"render .*--config", f"--frames 2 {SIZE} -q", {0}, False),
    (r"render .*cycles", f"-s samples=1 {SIZE} -q", {0, 69}, False),
    (r"render .*tracer", f"-s samples=2 {SIZE} -q", {0}, True),
    (r"render .*--frames", f"--frames 2 {SIZE} -q", {0}, True),
    (r"render", f"{SIZE} -q", {0}, True),
    (r"export .*cycles", SIZE, {0, 69}, False),
    (r"export", SIZE, {0}, True),
    (r"fly", f"{SIZE} --frames 2", {0, 69}, False),
    (r"bake", "--resolution 4", {0}, True),
    (r"benchmark .*(screen|march|realtime)", f"{SIZE} --repeat 2 --no-ceilings -q", {0}, False),
    (r"benchmark .*--error", f"{SIZE} --error 0.5 -q", {0, 69}, False),
    (r"benchmark", f"{SIZE} --seconds 0.05 -q", {0, 69}, False),
    (r"sweep", f"{SIZE} --untimed -q", {0, 1}, False),
    (r"scaling", "--size 32x18 -q", {0}, False),
    (r"pick .*--preset", f"{SIZE} --frames 16 --steps 2 -q", {0, 1}, False),
    (r"pick", f"{SIZE} -q", {0, 1}, False),
    (r"compare", "-q", {0, 1}, True),
    (r"flicker", "-q", {0, 1}, True),
    (r"fit", "", {0}, True),
    (r"limits", "-q", {0}, True),
    (r"view", "-q", {0}, True),
    (r"post", "-q", {0}, True),
    (r"conform \w+ \w+$", "-q", {0, 1}, False),
    (r"conform", "--size 32x18 --only height_fog_level,cloud_below -e march -q", {0, 1}, False),
    (r"nightly .*slurm", "", {0, 1, 69}, False),
    (r"nightly .*--against", "--only catalog --size 8x5 -q", {1, 66}, False),
    (r"nightly", "--only failure\\ fog_none --minutes 1 --once -q", {0, 1}, False),
    (r"baseline .*--night", "", {0, 65, 66}, False),  # a run that does not exist
    (r"baseline", "", {0, 66}, True),
    (r"droplets", "--effective-radius 1", {0}, True),
    (r"fluxes .*tracer", "--samples 16 -q", {0, 69}, True),
    (r"fluxes", "--samples 16 -q", {0}, True),
    (r"serve", "-o missing", {66}, True),  # else it runs until Ctrl-C
    (r"store", "", {0, 66}, True),
    (r"scenes .*--new", "--force", {0}, True),
    (r"(scenes|metrics)\b", "", {0}, True),
    (r"(engines|doctor)\b", "", {0, 3, 69}, True),
]
LENGTH = 96  # frames of a sequence: 64 of warm-up and a period of 32 of the light
WIDTH, HEIGHT = 16, 9

OCIO = """ocio_profile_version: 2
roles: {default: linear, scene_linear: linear}
file_rules:
  - !<Rule> {name: Default, colorspace: default}
displays:
  screen:
    - !<View> {name: Filmic, colorspace: linear}
colorspaces:
  - !<ColorSpace> {name: linear}
"""
FOG = """name: my_fog
title: Fog to a horizon
description: One layer, which both looks of fog have.
camera: {position_m: [0, 20, 0], look_at_m: [0, 20, -100], vertical_fov_deg: 60}
sun: {direction: [0.2, 0.3, -1], irradiance_w_per_m2: [5.5, 5, 4.5]}
background_w_per_m2_sr: [0.6, 0.7, 0.8]
scattering: single
media:
  - height_fog:
      unreal_layers:
        - {fog_density: 0.01, fog_height_falloff: 0.06, fog_height_m: 0}
      albedo: [1, 1, 1]
      phase: henyey_greenstein
      asymmetry_g: 0.6
fog_look: {inscattering_w_per_m2_sr: [0.45, 0.5, 0.55]}
"""
SWEEP = """title: Of one's own
light: octaves
width_px: 16
height_px: 9
frames: 16
warm_up: 4
truth_samples: 4
rounds: 1
seeds: 1
series:
  - {name: march, engine: march, vary: steps, values: 2 4, order: 2}
"""


def examples():
    """Every example of every help, in the order of the help."""
    for words in [("study",), *verbs()]:
        parts = re.split(r"\nExamples?:\n", ask(*words))
        for line in parts[1].splitlines() if len(parts) > 1 else ():
            yield " ".join(words), line


def command_of(line, words):
    """Inserts the words after the example, before a redirection; removes comments and devices."""
    line = re.sub(r"\s+#.*", "", line.strip()).replace("NEPH_VULKAN_DEVICE=nvidia ", "")
    line, arrow, to = line.partition(" > ")
    return f"{line} {words}{arrow}{to}"


def rule_of(command):
    for pattern, words, codes, by_day in RULES:
        if re.match(rf"(NEPH_\w+=\S+ )?neph {pattern}", command):
            return words, codes, by_day
    raise AssertionError(f"no rule of e2e_examples.py fits '{command}'")


def make_frames(folder):
    """The frames that examples name: a fence in noise that changes from frame to frame."""
    def values(frame):
        return [0.2 + 0.1 * (i % 3) + 0.01 * ((7 * i + 5 * frame) % 11) for i in
                range(WIDTH * HEIGHT)]

    def picture(path, frame):
        rgb = bytes(int(255 * value) for value in values(frame) for _ in range(3))
        path.write_bytes(frames.png_bytes(WIDTH, HEIGHT, rgb))

    depths = [5.0 if i % WIDTH < WIDTH / 2 else 500.0 for i in range(WIDTH * HEIGHT)]
    for i, name in enumerate(("exact", "march", "reference", "test", "before", "after", "still",
                              "a", "b", "cloud")):
        frames.grey_exr(folder / f"{name}.exr", WIDTH, HEIGHT, values(i), Z=depths)
    for i, name in enumerate(("old", "new", "ref", "before", "after")):
        picture(folder / f"{name}.png", i)
    for seed, name in enumerate(("night", "taa", "full", "fast", "lights", "sines", "a", "b",
                                 "half", "walk", "before", "after", "reference", "test")):
        (folder / name).mkdir()
        stem = "f" if name == "test" else "frame"
        for frame in range(LENGTH):
            frames.grey_exr(folder / name / f"{stem}.{frame:04}.exr", WIDTH, HEIGHT,
                            values(seed + frame), Z=depths)
    for seed in range(8):
        name = folder / ("old", "new")[seed % 2]
        name.mkdir(exist_ok=True)
        frames.grey_exr(name / f"seed_{seed}.exr", WIDTH, HEIGHT, values(seed))
    for name in "runs", "nights":
        (folder / name).mkdir()
    for run in range(1, 12):
        frames.grey_exr(folder / f"runs/seed_{run}.exr", WIDTH, HEIGHT, values(run), Z=depths)
    for run in range(5):
        (folder / f"nights/{run}").mkdir()
        for frame in range(16):
            frames.grey_exr(folder / f"nights/{run}/{frame:02}.exr", WIDTH, HEIGHT,
                            values(frame * (run + 1)), Z=depths)
    (folder / "game").mkdir()
    for frame in range(16):
        picture(folder / f"game/frame{frame:04}.png", frame)


def make_files(folder):
    make_frames(folder)
    scenes = ROOT / "scenes"
    for source, name in (("catalog/fog_look_clouds.yaml", "my_clouds.yaml"),
                         ("studies/display/walk_out.yaml", "walk.yaml"),
                         ("studies/display/walk_out_chain.yaml", "walk_out_chain.yaml"),
                         ("studies/display/walk_out_chain.yaml", "chain.yaml")):
        text = (scenes / source).read_text()
        stem = pathlib.Path(name).stem
        (folder / name).write_text(re.sub(r"^name: .*", f"name: {stem}", text, flags=re.MULTILINE))
    (folder / "my_fog.yaml").write_text(FOG)
    (folder / "my_sweep.yaml").write_text(SWEEP)
    (folder / "config.ocio").write_text(OCIO)


class Examples(unittest.TestCase):
    maxDiff = None

    @classmethod
    def setUpClass(cls):
        cls.folder = neph_case.scratch(cls.addClassCleanup)
        make_files(cls.folder)
        (cls.folder / ".bin").mkdir()
        (cls.folder / ".bin/neph").symlink_to(NEPH)
        path = f"{cls.folder / '.bin'}:{os.environ['PATH']}"
        cls.environment = {**os.environ, "PATH": path, "SDL_VIDEODRIVER": "dummy"}
        cls.examples = list(examples())
        neph_case.run("bake", "gaussian_blob", "cloud.vdb", "--resolution", "4", cwd=cls.folder)
        neph_case.run("render", "my_fog.yaml", "-e", "exact", "--size", "16x9", "-o", "fog",
                      cwd=cls.folder)
        (cls.folder / "fog/my_fog_exact_0000.exr").rename(cls.folder / "fog.exr")

    def paste(self, command, codes):
        done = subprocess.run(["bash", "-c", command], cwd=self.folder, env=self.environment,
                              capture_output=True, text=True, timeout=900)
        self.assertIn(done.returncode, codes, (command, done.stdout[-2000:], done.stderr[-2000:]))
        return done

    def test_examples_are_lines_of_their_own(self):
        self.assertGreater(len(self.examples), 90)
        for verb, line in self.examples:
            self.assertRegex(line, r"^  (NEPH_\w+=\S+ )?neph \w", verb)

    def test_every_example_is_parsed(self):
        for _, line in self.examples:
            done = self.paste(command_of(line, "--help"), {0})
            self.assertEqual(done.stderr, "", line)  # no deprecated name

    def run_those(self, by_day):
        ran = 0
        for verb, line in self.examples:
            words, codes, is_by_day = rule_of(line.strip())
            if is_by_day == by_day:
                (self.folder / "my_fog.yaml").write_text(FOG)  # which an example rewrites
                with self.subTest(verb=verb, example=line):
                    self.paste(command_of(line, words), codes)
                    ran += 1
        self.assertGreater(ran, 20)

    def test_cheap_examples_run(self):
        self.run_those(True)

    @night.of_the_night
    def test_the_others_run(self):
        self.run_those(False)


if __name__ == "__main__":
    unittest.main()
