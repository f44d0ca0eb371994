#!/usr/bin/env python3
"""Writes film.json beside it: a furry figure of balls and legs walks past. Fur is one mesh of strands for each part."""
import json
import math
import os
import random

random.seed(7)
GOLDEN = (math.sqrt(5) - 1) / 2


def fur(count, size, length, lean):
    """Strands that stand off an ellipsoid of half axes `size` and lean along -x."""
    strands = []
    for i in range(count):
        z, turn = 1 - 2 * (i + 0.5) / count, 2 * math.pi * GOLDEN * i
        s = math.sqrt(1 - z * z)
        unit = (s * math.cos(turn), z, s * math.sin(turn))
        root = [u * r for u, r in zip(unit, size)]
        normal = [u / r for u, r in zip(unit, size)]
        scale = math.sqrt(sum(n * n for n in normal))
        own = length * random.uniform(0.7, 1.1)
        bend = (-lean + random.gauss(0, 0.1), -0.25 + random.gauss(0, 0.1), random.gauss(0, 0.15))
        strands.append([[round(p + own * t * (n / scale) + own * t * t * b, 3) for p, n, b in zip(root, normal, bend)]
                        for t in (0, 0.5, 1)])
    return strands


def part(name, at, size, count, length=0.16, lean=0.5, keys=None, material="fur"):
    says = {"name": name, "shape": "group", "position": at, "parts": [
        {"shape": "sphere", "radius": 1, "scale": list(size), "segments": 24, "material": "skin"},
        {"shape": "strands", "strands": fur(count, size, length, lean), "radius": 0.007, "tip_radius": 0.001, "material": material}]}
    if keys:
        says.update(keys=keys, loop=True, interpolation="smooth")
    return says


def swing(phase, angle):
    """A step of 0.8 seconds."""
    return [{"at": round(0.2 * k, 3), "rotate": [0, 0, round(angle * math.sin(math.pi / 2 * k + phase), 3)]} for k in range(5)]


def leg(name, x, z, phase):
    hip = part(name, [x, 0.62, z], (0.001, 0.001, 0.001), 1)
    thigh = part(name + " fur", [0, -0.3, 0], (0.11, 0.34, 0.11), 260, 0.12, 0.3)
    hip["parts"] = [thigh]
    hip.update(keys=swing(phase, 24), loop=True)
    return hip


figure = {"name": "figure", "shape": "group", "keys": [{"at": 0, "position": [-1.0, 0, 0]}, {"at": 3.2, "position": [1.4, 0, 0]}],
          "interpolation": "linear", "parts": [
    part("body", [0, 0.85, 0], (0.62, 0.36, 0.34), 1500),
    part("head", [0.72, 1.2, 0], (0.28, 0.27, 0.25), 700, 0.12, keys=[{"at": 0, "rotate": [0, 0, -3]}, {"at": 0.4, "rotate": [0, 0, 4]}, {"at": 0.8, "rotate": [0, 0, -3]}]),
    part("tail", [-0.72, 1.1, 0], (0.1, 0.3, 0.1), 300, 0.18, keys=[{"at": 0, "rotate": [18, 0, 35]}, {"at": 0.4, "rotate": [-18, 0, 35]}, {"at": 0.8, "rotate": [18, 0, 35]}]),
    leg("leg 1", 0.42, 0.2, 0), leg("leg 2", 0.42, -0.2, math.pi), leg("leg 3", -0.42, 0.2, math.pi), leg("leg 4", -0.42, -0.2, 0)]
    + [{"name": f"eye {k}", "shape": "sphere", "radius": 0.05, "position": [0.98, 1.32, 0.12 * k], "material": {"base_color": 0.02, "roughness": 0.1}} for k in (-1, 1)]}
film = {"$schema": "../../docs/animation-file.schema.json", "title": "A furry figure walks past; written by make.py", "size": [320, 180],
        "frame_rate": 25, "seconds": 3.2,
        "camera": {"fov": 36, "look_at": [0.1, 0.75, 0], "keys": [{"at": 0, "position": [-0.6, 1.3, 4.2]}, {"at": 3.2, "position": [0.6, 1.3, 4.2]}]},
        "sky": {"zenith": [0.35, 0.5, 0.8], "horizon": [0.7, 0.7, 0.7], "ground": [0.25, 0.22, 0.2]},
        "lights": [{"kind": "sun", "elevation": 42, "azimuth": 35, "intensity": 2.5, "angle": 2, "color": [1, 0.93, 0.82]}],
        "materials": {"fur": {"hair": {"melanin": 0.45, "redness": 0.6}}, "skin": {"base_color": [0.3, 0.18, 0.12]}},
        "objects": [{"name": "ground", "shape": "plane", "size": [30, 30], "material": {"texture": {"checker": [[0.5, 0.46, 0.38], [0.4, 0.38, 0.34]]}, "texture_scale": 4}}, figure]}
with open(os.path.join(os.path.dirname(os.path.abspath(__file__)), "film.json"), "w") as file:
    json.dump(film, file, separators=(",", ":"))
    file.write("\n")
