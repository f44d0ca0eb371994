# SPDX-FileCopyrightText: The render2mpeg authors
# SPDX-License-Identifier: Apache-2.0 OR GPL-3.0-or-later
"""Takes the colours out of the program's OpenEXR files: Blender before 4 reads those of one layer alone, later ones none without names.

[OpenEXR] Technical Introduction and File Layout: scan lines, uncompressed or ZIP (16 lines a block) or ZIPS (one).
"""
import os
import struct
import zlib

import numpy as np

LINES = {0: 1, 2: 1, 3: 16}
TYPES = {0: np.dtype("<u4"), 1: np.dtype("<f2"), 2: np.dtype("<f4")}


class Damaged(Exception):
    """What is wrong with a file."""


def text_at(data, at):
    end = data.index(b"\0", at)
    return data[at:end].decode("latin-1"), end + 1


def header_of(data):
    """Attributes as bytes by name, and where the table of blocks begins."""
    if data[:4] != b"\x76\x2f\x31\x01" or data[5] & 0x12:
        raise Damaged("no OpenEXR file of scan lines in one part")
    attributes, at = {}, 8
    while data[at] != 0:
        name, at = text_at(data, at)
        _, at = text_at(data, at)
        size = struct.unpack_from("<i", data, at)[0]
        attributes[name] = data[at + 4:at + 4 + size]
        at += 4 + size
    return attributes, at + 1


def channels_of(attribute):
    """Names and types, in the order of their values along a line."""
    found, at = [], 0
    while attribute[at] != 0:
        name, at = text_at(attribute, at)
        found.append((name, TYPES[struct.unpack_from("<i", attribute, at)[0]]))
        at += 16
    return found


def unpacked(block, size):
    """Undoes ZIP: bytes of even and odd places apart, each as a difference from the one before."""
    if len(block) == size:
        return np.frombuffer(block, np.uint8)
    coded = np.frombuffer(zlib.decompress(block), np.uint8)
    if coded.size != size:
        raise Damaged("a block of another size")
    coded = np.cumsum(coded, dtype=np.uint8)
    coded[1::2] ^= 128  # each difference has 128 added, which goes at every other place
    out = np.empty(size, np.uint8)
    out[0::2], out[1::2] = coded[:(size + 1) // 2], coded[(size + 1) // 2:]
    return out


def packed(raw):
    """As ZIP has it; as it is where that is no larger."""
    size = raw.size
    apart = np.concatenate([raw[0::2], raw[1::2]])
    coded = apart.copy()
    coded[1:] = apart[1:] - apart[:-1] + np.uint8(128)
    block = zlib.compress(coded.tobytes(), 1)
    return block if len(block) < size else raw.tobytes()


def blocks_of(data):
    """Each block's first line, counted from 0, and its lines of A, B, G, R; first the width and height."""
    attributes, table = header_of(data)
    left, top, right, low = struct.unpack("<4i", attributes["dataWindow"])
    width, height, lines = right - left + 1, low - top + 1, LINES[attributes["compression"][0]]
    yield width, height
    places, length = {}, 0
    for name, kind in channels_of(attributes["channels"]):
        places[name] = (length, kind)
        length += width * kind.itemsize
    for begin in struct.unpack_from(f"<{-(-height // lines)}Q", data, table):
        y, size = struct.unpack_from("<ii", data, begin)
        count = min(lines, low + 1 - y)
        rows = unpacked(data[begin + 8:begin + 8 + size], count * length).reshape(count, length)
        out = np.ones((count, 4, width), np.float32)
        for number, name in enumerate("ABGR"):
            if name in places:
                at, kind = places[name]
                out[:, number] = np.ascontiguousarray(rows[:, at:at + width * kind.itemsize]).view(kind)
        yield y - top, out


def header(width, height):
    """Of a file of A, B, G, R as halves, ZIP."""
    def attribute(name, kind, value):
        return name + b"\0" + kind + b"\0" + struct.pack("<i", len(value)) + value

    channels = b"".join(name + b"\0" + struct.pack("<iiii", 1, 0, 1, 1) for name in (b"A", b"B", b"G", b"R")) + b"\0"
    window = struct.pack("<4i", 0, 0, width - 1, height - 1)
    return (b"\x76\x2f\x31\x01" + struct.pack("<i", 2) + attribute(b"channels", b"chlist", channels)
            + attribute(b"compression", b"compression", b"\3") + attribute(b"dataWindow", b"box2i", window)
            + attribute(b"displayWindow", b"box2i", window) + attribute(b"lineOrder", b"lineOrder", b"\0")
            + attribute(b"pixelAspectRatio", b"float", struct.pack("<f", 1))
            + attribute(b"screenWindowCenter", b"v2f", struct.pack("<2f", 0, 0))
            + attribute(b"screenWindowWidth", b"float", struct.pack("<f", 1)) + b"\0")


def read_colours(path):
    """Lines from the top, each of A, B, G, R; opaque where there is no alpha."""
    with open(path, "rb") as file:
        data = file.read()
    try:
        blocks = blocks_of(data)
        width, height = next(blocks)
        picture = np.ones((height, 4, width), np.float32)
        for y, rows in blocks:
            picture[y:y + len(rows)] = rows
    except (IndexError, KeyError, ValueError, struct.error, zlib.error) as error:
        raise Damaged(f"{path}: damaged ({error})") from None
    return picture


def take_colours(source, target):
    """Writes the colours of a file as a file of their own."""
    picture = read_colours(source).astype(TYPES[1])
    height, _, width = picture.shape
    coded = [struct.pack("<2i", y, len(block)) + block for y, block in
             ((y, packed(picture[y:y + 16].reshape(-1).view(np.uint8))) for y in range(0, height, 16))]
    begin, places = header(width, height), []
    at = len(begin) + 8 * len(coded)
    for block in coded:
        places.append(at)
        at += len(block)
    with open(target + ".new", "wb") as file:
        file.write(begin + struct.pack(f"<{len(places)}Q", *places) + b"".join(coded))
    os.replace(target + ".new", target)
