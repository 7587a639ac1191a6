#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Writes reference_values.json: the reference for tests of exact transport in C.

50 digits (mpmath), from the exact values of the doubles that the tests use. The formulas are the
textbooks', which cancel or overflow in double; here they have sufficient digits. Every closed form
is checked against tanh-sinh quadrature of its own integrand before it is written.

  apt-get install python3-mpmath && /usr/bin/python3 tests/scenes/reference_values.py
"""
import itertools
import math
import pathlib
import random
import sys

from mpmath import exp, expm1, inf, mp, mpf, pi, quad, sqrt

sys.path.insert(0, str(pathlib.Path(__file__).parents[1]))
import reference_tables

mp.dps = 50
DOUBLE_MAX = mpf(float.fromhex("0x1.fffffffffffffp+1023"))
INFINITE = float("inf")


def nearest(value):
    """The double nearest to the value; 0 has no sign."""
    if abs(value) > DOUBLE_MAX:
        return INFINITE if value > 0 else -INFINITE
    return float(value) or 0.0


# ---- phi and optical depth -------------------------------------------------------------------


def phi(x):
    if x == 0:
        return mpf(1)
    return -expm1(-mpf(x)) / mpf(x)


def phi_table():
    sizes = [5e-324, 1e-300, 1e-160, 1e-20, 1e-16, 1e-10, 1e-5, 1e-3, 0.1, 0.5, 1.0, 2.0, 5.0, 10.0,
             36.0, 37.0, 40.0, 100.0, 700.0, 709.5, 710.0, 712.0, 716.0, 720.0, 746.0, 1e10, 1e300]
    for x in [0.0] + sizes + [-x for x in sizes]:
        # e^{1e300} is infinite without a computation of its digits.
        value = inf if x < -1e4 else mpf(1) / mpf(x) if x > 1e4 else phi(x)
        yield x, value


def layer_depth(layer, y, k_y, length):
    """Optical depth of a e^{-b (y - h)}; all arguments mpf."""
    a, b, h = layer
    if a == 0 or length <= 0:
        return mpf(0)
    if length == inf:
        return a * exp(-b * (y - h)) / (b * k_y) if b * k_y > 0 else inf
    x = b * k_y * length
    # e^{-b (y - h)} phi(x), from the denser end, so that mpmath's exponents stay small.
    exponent = -b * ((y if x >= 0 else y + k_y * length) - h)
    if exponent > 2000000:
        return inf
    return a * exp(exponent) * length * (1 / abs(x) if abs(x) > 1000 else phi(abs(x)))


def fog_cases():
    """(extinction, falloff, height, y, k_y, length): selected extremes, then a seeded sample."""
    level = [0.0, 1e-300, -1e-300, 1e-160, -1e-160, 1e-17, -1e-17]
    slopes = level + [s * k for k in (1e-9, 1e-6, 1e-4, 0.1, math.sqrt(0.5), 1.0) for s in (1, -1)]
    lengths = [0.0, 1e-300, 1e-3, 1.0, 1e3, 1e6, 1e300, INFINITE]
    unreal = (9.609e-4, 0.01386294361119891, 0.0)
    for k_y, length in itertools.product(slopes, lengths):  # a camera at eye height
        yield unreal + (1.7, k_y, length)
    far = [unreal + (1e6,), unreal + (-2e3,)]  # above, below
    homogeneous = [(0.3, 1e-300, 0.0, 10.0), (0.3, 0.0, 0.0, 10.0), (0.0, 0.1, 0.0, 10.0)]
    for fog, k_y, length in itertools.product(far + homogeneous, (0.0, -1e-9, -0.3, -1.0, 1.0),
                                              (1e3, 1e6, INFINITE)):
        yield fog + (k_y, length)
    for falloff in (0.01, 0.5):
        for length in (999990.0, 999999.0, 1e6, 1000050.0):
            yield (1e-3, falloff, 3.0, 1e6, -1.0, length)  # 0 * inf in the textbook form
    # Extinction and exponential of opposite magnitude: both factors exceed the range of a double.
    yield (1e-300, 1.0, 0.0, -720.0, 0.5, 1.0)
    yield (1e-300, 1.0, 0.0, -1000.0, 0.5, INFINITE)
    yield (1e300, 1.0, 0.0, 730.0, 0.5, INFINITE)
    yield (1e-3, 0.01, 0.0, 74000.0, 0.0, 1e300)
    yield (1e-20, 1e-160, 0.0, 0.0, 1e-155, INFINITE)  # their product is subnormal
    draw = random.Random(20240607)
    for _ in range(300):
        yield (10.0 ** draw.uniform(-8, 2), 10.0 ** draw.uniform(-8, 1), draw.uniform(-500, 500),
               draw.choice([draw.uniform(-50, 50), draw.uniform(-1e4, 1e6)]),
               draw.choice([draw.uniform(-1, 1), draw.choice(slopes)]),
               10.0 ** draw.uniform(-3, 7))


def check_layer_depth():
    """The closed form against quadrature of the density."""
    layer = (mpf("1e-3"), mpf("0.02"), mpf(5))
    for y, k_y, length in ((2, "0.3", 200), (2, "-0.3", 200), (30, "1e-4", 1000), (0, "0", 7)):
        y, k_y, length = mpf(y), mpf(k_y), mpf(length)
        truth = quad(lambda t: layer[0] * exp(-layer[1] * (y + k_y * t - layer[2])), [0, length])
        assert abs(layer_depth(layer, y, k_y, length) / truth - 1) < mpf("1e-40")


def fog_table():
    check_layer_depth()
    for a, b, h, y, k_y, length in fog_cases():
        exact = [mpf(v) for v in (a, b, h, y, k_y)]
        depth = layer_depth(tuple(exact[:3]), exact[3], exact[4], mpf(length))
        # The exponent -b (y - h) of the density at the denser end is a sum of terms of this size:
        # rounding any of them by 2^-53 changes the optical depth by a relative 2^-53 times this.
        run = 0 if b * k_y >= 0 else abs(exact[4]) * mpf(length)
        condition = exact[1] * (abs(exact[3]) + abs(exact[2]) + run)
        yield ((a, b, h), y, k_y), (length, depth, condition)


# ---- phase functions -------------------------------------------------------------------------


def phase_per_sr(kind, g, cosine):
    cosine = max(mpf(-1), min(mpf(1), mpf(cosine)))
    g = mpf(g)
    if kind == "HENYEY_GREENSTEIN":
        return (1 - g * g) / (4 * pi * (1 + g * g - 2 * g * cosine) ** mpf("1.5"))
    if kind == "RAYLEIGH":
        return 3 / (16 * pi) * (1 + cosine * cosine)
    return 1 / (4 * pi)


def phase_table():
    cosines = (-1.0, -0.9999, -0.5, 0.0, 0.3, 0.999, 0.999999, 1.0)
    for g in (0.0, 1e-9, 0.5, -0.5, 0.85, -0.85, 0.99, 0.999, -0.999):
        for cosine in cosines:
            yield ("HENYEY_GREENSTEIN", g), (cosine, phase_per_sr("HENYEY_GREENSTEIN", g, cosine))
    for kind in ("RAYLEIGH", "ISOTROPIC"):
        for cosine in cosines:
            yield (kind, 0.0), (cosine, phase_per_sr(kind, 0, cosine))


# ---- single scattering -----------------------------------------------------------------------

EVERYWHERE = ((-INFINITE,) * 3, (INFINITE,) * 3)


class Medium:
    def __init__(self, layers, bounds=EVERYWHERE, albedo=1.0, phase=("ISOTROPIC", 0.0)):
        self.layers, self.bounds, self.albedo, self.phase = layers, bounds, albedo, phase

    def exact_layers(self):
        return [tuple(mpf(v) for v in layer) for layer in self.layers]

    def clip(self, origin, direction, t0, t1):
        for axis in range(3):
            low, high = mpf(self.bounds[0][axis]), mpf(self.bounds[1][axis])
            if direction[axis] == 0:
                if not low <= origin[axis] <= high:
                    return None
                continue
            ends = sorted([(low - origin[axis]) / direction[axis],
                           (high - origin[axis]) / direction[axis]])
            t0, t1 = max(t0, ends[0]), min(t1, ends[1])
        return (t0, t1) if t0 < t1 else None

    def depth(self, origin, direction, t0, t1):
        inside = self.clip(origin, direction, t0, t1)
        if not inside:
            return mpf(0)
        y = origin[1] + inside[0] * direction[1]
        return sum(layer_depth(layer, y, direction[1], inside[1] - inside[0])
                   for layer in self.exact_layers())

    def extinction(self, point):
        if not all(mpf(l) <= p <= mpf(h) for l, h, p in zip(*self.bounds, point)):
            return mpf(0)
        return sum(a * exp(-b * (point[1] - h)) for a, b, h in self.exact_layers())


def along(origin, direction, t):
    return [o + t * d for o, d in zip(origin, direction)]


class View:
    """One ray into media under a sun of irradiance 1; `end` cuts it as an opaque ground would."""

    def __init__(self, name, media, sun, origin, direction):
        self.name, self.media, self.sun = name, media, sun
        self.origin, self.direction = origin, direction
        self.o = [mpf(v) for v in origin]
        self.d = [mpf(v) for v in direction]
        self.s = [mpf(v) for v in sun]
        self.cosine = sum(a * b for a, b in zip(self.d, self.s))

    def depth(self, t0, t1):
        return sum(m.depth(self.o, self.d, t0, t1) for m in self.media)

    def source(self, t):
        point = along(self.o, self.d, t)
        depth = self.depth(mpf(0), t) + sum(m.depth(point, self.s, mpf(0), inf) for m in self.media)
        if depth == inf:
            return mpf(0)
        scattered = sum(mpf(m.albedo) * phase_per_sr(*m.phase, self.cosine) * m.extinction(point)
                        for m in self.media)
        return scattered * exp(-depth)

    def breaks(self):
        """Faces on the ray, faces on the sun rays, and geometric steps for the exponentials."""
        ranges = [r for r in (m.clip(self.o, self.d, mpf(0), inf) for m in self.media) if r]
        if not ranges:
            return []
        low, high = min(r[0] for r in ranges), max(r[1] for r in ranges)
        if high == inf:  # to a remaining 1e-30 of the fog, or e^-120 of the light
            high = 2 * low + 1
            while self.depth(mpf(0), high) < 120 and \
                    self.depth(high, inf) > mpf("1e-30") * self.depth(mpf(0), high):
                high *= 2
        if self.depth(mpf(0), high) > 300:
            clear, dark = low, high
            while not 120 <= self.depth(mpf(0), high) <= 300:
                high = (clear + dark) / 2
                if self.depth(mpf(0), high) > 300:
                    dark = high
                else:
                    clear = high
        cuts = {low, high}
        for r in ranges:
            cuts.update(r)
        for m in self.media:
            lines = [(mpf(0), mpf(0))]
            for axis in range(3):
                for side in range(2):
                    face = mpf(m.bounds[side][axis])
                    if abs(face) != inf and self.s[axis] != 0:
                        lines.append(((face - self.o[axis]) / self.s[axis],
                                      -self.d[axis] / self.s[axis]))
            for (c0, s0), (c1, s1) in itertools.combinations(lines, 2):
                if s0 != s1:
                    cuts.add((c1 - c0) / (s0 - s1))
        span = high - low
        for k in range(-30, 0):
            cuts.update((low + span * mpf(2) ** k, high - span * mpf(2) ** k))
        return sorted(c for c in cuts if low <= c <= high)

    def integral(self):
        """Tanh-sinh of the integrand in t: only the definition."""
        points = self.breaks()
        if not points:
            return mpf(0)
        with mp.workdps(30):
            value, error = quad(self.source, points, error=True, maxdegree=8)
        assert error <= mpf("1e-17") * value or value < mpf("1e-30"), (self.name, value, error)
        return value

    def condition(self):
        """The condition number: rounding the coordinates of the ray and of its points by 2^-53
        changes the radiance by a relative 2^-53 times this. It contains heights times falloff, the
        depth towards the sun per height, and crossed faces per length inside. Parts behind an
        optical depth of 50 do not count."""
        worst = mpf(0)
        points = [t for t in self.breaks() if self.depth(mpf(0), t) <= 50]
        for m, t in itertools.product(self.media, points):
            inside = m.clip(self.o, self.d, mpf(0), points[-1])
            if not inside:
                continue
            height = abs(self.o[1]) + t * abs(self.d[1])
            extinction = m.extinction(along(self.o, self.d, t))
            value = sum(b * (height + abs(h)) for _, b, h in m.exact_layers())
            per_length = 1 / (inside[1] - inside[0]) + extinction
            if m.bounds[1][0] < 1e8:
                value += max(abs(v) for v in (*along(self.o, self.d, t), t)) * per_length
            else:
                value += height * extinction / max(abs(self.s[1]), mpf("1e-300"))
                if m.bounds[1][1] < 1e8 and self.d[1] != 0:
                    value += height / abs(self.d[1]) * per_length
            worst = max(worst, value)
        return worst


def unit(x, y, z):
    length = math.sqrt(x * x + y * y + z * z)
    return (x / length, y / length, z / length)


def towards(mu, azimuth):
    """A direction with a vertical component of exactly the double mu."""
    across = math.sqrt(1.0 - mu * mu)
    return (across * math.cos(azimuth), mu, across * math.sin(azimuth))


PHASES = (("ISOTROPIC", 0.0), ("HENYEY_GREENSTEIN", 0.7), ("RAYLEIGH", 0.0),
          ("HENYEY_GREENSTEIN", -0.4))


def slab_views():
    """Plane-parallel: a box so wide that no ray leaves by its sides. Closed form, notes section 2:
         seen from above  w p mu0/(mu+mu0) [1 - e^{-tau0 (1/mu + 1/mu0)}]
         seen from below  w p (tau0/mu) e^{-tau0/mu0} phi(tau0 (1/mu - 1/mu0))"""
    thickness, wide = 8.0, 1e9
    bounds = ((-wide, 0.0, -wide), (wide, thickness, wide))
    angles = ((0.7, 0.7), (0.9, 0.3), (0.3, 0.9), (1.0, 1.0), (0.02, 0.5), (0.7, 0.7000000007),
              (1.0, 0.02))
    phases = itertools.cycle(PHASES)
    for depth in (1e-10, 1e-3, 0.5, 5.0, 60.0, 1e3):
        for mu, mu0 in angles:
            phase = next(phases)
            medium = Medium([(depth / thickness, 0.0, 0.0)], bounds, 0.9, phase)
            for looking in (-1, 1):
                origin = (0.0, thickness + 2.0, 0.0) if looking < 0 else (0.0, -2.0, 0.0)
                view = View("slab from %s, depth %g, mu %g, mu0 %g" %
                            ("above" if looking < 0 else "below", depth, mu, mu0),
                            [medium], towards(mu0, 0.4), origin, towards(looking * mu, 1.1))
                mu_e, mu0_e, tau0 = mpf(mu), mpf(mu0), mpf(depth / thickness) * mpf(thickness)
                scale = mpf(0.9) * phase_per_sr(*phase, view.cosine)
                if looking < 0:
                    value = scale * mu0_e / (mu_e + mu0_e) * -expm1(-tau0 * (1 / mu_e + 1 / mu0_e))
                else:
                    value = scale * tau0 / mu_e * exp(-tau0 / mu0_e) * \
                        phi(tau0 * (1 / mu_e - 1 / mu0_e))
                if depth == 0.5:
                    assert abs(view.integral() / value - 1) < mpf("1e-17"), view.name
                yield view, value


def fog_everywhere_views():
    """Height fog at all heights, sun cosine s, view k: with tau the depth from the eye and A0 the
    depth from the eye to the sun, L = w p e^{-A0} Int_0^{tau_v} e^{-tau (1 - k/s)} dtau, where
    tau_v is finite for k > 0 and infinite otherwise."""
    fogs = ((9.609e-4, 0.01386294361119891, 0.0), (1e-3, 1e-4, 0.0), (2.0, 1.0, 3.0),
            (1e-6, 0.5, 0.0))
    phases = itertools.cycle(PHASES)
    checked = 0
    for fog in fogs:
        for y, s, k in ((0.0, 0.5, 0.5), (2.0, 0.5, 0.9), (2.0, 0.9, 0.05), (500.0, 0.3, 1e-6),
                        (-3.0, 1.0, 1.0), (2.0, 0.5, 0.0), (2.0, 0.5, -0.3), (40.0, 0.05, -1.0),
                        (1e6, 0.6, -1.0), (1e6, 0.6, -0.4), (2.0, 0.5, 1e-300),
                        (2.0, 0.5, -1e-300)):
            phase = next(phases)
            view = View("fog a %g b %g from %g, sun %g, view %g" % (fog[0], fog[1], y, s, k),
                        [Medium([fog], EVERYWHERE, 0.8, phase)], towards(s, 0.2), (0.0, y, 0.0),
                        towards(k, 2.0))
            a, b, h = (mpf(v) for v in fog)
            eye = a * exp(-b * (mpf(y) - h))
            to_sun = eye / (b * mpf(s))
            rate = 1 - mpf(k) / mpf(s)
            if k > 0:
                tau = eye / (b * mpf(k))
                # Beyond 1e6 the remaining part of an exponential integral is 0 in any number of
                # digits.
                integral = tau * phi(tau * rate) if tau * rate < 1000000 else 1 / rate
            else:
                integral = 1 / rate
            value = mpf(0.8) * phase_per_sr(*phase, view.cosine) * exp(-to_sun) * integral
            if abs(k) > 0.01 and y < 1e5 and value > mpf("1e-25") and checked < 8:
                assert abs(view.integral() / value - 1) < mpf("1e-15"), view.name
                checked += 1
            yield view, value


def bounded_views():
    """Quadrature of the definition, without a closed form."""
    draw = random.Random(77)
    box = ((-2.0, 0.0, -3.0), (4.0, 5.0, 3.0))
    for i in range(16):
        extinction = 10.0 ** draw.uniform(-4, 1)
        origin = tuple(draw.uniform(-8, 8) for _ in range(3))
        if i % 3 == 0:  # inside
            origin = (draw.uniform(-2, 4), draw.uniform(0, 5), draw.uniform(-3, 3))
        target = (draw.uniform(-2, 4), draw.uniform(0, 5), draw.uniform(-3, 3))
        direction = unit(*(t - o for t, o in zip(target, origin)))
        sun = unit(draw.uniform(-1, 1), draw.uniform(-0.3, 1), draw.uniform(-1, 1))
        if i % 5 == 0:
            sun = (0.0, 1.0, 0.0)
        medium = Medium([(extinction, 0.0, 0.0)], box, 0.7, PHASES[i % 4])
        yield View("homogeneous box %d" % i, [medium], sun, origin, direction)
    for i in range(12):  # height fog in a box: the sun leaves by the top or a side
        fog = (10.0 ** draw.uniform(-3, 0.5), 10.0 ** draw.uniform(-2, 0.5), draw.uniform(-1, 3))
        origin = tuple(draw.uniform(-9, 9) for _ in range(3))
        target = (draw.uniform(-2, 4), draw.uniform(0, 5), draw.uniform(-3, 3))
        direction = unit(*(t - o for t, o in zip(target, origin)))
        sun = unit(draw.uniform(-1, 1), draw.uniform(-0.2, 1), draw.uniform(-1, 1))
        yield View("fog in a box %d" % i, [Medium([fog], box, 0.7, PHASES[i % 4])], sun, origin,
                   direction)
    layers = [(9.609e-4, 0.01386294361119891, 0.0), (5e-3, 0.1, 20.0)]
    slab = ((-INFINITE, 1.0, -INFINITE), (INFINITE, 60.0, INFINITE))
    sun = unit(0.3, 0.8, -0.2)
    for k in (0.7, 0.02, -0.02, -0.5):
        yield View("two layers, view %g" % k, [Medium(layers, EVERYWHERE, 0.9, PHASES[1])], sun,
                   (3.0, 15.0, 1.0), towards(k, 0.9))
        yield View("fog between two heights, view %g" % k,
                   [Medium(layers[:1], slab, 0.9, PHASES[2])], sun, (3.0, 15.0, 1.0),
                   towards(k, 0.9))
        yield View("two layers of one falloff, view %g" % k,
                   [Medium([layers[0], (2e-3, layers[0][1], 40.0)], EVERYWHERE, 0.9, PHASES[1])],
                   sun, (3.0, 15.0, 1.0), towards(k, 0.9))
        yield View("fog and a box, view %g" % k,
                   [Medium(layers[:1], EVERYWHERE, 0.9, PHASES[1]),
                    Medium([(0.3, 0.0, 0.0)], ((4.0, 0.0, 2.0), (9.0, 30.0, 12.0)), 0.5,
                           PHASES[0])], sun, (3.0, 15.0, 1.0), towards(k, 0.9))
    # Far away: a fog of 2 m seen from 1e6 m, in a thin sheet and in an exponential.
    sheet = ((-INFINITE, 0.0, -INFINITE), (INFINITE, 2.0, INFINITE))
    yield View("two layers from 1e6 m", [Medium(layers, EVERYWHERE, 0.9, PHASES[1])], sun,
               (0.0, 1e6, 0.0), towards(-0.4, 0.9))
    for k in (-1.0, -0.6, -0.05):
        yield View("thin fog far below, view %g" % k,
                   [Medium([(1e-4, 0.7, 0.0)], sheet, 1.0, PHASES[0])], sun, (0.0, 1e6, 0.0),
                   towards(k, 0.9))
        yield View("two thin layers far below, view %g" % k,
                   [Medium([(1e-4, 0.7, 0.0), (2e-5, 0.2, 1.0)], sheet, 1.0, PHASES[0])], sun,
                   (0.0, 1e6, 0.0), towards(k, 0.9))


def view_table():
    for view, value in itertools.chain(slab_views(), fog_everywhere_views()):
        yield view, value
    for view in bounded_views():
        yield view, view.integral()


# ---- file ----------------------------------------------------------------------------------------


def numbers(values):
    """The doubles nearest to numbers, and names of phase functions, in lists of the same shape."""
    return ["NEPH_PHASE_" + v if isinstance(v, str) else
            numbers(v) if isinstance(v, (list, tuple)) else nearest(v) for v in values]


def rows(table):
    """One row for neighbours in the table with the same first part."""
    for same, cases in itertools.groupby(table, lambda case: case[0]):
        values = [value for _, value in cases]
        yield numbers(same), len(values), numbers(values)


def medium_row(medium):
    kind = "HEIGHT_FOG" if any(layer[1] for layer in medium.layers) else "HOMOGENEOUS"
    return {"kind": "NEPH_MEDIUM_" + kind, "bounds": numbers(medium.bounds),
            "extinction_color": [1, 1, 1], "albedo": numbers([medium.albedo] * 3),
            "phase": numbers(medium.phase), "layer_count": len(medium.layers),
            "layers": numbers(medium.layers)}


def view_rows():
    """The media, each once, and the views with the indices of their media."""
    media, views = [], []
    for view, value in view_table():
        for medium in view.media:
            if medium_row(medium) not in media:
                media.append(medium_row(medium))
        which = [media.index(medium_row(medium)) for medium in view.media]
        views.append([view.name, *numbers([view.sun, view.origin, view.direction, value,
                                           view.condition()]), len(which), which])
    return media, views


if __name__ == "__main__":
    media, views = view_rows()
    reference_tables.write(pathlib.Path(__file__).with_suffix(".json"), {
        "struct reference_phi reference_phi[]": map(numbers, phi_table()),
        "struct reference_fog reference_fog[]": [[*same, *rest]
                                                 for same, *rest in rows(fog_table())],
        "struct reference_phase reference_phase[]": map(list, rows(phase_table())),
        "struct neph_medium reference_medium[]": media,
        "struct reference_view reference_view[]": views})
