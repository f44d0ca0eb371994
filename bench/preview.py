#!/usr/bin/env python3
"""What a draft shows of the final film, and how soon.

preview.py PROGRAM FILM OUT_FOLDER [--frames N] [--size WxH] [DRAFT OPTIONS...]

Renders the first N frames as a final film, at its defaults, and as a draft of the same size and exposure on two threads; both are
decoded and compared. Prints a row: pictures per CPU second and per second of two such cores (without loading), CPU seconds of loading, PSNR-Y and SSIM of
the draft against the final film, and flicker: the root mean square change of luma along exact motion, over the final film's. The final
film and the motion in OUT_FOLDER are used again. Needs python3-numpy, python3-openimageio and ffmpeg."""
import argparse, json, pathlib, re, subprocess
import numpy as np, OpenImageIO as oiio

parser = argparse.ArgumentParser()
parser.add_argument("program")
parser.add_argument("film")
parser.add_argument("out", type=pathlib.Path)
parser.add_argument("--frames", type=int, default=12)
parser.add_argument("--size", default="640x360")
given, options = parser.parse_known_args()
width, height = map(int, given.size.split("x"))
given.out.mkdir(parents=True, exist_ok=True)
frames = ["--frames", f"0:{given.frames - 1}", "--size", given.size]


def run(*arguments):
    subprocess.run([given.program, *map(str, arguments), "-y", "--quiet"], check=True)


def luma(path):
    raw = subprocess.run(["ffmpeg", "-v", "error", "-i", path, "-f", "rawvideo", "-pix_fmt", "yuv420p", "-"],
                         stdout=subprocess.PIPE, check=True).stdout
    pictures = np.frombuffer(raw, np.uint8).reshape(-1, height * width + 2 * ((height + 1) // 2) * ((width + 1) // 2))
    return pictures[:, :height * width].reshape(-1, height, width).astype(float)


def flicker(film):
    """Along the way from each frame to the one before, where that lies inside the picture on a surface."""
    ys, xs = np.mgrid[0:height, 0:width]
    squares, count = 0.0, 0
    for n in range(1, len(film)):
        layer = oiio.ImageBuf(str(given.out / "layers" / f"frame_{n:04d}.exr"))
        names = layer.spec().channelnames
        pixels = layer.get_pixels(oiio.FLOAT)
        channel = lambda end: pixels[..., next(i for i, name in enumerate(names) if name.endswith(end))]
        x, y = xs + channel("Vector.X"), ys - channel("Vector.Y")
        inside = (x >= 0) & (y >= 0) & (x <= width - 1) & (y <= height - 1) & (np.round(channel("Class.X")) == 1)
        x, y = np.clip(np.nan_to_num(x), 0, width - 1.001), np.clip(np.nan_to_num(y), 0, height - 1.001)
        x0, y0 = x.astype(int), y.astype(int)
        a, b, before = x - x0, y - y0, film[n - 1]
        there = (before[y0, x0] * (1 - a) + before[y0, x0 + 1] * a) * (1 - b) + (before[y0 + 1, x0] * (1 - a) + before[y0 + 1, x0 + 1] * a) * b
        squares += np.sum(((film[n] - there) ** 2)[inside])
        count += inside.sum()
    return np.sqrt(squares / max(count, 1))


final, layers, facts = given.out / "final.m2v", given.out / "layers", given.out / "final.json"
if not facts.exists():
    run("render", given.film, "-o", final, "--stats", facts, *frames)
exposure = json.loads(facts.read_text())["exposure"]
if not layers.exists():
    run("render", given.film, "-o", given.out / "motion.y4m", "--aov", layers, *frames, "--samples", 1, "--vpls", 0, "--tolerance", "fixed=50%", "--exposure", 0)
draft, drawn = given.out / "draft.m2v", given.out / "draft.json"
run("render", given.film, "-o", draft, "--preview", "--threads", 2, "--exposure", exposure, "--stats", drawn, *frames, *options)
s = json.loads(drawn.read_text())
a, b = luma(final)[:given.frames], luma(draft)
psnr = 10 * np.log10(255**2 / np.mean((a - b) ** 2))
told = subprocess.run(["ffmpeg", "-i", draft, "-i", final, "-lavfi", "ssim", "-f", "null", "-"], stderr=subprocess.PIPE, text=True).stderr
ssim = float(re.search(r"SSIM Y:([0-9.]+)", told).group(1))
cpu = {k: v for k, v in s["seconds"].items() if k not in ("cpu", "wall", "load")}  # by stage
each = [f["seconds"] for f in s["per_frame"]]
spent = sum(each)
print(f"| {pathlib.Path(given.film).name} | {len(b) / spent:.2f} | {2 * len(b) / spent:.2f} | first {each[0]:.2f} s, load {s['seconds']['load']:.2f} s | {psnr:.2f} | {ssim:.4f} | "
      f"{flicker(b) / flicker(a):.3f} | " + ", ".join(f"{k} {v / len(b):.3f}" for k, v in cpu.items() if v > 0) + " |")
