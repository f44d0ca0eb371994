#!/usr/bin/env python3
"""Banding of smooth gradients in films of 8 bits, with and without dither: `bench/banding.py build/release/render2mpeg`.

For each codec, quantiser, range of the gradient (code values), pan (rows a frame) and dither: bits a frame, the
low-pass error (rms of a Gaussian of four pixels) of source and film against the unrounded truth, and the mean length
of runs of equal value down a column. Needs ffmpeg and numpy.
"""
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
    offset = {"none": lambda: 0.5, "new": lambda: np.random.default_rng(frame).random(exact.shape),
              "kept": lambda: np.random.default_rng(7).random(exact.shape), "ordered": lambda: PATTERN}[dither]()
    return np.clip(np.floor(exact + offset), 16, 235).astype(np.uint8)


def low_pass(error):
    for axis in (0, 1):
        error = np.apply_along_axis(lambda line: np.convolve(line, BLUR, "same"), axis, error)
    return np.sqrt((error[16:-16, 16:-16] ** 2).mean())


def run_length(luma):
    return luma.size / ((np.diff(luma.astype(int), axis=0) != 0).sum() + luma.shape[1])


def coded(program, codec, quantiser, frames, folder):
    source, film = folder + "/in.y4m", folder + ("/film.m2v" if codec == "mpeg2" else "/film.mp4")
    with open(source, "wb") as file:
        file.write(f"YUV4MPEG2 W{WIDTH} H{HEIGHT} F24:1 Ip A1:1 C420mpeg2\n".encode())
        for frame in frames:
            file.write(b"FRAME\n" + frame.tobytes() + bytes([128]) * (WIDTH * HEIGHT // 2))
    subprocess.run([program, "encode", source, "-o", film, "-q", str(quantiser), "--codec", codec, "--overwrite",
                    "--quiet", "--threads", "1"], check=True)
    raw = subprocess.run(["ffmpeg", "-v", "error", "-i", film, "-f", "rawvideo", "-pix_fmt", "yuv420p", "-"],
                         capture_output=True, check=True).stdout
    pictures = np.frombuffer(raw, np.uint8).reshape(FRAMES, -1)[:, :WIDTH * HEIGHT]
    return os.path.getsize(film) * 8 / FRAMES, pictures.reshape(-1, HEIGHT, WIDTH)


def main():
    print("codec,quantiser,values,pan,dither,bits,error_of_source,error,run_of_source,run")
    with tempfile.TemporaryDirectory() as folder:
        for values in (20, 60):
            for pan in (0, 0.5):
                exact = [truth(values, pan, n) for n in range(FRAMES)]
                for dither in ("none", "new", "kept", "ordered"):
                    source = [rounded(dither, e, n) for n, e in enumerate(exact)]
                    for codec in ("mpeg2", "h264"):
                        for quantiser in (1, 2, 4, 8):
                            bits, film = coded(sys.argv[1], codec, quantiser, source, folder)
                            errors = [np.mean([low_pass(p[n] - exact[n]) for n in range(0, FRAMES, 4)])
                                      for p in (source, film)]
                            print(f"{codec},{quantiser},{values},{pan},{dither},{bits:.0f},{errors[0]:.3f},"
                                  f"{errors[1]:.3f},{run_length(source[8]):.1f},{run_length(film[8]):.1f}", flush=True)


main()
