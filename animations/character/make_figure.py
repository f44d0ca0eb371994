#!/usr/bin/env python3
"""Makes figure.gltf and figure.bin: a jointed figure, skinned to 15 bones, that walks and looks about for three seconds. Needs nothing
but Python. Run it in this folder: ./make_figure.py"""
import json
import math
import struct

# Bones: name, parent, place relative to the parent (metres, +y up, walks towards +z; the figure's left is +x).
BONES = [
    ("hips", None, (0, 0.96, 0)),
    ("spine", "hips", (0, 0.12, 0)),
    ("chest", "spine", (0, 0.22, 0)),
    ("head", "chest", (0, 0.27, 0)),
    ("arm left", "chest", (0.21, 0.17, 0)),
    ("forearm left", "arm left", (0, -0.29, 0)),
    ("hand left", "forearm left", (0, -0.26, 0)),
    ("arm right", "chest", (-0.21, 0.17, 0)),
    ("forearm right", "arm right", (0, -0.29, 0)),
    ("hand right", "forearm right", (0, -0.26, 0)),
    ("thigh left", "hips", (0.1, -0.03, 0)),
    ("shin left", "thigh left", (0, -0.44, 0)),
    ("thigh right", "hips", (-0.1, -0.03, 0)),
    ("shin right", "thigh right", (0, -0.44, 0)),
    ("foot left", "shin left", (0, -0.42, 0)),
    ("foot right", "shin right", (0, -0.42, 0)),
]
INDEX = {name: i for i, (name, _, _) in enumerate(BONES)}
REST = {}
for bone_name, bone_parent, bone_offset in BONES:
    base = REST[bone_parent] if bone_parent else (0, 0, 0)
    REST[bone_name] = tuple(a + b for a, b in zip(base, bone_offset))

DURATION, STEP_TIME, KEYS_PER_SECOND = 3.0, 1.0, 24
SPEED = 1.25  # metres per second, which the stride below covers


class Part:
    """One primitive: rings of corners along a line, skinned by their height."""

    def __init__(self):
        self.position, self.normal, self.uv, self.joints, self.weights, self.triangles = [], [], [], [], [], []

    def tube(self, rings, skin, sides=18, repeat=1.0):
        """`rings`: (centre, radius along x, radius along z) from below upwards or above downwards; `skin(centre)`: {bone: weight}."""
        start = len(self.position)
        length = 0.0
        down = rings[0][0][1] > rings[-1][0][1]
        for k, (c, rx, rz) in enumerate(rings):
            if k:
                length += math.dist(c, rings[k - 1][0])
            for s in range(sides + 1):
                turn = 2 * math.pi * (s % sides) / sides
                x, z = math.sin(turn), math.cos(turn)
                # Slope of the outline, for the normal.
                a, b = rings[max(0, k - 1)], rings[min(len(rings) - 1, k + 1)]
                run = math.dist(a[0], b[0]) or 1e-6
                slope = ((b[1] - a[1]) + (b[2] - a[2])) / 2 / run * (-1 if not down else 1)
                n = (x / max(rx, 1e-4), slope / max((rx + rz) / 2, 1e-4), z / max(rz, 1e-4))
                size = math.sqrt(sum(t * t for t in n))
                self.position.append((c[0] + rx * x, c[1], c[2] + rz * z))
                self.normal.append(tuple(t / size for t in n))
                self.uv.append((repeat * s / sides, length * 1.6))
                pairs = sorted(skin(c).items(), key=lambda item: -item[1])[:4]
                total = sum(w for _, w in pairs)
                self.joints.append([INDEX[b] for b, _ in pairs] + [0] * (4 - len(pairs)))
                self.weights.append([w / total for _, w in pairs] + [0.0] * (4 - len(pairs)))
        row = sides + 1
        for k in range(len(rings) - 1):
            for s in range(sides):
                a, b = start + k * row + s, start + (k + 1) * row + s
                quad = [(a, a + 1, b + 1), (a, b + 1, b)]
                self.triangles += [(i, k2, j) for i, j, k2 in quad] if down else quad


def smooth(t):
    t = max(0.0, min(1.0, t))
    return t * t * (3 - 2 * t)


def chain(bones, blend):
    """Weights along a chain of bones that hang below or stand above each other: the bone above and below a joint share it over `blend`."""

    def skin(c):
        weights = {bones[0]: 1.0}
        for upper, lower in zip(bones, bones[1:]):
            joint = REST[lower][1]
            sign = 1 if joint < REST[upper][1] or upper == bones[0] and REST[upper][1] > joint else -1
            t = smooth(0.5 + sign * (joint - c[1]) / blend)
            weights = {b: w * (1 - t) for b, w in weights.items()}
            weights[lower] = t
        return {b: w for b, w in weights.items() if w > 1e-3}

    return skin


def limb(part, top, bottom, profile, skin, flatten=1.0, steps=18):
    rings = []
    for k in range(steps + 1):
        t = k / steps
        c = tuple(a + (b - a) * t for a, b in zip(top, bottom))
        at = t * (len(profile) - 1)
        i = min(int(at), len(profile) - 2)
        r = profile[i] + (profile[i + 1] - profile[i]) * smooth(at - i)
        rings.append((c, r, r * flatten))
    # Round caps.
    cap = lambda c, r, sign: [((c[0], c[1] + sign * r * math.sin(a), c[2]), r * math.cos(a), r * flatten * math.cos(a))
                              for a in (0.5, 1.0, math.pi / 2)]
    first, last = rings[0], rings[-1]
    part.tube(list(reversed(cap(first[0], first[1], 1))) + rings + cap(last[0], last[1], -1), skin)


def ball(part, centre, radii, skin, rings=14):
    part.tube([((centre[0], centre[1] - radii[1] * math.cos(math.pi * k / rings), centre[2]),
                radii[0] * max(math.sin(math.pi * k / rings), 1e-4), radii[2] * max(math.sin(math.pi * k / rings), 1e-4))
               for k in range(rings + 1)], skin)


def build():
    cloth, skin_part, shoe = Part(), Part(), Part()
    body = [(0.85, 0.10, 0.09), (0.89, 0.155, 0.115), (0.96, 0.17, 0.125), (1.05, 0.15, 0.11), (1.14, 0.145, 0.105), (1.25, 0.17, 0.12),
            (1.36, 0.19, 0.125), (1.44, 0.19, 0.11), (1.50, 0.13, 0.085), (1.53, 0.06, 0.06)]
    fine = []
    for (y0, a0, b0), (y1, a1, b1) in zip(body, body[1:]):
        fine += [((0, y0 + (y1 - y0) * t / 3, 0), a0 + (a1 - a0) * smooth(t / 3), b0 + (b1 - b0) * smooth(t / 3)) for t in range(3)]
    fine.append(((0, body[-1][0], 0), body[-1][1], body[-1][2]))
    cloth.tube(fine, lambda c: upward(c, ["hips", "spine", "chest"]), sides=28, repeat=2.0)
    for side, x in (("left", 0.21), ("right", -0.21)):
        arm = chain([f"arm {side}", f"forearm {side}", f"hand {side}"], 0.10)
        top = REST[f"arm {side}"]
        limb(cloth, (x, top[1] - 0.01, 0), (x, top[1] - 0.50, 0), [0.072, 0.062, 0.052, 0.05, 0.045], arm)
        ball(skin_part, (x, top[1] - 0.60, 0), (0.036, 0.085, 0.052), lambda c, b=f"hand {side}": {b: 1.0})
        leg = chain([f"thigh {side}", f"shin {side}", f"foot {side}"], 0.12)
        hip = REST[f"thigh {side}"]
        limb(cloth, (hip[0], hip[1] - 0.02, 0), (hip[0], 0.10, 0), [0.098, 0.095, 0.078, 0.066, 0.064, 0.05], leg, steps=26)
        ball(shoe, (hip[0], 0.052, 0.055), (0.052, 0.052, 0.125), lambda c, b=f"foot {side}": {b: 1.0})
    limb(skin_part, (0, 1.60, 0), (0, 1.50, 0), [0.05, 0.055], lambda c: {"head": smooth((c[1] - 1.47) / 0.1) + 0.02, "chest": 1.02 - smooth((c[1] - 1.47) / 0.1)}, steps=6)
    ball(skin_part, (0, 1.70, 0.01), (0.088, 0.125, 0.102), lambda c: {"head": 1.0}, rings=20)
    ball(skin_part, (0, 1.69, 0.115), (0.015, 0.028, 0.024), lambda c: {"head": 1.0}, rings=8)
    ball(shoe, (0, 1.755, -0.008), (0.095, 0.085, 0.108), lambda c: {"head": 1.0}, rings=16)  # a cap of hair
    return cloth, skin_part, shoe


def upward(c, bones):
    """Weights for a body that stands on its first bone."""
    weights = {bones[0]: 1.0}
    for upper in bones[1:]:
        t = smooth(0.5 + (c[1] - REST[upper][1]) / 0.16)
        weights = {b: w * (1 - t) for b, w in weights.items()}
        weights[upper] = t
    return {b: w for b, w in weights.items() if w > 1e-3}


def turn(x=0.0, y=0.0, z=0.0):
    """Degrees about x, then y, then z, as a quaternion (x, y, z, w)."""

    def about(axis, degrees):
        half = math.radians(degrees) / 2
        q = [0.0, 0.0, 0.0, math.cos(half)]
        q[axis] = math.sin(half)
        return q

    def times(a, b):
        ax, ay, az, aw = a
        bx, by, bz, bw = b
        return [aw * bx + ax * bw + ay * bz - az * by, aw * by - ax * bz + ay * bw + az * bx, aw * bz + ax * by - ay * bx + az * bw,
                aw * bw - ax * bx - ay * by - az * bz]

    return times(about(2, z), times(about(1, y), about(0, x)))


def pose(t):
    """Rotations of the bones and the place of the hips at time t. A positive turn about x swings what hangs to the back."""
    phase = 2 * math.pi * t / STEP_TIME
    swing, s2 = math.sin(phase), math.sin(2 * phase)
    bent = lambda p: 8 + 52 * max(0.0, math.sin(p)) ** 1.5  # a knee bends while its leg comes forward
    bow = smooth((t - 0.3) / 0.8) * (1 - smooth((t - 1.9) / 0.8))
    rotations = {
        "hips": turn(2, 7 * swing, 2.5 * math.cos(phase)),
        "spine": turn(3 + 16 * bow, -5 * swing, -2 * math.cos(phase)),
        "chest": turn(2 + 14 * bow, -9 * swing, 0),
        "head": turn(-4 - 16 * bow, 22 * math.sin(math.pi * t / 1.5), 0),
        "arm left": turn(30 * swing + 4, 0, 7),
        "forearm left": turn(-22 - 14 * max(0.0, -swing), 0, 0),
        "hand left": turn(-6, 0, 0),
        "arm right": turn(-30 * swing + 4, 0, -7),
        "forearm right": turn(-22 - 14 * max(0.0, swing), 0, 0),
        "hand right": turn(-6, 0, 0),
        "thigh left": turn(-27 * swing - 6, -4 * swing, 0),
        "shin left": turn(bent(phase + 2.2 - math.pi / 2), 0, 0),
        "thigh right": turn(27 * swing - 6, -4 * swing, 0),
        "shin right": turn(bent(phase + 2.2 + math.pi / 2), 0, 0),
        "foot left": turn(12 * swing - 4, 0, 0),
        "foot right": turn(-12 * swing - 4, 0, 0),
    }
    place = (0.015 * swing, 0.945 + 0.018 * math.cos(2 * phase) + 0.004 * s2, SPEED * (t - DURATION / 2))
    return rotations, place


def main():
    blob, views, accessors = b"", [], []

    def accessor(values, kind, component="f", target=None, bounds=False):
        nonlocal blob
        flat = [v for value in values for v in (value if isinstance(value, (list, tuple)) else (value,))]
        while len(blob) % 4:
            blob += b"\0"
        data = struct.pack("<%d%s" % (len(flat), component), *flat)
        views.append({"buffer": 0, "byteOffset": len(blob), "byteLength": len(data), **({"target": target} if target else {})})
        blob += data
        entry = {"bufferView": len(views) - 1, "componentType": {"f": 5126, "H": 5123, "B": 5121}[component], "count": len(values), "type": kind}
        if bounds:
            columns = list(zip(*(v if isinstance(v, (list, tuple)) else (v,) for v in values)))
            # As single precision holds them.
            single = lambda x: struct.unpack("<f", struct.pack("<f", x))[0]
            entry["min"], entry["max"] = [single(min(c)) for c in columns], [single(max(c)) for c in columns]
        accessors.append(entry)
        return len(accessors) - 1

    primitives = []
    for material, part in enumerate(build()):
        primitives.append({
            "attributes": {
                "POSITION": accessor(part.position, "VEC3", target=34962, bounds=True),
                "NORMAL": accessor(part.normal, "VEC3", target=34962),
                "TEXCOORD_0": accessor(part.uv, "VEC2", target=34962),
                "JOINTS_0": accessor(part.joints, "VEC4", "B", 34962),
                "WEIGHTS_0": accessor(part.weights, "VEC4", target=34962),
            },
            "indices": accessor([i for t in part.triangles for i in t], "SCALAR", "H", 34963),
            "material": material,
        })
    inverse = [[1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -REST[n][0], -REST[n][1], -REST[n][2], 1] for n, _, _ in BONES]
    inverse_bind = accessor(inverse, "MAT4")

    nodes = []
    for name, _, offset in BONES:
        children = [INDEX[n] for n, p, _ in BONES if p == name]
        nodes.append({"name": name, "translation": list(offset), **({"children": children} if children else {})})
    nodes.append({"name": "figure", "mesh": 0, "skin": 0})

    count = int(DURATION * KEYS_PER_SECOND) + 1
    times = [k / KEYS_PER_SECOND for k in range(count)]
    poses = [pose(t) for t in times]
    clock = accessor(times, "SCALAR", bounds=True)
    samplers, channels = [], []

    def channel(bone, path, values, kind):
        samplers.append({"input": clock, "output": accessor(values, kind), "interpolation": "LINEAR"})
        channels.append({"sampler": len(samplers) - 1, "target": {"node": INDEX[bone], "path": path}})

    for name, _, _ in BONES:
        channel(name, "rotation", [p[0][name] for p in poses], "VEC4")
    channel("hips", "translation", [p[1] for p in poses], "VEC3")

    gltf = {
        "extensionsUsed": ["KHR_materials_pbrSpecularGlossiness"],
        "asset": {"version": "2.0", "generator": "make_figure.py"},
        "scene": 0,
        "scenes": [{"nodes": [INDEX["hips"], len(nodes) - 1]}],
        "nodes": nodes,
        "meshes": [{"name": "figure", "primitives": primitives}],
        "skins": [{"joints": list(range(len(BONES))), "inverseBindMatrices": inverse_bind, "skeleton": INDEX["hips"]}],
        "animations": [{"name": "walk", "samplers": samplers, "channels": channels}],
        "materials": [
            # Cloth has no highlight at all, which metal and roughness cannot say.
            {"name": "cloth", "extensions": {"KHR_materials_pbrSpecularGlossiness": {
                "diffuseTexture": {"index": 0}, "specularFactor": [0, 0, 0], "glossinessFactor": 0}}},
            {"name": "skin", "pbrMetallicRoughness": {"baseColorFactor": [0.62, 0.36, 0.24, 1], "metallicFactor": 0, "roughnessFactor": 0.6}},
            {"name": "leather", "pbrMetallicRoughness": {"baseColorFactor": [0.05, 0.03, 0.02, 1], "metallicFactor": 0, "roughnessFactor": 0.5}},
        ],
        "textures": [{"source": 0, "sampler": 0}],
        "samplers": [{"wrapS": 10497, "wrapT": 10497}],
        "images": [{"uri": "cloth.png"}],
        "buffers": [{"uri": "figure.bin", "byteLength": len(blob)}],
        "bufferViews": views,
        "accessors": accessors,
    }
    with open("figure.bin", "wb") as out:
        out.write(blob)
    with open("figure.gltf", "w") as out:
        json.dump(gltf, out, separators=(",", ":"))
        out.write("\n")
    print(sum(len(p["attributes"]) for p in primitives), "attributes,", len(blob), "bytes,", sum(accessors[p["indices"]]["count"] for p in primitives) // 3, "triangles")


if __name__ == "__main__":
    main()
