#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Write noise_voxels.yaml beside this file: smoothed noise, cut to a ball, from a fixed seed."""
import pathlib
import random

SIZE = (13, 10, 13)
HEAD = """# SPDX-License-Identifier: MIT
# Written by noise_voxels.py.
name: noise_voxels
title: A ball of noise in 13 x 10 x 13 voxels
physics: >
  Lumps, holes and hard edges at the scale of the cloud itself; optical depth of some 15. Truth:
  tracer.
camera: {position_m: [4, 5, 13], look_at_m: [0, 0, 0], vertical_fov_deg: 34}
sun: {direction: [-0.3, 0.8, 0.5], irradiance_w_per_m2: [3, 3, 3]}
scattering: multiple
media:
  - grid:
      size: [13, 10, 13]
      origin_m: [-3, -2.25, -3]
      spacing_m: [0.5, 0.5, 0.5]
      values: [ # x fastest, then y, then z
"""
TAIL = """      extinction_per_m: 9
      albedo: [1, 1, 1]
      phase: henyey_greenstein
      asymmetry_g: 0.3
"""


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


def value_at(noise, place):
    out = sum(((p - (n - 1) / 2) / (n / 2)) ** 2 for p, n in zip(place, SIZE))
    return max(0.0, 3.0 * (smoothed(noise, place) - 0.40) + 0.8 * (1.0 - out)) if out < 1.0 else 0.0


def main():
    draw = random.Random(16)
    places = [(x, y, z) for z in range(SIZE[2]) for y in range(SIZE[1]) for x in range(SIZE[0])]
    noise = {place: draw.random() for place in places}
    words = [f"{value_at(noise, place):.2f}" for place in places]
    rows = [", ".join(words[i:i + 13]) for i in range(0, len(words), 13)]
    text = HEAD + ",\n".join("        " + row for row in rows) + "]\n" + TAIL
    pathlib.Path(__file__).with_suffix(".yaml").write_text(text)


main()
