#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The presets of engine `realtime` side by side: flicker at depth edges, half-life, error.

Every preset renders the same scenes with the same steps, so with the same density evaluations per
pixel. The reference is the march with these steps, frame by frame: before a camera at rest as it is,
before a moving one with the preset's own anti-aliasing behind it (`off` with taa=on), or the jagged
edges of the march would be taken for flicker of the preset. For each scene and seed:

  a4        95th percentile at depth edges of the amplitude at the period of four frames [display]
  std       95th percentile there of the standard deviation over time [display]
  error     relative RMSE over the whole picture, mean of the frames
  half-life 95th percentile over the picture of the frames until half of a step of the sun's light
            is followed: the same scene, its sun four times as bright from frame 32 on (a scene with
            a sun of its own in motion, or a camera, is left out)

What two presets differ by is taken per scene, in decades (seeds of a scene are averaged first: they
share its geometry): mean, its 95 % interval by Student's t over scenes, how many scenes are better,
worse and alike. A half-life is left out where in either preset more than 5 % of the pixels never get
there, because they were wrong by more than half of the step to begin with.

  scripts/realtime_study.py --neph build/release/neph --work /tmp/study --markdown study.md
  scripts/realtime_study.py --presets seed,fixed,ours --scenes fence_pitch4 --seeds 1
"""
import argparse
import json
import math
import os
import re
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor

SCENES = {  # name: camera and sun at rest?
    "fence_pitch4": True,
    "foliage": True,
    "ridges": True,
    "fence_backlit": True,
    "fence_sky": True,
    "sphere_in_fog": True,
    "gaussian_blob": True,
    "camera_pan": False,
    "wind_cloud": False,
    "sun_step": False,
}
STEP_FRAME = 32  # of the sun's step
LAG_FRAMES = 48  # that are watched from there on
T_975 = [math.nan, 12.71, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262, 2.228, 2.201, 2.179]


class Study:
    def __init__(self, options):
        self.options = options
        self.env = dict(os.environ)

    def path(self, *parts):
        return os.path.join(self.options.work, *parts)

    def run(self, *arguments, codes=(0,)):
        done = subprocess.run([self.options.neph, *arguments], capture_output=True, text=True, env=self.env)
        if done.returncode not in codes:
            sys.exit(f"{' '.join(arguments)}\nended with {done.returncode}: {done.stderr}")
        return done.stdout

    def render(self, folder, scene, *arguments, frames):
        if os.path.isdir(folder) and len([f for f in os.listdir(folder) if f.endswith(".exr")]) >= frames:
            return
        self.run("render", scene, "--size", self.options.size, "--frames", str(frames), "-q", "-o", folder,
                 "--set", f"steps={self.options.steps}", *arguments)

    def step_scene(self, name):
        """A copy of the scene whose sun becomes four times as bright at STEP_FRAME; None: it moves."""
        with open(find_scene(name)) as file:
            text = file.read()
        found = re.search(r"^sun: \{direction: (\[[^\]]*\]), irradiance_w_per_m2: \[([^\]]*)\]\}$", text, re.M)
        if not found:
            sys.exit(f"{name}: its sun is not on one line")
        dim = ", ".join(f"{float(x) / 4:.9g}" for x in found[2].split(","))
        keys = "".join(f"    - {{frame: {frame}, direction: {found[1]}, irradiance_w_per_m2: [{value}]}}\n"
                       for frame, value in ((STEP_FRAME - 1, dim), (STEP_FRAME, found[2])))
        text = text[:found.start()] + "sun:\n  keys:\n" + keys.rstrip("\n") + text[found.end():]
        text = re.sub(r"^frames: .*\n", "", text, flags=re.M)
        text = re.sub(r"^name: .*$", f"name: {name}_step\nframes: {{count: {STEP_FRAME + LAG_FRAMES}, rate_hz: 30}}", text, flags=re.M)
        os.makedirs(self.path("scenes"), exist_ok=True)
        path = self.path("scenes", f"{name}_step.yaml")
        with open(path, "w") as file:
            file.write(text)
        return path

    def preset_arguments(self, preset):
        name, *changes = preset.split("+")
        return ["-e", "realtime", "--preset", name] + [a for change in changes for a in ("--set", change)]

    def anti_aliasing(self, preset):
        """What the preset sets of TAA, as arguments."""
        name, *changes = preset.split("+")
        known = json.loads(self.run("engines", "realtime", "--json"))[0]["presets"]
        settings = next(p["settings"] for p in known if p["name"] == name).split() + changes
        return [a for s in settings if s.startswith("taa") for a in ("--set", s)]

    def reference(self, scene, at_rest, preset):
        """Folder of the reference's frames; made by references()."""
        if at_rest:
            return self.path("march", scene)
        return self.path("march" + "".join(self.anti_aliasing(preset)[1::2]).replace("=", "-"), scene)

    def references(self, scene, at_rest, preset):
        folder = self.reference(scene, at_rest, preset)
        if not at_rest:
            self.render(folder, scene, "-e", "realtime", "--preset", "off", "--set", "taa=on", "--set", "warm_up=32",
                        *self.anti_aliasing(preset), "--scene-layers", frames=self.options.frames)
        else:
            self.render(folder, scene, "-e", "march", "--scene-layers", frames=1)
            self.render(self.path("march", f"{scene}_step"), self.step_scene(scene), "-e", "march",
                        frames=STEP_FRAME + LAG_FRAMES)

    def flicker(self, reference, test, *arguments):
        # 1: frames are frozen, which the table says; 3 and others are errors.
        out = self.run("flicker", "--reference", reference, test, "--json", "-q", *arguments, codes=(0, 1))
        return json.loads(out)

    def measure(self, scene, at_rest, preset, seed):
        arguments = self.preset_arguments(preset) + ["--seed", str(seed)]
        if preset.split("+")[0] != "off":
            arguments += ["--set", "warm_up=32"]
        folder = self.path(f"{preset}.{seed}".replace("=", "-"), scene)
        self.render(folder, scene, *arguments, "--scene-layers", frames=self.options.frames)
        found = self.flicker(self.reference(scene, at_rest, preset), folder, "-m", "a4_p95", "-m", "std_p95", "-m", "rel_rmse",
                             "-m", "cyclic_share")
        result = {
            "scene": scene, "preset": preset, "seed": seed, "frozen": found["frozen"],
            "a4": value(found, "a4_p95", "depth_edge"), "std": value(found, "std_p95", "depth_edge"),
            "cyclic": value(found, "cyclic_share", "depth_edge"),
            "a4_all": value(found, "a4_p95", "all"), "error": value(found, "rel_rmse", "all"),
        }
        if at_rest:
            folder += "_step"
            self.render(folder, self.path("scenes", f"{scene}_step.yaml"), *arguments, frames=STEP_FRAME + LAG_FRAMES)
            found = self.flicker(self.path("march", f"{scene}_step"), folder, "-m", "half_life_p95",
                                 "-m", "half_life_p50", "-m", "frames_to_10_p95", "-s", f"lag.step_frame={STEP_FRAME}")
            result["half_life"] = value(found, "half_life_p95", "all")
            result["half_life_p50"] = value(found, "half_life_p50", "all")
            result["to_10"] = value(found, "frames_to_10_p95", "all")
        return result


def find_scene(name):
    data = os.environ.get("NEPH_DATA_DIR", os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
    for folder in ("catalog", "failure"):
        path = os.path.join(data, "scenes", folder, f"{name}.yaml")
        if os.path.exists(path):
            return path
    sys.exit(f"there is no scene {name}")


def value(found, metric, mask):
    """Of radiance; the mean where there is one value a frame."""
    values = [m["value"] for m in found["measurements"]
              if m["metric"] == metric and m["mask"] == mask and m["quantity"] == "radiance" and m["value"] is not None]
    return sum(values) / len(values) if values else math.nan


def per_scene(results, preset, key):
    scenes = {}
    for r in results:
        if r["preset"] == preset and not math.isnan(r.get(key, math.nan)):
            scenes.setdefault(r["scene"], []).append(r[key])
    return {scene: sum(values) / len(values) for scene, values in scenes.items()}


FLOOR = 1e-5  # of a4: a four-hundredth of an 8-bit step; what is below is alike


def paired(results, ours, other, key):
    """Mean of log10(ours / other) over scenes, half width of its 95 % interval, scenes better, worse, alike."""
    a, b = per_scene(results, ours, key), per_scene(results, other, key)
    never = LAG_FRAMES - 1 if key == "half_life" else math.inf
    differences = [math.log10(max(a[s], FLOOR) / max(b[s], FLOOR))
                   for s in a if s in b and a[s] < never and b[s] < never]
    n = len(differences)
    if n < 2:
        return None
    mean = sum(differences) / n
    deviation = math.sqrt(sum((d - mean) ** 2 for d in differences) / (n - 1))
    better, worse = sum(d < 0 for d in differences), sum(d > 0 for d in differences)
    return mean, T_975[min(n - 1, 12)] * deviation / math.sqrt(n), better, worse, n - better - worse


def table(results, presets, key, form):
    scenes = list(dict.fromkeys(r["scene"] for r in results if not math.isnan(r.get(key, math.nan))))
    lines = ["| scene | " + " | ".join(presets) + " |", "| --- |" + " ---: |" * len(presets)]
    for scene in scenes:
        cells = [per_scene(results, p, key).get(scene, math.nan) for p in presets]
        lines.append(f"| {scene} | " + " | ".join(form.format(c) for c in cells) + " |")
    return "\n".join(lines)


def report(results, presets):
    parts = []
    for key, title, form in (("a4", "A4 at depth edges, 95th percentile, in 1/1000 of display white", "{:.3f}"),
                             ("std", "Standard deviation over time there, in 1/1000", "{:.3f}"),
                             ("cyclic", "Share of the depth edges' pixels whose flicker is cyclic, in 1/1000", "{:.1f}"),
                             ("half_life", "Half-life, 95th percentile [frames]", "{:.2f}"),
                             ("to_10", "Frames to 10 %, 95th percentile", "{:.2f}"),
                             ("error", "Relative RMSE, in 1/1000", "{:.2f}")):
        factor = 1 if key in ("half_life", "to_10") else 1000
        scaled = [{**r, key: r.get(key, math.nan) * factor} for r in results]
        parts.append(f"**{title}**\n\n{table(scaled, presets, key, form)}\n")
    rows = ["| against | a4 [decades] | better, worse, alike | half-life [decades] | better, worse, alike |",
            "| --- | ---: | ---: | ---: | ---: |"]
    ours = presets[-1]
    for other in presets[:-1]:
        cells = []
        for key in ("a4", "half_life"):
            found = paired(results, ours, other, key)
            cells += ["-", "-"] if not found else [f"{found[0]:+.2f} ± {found[1]:.2f}", "{}, {}, {}".format(*found[2:])]
        rows.append(f"| {other} | " + " | ".join(cells) + " |")
    parts.append(f"**`{ours}` minus each other, paired by scene (95 % intervals)**\n\n" + "\n".join(rows) + "\n")
    return "\n".join(parts)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--neph", default="build/release/neph", help="the program (default: %(default)s)")
    parser.add_argument("--work", default="study", help="folder for frames; what is there is reused (default: %(default)s)")
    parser.add_argument("--presets", default="seed,fixed,ue,c52e,unity,ours",
                        help="the last is held against the others; PRESET+KEY=VALUE changes one (default: %(default)s)")
    parser.add_argument("--scenes", default=",".join(SCENES),
                        help="default: all ten; others are taken to be at rest")
    parser.add_argument("--seeds", type=int, default=2, help="of the dithers (default: %(default)s)")
    parser.add_argument("--size", default="320x180")
    parser.add_argument("--steps", type=int, default=32)
    parser.add_argument("--frames", type=int, default=64, help="a multiple of 4 (default: %(default)s)")
    parser.add_argument("--jobs", type=int, default=2, help="at once (default: %(default)s)")
    parser.add_argument("--markdown", help="file for the tables")
    parser.add_argument("--json", help="file for the numbers")
    options = parser.parse_args()
    presets, scenes = options.presets.split(","), options.scenes.split(",")
    study = Study(options)
    with ThreadPoolExecutor(options.jobs) as pool:
        references = {study.reference(s, SCENES.get(s, True), p): (s, SCENES.get(s, True), p) for s in scenes for p in presets}
        list(pool.map(lambda r: study.references(*r), references.values()))
        work = [(s, SCENES.get(s, True), p, seed) for s in scenes for p in presets for seed in range(1, options.seeds + 1)]
        results = list(pool.map(lambda w: study.measure(*w), work))
    for result in results:
        if result["frozen"]:
            print(f"{result['scene']} {result['preset']}: {result['frozen']} frames are frozen", file=sys.stderr)
    text = report(results, presets)
    print(text)
    if options.markdown:
        with open(options.markdown, "w") as file:
            file.write(text)
    if options.json:
        with open(options.json, "w") as file:
            json.dump(results, file, indent=1)


if __name__ == "__main__":
    main()
