# SPDX-License-Identifier: Apache-2.0 OR GPL-3.0-or-later
"""Errors of decoded films against halves of a truth, and their change along motion.

Errors against two halves of the truth's samples are multiplied, so that its noise drops out. Pictures are luma in code values of 8
bits, (frames, rows, columns)."""
import subprocess

import numpy as np

from denoise import box
from installed import mean_and_low


def luma(film, width, height, bits):
    raw = subprocess.run(["ffmpeg", "-v", "error", "-i", str(film), "-vf", "extractplanes=y", "-f", "rawvideo", "-"], stdout=subprocess.PIPE, check=True).stdout
    return np.frombuffer(raw, np.uint8 if bits == 8 else "<u2").reshape(-1, height, width) / 2.0**(bits - 8)


def motion_of(layers, frames, width, height):
    """(where each pixel's point was in the frame before, whether that is known) of each frame but the first; rows, columns."""
    for n in list(frames)[1:]:
        data = (layers / f"frame_{n:04d}.motion").read_bytes()
        version, _, _, fields = np.frombuffer(data, "<u4", 4, 4)
        values = np.frombuffer(data, "<i2" if version == 2 else "<f4", width * height * 2, 32).reshape(height, width, 2)
        kind = np.frombuffer(data, np.uint8, width * height, 32 + values.nbytes * int(fields)).reshape(height, width)
        step = 32 if version == 2 else 1
        row, column = np.mgrid[:height, :width]
        at = np.rint(row + values[..., 1] / step).astype(int), np.rint(column + values[..., 0] / step).astype(int)
        known = (kind == 1) & (values[..., 0] != -32768) & (at[0] >= 0) & (at[0] < height) & (at[1] >= 0) & (at[1] < width)
        yield np.where(known, at[0], 0), np.where(known, at[1], 0), known


def flicker(pictures, halves, motion):
    """(sum of squares, pixels): what of the error changes from a frame to the next at points that both show."""
    squares, count = 0.0, 0
    for n, (row, column, known) in enumerate(motion, 1):
        a, b = (((pictures[n] - h[n]) - (pictures[n - 1] - h[n - 1])[row, column])[known] for h in halves)
        squares, count = squares + np.sum(a * b), count + a.size
    return float(squares), count


def ssim(a, b):
    """Mean over 8x8 windows (Wang et al. 2004)."""
    a, b = np.moveaxis(a, 0, -1), np.moveaxis(b, 0, -1)
    mean = [box(v, 4) for v in (a, b)]
    square = [box(v * v, 4) - m * m for v, m in zip((a, b), mean)]
    both = box(a * b, 4) - mean[0] * mean[1]
    return float(np.mean((2 * mean[0] * mean[1] + 6.5025) * (2 * both + 58.5225) / ((mean[0]**2 + mean[1]**2 + 6.5025) * (square[0] + square[1] + 58.5225))))


def weights_of_rows(height, panorama):
    """Weight of a pixel of each row, 1 in the mean: in panoramas, of which so much is left off at each side, its solid angle."""
    if not panorama:
        return np.ones(height)
    _, top, _, bottom = panorama
    weights = np.sin(np.pi * (top + (1 - top - bottom) * (np.arange(height) + .5) / height))
    return weights / weights.mean()


def judged(pictures, size, halves, motion, weights):
    """A film's sums, which add up over windows. Squares are weighted by rows."""
    squares, points = flicker(pictures, halves, motion)
    products = (pictures - halves[0]) * (pictures - halves[1]) * weights[:, None]
    return {"frames": len(pictures), "bytes": size, "squares": float(np.sum(np.mean(products, (1, 2)))),
            "ssim": len(pictures) * ssim(pictures, (halves[0] + halves[1]) / 2), "flicker_squares": squares, "flicker_points": points}


def noise_of(halves, weights):
    """PSNR of the truth, the mean of its halves, by their difference: what is left of its own noise, which no figure has in it."""
    return 10 * np.log10(255**2 / max(np.mean((halves[0] - halves[1]) ** 2 * weights[:, None]) / 4, 1e-6))


def together(all_sums):
    """Figures of windows' sums: CPU seconds a frame, dB, mean SSIM, other programs' metrics, bytes, code values of flicker."""
    total = {key: sum((s[key] for s in all_sums[1:]), start=all_sums[0][key]) for key in all_sums[0]}
    told = {}
    for metric in ("xpsnr_y", "ssimulacra2"):
        told[metric], told[f"{metric}_low"] = mean_and_low(total.get(metric, []))
    frames = total["frames"]
    return {"cpu": total["cpu"] / frames, "psnr_y": 10 * np.log10(255**2 / max(total["squares"] / frames, 1e-3)), "ssim_y": total["ssim"] / frames,
            **told, "bytes": total["bytes"], "flicker": np.sqrt(max(total["flicker_squares"], 0.0) / max(total["flicker_points"], 1))}


def at_equal_quality(ours, rows):
    """Cycles' CPU over ours, our flicker over Cycles', and whether that lies between its counts of samples: "", or < or >."""
    rows = sorted(rows, key=lambda r: r["cpu"])
    psnr = np.maximum.accumulate([r["psnr_y"] for r in rows])
    beyond = "<" if ours["psnr_y"] < psnr[0] else ">" if ours["psnr_y"] > psnr[-1] else ""
    cpu = np.exp(np.interp(ours["psnr_y"], psnr, np.log([r["cpu"] for r in rows])))
    return {"times": cpu / ours["cpu"], "flicker": ours["flicker"] / max(np.interp(ours["psnr_y"], psnr, [r["flicker"] for r in rows]), 1e-6), "beyond": beyond}


def tiles(pictures):
    rows, columns = np.array_split(np.arange(pictures.shape[1]), 4), np.array_split(np.arange(pictures.shape[2]), 4)
    return np.array([[pictures[:, r[0]:r[-1] + 1, c[0]:c[-1] + 1].mean() for c in columns] for r in rows])


def brightness(own, a, b):
    """Light over that of the truth's halves: mean, its standard error, of the darker half of the pixels, of the worst of 4x4 tiles."""
    truth = (a + b) / 2
    dark = truth <= np.median(truth)
    parts, blocks = tiles(own) / np.maximum(tiles(truth), 1e-9), (tiles(a) - tiles(b)) / 2
    row, column = np.unravel_index(np.argmax(np.abs(np.log(np.maximum(parts, 1e-9)))), parts.shape)
    return {"mean": own.mean() / max(truth.mean(), 1e-9), "noise": np.sqrt(np.mean(blocks**2)) / 4 / max(truth.mean(), 1e-9),
            "dark": own[dark].mean() / max(truth[dark].mean(), 1e-9), "tile": parts[row, column], "tile_at": [int(column) + 1, int(row) + 1]}
