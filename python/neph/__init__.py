# SPDX-License-Identifier: MIT
"""Errors, flicker and lag of rendered frames, as the program `neph` measures them.

    import neph
    result = neph.compare(reference, test)          # numpy arrays: floats are linear light,
    result["rel_rmse"].value                        # uint8 and uint16 codes of sRGB
    result = neph.flicker(frames, reference=still)  # a list, or an array (n, height, width, 3)
    result.table()                                  # of pandas, where it is installed

The numbers are those of `neph compare` and `neph flicker` for files with these values, to the bit.
Metrics, masks and channels have the names that `neph metrics` lists.
"""
from __future__ import annotations

import ctypes
import dataclasses
import json
import math
from collections.abc import Mapping, Sequence
from typing import Any, Union

import numpy

from . import _frames, _library
from ._library import Error, FrozenError, InputError

__all__ = ["compare", "flicker", "Number", "Result", "Error", "InputError", "FrozenError",
           "version"]

# An image: (height, width), (height, width, 1, 3 or 4), or channels by their names ("rgb": an
# image; "Z": depth in m along the camera's axis, inf the sky; "mask.NAME", ...).
Image = Union[numpy.ndarray, Mapping[str, numpy.ndarray]]
Images = Union[Image, Sequence[Image]]

_COMPARE, _FLICKER = 0, 1


def version() -> str:
    """The version of libneph_metrics."""
    return _library.library.nephm_version().decode()


@dataclasses.dataclass(frozen=True)
class Number:
    """A number of a metric, of a quantity, over a mask."""

    extractor: str
    metric: str
    quantity: str
    mask: str
    unit: str
    frame: int | None  # None: all frames together
    value: float  # NaN: undefined
    low: float | None  # 95 % interval; None: there is none
    high: float | None
    undefined_because: str | None


@dataclasses.dataclass(frozen=True)
class Result:
    """What was measured. `document` is what the command prints with --json."""

    numbers: tuple[Number, ...]
    document: dict[str, Any]

    def find(self, metric: str, *, mask: str = "all", quantity: str | None = None,
             frame: int | None = None) -> Number:
        """The number of a metric; of all frames together where there are several. KeyError."""
        found = [n for n in self.numbers if n.metric == metric and n.mask == mask and
                 quantity in (None, n.quantity)]
        exact = [n for n in found if n.frame == frame] or (found if frame is None else [])
        if not exact:
            names = ", ".join(sorted({n.metric for n in self.numbers}))
            raise KeyError(f"no number {metric!r} over the mask {mask!r}; metrics are {names}")
        return exact[0]

    def __getitem__(self, metric: str) -> Number:
        return self.find(metric)

    def table(self):
        """The numbers as a pandas.DataFrame, a column for each field of Number. A frame of all
        frames together is NA, an interval that there is not NaN. ImportError without pandas."""
        import pandas
        names = [field.name for field in dataclasses.fields(Number)]
        rows = [[getattr(number, name) for name in names] for number in self.numbers]
        return pandas.DataFrame(rows, columns=names).astype(
            {"frame": "Int64", "value": float, "low": float, "high": float})


def compare(reference: Images, test: Images, *, metric: str | Sequence[str] | None = None,
            settings: str | Sequence[str] = (), mask: str | None = None, rings: bool = False,
            warm_up: int = 0, fps: float | None = None, ppd: float | None = None,
            exposure: float | None = None, white: float | None = None,
            negative_ok: bool = False) -> Result:
    """The error of each image of `test`. `reference` is one image for all, or as many. Options are
    those of `neph compare`; `settings` are "EXTRACTOR:KEY=VALUE". The sign is test - reference.

    ValueError, TypeError: an image, a value or an option that cannot be used, and where it is."""
    options = locals()
    reference, test = options.pop("reference"), options.pop("test")
    return _measure(_COMPARE, reference, test, options)


def flicker(frames: Images, reference: Images | None = None, *,
            metric: str | Sequence[str] | None = None, settings: Sequence[str] = (),
            mask: str | None = None, rings: bool = False, warm_up: int = 0,
            fps: float | None = None, ppd: float | None = None, exposure: float | None = None,
            white: float | None = None, negative_ok: bool = False,
            frozen_ok: bool = False) -> Result:
    """Unwanted change of a sequence over time. Without a reference, change of the scene itself
    counts as flicker. Options are those of `neph flicker`.

    FrozenError: frames are equal to those before them, and `frozen_ok` is not set."""
    options = locals()
    frames, reference = options.pop("frames"), options.pop("reference")
    return _measure(_FLICKER, reference, frames, options)


def _words(value):
    """The words of an option: of a text one, of None none."""
    return [value] if isinstance(value, str) else list(value if value is not None else ())


def _option_text(value):
    for kind, plain in ((numpy.bool_, bool), (numpy.integer, int), (numpy.floating, float)):
        if isinstance(value, kind):
            value = plain(value)
    if isinstance(value, bool):
        return "on" if value else "off"
    return value if isinstance(value, str) else repr(value)


def _set_options(task, options):
    pairs = [("metric", word) for word in _words(options.pop("metric"))]
    pairs += [("set", word) for word in _words(options.pop("settings"))]
    pairs += [(name, _option_text(value)) for name, value in options.items() if value is not None]
    for name, text in pairs:
        _library.call("nephm_task_set", task.pointer, name.replace("_", "-").encode(),
                      _library.encode("settings" if name == "set" else name, text))


def _make_images(what, frames):
    """Handles of images, and the list of them for the library."""
    images = [_frames.make_image(name, frame) for name, frame in _frames.as_list(what, frames)]
    return images, (ctypes.c_void_p * len(images))(*(image.pointer for image in images))


def _measure(kind, reference, test, options):
    task = _library.Handle("task", kind)
    _set_options(task, options)
    references, reference_list = _make_images("reference", reference) if reference is not None \
        else ([], None)
    tests, test_list = _make_images("test", test)
    result = _library.Handle("result")
    try:
        _library.call("nephm_task_run", task.pointer, reference_list, len(references), test_list,
                      len(tests), ctypes.byref(result.pointer))
    except InputError as error:
        if not result.pointer:
            raise
        frozen = FrozenError(error.status, str(error))  # the only error with a result
        frozen.result = _take(result)
        raise frozen from None
    return _take(result)


def _text(value):
    return None if value is None else value.decode()


def _take(handle):
    numbers, raw = [], _library.Number()
    for i in range(_library.library.nephm_result_count(handle.pointer)):
        _library.call("nephm_result_number", handle.pointer, i, ctypes.byref(raw))
        numbers.append(Number(
            *(_text(getattr(raw, name)) for name in ("extractor", "metric", "quantity", "mask",
                                                     "unit")),
            frame=None if raw.frame < 0 else raw.frame,
            value=raw.value if raw.is_defined else math.nan,
            low=None if math.isnan(raw.low) else raw.low,
            high=None if math.isnan(raw.high) else raw.high,
            undefined_because=_text(raw.undefined_because)))
    document = json.loads(_library.library.nephm_result_json(handle.pointer).decode())
    return Result(tuple(numbers), document)
