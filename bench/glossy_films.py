#!/usr/bin/env python3
"""bench/glossy_films.py FOLDER ROUGHNESS...: films to measure glossy surfaces by. For each roughness, in percent,
FOLDER/corridor_R is a polished floor, metal columns and panels under lamps, past which the camera walks, and
FOLDER/colonnade_R is animations/colonnade with all of its stone, wood and clay polished."""
import json
import pathlib
import re
import shutil
import sys

colonnade = pathlib.Path(__file__).resolve().parents[2] / "animations" / "colonnade"


def without_comments(text):
    return re.sub(r'("(?:\\.|[^"\\])*")|//[^\n]*', lambda m: m.group(1) or "", text)


def polish_colonnade(folder, roughness):
    shutil.copytree(colonnade, folder, dirs_exist_ok=True)
    film = json.loads(without_comments((colonnade / "film.json").read_text()))
    film.pop("$schema", None)
    for name, material in film["materials"].items():
        if name not in ("earth", "leaves"):
            material.update(metallic=0, roughness=roughness)
    (folder / "film.json").write_text(json.dumps(film, indent=1))


def corridor(folder, roughness):
    metal = lambda color: {"base_color": color, "metallic": 1, "roughness": roughness}
    paint = lambda color: {"base_color": color, "metallic": 0, "roughness": roughness}
    film = {
        "size": [640, 360], "seconds": 2,
        "camera": {"fov": 55, "keys": [
            {"at": 0, "position": [0.3, 1.6, 4.5], "look_at": [-0.2, 1.2, -4]},
            {"at": 2, "position": [-0.3, 1.6, 1.5], "look_at": [0.4, 1.2, -6]}]},
        "sky": 0,
        "objects": [
            {"shape": "box", "size": [4, 0.2, 14], "position": [0, -0.2, 0],
             "material": {**paint([1, 1, 1]), "texture": {"checker": [[0.5, 0.45, 0.4], [0.12, 0.1, 0.1]], "squares": 8},
                          "texture_scale": 0.25}, "uv": "units"},
            {"shape": "box", "size": [4, 0.2, 14], "position": [0, 3, 0], "material": {"base_color": [0.8, 0.8, 0.78]}},
            {"shape": "box", "size": [0.2, 3, 14], "position": [-2.1, 0, 0], "material": {"base_color": [0.7, 0.4, 0.3]}},
            {"shape": "box", "size": [0.2, 3, 14], "position": [2.1, 0, 0], "material": paint([0.3, 0.45, 0.6])},
            {"shape": "box", "size": [4.4, 3, 0.2], "position": [0, 0, -7.1], "material": metal([0.8, 0.8, 0.82])},
            {"shape": "box", "size": [4.4, 3, 0.2], "position": [0, 0, 7.1], "material": {"base_color": [0.6, 0.6, 0.5]}},
            {"shape": "cylinder", "radius": 0.25, "height": 3, "position": [0, 0, 0], "material": metal([0.9, 0.7, 0.4]),
             "repeat": {"count": [2, 1, 4], "step": [2.8, 0, 3], "centered": True}},
            {"shape": "box", "size": [0.05, 1.4, 1.6], "position": [-1.95, 0.8, 0], "material": metal([0.75, 0.75, 0.78]),
             "repeat": {"count": [1, 1, 4], "step": [1, 0, 3], "centered": True}},
            {"shape": "sphere", "radius": 0.4, "position": [0.4, 0.4, -2.5], "material": metal([0.6, 0.8, 0.65])},
            {"shape": "box", "size": [0.7, 0.05, 0.7], "position": [0, 2.9, 0], "material": {"base_color": 0, "emission": [9, 8, 6.5]},
             "repeat": {"count": [1, 1, 4], "step": [1, 0, 3.2], "centered": True}}]}
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "film.json").write_text(json.dumps(film, indent=1))


if __name__ == "__main__":
    root = pathlib.Path(sys.argv[1])
    for percent in sys.argv[2:]:
        polish_colonnade(root / f"colonnade_{percent}", int(percent) / 100)
        corridor(root / f"corridor_{percent}", int(percent) / 100)
