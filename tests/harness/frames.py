# SPDX-License-Identifier: MIT
"""Frames as another renderer would write them: uncompressed scanline EXR, 8-bit RGB PNG."""
import array
import struct
import zlib


def exr_bytes(width, height, channels):
    """channels: {name: width * height floats, row 0 on top}."""
    names = sorted(channels)
    chlist = b"".join(n.encode() + b"\0" + struct.pack("<iBxxxii", 2, 0, 1, 1) for n in names) + b"\0"

    def attribute(name, kind, value):
        return name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<i", len(value)) + value

    window = struct.pack("<4i", 0, 0, width - 1, height - 1)
    header = struct.pack("<ii", 20000630, 2) + b"".join((
        attribute("channels", "chlist", chlist),
        attribute("compression", "compression", b"\0"),
        attribute("dataWindow", "box2i", window),
        attribute("displayWindow", "box2i", window),
        attribute("lineOrder", "lineOrder", b"\0"),
        attribute("pixelAspectRatio", "float", struct.pack("<f", 1)),
        attribute("screenWindowCenter", "v2f", struct.pack("<ff", 0, 0)),
        attribute("screenWindowWidth", "float", struct.pack("<f", 1)))) + b"\0"
    row_bytes = 4 * width * len(names)
    first = len(header) + 8 * height
    offsets = struct.pack(f"<{height}Q", *(first + y * (row_bytes + 8) for y in range(height)))
    rows = []
    for y in range(height):
        rows.append(struct.pack("<ii", y, row_bytes))
        for name in names:
            rows.append(array.array("f", channels[name][y * width:(y + 1) * width]).tobytes())
    return header + offsets + b"".join(rows)


def grey_exr(path, width, height, values, **further):
    """A frame whose R, G and B are `values`; further channels by name."""
    path.write_bytes(exr_bytes(width, height, {"R": values, "G": values, "B": values, **further}))


def png_bytes(width, height, rgb):
    """rgb: width * height * 3 bytes."""
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    rows = b"".join(b"\0" + bytes(rgb[3 * width * y:3 * width * (y + 1)]) for y in range(height))
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)) +
            chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))
