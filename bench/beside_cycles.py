#!/usr/bin/python3
"""Films as people make them by this program and by Cycles with a denoiser, both coded alike: what a quality costs, and how it flickers.

beside_cycles.py [--size 320x180] [--frames A:B] [--spp 8,32,128] [--most-spp 512] [--truth-spp N] [--quantisers 4,8,16]
                 [--work FOLDER] [--page F.html] [--json F] PROGRAM FILM...

FILM: a .blend, a folder of them, or a script of people/ by its name. Each film is rendered by PROGRAM as it is by default, on one
thread, at every quantiser; and by Cycles as the scene sets it up, at every count of samples (and four times as many, up to --most-spp,
where ours is better than that), a seed a frame, in two halves, denoised by people/denoise.py (--denoiser blender: by the
OpenImageDenoise of that Blender, where it has one). Cycles' pictures are coded by `encode` with the same quantisers. Truth is Cycles
without clamps in two more halves, as the scene's view shows it: errors against both halves are multiplied, so that their noise drops
out: not of SSIM, and not where it is so large that the view bends it. What was made is kept in the work folder.

Columns of the first table: CPU seconds (user and system, of all processes) a frame, with export, loading and first frames; of Cycles
without the denoiser's own time. PSNR-Y and SSIM of decoded films against the truth, kB, and flicker: what of the error changes from a
frame to the next along exact motion, in code values. The second has, for each quantiser, Cycles' CPU at our PSNR-Y over ours (between
its counts of samples on straight lines over log CPU, `<` and `>` beyond them) and our flicker over Cycles' there. The third has mean
light of ours over Cycles', and its standard error by the halves' difference; of the darker half of the pixels; of the worst of 4x4
tiles; and shares of our time by effect. The last quantiser's run also writes the layers that this and motion are read from.
Needs Blender with Cycles, ffmpeg, python3-numpy and python3-openimageio."""
import argparse
import hashlib
import json
import pathlib
import resource
import shutil
import subprocess
import sys

import numpy as np
import OpenImageIO as oiio

HERE = pathlib.Path(__file__).resolve().parent
SCRIPTS = HERE / "people"
sys.path.insert(0, str(SCRIPTS))
import denoise  # noqa: E402
import peers_page  # noqa: E402

WEIGHTS = np.array([0.2126, 0.7152, 0.0722])

parser = argparse.ArgumentParser()
parser.add_argument("program")
parser.add_argument("films", nargs="+")
parser.add_argument("--size", default="320x180")
parser.add_argument("--frames", default="0:7")
parser.add_argument("--spp", default="8,32,128")
parser.add_argument("--most-spp", type=int, default=512)
parser.add_argument("--truth-spp", type=int, default=512)
parser.add_argument("--quantisers", default="4,8,16")
parser.add_argument("--codec", default="h264")
parser.add_argument("--denoiser", choices=("regression", "blender"), default="regression")
parser.add_argument("--work", type=pathlib.Path, default=HERE.parent / "build" / "bench-cache" / "people")
parser.add_argument("--page", type=pathlib.Path)
parser.add_argument("--json", type=pathlib.Path)
given = parser.parse_args()
first, last = map(int, given.frames.split(":"))
frames = range(first, last + 1)
width, height = map(int, given.size.split("x"))
quantisers = [int(q) for q in given.quantisers.split(",")]


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


def found_films():
    """(name, .blend) of each film; scripts' files are made, each in a folder named by its text."""
    for film in given.films:
        path = pathlib.Path(film)
        script = SCRIPTS / f"{film}.py"
        if path.is_dir():
            yield from ((p.stem, p) for p in sorted(path.glob("*.blend")))
        elif path.exists():
            yield path.stem, path
        elif script.exists():
            text = (SCRIPTS / "making.py").read_bytes() + script.read_bytes()
            blend = given.work / f"{film}-{hashlib.sha256(text).hexdigest()[:12]}" / f"{film}.blend"
            if not blend.exists():
                blend.parent.mkdir(parents=True, exist_ok=True)
                blender("--python", script, "--", blend)
            yield film, blend
        else:
            raise SystemExit(f"{film}: no .blend, no folder, no script of {SCRIPTS}")


def work_of(blend):
    folder = given.work / f"{blend.stem}-{hashlib.sha256(blend.read_bytes()).hexdigest()[:12]}"
    folder.mkdir(parents=True, exist_ok=True)
    return folder


def cycles(blend, samples, seed, kind):
    """(folder of frames, CPU seconds of all frames, of loading)."""
    script = hashlib.sha256((SCRIPTS / "cycles.py").read_bytes()).hexdigest()[:8]
    folder = work_of(blend) / f"{kind}-{given.size}-{first}-{last}-{samples}-{seed}-{script}"
    taken = folder / "taken.json"
    if not taken.exists():
        every = blender(blend, "-P", SCRIPTS / "cycles.py", "--", folder, samples, given.size, seed, kind, *frames)
        seconds = sum(json.loads((folder / "seconds.json").read_text()))
        taken.write_text(json.dumps([seconds, every - seconds]))
    return folder, *json.loads(taken.read_text())


def channels(path, *names):
    image = oiio.ImageBuf(str(path))
    every = image.spec().channelnames
    at = [next(i for i, c in enumerate(every) if c == name or c.endswith("." + name)) for name in names]
    return image.get_pixels(oiio.FLOAT)[..., at]


def colours(folder, n):
    return channels(folder / f"{n:04d}.exr", "Combined.R" if "own-" in folder.name else "R", "Combined.G" if "own-" in folder.name else "G",
                    "Combined.B" if "own-" in folder.name else "B").astype(float)


def light(folder, pattern="%04d.exr"):
    return np.stack([channels(folder / (pattern % n), "R", "G", "B").astype(float) @ WEIGHTS for n in frames])


def write(path, picture):
    image = oiio.ImageBuf(oiio.ImageSpec(width, height, 3, oiio.FLOAT))
    image.set_pixels(oiio.ROI(), np.ascontiguousarray(picture, np.float32))
    image.write(str(path))


def denoised(blend, samples):
    """(folder of denoised frames, CPU seconds of frames and loading) of so many samples of Cycles."""
    if given.denoiser == "blender":
        folder, seconds, rest = cycles(blend, samples, 3, "denoised")
        return folder, seconds + rest, 0.0
    halves = [cycles(blend, samples // 2, seed, "own") for seed in (3, 4)]
    text = hashlib.sha256((SCRIPTS / "denoise.py").read_bytes()).hexdigest()[:8]
    into = halves[0][0].with_name(halves[0][0].name + "-denoised-" + text)
    for n in frames:
        if (into / f"{n:04d}.exr").exists():
            continue
        into.mkdir(exist_ok=True)
        features = [np.concatenate([channels(f / f"{n:04d}.exr", *(f"Denoising Albedo.{c}" for c in "RGB")),
                                    channels(f / f"{n:04d}.exr", *(f"Denoising Normal.{c}" for c in "XYZ")),
                                    np.minimum(channels(f / f"{n:04d}.exr", "Denoising Depth.Z"), 1e3)], -1) for f, *_ in halves]
        write(into / f"{n:04d}.exr", denoise.denoised([colours(f, n) for f, *_ in halves], (features[0] + features[1]) / 2))
    return into, halves[0][1] + halves[1][1] + halves[0][2], halves[0][1]


def luma(path):
    raw = subprocess.run(["ffmpeg", "-v", "error", "-i", str(path), "-f", "rawvideo", "-pix_fmt", "yuv420p", "-"], stdout=subprocess.PIPE, check=True).stdout
    pictures = np.frombuffer(raw, np.uint8).reshape(-1, height * width + 2 * ((height + 1) // 2) * ((width + 1) // 2))
    return pictures[:, :height * width].reshape(-1, height, width).astype(float)


def shown(folder):
    """Luma of what Blender's view makes of frames."""
    pictures = [oiio.ImageBuf(str(folder / f"{n:04d}.png")).get_pixels(oiio.FLOAT)[..., :3] for n in frames]
    return 16 + 219 * (np.stack(pictures).astype(float) @ (np.array([0.299, 0.587, 0.114]) if height < 720 else WEIGHTS))


def motion_of(layers):
    """(where each pixel's point was in the frame before, whether that is known) of each frame but the first; rows, columns."""
    for n in list(frames)[1:]:
        data = (layers / f"frame_{n:04d}.motion").read_bytes()
        version, _, _, fields = np.frombuffer(data, "<u4", 4, 4)
        values = np.frombuffer(data, "<i2" if version == 2 else "<f4", width * height * 2, 32).reshape(height, width, 2)
        kind = np.frombuffer(data, np.uint8, width * height, 32 + values.nbytes * int(fields)).reshape(height, width)
        step = 32 if version == 2 else 1
        row, column = np.mgrid[:height, :width]
        at = np.rint(row + values[..., 1] / step).astype(int), np.rint(column + values[..., 0] / step).astype(int)
        known = (kind == 1) & (values[..., 0] != -32768) & (at[0] >= 0) & (at[0] < height) & (at[1] >= 0) & (at[1] < width)
        yield np.where(known, at[0], 0), np.where(known, at[1], 0), known


def flicker(pictures, halves, motion):
    squares, count = 0.0, 0
    for n, (row, column, known) in enumerate(motion, 1):
        a, b = (((pictures[n] - h[n]) - (pictures[n - 1] - h[n - 1])[row, column])[known] for h in halves)
        squares, count = squares + np.sum(a * b), count + a.size
    return np.sqrt(max(squares, 0.0) / max(count, 1))


def ssim(a, b):
    """Mean over 8x8 windows, of code values (Wang et al. 2004)."""
    a, b = np.moveaxis(a, 0, -1), np.moveaxis(b, 0, -1)
    mean = [denoise.box(v, 4) for v in (a, b)]
    square = [denoise.box(v * v, 4) - m * m for v, m in zip((a, b), mean)]
    both = denoise.box(a * b, 4) - mean[0] * mean[1]
    return np.mean((2 * mean[0] * mean[1] + 6.5025) * (2 * both + 58.5225) / ((mean[0]**2 + mean[1]**2 + 6.5025) * (square[0] + square[1] + 58.5225)))


def judged(film, seconds, halves, motion):
    pictures = luma(film)
    error = max(np.mean((pictures - halves[0]) * (pictures - halves[1])), 1e-3)
    return {"cpu": seconds / len(frames), "db": 10 * np.log10(255**2 / error), "ssim": ssim(pictures, (halves[0] + halves[1]) / 2),
            "kb": film.stat().st_size / 1000, "flicker": flicker(pictures, halves, motion)}


def ours(blend, quantiser, with_layers):
    """(film, CPU seconds, statistics, layers), with an export of its own; what this program has made before is kept."""
    program = hashlib.sha256(pathlib.Path(given.program).read_bytes()).hexdigest()[:8]
    folder = work_of(blend) / f"ours-{given.size}-{first}-{last}-{given.codec}-{quantiser}-{program}{'-layers' if with_layers else ''}"
    copy, film, statistics, layers, taken = (folder / n for n in ("own.blend", "film.mp4", "film.json", "layers", "taken.json"))
    if not taken.exists():
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir()
        shutil.copy2(blend, copy)
        taken.write_text(json.dumps(run(
            given.program, "render", copy, "-y", "-o", film, "--codec", given.codec, "--quantiser", quantiser, "--size", given.size,
            "--frames", given.frames, "--threads", 1, "--stats", statistics, "--quiet", *(["--aov", layers] if with_layers else []))))
    return film, json.loads(taken.read_text()), json.loads(statistics.read_text()), layers


def coded(folder, said, quantiser):
    film = folder / f"{quantiser}.mp4"
    run(given.program, "encode", folder / "%04d.exr", "-y", "-o", film, "--codec", given.codec, "--view", said["view"], "--exposure", 0,
        "--fps", 24, "--quantiser", quantiser, "--quiet")
    return film


def tiles(pictures):
    rows, columns = np.array_split(np.arange(height), 4), np.array_split(np.arange(width), 4)
    return np.array([[pictures[:, r[0]:r[-1] + 1, c[0]:c[-1] + 1].mean() for c in columns] for r in rows])


def brightness(own, a, b):
    truth = (a + b) / 2
    dark = truth < np.median(truth)
    parts, blocks = tiles(own) / np.maximum(tiles(truth), 1e-9), (tiles(a) - tiles(b)) / 2
    row, column = np.unravel_index(np.argmax(np.abs(np.log(np.maximum(parts, 1e-9)))), parts.shape)
    return {"mean": own.mean() / truth.mean(), "noise": np.sqrt(np.mean(blocks**2)) / 4 / truth.mean(),
            "dark": own[dark].mean() / truth[dark].mean(), "tile": parts[row, column], "tile_at": f"{column + 1},{row + 1}"}


def at_equal_quality(mine, rows):
    """Cycles' CPU over ours, our flicker over Cycles', and whether that lies between its counts: "", or < or >."""
    rows = sorted(rows, key=lambda r: r["cpu"])
    db = np.maximum.accumulate([r["db"] for r in rows])
    sign = "<" if mine["db"] < db[0] else ">" if mine["db"] > db[-1] else ""
    cpu = np.exp(np.interp(mine["db"], db, np.log([r["cpu"] for r in rows])))
    return {"times": cpu / mine["cpu"], "flicker": mine["flicker"] / max(np.interp(mine["db"], db, [r["flicker"] for r in rows]), 1e-6), "sign": sign}


def look(blend):
    halves_of_truth = [cycles(blend, given.truth_spp // 2, seed, "truth")[0] for seed in (1, 2)]
    halves = [shown(f) for f in halves_of_truth]
    made = {q: ours(blend, q, q == quantisers[-1]) for q in quantisers}
    _, _, said, layers = made[quantisers[-1]]
    motion = list(motion_of(layers))
    found = {"ours": {q: judged(film, seconds, halves, motion) for q, (film, seconds, *_) in made.items()}, "cycles": {}, "equal": {}}
    peers = {int(s): denoised(blend, int(s)) for s in given.spp.split(",")}
    best = lambda s: judged(coded(peers[s][0], said, quantisers[0]), 0, halves, motion)["db"]  # noqa: E731
    while best(max(peers)) < found["ours"][quantisers[0]]["db"] and 4 * max(peers) <= given.most_spp:
        peers[4 * max(peers)] = denoised(blend, 4 * max(peers))
    # What a picture costs before its first sample, by a line through the halves' seconds, is there once and not in both halves.
    counts, spent = [s // 2 for s in peers], [p[2] for p in peers.values()]
    before = max(0.0, np.polyfit(counts, spent, 1)[1]) if given.denoiser == "regression" and len(peers) > 1 else 0.0
    for q in quantisers:
        found["cycles"][q] = {s: judged(coded(folder, said, q), seconds - before, halves, motion) for s, (folder, seconds, _) in peers.items()}
        found["equal"][q] = at_equal_quality(found["ours"][q], found["cycles"][q].values())
    found["light"] = brightness(light(layers, "frame_%04d.exr"), *(light(f) for f in halves_of_truth))
    spent = {e["effect"]: e["seconds"] for e in said["effects"] if e["seconds"]}
    found["effects"] = {name: s / sum(spent.values()) for name, s in sorted(spent.items(), key=lambda e: -e[1])}
    if given.page:
        pictures[blend.stem] = peers_page.pictures_of({q: film for q, (film, *_) in made.items()},
                                                      {s: folder / f"{quantisers[0]}.mp4" for s, (folder, *_) in peers.items()}, halves_of_truth[0],
                                                      len(frames) // 2, first)
    return found


def rows_of(name, found):
    for who, q, r in [("ours", q, r) for q, r in found["ours"].items()] + [(f"Cycles {s}", q, r) for q, by in found["cycles"].items() for s, r in by.items()]:
        yield f"| {name} | {who} | {q} | {r['cpu']:.1f} | {r['db']:.1f} | {r['ssim']:.4f} | {r['kb']:.0f} | {r['flicker']:.2f} |"


everything, pictures = {}, {}
for name, blend in found_films():
    everything[name] = look(blend)
    print(*rows_of(name, everything[name]), sep="\n", flush=True)
    if given.json:
        given.json.write_text(json.dumps(everything, indent=1, default=float))
lines = ["| film | by | quantiser | CPU s a frame | PSNR-Y | SSIM | kB | flicker |", "|---|---|---|---|---|---|---|---|"]
lines += [row for name, found in everything.items() for row in rows_of(name, found)]
lines += ["", "| film | " + " | ".join(f"at {q}: Cycles' CPU over ours, our flicker over its" for q in quantisers) + " |", "|---|" + "---|" * len(quantisers)]
lines += [f"| {name} | " + " | ".join(f"{e['sign']} x{e['times']:.2f}, {e['flicker']:.2f}" for e in found["equal"].values()) + " |" for name, found in everything.items()]
lines += ["", "| film | mean light (noise) | darker half | worst tile | shares of our time |", "|---|---|---|---|---|"]
for name, found in everything.items():
    n = found["light"]
    shares = ", ".join(f"{effect} {100 * share:.0f} %" for effect, share in found["effects"].items() if share > 0.02)
    lines += [f"| {name} | {100 * n['mean'] - 100:+.1f} ({100 * n['noise']:.1f}) % | {100 * n['dark'] - 100:+.1f} % | {100 * n['tile'] - 100:+.0f} % ({n['tile_at']}) | {shares} |"]
print("", *lines, sep="\n")
if given.page:
    peers_page.write(given.page, lines, pictures)
