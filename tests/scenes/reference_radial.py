#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Writes reference_radial.json: optical depths of blobs and shells, as a reference for the C code.

40 digits (mpmath), from the exact values of the doubles that the tests use. A ray is reduced to r^2
= p^2 + s^2 with sufficient digits. The shell is tanh-sinh quadrature of e^{-(r - R) / H} itself
between the altitudes of whole scale heights, the blob is erfc; both are checked against other
forms.

  apt-get install python3-mpmath && /usr/bin/python3 tests/scenes/reference_radial.py
"""
import itertools
import math
import pathlib
import random
import sys

from mpmath import besselk, erf, erfc, exp, inf, log, mp, mpf, pi, quad, sqrt

sys.path.insert(0, str(pathlib.Path(__file__).parents[1]))
import reference_tables

mp.dps = 40
INFINITE = float("inf")


def doubles(values):
    """The doubles nearest to the numbers, in lists of the same shape."""
    return [doubles(v) if isinstance(v, (list, tuple)) else float(v) or 0.0
            for v in values]


def radial(center, origin, direction, t0, t1):
    """(p, s0, s1) of origin + t direction, which is not exactly a unit vector."""
    d = [mpf(v) for v in direction]
    norm = sqrt(sum(v * v for v in d))
    o = [mpf(a) - mpf(b) for a, b in zip(origin, center)]
    along = sum(a * b for a, b in zip(o, d)) / norm
    impact = sqrt(sum((a - along * b / norm) ** 2 for a, b in zip(o, d)))
    return impact, along + norm * t0, inf if t1 == INFINITE else along + norm * t1


# ---- shells ----------------------------------------------------------------------------------


def leg(radius, height, impact, near, far):
    """Over s in [near, far], near >= 0, of e^{-(r - R) / H}; pieces end at whole scale heights."""
    def rise(s):
        return (s - near) * (s + near) / (sqrt(impact ** 2 + s ** 2) + near_r)
    near_r = sqrt(impact ** 2 + near ** 2)
    ends, folds = [near], 0
    while folds < 110 and ends[-1] < far:
        folds += 2 if folds < 20 else 10
        ends.append(min(far, sqrt((near_r + folds * height) ** 2 - impact ** 2)))
    if near == 0 or impact < height:  # a narrow bend of r(s) at s ~ p
        ends = sorted(set(ends + [e for e in (impact * mpf(3) ** k for k in range(-3, 12))
                                  if near < e < ends[-1]]))
    return exp(-(near_r - radius) / height) * quad(lambda s: exp(-rise(s) / height), ends)


def shell_depth(radius, height, center, origin, direction, t0, t1):
    radius, height = mpf(radius), mpf(height)
    impact, s0, s1 = radial(center, origin, direction, t0, t1)
    ground = sqrt(radius ** 2 - impact ** 2) if impact < radius else mpf(0)
    total = mpf(0)
    for low, high in ((s0, s1), (-s1, -s0)):
        low = max(low, ground)
        if low < high:
            total += leg(radius, height, impact, low, high)
    return total


def check_shell():
    """Level from the ground: Ch(X, 90 deg) = X e^X K_1(X); vertically: H (1 - e^{-L / H})."""
    for x in (1, 50, 797):
        level = shell_depth(x, 1, (0, 0, 0), (0, x, 0), (1, 0, 0), 0, INFINITE)
        assert abs(level / (x * exp(x) * besselk(1, x)) - 1) < mpf("1e-25"), x
        up = shell_depth(x, 1, (0, 0, 0), (0, x, 0), (0, 1, 0), 0, 3)
        assert abs(up / (1 - exp(-3)) - 1) < mpf("1e-25")


def unit(x, y, z):
    norm = math.sqrt(x * x + y * y + z * z)
    return (x / norm, y / norm, z / norm)


def shell_cases():
    """(R, H, origin, direction, t0, t1); the planet's centre is at (0, -R, 0)."""
    slopes = [1.0, 0.3, 0.01, 1e-5, 0.0, -1e-5, -0.01, -0.3, -1.0]
    for radius, height in ((6.371e6, 8000.0), (6.371e6, 1200.0), (1e6, 1.0), (1.0, 1.0),
                           (50.0, 2.0), (0.01, 1.0), (1e-6, 1.0)):
        for slope in slopes:  # from the ground, from inside, from high above
            d = unit(1.0, slope, 0.2)
            for altitude in (0.0, 1.5, 20.0):
                eye = (0.0, altitude * height, 0.0)
                yield radius, height, eye, d, 0.0, INFINITE
                yield radius, height, eye, d, 0.0, 2.5 * height
        yield radius, height, (0.0, 0.25 * height, 0.0), (1.0, 0.0, 0.0), 0.0, 1e-6 * height
        yield radius, height, (0.0, 0.25 * height, 0.0), (0.0, 1.0, 0.0), 3.0, 3.0 + 1e-6 * height
        start = -30.0 * math.sqrt(radius * height) - 40.0 * height
        for altitude in (-0.5 * radius, -0.1 * height, 0.0, 0.1 * height, 7.0 * height):
            yield radius, height, (start, altitude, 0.0), (1.0, 0.0, 0.0), 0.0, INFINITE
            yield radius, height, (start, altitude, 0.0), (1.0, 0.0,
                                                           0.0), 0.0, -start + 0.5 * height
    draw = random.Random(20250607)
    for _ in range(150):
        height = 10.0 ** draw.uniform(0, 4)
        radius = height * 10.0 ** draw.uniform(-1, 4)
        span = 30 * height + 3 * math.sqrt(radius * height)
        eye = (draw.uniform(-span, span), draw.uniform(0, 9) * height, draw.uniform(-span, span))
        d = unit(draw.uniform(-1, 1), draw.choice([draw.uniform(-1, 1), draw.uniform(-.05, .05)]),
                 draw.uniform(-1, 1))
        t0 = draw.choice([0.0, draw.uniform(0, span)])
        yield radius, height, eye, d, t0, t0 + draw.choice([INFINITE, span * draw.random()])


def shell_table():
    check_shell()
    for radius, height, origin, direction, t0, t1 in shell_cases():
        center = (0.0, -radius, 0.0)
        depth = shell_depth(radius, height, center, origin, direction, t0, t1)
        yield (radius, height, direction), (origin, t0, t1, depth)


# ---- blobs -----------------------------------------------------------------------------------


def gaussian_depth(width, center, origin, direction, t0, t1):
    width = mpf(width)
    impact, s0, s1 = radial(center, origin, direction, t0, t1)
    a, b = (s / (width * sqrt(mpf(2))) for s in (s0, s1))
    if b < 0:
        a, b = -b, -a
    between = erfc(a) - (0 if b == inf else erfc(b)) if a > 0 else erf(b) - erf(a)
    return exp(-(impact / width) ** 2 / 2) * width * sqrt(pi / 2) * between


def check_gaussian():
    args = (1.3, (1, 2, 3), (0, 1, 5), unit(0.3, 0.5, -0.4), 0.25, 4.0)
    d = [mpf(v) for v in args[3]]
    norm2 = sum(v * v for v in d)
    assert abs(norm2 - 1) < mpf("1e-15")

    def density(t):
        r2 = sum((o + t * v - c) ** 2 for o, v, c in zip(args[2], d, args[1]))
        return exp(-r2 / (2 * mpf(args[0]) ** 2))
    assert abs(quad(density, [0.25, 1, 2, 4]) * sqrt(norm2) / gaussian_depth(*args) - 1) < 1e-30


def gaussian_cases():
    """(width, center, origin, direction, t0, t1)."""
    x = (1.0, 0.0, 0.0)
    for p in (0.0, 0.5, 5.0, 12.0, 37.0, 39.0):  # up to where e^{-p^2/2} is subnormal
        for s0 in (-30.0, -8.0, -1.0, -1e-9, 0.0, 1e-9, 2.0, 8.0, 30.0):
            for length in (1e-12, 1e-6, 1e-3, 0.3, 1.0, 3.0, 20.0, INFINITE):
                yield 1.0, (0.0, 0.0, 0.0), (s0, p, 0.0), x, 0.0, length
    for far in (1e3, 1e6, 1e9):
        d = unit(1.0, 1e-3, -2e-3)
        c = (0.1, 0.2, -0.3)
        eye = tuple(a - far * b for a, b in zip(c, d))
        yield 1.0, c, eye, d, 0.0, INFINITE
        yield 1.0, c, eye, d, 0.0, far
        yield 1.0, c, eye, d, far - 2.0, far - 1.999
    draw = random.Random(31)
    for _ in range(150):
        width = 10.0 ** draw.uniform(-2, 4)
        c = tuple(draw.uniform(-4, 4) * width for _ in range(3))
        eye = tuple(draw.uniform(-4, 4) * width for _ in range(3))
        t0 = draw.uniform(-3, 3) * width
        yield (width, c, eye, unit(*(draw.uniform(-1, 1) for _ in range(3))), t0,
               t0 + width * 10.0 ** draw.uniform(-9, 1))


def gaussian_table():
    check_gaussian()
    for case in gaussian_cases():
        width, center, origin, direction, t0, t1 = case
        yield (width, center, direction), (origin, t0, t1, gaussian_depth(*case))


# ---- file ----------------------------------------------------------------------------------------


def rows(table, most):
    """One row per medium and direction, for neighbours in the table, with their pieces."""
    for same, cases in itertools.groupby(table, lambda case: case[0]):
        pieces = [piece for _, piece in cases]
        for first in range(0, len(pieces), most):
            part = pieces[first:first + most]
            yield [*doubles(same), len(part), doubles(part)]


if __name__ == "__main__":
    reference_tables.write(pathlib.Path(__file__).with_suffix(".json"), {
        "struct reference_shell reference_shell[]": rows(shell_table(), 10),
        "struct reference_gaussian reference_gaussian[]": rows(gaussian_table(), 8)})
