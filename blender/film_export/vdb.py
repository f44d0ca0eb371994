# SPDX-License-Identifier: Apache-2.0 OR GPL-3.0-or-later
"""Writes a grid of floats as an OpenVDB file (version 224, not compressed), which Blender's own Python cannot before 4.4.

[Museth2013] has the tree: leaves of 8^3 voxels in nodes of 16^3 leaves in nodes of 32^3 of those, z fastest in each.
"""
import struct
import uuid

import numpy as np

MAGIC, VERSION, LIBRARY = 0x56444220, 224, (10, 0)
ALL_VALUES = b"\x06"  # no value is left out by a mask


def text(words):
    data = words.encode()
    return struct.pack("<I", len(data)) + data


def mask(bits):
    return np.packbits(np.asarray(bits, dtype=bool), bitorder="little").tobytes()


def metadata(values):
    out = struct.pack("<I", len(values))
    for name, kind, value in values:
        out += text(name) + text(kind) + struct.pack("<I", len(value)) + value
    return out


def inner(children, side):
    """The head of a node with `side`^3 places, of which those of `children` hold nodes, and no place a value."""
    bits = np.zeros(side ** 3, dtype=bool)
    bits[children] = True
    return mask(bits) + mask(np.zeros(side ** 3)) + ALL_VALUES + bytes(4 * side ** 3)


def leaves_of(values):
    """(x, y, z) in leaves -> its 512 voxels, x slowest, of those that are not 0. `values` is by z, y, x."""
    padded = np.pad(values.astype("<f4"), [(0, -n % 8) for n in values.shape])
    z, y, x = (n // 8 for n in padded.shape)
    blocks = padded.reshape(z, 8, y, 8, x, 8).transpose(4, 2, 0, 5, 3, 1).reshape(x, y, z, 512)
    return {tuple(place): blocks[tuple(place)] for place in np.argwhere(blocks.any(axis=3)).tolist()}


def write(path, name, values, low, sides):
    """`values`: by z, y, x, of a grid of boxes of these sides, of which the first has its low corner at `low`. 0 is not stored."""
    leaves = leaves_of(values)
    filled = np.argwhere(values > 0)[:, ::-1]
    ends = (filled.min(axis=0), filled.max(axis=0)) if len(filled) else ((0, 0, 0), (-1, -1, -1))
    matrix = np.diag(np.append(sides, 1.0))
    matrix[3, :3] = np.asarray(low, dtype=float) + np.asarray(sides) / 2

    nodes = {}  # place of a node of leaves -> places of its leaves
    for place in leaves:
        nodes.setdefault(tuple(n // 16 for n in place), []).append(place)
    tops = {}
    for place in nodes:
        tops.setdefault(tuple(n // 32 for n in place), []).append(place)

    def number(place, count):
        x, y, z = (n % count for n in place)
        return (x * count + y) * count + z
    topology, order = [struct.pack("<IfII", 1, 0.0, 0, len(tops))], []
    for top in sorted(tops):
        children = sorted(tops[top], key=lambda p: number(p, 32))
        topology += [struct.pack("<3i", *(4096 * n for n in top)), inner([number(p, 32) for p in children], 32)]
        for child in children:
            below = sorted(nodes[child], key=lambda p: number(p, 16))
            topology += [inner([number(p, 16) for p in below], 16)] + [mask(leaves[p] > 0) for p in below]
            order += below
    buffers = b"".join(mask(leaves[p] > 0) + ALL_VALUES + leaves[p].tobytes() for p in order)

    head = struct.pack("<qIIIb", MAGIC, VERSION, *LIBRARY, 1) + str(uuid.uuid5(uuid.NAMESPACE_URL, name)).encode()
    head += metadata([]) + struct.pack("<I", 1) + text(name) + text("Tree_float_5_4_3") + text("")
    begin = len(head) + 24
    body = struct.pack("<I", 0) + metadata([("class", "string", b"fog volume")] +
                                           [(f"file_bbox_{end}", "vec3i", struct.pack("<3i", *map(int, at))) for end, at in zip(("min", "max"), ends)])
    body += text("AffineMap") + matrix.astype("<f8").tobytes() + b"".join(topology)
    with open(path, "wb") as file:
        file.write(head + struct.pack("<3q", begin, begin + len(body), begin + len(body) + len(buffers)) + body + buffers)
