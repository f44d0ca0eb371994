#!/usr/bin/env python3
"""large_scenes.py triangles|lights COUNT OUT.glb

Writes a scene that is large in one way: a rolling landscape of about COUNT triangles under a sun and a sky, or a hall with
COUNT small lamps. What rendering them takes is in docs/measurements.md#memory.
"""
import array
import json
import math
import random
import struct
import sys


def glb(document, binary):
    document["buffers"] = [{"byteLength": len(binary)}]
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    binary += b"\0" * (-len(binary) % 4)
    return (struct.pack("<4sII", b"glTF", 2, 28 + len(text) + len(binary)) +
            struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(binary), b"BIN\0") + binary)


def mesh(positions, indices):
    """A document with one mesh, camera and nodes for both."""
    binary = positions.tobytes() + indices.tobytes()
    document = {
        "asset": {"version": "2.0"},
        "scenes": [{"nodes": [0, 1]}],
        "nodes": [{"mesh": 0}, {"camera": 0, "translation": [0, 3, 12], "rotation": [-0.09, 0, 0, 0.996]}],
        "cameras": [{"type": "perspective", "perspective": {"yfov": 0.8, "znear": 0.1}}],
        "materials": [{"pbrMetallicRoughness": {"baseColorFactor": [0.6, 0.55, 0.5, 1], "metallicFactor": 0}}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": 0}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": len(positions) // 3, "type": "VEC3",
             "min": [min(positions[k::3]) for k in range(3)], "max": [max(positions[k::3]) for k in range(3)]},
            {"bufferView": 1, "componentType": 5125, "count": len(indices), "type": "SCALAR"},
        ],
        "bufferViews": [
            {"buffer": 0, "byteOffset": 0, "byteLength": positions.itemsize * len(positions)},
            {"buffer": 0, "byteOffset": positions.itemsize * len(positions),
             "byteLength": indices.itemsize * len(indices)},
        ],
    }
    return document, binary


def grid(side, size, height):
    """side x side quads over size x size."""
    positions, indices = array.array("f"), array.array("I")
    for row in range(side + 1):
        z = size * (row / side - 0.5)
        for column in range(side + 1):
            x = size * (column / side - 0.5)
            positions.extend((x, height * (math.sin(x) * math.cos(1.3 * z) + 0.1 * math.sin(17 * x + 11 * z)), z))
    for row in range(side):
        first = row * (side + 1)
        for i in range(first, first + side):
            indices.extend((i, i + side + 1, i + 1, i + 1, i + side + 1, i + side + 2))
    return positions, indices


def triangles(count):
    document, binary = mesh(*grid(max(1, round(math.sqrt(count / 2))), 40, 0.6))
    document["extensionsUsed"] = ["KHR_lights_punctual"]
    document["extensions"] = {"KHR_lights_punctual": {"lights": [{"type": "directional", "intensity": 3}]}}
    document["nodes"].append({"rotation": [-0.4, 0.3, 0, 0.866], "extensions": {"KHR_lights_punctual": {"light": 0}}})
    document["scenes"][0]["nodes"].append(2)
    return glb(document, binary)


def lights(count):
    document, binary = mesh(*grid(40, 40, 0.3))
    dice = random.Random(1)
    document["extensionsUsed"] = ["KHR_lights_punctual"]
    document["extensions"] = {"KHR_lights_punctual": {"lights": [
        {"type": "point", "intensity": 2000 / count, "color": [dice.random(), dice.random(), dice.random()]}
        for _ in range(64)]}}
    for i in range(count):
        place = [round(40 * (dice.random() - 0.5), 3), round(1 + 3 * dice.random(), 3), round(40 * (dice.random() - 0.5), 3)]
        document["nodes"].append({"translation": place, "extensions": {"KHR_lights_punctual": {"light": i % 64}}})
    document["scenes"][0]["nodes"] += list(range(2, 2 + count))
    return glb(document, binary)


if __name__ == "__main__":
    if len(sys.argv) != 4 or sys.argv[1] not in ("triangles", "lights"):
        sys.exit(__doc__)
    with open(sys.argv[3], "wb") as out:
        out.write({"triangles": triangles, "lights": lights}[sys.argv[1]](int(sys.argv[2])))
