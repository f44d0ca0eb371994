#!/usr/bin/env python3
"""Brightness that coding moves from picture to picture (docs/model/metrics.md, Pumping), in four films: a lamp that
crosses a room, a lamp that fades, a walk, and a room where nothing moves.

  bench/pumping.py [-q 4,8] [-o FOLDER] PROGRAM [PROGRAM...]

Renders each film once with the first program (some CPU minutes; kept in FOLDER), lets every program encode the same
frames, and prints a row for each: bytes, PSNR-Y, pumping of the film and of its I, P and B pictures. Programs without
pumping in their statistics show none.
"""
import argparse
import json
import math
import os
import shutil
import subprocess
import tempfile

HERE = os.path.dirname(os.path.abspath(__file__))
TEXTURES = os.path.join(HERE, "../animations/still_room")

ROOM = {
    "objects": [
        {"shape": "plane", "size": [6, 6], "uv": "units", "material": "floor"},
        {"shape": "plane", "size": [6, 6], "position": [0, 3, 0], "rotate": [180, 0, 0], "material": "plaster"},
        {"shape": "quad", "size": [6, 3], "position": [0, 1.5, -3], "material": "plaster"},
        {"shape": "quad", "size": [6, 3], "position": [-3, 1.5, 0], "rotate": 90, "material": "plaster"},
        {"shape": "quad", "size": [6, 3], "position": [3, 1.5, 0], "rotate": -90, "material": "plaster"},
        {"shape": "box", "size": [0.9, 1.2, 0.9], "position": [0.8, 0, -1.2], "rotate": 25, "material": "carpet"},
        {"shape": "sphere", "radius": 0.45, "position": [-0.9, 0.45, -0.4],
         "material": {"base_color": [0.7, 0.3, 0.2]}},
    ],
    "materials": {
        "floor": {"texture": "floor.png"},
        "plaster": {"base_color": 0.8, "texture": "plaster.png"},
        "carpet": {"texture": "carpet.png"},
    },
}
CAMERA = {"position": [0, 1.5, 2.9], "look_at": [0, 1.1, -1], "fov": 60}
LAMP = {"kind": "point", "intensity": 10}
STILL_LAMP = dict(LAMP, position=[0, 2.5, 0])
FILMS = {
    "moving lamp": {"camera": CAMERA, "lights": [dict(LAMP, keys=[
        {"at": 0, "position": [-1.8, 2.3, -1]}, {"at": 1.2, "position": [0.2, 2.6, 0.6]},
        {"at": 2.4, "position": [1.8, 2.2, -1.2]}])]},
    "fading lamp": {"camera": CAMERA, "lights": [dict(STILL_LAMP, interpolation="linear", keys=[
        {"at": 0, "power": 0.25}, {"at": 1.2, "power": 1.5}, {"at": 2.4, "power": 0.25}])]},
    "walk": {"camera": {"fov": 60, "keys": [
        {"at": 0, "position": [-1.2, 1.5, 2.9], "look_at": [0, 1.1, -1]},
        {"at": 2.4, "position": [1.0, 1.6, 1.2], "look_at": [0.4, 1.0, -2]}]}, "lights": [STILL_LAMP]},
    "still room": {"camera": CAMERA, "lights": [STILL_LAMP]},
}


def make(film, folder, program):
    """Frames and exact motion of a film; made once."""
    place = os.path.join(folder, film.replace(" ", "_"))
    frames, motion = os.path.join(place, "frames.y4m"), os.path.join(place, "layers")
    if not os.path.exists(frames):
        os.makedirs(place, exist_ok=True)
        for texture in ("floor", "plaster", "carpet"):
            shutil.copy(os.path.join(TEXTURES, texture + ".png"), place)
        with open(os.path.join(place, "film.json"), "w") as file:
            json.dump(dict(ROOM, size=[480, 272], frames=45, exposure=0, **FILMS[film]), file)
        subprocess.run([program, "render", place, "-o", frames, "--aov", motion, "--tolerance", "reference",
                        "--vpls", "64", "--quiet"], check=True)
    return frames, os.path.join(motion, "frame_%04d.exr")


def rms(values):
    known = [v for v in values if v is not None]
    return "%.2f" % math.sqrt(sum(v * v for v in known) / len(known)) if known else ""


def measure(program, frames, motion, quantiser, folder):
    statistics = os.path.join(folder, "statistics.json")
    subprocess.run([program, "encode", frames, "--motion", motion, "-o", os.path.join(folder, "film.m2v"),
                    "--quantiser", str(quantiser), "--stats", statistics, "--quiet"], check=True)
    with open(statistics) as file:
        s = json.load(file)
    by_type = [rms([f.get("pumping") for f in s["per_frame"] if f["type"] == t]) for t in "IPB"]
    return [str(s["bytes"]), "%.2f" % s["psnr_y"], rms([s.get("pumping")])] + by_type


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-q", "--quantisers", default="4")
    parser.add_argument("-o", "--folder", default=os.path.join(tempfile.gettempdir(), "render2mpeg_pumping"))
    parser.add_argument("programs", nargs="+")
    options = parser.parse_args()
    print("| film | quantiser | program | bytes | PSNR-Y, dB | pumping | of I | of P | of B |")
    print("|---|---|---|---|---|---|---|---|---|")
    for film in FILMS:
        frames, motion = make(film, options.folder, options.programs[0])
        for quantiser in options.quantisers.split(","):
            for program in options.programs:
                row = measure(program, frames, motion, quantiser, options.folder)
                print("| " + " | ".join([film, quantiser, os.path.basename(program)] + row) + " |", flush=True)


if __name__ == "__main__":
    main()
