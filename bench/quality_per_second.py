#!/usr/bin/env python3
"""What a default film loses to the converged picture, and what it costs.

quality_per_second.py PROGRAM FILM OUT_FOLDER [--frames N] [--size WxH] [--quantisers 4,8,16] [--converged "OPTIONS"]
                       [--cycles FOLDER [--cycles-samples N]] [OPTIONS...]

Truth: the first N frames rendered three times as large (so light is gathered at nine places of a pixel), with many light
points and edge samples, averaged to the film's size (many more light points than the film has: sets of like numbers share
their errors). They are coded with the film's own encoder and exact motion. Then the film
is rendered at each quantiser with OPTIONS (none: the default) on one thread. A row for each quantiser: dB of PSNR-Y lost (coded
truth less ours, both decoded and held against the truth), flicker (root mean square of the change of errors from frame to frame)
and bytes over those of the coded truth; CPU seconds a frame (without loading, at the truth's exposure). What is in OUT_FOLDER is
used again.

With --cycles FOLDER, where beside_cycles/cycles.py has rendered the same frames twice, two more figures in each row: CPU seconds a
frame of Cycles until its frames, coded alike, lose what ours lost, and until they are equal to the truth's (0.25 dB, flicker
x1.10, bytes x1.05). Its frames of n samples are the truth and the difference of its two renderings over sqrt(2), times the
root of their samples over n: noise as it is without adaptive sampling and denoiser.
Needs python3-numpy, python3-openimageio and ffmpeg."""
import argparse, json, pathlib, subprocess
import numpy as np, OpenImageIO as oiio

parser = argparse.ArgumentParser()
parser.add_argument("program")
parser.add_argument("film")
parser.add_argument("out", type=pathlib.Path)
parser.add_argument("--frames", type=int, default=12)
parser.add_argument("--size", default="256x256")
parser.add_argument("--quantisers", default="4,8,16")
parser.add_argument("--converged", default="--tolerance fixed=1% --vpls 1048576 --samples 4 --edge-samples 16 --cache off")
parser.add_argument("--cycles", type=pathlib.Path)
parser.add_argument("--cycles-samples", type=int, default=64)
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


def read(path):
    return oiio.ImageBuf(str(path)).get_pixels(oiio.FLOAT)[..., :3]


exposure = json.loads(statistics.read_text())["exposure"]
linear_truth = np.stack([read(p) for p in sorted(truth_frames.iterdir())])
truth = np.stack([developed(pixels, exposure) for pixels in linear_truth])


def coded(frames, q, film):
    """PSNR-Y, flicker and bytes of such frames, coded with the film's own motion."""
    first = sorted(layers.iterdir())[0].name
    run("encode", frames / "%04d.exr", "-y", "--exposure", exposure, "-o", film, "--quantiser", q, "--motion", layers / first.replace("0000", "%04d"))
    return *figures(luma(film), truth), film.stat().st_size


class Cycles:
    """Its frames of any number of samples, and what they cost."""
    exponents = range(35)  # samples are powers of the root of two

    def __init__(self, folder):
        a, b = (np.stack([read(p) for p in sorted(folder.glob(f"cycles{seed}_*.exr"))]) for seed in (0, 1))
        self.noise = np.nan_to_num(a - b) / np.sqrt(2) * np.sqrt(given.cycles_samples)
        self.seconds = float((folder / "cycles_film_seconds").read_text())
        self.known = {}

    def loss(self, q, exponent, base):
        if (q, exponent) not in self.known:
            folder = given.out / "cycles"
            folder.mkdir(exist_ok=True)
            for i, pixels in enumerate(np.maximum(linear_truth + self.noise / np.sqrt(2.0 ** (exponent / 2)), 0)):
                image = oiio.ImageBuf(oiio.ImageSpec(width, height, 3, oiio.FLOAT))
                image.set_pixels(oiio.ROI(), np.ascontiguousarray(pixels))
                image.write(str(folder / f"{i:04d}.exr"))
            psnr, flicker, size = coded(folder, q, given.out / "cycles.m2v")
            self.known[q, exponent] = base[0] - psnr, flicker / base[1], size / base[2]
        return self.known[q, exponent]

    def until(self, q, base, good):
        """CPU seconds a frame until `good` of loss, flicker and bytes: bisected, since all fall with samples."""
        low, high = 0, len(self.exponents)
        while low < high:
            middle = (low + high) // 2
            low, high = (low, middle) if good(*self.loss(q, middle, base)) else (middle + 1, high)
        return self.seconds * 2.0 ** (low / 2)


cycles = Cycles(given.cycles) if given.cycles else None
for q in given.quantisers.split(","):
    film, seconds = given.out / f"film_{q}.m2v", given.out / f"film_{q}.json"
    base = coded(truth_frames, q, given.out / f"coded_{q}.m2v")
    run("render", given.film, "-y", "-o", film, "--quantiser", q, "--threads", 1, "--exposure", exposure, "--stats", seconds, *frames, *options)
    psnr, flicker = figures(luma(film), truth)
    s = json.loads(seconds.read_text())
    cpu = (s["seconds"]["cpu"] - s["seconds"]["load"]) / s["frames"]
    row = (f"| {pathlib.Path(given.film).name} | {q} | {base[0] - psnr:.2f} dB | x{flicker / base[1]:.2f} | "
           f"x{film.stat().st_size / base[2]:.3f} | {cpu:.2f} s | see {s['seconds']['see'] / s['frames']:.2f} "
           f"shade {s['seconds']['shade'] / s['frames']:.2f} photons {s['passes'].get('photons', 0) / s['frames']:.2f} load {s['seconds']['load']:.1f} |")
    if cycles:
        alike = cycles.until(q, base, lambda loss, *_: loss <= max(base[0] - psnr, 0.01))
        equal = cycles.until(q, base, lambda loss, flicker, size: loss <= 0.25 and flicker <= 1.10 and size <= 1.05)
        row += f" {alike:.1f} s (x{alike / cpu:.1f}) | {equal:.1f} s |"
    print(row, flush=True)
