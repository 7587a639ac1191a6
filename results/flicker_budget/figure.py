#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""figure.py FOLDER: flicker_budget.svg from FOLDER/PRESET.csv, the output of `neph flicker --csv`.

A bar for each preset: the parts of the variance of (frame - reference) over time, which add up to
1. A part is the square of the metric cycle_P (period P), cycle_drift or cycle_noise over all
pixels; parts below 4 % are drawn together."""
import csv
import pathlib
import sys

PRESETS = ("seed", "ue", "ours")
SHADES = ("#222", "#555", "#888", "#aaa", "#ccc", "#e4e4e4", "#fff")
LEFT, WIDTH, ROW = 70, 560, 62


def parts(path):
    """[(name, share)] of a preset, the largest first, and the RMS of the whole."""
    values = {}
    with path.open(newline="") as file:
        for row in csv.DictReader(file):
            if (row["quantity"], row["mask"]) == ("radiance", "all") and row["value"]:
                values[row["metric"]] = float(row["value"])
    names = [name for name in values
             if name in ("cycle_drift", "cycle_noise") or name.removeprefix("cycle_").isdigit()]
    whole = values["cycle_std"] ** 2
    shares = sorted(((name, values[name] ** 2 / whole) for name in names), key=lambda p: -p[1])
    large = [(name, share) for name, share in shares if share >= 0.04]
    return large + [("other", 1.0 - sum(share for _, share in large))], values["cycle_std"]


def words(name):
    name = name.removeprefix("cycle_")
    return f"period {name}" if name.isdigit() else name


def main():
    folder = pathlib.Path(sys.argv[1])
    height = ROW * len(PRESETS) + 56
    out = [f'<svg xmlns="http://www.w3.org/2000/svg" width="820" height="{height}" '
           f'viewBox="0 0 820 {height}" font-family="sans-serif" font-size="12">',
           '<rect width="100%" height="100%" fill="#fff"/>',
           '<text x="12" y="22" font-size="14" font-weight="bold">Parts of the variance of (frame - '
           'reference) over time, scene railings</text>']
    for number, preset in enumerate(PRESETS):
        found, rms = parts(folder / f"{preset}.csv")
        y, x = 40 + ROW * number, float(LEFT)
        out.append(f'<text x="{LEFT - 8}" y="{y + 19}" text-anchor="end" font-weight="bold">{preset}'
                   f'</text><text x="{LEFT + WIDTH + 12}" y="{y + 19}">RMS {1000 * rms:.2f} / 1000 '
                   'of white</text>')
        for shade, (name, share) in zip(SHADES, found):
            width = WIDTH * share
            out.append(f'<rect x="{x:.1f}" y="{y}" width="{width:.1f}" height="28" fill="{shade}" '
                       'stroke="#222"/>')
            if share > 0.03:
                out.append(f'<text x="{x + width / 2:.1f}" y="{y + 43}" text-anchor="middle">'
                           f'{words(name) if share > 0.09 else words(name).split()[-1]}</text>')
            x += width
    (folder / "flicker_budget.svg").write_text("\n".join(out + ["</svg>", ""]))


if __name__ == "__main__":
    main()
