#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""An example of a renderer for engine `command`: even fog, thinned by distance, without sunlight.

    NEPH_COMMAND=docs/examples/fog.py neph render SCENE -e command -s a=0.05

`a` is the extinction per metre. Solids are black, the sky shines; nothing else of the scene is
looked at. Without libraries, so that it runs everywhere.
"""
import array
import json
import math
import struct
import sys


def read_depth(path, width, height):
    """The one channel of depth.exr, which is never compressed: offset table, then lines."""
    data = open(path, "rb").read()
    at = 8
    while data[at]:  # attributes: name, type, size, value; an empty name ends them
        at = data.index(b"\0", at) + 1
        at = data.index(b"\0", at) + 1
        at += 4 + struct.unpack_from("<i", data, at)[0]
    lines = struct.unpack_from(f"<{height}Q", data, at + 1)
    return [struct.unpack_from(f"<{width}f", data, line + 8) for line in lines]


def attribute(name, kind, value):
    return name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<i", len(value)) + value


def write_frame(path, width, height, channels):
    """Floats, uncompressed. `channels`: a list of lines for each name."""
    names = sorted(channels)
    listed = b"".join(n.encode() + b"\0" + struct.pack("<iiii", 2, 0, 1, 1) for n in names) + b"\0"
    box = struct.pack("<iiii", 0, 0, width - 1, height - 1)
    header = struct.pack("<ii", 20000630, 2)
    for name, kind, value in (("channels", "chlist", listed), ("compression", "compression", b"\0"),
                              ("dataWindow", "box2i", box), ("displayWindow", "box2i", box),
                              ("lineOrder", "lineOrder", b"\0"),
                              ("pixelAspectRatio", "float", struct.pack("<f", 1)),
                              ("screenWindowCenter", "v2f", struct.pack("<ff", 0, 0)),
                              ("screenWindowWidth", "float", struct.pack("<f", 1))):
        header += attribute(name, kind, value)
    header += b"\0"
    size = 4 * width * len(names)
    start = len(header) + 8 * height
    with open(path, "wb") as file:
        file.write(header)
        file.write(struct.pack(f"<{height}Q", *(start + y * (size + 8) for y in range(height))))
        for y in range(height):
            file.write(struct.pack("<ii", y, size))
            for name in names:
                file.write(array.array("f", channels[name][y]).tobytes())


def render(job):
    width, height = job["size_px"]
    tangent = math.tan(job["camera"]["vertical_fov_rad"] / 2.0)
    extinction_per_m = job["settings"]["a"]
    depth = read_depth("depth.exr", width, height)
    transmittance = []
    for y in range(height):
        up = tangent * (1.0 - 2.0 * (y + 0.5) / height)
        line = []
        for x in range(width):
            right = tangent * (2.0 * (x + 0.5) / width - 1.0) * width / height
            distance_m = depth[y][x] * math.sqrt(1.0 + up * up + right * right)
            line.append(math.exp(-extinction_per_m * distance_m) if extinction_per_m else 1.0)
        transmittance.append(line)
    channels = {"Z": depth}
    for c, name in enumerate("RGB"):
        sky = job["background_w_per_m2_sr"][c]
        channels["transmittance." + name] = transmittance
        channels[name] = [[sky * t if z == math.inf else 0.0 for t, z in zip(*rows)]
                          for rows in zip(transmittance, depth)]
    write_frame("frame.exr", width, height, channels)


def main():
    if sys.argv[1:] == ["--version"]:
        print("example fog 1.0")
        return
    job = json.load(open(sys.argv[1]))
    if job["camera"]["orthographic_height_m"]:
        open("cannot.txt", "w").write("orthographic cameras\n")
        return
    render(job)


if __name__ == "__main__":
    main()
