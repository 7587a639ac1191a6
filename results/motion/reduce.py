#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""reduce.py FOLDER: from FOLDER/flicker_WIDTH_HZ.csv and FOLDER/causes.csv, which go:

floor.csv: each preset over its floor, geometric means over scenes with Student's 95 % interval of
the logarithm, for flicker seen and error, at each size and frame rate. times_seen.csv,
times_error.csv: the same as text, a column for each size and rate. seen.csv: flicker seen of each
scene at 384x216 and 30 Hz, and the floor of `fixed` and of `ours`. pairs.csv: `ours` over each
preset, at that size and rate. causes.csv: shares of the squared flicker seen [%]. causes_mean.csv:
their means over scenes, and by how much flicker seen falls with a part ideal [%]."""
import csv
import math
import pathlib
import statistics
import sys

STUDENT_T = {16: 2.131, 17: 2.120, 18: 2.110}  # 97.5 %, by scenes
METRICS = {"seen": "seen_contrast", "error": "rel_rmse"}


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


def interval(values):
    """Mean and the ends of its 95 % interval."""
    mean = statistics.fmean(values)
    half = STUDENT_T[len(values)] * statistics.stdev(values) / math.sqrt(len(values))
    return mean, mean - half, mean + half


def rows_of_metric(rows, metric):
    return [row for row in rows if row["metric"] == metric and row["mask"] == "all" and
            row["value"] and row["is_floor"] == "0"]


def over_floor(rows, width, hz):
    found = []
    for preset in dict.fromkeys(row["preset"] for row in rows if row["is_floor"] == "0"):
        line = {"width": width, "hz": hz, "preset": preset}
        for name, metric in METRICS.items():
            times = {row["scene"]: float(row["scene_times_floor"])
                     for row in rows_of_metric(rows, metric)
                     if row["preset"] == preset and row["scene_times_floor"]}
            mean, low, high = interval([math.log(value) for value in times.values()])
            for end, value in (("times", mean), ("low", low), ("high", high)):
                line[f"{name}_{end}"] = f"{math.exp(value):.4g}"
            line[f"{name}_most"] = f"{max(times.values()):.4g}"
            line[f"{name}_most_in"] = max(times, key=times.get)
        found.append(line)
    return found


def times_as_text(floors, name):
    lines = {}
    for row in floors:
        line = lines.setdefault(row["preset"], {"preset": row["preset"]})
        times, low, high = (float(row[f"{name}_{end}"]) for end in ("times", "low", "high"))
        line[f"{row['width']}_{row['hz']}Hz"] = f"{times:.2f} ({low:.2f} to {high:.2f})"
    return list(lines.values())


def seen_by_scene(rows):
    lines = {}
    for row in rows_of_metric(rows, METRICS["seen"]):
        line = lines.setdefault(row["scene"], {"scene": row["scene"]})
        line[row["preset"]] = row["value"]
        if row["preset"] in ("fixed", "ours"):
            line[f"floor_{row['preset']}"] = row["floor"]
    return list(lines.values())


def pairs(rows):
    """The preset `ours` over each other one."""
    lines = []
    for other in dict.fromkeys(row["preset"] for row in rows if row["is_floor"] == "0"):
        line = {"second": other}
        for name, metric in METRICS.items() if other != "ours" else ():
            values = {(row["scene"], row["preset"]): float(row["value"])
                      for row in rows_of_metric(rows, metric)}
            logs = {scene: math.log(values[scene, "ours"] / value)
                    for (scene, preset), value in values.items() if preset == other}
            for end, value in zip(("times", "low", "high"), interval(list(logs.values()))):
                line[f"{name}_{end}"] = f"{math.exp(value):.4g}"
            line[f"{name}_better"] = sum(value < 0.0 for value in logs.values())
        lines += [line] * (len(line) > 1)
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
    floors = []
    for path in sorted(folder.glob("flicker_*.csv")):
        _, width, hz = path.stem.split("_")
        rows = read(path)
        floors += over_floor(rows, int(width), int(hz))
        if (width, hz) == ("384", "30"):
            write(folder / "seen.csv", seen_by_scene(rows))
            write(folder / "pairs.csv", pairs(rows))
    write(folder / "floor.csv", floors)
    for name in METRICS:
        write(folder / f"times_{name}.csv", times_as_text(floors, name))
    rows = read(folder / "causes.csv")
    write(folder / "causes.csv", causes(rows))
    write(folder / "causes_mean.csv", mean_causes(rows))


if __name__ == "__main__":
    main()
