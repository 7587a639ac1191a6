#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""reduce.py FOLDER: from FOLDER/flicker_WIDTH_HZ.csv and, where there is one, FOLDER/causes.csv,
which go (seeds of a scene are averaged first):

floor.csv: each preset over its floor, geometric means over scenes with Student's 95 % interval of
the logarithm, for flicker seen, error, half-life and ghosts, at each size and frame rate, and the
number of scenes beyond 1.6 times. times_seen.csv, times_error.csv: the same as text, a column for
each size and rate. seen.csv, error.csv: flicker seen and error of each scene at 384x216 and 30 Hz,
and the floor of `fixed` and of `ours`. pairs.csv: `ours` over each preset at 30 Hz. causes.csv:
shares of the squared flicker seen [%]. causes_mean.csv: their means over scenes, and by how much
flicker seen falls with a part ideal [%]. rest.csv: `ours` over `ours2` in the scenes of
FOLDER/rest_SUITE.csv."""
import csv
import math
import pathlib
import statistics
import sys

STUDENT_T = {5: 2.776, 14: 2.160, 16: 2.131, 17: 2.120, 18: 2.110,
             32: 2.040, 36: 2.030, 41: 2.021}  # 97.5 %, by scenes
METRICS = {"seen": "seen_contrast", "error": "rel_rmse", "half_life": "half_life_p50",
           "ghosts": "ghost_area_frames"}
MUCH = 1.6  # times the floor
WIDTH_OF_SCENES = 384


def write(path, rows):
    with path.open("w", newline="") as file:
        writer = csv.DictWriter(file, rows[0])
        writer.writeheader()
        writer.writerows(rows)


def read(path):
    with path.open(newline="") as file:
        rows = list(csv.DictReader(file))
    path.unlink()
    return rows


def means_over_seeds(rows):
    """{metric: {preset: {scene: (value, floor or None)}}}, of the whole image."""
    seeds = {}
    for row in rows:
        if row["mask"] == "all" and row["value"] and row["is_floor"] == "0":
            key = row["metric"], row["preset"], row["scene"]
            seeds.setdefault(key, []).append((float(row["value"]), row["floor"]))
    found = {}
    for (metric, preset, scene), pairs in seeds.items():
        floors = [float(floor) for _, floor in pairs if floor]
        mean = (statistics.fmean(value for value, _ in pairs),
                statistics.fmean(floors) if len(floors) == len(pairs) else None)
        found.setdefault(metric, {}).setdefault(preset, {})[scene] = mean
    return found


def interval(values):
    """Mean and the ends of its 95 % interval."""
    mean = statistics.fmean(values)
    half = STUDENT_T[len(values)] * statistics.stdev(values) / math.sqrt(len(values))
    return mean, mean - half, mean + half


def ratio_fields(name, times):
    """Geometric mean over scenes of `times`, {scene: ratio}, and its interval."""
    ends = interval([math.log(value) for value in times.values()])
    return {f"{name}_{end}": f"{math.exp(value):.4g}"
            for end, value in zip(("times", "low", "high"), ends)}


def over_floor(means, width, hz):
    found = []
    for preset in means["seen_contrast"]:
        line = {"width": width, "hz": hz, "preset": preset}
        for name in ("seen", "error"):
            times = {scene: value / floor
                     for scene, (value, floor) in means[METRICS[name]][preset].items() if floor}
            line |= ratio_fields(name, times)
            line[f"{name}_most"] = f"{max(times.values()):.4g}"
            line[f"{name}_most_in"] = max(times, key=times.get)
            line[f"{name}_beyond"] = sum(value > MUCH for value in times.values())
        found.append(line)
    return found


def times_as_text(floors, name):
    lines = {}
    for row in floors:
        line = lines.setdefault(row["preset"], {"preset": row["preset"]})
        times, low, high = (float(row[f"{name}_{end}"]) for end in ("times", "low", "high"))
        line[f"{row['width']}_{row['hz']}Hz"] = f"{times:.2f} ({low:.2f} to {high:.2f})"
    return list(lines.values())


def by_scene(presets):
    """A line for each scene, and the floors of `fixed` and of `ours`."""
    lines = {}
    for preset, scenes in presets.items():
        for scene, (value, floor) in scenes.items():
            line = lines.setdefault(scene, {"scene": scene})
            line[preset] = f"{value:.6g}"
            if preset in ("fixed", "ours"):
                line[f"floor_{preset}"] = f"{floor:.6g}"
    return list(lines.values())


def pairs(means, width):
    """The preset `ours` over each other one, in the scenes in which both have a value above 0."""
    lines = []
    for other in means["seen_contrast"]:
        if other == "ours":
            continue
        line = {"width": width, "second": other}
        for name, metric in METRICS.items():
            presets = means.get(metric, {})
            values = presets.get(other, {})
            times = {scene: value / values[scene][0]
                     for scene, (value, _) in presets.get("ours", {}).items()
                     if scene in values and value > 0.0 and values[scene][0] > 0.0}
            if times:
                line |= ratio_fields(name, times)
                line[f"{name}_better"] = sum(value < 1.0 for value in times.values())
                line[f"{name}_worse"] = sum(value > 1.0 for value in times.values())
        lines.append(line)
    return lines


def causes(rows):
    lines = {}
    for row in rows:
        line = lines.setdefault(row["scene"], {"scene": row["scene"], "seen": row["seen"]})
        line[row["part"]] = row["percent"]
    return list(lines.values())


def mean_causes(rows):
    lines = []
    for part in dict.fromkeys(row["part"] for row in rows):
        own = {row["scene"]: row for row in rows if row["part"] == part}
        mean, low, high = interval([float(row["percent"]) for row in own.values()])
        most = max(own, key=lambda scene: float(own[scene]["percent"]))
        falls = [float(row["gain"]) / float(row["seen"]) for row in own.values() if row["gain"]]
        lines.append({"part": part, "share": f"{mean:.4g}", "low": f"{low:.4g}",
                      "high": f"{high:.4g}", "most": own[most]["percent"], "most_in": most,
                      "falls": f"{100 * statistics.fmean(falls):.3g}" if falls else ""})
    return sorted(lines, key=lambda line: -float(line["share"]))


def main():
    folder = pathlib.Path(sys.argv[1])
    floors, ours_over = [], []
    for path in sorted(folder.glob("flicker_*.csv")):
        _, width, hz = path.stem.split("_")
        means = means_over_seeds(read(path))
        floors += over_floor(means, int(width), int(hz))
        if hz == "30":
            ours_over += pairs(means, int(width))
        if (int(width), hz) == (WIDTH_OF_SCENES, "30"):
            for name in ("seen", "error"):
                write(folder / f"{name}.csv", by_scene(means[METRICS[name]]))
    write(folder / "floor.csv", floors)
    write(folder / "pairs.csv", ours_over)
    for name in ("seen", "error"):
        write(folder / f"times_{name}.csv", times_as_text(floors, name))
    rest = [row for path in sorted(folder.glob("rest_*.csv")) for row in read(path)]
    if rest:
        write(folder / "rest.csv", pairs(means_over_seeds(rest), 192))
    if (folder / "causes.csv").exists():
        rows = read(folder / "causes.csv")
        write(folder / "causes.csv", causes(rows))
        write(folder / "causes_mean.csv", mean_causes(rows))


if __name__ == "__main__":
    main()
