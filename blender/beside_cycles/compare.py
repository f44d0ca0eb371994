# SPDX-License-Identifier: Apache-2.0 OR GPL-3.0-or-later
"""blender -b --factory-startup --disable-autoexec --python-exit-code 1 --python compare.py -- ORDER.json

Windows of a .blend's film by render2mpeg and by Cycles with a denoiser, both coded alike. ORDER.json says `scene`; `render`, words of a
command of render2mpeg that lack frames, size, quantiser and outputs; `codec`; `size`; `windows` of frames; `quantisers` of the codec;
`samples`, ascending counts, the last four times as many up to `most_samples` where ours is better; numbers below 1 are thresholds of
noise; `truth_samples`; `threads`, 0: all; `denoiser`, `blender`, `regression` or `best`, Blender's where it has one; `everything`,
whether CPU seconds are those of exports, loading and frames, or of frames alone; `blender`, words that start it (none: this program);
`by_frame`, whether the seed changes; `guiding`; `folder`, where all that was made is kept and found again; `result`, the file that is
written. Coding counts with both.

The result: `denoiser`; `windows`, each with its `first` and `last` frame, and `all`: `ours` by quantiser, `cycles` by quantiser and
count of samples, `equal` by quantiser (judge.py), `light`, `psnr_y_by`; `effects`: shares of our time. Halves with seeds of their own make the truth
(Cycles without clamps), and what is denoised. Where the stand-in for a denoiser does harm, its input counts, and its time never. Steps are told on standard error."""
import hashlib
import json
import os
import pathlib
import resource
import shutil
import subprocess
import sys
import time

import bpy
import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
sys.dont_write_bytecode = True
sys.path.insert(0, str(HERE))
import denoise  # noqa: E402
import exr  # noqa: E402
import installed  # noqa: E402
import judge  # noqa: E402

WEIGHTS = np.array([0.2126, 0.7152, 0.0722])
ORDER = json.loads(pathlib.Path(sys.argv[sys.argv.index("--") + 1]).read_text())
SCENE, FOLDER = pathlib.Path(ORDER["scene"]), pathlib.Path(ORDER["folder"])
WIDTH, HEIGHT = ORDER["size"]
CODEC, PROGRAM = ORDER["codec"], ORDER["render"][0]
BITS = 10 if CODEC in ("hevc", "av1") else 8
BLENDER = ORDER.get("blender") or [bpy.app.binary_path]
if ORDER["threads"]:  # As many cores, for all that is started: Blender's own thread turns while its others render, and its seconds would count.
    os.sched_setaffinity(0, sorted(os.sched_getaffinity(0))[:ORDER["threads"]])


class Failed(Exception):
    pass


class Steps:
    """Tells steps with the time to go, by samples of Cycles; a run of ours counts as many as `OURS`, until more is known."""
    OURS = 256

    def __init__(self):
        self.begin, self.done, self.now = time.monotonic(), 0, 0
        self.of_window = ORDER["truth_samples"] + self.OURS + sum(map(work_of, ORDER["samples"]))

    def __call__(self, name, text, samples):
        self.done, self.now = self.done + self.now, samples
        gone = time.monotonic() - self.begin
        left = gone / max(self.done, 1) * max(self.of_window * len(ORDER["windows"]) - self.done, samples)
        if not ORDER.get("quiet"):
            print(f"{clock(gone)} {name}: {text}" + (f"; about {clock(left)} to go" if self.done else ""), file=sys.stderr, flush=True)


def work_of(samples):
    """Samples that a threshold of noise stands for: a guess, by which the time to go is told."""
    return samples if samples >= 1 else 12 / samples


def setting_of(samples):
    return f"{samples} samples" if samples >= 1 else f"noise {samples:g}"


def clock(seconds):
    return f"{int(seconds) // 60}:{int(seconds) % 60:02d}"


def run(*words, folder=None):
    """CPU seconds of a child and all of its own; in this folder or the current one."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run([str(w) for w in words], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, cwd=folder)
    if done.returncode:
        said = [line for line in done.stdout.splitlines() if line.strip()]
        raise Failed(f"{pathlib.Path(words[0]).name}: {said[-1] if said else 'failed without a word'}")
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def key_of(*parts):
    return hashlib.sha256(json.dumps(parts, default=str).encode()).hexdigest()[:12]


PANORAMAS = {"equirectangular": (0, 0, 0, 0), "vr180": (0.25, 0, 0.25, 0)}  # shares of the sphere left off at the left, top, right, bottom


def view_of(film):
    """Words of a film's container about its pictures: (options that have `encode` say the same, size, weights of its rows)."""
    words = [PROGRAM, "info", "--json", "--summary", str(film)]
    said = json.loads(subprocess.run(words, stdout=subprocess.PIPE, check=True).stdout)
    shown, packing = said["panorama"], said["stereo"]
    options = ["--stereo", packing] if packing else []
    for name, bounds in PANORAMAS.items():
        if shown and np.allclose(shown, bounds, atol=1e-6):
            options += ["--projection", name]
    below, beside = packing == "top-bottom", packing == "side-by-side"
    return options, (WIDTH * (1 + beside), HEIGHT * (1 + below)), np.tile(judge.weights_of_rows(HEIGHT, shown), 1 + below)


def text_of(name):
    return hashlib.sha256((HERE / name).read_bytes()).hexdigest()


class Window:
    """Frames `first` to `last`, and what was made of them."""

    def __init__(self, first, last):
        self.first, self.last, self.frames = first, last, range(first, last + 1)

    def made(self, make, *key):
        """A folder of its own that `make` fills, unless it is there; (folder, what `make` returned)."""
        folder = FOLDER / f"{key[0]}-{self.first}-{self.last}-{key_of(*key, ORDER['size'], str(SCENE), SCENE.stat().st_mtime_ns)}"
        taken = folder / "taken.json"
        if not taken.exists():
            shutil.rmtree(folder, ignore_errors=True)
            folder.mkdir(parents=True)
            taken.write_text(json.dumps(make(folder)))
        return folder, json.loads(taken.read_text())

    def cycles(self, samples, seed, kind):
        """(folder of frames, [CPU seconds of frames, of loading])."""
        says = {"samples": samples, "seed": seed, "kind": kind, "size": [WIDTH, HEIGHT], "threads": ORDER["threads"],
                "by_frame": kind == "truth" or ORDER.get("by_frame", True), "guiding": kind != "truth" and ORDER.get("guiding", False)}
        says |= {} if kind == "truth" else {"cores": len(os.sched_getaffinity(0))}

        def make(folder):
            every = run(*BLENDER, "--background", "--factory-startup", "--disable-autoexec", "-noaudio", "--python-exit-code", 1,
                        "-P", HERE / "frames.py", "--", SCENE, folder, json.dumps(says), *self.frames, folder=folder)
            seconds = sum(json.loads((folder / "seconds.json").read_text()))
            return [seconds, every - seconds]
        return self.made(make, kind, json.dumps(says), text_of("frames.py"), bpy.app.version_string)

    def denoised(self, samples):
        """(folders of frames, denoised and not, the better of which counts; CPU seconds of frames, of loading)."""
        if DENOISER == "blender":
            folder, (seconds, loading) = self.cycles(samples, 3, "denoised")
            return [folder], seconds, loading
        halves = [self.cycles(samples // 2, seed, "own") for seed in (3, 4)]

        def make(folder):
            for n in self.frames:
                layers = [exr.read(h / f"{n:04d}.exr") for h, _ in halves]
                pick = lambda said, *ends: np.stack([next(v for c, v in said.items() if c.endswith(e)) for e in ends], -1)  # noqa: E731
                features = [np.concatenate([pick(said, *(f"Denoising Albedo.{c}" for c in "RGB"), *(f"Denoising Normal.{c}" for c in "XYZ")),
                                            np.minimum(pick(said, "Denoising Depth.Z"), 1e3)], -1) for said in layers]
                light = [pick(said, "Combined.R", "Combined.G", "Combined.B") for said in layers]
                exr.write(folder / f"{n:04d}.exr", exr.rgb(denoise.denoised(light, (features[0] + features[1]) / 2)))
                (folder / "plain").mkdir(exist_ok=True)
                exr.write(folder / "plain" / f"{n:04d}.exr", exr.rgb((light[0] + light[1]) / 2))
        folder, _ = self.made(make, "regression", samples, *(str(h) for h, _ in halves), text_of("denoise.py"))
        return [folder, folder / "plain"], halves[0][1][0] + halves[1][1][0], halves[0][1][1]

    def together(self, *halves):
        """A folder of the halves' means."""
        def make(folder):
            for n in self.frames:
                a, b = (exr.read(half / f"{n:04d}.exr") for half in halves)
                exr.write(folder / f"{n:04d}.exr", {c: (a[c] + b[c]) / 2 for c in "RGB"})
        return self.made(make, "mean", *map(str, halves))[0]

    def ours(self, quantiser, layers=False):
        """(folder with film.mkv, film.json and layers, CPU seconds)."""
        program = pathlib.Path(PROGRAM).stat()

        def make(folder):
            if ORDER["everything"]:
                shutil.rmtree(str(SCENE) + ".export", ignore_errors=True)
            return run(*ORDER["render"], "-y", "-o", folder / "film.mkv", "--frames", f"{self.first}:{self.last}", "--size", f"{WIDTH}x{HEIGHT}", "--quantiser",
                       quantiser, "--stats", folder / "film.json", "--quiet", *(["--aov", folder / "layers"] if layers else []))
        folder, seconds = self.made(make, "layers" if layers else "ours", quantiser, ORDER["render"], program.st_size, program.st_mtime_ns)
        said = json.loads((folder / "film.json").read_text())
        return folder, seconds if ORDER["everything"] else max(seconds - said["seconds"]["load"], 1e-3), said

    def coded(self, frames, said, codec, *options):
        """(a film of a folder's frames, as ours shows them; CPU seconds)."""
        film = frames / f"{codec}-{'-'.join(map(str, options))}-{key_of(said['view'], said['exposure'])}.mkv"
        taken = film.with_suffix(".json")
        if not taken.exists():
            seconds = run(PROGRAM, "encode", frames / "%04d.exr", "-y", "-o", film, "--codec", codec, "--view", said["view"], "--exposure", said["exposure"],
                          "--fps", said["fps"], "--frames", f"{self.first}:{self.last}", "--threads", ORDER["threads"], "--quiet", *options)
            taken.write_text(json.dumps(seconds))
        return film, json.loads(taken.read_text())

    def light(self, folder, pattern="%04d.exr"):
        found = [exr.read(folder / (pattern % n)) for n in self.frames]
        return np.stack([np.stack([said[c] for c in "RGB"], -1).astype(float) @ WEIGHTS for said in found])

    def look(self):
        quantisers = ORDER["quantisers"]
        name = f"frames {self.first} to {self.last}"
        told(name, f"the truth, {ORDER['truth_samples']} samples of Cycles", ORDER["truth_samples"])
        truth = [self.cycles(ORDER["truth_samples"] // 2, seed, "truth")[0] for seed in (1, 2)]
        told(name, "render2mpeg", told.OURS)
        ours = {q: self.ours(q, layers=q == quantisers[-1]) for q in quantisers}
        layers, _, said = ours[quantisers[-1]]
        told_to_encode, size, weights = view_of(layers / "film.mkv")
        motion = list(judge.motion_of(layers / "layers", self.frames, *size))
        halves = [judge.luma(self.coded(folder, said, "ffv1")[0], *size, 12) for folder in truth]

        whole = self.coded(self.together(*truth), said, "ffv1")[0]

        def judged(film, seconds):
            others = {"xpsnr_y": installed.xpsnr(film, whole, size[0] * size[1]), "ssimulacra2": installed.ssimulacra2(film, whole)}
            return judge.judged(judge.luma(film, *size, BITS), film.stat().st_size, halves, motion, weights) | others | {"cpu": seconds}

        own = {q: judged(folder / "film.mkv", seconds) for q, (folder, seconds, _) in ours.items()}
        peers = {}

        def try_samples(count):
            if count not in ORDER["samples"]:
                told.of_window += count
            told(name, f"Cycles, {setting_of(count)}, denoised", work_of(count))
            folders, seconds, loading = self.denoised(count)
            every = {q: [self.coded(folder, said, CODEC, "--quantiser", q, *told_to_encode) for folder in folders] for q in quantisers}
            spent = seconds + (loading if ORDER["everything"] else 0)
            rows = {q: [judged(film, spent + coding) for film, coding in films] for q, films in every.items()}
            better = min(range(len(folders)), key=lambda k: rows[quantisers[0]][k]["squares"])
            peers[count] = folders[better], seconds, {q: min(by, key=lambda row: row["squares"]) for q, by in rows.items()}

        for count in ORDER["samples"]:
            try_samples(count)
        while peers[max(peers)][2][quantisers[0]]["squares"] > own[quantisers[0]]["squares"] and 4 * max(peers) <= ORDER["most_samples"]:
            try_samples(4 * max(peers))
        if DENOISER == "regression" and len(peers) > 1:
            # What a picture costs before its first sample, by a line through the halves' seconds, is there once and not in both halves.
            before = max(0.0, np.polyfit([s // 2 for s in peers], [p[1] for p in peers.values()], 1)[1]) / 2
            for _, _, rows in peers.values():
                for row in rows.values():
                    row["cpu"] = max(row["cpu"] - before, 1e-3)
        self.sums = own, {count: rows for count, (_, _, rows) in peers.items()}
        effects = {e["effect"]: e["seconds"] for e in said["effects"] if e["seconds"]}
        return {"first": self.first, "last": self.last, **figures([self.sums]), "light": judge.brightness(self.light(layers / "layers", "frame_%04d.exr"), *map(self.light, truth)),
                "effects": {effect: seconds / max(sum(effects.values()), 1e-9) for effect, seconds in sorted(effects.items(), key=lambda e: -e[1])},
                "films": {"ours": {q: str(f / "film.mkv") for q, (f, *_) in ours.items()}, "cycles": {c: str(self.coded(p[0], said, CODEC, "--quantiser", quantisers[0], *told_to_encode)[0]) for c, p in peers.items()},
                          "truth": str(whole)},
                "psnr_y_by": "pixels" if np.all(weights == 1) else "solid angle", "truth_psnr_y": judge.noise_of(halves, weights)}


def figures(sums):
    """Of windows' sums; of Cycles by the counts that all of them have."""
    counts = sorted(set.intersection(*(set(cycles) for _, cycles in sums)))
    ours = {q: judge.together([own[q] for own, _ in sums]) for q in ORDER["quantisers"]}
    cycles = {q: {c: judge.together([by[c][q] for _, by in sums]) for c in counts} for q in ours}
    return {"ours": ours, "cycles": cycles, "equal": {q: judge.at_equal_quality(ours[q], cycles[q].values()) for q in ours}}


def denoiser_here():
    try:
        import _cycles  # Blender's own
    except ImportError:
        raise Failed(f"Blender {bpy.app.version_string} has no Cycles: name another by --blender") from None
    return "blender" if getattr(_cycles, "with_openimagedenoise", False) else "regression"


told = Steps()
try:
    here = denoiser_here()
    DENOISER = here if ORDER["denoiser"] == "best" else ORDER["denoiser"]
    windows = [Window(first, last) for first, last in ORDER["windows"]]
    found = [window.look() for window in windows]
    result = {"blender": bpy.app.version_string, "denoiser": DENOISER,
              "light_tree": bool(getattr(bpy.context.scene.cycles, "use_light_tree", False)), "windows": found, "all": figures([window.sums for window in windows])}
except (Failed, OSError, ValueError, subprocess.SubprocessError) as failure:
    result = {"error": str(failure)}
temporary = pathlib.Path(ORDER["result"] + ".new")
temporary.write_text(json.dumps(result, indent=1, default=float))
os.replace(temporary, ORDER["result"])
