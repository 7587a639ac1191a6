#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Writes image_reference.h: image metrics of synthetic frames, evaluated with numpy from the
definitions, independent of metrics/. Run by hand: python3 image_reference.py"""

import pathlib

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

try:
    from skimage.metrics import structural_similarity
except ImportError:
    structural_similarity = None

MASK64 = (1 << 64) - 1


def splitmix(state):
    """As neph_test_random()."""
    while True:
        state = (state + 0x9e3779b97f4a7c15) & MASK64
        z = state
        z = ((z ^ (z >> 30)) * 0xbf58476d1ce4e5b9) & MASK64
        z = ((z ^ (z >> 27)) * 0x94d049bb133111eb) & MASK64
        yield z ^ (z >> 31)


def pattern(x, y, c):
    return (3 * x + 5 * y + 40 * ((x // 8 + y // 8) % 2) + 11 * c) % 97 / 32


def frames(width, height, seed):
    """Reference, test, second reference: height x width x 3, exact in single precision. The test is
    noisier, and shifted by up to a pixel in tiles of 16 px."""
    draw = splitmix(seed)
    out = np.zeros((3, height, width, 3))
    for y in range(height):
        for x in range(width):
            for c in range(3):
                clean = pattern(x + 1, y + 1, c)
                moved = pattern(x + x // 16 % 3, y + y // 16 % 3, c)
                noise = [(next(draw) & 255) for _ in range(3)]
                out[0, y, x, c] = clean + noise[0] / 1024
                out[1, y, x, c] = max(0.0, moved + noise[1] / 512 - 0.1875)
                out[2, y, x, c] = clean + noise[2] / 1024
    assert np.array_equal(out, out.astype(np.float32))
    return out


def luminance(rgb):
    return rgb @ np.array([0.2126, 0.7152, 0.0722])


def pu21(cd):
    p = [.353487901, .3734658629, 8.277049286e-05, .9062562627, .09150303166, .9099517204,
         596.3148142]
    cd = np.clip(cd, 0.005, 1e4)
    power = cd ** p[3]
    return np.maximum(p[6] * (((p[0] + p[1] * power) / (1 + p[2] * power)) ** p[4] - p[5]), 0)


def encoded(rgb):
    v = np.clip(rgb, 0, 1)
    return np.where(v <= 0.0031308, 12.92 * v, 1.055 * np.maximum(v, 1e-9) ** (1 / 2.4) - 0.055)


def display(rgb):
    return 255 * luminance(encoded(rgb))


def window():
    g = np.exp(-np.arange(-5, 6) ** 2 / (2 * 1.5 ** 2))
    g = np.outer(g, g)
    return g / g.sum()


def averaged(image):
    return np.einsum("ijkl,kl->ij", sliding_window_view(image, (11, 11)), window())


def ssim(x, y, peak):
    """Luminance, contrast and structure at every window."""
    c1, c2 = (0.01 * peak) ** 2, (0.03 * peak) ** 2
    mx, my = averaged(x), averaged(y)
    vx, vy = averaged(x * x) - mx * mx, averaged(y * y) - my * my
    covariance = averaged(x * y) - mx * my
    both = np.sqrt(np.maximum(vx, 0) * np.maximum(vy, 0))
    return ((2 * mx * my + c1) / (mx * mx + my * my + c1), (2 * both + c2) / (vx + vy + c2),
            (covariance + c2 / 2) / (both + c2 / 2))


def uniform_ssim(x, y):
    """Equation 13 of Wang et al. in each window of 7x7, with sample covariance; L = 1."""
    c1, c2 = 0.01 ** 2, 0.03 ** 2
    a, b = (sliding_window_view(image, (7, 7)).reshape(-1, 49) for image in (x, y))
    ma, mb = a.mean(axis=1), b.mean(axis=1)
    covariance = ((a - ma[:, None]) * (b - mb[:, None])).sum(axis=1) / 48
    variances = a.var(axis=1, ddof=1) + b.var(axis=1, ddof=1)
    return ((2 * ma * mb + c1) * (2 * covariance + c2) / ((ma * ma + mb * mb + c1) *
                                                          (variances + c2))).mean()


def published_ssim(reference, test):
    """Of values in sRGB; where scikit-image is installed, compared with it."""
    luma = np.array([0.299, 0.587, 0.114])
    channels = [(reference[..., c], test[..., c]) for c in range(3)]
    found = {"srgb_ssim": np.mean([np.prod(ssim(x, y, 1), axis=0).mean() for x, y in channels]),
             "srgb_ssim_luma": np.prod(ssim(reference @ luma, test @ luma, 1), axis=0).mean(),
             "srgb_ssim_7x7": np.mean([uniform_ssim(x, y) for x, y in channels])}
    if structural_similarity:
        wang = {"gaussian_weights": True, "sigma": 1.5, "use_sample_covariance": False,
                "data_range": 1}
        theirs = {"srgb_ssim": structural_similarity(reference, test, channel_axis=-1, **wang),
                  "srgb_ssim_luma": structural_similarity(reference @ luma, test @ luma, **wang),
                  "srgb_ssim_7x7": structural_similarity(reference, test, channel_axis=-1,
                                                         data_range=1)}
        for name, value in theirs.items():
            assert abs(value - found[name]) < 1e-12, (name, value, found[name])
    return found


def shrunk(image, kernel, factor, out_shape):
    """Each pixel of the result is a sum over the plane, with numpy's symmetric border."""
    taps = kernel.shape[0]
    before, after = taps // 2, taps + factor
    padded = np.pad(image, ((before, after), (before, after)), mode="symmetric")
    rows, columns = out_shape
    out = np.zeros(out_shape)
    for i in range(rows):
        for j in range(columns):
            patch = padded[i * factor:i * factor + taps, j * factor:j * factor + taps]
            out[i, j] = (patch * kernel).sum()
    return out


def ms_ssim(x, y, peak):
    wavelet = np.array([.0378, -.0238, -.1106, .3774, .8527, .3774, -.1106, -.0238, .0378])
    wavelet /= wavelet.sum()
    kernel = np.outer(wavelet, wavelet)
    product = 1.0
    for scale, power in enumerate([.0448, .2856, .3001, .2363, .1333]):
        if scale > 0:
            half = ((x.shape[0] + 1) // 2, (x.shape[1] + 1) // 2)
            x, y = shrunk(x, kernel, 2, half), shrunk(y, kernel, 2, half)
        l, c, s = ssim(x, y, peak)
        product *= c.mean() ** power * s.mean() ** power
    return product * l.mean() ** power


def decimated(image):
    factor = int(np.floor(min(image.shape) / 256 + 0.5))
    assert factor > 1
    shape = tuple(n // factor + n % 2 for n in image.shape)
    return shrunk(image, np.full((factor, factor), 1 / factor ** 2), factor, shape)


def shifted_squares(reference, test):
    """Mean square over colours; every 8x8 block has the best of nine shifts."""
    height, width = reference.shape[:2]
    padded = np.pad(test, ((1, 1), (1, 1), (0, 0)), mode="edge")
    squares = {(dy, dx): ((padded[1 + dy:1 + dy + height, 1 + dx:1 + dx + width] - reference) ** 2)
               .mean(axis=2) for dy in (-1, 0, 1) for dx in (-1, 0, 1)}
    out = np.zeros((height, width))
    for y in range(0, height, 8):
        for x in range(0, width, 8):
            block = np.s_[y:y + 8, x:x + 8]
            ranked = sorted(squares, key=lambda m: squares[m][block].sum())
            best, next_best = squares[ranked[0]][block], squares[ranked[1]][block]
            # No tie that rounding could break, unless it has no effect (past the border).
            assert next_best.sum() > best.sum() * 1.00001 or np.array_equal(best, next_best)
            out[block] = squares[ranked[0]][block]
    return out


def numbers(width, height, seed, white, ev):
    reference, test, second = frames(width, height, seed)
    found = {"width_px": width, "height_px": height, "seed": seed, "white_cd_per_m2": white,
             "exposure_ev": ev}
    lr, lt = luminance(reference), luminance(test)
    floor = 1e-4 * lr.mean()
    stops = np.abs(np.log2(np.maximum(lt, floor) / np.maximum(lr, floor)))
    found["stops_mean"], found["stops_p50"] = stops.mean(), np.median(stops)
    found["stops_p95"] = np.percentile(stops, 95)
    cr, ct = (pu21(white * 2.0 ** ev * l) for l in (lr, lt))
    found["pu_mse"] = ((cr - ct) ** 2).mean()
    l, c, s = ssim(cr, ct, 256)
    found["ssim_mean"], found["ssim_p5"] = (l * c * s).mean(), np.percentile(l * c * s, 5)
    found["ssim_first"], found["ssim_last"] = (l * c * s)[0, 0], (l * c * s)[-1, -1]
    dr, dt = (display(2.0 ** ev * f) for f in (reference, test))
    found["ssim_display"] = np.prod(ssim(dr, dt, 255), axis=0).mean()
    found |= published_ssim(*(encoded(2.0 ** ev * f) for f in (reference, test)))
    big = min(width, height) >= 176
    found["ms_ssim"] = ms_ssim(cr, ct, 256) if big else 0
    found["ms_ssim_display"] = ms_ssim(dr, dt, 255) if big else 0
    found["ssim_decimated"] = 0
    if min(width, height) >= 384:
        found["ssim_decimated"] = np.prod(ssim(decimated(cr), decimated(ct), 256), axis=0).mean()
    found["mse"] = ((test - reference) ** 2).mean()
    found["mse_shift1"] = shifted_squares(reference, test).mean()
    found["mse_unbiased"] = ((test - reference) * (test - second)).mean()
    found["noise_variance"] = ((reference - second) ** 2).mean() / 2
    found["mse_mean_reference"] = ((test - (reference + second) / 2) ** 2).mean()
    return found


def write(path):
    cases = [numbers(193, 181, 1, 100, 0), numbers(12, 11, 2, 100, 0), numbers(61, 50, 3, 250, -2),
             numbers(385, 391, 4, 40, 1.5), numbers(40, 176, 5, 1000, 3)]
    out = ["/* SPDX-License-Identifier: MIT", " *",
           " * Written by image_reference.py (numpy, double precision). Do not edit.", " */",
           "#ifndef NEPH_TESTS_METRICS_IMAGE_REFERENCE_H",
           "#define NEPH_TESTS_METRICS_IMAGE_REFERENCE_H", "", "/* clang-format off */",
           "struct image_reference {", "    int width_px, height_px, seed;",
           "    double " + ", ".join(k for k in cases[0] if k not in
                                     ("width_px", "height_px", "seed")) + ";",
           "};", "", "static const struct image_reference image_references[] = {"]
    for case in cases:
        out.append("    {" + ", ".join(".%s = %.17g" % item for item in case.items()) + "},")
    out += ["};", "", "/* clang-format on */", "", "#endif", ""]
    path.write_text("\n".join(out), encoding="utf-8")


if __name__ == "__main__":
    write(pathlib.Path(__file__).with_name("image_reference.h"))
