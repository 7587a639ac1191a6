#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Write noise_voxels.yaml and noise_lumps.yaml beside this file: smoothed noise, cut to a ball,
each from a fixed seed."""
import pathlib
import random

HEAD = """# SPDX-License-Identifier: MIT
# Written by noise_voxels.py.
name: {name}
title: A ball of noise in {size} voxels
description: >
  Lumps, holes and hard edges at the scale of the cloud, with an optical depth of about {depth}.
  The reference is the path tracer `tracer`.
camera: {{position_m: {camera_m}, look_at_m: [0, 0, 0], vertical_fov_deg: 34}}
sun: {{direction: [-0.3, 0.8, 0.5], irradiance_w_per_m2: [3, 3, 3]}}
scattering: multiple
media:
  - grid:
      size: {nodes}
      origin_m: {origin_m}
      spacing_m: [0.5, 0.5, 0.5]
      values: [ # x fastest, then y, then z
"""
TAIL = """      extinction_per_m: {extinction_per_m}
      albedo: [1, 1, 1]
      phase: henyey_greenstein
      asymmetry_g: {g}
"""


GRIDS = [
    {"name": "noise_voxels", "seed": 16, "nodes": [13, 10, 13], "camera_m": [4, 5, 13], "depth": 15,
     "extinction_per_m": 9, "g": 0.3},
    {"name": "noise_lumps", "seed": 61, "nodes": [10, 11, 12], "camera_m": [-9, 1, 9], "depth": 10,
     "extinction_per_m": 6, "g": 0.5},
]


def smoothed(noise, place):
    total = weight = 0.0
    for dx in (-1, 0, 1):
        for dy in (-1, 0, 1):
            for dz in (-1, 0, 1):
                share = 0.5 ** (abs(dx) + abs(dy) + abs(dz))
                near = (place[0] + dx, place[1] + dy, place[2] + dz)
                total += share * noise.get(near, 0.0)
                weight += share
    return total / weight


def value_at(noise, place, size):
    out = sum(((p - (n - 1) / 2) / (n / 2)) ** 2 for p, n in zip(place, size))
    return max(0.0, 3.0 * (smoothed(noise, place) - 0.40) + 0.8 * (1.0 - out)) if out < 1.0 else 0.0


def write(grid):
    draw = random.Random(grid["seed"])
    wide, high, deep = grid["nodes"]
    places = [(x, y, z) for z in range(deep) for y in range(high) for x in range(wide)]
    noise = {place: draw.random() for place in places}
    words = [f"{value_at(noise, place, grid['nodes']):.2f}" for place in places]
    rows = [", ".join(words[i:i + wide]) for i in range(0, len(words), wide)]
    told = dict(grid, size=f"{wide} x {high} x {deep}",
                origin_m="[" + ", ".join(f"{(1 - n) / 4:g}" for n in grid["nodes"]) + "]")
    text = (HEAD.format(**told) + ",\n".join("        " + row for row in rows) + "]\n" +
            TAIL.format(**told))
    pathlib.Path(__file__).with_name(grid["name"] + ".yaml").write_text(text)


for each in GRIDS:
    write(each)
