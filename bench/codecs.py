#!/usr/bin/python3
"""Bits of `encode`'s codecs beside ffmpeg's encoders at equal quality.

  [VMAF=vmaf] bench/codecs.py PROGRAM FOLDER... [-- OPTION...]

Each folder holds frames.y4m and layers/frame_%04d.motion, as `render -o frames.y4m --aov layers` leaves them. Codes them with
quantisers 2, 4, 8, 16 and the options, and with the peers of the codec as people type them, on one thread. Prints by film and peer the
difference of bits in per cent (Bjontegaard, piecewise cubics) at equal PSNR-Y, SSIM and PSNR-HVS-M of decoded luma, and CPU
milliseconds a picture of both; ours reads motion and decodes too. Containers and encoders' messages do not count.
Where the environment names libvmaf's program also at equal VMAF NEG, from 30 to 97, and SSIMULACRA2 of a quarter of the frames, by the
Python package of that name."""
import json
import os
import resource
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

os.environ["SVT_LOG"] = "0"  # else SVT-AV1 talks
QUANTISERS = (2, 4, 8, 16)
X26, SVT = (16, 20, 24, 28, 32, 36), (12, 20, 28, 36, 44, 52)  # values of -crf
MEDIUM, TEN_BITS = ["libx264", "-preset", "medium"], ["-pix_fmt", "yuv420p10le"]
ALONE = ["-x265-params", "pools=none:frame-threads=1:log-level=error"]
PEERS = {
    "h264": [(X26, [*MEDIUM]), (X26, [*MEDIUM, "-tune", "psnr"])],
    "hevc": [(X26, [*MEDIUM])] + [(X26, ["libx265", "-preset", preset, *ALONE]) for preset in ("medium", "slow", "slower")],
    "av1": [(SVT, ["libsvtav1", "-preset", "6", "-svtav1-params", "lp=1", *TEN_BITS])],
    "mpeg2": [(X26, [*MEDIUM])]}
STREAMS = {"h264": ("h264", "filter_units=remove_types=6"), "hevc": ("hevc", "filter_units=remove_types=39"), "av1": ("obu", "null"),
           "mpeg2": ("mpeg2video", "null")}
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
    """In code values of 8 bits, with what 10 bits have between them."""
    raw = subprocess.run(["ffmpeg", "-v", "error", "-i", file, "-pix_fmt", "yuv420p10le", "-fps_mode", "passthrough", "-f", "rawvideo",
                          "-"], capture_output=True, check=True).stdout
    count, height, width = like.shape
    return np.frombuffer(raw, "<u2").reshape(count, -1)[:, :width * height].reshape(like.shape) / 4


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


def to_the_eye(frames, film):
    """VMAF NEG and SSIMULACRA2."""
    from ssimulacra2 import compute_ssimulacra2
    decode = ["ffmpeg", "-v", "error", "-y", "-i"]
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        quarter = ["-vf", r"select=lt(mod(n*0.618034+0.5\,1)\,0.25)", "-fps_mode", "passthrough"]  # no type of pictures preferred
        for side, file in (("a", frames), ("b", film)):
            subprocess.run([*decode, file, "-fps_mode", "passthrough", *TEN_BITS, "-strict", "-1", folder / f"{side}.y4m"], check=True)
            subprocess.run([*decode, file, *quarter, folder / f"{side}%03d.png"], check=True)
        subprocess.run([os.environ["VMAF"], "-q", "-r", folder / "a.y4m", "-d", folder / "b.y4m", "--model",
                        "version=vmaf_v0.6.1neg:name=neg", "--json", "-o", folder / "vmaf"], check=True, stderr=subprocess.DEVNULL)
        pictures = [compute_ssimulacra2(a, folder / a.name.replace("a", "b")) for a in sorted(folder.glob("a*.png"))]
        return json.loads((folder / "vmaf").read_text())["pooled_metrics"]["neg"]["mean"], float(np.mean(pictures))


def point(source, film, codec, milliseconds, frames):
    """Bits of a stream, the qualities of the file that holds it, and time."""
    stream = film.with_name("stream")
    subprocess.run(["ffmpeg", "-v", "error", "-y", "-i", film, "-c", "copy", "-bsf:v", STREAMS[codec][1], "-f", STREAMS[codec][0], stream],
                   check=True)
    shown = luma_of_film(film, source)
    error = ((source - shown) ** 2).mean()
    return stream.stat().st_size * 8, 10 * np.log10(65025 / error), ssim(source, shown), hvs_m(source, shown), *(
        to_the_eye(frames, film) if "VMAF" in os.environ else ()), milliseconds


def run(source, *command):
    """CPU milliseconds a picture."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(command, check=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return 1000 * (after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime) / len(source)


def ours(source, program, folder, film, quantiser, options):
    return run(source, program, "encode", folder / "frames.y4m", "--motion", folder / "layers/frame_%04d.motion", "-o", film, "-q",
               str(quantiser), "--quiet", "-y", *options)


def theirs(source, folder, film, factor, peer):
    return run(source, "ffmpeg", "-v", "error", "-y", "-threads", "1", "-i", folder / "frames.y4m", "-threads", "1", "-c:v", *peer, "-crf",
               str(factor), film)


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
    low, high = max(s[0][0] for s in sides), min(s[0][-1] for s in sides)
    grid = np.linspace(*((max(low, 30), min(high, 97)) if quality == 4 else (low, high)), 200)
    mine, its = (cubic(*s)(grid) for s in sides)
    return 100 * (np.exp((mine - its).mean()) - 1)


def main():
    words = sys.argv[1:]
    cut = words.index("--") if "--" in words else len(words)
    if cut < 2:
        sys.exit(__doc__)
    program, folders, options = words[0], [Path(f) for f in words[1:cut]], words[cut + 1:]
    codec = options[options.index("--codec") + 1] if "--codec" in options else "h264"
    differences = {}
    qualities = ["PSNR-Y", "SSIM", "PSNR-HVS-M", "VMAF NEG", "SSIMULACRA2"][:5 if "VMAF" in os.environ else 3]
    print("film", "peer", *qualities, "our ms", "its ms", sep=",")
    with tempfile.TemporaryDirectory() as name:
        film = Path(name) / "film.mkv"
        for folder in folders:
            source = luma_of_y4m(folder / "frames.y4m")
            frames = folder / "frames.y4m"
            mine = [point(source, film, codec, ours(source, program, folder, film, q, options), frames) for q in QUANTISERS]
            for factors, peer in PEERS[codec]:
                kind = next(c for c, name in (("h264", "x264"), ("hevc", "x265"), ("av1", "av1")) if name in peer[0])
                curve = [point(source, film, kind, theirs(source, folder, film, f, peer), frames) for f in factors]
                row = [difference(mine, curve, quality) for quality in range(1, 1 + len(qualities))]
                row += [np.mean([p[-1] for p in c]) for c in (mine, curve)]
                words = " ".join(w for w in peer if w not in ALONE and w != "-svtav1-params" and w != "lp=1")
                differences.setdefault(words, []).append(row)
                print(folder.name, words, *(f"{v:.1f}" for v in row), sep=",", flush=True)
    for words, rows in differences.items():
        print("mean", words, *(f"{v:.1f}" for v in np.mean(rows, 0)), sep=",")


main()
