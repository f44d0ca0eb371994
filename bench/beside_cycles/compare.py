"""blender -b -noaudio --factory-startup --python-exit-code 1 -P compare.py -- FOLDER OUT.png

Holds FOLDER/ours.exr against the mean of cycles0.exr and cycles1.exr. Prints a row of a table and writes ours, Cycles and
their difference (grey: none; eight times enlarged) side by side. Blender reads the images, since it is there anyway.

Columns: name; mean of ours over mean of Cycles; the same in the darker half (pixels below the median); PSNR; PSNR without
Cycles' noise; noise; CPU seconds of ours and of Cycles. Means are of luminance. PSNR is of sRGB pictures of 8 bits range,
over the pixels that are not black, with the exposure that shows Cycles' median of them as 0.25. Cycles' two halves a, b have
independent noise, so (ours - a)(ours - b) is on average the square of the error against Cycles' limit: "without noise".
"noise" is the PSNR of Cycles' mean against that limit.
"""
import json
import math
import os
import statistics
import struct
import sys
import zlib

import bpy


def load(path):
    """Rows from the bottom up, [r, g, b] each."""
    image = bpy.data.images.load(path)
    image.colorspace_settings.name = "Non-Color"
    flat = image.pixels[:]
    return image.size[0], [flat[i:i + 3] for i in range(0, len(flat), 4)]


def luminance(p):
    return 0.2126 * p[0] + 0.7152 * p[1] + 0.0722 * p[2]


def develop(pixels, exposure):
    def curve(x):
        x = min(max(x * exposure, 0.0), 1.0)
        return 12.92 * x if x <= 0.0031308 else 1.055 * x ** (1 / 2.4) - 0.055
    return [[255 * curve(c) for c in p] for p in pixels]


def psnr(a, b, c, keep):
    """Of the mean of (a - b)(a - c); at most 60."""
    error = sum((x - y) * (x - z) for p, q, r, k in zip(a, b, c, keep) if k for x, y, z in zip(p, q, r)) / (3 * max(1, sum(keep)))
    return 10 * math.log10(255**2 / max(error, 255**2 / 1e6))


def write_png(path, width, rows):
    raw = b"".join(b"\0" + bytes(v for p in row for v in p) for row in rows)

    def chunk(name, data):
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))
    with open(path, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, len(rows), 8, 2, 0, 0, 0)) +
                   chunk(b"sRGB", b"\0") + chunk(b"IDAT", zlib.compress(raw)) + chunk(b"IEND", b""))


def side_by_side(path, width, pictures, zoom=3):
    rows = []
    for y in reversed(range(len(pictures[0]) // width)):
        row = []
        for picture in pictures:
            for p in picture[y * width:(y + 1) * width]:
                row += [[int(min(255, max(0, v + 0.5))) for v in p]] * zoom
            row += [[255, 255, 255]] * 4
        rows += [row] * zoom
    write_png(path, len(rows[0]), rows)


def main():
    folder, out = sys.argv[sys.argv.index("--") + 1:]
    name = os.path.basename(folder)
    width, ours = load(os.path.join(folder, "ours.exr"))
    first, second = (load(os.path.join(folder, f"cycles{i}.exr"))[1] for i in (0, 1))
    cycles = [[(a + b) / 2 for a, b in zip(p, q)] for p, q in zip(first, second)]
    light, truth = [luminance(p) for p in ours], [luminance(p) for p in cycles]
    side = json.load(open(os.path.join(folder, "side.json")))
    if "closed_form" in side:
        print(f"ROW | {name} | {sum(light) / len(light) / side['closed_form']:.4f} | "
              f"{sum(truth) / len(truth) / side['closed_form']:.4f} |")
        return
    lit = [t > 0 for t in truth]
    exposure = 0.25 / statistics.median([t for t, k in zip(truth, lit) if k])
    # Chosen by one half of the samples and measured by the other, so that noise does not choose.
    chosen, measured = [luminance(p) for p in first], [luminance(p) for p in second]
    dark = [c < statistics.median(chosen) for c in chosen]
    shown = [develop(p, exposure) for p in (ours, cycles, first, second)]
    seconds = [open(os.path.join(folder, f)).read().strip() for f in ("ours_seconds", "cycles_seconds")]
    print(f"ROW | {name} | {sum(light) / sum(truth):.4f} | "
          f"{sum(v for v, k in zip(light, dark) if k) / sum(v for v, k in zip(measured, dark) if k):.4f} | "
          f"{psnr(shown[0], shown[1], shown[1], lit):.1f} | {psnr(shown[0], shown[2], shown[3], lit):.1f} | "
          f"{psnr(shown[2], shown[3], shown[3], lit) + 20 * math.log10(2):.1f} | "
          f"{seconds[0]} | {seconds[1]} |")
    difference = [[128 + 8 * (a - b) for a, b in zip(p, q)] for p, q in zip(shown[0], shown[1])]
    side_by_side(out, width, [shown[0], shown[1], difference])


main()
