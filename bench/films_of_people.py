#!/usr/bin/python3
"""Films as Blender's users make them beside Cycles: what they cost, how bright they are, and how near to the truth.

films_of_people.py [--films a,b] [--size 160x90] [--frames A:B] [--spp 96] [--truth-spp N] [--work FOLDER] [--json F] PROGRAM

Films are scripts of people/. Each is rendered with the default settings on one thread, and by Cycles with 96 samples and, twice, with
half of N. Cycles' pictures are kept in the work folder: a second run needs only ours. What Blender's view shows of the truth is
held against decoded films; Cycles' 96 samples are coded as ours are, by `encode`. Two halves of the truth have independent noise, so that errors against both are multiplied.

Columns: CPU seconds (user and system, of all processes) of export and loading, the first frame, the mean later frame; of Cycles a frame
and all the rest; ours over Cycles' of a later frame. Mean light of ours over Cycles', its standard error by the halves' difference; of the
darker half of the pixels; the worst of 4x4 tiles (column and row from the left top). PSNR-Y against the truth, decoded, of ours, of
Cycles' 96 samples and of the truth itself; ours less Cycles'. A second table has the shares of our time by effect.
Needs Blender with Cycles, ffmpeg, python3-numpy and python3-openimageio."""
import argparse
import hashlib
import json
import pathlib
import resource
import shutil
import subprocess

import numpy as np
import OpenImageIO as oiio

HERE = pathlib.Path(__file__).resolve().parent
SCRIPTS = HERE / "people"
FILMS = ("turntable", "porcelain", "head", "yard", "room", "street")
WEIGHTS = np.array([0.2126, 0.7152, 0.0722])

parser = argparse.ArgumentParser()
parser.add_argument("program")
parser.add_argument("--films", default=",".join(FILMS))
parser.add_argument("--size", default="160x90")
parser.add_argument("--frames", default="0:1")
parser.add_argument("--spp", type=int, default=96)
parser.add_argument("--truth-spp", type=int, default=1024)
parser.add_argument("--work", type=pathlib.Path, default=HERE.parent / "build" / "bench-cache" / "people")
parser.add_argument("--json", type=pathlib.Path)
given = parser.parse_args()
first, last = map(int, given.frames.split(":"))
width, height = map(int, given.size.split("x"))


def run(*words):
    """CPU seconds of a child and all of its own."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run([str(w) for w in words], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    if done.returncode:
        raise SystemExit(f"{' '.join(map(str, words))}\n{done.stdout}")
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def blender(*words):
    return run("blender", "--background", "--factory-startup", "-noaudio", "--python-exit-code", "1", *words)


def made(name):
    """The .blend of a script as it is now, in a folder of its own."""
    text = (SCRIPTS / "making.py").read_bytes() + (SCRIPTS / "cycles.py").read_bytes() + (SCRIPTS / f"{name}.py").read_bytes()
    folder = given.work / f"{name}-{hashlib.sha256(text).hexdigest()[:12]}"
    blend = folder / f"{name}.blend"
    if not blend.exists():
        folder.mkdir(parents=True, exist_ok=True)
        blender("--python", SCRIPTS / f"{name}.py", "--", blend)
    return blend


def cycles(blend, samples, seed):
    """(folder of frames, CPU seconds of a frame, of the rest)."""
    folder = blend.parent / f"cycles-{given.size}-{first}-{last}-{samples}-{seed}"
    taken = folder / "taken.json"
    if not taken.exists():
        every = blender(blend, "-P", SCRIPTS / "cycles.py", "--", folder, samples, given.size, seed, *range(first, last + 1))
        frames = json.loads((folder / "seconds.json").read_text())
        taken.write_text(json.dumps([sum(frames) / len(frames), every - sum(frames)]))
    return folder, *json.loads(taken.read_text())


def light(folder, pattern):
    frames = []
    for n in range(first, last + 1):
        image = oiio.ImageBuf(str(folder / (pattern % n)))
        at = [image.spec().channelnames.index(c) for c in "RGB"]
        frames.append(image.get_pixels(oiio.FLOAT)[..., at].astype(float) @ WEIGHTS)
    return np.stack(frames)


def luma(path):
    raw = subprocess.run(["ffmpeg", "-v", "error", "-i", str(path), "-f", "rawvideo", "-pix_fmt", "yuv420p", "-"], stdout=subprocess.PIPE, check=True).stdout
    pictures = np.frombuffer(raw, np.uint8).reshape(-1, height * width + 2 * ((height + 1) // 2) * ((width + 1) // 2))
    return pictures[:, :height * width].reshape(-1, height, width).astype(float)


def coded(folder, view, film):
    run(given.program, "encode", folder / "%04d.exr", "-y", "-o", film, "--view", view, "--exposure", 0, "--fps", 24, "--quantiser", 4, "--quiet")
    return luma(film)


def shown(folder):
    """Luma of what Blender's view makes of frames."""
    pictures = [oiio.ImageBuf(str(folder / f"{n:04d}.png")).get_pixels(oiio.FLOAT)[..., :3] for n in range(first, last + 1)]
    return 16 + 219 * (np.stack(pictures).astype(float) @ (np.array([0.299, 0.587, 0.114]) if height < 720 else WEIGHTS))


def psnr(picture, halves):
    return 10 * np.log10(255**2 / max(np.mean((picture - halves[0]) * (picture - halves[1])), 1e-3))


def tiles(frames):
    rows, columns = np.array_split(np.arange(height), 4), np.array_split(np.arange(width), 4)
    return np.array([[frames[:, r[0]:r[-1] + 1, c[0]:c[-1] + 1].mean() for c in columns] for r in rows])


def mean_of_both(folders, into):
    into.mkdir(exist_ok=True)
    for n in range(first, last + 1):
        a, b = (oiio.ImageBuf(str(f / f"{n:04d}.exr")).get_pixels(oiio.FLOAT)[..., :3] for f in folders)
        image = oiio.ImageBuf(oiio.ImageSpec(width, height, 3, oiio.FLOAT))
        image.set_pixels(oiio.ROI(), np.ascontiguousarray((a + b) / 2, np.float32))
        image.write(str(into / f"{n:04d}.exr"))


def look(name):
    blend = made(name)
    folder = blend.parent
    few, seconds, rest = cycles(blend, given.spp, 0)
    half_folders = [cycles(blend, given.truth_spp // 2, seed)[0] for seed in (1, 2)]
    # Ours, with an export of its own.
    shutil.rmtree(f"{blend}.export", ignore_errors=True)
    film, layers, statistics = folder / "ours.m2v", folder / "ours", folder / "ours.json"
    shutil.rmtree(layers, ignore_errors=True)
    every = run(given.program, "render", blend, "-y", "-o", film, "--size", given.size, "--frames", given.frames, "--threads", 1,
                "--aov", layers, "--stats", statistics, "--quiet")
    said = json.loads(statistics.read_text())
    ours = [f["seconds"] for f in said["per_frame"]]
    later = sum(ours[1:]) / (len(ours) - 1) if len(ours) > 1 else ours[0]
    # Hold the light against Cycles'.
    a, b = (light(f, "%04d.exr") for f in half_folders)
    truth, own = (a + b) / 2, light(layers, "frame_%04d.exr")
    dark = truth < np.median(truth)
    parts = tiles(own) / np.maximum(tiles(truth), 1e-9)
    row, column = np.unravel_index(np.argmax(np.abs(np.log(np.maximum(parts, 1e-9)))), parts.shape)
    blocks = (tiles(a) - tiles(b)) / 2
    # Hold the decoded pictures against Cycles', in the film's own codes.
    mean_of_both(half_folders, folder / "truth")
    halves = [shown(f) for f in half_folders]
    numbers = {
        "load": every - sum(ours), "first": ours[0], "later": later, "cycles": seconds, "cycles_rest": rest, "times": later / seconds,
        "mean": own.mean() / truth.mean(), "noise": np.sqrt(np.mean(blocks**2)) / 4 / truth.mean(), "dark": own[dark].mean() / truth[dark].mean(),
        "tile": parts[row, column], "tile_at": f"{column + 1},{row + 1}", "tiles": np.round(parts, 4).tolist(),
        "db": psnr(luma(film), halves), "cycles_db": psnr(coded(few, said["view"], folder / "few.m2v"), halves),
        "truth_db": psnr(coded(folder / "truth", said["view"], folder / "truth.m2v"), halves)}
    spent = {e["effect"]: e["seconds"] for e in said["effects"] if e["seconds"]}
    numbers["effects"] = {name: s / sum(ours) for name, s in sorted(spent.items(), key=lambda e: -e[1])}
    return numbers


table, found = [], {}
for name in given.films.split(","):
    n = found[name] = look(name)
    table.append(f"| {name} | {n['load']:.1f}, {n['first']:.1f}, {n['later']:.1f} | {n['cycles']:.1f}, {n['cycles_rest']:.1f} | x{n['times']:.2f} | "
                 f"{100 * n['mean'] - 100:+.1f} ({100 * n['noise']:.1f}) % | {100 * n['dark'] - 100:+.1f} % | {100 * n['tile'] - 100:+.0f} % ({n['tile_at']}) | "
                 f"{n['db']:.1f}, {n['cycles_db']:.1f}, {n['truth_db']:.1f} dB | {n['db'] - n['cycles_db']:+.1f} dB |")
    print(table[-1], flush=True)
    if given.json:
        given.json.write_text(json.dumps(found, indent=1))
print("\n| film | export and loading, first, later frame: CPU s | Cycles' frame, rest | ours over Cycles' | mean light (noise) | darker half | worst tile | "
      "ours, Cycles', truth coded | ours less Cycles' |\n|---|---|---|---|---|---|---|---|---|", *table, sep="\n")
print("\n| film | shares of our time |\n|---|---|")
for name, n in found.items():
    print(f"| {name} | " + ", ".join(f"{effect} {100 * share:.0f} %" for effect, share in n["effects"].items() if share > 0.02) + " |")
