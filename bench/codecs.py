#!/usr/bin/python3
"""Bits of `encode`'s codecs beside ffmpeg's libx264 at equal quality.

  bench/codecs.py PROGRAM FOLDER... [-- OPTION...]

Each folder holds frames.y4m and layers/frame_%04d.motion, as `render -o frames.y4m --aov layers` leaves them. Codes them with
quantisers 2, 4, 8, 16 and the options, and with libx264 `-preset medium` as people type it and with `-tune psnr`, and prints by film
the difference of bits in per cent (Bjontegaard, piecewise cubics) at equal PSNR-Y, SSIM and PSNR-HVS-M of decoded luma. Containers and
x264's message do not count."""
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

QUANTISERS = (2, 4, 8, 16)
FACTORS = (16, 20, 24, 28, 32, 36)  # x264's --crf
CSF = np.array("""1.608443 2.339554 2.573509 1.608443 1.072295 0.643377 0.504610 0.421887 2.144591 2.144591 1.838221 1.354478 0.989811
0.443708 0.428918 0.467911 1.838221 1.979622 1.608443 1.072295 0.643377 0.451493 0.372972 0.459555 1.838221 1.513829 1.169777 0.887417
0.504610 0.295806 0.321689 0.415082 1.429727 1.169777 0.695543 0.459555 0.378457 0.236102 0.249855 0.334222 1.072295 0.735288 0.467911
0.402111 0.317717 0.247453 0.227744 0.279729 0.525206 0.402111 0.329937 0.295806 0.249855 0.212687 0.214459 0.254803 0.357432 0.279729
0.270896 0.262603 0.229778 0.257351 0.249855 0.259950""".split(), float).reshape(8, 8)
MASK = np.array("""0.390625 0.826446 1.0 0.390625 0.173611 0.062500 0.038447 0.026874 0.694444 0.694444 0.510204 0.277008 0.147929
0.029727 0.027778 0.033058 0.510204 0.591716 0.390625 0.173611 0.062500 0.030779 0.021004 0.031888 0.510204 0.346021 0.206612 0.118906
0.038447 0.013212 0.015625 0.026015 0.308642 0.206612 0.073046 0.031888 0.021626 0.008417 0.009426 0.016866 0.173611 0.081633 0.033058
0.024414 0.015242 0.009246 0.007831 0.011815 0.041649 0.024414 0.016437 0.013212 0.009426 0.006830 0.006944 0.009803 0.019290 0.011815
0.011080 0.010412 0.007972 0.010000 0.009426 0.010203""".split(), float).reshape(8, 8)
DCT = np.array([[np.sqrt((1 if u == 0 else 2) / 8) * np.cos((2 * x + 1) * u * np.pi / 16) for x in range(8)] for u in range(8)])


def luma_of_y4m(file):
    data = Path(file).read_bytes()
    end = data.index(b"\n")
    width, height = (int(next(w for w in data[:end].decode().split() if w[0] == mark)[1:]) for mark in "WH")
    frames = np.frombuffer(data[end + 1:], np.uint8).reshape(-1, width * height * 3 // 2 + 6)
    return frames[:, 6:6 + width * height].reshape(-1, height, width)


def luma_of_film(file, like):
    raw = subprocess.run(["ffmpeg", "-v", "error", "-i", file, "-pix_fmt", "yuv420p", "-fps_mode", "passthrough", "-f", "rawvideo", "-"],
                         capture_output=True, check=True).stdout
    count, height, width = like.shape
    return np.frombuffer(raw, np.uint8).reshape(count, -1)[:, :width * height].reshape(like.shape)


def blocks(film):
    count, height, width = film.shape
    cut = film[:, :height // 8 * 8, :width // 8 * 8].reshape(count, height // 8, 8, width // 8, 8)
    return cut.transpose(0, 1, 3, 2, 4).reshape(-1, 8, 8).astype(float)


def spread(block):
    n = block.shape[-1] * block.shape[-2]
    return block.var(axis=(-1, -2)) * n * n / (n - 1)


def masking(block, coefficients):
    energy = (coefficients ** 2 * MASK).reshape(-1, 64)[:, 1:].sum(1)
    quarters = sum(spread(block[:, y:y + 4, x:x + 4]) for y in (0, 4) for x in (0, 4))
    whole = spread(block)
    return np.sqrt(energy * np.where(whole > 0, quarters / np.maximum(whole, 1e-12), 0)) / 32


def hvs_m(a, b):
    a, b = blocks(a), blocks(b)
    p, q = DCT @ a @ DCT.T, DCT @ b @ DCT.T
    hidden = np.maximum(masking(a, p), masking(b, q))[:, None, None] / MASK
    hidden[:, 0, 0] = 0
    seen = np.maximum(0, np.abs(p - q) - hidden) * CSF
    return 10 * np.log10(65025 / (seen ** 2).mean())


def ssim(a, b):
    def windows(film):
        count, height, width = film.shape
        s = film[:, :height // 4 * 4, :width // 4 * 4].reshape(count, height // 4, 4, width // 4, 4).sum((2, 4))
        return s[:, :-1, :-1] + s[:, 1:, :-1] + s[:, :-1, 1:] + s[:, 1:, 1:]
    a, b = a.astype(float), b.astype(float)
    sa, sb, squares, both = windows(a), windows(b), windows(a * a + b * b), windows(a * b)
    variance, covariance = 64 * squares - sa * sa - sb * sb, 64 * both - sa * sb
    c1, c2 = 0.01 ** 2 * 65025 * 64, 0.03 ** 2 * 65025 * 64 * 63
    values = (2 * sa * sb + c1) * (2 * covariance + c2) / ((sa * sa + sb * sb + c1) * (variance + c2))
    return -10 * np.log10(1 - values.mean())


def point(source, file, stream):
    """Bits of a stream, and the three qualities of a file that holds it."""
    film = luma_of_film(file, source)
    error = ((source.astype(float) - film) ** 2).mean()
    return stream.stat().st_size * 8, 10 * np.log10(65025 / error), ssim(source, film), hvs_m(source, film)


def ours(program, folder, work, quantiser, options):
    film = work / "film.mkv"
    subprocess.run([program, "encode", folder / "frames.y4m", "--motion", folder / "layers/frame_%04d.motion", "-o", film, "-q",
                    str(quantiser), "--quiet", "-y", *options], check=True)
    codec = options[options.index("--codec") + 1] if "--codec" in options else "h264"
    kind, ending = {"hevc": ("hevc", "hevc"), "av1": ("obu", "obu"), "mpeg2": ("mpeg2video", "m2v")}.get(codec, ("h264", "h264"))
    stream = work / f"film.{ending}"
    subprocess.run(["ffmpeg", "-v", "error", "-y", "-i", film, "-c", "copy", "-f", kind, stream], check=True)
    return film, stream


def theirs(folder, work, factor, tune):
    stream = work / "film.h264"
    subprocess.run(["ffmpeg", "-v", "error", "-y", "-i", folder / "frames.y4m", "-c:v", "libx264", "-threads", "1", "-preset", "medium",
                    *tune, "-crf", str(factor), "-bsf:v", "filter_units=remove_types=6", "-f", "h264", stream], check=True)
    return stream, stream


def cubic(x, y):
    """Monotone piecewise cubics through points [Fritsch1980]."""
    h, d, m = np.diff(x), np.diff(y) / np.diff(x), np.zeros(len(x))
    for i in range(1, len(x) - 1):
        if d[i - 1] * d[i] > 0:
            a, b = 2 * h[i] + h[i - 1], h[i] + 2 * h[i - 1]
            m[i] = (a + b) / (a / d[i - 1] + b / d[i])
    m[0], m[-1] = d[0], d[-1]

    def at(g):
        i = np.clip(np.searchsorted(x, g) - 1, 0, len(x) - 2)
        t = (g - x[i]) / h[i]
        return ((1 + 2 * t) * (1 - t) ** 2 * y[i] + t * (1 - t) ** 2 * h[i] * m[i] + t * t * (3 - 2 * t) * y[i + 1]
                + t * t * (t - 1) * h[i] * m[i + 1])
    return at


def difference(curve, other, quality):
    sides = [np.array(sorted((p[quality], np.log(p[0])) for p in c)).T for c in (curve, other)]
    grid = np.linspace(max(s[0][0] for s in sides), min(s[0][-1] for s in sides), 200)
    mine, its = (cubic(*s)(grid) for s in sides)
    return 100 * (np.exp((mine - its).mean()) - 1)


def main():
    words = sys.argv[1:]
    cut = words.index("--") if "--" in words else len(words)
    if cut < 2:
        sys.exit(__doc__)
    program, folders, options = words[0], [Path(f) for f in words[1:cut]], words[cut + 1:]
    rows = []
    print("film,PSNR-Y against medium,SSIM,PSNR-HVS-M,PSNR-Y against -tune psnr,SSIM,PSNR-HVS-M")
    with tempfile.TemporaryDirectory() as name:
        work = Path(name)
        for folder in folders:
            source = luma_of_y4m(folder / "frames.y4m")
            mine = [point(source, *ours(program, folder, work, q, options)) for q in QUANTISERS]
            row = []
            for tune in ([], ["-tune", "psnr"]):
                curve = [point(source, *theirs(folder, work, f, tune)) for f in FACTORS]
                row += [difference(mine, curve, quality) for quality in (1, 2, 3)]
            rows.append(row)
            print(folder.name, *(f"{v:.1f}" for v in row), sep=",", flush=True)
    print("mean", *(f"{v:.1f}" for v in np.mean(rows, 0)), sep=",")


main()
