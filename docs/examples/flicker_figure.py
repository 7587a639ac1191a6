#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Error and flicker of two presets of engine `realtime` as a figure, flicker_figure.svg.

    python3 flicker_figure.py        or cell by cell in an editor that knows `# %%`

Needs neph in PATH, its Python module, and matplotlib (apt install python3-matplotlib).
"""
# %% Packages, and what is rendered
import pathlib
import struct
import subprocess
import sys
import tempfile
import zlib

import numpy

import neph

try:
    from matplotlib import pyplot
except ImportError as error:
    sys.exit(f"flicker_figure.py: {error}: apt install python3-matplotlib")

SCENE, SIZE, FPS = "fence_drift", "96x54", 30
FRAMES, WARM_UP = 48, 16
PRESETS = {"fixed": "tab:red", "ours": "tab:blue"}  # and their colours
MASKS = {"all": "all pixels", "sky": "sky", "depth_edge": "depth edges", "thin": "thin objects"}


# %% Frames as mappings of channels
def text_at(data, at):
    """The text up to the next zero byte, and the position after it."""
    end = data.index(b"\0", at)
    return data[at:end].decode(), end + 1


def unzip(packed, size):
    """Bytes of a ZIP chunk: differences of neighbours, and even bytes before odd ones."""
    if len(packed) == size:
        return numpy.frombuffer(packed, "u1")
    differences = numpy.frombuffer(zlib.decompress(packed), "u1").astype(int)
    halves = (numpy.cumsum(differences - 128) + 128) % 256
    plain = numpy.empty(size, "u1")
    plain[0::2], plain[1::2] = halves[:(size + 1) // 2], halves[(size + 1) // 2:]
    return plain


def read_exr(path):
    """{channel: plane} of a file that neph wrote: 32-bit floats, ZIP in chunks of 16 lines."""
    data, at, header, names, place = path.read_bytes(), 8, {}, [], 0
    while data[at]:
        name, at = text_at(data, at)
        _, at = text_at(data, at)
        size, = struct.unpack_from("<i", data, at)
        header[name], at = data[at + 4:at + 4 + size], at + 4 + size
    while header["channels"][place]:
        name, place = text_at(header["channels"], place)
        names, place = [*names, name], place + 16
    left, top, right, bottom = struct.unpack("<4i", header["dataWindow"])
    width, height = right - left + 1, bottom - top + 1
    chunks = []
    for offset in numpy.frombuffer(data, "<u8", (height + 15) // 16, at + 1).tolist():
        y, size = struct.unpack_from("<ii", data, offset)
        lines = min(16, bottom + 1 - y)
        plain = unzip(data[offset + 8:offset + 8 + size], 4 * width * len(names) * lines)
        chunks.append(plain.view("<f4").reshape(lines, len(names), width))
    planes = numpy.concatenate(chunks)
    return {name: planes[:, i] for i, name in enumerate(names)}


def render(*words):
    """Frames of the scene by an engine, in numpy arrays: colours and depth."""
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run(["neph", "render", SCENE, *words, "--frames", str(FRAMES), "--size", SIZE,
                        "-q", "-o", folder], check=True, stdout=subprocess.DEVNULL)
        frames = [read_exr(path) for path in sorted(pathlib.Path(folder).glob("*.exr"))]
    return [{name: frame[name] for name in "RGBZ"} for frame in frames]


# %% Two presets, and four rays in each pixel as their reference
reference = render("-e", "march", "-s", "rays_per_px=4")
sequences = {preset: render("-e", "realtime", "-p", preset) for preset in PRESETS}

# %% Error of each frame, flicker of each sequence
errors = {preset: neph.compare(reference[WARM_UP:], frames[WARM_UP:], metric="flip")
          for preset, frames in sequences.items()}
flicker = {preset: neph.flicker(frames, reference=reference, metric="seen", warm_up=WARM_UP,
                                fps=FPS) for preset, frames in sequences.items()}


# %% The figure; bands and bars are 95 % intervals over tiles of the image
def draw_error(axes, preset):
    numbers = [errors[preset].find("flip_mean", frame=i) for i in range(FRAMES - WARM_UP)]
    at = [WARM_UP + number.frame for number in numbers]
    axes.plot(at, [number.value for number in numbers], color=PRESETS[preset], label=preset)
    axes.fill_between(at, [number.low for number in numbers], [number.high for number in numbers],
                      color=PRESETS[preset], alpha=0.2, linewidth=0)


def draw_flicker(axes, preset, shift):
    for i, mask in enumerate(MASKS):
        number = flicker[preset].find("seen_contrast", mask=mask)
        low, high = (number.value if end is None else end for end in (number.low, number.high))
        axes.bar(i + shift, number.value, 0.36, color=PRESETS[preset], capsize=3,
                 yerr=[[number.value - low], [high - number.value]])


figure, (left, right) = pyplot.subplots(1, 2, figsize=(10, 4), layout="constrained")
for preset, shift in zip(PRESETS, (-0.2, 0.2)):
    draw_error(left, preset)
    draw_flicker(right, preset, shift)
left.set(title="Error", xlabel="frame", ylabel="mean of FLIP", ylim=(0, None))
right.set(title="Flicker seen", ylabel="contrast / threshold (1: just visible)",
          xticks=range(len(MASKS)), xticklabels=MASKS.values())
right.axhline(1, color="black", linestyle=":", linewidth=1)
left.legend(title="preset", frameon=False)
figure.suptitle(f"{SCENE}, {SIZE}, {FPS} Hz")
figure.savefig("flicker_figure.svg")
print("flicker_figure.svg")
