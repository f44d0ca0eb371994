# SPDX-License-Identifier: Apache-2.0 OR GPL-3.0-or-later
"""Libraries that a .blend links, by its blocks: Blender opens them while it reads the file, before any script could stop it."""
import gzip
import os
import re
import struct

from .files import kind_of

PATHS = re.compile(rb"(?<=\0)/[^\0]{1,1023}(?=\0)")


def opened(path):
    """A .blend's bytes; None of a compression that this Python lacks, and of other files."""
    file = open(path, "rb")
    first = file.read(4)
    file.seek(0)
    if first == b"BLEN":
        return file
    if first[:2] == b"\x1f\x8b":
        return gzip.GzipFile(fileobj=file)
    if first == b"\x28\xb5\x2f\xfd":
        try:
            import zstandard
        except ImportError:
            return None
        return zstandard.ZstdDecompressor().stream_reader(file, read_across_frames=True)
    return None


def skip(file, count):
    while count > 0 and (block := file.read(min(count, 1 << 20))):
        count -= len(block)


def blocks(file, code):
    """Data of all blocks with this code."""
    head = file.read(12)
    if not head.startswith(b"BLENDER"):
        return
    if head[7:8].isdigit():  # since 5.0: the header's own size, then large blocks
        file.read(int(head[7:9]) - 12)
        order, shape, length = "<", "4siQqq", 3
    else:
        order = ">" if head[8:9] == b"V" else "<"
        shape, length = ("4siIii" if head[7:8] == b"_" else "4siQii"), 1
    size = struct.calcsize(order + shape)
    while len(block := file.read(size)) == size:
        said = struct.unpack(order + shape, block)
        if said[0] == b"ENDB" or said[length] < 0:
            return
        if said[0] == code:
            yield file.read(min(said[length], 1 << 16))
            skip(file, said[length] - (1 << 16))
        else:
            skip(file, said[length])


def unreadable(path, seen=None):
    """(path, kind) of the first library, or library of one, that is no plain file; None without one."""
    seen = set() if seen is None else seen
    seen.add(os.path.realpath(path))
    try:
        file = opened(path)
        named = [found.decode(errors="surrogateescape") for block in blocks(file, b"LI\0\0") for found in PATHS.findall(block)] if file else []
    except (OSError, EOFError, struct.error, ValueError):
        return None  # Blender will say what is wrong with it
    for name in named:
        library = os.path.join(os.path.dirname(path), name[2:]) if name.startswith("//") else name
        if kind := kind_of(library):
            return library, kind
        if os.path.isfile(library) and os.path.realpath(library) not in seen:
            if bad := unreadable(library, seen):
                return bad
    return None
