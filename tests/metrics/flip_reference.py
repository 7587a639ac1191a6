#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""A second implementation of FLIP, with numpy and scipy-free 2-D kernels, from the two papers'
formulas and independent of metrics/extractors/flip.c: no separation, no tiles, no opponents,
published YCxCz in full.

    python3 tests/metrics/flip_reference.py > tests/metrics/flip_reference.h

Images are made from integers by the same rules as in test_flip.c, so both have the same bits."""
import numpy as np

MASK = 0xFFFFFFFF


def hash32(x, y, c, seed):
    h = (x * 374761393 + y * 668265263 + c * 2246822519 + seed * 3266489917) & MASK
    h = ((h ^ (h >> 13)) * 1274126177) & MASK
    return h ^ (h >> 16)


def unit(h):
    return (h >> 8) * 2.0**-24


def noise(x, y, c, seed, test):
    return unit(hash32(x, y, c, seed + test))


def near(x, y, c, seed, test):
    h = hash32(x, y, c, seed)
    return unit(h ^ (0x300 if test and hash32(x, y, c, seed + 1) & 1 else 0))


def dark(x, y, c, seed, test):
    return unit(hash32(x, y, c, seed)) * (2.0**-13 if test else 2.0**-14)


def bright(x, y, c, seed, test):
    return unit(hash32(x, y, c, seed + test)) * 8.0


def wires(x, y, c, seed, test):
    damaged = test and x % 2 == 0 and y % 2 == 0
    return 0.03125 if (3 * x + y) % 17 == 0 and not damaged else (x + 2 * y + 40 * c) / 1024.0


def huge(x, y, c, seed, test):
    h = hash32(x, y, c, seed + test)
    return unit(h) * 2.0 ** (hash32(x, y, 0, seed) % 128)


def night(x, y, c, seed, test):
    lit = hash32(x, y, 0, seed) % 16 == 0
    return unit(hash32(x, y, c, seed + test)) * 64.0 if lit else 0.0


def sky(x, y, c, seed, test):
    sun = 4096.0 if (x - 9) ** 2 + (y - 8) ** 2 < 12 else 0.0
    shift = 1 if test else 0
    return sun + (40 + 10 * c + 2 * (x + shift) + y) / 64.0


def below_zero(x, y, c, seed, test):
    return unit(hash32(x, y, c, seed + test)) * 2.0 - 0.75


TONES = ["none", "aces", "reinhard", "hable"]

# kind, width, height, seed, ppd, exposure, tone
LDR = [
    (noise, 1, 1, 1, 67.0206432765823, 0.0, "none"),
    (noise, 3, 2, 2, 67.0206432765823, 0.0, "none"),
    (noise, 1, 9, 3, 67.0206432765823, 0.0, "none"),
    (noise, 37, 29, 4, 67.0206432765823, 0.0, "none"),
    (noise, 261, 131, 5, 67.0206432765823, 0.0, "none"),
    (noise, 24, 17, 6, 10.0, 0.0, "none"),
    (noise, 24, 17, 7, 40.0, 0.0, "none"),
    (noise, 24, 17, 8, 200.0, 0.0, "none"),
    (noise, 24, 17, 9, 1.0, 0.0, "none"),
    (near, 33, 21, 10, 67.0206432765823, 0.0, "none"),
    (dark, 33, 21, 11, 67.0206432765823, 0.0, "none"),
    (bright, 33, 21, 12, 67.0206432765823, 0.0, "none"),
    (bright, 33, 21, 13, 67.0206432765823, -2.5, "none"),
    (wires, 63, 47, 14, 67.0206432765823, 0.0, "none"),
    (wires, 63, 47, 15, 30.0, 1.0, "none"),
    (huge, 33, 21, 16, 67.0206432765823, 0.0, "none"),
    (huge, 33, 21, 17, 67.0206432765823, -60.0, "none"),
    (below_zero, 33, 21, 18, 67.0206432765823, 0.0, "none"),
    (sky, 33, 21, 19, 67.0206432765823, 0.5, "aces"),
    (bright, 33, 21, 20, 67.0206432765823, -1.0, "reinhard"),
    (bright, 33, 21, 21, 67.0206432765823, -1.0, "hable"),
    (huge, 33, 21, 22, 120.0, -50.0, "aces"),
    (huge, 33, 21, 23, 67.0206432765823, -50.0, "reinhard"),
]

# kind, width, height, seed, ppd, tone; exposures by the rule
HDR = [
    (bright, 33, 21, 30, 67.0206432765823, "aces"),
    (bright, 33, 21, 31, 40.0, "reinhard"),
    (bright, 33, 21, 32, 67.0206432765823, "hable"),
    (sky, 41, 23, 33, 67.0206432765823, "aces"),
    (dark, 33, 21, 34, 67.0206432765823, "aces"),
    (night, 40, 25, 35, 67.0206432765823, "aces"),
    (noise, 1, 1, 36, 67.0206432765823, "aces"),
]


def picture(kind, width, height, seed, test):
    values = [[[kind(x, y, c, seed, test) for c in range(3)] for x in range(width)]
              for y in range(height)]
    return np.array(values).astype(np.float32).astype(np.float64)


# ---- display -------------------------------------------------------------------------------------

CURVES = {
    "none": (0, 1, 0, 0, 0, 1),
    "reinhard": (0, 1, 0, 0, 1, 1),
    "aces": (0.6 * 0.6 * 2.51, 0.6 * 0.03, 0, 0.6 * 0.6 * 2.43, 0.6 * 0.59, 0.14),
    "hable": (0.231683, 0.013791, 0, 0.18, 0.3, 0.018),
}


def luminance(image):
    return image @ np.array([0.2126, 0.7152, 0.0722])


def display(image, exposure, tone):
    v = np.maximum(image, 0) * 2.0**exposure
    if tone == "reinhard":
        v = v / (1 + luminance(v))[..., None]
    elif tone != "none":
        a, b, c, d, e, f = CURVES[tone]
        v = (a * v * v + b * v + c) / (d * v * v + e * v + f)
    return np.clip(v, 0, 1)


# ---- colour --------------------------------------------------------------------------------------

RGB_TO_XYZ = np.array(
    [
        [10135552 / 24577794, 8788810 / 24577794, 4435075 / 24577794],
        [2613072 / 12288897, 8788810 / 12288897, 887015 / 12288897],
        [1425312 / 73733382, 8788810 / 73733382, 70074185 / 73733382],
    ]
)
WHITE = np.array([0.950428545, 1.0, 1.088900371])


def to_ycxcz(rgb):
    n = (rgb @ RGB_TO_XYZ.T) / WHITE
    return np.stack([116 * n[..., 1] - 16, 500 * (n[..., 0] - n[..., 1]),
                     200 * (n[..., 1] - n[..., 2])], axis=-1)


def from_ycxcz(t):
    y = (t[..., 0] + 16) / 116
    n = np.stack([y + t[..., 1] / 500, y, y - t[..., 2] / 200], axis=-1)
    return (n * WHITE) @ np.linalg.inv(RGB_TO_XYZ).T


def to_hunt_lab(rgb):
    n = (rgb @ RGB_TO_XYZ.T) / WHITE
    delta = 6 / 29
    f = np.where(n > delta**3, np.cbrt(n), n / (3 * delta**2) + 4 / 29)
    lightness = 116 * f[..., 1] - 16
    a = 500 * (f[..., 0] - f[..., 1])
    b = 200 * (f[..., 1] - f[..., 2])
    return np.stack([lightness, 0.01 * lightness * a, 0.01 * lightness * b], axis=-1)


def hyab(p, q):
    d = p - q
    return np.abs(d[..., 0]) + np.sqrt(d[..., 1] ** 2 + d[..., 2] ** 2)


# ---- filters -------------------------------------------------------------------------------------


def correlate(plane, kernel):
    r = kernel.shape[0] // 2
    padded = np.pad(plane, r, mode="edge")
    out = np.zeros_like(plane)
    for j in range(kernel.shape[0]):
        for i in range(kernel.shape[1]):
            out += kernel[j, i] * padded[j : j + plane.shape[0], i : i + plane.shape[1]]
    return out


def contrast_kernel(terms, ppd):
    r = int(np.ceil(3 * np.sqrt(0.04 / (2 * np.pi**2)) * ppd))
    i = np.arange(-r, r + 1) / ppd
    d2 = i[:, None] ** 2 + i[None, :] ** 2
    g = sum(a * np.sqrt(np.pi / b) * np.exp(-(np.pi**2) * d2 / b) for a, b in terms)
    return g / g.sum()


def feature_kernels(ppd):
    sigma = 0.5 * 0.082 * ppd
    r = int(np.ceil(3 * sigma))
    i = np.arange(-r, r + 1)
    x, y = np.meshgrid(i, i)
    g = np.exp(-(x**2 + y**2) / (2 * sigma**2))
    lobes = lambda k: np.where(k > 0, k / k[k > 0].sum(), np.where(k < 0, k / -k[k < 0].sum(), 0))
    return lobes(-x * g), lobes((x**2 / sigma**2 - 1) * g)


def features(plane, ppd):
    edge, point = feature_kernels(ppd)
    length = lambda k: np.sqrt(correlate(plane, k) ** 2 + correlate(plane, k.T) ** 2)
    return length(edge), length(point)


# ---- FLIP ----------------------------------------------------------------------------------------


def flip(reference, test, ppd):
    """FLIP of display values in [0, 1]."""
    kernels = [contrast_kernel(t, ppd)
               for t in ([(1, 0.0047)], [(1, 0.0053)], [(34.1, 0.04), (13.5, 0.025)])]
    lab, edges, points = [], [], []
    for image in (reference, test):
        t = to_ycxcz(image)
        blurred = np.stack([correlate(t[..., c], kernels[c]) for c in range(3)], axis=-1)
        lab.append(to_hunt_lab(np.clip(from_ycxcz(blurred), 0, 1)))
        edge, point = features((t[..., 0] + 16) / 116, ppd)
        edges.append(edge)
        points.append(point)
    largest = hyab(to_hunt_lab(np.array([0.0, 1.0, 0.0])),
                   to_hunt_lab(np.array([0.0, 0.0, 1.0]))) ** 0.7
    c = hyab(lab[0], lab[1]) ** 0.7
    knee = 0.4 * largest
    color = np.where(c < knee, c * 0.95 / knee, 0.95 + (c - knee) / (largest - knee) * 0.05)
    feature = np.sqrt(np.maximum(np.abs(edges[0] - edges[1]),
                                 np.abs(points[0] - points[1])) / np.sqrt(2))
    return color ** (1 - feature)


def exposures(reference, tone):
    """The published rule; if the median is not positive, the median of the positive values."""
    a, b, c, d, e, f = CURVES[tone]
    p, q, r = a - 0.85 * d, b - 0.85 * e, c - 0.85 * f
    xm = -r / q if p == 0 else max(np.roots([p, q, r]))
    y = np.sort(luminance(reference).ravel())
    median = y[len(y) // 2]
    if not median > 0:
        positive = y[y > 0]
        median = positive[len(positive) // 2]
    start, stop = np.log2(xm / y[-1]), np.log2(xm / median)
    return start, stop, max(2, int(np.ceil(stop - start)))


def hdr_flip(reference, test, ppd, tone):
    start, stop, count = exposures(reference, tone)
    result = np.zeros(reference.shape[:2])
    for i in range(count):
        ev = start + (stop - start) / (count - 1) * i
        result = np.maximum(result,
                            flip(display(reference, ev, tone), display(test, ev, tone), ppd))
    return result, start, stop, count


# ---- header --------------------------------------------------------------------------------------


def numbers(m):
    h, w = m.shape
    flat = np.sort(m.ravel())
    weighted = flat[np.searchsorted(np.cumsum(flat), 0.5 * flat.sum(), side="right")]
    return ", ".join("%.15g" % v for v in (m.mean(), m.max(), weighted, m[0, 0], m[h // 2, w // 2]))


def main():
    print("/* SPDX-License-Identifier: MIT\n *\n * Printed by flip_reference.py; not to be "
          "edited.\n */\n/* clang-format off */")
    print("static const struct ldr_case ldr_cases[] = {")
    for kind, w, h, seed, ppd, ev, tone in LDR:
        r, t = (picture(kind, w, h, seed, i) for i in (0, 1))
        m = flip(display(r, ev, tone), display(t, ev, tone), ppd)
        print("    {%s, %d, %d, %d, %.15g, {%g, %d}, {%s}}," % (kind.__name__, w, h, seed, ppd, ev,
                                                                TONES.index(tone), numbers(m)))
    print("};\n\nstatic const struct hdr_case hdr_cases[] = {")
    for kind, w, h, seed, ppd, tone in HDR:
        r, t = (picture(kind, w, h, seed, i) for i in (0, 1))
        m, start, stop, count = hdr_flip(r, t, ppd, tone)
        print("    {%s, %d, %d, %d, %.15g, %d, %.15g, %.15g, %d, {%s}}," %
              (kind.__name__, w, h, seed, ppd, TONES.index(tone), start, stop, count, numbers(m)))
    print("};\n/* clang-format on */")


main()
