"""blender -b -noaudio --factory-startup --python-exit-code 1 -P sheet.py -- FOLDER OUT.png NAME...

Holds FOLDER/NAME_ours.exr against NAME_three.png and NAME_cycles.exr, as far as they are there. Prints a row of a table for
each: mean of ours over that of three.js, PSNR; the same beside Cycles. All are of 8-bit sRGB pictures, on the ball alone.
Draws the balls: a row each of ours, three.js and Cycles, for every seven names.
"""
import json
import math
import os
import struct
import sys
import zlib

import bpy

GAP = 2


def load(path):
    """Rows from the top of 8-bit sRGB pixels; none where there is no such file."""
    if not os.path.exists(path):
        return None
    image = bpy.data.images.load(path)
    image.colorspace_settings.name = "Non-Color"
    width, flat = image.size[0], image.pixels[:]

    def code(v):
        v = min(max(v, 0.0), 1.0)
        if path.endswith(".exr"):
            v = 12.92 * v if v <= 0.0031308 else 1.055 * v ** (1 / 2.4) - 0.055
        return 255 * v
    pixels = [[code(c) for c in flat[i:i + 3]] for i in range(0, len(flat), 4)]
    return [pixels[y * width:(y + 1) * width] for y in reversed(range(image.size[1]))]


def beside(ours, other):
    if other is None:
        return "- | -"
    size, pairs = len(ours), []
    radius = 1 / math.sqrt(24) / math.tan(0.25) * 0.97 * size / 2  # of the ball's outline, seen from 5 radii
    for y in range(size):
        for x in range(size):
            if math.hypot(x + 0.5 - size / 2, y + 0.5 - size / 2) < radius:
                pairs += zip(ours[y][x], other[y][x])
    error = sum((a - b) ** 2 for a, b in pairs) / len(pairs)
    return f"{sum(a for a, _ in pairs) / sum(b for _, b in pairs):.3f} | {10 * math.log10(255 ** 2 / max(error, 1e-3)):.1f}"


def write_png(path, rows):
    raw = b"".join(b"\0" + bytes(int(v + 0.5) for p in row for v in p) for row in rows)

    def chunk(name, data):
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))
    with open(path, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", len(rows[0]), len(rows), 8, 2, 0, 0, 0)) +
                   chunk(b"sRGB", b"\0") + chunk(b"IDAT", zlib.compress(raw)) + chunk(b"IEND", b""))


def main():
    folder, out, *names = sys.argv[sys.argv.index("--") + 1:]
    size, sheet = 0, []
    for first in range(0, len(names), 7):
        columns = []
        for name in names[first:first + 7]:
            path = os.path.join(folder, name)
            ours, three, cycles = load(path + "_ours.exr"), load(path + "_three.png"), load(path + "_cycles.exr")
            size = len(ours)
            print(f"ROW | `{name}` | {beside(ours, three)} | {beside(ours, cycles)} |")
            columns.append([ours, three, cycles])
        blank = [[(255, 255, 255)] * size] * size
        for kind in range(3):
            for y in range(size):
                sheet.append([p for c in columns for p in (c[kind] or blank)[y] + [(255, 255, 255)] * GAP])
            sheet += [[(255, 255, 255)] * len(sheet[-1])] * (GAP if kind < 2 else 4 * GAP)
    width = max(len(row) for row in sheet)
    write_png(out, [list(row) + [(255, 255, 255)] * (width - len(row)) for row in sheet])


main()
