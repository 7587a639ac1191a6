# SPDX-License-Identifier: MIT
"""Images of the library from numpy arrays."""
import collections.abc

import numpy

from . import _library

LARGEST = 2**31 - 1  # pixels of a side, as the library counts them
CODES = {numpy.dtype("u1"): 1, numpy.dtype("u2"): 2}  # bytes of a code of sRGB
COLOURS = {1: ("R",), 3: ("R", "G", "B"), 4: ("R", "G", "B", "A")}


def _planes(what, array):
    """(H, W) or (H, W, 1, 3 or 4) as {channel: plane}."""
    if array.ndim == 2:
        array = array[:, :, None]
    if array.ndim != 3 or array.shape[2] not in COLOURS:
        raise ValueError(f"{what}: shape {array.shape} is no image: (height, width), or with 1, 3 "
                         "or 4 channels behind")
    if 0 in array.shape:
        raise ValueError(f"{what}: shape {array.shape} has no pixels")
    return {name: array[:, :, c] for c, name in enumerate(COLOURS[array.shape[2]])}


def _numbers(what, values):
    """An array of one of the types that are read."""
    if numpy.ma.is_masked(values):
        raise TypeError(f"{what}: masked pixels: fill them, and give a channel 'mask.NAME' to the "
                        "reference")
    try:
        array = numpy.asarray(values)
    except ValueError as error:  # rows of different lengths
        raise ValueError(f"{what}: {error}") from error
    if array.dtype.kind == "f":
        return array.astype(numpy.float32, copy=False)
    if array.dtype.newbyteorder("=") in CODES:
        return array.astype(array.dtype.newbyteorder("="), copy=False)
    raise TypeError(f"{what}: dtype {array.dtype}: floats are linear light, uint8 and uint16 codes "
                    "of sRGB")


def _channels(what, frame):
    """An image as {channel: plane}; a mapping has colours under "rgb", or channels by name."""
    if not isinstance(frame, collections.abc.Mapping):
        return _planes(what, _numbers(what, frame))
    channels = {}
    for name, values in frame.items():
        _library.encode(f"{what}, the name of a channel", name)
        array = _numbers(f"{what}[{name!r}]", values)
        if name == "rgb":
            channels |= _planes(f"{what}['rgb']", array)
        elif array.ndim == 2 and array.size:
            channels[name] = array
        else:
            raise ValueError(f"{what}[{name!r}]: shape {array.shape} is no plane: (height, width)")
    if not channels:
        raise ValueError(f"{what}: no channels")
    return channels


def _drop_opaque(what, channels):
    """Display images have no transparency, as PNG files."""
    alpha = channels.get("A")
    if alpha is not None and alpha.dtype in CODES:
        if (alpha != numpy.iinfo(alpha.dtype).max).any():
            raise ValueError(f"{what}: translucent pixels: composite the image first")
        del channels["A"]


def _code_bytes(plane):
    return (CODES[plane.dtype],) if plane.dtype in CODES else ()


def make_image(what, frame):
    """A handle of an image; the library copies the samples."""
    channels = _channels(what, frame)
    _drop_opaque(what, channels)
    shapes = {plane.shape for plane in channels.values()}
    if len(shapes) > 1:
        raise ValueError(f"{what}: channels of different sizes: "
                         f"{', '.join(str(shape) for shape in sorted(shapes))}")
    (height, width), = shapes
    if max(height, width) > LARGEST:
        raise ValueError(f"{what}: {width} x {height} pixels: {LARGEST} are the most of a side")
    try:
        image = _library.Handle("image", width, height)
    except _library.Error as error:
        raise _library.InputError(error.status, f"{what}: {error}") from error
    for name, plane in channels.items():
        where = (plane.ctypes.data, *_code_bytes(plane), plane.strides[1], plane.strides[0])
        function = f"nephm_image_set_{'srgb_codes' if plane.dtype in CODES else 'floats'}"
        _library.call(function, image.pointer, _library.encode(what, name), *where)
    return image


def as_list(what, frames):
    """(name, frame) of each image: an image by itself, a list, or an array of (frames, height,
    width, channels)."""
    if isinstance(frames, collections.abc.Mapping):
        return [(what, frames)]
    if isinstance(frames, (list, tuple)) and frames and not numpy.isscalar(frames[0]):
        return [(f"{what}[{i}]" if len(frames) > 1 else what, frame)
                for i, frame in enumerate(frames)]
    array = _numbers(what, frames)
    if array.ndim == 4:
        return as_list(what, list(array))
    return [(what, array)]
