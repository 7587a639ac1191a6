#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Prints foliage.yaml: leaves of one pixel each at 320x180, at random places and distances."""
import random

COLUMNS, ROWS, COVER, SEED = 100, 50, 0.1, 20270301
# one pixel is 0.004 of them: coordinates need no more than 3 digits
DISTANCES_M = (8, 9, 10, 11, 12)
EYE_Y_M, DEPTH_M = 2, 0.005

HEAD = """\
# SPDX-License-Identifier: MIT
# Made by foliage.py.
name: foliage
title: Leaves of one pixel at random over a tenth of the view, before a cloud
description: >
  500 leaves of exactly one pixel each at 320x180, at random over a tenth of the view and at 8 to 12
  m, before a brighter cloud: few rays of a coarse grid meet one, and the next frame loses it again.
  The reference is engine `exact`.
# They cover a tenth of the middle 100 x 50 pixels; the cloud is about eight times as bright as the
# fog before them. A tile of 4 x 4 pixels has one or two leaves: its nearest and farthest depth lie
# at single pixels. The sun is above, and cloud and fog do not reach the leaves: no shadow falls
# into them.
# One pixel is 0.004 of the distance: tan(fov / 2) = 90 * 0.004.
camera: {position_m: [0, 2, 0], look_at_m: [0, 2, -10], vertical_fov_deg: 39.597752709049864}
frames: {count: 64, rate_hz: 30}
sun: {direction: [0.6, 0.8, 0], irradiance_w_per_m2: [6, 6, 6]}
background_w_per_m2_sr: [0.02, 0.03, 0.05]
scattering: single
media:
  - homogeneous:
      extinction_per_m: 0.005
      albedo: [1, 1, 1]
      bounds: {min_m: [-8, -4, -7.5], max_m: [8, 8, -0.5]}
  - gaussian:
      center_m: [-2, 2.5, -30]
      width_m: 5
      extinction_per_m: 0.25
      albedo: [1, 1, 1]
      bounds: {min_m: [-30, -20, -60], max_m: [30, 25, -12.5]}
display: {exposure_ev: 1}
solids:"""


def leaf(pixel, distance_m):
    """The square over the centre of a pixel (column, row from the middle), its front at a distance.

    A quarter of a pixel aside, so that no ray of this size, its half or its quarter meets an edge.
    """
    side_m = 0.004 * distance_m
    x_m, y_m = ((p + 0.25) * side_m for p in pixel)
    low = (x_m, EYE_Y_M + y_m, -distance_m - DEPTH_M)
    high = (x_m + side_m, EYE_Y_M + y_m + side_m, -distance_m)
    return "[%s]" % ", ".join(f"{v:.6g}" for v in low), "[%s]" % ", ".join(f"{v:.6g}" for v in high)


rng = random.Random(SEED)
places = [(c - COLUMNS // 2, r - ROWS // 2) for r in range(ROWS) for c in range(COLUMNS)]
print(HEAD)
for place in sorted(rng.sample(places, int(COVER * len(places)))):
    print("  - box: {min_m: %s, max_m: %s, albedo: [0, 0, 0]}" % leaf(place,
                                                                      rng.choice(DISTANCES_M)))
