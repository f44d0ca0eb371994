#!/usr/bin/env python3
"""bench/estimates.py OUT_FOLDER [--within TIME] [NAME... | NAME=SCENE,OPTIONS...]

What `render --dry-run` says that films take, held against the films: a row for each of twelve, as docs/measurements.md#estimates has them.
Films that OUT_FOLDER has are taken from there, each with what its making took, so that only dry runs are made anew. Films
are elementary streams: a program stream's packs are as large as some of them. Times are CPU seconds. `--within` is that of
the dry run (10s): where others share the machine, it takes more to light as much. RENDER2MPEG names another program than
build/release/render2mpeg. A quarter of an hour on two cores.
"""
import json
import os
import pathlib
import re
import subprocess
import sys
import time

HERE = pathlib.Path(__file__).resolve().parent
PROGRAM = os.environ.get("RENDER2MPEG", str(HERE / "../build/release/render2mpeg"))
ANIMATIONS = HERE / "../animations"

# Name, scene, options.
FILMS = [
    ("cornell", "cornell", "--size 128x128 --frames 0:23"),
    ("still_room", "still_room", "--size 192x108 --frames 0:23"),
    ("character", "character", "--size 128x72 --frames 0:23"),
    ("colonnade", "colonnade", "--size 128x72 --frames 0:23"),
    ("flash_cut", "flash_cut", "--size 112x64"),
    ("many_lamps", "many_lamps", "--size 96x54 --frames 0:23"),
    ("mirror_and_glass", "mirror_and_glass", "--size 96x54 --frames 0:23"),
    ("rack_focus", "rack_focus", "--size 128x72 --frames 0:23"),
    ("ring_and_lens", "ring_and_lens", "--size 96x54 --frames 0:23"),
    ("wheel", "wheel", "--size 128x72 --frames 0:23"),
    ("studio", "character/figure.gltf", "--size 128x128 --frames 0:23"),
    ("coarse", "cornell", "--size 96x96 --frames 24:47 --quantiser 16 --tolerance fixed=4%"),
]


def run(words):
    """What the program prints, CPU seconds, seconds on the clock."""
    before, began = os.times(), time.monotonic()
    done = subprocess.run([PROGRAM, *words], capture_output=True, text=True, check=True)
    after = os.times()
    cpu = after.children_user + after.children_system - before.children_user - before.children_system
    return done.stdout, cpu, time.monotonic() - began


def film_of(out, name, scene, options):
    """What making the film took, and its size."""
    kept = out / f"{name}.json"
    if not kept.exists():
        film = out / f"{name}.m2v"
        _, cpu, clock = run(["render", "-y", scene, *options.split(), "--quiet", "-o", str(film)])
        kept.write_text(json.dumps({"cpu": cpu, "clock": clock, "bytes": film.stat().st_size}))
    return json.loads(kept.read_text())


def bytes_of(text):
    figure, unit = text.split()
    return float(figure) * {"kB": 1e3, "MB": 1e6}[unit]


def main():
    out, *wanted = sys.argv[1:]
    within = ["--within", "10s"]
    if wanted[:1] == ["--within"]:
        within, wanted = wanted[:2], wanted[2:]
    out = pathlib.Path(out)
    out.mkdir(parents=True, exist_ok=True)
    films = [f for f in FILMS if not wanted or f[0] in wanted]
    for name, own, said in (w.partition("=") for w in wanted):
        scene, _, options = said.partition(",")
        films += [(name, str(pathlib.Path(scene).resolve()), options)] if own else []
    print("| film | CPU, s: told, true | | size, kB: told, true | | dry run: CPU, clock, s |\n|---|---|---|---|---|---|")
    for name, scene, options in films:
        scene = str(ANIMATIONS / scene)
        true = film_of(out, name, scene, options)
        text, cpu, clock = run(["render", "--dry-run", scene, *options.split(), *within, "-o", str(out / "none.m2v")])
        told = float(re.search(r"([0-9.]+) s of CPU time", text)[1])
        size = bytes_of(re.search(r"the film has about ([0-9.]+ [kM]B)", text)[1])
        print(f"| {name} | {told:.0f}, {true['cpu']:.0f} | {100 * (told / true['cpu'] - 1):+.0f} % "
              f"| {size / 1e3:.3g}, {true['bytes'] / 1e3:.3g} | {100 * (size / true['bytes'] - 1):+.0f} % "
              f"| {cpu:.0f}, {clock:.0f} |", flush=True)


if __name__ == "__main__":
    main()
