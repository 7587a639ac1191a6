#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""reduce.py FOLDER: seen.csv, error.csv and pairs.csv from FOLDER/flicker.csv, which goes.

seen.csv and error.csv: the mean over seeds of a scene and a preset, of the flicker seen (contrast
over threshold) and of the relative RMSE. pairs.csv: the geometric mean over scenes of the first
preset over each other one, with Student's 95 % interval of the logarithm."""
import csv
import math
import pathlib
import statistics
import sys

METRICS = {"seen": "seen_contrast", "error": "rel_rmse"}
T_OF_12 = 2.201  # Student's t, 11 degrees of freedom, 97.5 %


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
            if row["mask"] == "all" and row["value"] and row["metric"] in METRICS.values():
                key = row["metric"], row["scene"], row["preset"]
                values.setdefault(key, []).append(float(row["value"]))
                scenes[row["scene"]] = presets[row["preset"]] = None
    means = {key: statistics.fmean(found) for key, found in values.items()}
    assert len(scenes) == 12, "t is of 12 scenes"
    for table, metric in METRICS.items():
        write(folder / f"{table}.csv", [
            {"scene": scene} | {preset: f"{means[metric, scene, preset]:.6g}" for preset in presets}
            for scene in scenes])
    first, *others = presets
    pairs = []
    for second in others:
        row = {"first": first, "second": second}
        for table, metric in METRICS.items():
            logs = [math.log(means[metric, scene, first] / means[metric, scene, second])
                    for scene in scenes]
            mean = statistics.fmean(logs)
            half = T_OF_12 * statistics.stdev(logs) / math.sqrt(len(logs))
            for name, value in (("times", mean), ("low", mean - half), ("high", mean + half)):
                row[f"{table}_{name}"] = f"{math.exp(value):.4g}"
            row[f"{table}_better"] = sum(value < 0.0 for value in logs)
        row["error_less_percent"] = f"{100.0 * (1.0 - float(row['error_times'])):.3g}"
        pairs.append(row)
    write(folder / "pairs.csv", pairs)
    (folder / "flicker.csv").unlink()


if __name__ == "__main__":
    main()
