#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Writes cloud_reference.h: single scattering in clouds to 20 digits, only from the definition.

Every optical depth is a numerical integral of the density and the radiance an integral over these:
no closed form of the project is used. Isotropic, albedo 1, sun irradiance 1."""

import pathlib
import sys

from mpmath import exp, mp, mpf, pi, quad, sqrt

mp.dps = 20


def unit(v):
    length = sqrt(sum(mpf(x) ** 2 for x in v))
    return tuple(mpf(x) / length for x in v)


def along(o, d, t):
    return tuple(a + t * b for a, b in zip(o, d))


def radiance(density, origin, direction, sun, cuts, sun_cuts):
    """`cuts` bound the medium on the ray; `sun_cuts(point)` on the way to the sun."""
    def view_depth(t):
        inside = [c for c in cuts if c < t] + [t]
        return quad(lambda x: density(along(origin, direction, x)),
                    inside) if len(inside) > 1 else mpf(0)

    def source(t):
        p = along(origin, direction, t)
        here = density(p)
        if here == 0:
            return mpf(0)
        sun_depth = quad(lambda x: density(along(p, sun, x)), sun_cuts(p))
        return here * exp(-view_depth(t) - sun_depth)

    return quad(source, cuts) / (4 * pi)


def gaussian(sigma, width, origin, direction, sun):
    origin = tuple(mpf(x) for x in origin)
    direction, sun = unit(direction), unit(sun)

    def density(p):
        return sigma * exp(-sum(x * x for x in p) / (2 * width * width))

    def around(o, d, start):
        middle = -sum(a * b for a, b in zip(o, d))
        points = [middle + k * width for k in (-11, -5, -2, 0, 2, 5, 11)]
        return [start] + [x for x in points if x > start]

    return radiance(density, origin, direction, sun, around(origin, direction, mpf(0)),
                    lambda p: around(p, sun, mpf(0)))


def shell(sigma, radius, height, origin, direction, sun):
    """Rays that never hit the ground. The centre is at the origin."""
    origin = tuple(mpf(x) for x in origin)
    direction, sun = unit(direction), unit(sun)

    def density(p):
        return sigma * exp(-(sqrt(sum(x * x for x in p)) - radius) / height)

    def climbs(o, d):
        """Upward rays: from the start to 60 scale heights above it."""
        start, low2 = sum(a * b for a, b in zip(o, d)), sum(a * a for a in o)
        assert start >= 0
        heights = [height * k for k in (0, 1, 3, 6, 10, 16, 24, 40, 60)]
        return [sqrt(start ** 2 + h * (2 * sqrt(low2) + h)) - start for h in heights]

    return radiance(density, origin, direction, sun, climbs(origin, direction),
                    lambda p: climbs(p, sun))


def one_node(sigma, origin, direction, sun):
    """A grid of one node at 0 with spacing 1: a tent in each direction."""
    origin = tuple(mpf(x) for x in origin)
    direction, sun = unit(direction), unit(sun)

    def density(p):
        product = mpf(sigma)
        for x in p:
            product *= max(mpf(0), 1 - abs(x))
        return product

    def faces(o, d):
        ts = sorted({(f - a) / b for a, b in zip(o, d) if b != 0 for f in (-1, 0, 1)} | {mpf(0)})
        return [t
                for t in ts if t >= 0 and max(abs(x) for x in along(o, d, t)) < 1 + mpf(10) ** -15]

    def sun_faces(p):
        ts = faces(p, sun)
        return ts if len(ts) > 1 else [mpf(0), mpf(0)]

    # Where the sun ray crosses an edge, the source has a kink in its second derivative.
    cuts = faces(origin, direction)
    edges = []
    for i in range(3):
        for j in range(i):
            for fi in (-1, 0, 1):
                for fj in (-1, 0, 1):
                    denominator = direction[i] * sun[j] - direction[j] * sun[i]
                    if denominator != 0:
                        edges.append(((fi - origin[i]) * sun[j] - (fj - origin[j]) * sun[i]) /
                                     denominator)
    cuts = sorted(set(cuts) | {t for t in edges if cuts[0] < t < cuts[-1]})
    return radiance(density, origin, direction, sun, cuts, sun_faces)


CASES = [("gaussian",
          lambda: gaussian(mpf("0.7"), mpf("1.5"), ("-9", "0.5", "1"),
                           (1, mpf("0.05"), mpf("-0.1")), (mpf("0.3"), mpf("0.9"), mpf("0.2")))),
         ("dense_gaussian",
          lambda: gaussian(mpf(30), mpf("1.5"), ("-9", "0.5", "1"), (1, mpf("0.05"), mpf("-0.1")),
                           (mpf("-0.6"), mpf("0.5"), mpf("0.4")))),
         ("shell", lambda: shell(mpf("1e-5"), mpf(6400000), mpf(8000), (0, 6402000, 0),
                                 (1, mpf("0.02"), 0), (mpf("0.4"), mpf("0.6"), mpf("0.3")))),
         ("one_node", lambda: one_node(mpf(3), ("-2", "0.3", "0.2"), (1, mpf("-0.13"), mpf("0.07")),
                                       (mpf("0.25"), mpf("0.8"), mpf("0.4")))),]


def main():
    lines = ["/* SPDX-License-Identifier: MIT", " *",
             " * Written by cloud_reference.py (mpmath). Do not edit.", " */",
             "#ifndef NEPH_TESTS_TRUTH_CLOUD_REFERENCE_H",
             "#define NEPH_TESTS_TRUTH_CLOUD_REFERENCE_H", ""]
    for name, value in CASES:
        lines.append(f"static const double reference_{name} = {mp.nstr(value(), 17)};")
        print(lines[-1], file=sys.stderr)
    lines += ["", "#endif", ""]
    pathlib.Path(__file__).with_name("cloud_reference.h").write_text("\n".join(lines),
                                                                     encoding="utf-8")


if __name__ == "__main__":
    main()
