#!/usr/bin/env python3
"""What a default film loses to the converged picture, and what it costs.

quality_per_second.py PROGRAM FILM OUT_FOLDER [--frames N] [--size WxH] [--quantisers 4,8,16] [--converged "OPTIONS"] [OPTIONS...]

Truth: the first N frames rendered three times as large (so light is gathered at nine places of a pixel), with many light
points and edge samples, averaged to the film's size. They are coded with the film's own encoder and exact motion. Then the film
is rendered at each quantiser with OPTIONS (none: the default) on one thread. A row for each quantiser: dB of PSNR-Y lost (coded
truth less ours, both decoded and held against the truth), flicker (root mean square of the change of errors from frame to frame)
and bytes over those of the coded truth; CPU seconds a frame (without loading, at the truth's exposure). What is in OUT_FOLDER is
used again. Needs python3-numpy, python3-openimageio and ffmpeg."""
import argparse, json, pathlib, subprocess
import numpy as np, OpenImageIO as oiio

parser = argparse.ArgumentParser()
parser.add_argument("program")
parser.add_argument("film")
parser.add_argument("out", type=pathlib.Path)
parser.add_argument("--frames", type=int, default=12)
parser.add_argument("--size", default="256x256")
parser.add_argument("--quantisers", default="4,8,16")
parser.add_argument("--converged", default="--tolerance fixed=1% --vpls 65536 --samples 4 --edge-samples 16 --cache off")
given, options = parser.parse_known_args()
width, height = map(int, given.size.split("x"))
given.out.mkdir(parents=True, exist_ok=True)
frames = ["--frames", f"0:{given.frames - 1}", "--size", given.size]


def run(*arguments):
    subprocess.run([given.program, *map(str, arguments), "--quiet"], check=True)


def luma(path):
    raw = subprocess.run(["ffmpeg", "-v", "error", "-i", path, "-f", "rawvideo", "-pix_fmt", "yuv420p", "-"],
                         stdout=subprocess.PIPE, check=True).stdout
    # The first plane of each picture. Asked for grey, ffmpeg would stretch the range.
    chroma = ((height + 1) // 2) * ((width + 1) // 2)
    pictures = np.frombuffer(raw, np.uint8).reshape(-1, height * width + 2 * chroma)
    return pictures[:, :height * width].reshape(-1, height, width).astype(float)


def developed(pixels, exposure):
    """Luma, 8 bit, of scene-linear pixels (docs/model/display.md)."""
    x = np.maximum(pixels, 0) * 2.0**exposure
    y = np.where(x <= 0.625, x, 1 - 0.375**2 / np.maximum(x - 0.25, 0.375))
    v = np.where(y < 0.018053968510807, 4.5 * y, 1.09929682680944 * np.maximum(y, 1e-9) ** 0.45 - 0.09929682680944)
    weights = [0.299, 0.587, 0.114] if height < 720 else [0.2126, 0.7152, 0.0722]
    return np.floor(16 + 219 * (v @ np.array(weights)) + 0.5)


def figures(film, truth):
    error = film - truth
    flicker = np.sqrt(np.mean((error[1:] - error[:-1]) ** 2)) if len(error) > 1 else 0.0
    return 10 * np.log10(255**2 / np.mean(error**2)), flicker


truth_frames, layers, large, statistics = (given.out / n for n in ("truth", "layers", "large", "truth.json"))
if not statistics.exists():
    for folder in (truth_frames, layers, large):
        folder.mkdir(exist_ok=True)
    run("render", given.film, "-y", "-o", given.out / "motion.y4m", "--aov", layers, *frames, "--samples", 1)
    run("render", given.film, "-y", "-o", large / "%04d.exr", *frames[:2], "--size", f"{3 * width}x{3 * height}",
        *given.converged.split(), "--stats", statistics)
    for path in large.iterdir():
        pixels = oiio.ImageBuf(str(path)).get_pixels(oiio.FLOAT)[..., :3]
        mean = pixels.reshape(height, 3, width, 3, 3).mean(axis=(1, 3))
        out = oiio.ImageBuf(oiio.ImageSpec(width, height, 3, oiio.FLOAT))
        out.set_pixels(oiio.ROI(), np.ascontiguousarray(mean))
        out.write(str(truth_frames / path.name))
        path.unlink()
exposure = json.loads(statistics.read_text())["exposure"]
truth = np.stack([developed(oiio.ImageBuf(str(p)).get_pixels(oiio.FLOAT)[..., :3], exposure) for p in sorted(truth_frames.iterdir())])
for q in given.quantisers.split(","):
    coded, film, seconds = given.out / f"coded_{q}.m2v", given.out / f"film_{q}.m2v", given.out / f"film_{q}.json"
    first = sorted(layers.iterdir())[0].name
    run("encode", truth_frames / "%04d.exr", "-y", "--exposure", exposure, "-o", coded, "--quantiser", q, "--motion", layers / first.replace("0000", "%04d"))
    run("render", given.film, "-y", "-o", film, "--quantiser", q, "--threads", 1, "--exposure", exposure, "--stats", seconds, *frames, *options)
    base, base_flicker = figures(luma(coded), truth)
    ours, flicker = figures(luma(film), truth)
    s = json.loads(seconds.read_text())
    cpu = (s["seconds"]["cpu"] - s["seconds"]["load"]) / s["frames"]
    print(f"| {pathlib.Path(given.film).name} | {q} | {base - ours:.2f} dB | x{flicker / base_flicker:.2f} | "
          f"x{film.stat().st_size / coded.stat().st_size:.3f} | {cpu:.2f} s | see {s['seconds']['see'] / s['frames']:.2f} "
          f"shade {s['seconds']['shade'] / s['frames']:.2f} photons {s['passes'].get('photons', 0) / s['frames']:.2f} load {s['seconds']['load']:.1f} |", flush=True)
