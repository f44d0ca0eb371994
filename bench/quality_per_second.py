#!/usr/bin/python3
"""What a film loses to the truth, and what it costs.

quality_per_second.py PROGRAM FILM WORK [--frames A:B] [--size WxH] [--quantisers 4,8,16] [--truth PERCENT] [--truth-frames 0:0,15:15]
                      [--guide "OPTIONS"] [--cycles FOLDER [--cycles-samples N]] [OPTIONS...]

Truth: frames by paths (`--tolerance truth`), whose two halves are independent, of all frames or of some. Guide: the same frames by
many light points; it has no noise, so that coding it tells what coding alone loses. Errors against both halves are multiplied, so that
the mean has none of the truth's noise; of what the curve of luma makes of noise, the second order is taken off. Both are made once and
kept in WORK (truth, guide); other programs use them again.

Then the film is rendered at each quantiser with OPTIONS (none: the default), once on one thread against the clock and once with its layers.
A row for each: CPU seconds a frame (without loading); PSNR-Y of the decoded film against the truth; dB below the decoded guide against
the guide; bytes and flicker (root mean square of the errors' change) over the guide's; before coding, in code values, the root mean square error, of it
that of means over 8x8 pixels and the rest; light over the truth's; share of pixels within 2 % of the truth, taken as the guide times the
ratio of their means over 9x9 pixels; the truth's own noise in code values.

With --cycles FOLDER, where beside_cycles/cycles.py has rendered the same frames twice: CPU seconds a frame of Cycles until its frames,
coded alike, lose what ours lost, and until they lose 0.25 dB. Its frames of n samples are the guide and the difference of its two
renderings over sqrt(2), times the root of their samples over n.
Needs python3-numpy, python3-openimageio and ffmpeg."""
import argparse
import json
import pathlib
import subprocess

import numpy as np
import OpenImageIO as oiio

parser = argparse.ArgumentParser()
parser.add_argument("program")
parser.add_argument("film")
parser.add_argument("work", type=pathlib.Path)
parser.add_argument("--frames", default="0:3")
parser.add_argument("--size", default="192x192")
parser.add_argument("--quantisers", default="4,8,16")
parser.add_argument("--truth", default="5")
parser.add_argument("--truth-frames")
parser.add_argument("--guide", default="--tolerance fixed=2% --vpls 65536 --samples 4 --edge-samples 16 --cache off")
parser.add_argument("--cycles", type=pathlib.Path)
parser.add_argument("--cycles-samples", type=int, default=64)
given, options = parser.parse_known_args()
width, height = map(int, given.size.split("x"))
first, last = map(int, given.frames.split(":"))
count = last - first + 1
given.work.mkdir(parents=True, exist_ok=True)
WEIGHTS = np.array([0.299, 0.587, 0.114] if height < 720 else [0.2126, 0.7152, 0.0722])


def run(*arguments):
    subprocess.run([given.program, *map(str, arguments), "--quiet"], check=True)


def render(output, frames, *more):
    run("render", given.film, "-y", "-o", output, "--frames", frames, "--size", given.size, *more)


def luma(path):
    raw = subprocess.run(["ffmpeg", "-v", "error", "-i", path, "-f", "rawvideo", "-pix_fmt", "yuv420p", "-"],
                         stdout=subprocess.PIPE, check=True).stdout
    # The first plane of each picture. Asked for grey, ffmpeg would stretch the range.
    pictures = np.frombuffer(raw, np.uint8).reshape(-1, height * width + 2 * ((height + 1) // 2) * ((width + 1) // 2))
    return pictures[:, :height * width].reshape(-1, height, width).astype(float)


def signal(x):
    """R'G'B' of exposed light (docs/model/display.md)."""
    y = np.where(x <= 0.625, x, 1 - 0.375**2 / np.maximum(x - 0.25, 0.375))
    return np.where(y <= 0.0031308, 12.92 * y, 1.055 * np.maximum(y, 1e-9) ** (1 / 2.4) - 0.055)


def codes(pixels, exposure):
    return 16 + 219 * (signal(np.maximum(pixels, 0) * 2.0**exposure) @ WEIGHTS)


def true_codes(half, mean, relative_error, exposure):
    """Code values of half of a truth: less what the curve makes of its noise on the average, to second order."""
    step = 1e-2
    x = np.maximum(mean, 1e-9) * 2.0**exposure
    curvature = (signal(x * (1 + step)) + signal(x * (1 - step)) - 2 * signal(x)) / step**2
    variance = 2 * np.minimum(relative_error, 0.3) ** 2
    return codes(half, exposure) - 219 * 0.5 * variance * (curvature @ WEIGHTS)


def layer(path, name, channels="RGB"):
    image = oiio.ImageBuf(str(path))
    at = [image.spec().channelnames.index(name + c) for c in channels]
    return image.get_pixels(oiio.FLOAT)[..., at].astype(float)


def layers_of(folder, frames):
    files = {int("".join(c for c in p.stem if c.isdigit())): p for p in folder.glob("*.exr")}
    return [files[n] for n in frames]


def write(folder, frames):
    folder.mkdir(exist_ok=True)
    for n, pixels in frames:
        image = oiio.ImageBuf(oiio.ImageSpec(width, height, 3, oiio.FLOAT))
        image.set_pixels(oiio.ROI(), np.ascontiguousarray(pixels, np.float32))
        image.write(str(folder / f"{n:04d}.exr"))


# Make the guide and the truth, unless they are there.
guide_folder, truth_folder = given.work / "guide", given.work / "truth"
statistics = given.work / "guide.json"
if not statistics.exists():
    render(given.work / "guide.m2v", given.frames, "--aov", guide_folder, *given.guide.split(), "--stats", statistics)
truth_frames = []
for part in (given.truth_frames or given.frames).split(","):
    a, b = map(int, part.split(":"))
    if len(list(truth_folder.glob("*.exr"))) < len(truth_frames) + b - a + 1:
        render(given.work / "truth.%04d.exr", part, "--aov", truth_folder, "--tolerance", f"truth={given.truth}%")
    truth_frames += range(a, b + 1)

exposure = json.loads(statistics.read_text())["exposure"]
guide = np.stack([layer(p, "") for p in layers_of(guide_folder, range(first, last + 1))])
places = [n - first for n in truth_frames]
truth_files = layers_of(truth_folder, truth_frames)
truth = np.stack([layer(p, "") for p in truth_files])
half = np.stack([layer(p, "render2mpeg.Half.") for p in truth_files])
halves = [half, 2 * truth - half]
guide_codes = codes(guide, exposure)
relative_error = np.stack([layer(p, "render2mpeg.Error.", "X")[..., 0] for p in truth_files]) / np.maximum(truth @ WEIGHTS, 1e-9)
halves_codes = [true_codes(h, truth, relative_error, exposure) for h in halves]
noise = np.sqrt(np.mean((halves_codes[0] - halves_codes[1]) ** 2)) / 2


def means(x, side, step):
    """Of squares of `side` pixels, every `step`."""
    rows = np.lib.stride_tricks.sliding_window_view(x, (side, side), (-2, -1))[..., ::step, ::step, :, :]
    return rows.mean((-1, -2))


def smoothed(x):
    padded = np.pad(np.moveaxis(x, -1, 1), ((0, 0), (0, 0), (4, 4), (4, 4)), "edge")
    return np.moveaxis(means(padded, 9, 1), 1, -1)


smooth_truth = guide[places] * smoothed(truth) / np.maximum(smoothed(guide[places]), 1e-9)


def square(errors):
    """Mean square by errors against both halves: none of the truth's noise is in it."""
    return float(np.mean(errors[0] * errors[1]))


def change(errors):
    """Between frames that follow one another; none: 0."""
    pairs = [i for i in range(1, len(places)) if places[i] == places[i - 1] + 1]
    if not pairs or len(errors[0]) != len(places):
        return 0.0
    return np.sqrt(max(square([e[pairs] - e[[i - 1 for i in pairs]] for e in errors]), 0))


def psnr(mean_square):
    return 10 * np.log10(255**2 / max(mean_square, 1e-9))


def coded(frames, q, film):
    """Decoded luma of such frames, coded with the film's own motion, and bytes."""
    motion = layers_of(guide_folder, [first])[0].name.replace(f"{first:04d}", "%04d")
    run("encode", frames / "%04d.exr", "-y", "--exposure", exposure, "-o", film, "--quantiser", q, "--motion", guide_folder / motion)
    return luma(film), film.stat().st_size


class Cycles:
    """Its frames of any number of samples, and what they cost."""
    exponents = range(35)  # samples are powers of the root of two

    def __init__(self, folder):
        a, b = (np.stack([layer(p, "") for p in sorted(folder.glob(f"cycles{seed}_*.exr"))]) for seed in (0, 1))
        self.noise = np.nan_to_num(a - b) / np.sqrt(2) * np.sqrt(given.cycles_samples)
        self.seconds = float((folder / "cycles_film_seconds").read_text())
        self.known = {}

    def loss(self, q, exponent, base):
        if (q, exponent) not in self.known:
            folder = given.work / "cycles"
            write(folder, enumerate(np.maximum(guide + self.noise / np.sqrt(2.0 ** (exponent / 2)), 0), first))
            picture, _ = coded(folder, q, given.work / "cycles.m2v")
            self.known[q, exponent] = base - psnr(np.mean((picture - guide_codes) ** 2))
        return self.known[q, exponent]

    def until(self, q, base, loss):
        """CPU seconds a frame until so many dB are lost: bisected, since they fall with samples."""
        low, high = 0, len(self.exponents)
        while low < high:
            middle = (low + high) // 2
            low, high = (low, middle) if self.loss(q, middle, base) <= loss else (middle + 1, high)
        return self.seconds * 2.0 ** (low / 2)


def before_coding(q):
    """Errors of the film's frames as they were lit, and light and close pixels over the truth's."""
    folder = given.work / f"lit_{q}"
    render(given.work / "lit.m2v", given.frames, "--quantiser", q, "--exposure", exposure, "--aov", folder, *options)
    lit = np.stack([layer(p, "") for p in layers_of(folder, truth_frames)])
    lit_codes = codes(lit, exposure)
    errors = [lit_codes - h for h in halves_codes]
    blocks = square([means(e, 8, 8) for e in errors])
    far = np.abs(lit @ WEIGHTS - smooth_truth @ WEIGHTS) > 0.02 * (smooth_truth @ WEIGHTS)
    return square(errors), blocks, (lit @ WEIGHTS).sum() / (truth @ WEIGHTS).sum(), 1 - far.mean()


cycles = Cycles(given.cycles) if given.cycles else None
write(given.work / "frames", enumerate(guide, first))
print("| film | q | CPU s a frame | PSNR-Y | loss | bytes | flicker | error before coding: all, 8x8, rest | light | within 2 % | truth's noise |")
print("|---|---|---|---|---|---|---|---|---|---|---|")
for q in given.quantisers.split(","):
    film, seconds = given.work / f"film_{q}.m2v", given.work / f"film_{q}.json"
    base_picture, base_bytes = coded(given.work / "frames", q, given.work / f"coded_{q}.m2v")
    base_error = (base_picture - guide_codes)[places]
    base = psnr(np.mean(base_error**2))
    render(film, given.frames, "--quantiser", q, "--threads", 1, "--exposure", exposure, "--stats", seconds, *options)
    errors = [luma(film)[places] - h for h in halves_codes]
    s = json.loads(seconds.read_text())
    cpu = (s["seconds"]["cpu"] - s["seconds"]["load"]) / s["frames"]
    everything, blocks, light, close = before_coding(q)
    flicker = change(errors) / max(change([base_error, base_error]), 1e-9)
    root = lambda x: np.sqrt(max(x, 0))
    row = (f"| {pathlib.Path(given.film).name} | {q} | {cpu:.2f} | {psnr(square(errors)):.2f} | {base - psnr(square(errors)):.2f} dB | "
           f"x{film.stat().st_size / base_bytes:.3f} | x{flicker:.2f} | {root(everything):.2f}, {root(blocks):.2f}, "
           f"{root(everything - blocks):.2f} | {100 * light - 100:+.2f} % | {100 * close:.1f} % | {noise:.2f} |")
    if cycles:
        row += f" {cycles.until(q, base, max(base - psnr(square(errors)), 0.01)):.1f} s | {cycles.until(q, base, 0.25):.1f} s |"
    print(row, flush=True)
