#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Random calls of the Python module: images of any shape, type, value and place in memory, and any
options. Each ends in a result or in an exception of the kinds that the module documents. An image
that is valid has the numbers of the same image in plain memory.

    NEPH_METRICS_LIBRARY=... python3 tests/harness/python_fuzz.py --seed S [--first N] [--count N]
                                                                  [--seconds T]

Prints each call's number before the call, as the last line of a crash, and ends with the counts.
"""
import argparse
import collections
import faulthandler
import math
import pathlib
import sys
import time
import traceback
import warnings

import numpy

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "python"))
import neph  # noqa: E402

DOCUMENTED = (ValueError, TypeError, MemoryError, neph.Error)
TYPES = ["f2", "f4", "f8", "g", ">f4", ">f8", "u1", "u2", ">u2", "i1", "i2", "i4", "i8", "u4", "u8",
         "?", "c8", "S3", "U2", "O", "M8[s]", "V4"]
VALUES = [math.nan, math.inf, -math.inf, -1.0, -0.0, 1e-45, 3e38, 1e300, 65504.0]
NAMES = ["R", "G", "B", "A", "Z", "rgb", "mask.sky", "mask.mine", "motion.X", "motion.Y",
         "depth_edge", "", "a" * 300, "\ud800", "R\0", "é", "transmittance.R", 7, None, b"R"]
WORDS = ["", "error", "error,ssim", "flip", "nope", "error\0", "\ud800", "é", "all", "sky",
         "mine", "x" * 5000, "%s%n", "flicker", "lag:step_frame=8", "flip:tone=aces", "a:b=c", "=",
         ":", ",,"]
NUMBERS = [0, 1, -1, 2, 30, 0.5, 1e-300, 1e300, math.nan, math.inf, -math.inf, 10**400, True, None,
           "", "30", "fast", "1\0", b"1", 1j, [], {}, numpy.float32(30), numpy.int64(2),
           numpy.bool_(True), numpy.float64("nan"), numpy.array([1.0]), object()]
OPTIONS = {"metric": [None, ["error", None], ("ssim",), 5, *WORDS],
           "settings": [(), None, 5, [None], [b"x"], *([word] for word in WORDS), *WORDS],
           "mask": [None, 5, b"all", *WORDS], "rings": [True, False, *NUMBERS],
           "warm_up": NUMBERS, "fps": NUMBERS, "ppd": NUMBERS, "exposure": NUMBERS,
           "white": NUMBERS, "negative_ok": [True, *NUMBERS], "frozen_ok": [True, *NUMBERS]}


class Draw:
    def __init__(self, seed, number):
        self.random = numpy.random.default_rng([seed, number])

    def one_of(self, things):
        return things[self.random.integers(len(things))]

    def chance(self, probability):
        return self.random.random() < probability

    # ---- images ------------------------------------------------------------------------------

    def light(self, height, width, channels):
        """A valid image."""
        shape = (height, width, channels) if channels else (height, width)
        array = self.random.random(shape) * 2
        kind = self.one_of(["f4", "f4", "f2", "f8", ">f4", "u1", "u2", ">u2"])
        if kind[-2] == "u":
            array = array / 2 * numpy.iinfo(kind).max
            if channels == 4:
                array[..., 3] = numpy.iinfo(kind).max
        return array.astype(kind)

    def placed(self, array):
        """The same values in another layout."""
        how = self.random.integers(7)
        if how == 0:
            array = numpy.asfortranarray(array)
        elif how == 1:
            turned = (slice(None, None, -1),) * self.random.integers(array.ndim + 1)
            array = array[turned].copy()[turned]
        elif how == 2:
            steps = tuple(int(self.random.integers(1, 4)) for _ in array.shape)
            wide = numpy.ones([n * step for n, step in zip(array.shape, steps)], array.dtype)
            view = wide[tuple(slice(step - 1, None, step) for step in steps)]
            view[...] = array
            array = view
        elif how == 3:  # at an odd address
            data = bytearray(array.nbytes + 1)
            view = numpy.frombuffer(data, array.dtype, array.size, 1).reshape(array.shape)
            view[...] = array
            array = view
        elif how == 4:
            array = array.copy()
            array.flags.writeable = False
        elif how == 5:
            array = numpy.moveaxis(numpy.moveaxis(array, -1, 0).copy(), 0, -1)
        return array

    def wrong(self):
        """An argument that is no valid image, mostly."""
        how = self.random.integers(12)
        if how < 5:
            shape = self.random.integers(0, 14, self.random.integers(0, 6))
            array = numpy.asarray(self.random.standard_normal(shape) * 100)
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                try:
                    array = array.astype(self.one_of(TYPES))
                except (TypeError, ValueError):
                    pass
            return self.placed(array) if array.ndim else array
        if how == 5:
            return numpy.broadcast_to(numpy.float32(1), self.one_of(
                [(9, 9), (1, 2**32 + 9), (2**33, 2**33), (2**31, 1), (0, 2**40), (9, 9, 2**31)]))
        if how == 6:
            return numpy.ma.masked_greater(self.light(9, 9, 3), 1)
        if how == 7:
            return {self.one_of(NAMES): self.one_of([None, 1.0, {}, self.light(9, 9, 0),
                                                    self.light(9, 9, 3), self.light(3, 4, 0)])
                    for _ in range(self.random.integers(4))}
        return self.one_of([None, "x", b"x", 1, 1.5, [], (), {}, [[]], [[[]]], [[1, 2], [3]],
                            object(), set(), range(3), [None], [{}], {"R": None}, [["a"]],
                            memoryview(b"abcd"), numpy.float32(1), iter([1]), Ellipsis, int])

    def image(self, size):
        if self.chance(0.15):
            return self.wrong()
        array = self.placed(self.light(*size, self.one_of([0, 1, 3, 3, 3, 4])))
        if array.dtype.kind == "f" and self.chance(0.15):
            array = array.copy()
            with numpy.errstate(over="ignore"):
                array.flat[self.random.integers(array.size)] = self.one_of(VALUES)
        if self.chance(0.25):
            depth = self.random.random(size) * 100
            depth[self.random.random(size) < 0.3] = self.one_of([math.inf, 5.0, 1e30])
            array = {"rgb": array, "Z": self.placed(depth.astype("f4"))}
            if self.chance(0.3):
                array[self.one_of(NAMES)] = self.image(size) if self.chance(0.3) \
                    else self.light(*size, 0)
        return array

    def images(self, size, count):
        if self.chance(0.5):
            return self.image(size)
        if self.chance(0.3):
            return self.random.random((count, *size, 3)).astype(self.one_of(["f4", "f8", "O"]))
        return [self.image(size) for _ in range(count)]

    def options(self, names):
        options = {"metric": self.one_of(["error", "ssim", "error,flip", "flicker", "seen"])}
        for _ in range(self.random.integers(4) if self.chance(0.5) else 0):
            name = self.one_of(names)
            options[name] = self.one_of(OPTIONS[name])
        return options


def check_result(result):
    assert result.numbers and isinstance(result.document, dict)
    assert len(result.numbers) == len(result.document["measurements"])
    for number in result.numbers:
        assert isinstance(number.value, float) and isinstance(number.metric, str), number
        assert math.isnan(number.value) == (number.undefined_because is not None), number
    repr(result)


def call_anything(draw):
    size = tuple(int(n) for n in draw.random.integers(1, 20, 2))
    count = int(draw.one_of([1, 1, 2, 3, 17]))
    is_flicker = draw.chance(0.3)
    names = sorted(set(OPTIONS) - (set() if is_flicker else {"frozen_ok"}))
    options = draw.options(names)
    try:
        if is_flicker:
            reference = draw.images(size, count) if draw.chance(0.6) else None
            result = neph.flicker(draw.images(size, count), reference, **options)
        else:
            result = neph.compare(draw.images(size, count), draw.images(size, count), **options)
    except neph.FrozenError as error:
        result = error.result
    check_result(result)


def compare_layouts(draw):
    """An image in any layout has the numbers of its contiguous copy."""
    size = tuple(int(n) for n in draw.random.integers(1, 20, 2))
    image = draw.light(*size, draw.one_of([0, 1, 3, 4]))
    other = (image // 2 if image.dtype.kind == "u" else image * 0.9).astype(image.dtype)
    if image.ndim == 3 and image.shape[2] == 4:
        other[..., 3] = image[..., 3]
    wanted = neph.compare(image, other, metric="error")
    found = neph.compare(draw.placed(image), draw.placed(other), metric="error")
    assert repr(wanted.numbers) == repr(found.numbers)
    check_result(found)


def run_case(seed, number):
    """The name of the exception, or "numbers"."""
    draw = Draw(seed, number)
    try:
        (compare_layouts if number % 4 == 0 else call_anything)(draw)
    except DOCUMENTED as error:
        assert number % 4, "a valid image was refused"
        assert str(error).strip(), "an error without a word"
        return type(error).__name__
    return "numbers"


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seed", type=int, required=True)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--count", type=int, default=10**9)
    parser.add_argument("--seconds", type=float, default=1e9)
    options = parser.parse_args()
    faulthandler.enable()
    warnings.simplefilter("ignore", RuntimeWarning)  # numpy: doubles beyond float32
    ends, counts, failed = time.monotonic() + options.seconds, collections.Counter(), 0
    number = options.first
    while number < options.first + options.count and time.monotonic() < ends:
        print(f"seed {options.seed} call {number}", flush=True)
        try:
            counts[run_case(options.seed, number)] += 1
        except Exception:
            failed += 1
            traceback.print_exc()
            print(f"failed: --seed {options.seed} --first {number} --count 1", file=sys.stderr)
        number += 1
    print(f"{number - options.first} calls, {failed} failed: {dict(counts)}")
    return int(failed > 0)


if __name__ == "__main__":
    sys.exit(main())
