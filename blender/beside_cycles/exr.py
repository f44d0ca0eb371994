# SPDX-License-Identifier: Apache-2.0 OR GPL-3.0-or-later
"""OpenEXR files of scan lines, uncompressed or by zlib, halves or floats: what Blender's Python lacks. openexr.com, file layout."""
import struct
import zlib

import numpy as np

SIZES = {1: ("<f2", 2), 2: ("<f4", 4)}
ROWS = {0: 1, 2: 1, 3: 16}  # of a chunk, by compression: none, ZIPS, ZIP


def header_of(data):
    """({attribute: (type, bytes)}, where the offset table begins)."""
    if data[:4] != b"\x76\x2f\x31\x01":
        raise ValueError("no OpenEXR file")
    attributes, at = {}, 8
    while data[at]:
        name, kind = data[at:at + 512].split(b"\0", 2)[:2]
        at += len(name) + len(kind) + 2
        size, = struct.unpack_from("<i", data, at)
        attributes[name.decode()] = kind.decode(), data[at + 4:at + 4 + size]
        at += 4 + size
    return attributes, at + 1


def channels_of(attribute):
    """(name, type) in the order of the file."""
    found, at = [], 0
    while attribute[at]:
        end = attribute.index(b"\0", at)
        found.append((attribute[at:end].decode(), struct.unpack_from("<i", attribute, end + 1)[0]))
        at = end + 17
    return found


def inflated(data, size):
    """What OpenEXR's ZIP holds: differences of bytes, odd ones behind even ones."""
    if len(data) == size:
        return data
    deltas = np.frombuffer(zlib.decompress(data), np.uint8).astype(np.int64)
    deltas[1:] -= 128
    parts = (np.cumsum(deltas) & 255).astype(np.uint8)
    whole = np.empty(size, np.uint8)
    whole[0::2], whole[1::2] = parts[:(size + 1) // 2], parts[(size + 1) // 2:]
    return whole.tobytes()


def read(path):
    """{channel: (rows, columns)} of a file."""
    with open(path, "rb") as file:
        data = file.read()
    attributes, at = header_of(data)
    left, top, right, bottom = struct.unpack("<4i", attributes["dataWindow"][1])
    rows, columns, compression = bottom - top + 1, right - left + 1, attributes["compression"][1][0]
    if compression not in ROWS:
        raise ValueError(f"{path}: compression {compression} is not read")
    channels = channels_of(attributes["channels"][1])
    picture = {name: np.empty((rows, columns), np.float32) for name, _ in channels}
    together = ROWS[compression]
    for offset in struct.unpack_from(f"<{-(-rows // together)}Q", data, at):
        row, size = struct.unpack_from("<2i", data, offset)
        count = min(together, bottom + 1 - row)
        line = inflated(data[offset + 8:offset + 8 + size], count * columns * sum(SIZES[kind][1] for _, kind in channels))
        place = 0
        for y in range(row - top, row - top + count):
            for name, kind in channels:
                dtype, wide = SIZES[kind]
                picture[name][y] = np.frombuffer(line, dtype, columns, place)
                place += columns * wide
    return picture


def rgb(picture):
    """Channels of (rows, columns, 3)."""
    return {c: picture[..., k] for k, c in enumerate("RGB")}


def write(path, channels):
    """{channel: (rows, columns)} as floats, uncompressed."""
    names = sorted(channels)  # as the format wants them
    planes = np.stack([channels[name] for name in names]).astype("<f4")
    _, rows, columns = planes.shape
    box = struct.pack("<4i", 0, 0, columns - 1, rows - 1)
    attributes = [("channels", "chlist", b"".join(c.encode() + b"\0" + struct.pack("<i4x2i", 2, 1, 1) for c in names) + b"\0"), ("compression", "compression", b"\0"),
                  ("dataWindow", "box2i", box), ("displayWindow", "box2i", box), ("lineOrder", "lineOrder", b"\0"), ("pixelAspectRatio", "float", struct.pack("<f", 1)),
                  ("screenWindowCenter", "v2f", struct.pack("<2f", 0, 0)), ("screenWindowWidth", "float", struct.pack("<f", 1))]
    head = b"\x76\x2f\x31\x01\x02\0\0\0" + b"".join(n.encode() + b"\0" + k.encode() + b"\0" + struct.pack("<i", len(v)) + v for n, k, v in attributes) + b"\0"
    size = 4 * len(names) * columns
    with open(path, "wb") as file:
        file.write(head + struct.pack(f"<{rows}Q", *(len(head) + 8 * rows + (8 + size) * y for y in range(rows))))
        for y in range(rows):
            file.write(struct.pack("<2i", y, size) + planes[:, y].tobytes())
