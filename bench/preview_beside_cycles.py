#!/usr/bin/env python3
"""Drafts beside Blender's Cycles in as much time: whose picture is nearer to the converged one.

preview_beside_cycles.py PROGRAM OUT_FOLDER [--models SCENES_FOLDER] [--size WxH] [--frames N] [--converged SAMPLES] NAME...

Films of beside_cycles/scenes.py (matt, some thing or the camera moves), N frames: drafts (--preview), and Cycles with 1, 2 and 4 samples a
pixel, without denoiser, on one thread. The last frame of each is held against Cycles with 2 x SAMPLES samples: PSNR of luma in 8 bits,
as sRGB, grey mean at 18 %. Prints a row a film: CPU seconds of a frame (the draft's all threads, loading aside) and PSNR of each, and the
PSNR that Cycles has in the draft's time, where error falls with the root of the samples. Needs Blender 3.4 with Cycles,
python3-openimageio and python3-numpy."""
import argparse, json, os, pathlib, subprocess
import numpy as np, OpenImageIO as oiio

parser = argparse.ArgumentParser()
parser.add_argument("program")
parser.add_argument("out", type=pathlib.Path)
parser.add_argument("--models")
parser.add_argument("--size", default="320x180")
parser.add_argument("--frames", type=int, default=3)
parser.add_argument("--converged", type=int, default=128)
parser.add_argument("names", nargs="+")
given = parser.parse_args()
here = pathlib.Path(__file__).resolve().parent / "beside_cycles"
given.out = given.out.resolve()
given.out.mkdir(parents=True, exist_ok=True)
models = ["--models", given.models] if given.models else []
subprocess.run(["python3", here / "scenes.py", *models, "--frames", str(given.frames), given.out, *given.names], check=True, stdout=subprocess.DEVNULL)


def cycles(folder, samples):
    """CPU seconds of a frame, and the mean of its two last frames."""
    subprocess.run(["blender", "-b", "-noaudio", "--factory-startup", "--python-exit-code", "1", "-P", here / "cycles.py", "--", folder, str(samples),
                    *given.size.split("x")], check=True, cwd=folder, stdout=subprocess.DEVNULL, env={**os.environ, "OMP_NUM_THREADS": "1"})
    frames = [luminance(folder / f"cycles{seed}_{given.frames - 1:04d}.exr") for seed in (0, 1)]
    return samples * float((folder / "cycles_film_seconds").read_text()), frames


def luminance(path):
    return oiio.ImageBuf(str(path)).get_pixels(oiio.FLOAT)[..., :3] @ np.array([0.2126, 0.7152, 0.0722])


def codes(light, scale):
    v = np.clip(light * scale, 0, 1)
    return 255 * np.where(v <= 0.0031308, 12.92 * v, 1.055 * v ** (1 / 2.4) - 0.055)


for name in given.names:
    folder = given.out / name
    _, halves = cycles(folder, given.converged)
    truth = sum(halves) / 2
    scale = 0.18 / truth.mean()
    psnr = lambda light: 10 * np.log10(255**2 / np.mean((codes(light, scale) - codes(truth, scale)) ** 2))
    subprocess.run([given.program, "render", folder, "--preview", "-o", folder / "draft%04d.exr", "--size", given.size, "--exposure", "0", "-y", "--quiet",
                    "--stats", folder / "draft.json"], check=True)
    seconds = [f["seconds"] for f in json.loads((folder / "draft.json").read_text())["per_frame"]]
    own, quality = seconds[-1], psnr(luminance(folder / f"draft{given.frames - 1:04d}.exr"))
    row = [f"draft {own:.2f} s, {quality:.2f} dB"]
    for samples in (1, 2, 4):
        took, frames = cycles(folder, samples)
        there = np.mean([psnr(f) for f in frames])
        row.append(f"{samples}: {took:.2f} s, {there:.2f} dB")
    row.append(f"in the draft's time {there + 10 * np.log10(own / took):.2f} dB")
    print(f"| {name} | " + " | ".join(row) + " |", flush=True)
