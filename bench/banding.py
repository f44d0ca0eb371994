#!/usr/bin/env python3
"""Banding of smooth gradients as displays of 8 bits show them, with and without dither:
`[VMAF=vmaf] bench/banding.py build/release/render2mpeg`.

For each codec, quantiser, range of the gradient (code values), pan (rows a frame) and dither of the source (`exact`:
none, in 16 bits): bits a frame, the low-pass error (rms of a Gaussian of four pixels) of source and film against the
unrounded truth, and the mean length of runs of equal value down a column; where the environment names libvmaf's program
also CAMBI of both. Needs ffmpeg and numpy.
"""
import json
import os
import subprocess
import sys
import tempfile

import numpy as np

WIDTH, HEIGHT, FRAMES = 640, 360, 24
BLUR = np.exp(-np.arange(-14, 15) ** 2 / 32)
BLUR /= BLUR.sum()


def truth(values, pan, frame):
    y, x = np.mgrid[0:HEIGHT, 0:WIDTH].astype(float)
    moved = pan * frame
    return 110 + values * ((y + moved) / HEIGHT) ** 1.2 + 0.15 * values * np.sin((x + 2 * moved) / WIDTH * 3)


def ordered(side):
    if side == 1:
        return np.zeros((1, 1))
    half = ordered(side // 2)
    return np.block([[4 * half, 4 * half + 2], [4 * half + 3, 4 * half + 1]])


PATTERN = np.tile((ordered(8) + 0.5) / 64, (HEIGHT // 8, WIDTH // 8))


def rounded(dither, exact, frame):
    if dither == "exact":
        return np.round(256 * exact) / 256
    offset = {"none": lambda: 0.5, "new": lambda: np.random.default_rng(frame).random(exact.shape),
              "kept": lambda: np.random.default_rng(7).random(exact.shape), "ordered": lambda: PATTERN}[dither]()
    return np.clip(np.floor(exact + offset), 16, 235)


def shown(pictures):
    """In 8 bits."""
    return np.floor(np.asarray(pictures) + 0.5)


def write(file, frames, depth):
    kind = "<u2" if depth > 8 else np.uint8
    scale = 2 ** (depth - 8)
    with open(file, "wb") as out:
        out.write(f"YUV4MPEG2 W{WIDTH} H{HEIGHT} F24:1 Ip A1:1 C420{'p16' if depth > 8 else 'mpeg2'}\n".encode())
        grey = np.full(WIDTH * HEIGHT // 2, 128 * scale, kind).tobytes()
        for frame in frames:
            out.write(b"FRAME\n" + np.round(scale * frame).astype(kind).tobytes() + grey)


def cambi(pictures, folder):
    if "VMAF" not in os.environ:
        return float("nan")
    film, result = folder + "/shown.y4m", folder + "/cambi.json"
    write(film, shown(pictures), 8)
    subprocess.run([os.environ["VMAF"], "-q", "-r", film, "-d", film, "--no_prediction", "--feature", "cambi", "--json", "-o", result],
                   check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    with open(result) as file:
        return json.load(file)["pooled_metrics"]["cambi"]["mean"]


def low_pass(error):
    for axis in (0, 1):
        error = np.apply_along_axis(lambda line: np.convolve(line, BLUR, "same"), axis, error)
    return np.sqrt((error[16:-16, 16:-16] ** 2).mean())


def run_length(luma):
    return luma.size / ((np.diff(luma.astype(int), axis=0) != 0).sum() + luma.shape[1])


def coded(program, codec, quantiser, frames, depth, folder):
    source, film = folder + "/in.y4m", folder + ("/film.m2v" if codec == "mpeg2" else "/film.mp4")
    write(source, frames, depth)
    subprocess.run([program, "encode", source, "-o", film, "-q", str(quantiser), "--codec", codec, "--overwrite",
                    "--quiet", "--threads", "1"], check=True)
    raw = subprocess.run(["ffmpeg", "-v", "error", "-i", film, "-f", "rawvideo", "-pix_fmt", "yuv420p10le", "-"],
                         capture_output=True, check=True).stdout
    pictures = np.frombuffer(raw, "<u2").reshape(FRAMES, -1)[:, :WIDTH * HEIGHT]
    return os.path.getsize(film) * 8 / FRAMES, pictures.reshape(-1, HEIGHT, WIDTH) / 4


def main():
    print("codec,quantiser,values,pan,dither,bits,error_of_source,error,run_of_source,run,cambi_of_source,cambi")
    with tempfile.TemporaryDirectory() as folder:
        for values in (20, 60):
            for pan in (0, 0.5):
                exact = [truth(values, pan, n) for n in range(FRAMES)]
                for dither in ("exact", "none", "new", "kept", "ordered"):
                    source = [rounded(dither, e, n) for n, e in enumerate(exact)]
                    for codec in ("hevc", "av1") if dither == "exact" else ("mpeg2", "h264"):
                        for quantiser in (1, 2, 4, 8):
                            depth = 16 if dither == "exact" else 8
                            bits, film = coded(sys.argv[1], codec, quantiser, source, depth, folder)
                            errors = [np.mean([low_pass(p[n] - exact[n]) for n in range(0, FRAMES, 4)])
                                      for p in (source, film)]
                            print(f"{codec},{quantiser},{values},{pan},{dither},{bits:.0f},{errors[0]:.3f},"
                                  f"{errors[1]:.3f},{run_length(shown(source[8])):.1f},{run_length(shown(film[8])):.1f},"
                                  f"{cambi(source, folder):.2f},{cambi(film, folder):.2f}", flush=True)


main()
