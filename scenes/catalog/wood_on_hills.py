#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Writes the meshes of wood_on_hills.yaml here: hills as a 16-bit height field, and a fir."""
import math
import pathlib
import struct
import zlib

FOLDER = pathlib.Path(__file__).parent
SIDE, SIZE_M = 65, 320.0


def height(x, z):
    """In metres, 0 to 24."""
    wide = math.sin(x / 31) * math.cos(z / 43)
    return 12 + 7 * wide + 5 * math.sin(x / 17 + 1) * math.sin(z / 13)


def chunk(kind, data):
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def write_hills():
    at = [(i / (SIDE - 1) - 0.5) * SIZE_M for i in range(SIDE)]
    codes = [[round(65535 * height(x, z) / 24) for x in at] for z in at]
    rows = b"".join(b"\0" + struct.pack(f">{SIDE}H", *row) for row in codes)
    head = struct.pack(">IIBBBBB", SIDE, SIDE, 16, 0, 0, 0, 0)
    (FOLDER / "wood_hills.png").write_bytes(
        b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(rows, 9)) +
        chunk(b"IEND", b""))


def write_fir():
    """A trunk and three cones of eight sides each, closed."""
    lines, count = ["# SPDX-License-Identifier: MIT", "# Made by wood_on_hills.py."], 0
    for low, high, wide, top in ((-1, 2, 0.3, 0.25), (1.5, 5, 2.2, 0), (3.5, 7, 1.7, 0),
                                 (5.5, 9, 1.1, 0)):
        for y, radius in ((low, wide), (high, max(top, 0.02))):
            for k in range(8):
                angle = math.pi * k / 4
                x, z = radius * math.cos(angle), radius * math.sin(angle)
                lines.append(f"v {x:.4f} {y:g} {z:.4f}")
        lines.append("f " + " ".join(str(count + 1 + k) for k in range(8)))
        lines.append("f " + " ".join(str(count + 9 + k) for k in reversed(range(8))))
        for k in range(8):
            a, b = count + 1 + k, count + 1 + (k + 1) % 8
            lines.append(f"f {a} {a + 8} {b + 8} {b}")
        count += 16
    (FOLDER / "wood_fir.obj").write_text("\n".join(lines) + "\n")


write_hills()
write_fir()
