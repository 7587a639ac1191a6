#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""reduce.py FOLDER: TABLE.csv of each metric, pairs.csv and over_floor.csv from
FOLDER/flicker.csv, which goes.

TABLE.csv has the mean over seeds of a scene and a preset: flicker seen (contrast over threshold),
relative RMSE, half-life [frames], ghosts [area times frames]. pairs.csv has the geometric mean over
scenes of the first preset over each other one, with Student's 95 % interval of the logarithm, over
the scenes in which both have a value above 0. over_floor.csv has the flicker seen of each preset
over every pixel marched (off+taa=on), geometric means over scenes."""
import csv
import math
import pathlib
import statistics
import sys

METRICS = {"seen": "seen_contrast", "error": "rel_rmse", "half_life": "half_life_p50",
           "ghosts": "ghost_area_frames"}
FLOOR = "off+taa=on"
STUDENT_T = {9: 2.306, 10: 2.262, 11: 2.228, 12: 2.201, 17: 2.120}  # 97.5 %, by scenes


def write(path, rows):
    with path.open("w", newline="") as file:
        writer = csv.DictWriter(file, rows[0])
        writer.writeheader()
        writer.writerows(rows)


def main():
    folder = pathlib.Path(sys.argv[1])
    values, scenes, presets = {}, {}, {}
    with (folder / "flicker.csv").open(newline="") as file:
        for row in csv.DictReader(file):
            if row.get("is_floor") == "1":
                continue
            if row["mask"] == "all" and row["value"] and row["metric"] in METRICS.values():
                key = row["metric"], row["scene"], row["preset"]
                values.setdefault(key, []).append(float(row["value"]))
                scenes[row["scene"]] = presets[row["preset"]] = None
    means = {key: statistics.fmean(found) for key, found in values.items()}
    measured = {table: metric for table, metric in METRICS.items()
                if any(key[0] == metric for key in means)}
    first, *others = presets
    for table, metric in measured.items():
        write(folder / f"{table}.csv", [
            {"scene": scene} | {preset: f"{means[metric, scene, preset]:.6g}" for preset in presets
                                if (metric, scene, preset) in means}
            for scene in scenes if (metric, scene, first) in means])
    pairs = []
    for second in others:
        row = {"first": first, "second": second}
        for table, metric in measured.items():
            both = [(means.get((metric, scene, first), 0.0), means.get((metric, scene, second), 0.0))
                    for scene in scenes]
            logs = [math.log(a / b) for a, b in both if a > 0.0 and b > 0.0]
            mean = statistics.fmean(logs)
            half = STUDENT_T[len(logs)] * statistics.stdev(logs) / math.sqrt(len(logs))
            for name, value in (("times", mean), ("low", mean - half), ("high", mean + half)):
                row[f"{table}_{name}"] = f"{math.exp(value):.4g}"
            row[f"{table}_better"] = sum(value < 0.0 for value in logs)
        row["error_less_percent"] = f"{100.0 * (1.0 - float(row['error_times'])):.3g}"
        pairs.append(row)
    write(folder / "pairs.csv", pairs)
    write(folder / "over_floor.csv", [
        {"preset": preset, "seen_times": f"{math.exp(statistics.fmean(logs)):.4g}"}
        for preset in presets if "off" not in preset
        for logs in [[math.log(means[METRICS["seen"], scene, preset] /
                               means[METRICS["seen"], scene, FLOOR]) for scene in scenes]]])
    (folder / "flicker.csv").unlink()


if __name__ == "__main__":
    main()
