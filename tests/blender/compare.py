# SPDX-License-Identifier: Apache-2.0 OR GPL-3.0-or-later
"""blender -b --factory-startup -noaudio --python-exit-code 1 -P compare.py -- FOLDER FRAME... [--picture OUT.png] [--shown] [--alpha]
    [--patches COLUMNSxROWS]

Also behind cycles.py in one Blender, whose words it leaves alone. Holds FOLDER/oursNNNN.exr against cyclesNNNN.exr. A row per frame: mean luminance of ours over Cycles', PSNR (sRGB pictures
of 8 bits, exposed so that Cycles' median is 0.25), and by how many pixels ours is shifted to the right and up: what turns ours
into Cycles' by least squares over the gradients [Lucas1981]. With --shown oursNNNN.png against cyclesNNNN.png, as they are: the row
begins with the mean code values' ratio. With --patches a row for each part of the picture, row by row: mean of ours over Cycles'
by channel. With --alpha another row: mean alpha of both, and their mean difference. The picture: ours, Cycles, their difference times four.
"""
import os
import sys

import bpy
import numpy as np

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "blender"))
from film_export import png  # noqa: E402

WEIGHTS = np.array([0.2126, 0.7152, 0.0722])


def load(path):
    image = bpy.data.images.load(path)
    image.colorspace_settings.name = "Non-Color"
    pixels = np.empty(image.size[0] * image.size[1] * image.channels, dtype=np.float32)
    image.pixels.foreach_get(pixels)
    return pixels.reshape(image.size[1], image.size[0], image.channels).astype(float)


def shift(ours, truth):
    """By least squares, on what the eye sees: a lamp is no brighter than white."""
    a, b = ours @ WEIGHTS, truth @ WEIGHTS
    up, right = np.gradient(a)
    inner = np.s_[2:-2, 2:-2]
    matrix = np.stack([right[inner].ravel(), up[inner].ravel()], axis=1)
    # ours(x) = truth(x + d) has truth - ours = -d . gradient.
    answer, *_ = np.linalg.lstsq(matrix, (b - a)[inner].ravel(), rcond=None)
    return -answer


def main():
    words = sys.argv[sys.argv.index("--") + 1:]
    out = words[words.index("--picture") + 1] if "--picture" in words else None
    ending = "png" if "--shown" in words else "exr"
    patches = words[words.index("--patches") + 1] if "--patches" in words else None
    folder, *frames = (word for i, word in enumerate(words)
                       if not word.startswith("--") and words[i - 1] not in {"--picture", "--patches", "--samples"})
    rows = []
    for frame in frames:
        ours, truth = (load(os.path.join(folder, f"{who}{int(frame):04d}.{ending}")) for who in ("ours", "cycles"))
        if "--alpha" in words:
            print(f"ALPHA {np.mean(ours[..., 3]):.4f} {np.mean(truth[..., 3]):.4f} {np.mean(np.abs(ours[..., 3] - truth[..., 3])):.4f}")
        ours, truth = ours[..., :3], truth[..., :3]
        if patches:
            columns, rows_of_them = map(int, patches.split("x"))
            for k in range(columns * rows_of_them):
                high, wide = ours.shape[0] // rows_of_them, ours.shape[1] // columns
                top, left = (rows_of_them - 1 - k // columns) * high, k % columns * wide
                means = [p[top:top + high, left:left + wide].mean(axis=(0, 1)) for p in (ours, truth)]
                print("PATCH", k, *(f"{a / max(b, 1e-9):.4f}" for a, b in zip(*means)))
        light = truth @ WEIGHTS
        exposure = 0.25 / max(float(np.median(light)), 1e-6)
        shown = [p if ending == "png" else png.srgb(p * exposure) for p in (ours, truth)]
        error = np.mean((shown[0] - shown[1]) ** 2)
        right, up = shift(*shown)
        print(f"ROW {frame} {np.mean(ours @ WEIGHTS) / np.mean(light):.4f} {-10 * np.log10(max(error, 1e-9)):.2f} {right:.3f} {up:.3f}")
        gap = np.ones((ours.shape[0], 4, 3))
        rows.append(np.concatenate([shown[0], gap, shown[1], gap, np.clip(0.5 + 4 * (shown[0] - shown[1]), 0, 1)], axis=1))
    if out:
        picture = np.concatenate(rows[::-1], axis=0)
        png.write(out, np.repeat(np.repeat(picture, 3, axis=0), 3, axis=1))


main()
