#!/usr/bin/python3
"""Films as people make them by this program and by Cycles with a denoiser, both coded alike: what a quality costs, and how it flickers.

beside_cycles.py [--peer bpy|debian] [--python PATH] [--size 320x180] [--frames A:B] [--spp 8,32,128] [--noise .1,.05] [--most-spp 512] [--truth-spp N]
                 [--seed by-frame|fixed] [--guiding] [--around] [--quantisers 4,8,16] [--codec C] [--work FOLDER] [--page F.html] [--json F] [--csv F] PROGRAM FILM...

FILM: a .blend, a folder of them, or a script of people/ by its name. It is what `compare --beside cycles` does (blender/beside_cycles),
of one window, on one thread, at several quantisers, with CPU seconds of everything: start, exports, loading, first frames, denoising,
coding. What was made is kept in the work folder.

--peer bpy is Blender as users have it: the module bpy of the Python PATH (or RENDER2MPEG_BPY), OpenImageDenoise with albedo and normal,
prefiltered accurately, light tree and persistent data; it exports our films, too. --around
makes them panoramas for both eyes (people/around.py), whose PSNR-Y counts by solid angle. Counts of samples (--spp) are fixed, --noise are
thresholds of adaptive sampling. --peer debian is the Blender of the PATH, whose stand-in for a denoiser takes time that does not count.

Columns of the first table: CPU seconds (user and system, of all processes) a frame; PSNR-Y and SSIM of decoded films against the truth,
kB, and flicker: what of the error changes from a frame to the next along exact motion, in code values. The second has, for each
quantiser, Cycles' CPU at our PSNR-Y over ours (between its counts of samples on straight lines over log CPU, `<` and `>` beyond them)
and our flicker over Cycles' there. PSNR is without the truth's own noise, which the third tells. The third has mean light of ours over Cycles', and its standard error by the halves' difference; of
the darker half of the pixels; of the worst of 4x4 tiles; and shares of our time by effect. Needs Blender with Cycles and ffmpeg; says so and ends where there is no bpy."""
import argparse
import hashlib
import json
import os
import pathlib
import shutil
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
SCRIPTS = HERE / "people"
sys.path.insert(0, str(SCRIPTS))
import peers_page  # noqa: E402

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
parser.add_argument("--peer", choices=("bpy", "debian"), default="debian")
parser.add_argument("--python", default=os.environ.get("RENDER2MPEG_BPY", "python3"))
parser.add_argument("--noise", default="")
parser.add_argument("--seed", choices=("by-frame", "fixed"), default="by-frame")
parser.add_argument("--guiding", action="store_true")
parser.add_argument("--around", action="store_true")
parser.add_argument("--work", type=pathlib.Path, default=HERE.parent / "build" / "bench-cache" / "people")
parser.add_argument("--page", type=pathlib.Path)
parser.add_argument("--json", type=pathlib.Path)
parser.add_argument("--csv", type=pathlib.Path)
given = parser.parse_args()
given.work = given.work.resolve()
given.work.mkdir(parents=True, exist_ok=True)
first, last = map(int, given.frames.split(":"))
quantisers = given.quantisers.split(",")


samples = [*map(int, given.spp.split(",")), *(float(n) for n in given.noise.split(",") if n)]


def started_blender():
    """Words that start the peer's Blender; of a module by a program in the work folder, which exports our films."""
    if given.peer == "debian":
        if given.noise:
            parser.error("--noise and --peer debian: its stand-in for a denoiser wants two halves of a fixed count")
        return ["blender"]
    found = subprocess.run([given.python, "-c", "import bpy"], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True) if shutil.which(given.python) else None
    if not found or found.returncode:
        print(f"skipped: {given.python} has no module bpy (--python, RENDER2MPEG_BPY)")
        raise SystemExit(0)
    program = given.work.resolve() / "blender-by-bpy"
    program.parent.mkdir(parents=True, exist_ok=True)
    program.write_text(f'#!/bin/sh\nexec "{shutil.which(given.python)}" "{HERE.parent}/blender/bpy_program.py" "$@"\n')
    program.chmod(0o755)
    os.environ["RENDER2MPEG_BLENDER"] = str(program)
    return [str(program)]


def blender(*words):
    subprocess.run([*BLENDER, "--background", "--factory-startup", "-noaudio", "--python-exit-code", "1", *map(str, words)], stdout=subprocess.DEVNULL, check=True, cwd=given.work)


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
            blend = given.work / f"{film}-{given.peer}-{hashlib.sha256(text).hexdigest()[:12]}" / f"{film}.blend"
            if not blend.exists():
                blend.parent.mkdir(parents=True, exist_ok=True)
                blender("--python", script, "--", blend)
            yield film, blend
        else:
            raise SystemExit(f"{film}: no .blend, no folder, no script of {SCRIPTS}")


def around(blend):
    told = hashlib.sha256(f"{blend} {blend.stat().st_mtime_ns}".encode()).hexdigest()[:12]
    made = given.work / f"{blend.stem}-around-{told}.blend"
    if not made.exists():
        blender("--disable-autoexec", blend, "--python", SCRIPTS / "around.py", "--", made)
    return made


def look(blend):
    blend = blend.resolve()
    folder = given.work / f"{blend.stem}-films"
    folder.mkdir(parents=True, exist_ok=True)
    order = {"scene": str(blend), "render": [str(pathlib.Path(given.program).resolve()), "render", str(blend), "--codec", given.codec, "--threads", "1"],
             "codec": given.codec, "size": list(map(int, given.size.split("x"))), "windows": [[first, last]], "quantisers": list(map(int, quantisers)),
             "samples": samples, "most_samples": given.most_spp, "truth_samples": given.truth_spp, "threads": 1, "blender": BLENDER,
             "by_frame": given.seed == "by-frame", "guiding": given.guiding, "denoiser": "blender" if given.peer == "bpy" else "regression", "everything": True, "folder": str(folder), "result": str(folder / "result.json")}
    (folder / "order.json").write_text(json.dumps(order))
    blender("--disable-autoexec", "--python", HERE.parent / "blender" / "beside_cycles" / "compare.py", "--", folder / "order.json")
    found = json.loads((folder / "result.json").read_text())
    if "error" in found:
        raise SystemExit(f"{blend}: {found['error']}")
    return found["windows"][0]


def settings_of(found):
    """(who, quantiser, figures) of all that was made of a film."""
    rows = [("ours", q, r) for q, r in found["ours"].items()]
    named = lambda s: f"Cycles {s}" if float(s) >= 1 else f"Cycles, noise {s}"  # noqa: E731
    return rows + [(named(s), q, r) for q, by in found["cycles"].items() for s, r in sorted(by.items(), key=lambda row: float(row[0]))]


def rows_of(name, found):
    rows = settings_of(found)
    return [f"| {name} | {who} | {q} | {r['cpu']:.1f} | {r['psnr_y']:.1f} | {r['ssim_y']:.4f} | {r['bytes'] / 1000:.0f} | {r['flicker']:.2f} |" for who, q, r in rows]


BLENDER = started_blender()
everything, pictures = {}, {}
for name, blend in found_films():
    everything[name] = found = look(around(blend) if given.around else blend)
    print(*rows_of(name, found), sep="\n", flush=True)
    if given.json:
        given.json.write_text(json.dumps(everything, indent=1))
    if given.page:
        pictures[name] = peers_page.pictures_of(found["films"], (last - first) // 2)
lines = ["| film | by | quantiser | CPU s a frame | PSNR-Y | SSIM | kB | flicker |", "|---|---|---|---|---|---|---|---|"]
lines += [row for name, found in everything.items() for row in rows_of(name, found)]
lines += ["", "| film | " + " | ".join(f"at {q}: Cycles' CPU over ours, our flicker over its" for q in quantisers) + " |", "|---|" + "---|" * len(quantisers)]
lines += [f"| {name} | " + " | ".join(f"{e['beyond']} x{e['times']:.2f}, {e['flicker']:.2f}" for e in found["equal"].values()) + " |" for name, found in everything.items()]
lines += ["", "| film | truth's own PSNR-Y | mean light (noise) | darker half | worst tile | shares of our time |", "|---|---|---|---|---|---|"]
for name, found in everything.items():
    n = found["light"]
    shares = ", ".join(f"{effect} {100 * share:.0f} %" for effect, share in found["effects"].items() if share > 0.02)
    column, row = n["tile_at"]
    lines += [f"| {name} | {found['truth_psnr_y']:.1f} | {100 * n['mean'] - 100:+.1f} ({100 * n['noise']:.1f}) % | {100 * n['dark'] - 100:+.1f} % | {100 * n['tile'] - 100:+.0f} % ({column},{row}) | {shares} |"]
print("", *lines, sep="\n")
if given.csv:
    with open(given.csv, "w") as file:
        print("film,by,quantiser,CPU s a frame,PSNR-Y,SSIM,bytes,flicker,truth's own PSNR-Y,mean light over the truth's", file=file)
        for name, found in everything.items():
            for who, q, r in settings_of(found):
                print(f"{name},\"{who}\",{q},{r['cpu']:.2f},{r['psnr_y']:.2f},{r['ssim_y']:.4f},{r['bytes']},{r['flicker']:.3f},"
                      f"{found['truth_psnr_y']:.2f},{found['light']['mean']:.4f}", file=file)
if given.page:
    peers_page.write(given.page, lines, pictures)
