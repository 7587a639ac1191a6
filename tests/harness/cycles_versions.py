#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The errors of different Blenders, run by hand: several seeds of each scene of the catalogue.

    cycles_versions.py NEPH OUTPUT.json [--blender PATH]... [--scene NAME]... [--seeds N]
                       [--samples N] [--size WxH] [--modes default,biased]

Mode "default" marches without steps where a Blender supports this, "biased" marches in steps.

For each Blender and scene it renders the radiance with N seeds in one process, from the
specification that `neph export` writes, by scripts/blender_render.py. It compares means over the
image with `exact`, where that supports the scene, or with the tracer's mean of four seeds. A row
has

    bias     mean of the seeds over the reference, less 1
    error    standard error of the bias, from the scatter of the seeds (and of the tracer's)
    z        bias / error
    spread   scatter of the seeds' means, divided by the scatter that independent pixels with the
             same noise would give: 1 if pixels are independent
    noise    relative standard deviation of a pixel at these samples, root mean square
    negative pixels below 0, of all seeds, and their sum over the sum of all
    cpu_s    processor time of one radiance image, without start-up
    T        rms and largest error of the transmittance against `exact`, where it supports it
"""
import argparse
import datetime
import json
import math
import os
import pathlib
import platform
import statistics
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).parent))
from frames import read_exr  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parents[2]
SCRIPT = ROOT / "scripts/blender_render.py"

# Runs inside Blender: the project's script without its last line, then every seed.
LOOP = """
import json, sys, time
code = open("blender_render.py").read()
assert code.rstrip().splitlines()[-1].startswith("main(")
exec("\\n".join(code.rstrip().splitlines()[:-1]))
spec = json.load(open("spec.json"))
plan = json.load(open("plan.json"))
is_unbiased = False
bpy.ops.wm.read_factory_settings(use_empty=True)
seconds = []
for number, entry in enumerate(plan):
    if entry["pass"]["is_unbiased"] is None:
        entry["pass"]["is_unbiased"] = has(bpy.context.scene.cycles, "volume_biased")
        is_unbiased = entry["pass"]["is_unbiased"]
    scene = build(spec, entry["pass"])
    for seed in entry["seeds"]:
        scene.cycles.seed = seed
        scene.render.filepath = os.path.join(os.getcwd(), f"image{number}_{seed}.exr")
        start = time.process_time()
        render(scene)
        seconds.append([number, seed, time.process_time() - start])
told = {"version": bpy.app.version_string, "is_unbiased": is_unbiased, "seconds": seconds}
json.dump(told, open("seconds.json", "w"))
"""


def rgb(path):
    channels = read_exr(path)[2]
    return [channels["pass.Combined." + c] for c in "RGB"]


def run(command, **more):
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, **more)
    if done.returncode != 0:
        raise RuntimeError(f"{command[0]}: {done.returncode}: {(done.stdout + done.stderr)[-400:]}")
    return done.stdout


def mean(plane):
    return math.fsum(plane) / len(plane)


class Reference:
    """Means of each colour, their standard errors, and the transmittance."""

    def __init__(self, neph, scene, size, folder):
        self.transmittance = None
        try:
            run([neph, "render", scene, "-e", "exact", "--size", size, "-o", folder / "exact",
                 "-q"])
            frames, self.name = [next((folder / "exact").glob("*.exr"))], "exact"
        except RuntimeError:
            frames, self.name = [], "tracer, 4 x 2048"
            for seed in range(101, 105):
                run([neph, "render", scene, "-e", "tracer", "--size", size, "--seed", seed, "-s",
                     "samples=2048", "-o", folder / f"tracer{seed}", "-q"])
                frames.append(next((folder / f"tracer{seed}").glob("*.exr")))
        channels = [read_exr(frame)[2] for frame in frames]
        self.means = [[mean(c[k]) for c in channels] for k in "RGB"]
        if self.name == "exact" and "transmittance.G" in channels[0]:
            self.transmittance = [channels[0]["transmittance." + k] for k in "RGB"]

    def grey(self):
        values = [sum(m[i] for m in self.means) / 3 for i in range(len(self.means[0]))]
        error = statistics.stdev(values) / math.sqrt(len(values)) if len(values) > 1 else 0.0
        return statistics.mean(values), error


def passes_of(spec, kind):
    return [entry for entry in spec["passes"] if entry["kind"] == kind]


def render(blender, spec, files, mode, seeds, samples, folder):
    """Returns planes of grey radiance by seed, the transmittance, and the seconds of a radiance
    image."""
    folder.mkdir()
    for path in files:
        (folder / path.name).write_bytes(path.read_bytes())
    (folder / "loop.py").write_text(LOOP)
    (folder / "spec.json").write_text(json.dumps({**spec, "threads": 2}))
    radiance = [{**entry, "samples": samples, "is_unbiased": None if mode == "default" else False}
                for entry in passes_of(spec, "radiance")]
    once = passes_of(spec, "emission") + passes_of(spec, "transmittance")
    plan = [{"pass": entry, "seeds": list(range(1, seeds + 1))} for entry in radiance]
    plan += [{"pass": entry, "seeds": [1]} for entry in once]
    (folder / "plan.json").write_text(json.dumps(plan))
    run([blender, "-b", "--factory-startup", "-noaudio", "-t", "2", "--python-exit-code", "7",
         "--python", "loop.py"], cwd=folder,
        env={k: v for k, v in os.environ.items() if k != "PWD"})  # Blender would use it
    told = json.loads((folder / "seconds.json").read_text())

    def planes(number, seed):
        return rgb(folder / f"image{number}_{seed}.exr")

    emission = [planes(len(radiance) + i, 1) for i in range(len(passes_of(spec, "emission")))]
    by_seed = []
    for seed in range(1, seeds + 1):
        images = [planes(number, seed) for number in range(len(radiance))]
        colours = images[0] if len(images) == 1 else [images[c][c] for c in range(3)]
        if emission:
            glow = emission[0] if len(emission) == 1 else [emission[c][c] for c in range(3)]
            colours = [[a + b for a, b in zip(x, y)] for x, y in zip(colours, glow)]
        by_seed.append([sum(values) / 3 for values in zip(*colours)])
    seconds = sum(s for number, _, s in told["seconds"] if number < len(radiance)) / seeds
    return by_seed, planes(len(plan) - 1, 1), seconds, told


def row_of(by_seed, reference, seconds):
    truth, truth_error = reference.grey()
    means = [mean(plane) for plane in by_seed]
    pixels, seeds = len(by_seed[0]), len(by_seed)
    variances = [statistics.variance([plane[p] for plane in by_seed]) for p in range(pixels)]
    scatter = statistics.stdev(means)
    independent = math.sqrt(math.fsum(variances)) / pixels
    error = math.hypot(scatter / math.sqrt(seeds), truth_error) / truth
    bias = statistics.mean(means) / truth - 1.0
    below = [value for plane in by_seed for value in plane if value < 0.0]
    return {"bias": bias, "error": error, "z": bias / error if error > 0.0 else None,
            "spread": scatter / independent if independent > 0.0 else None,
            "noise": math.sqrt(mean(variances)) / truth, "negative": len(below),
            "negative_sum": math.fsum(below) / math.fsum(map(math.fsum, by_seed)),
            "cpu_s": seconds}


def transmittance_of(planes, reference):
    if reference.transmittance is None:
        return {}
    off = [abs(a - b) for x, y in zip(planes, reference.transmittance) for a, b in zip(x, y)]
    return {"T_rms": math.sqrt(mean([d * d for d in off])), "T_max": max(off)}


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("neph")
    parser.add_argument("output", type=pathlib.Path)
    parser.add_argument("--blender", action="append", default=[])
    parser.add_argument("--scene", action="append", default=[])
    parser.add_argument("--seeds", type=int, default=8)
    parser.add_argument("--samples", type=int, default=64)
    parser.add_argument("--size", default="32x18")
    parser.add_argument("--modes", default="default")
    given = parser.parse_args()
    names = given.scene or sorted(p.stem for p in (ROOT / "scenes/catalog").glob("*.yaml"))
    document = {"date": datetime.date.today().isoformat(), "command": " ".join(sys.argv[2:]),
                "host": f"{platform.processor() or platform.machine()}, {os.cpu_count()} cores",
                "neph": run([given.neph, "--version"]).strip(), "size": given.size,
                "samples": given.samples, "seeds": given.seeds, "rows": []}
    environment = {**os.environ, "NEPH_BLENDER": ":".join(given.blender)}
    for name in names:
        with tempfile.TemporaryDirectory(prefix="neph-versions-") as scratch:
            folder = pathlib.Path(scratch)
            try:
                run([given.neph, "export", name, "-e", "cycles", "--size", given.size, "-o",
                     folder / "files"], env=environment)
                reference = Reference(given.neph, name, given.size, folder)
            except (RuntimeError, StopIteration) as error:
                print(f"{name}: {error}", file=sys.stderr)
                continue
            spec = json.loads((folder / "files/spec.json").read_text())
            files = [p for p in (folder / "files").iterdir() if p.suffix in (".py", ".vdb")]
            for i, blender in enumerate(given.blender):
                for mode in given.modes.split(","):
                    try:
                        by_seed, through, seconds, told = render(
                            blender, spec, files, mode, given.seeds, given.samples,
                            folder / f"{i}{mode}")
                    except RuntimeError as error:
                        print(f"{name}, {blender}, {mode}: {str(error)[-300:]}", file=sys.stderr)
                        continue
                    row = {"scene": name, "blender": told["version"], "mode":
                           "unbiased" if told["is_unbiased"] else "steps",
                           "reference": reference.name, "voxels": any(
                               "grid" in medium for medium in spec["media"]),
                           **row_of(by_seed, reference, seconds),
                           **transmittance_of(through, reference)}
                    document["rows"].append(row)
                    given.output.write_text(json.dumps(document, indent=1) + "\n")
                    print(json.dumps(row), flush=True)


if __name__ == "__main__":
    main()
