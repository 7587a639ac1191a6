# SPDX-License-Identifier: MIT
"""Frames as another renderer would write them: uncompressed scanline EXR, 8-bit RGB PNG. Also EXR
as another program would read it, only from the file format's specification."""
import array
import itertools
import struct
import zlib


def exr_bytes(width, height, channels, attributes=(), pixel_aspect=1, corner=(0, 0), display=None,
              long_names=False):
    """channels: {name: width * height floats, row 0 on top}; attributes: additional (name, type,
    bytes); the data window is at `corner` in a display window of `display` pixels;
    long_names: names may have 255 bytes."""
    names = sorted(channels)
    chlist = b"".join(n.encode() + b"\0" + struct.pack("<iBxxxii", 2, 0, 1, 1)
                      for n in names) + b"\0"

    def attribute(name, kind, value):
        return name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<i", len(value)) + value

    left, top = corner
    window = struct.pack("<4i", left, top, left + width - 1, top + height - 1)
    whole = window if not display else struct.pack("<4i", 0, 0, display[0] - 1, display[1] - 1)
    header = struct.pack("<ii", 20000630, 2 | 0x400 * long_names) + b"".join((
        attribute("channels", "chlist", chlist),
        attribute("compression", "compression", b"\0"),
        attribute("dataWindow", "box2i", window),
        attribute("displayWindow", "box2i", whole),
        attribute("lineOrder", "lineOrder", b"\0"),
        attribute("pixelAspectRatio", "float", struct.pack("<f", pixel_aspect)),
        attribute("screenWindowCenter", "v2f", struct.pack("<ff", 0, 0)),
        attribute("screenWindowWidth", "float", struct.pack("<f", 1)),
        *(attribute(*further) for further in attributes))) + b"\0"
    row_bytes = 4 * width * len(names)
    first = len(header) + 8 * height
    offsets = struct.pack(f"<{height}Q", *(first + y * (row_bytes + 8) for y in range(height)))
    rows = []
    for y in range(height):
        rows.append(struct.pack("<ii", top + y, row_bytes))
        for name in names:
            rows.append(array.array("f", channels[name][y * width:(y + 1) * width]).tobytes())
    return header + offsets + b"".join(rows)


def multipart_exr_bytes(width, height, parts):
    """parts: {name: channels} of parts of one size, see exr_bytes()."""
    headers, chunks = [], []
    for channels in parts.values():
        chunk_bytes = 8 + 4 * width * len(channels)
        name = list(parts)[len(headers)].encode()
        data = exr_bytes(width, height, channels, [
            ("name", "string", name), ("type", "string", b"scanlineimage"),
            ("chunkCount", "int", struct.pack("<i", height))])
        first = len(data) - height * chunk_bytes
        chunks += [struct.pack("<i", len(headers)) + data[i:i + chunk_bytes]
                   for i in range(first, len(data), chunk_bytes)]
        headers.append(data[8:first - 8 * height])
    head = struct.pack("<ii", 20000630, 2 | 0x1000) + b"".join(headers) + b"\0"
    places = itertools.accumulate(map(len, chunks), initial=len(head) + 8 * len(chunks))
    return head + struct.pack(f"<{len(chunks)}Q", *list(places)[:-1]) + b"".join(chunks)


def _cut(data, at):
    """The text up to the next zero byte, and the position after it."""
    end = data.index(b"\0", at)
    return data[at:end].decode(), end + 1


def _unzip(packed, size):
    """Decodes a ZIP chunk: deflate, differences of neighbours, then all even bytes before all odd
    ones."""
    if len(packed) == size:
        return packed
    halves = bytes(itertools.accumulate(zlib.decompress(packed),
                                        lambda before, byte: (before + byte - 128) & 255))
    data = bytearray(size)
    data[0::2], data[1::2] = halves[:(size + 1) // 2], halves[(size + 1) // 2:]
    return bytes(data)


def read_exr(path):
    """(width, height, {channel: floats, row 0 on top}, {attribute: text}) of a scanline EXR of
    32-bit floats."""
    data, at, header = path.read_bytes(), 8, {}
    while data[at]:
        name, at = _cut(data, at)
        kind, at = _cut(data, at)
        size, = struct.unpack_from("<i", data, at)
        header[name] = (kind, data[at + 4:at + 4 + size])
        at += 4 + size
    names, chlist, place = [], header["channels"][1], 0
    while chlist[place]:
        name, place = _cut(chlist, place)
        if struct.unpack_from("<i", chlist, place)[0] != 2:
            raise ValueError(f"{path}: channel {name} is not of 32-bit floats")
        names.append(name)
        place += 16
    left, top, right, bottom = struct.unpack("<4i", header["dataWindow"][1])
    width, height, rows_per_chunk = (right - left + 1, bottom - top + 1,
                                     {0: 1, 3: 16}[header["compression"][1][0]])
    channels = {name: array.array("f", bytes(4 * width * height)) for name in names}
    for first in range(0, height, rows_per_chunk):
        offset, = struct.unpack_from("<Q", data, at + 1 + 8 * (first // rows_per_chunk))
        y, size = struct.unpack_from("<ii", data, offset)
        rows = min(rows_per_chunk, height - first)
        plain = _unzip(data[offset + 8:offset + 8 + size], 4 * width * rows * len(names))
        places = itertools.product(range(y - top, y - top + rows), names)
        for i, (row, name) in enumerate(places):
            channels[name][row * width:(row + 1) * width] = array.array(
                "f", plain[4 * width * i:4 * width * (i + 1)])
    texts = {name: value.decode() for name, (kind, value) in header.items() if kind == "string"}
    return width, height, channels, texts


def grey_exr(path, width, height, values, **further):
    """A frame with R, G and B equal to `values`; additional channels by name."""
    path.write_bytes(exr_bytes(width, height, {"R": values, "G": values, "B": values, **further}))


def png_bytes(width, height, rgb, before=(), behind=()):
    """rgb: width * height * 3 bytes; additional chunks (name, bytes) before and after the
    pixels."""
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I",
                                                                        zlib.crc32(kind + data))
    rows = b"".join(b"\0" + bytes(rgb[3 * width * y:3 * width * (y + 1)]) for y in range(height))
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR",
                                         struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)) +
            b"".join(chunk(*further) for further in before) + chunk(b"IDAT", zlib.compress(rows)) +
            b"".join(chunk(*further) for further in behind) + chunk(b"IEND", b""))


def apng_bytes(width, height, shots, bits=8, still=None):
    """shots: (x, y, width, height, RGBA codes, (delay, unit), dispose, blend) of each frame; still:
    codes of a default image that is none of them. See the PNG specification, third edition,
    11.3.6."""
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I",
                                                                        zlib.crc32(kind + data))

    def pixels(codes, row_codes):
        packed = array.array("B" if bits == 8 else "H", codes)
        if bits == 16:
            packed.byteswap()
        data, stride = packed.tobytes(), row_codes * bits // 8
        return zlib.compress(b"".join(b"\0" + data[y:y + stride]
                                      for y in range(0, len(data), stride)))
    made = b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, bits, 6, 0,
                                                              0, 0))
    made += chunk(b"acTL", struct.pack(">II", len(shots), 0))
    if still:
        made += chunk(b"IDAT", pixels(still, 4 * width))
    number = itertools.count()
    for at, (x, y, w, h, codes, delay, dispose, blend) in enumerate(shots):
        made += chunk(b"fcTL", struct.pack(">5I2H2B", next(number), w, h, x, y, *delay, dispose,
                                           blend))
        data = pixels(codes, 4 * w)
        made += (chunk(b"fdAT", struct.pack(">I", next(number)) + data) if at or still
                 else chunk(b"IDAT", data))
    return made + chunk(b"IEND", b"")


def png_rows(path):
    """Bytes of an 8-bit RGB PNG, row by row, for the filters that libpng may use."""
    data, at, packed = path.read_bytes(), 8, b""
    width, height = struct.unpack(">II", data[16:24])
    stride = 3 * width
    while at < len(data):
        size, kind = struct.unpack(">I4s", data[at:at + 8])
        if kind == b"IDAT":
            packed += data[at + 8:at + 8 + size]
        at += 12 + size
    raw, rows = zlib.decompress(packed), []
    above = bytes(stride)
    for y in range(height):
        filter_kind, line = raw[y * (stride + 1)], raw[y * (stride + 1) + 1:(y + 1) * (stride + 1)]
        row = bytearray(stride)
        for i, value in enumerate(line):
            left, up = row[i - 3] if i > 2 else 0, above[i]
            corner = above[i - 3] if i > 2 else 0
            guess = left + up - corner
            nearest = min((abs(guess - left), 0, left), (abs(guess - up), 1, up),
                          (abs(guess - corner), 2, corner))[2]
            row[i] = (value + (0, left, up, (left + up) // 2, nearest)[filter_kind]) & 255
        rows.append(bytes(row))
        above = row
    return rows
