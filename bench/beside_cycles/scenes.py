#!/usr/bin/env python3
"""scenes.py [--models SCENES_FOLDER] [--frames N] OUT_FOLDER [NAME...]

Writes scenes as animation files, OUT_FOLDER/NAME/film.json, which render2mpeg and cycles.py both read: one description for
both. Scenes whose names begin with "check_" are a matt plane under one lamp, with the closed form of its radiance in
OUT_FOLDER/NAME/closed_form. Models become matt and rigid: each material keeps its colour factor, loses textures and
highlights, and shows both sides, so that the comparison is of light and not of material conventions; skins and morphs go.
Films of more than one frame: in cornell the short box slides and turns, elsewhere the camera goes sideways.
"""
import argparse
import json
import math
import os
import struct
import zlib

ALBEDO = 0.8


def matt(*colour):
    return {"base_color": list(colour) if len(colour) > 1 else colour[0]}


def ball(x, z, material, radius=0.5):
    return {"shape": "sphere", "radius": radius, "segments": 128, "position": [x, radius, z], "material": material}


def panel(position, rotate, size, intensity, colour=(1, 1, 1)):
    return {"kind": "panel", "position": position, "rotate": rotate, "size": size, "intensity": intensity, "color": list(colour)}


def room(width, height, depth, walls, left=None, right=None, front=False):
    """Walls that face inwards, about the origin; the front is open unless `front`."""
    parts = [
        {"shape": "plane", "size": [width, depth], "material": walls},
        {"shape": "plane", "size": [width, depth], "position": [0, height, 0], "rotate": [180, 0, 0], "material": walls},
        {"shape": "quad", "size": [width, height], "position": [0, height / 2, -depth / 2], "material": walls},
        {"shape": "quad", "size": [depth, height], "position": [-width / 2, height / 2, 0], "rotate": 90, "material": left or walls},
        {"shape": "quad", "size": [depth, height], "position": [width / 2, height / 2, 0], "rotate": -90, "material": right or walls},
    ]
    if front:
        parts.append({"shape": "quad", "size": [width, height], "position": [0, height / 2, depth / 2], "rotate": 180, "material": walls})
    return parts


def checks():
    """One lamp above a matt plane; the camera sees a spot of it at the origin, 2 units below the lamp."""
    height, half, radius, radiance = 2.0, 0.5, 0.25, 3.0
    # A square above the origin [Lambert1760]: four times the configuration factor of a quarter, seen from below its corner.
    a = half / height
    form = 4 / (2 * math.pi) * 2 * a / math.sqrt(1 + a * a) * math.atan(a / math.sqrt(1 + a * a))
    lamps = {
        "sun": ({"kind": "sun", "elevation": 50, "azimuth": 30, "intensity": 4}, 4 * math.sin(math.radians(50)) / math.pi),
        "point": ({"kind": "point", "position": [0, height, 0], "intensity": 10}, 10 / height**2 / math.pi),
        "panel": (panel([0, height, 0], [-90, 0, 0], [2 * half, 2 * half], radiance), radiance * form),
        "sphere": ({"kind": "sphere", "position": [0, height, 0], "radius": radius, "intensity": radiance},
                   radiance * radius**2 / height**2),
        "sky": (None, 1.5),
    }
    for name, (lamp, radiance_of_white) in lamps.items():
        film = {"camera": {"position": [3, 1.5, 0], "look_at": [0, 0, 0], "fov": 0.5},
                "objects": [{"shape": "plane", "size": [200, 200], "material": "white"}],
                "materials": {"white": matt(ALBEDO)}, "size": [16, 16]}
        film.update({"lights": [lamp]} if lamp else {"sky": 1.5})
        yield "check_" + name, film, {"closed_form": ALBEDO * radiance_of_white}


def ball_row(kind, base):
    roughness = [0.1, 0.2, 0.35, 0.6, 1.0]
    materials = {"floor": matt(0.5)}
    objects = [{"shape": "plane", "size": [40, 40], "material": "floor"}]
    for i, r in enumerate(roughness):
        materials[f"{kind}{i}"] = {"base_color": base, "metallic": 1 if kind == "metal" else 0, "roughness": r}
        objects.append(ball(1.15 * (i - 2), 0, f"{kind}{i}"))
    return {"camera": {"position": [0, 2.2, 7], "look_at": [0, 0.45, 0], "fov": 30}, "sky": [0.5, 0.6, 0.8],
            "lights": [panel([-2, 3.5, 2.5], [-50, -30, 0], [1.5, 1.5], 12, (1, 0.9, 0.75))],
            "objects": objects, "materials": materials}


def own():
    floor = {"shape": "plane", "size": [40, 40], "material": "floor"}
    yield "floor_and_ball", {
        "camera": {"position": [0, 1.6, 5], "look_at": [0, 0.5, 0], "fov": 35}, "sky": [0.4, 0.6, 1.0],
        "lights": [{"kind": "sun", "elevation": 45, "azimuth": 60, "intensity": 4, "color": [1, 0.95, 0.85]}],
        "objects": [floor, ball(0, 0, "ball"), {"shape": "box", "size": [0.6, 1.2, 0.6], "position": [-1.3, 0, -0.6], "rotate": 25,
                                                "material": "box"}],
        "materials": {"floor": matt(0.5), "ball": matt(0.8, 0.3, 0.2), "box": matt(0.2, 0.4, 0.7)}}, {}
    yield "cornell", {
        "camera": {"position": [0, 1, 3.9], "look_at": [0, 1, 0], "fov": 39.3},
        "lights": [panel([0, 1.98, 0], [-90, 0, 0], [0.5, 0.5], 18, (1, 0.85, 0.6))],
        "objects": room(2, 2, 2, "white", "red", "green") + [
            {"shape": "box", "size": [0.6, 1.2, 0.6], "position": [-0.35, 0, -0.3], "rotate": 20, "material": "white"},
            {"shape": "box", "size": [0.6, 0.6, 0.6], "position": [0.35, 0, 0.3], "rotate": -18, "material": "white"}],
        "materials": {"white": matt(0.73), "red": matt(0.65, 0.05, 0.05), "green": matt(0.12, 0.45, 0.15)}}, {}
    yield "metal_balls", ball_row("metal", [0.9, 0.75, 0.5]), {}
    yield "dielectric_balls", ball_row("plastic", [0.6, 0.2, 0.15]), {}
    yield "dielectric_balls_mixed", ball_row("plastic", [0.6, 0.2, 0.15]), {"dielectric": "mix"}
    yield "sphere_lamp_room", {
        "camera": {"position": [0, 1.3, 3.4], "look_at": [0, 1.1, 0], "fov": 50},
        "lights": [{"kind": "sphere", "position": [0.4, 1.9, -0.3], "radius": 0.25, "intensity": 15, "color": [1, 0.9, 0.8]}],
        "objects": room(4, 2.6, 4, "white", "red") + [ball(-0.8, 0, "blue"), {
            "shape": "box", "size": [0.7, 0.9, 0.7], "position": [1, 0, -0.8], "rotate": 30, "material": "white"}],
        "materials": {"white": matt(0.7), "red": matt(0.6, 0.15, 0.1), "blue": matt(0.2, 0.3, 0.7)}}, {}
    yield "white_room", {
        "camera": {"position": [0, 1.3, 1.9], "look_at": [0, 1.1, 0], "fov": 65},
        "lights": [panel([0, 2.58, 0], [-90, 0, 0], [0.6, 0.6], 5)],
        "objects": room(4, 2.6, 4, "white", front=True) + [ball(-0.8, -0.4, "white"), {
            "shape": "box", "size": [0.7, 0.9, 0.7], "position": [1, 0, -0.8], "rotate": 30, "material": "white"}],
        "materials": {"white": matt(0.9)}}, {}
    yield "soft_sun", {
        "camera": {"position": [0.5, 2.2, 5], "look_at": [0, 0.6, 0], "fov": 38}, "sky": [0.15, 0.2, 0.3],
        "lights": [{"kind": "sun", "elevation": 35, "azimuth": 70, "intensity": 5, "angle": 6}],
        "objects": [floor, {"shape": "box", "size": [0.3, 2, 0.3], "material": "post"}, ball(0.9, 0.6, "post", 0.35)],
        "materials": {"floor": matt(0.5), "post": matt(0.7, 0.5, 0.3)}}, {}
    yield "point_lamps", {
        "camera": {"position": [0, 1.3, 3.4], "look_at": [0, 1.0, 0], "fov": 50},
        "lights": [{"kind": "point", "position": p, "intensity": 3, "color": c} for p, c in
                   (([-1.2, 1.6, 0.8], [1, 0.4, 0.3]), ([1.2, 1.2, 0.2], [0.3, 1, 0.4]), ([0, 2.1, -1.2], [0.4, 0.5, 1]))],
        "objects": room(4, 2.6, 4, "white") + [ball(-0.6, 0, "white"), {
            "shape": "cylinder", "radius": 0.3, "height": 1.2, "segments": 128, "position": [0.8, 0, -0.6], "material": "white"}],
        "materials": {"white": matt(0.7)}}, {}


def materials_room(things, materials, **film):
    """A matt room under a panel, with things in it."""
    return {"camera": {"position": [0, 1.4, 3.4], "look_at": [0, 1.0, 0], "fov": 50},
            "lights": [panel([0, 2.58, 0.4], [-90, 0, 0], [1, 1], 8, (1, 0.9, 0.8))],
            "objects": room(4, 2.6, 4, "white", "red", "blue") + things,
            "materials": {"white": matt(0.7), "red": matt(0.6, 0.15, 0.1), "blue": matt(0.2, 0.3, 0.7), **materials}, **film}


def lens(radius=0.5, curvature=0.8, steps=12):
    """Profile of a lens whose faces are parts of spheres, from its lower face's middle to its upper one's."""
    sag = curvature - math.sqrt(curvature**2 - radius**2)
    face = [(radius * k / steps, sag - (curvature - math.sqrt(curvature**2 - (radius * k / steps)**2)) + 0.01) for k in range(steps + 1)]
    return [[r, -h] for r, h in face] + [[r, h] for r, h in reversed(face)]


def hard():
    """What is thin, clear, mirroring, cut out, tiny or huge."""
    box = {"shape": "box", "size": [0.7, 0.9, 0.7], "position": [0.8, 0, -0.8], "rotate": 30, "material": "white"}
    yield "glass_panes", materials_room([
        box, ball(-0.9, -0.6, "red"), {"shape": "quad", "size": [1, 1.4], "position": [-0.6, 0.7, 0.5], "rotate": 30, "material": "clear"},
        {"shape": "quad", "size": [1, 1.4], "position": [0.7, 0.7, 0.4], "rotate": -20, "material": "green glass"}],
        {"clear": {"base_color": 1, "transmission": 1, "roughness": 0, "metallic": 0},
         "green glass": {"base_color": [0.3, 0.8, 0.4], "transmission": 1, "roughness": 0, "metallic": 0}}), {"caustics": False}
    clear = {"base_color": 1, "transmission": 1, "roughness": 0, "ior": 1.5, "solid": True}
    yield "glass_sphere", materials_room([box, ball(-0.5, -0.2, "solid")], {"solid": clear}), {}
    yield "glass_lens", materials_room([
        box, {"shape": "lathe", "segments": 128, "profile": lens(), "position": [-0.4, 0.7, 0.2], "rotate": [90, 20, 0], "material": "solid"}],
        {"solid": clear}), {}
    yield "glass_of_liquid", materials_room([
        box, {"shape": "lathe", "segments": 128, "position": [-0.4, 0.01, 0], "material": "solid",
              "profile": [[0, 0], [0.45, 0], [0.45, 0.9], [0.38, 0.9], [0.38, 0.1], [0, 0.1]]},
        # A hair of air between them: Cycles has no rule for what touches.
        {"shape": "lathe", "segments": 128, "position": [-0.4, 0.12, 0], "material": "liquid",
         "profile": [[0, 0], [0.375, 0], [0.375, 0.6], [0, 0.6]]}],
        {"solid": clear, "liquid": {**clear, "ior": 1.33, "attenuation": [0.9, 0.3, 0.2], "attenuation_distance": 0.5}}), {}
    yield "mirrors", materials_room([
        box, ball(-0.6, 0, "silver"), {"shape": "quad", "size": [1.6, 1.6], "position": [-0.9, 1.2, -1.9], "rotate": 0, "material": "silver"},
        {"shape": "quad", "size": [1.6, 1.6], "position": [1.95, 1.2, 0], "rotate": -90, "material": "silver"}],
        {"silver": {"base_color": 0.9, "metallic": 1, "roughness": 0}}), {}
    metals = {f"metal{i}": {"base_color": [0.9, 0.7, 0.5], "metallic": 1, "roughness": r} for i, r in enumerate((0.35, 0.6, 1.0))}
    yield "rough_metals", materials_room([
        ball(-1.1, -0.3, "metal0"), {**box, "position": [0, 0, -0.6], "material": "metal1"}, ball(1.1, -0.3, "metal2"),
        {"shape": "quad", "size": [3, 0.8], "position": [0, 1.9, -1.95], "material": "metal0"}], metals), {}
    yield "thin_things", {
        "camera": {"position": [0, 1.2, 4], "look_at": [0, 0.8, 0], "fov": 40}, "sky": [0.4, 0.5, 0.7],
        "lights": [{"kind": "sun", "elevation": 50, "azimuth": 40, "intensity": 4, "angle": 2}],
        "objects": [{"shape": "plane", "size": [40, 40], "material": "floor"}] + [
            {"shape": "box", "size": [0.01, 1.6, 0.01], "position": [-1.5 + 0.1 * i, 0, -0.3], "material": "bar"} for i in range(31)] + [
            {"shape": "plane", "size": [1.2, 0.8], "position": [0, 0.5, 0.8], "rotate": [3, 20, 0], "material": "sheet"}],
        "materials": {"floor": matt(0.5), "bar": matt(0.3, 0.3, 0.3), "sheet": {**matt(0.8, 0.5, 0.3), "double_sided": True}}}, {}
    yield "many_small_lamps", materials_room(
        [box, ball(-0.6, 0, "white")], {},
        lights=[{"kind": "sphere", "position": [-1.8 + 0.4 * i, 0.15 + 0.55 * j, -1.8 + 0.4 * ((3 * i + 5 * j) % 10)], "radius": 0.02,
                 "intensity": 60, "color": [[1, 0.6, 0.3], [0.4, 0.6, 1], [0.5, 1, 0.5]][(i + j) % 3]} for i in range(10) for j in range(5)]), {}
    yield "textured_emission", materials_room(
        [box, ball(-0.8, 0.3, "white"), {"shape": "quad", "size": [2.4, 1.2], "position": [0, 1.5, -1.9], "material": "screen"}],
        {"screen": {"base_color": 0, "emission": 6, "emission_texture": "screen.png"}}, lights=[]), {}
    yield "cut_outs", {
        "camera": {"position": [0.8, 1.6, 3.6], "look_at": [0, 0.6, 0], "fov": 42}, "sky": [0.4, 0.5, 0.7],
        "lights": [{"kind": "sun", "elevation": 40, "azimuth": 200, "intensity": 4, "angle": 1}],
        "objects": [{"shape": "plane", "size": [40, 40], "material": "floor"},
                    {"shape": "quad", "size": [1.6, 1.6], "position": [0, 0.8, 0], "material": "leaves"}],
        "materials": {"floor": matt(0.5), "leaves": {"base_color": [0.4, 0.7, 0.3], "texture": "leaves.png", "alpha": "mask", "double_sided": True}}}, {}
    for name, size in (("tiny", 1e-3), ("huge", 1e4)):
        film = next(f for n, f, _ in own() if n == "cornell")
        yield name, json.loads(json.dumps(film), object_hook=lambda thing, k=size: scaled(thing, k)), {}


def scaled(thing, factor):
    """What has a place or size, times `factor`; intensities are radiances and stay."""
    for key in ("position", "look_at", "size", "radius"):
        if key in thing:
            thing[key] = [factor * v for v in thing[key]] if isinstance(thing[key], list) else factor * thing[key]
    return thing


def images():
    """What scenes paint with, by name: rows of RGBA from the top."""
    # Texels by the dozen alike: Cycles interpolates what is coded, not the light.
    screen = [[(40 + 25 * (x // 16), 255 - 25 * (y // 16), 90 if (x // 16 + y // 16) % 2 else 230, 255) for x in range(128)]
              for y in range(128)]
    leaves = [[(255, 255, 255, 255 if (x // 8 + 2 * (y // 8)) % 5 else 0) for x in range(40)] for y in range(40)]
    return {"screen.png": screen, "leaves.png": leaves}


def png(rows):
    def chunk(name, data):
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))
    raw = b"".join(b"\0" + bytes(v for p in row for v in p) for row in rows)
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", len(rows[0]), len(rows), 8, 6, 0, 0, 0)) +
            chunk(b"IDAT", zlib.compress(raw)) + chunk(b"IEND", b""))


def outdoors(eye, aim, fov=40, ground=None):
    """Sun and sky; on a floor where its height is given."""
    film = {"camera": {"position": eye, "look_at": aim, "fov": fov}, "sky": [0.5, 0.6, 0.8],
            "lights": [{"kind": "sun", "elevation": 50, "azimuth": 30, "intensity": 4, "angle": 1}]}
    if ground is not None:
        film["objects"] = [{"shape": "plane", "size": [40, 40], "position": [0, ground, 0], "material": "floor"}]
        film["materials"] = {"floor": matt(0.5)}
    return film


SKY_BOX = ["Material__75", "Material__76", "_3_-_Default", "_4_-_Default_1", "_5_-_Default", "_6_-_Default", "_7_-_Default",
           "_8_-_Default"]
MODELS = {  # name: file, parts to leave out (materials), film
    "sponza": ("sponza_dabrovic/sponza.glb", [], {
        "camera": {"position": [-11, 1.2, 0.6], "look_at": [0, 3.2, -0.6], "fov": 55}, "sky": [0.5, 0.7, 1.0],
        "lights": [{"kind": "sun", "elevation": 62, "azimuth": 28, "color": [1, 0.94, 0.82], "intensity": 12}]}),
    "sibenik": ("sibenik/sibenik.glb", ["glas", "staklo_zeleno", "staklo_crveno", "staklo_plavo", "staklo_zuto"], {
        "camera": {"position": [-60, 58, 6], "look_at": [300, 150, 0], "fov": 60}, "sky": [0.3, 0.35, 0.45],
        "lights": [panel([x, 380, 0], [-90, 0, 0], [40, 40], 90, (1, 0.85, 0.65)) for x in (-100, 120, 340)]}),
    "bathroom": ("bathroom/bathroom.glb", ["BulbGlass"], {
        "camera": {"position": [0.00724, 0.9124, -0.2276], "look_at": [-0.7447, 0.9279, -0.8867], "fov": 55},
        "sky": 0.2, "lights": [panel([-0.7, 2.1, -1.2], [-90, 0, 0], [0.5, 0.5], 20, (1, 0.92, 0.8))]}),
    "gltf_room": ("godot_gi/room.glb", [], {
        "camera": {"position": [0.6, 1.7, 4], "look_at": [0, 1.6, -2], "fov": 70}, "sky": [0.6, 0.8, 1],
        "lights": [{"kind": "sun", "elevation": 50, "azimuth": 30, "intensity": 5}]}),
    "city": ("gltf_anim/VC/VC.glb", SKY_BOX, outdoors([20, 12, 30], [0, 4, 0], 60)),
    "brain_stem": ("gltf_anim/BrainStem/BrainStem.glb", [], outdoors([1.5, 1.6, 3.4], [0, 0.9, 0], ground=0)),
    "cesium_man": ("gltf_anim/CesiumMan/CesiumMan.glb", [], outdoors([2, 1.3, 2.2], [0, 0.75, 0], ground=0)),
    "engine": ("gltf_anim/2CylinderEngine/2CylinderEngine.glb", [], outdoors([500, 400, 900], [0, -20, 0])),
    "box_animated": ("gltf_anim/BoxAnimated/BoxAnimated.glb", [], outdoors([1.3, 1.2, 2], [0, 0, 0], ground=-0.5)),
    "morph_cube": ("gltf_anim/AnimatedMorphCube/AnimatedMorphCube.glb", [], outdoors([2.6, 2.4, 4], [0, 0, 0], ground=-1)),
    "rigged_simple": ("gltf_anim/RiggedSimple/RiggedSimple.glb", [], outdoors([6, 5, 13], [0, 0, 0], ground=-4.575)),
    "gltf_cornell": ("cornell/gltf/CornellBox.glb", [], {
        "camera": {"position": [-278, 273, 800], "look_at": [-278, 273, 0], "fov": 39.3}}),
}


def matt_model(source, left_out):
    """The bytes of a .glb with positions and normals only, and matt materials."""
    data = open(source, "rb").read()
    length = struct.unpack("<I", data[12:16])[0]
    document, binary = json.loads(data[20:20 + length]), data[20 + length:]
    names = [m.get("name") for m in document["materials"]]
    for material in document["materials"]:
        factor = material.get("pbrMetallicRoughness", {}).get("baseColorFactor", [0.6, 0.5, 0.4, 1])
        extensions = {"KHR_materials_ior": {"ior": 1}}
        if "KHR_materials_emissive_strength" in material.get("extensions", {}):
            extensions["KHR_materials_emissive_strength"] = material["extensions"]["KHR_materials_emissive_strength"]
        emission = material.get("emissiveFactor", [0, 0, 0])
        name = material.get("name")
        material.clear()
        material.update({"name": name, "doubleSided": True, "emissiveFactor": emission, "extensions": extensions,
                         "pbrMetallicRoughness": {"baseColorFactor": factor[:3] + [1], "metallicFactor": 0, "roughnessFactor": 1}})
    for mesh in document["meshes"]:
        mesh.pop("weights", None)
        for part in mesh["primitives"]:
            part.pop("targets", None)
            part["attributes"] = {k: v for k, v in part["attributes"].items() if k in ("POSITION", "NORMAL")}
        mesh["primitives"] = [p for p in mesh["primitives"] if names[p["material"]] not in left_out]
    for node in document["nodes"]:
        node.pop("camera", None)
        node.pop("skin", None)
        node.pop("weights", None)
        if "mesh" in node and not document["meshes"][node["mesh"]]["primitives"]:
            del node["mesh"]
    kept = [i for i, mesh in enumerate(document["meshes"]) if mesh["primitives"]]
    document["meshes"] = [document["meshes"][i] for i in kept]
    for node in document["nodes"]:
        if "mesh" in node:
            node["mesh"] = kept.index(node["mesh"])
    for key in ("textures", "images", "samplers", "cameras", "animations", "skins", "extensions"):
        document.pop(key, None)
    document["extensionsUsed"] = ["KHR_materials_ior", "KHR_materials_emissive_strength"]
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    return struct.pack("<4sIII4s", b"glTF", 2, 20 + len(text) + len(binary), len(text), b"JSON") + text + binary


def moved(name, film, frames):
    """The film with linear motion, as much a frame however many there are."""
    end = (frames - 1) / 25

    def keyed(thing, change):
        keys = {k: thing.pop(k) for k in ("position", "look_at", "rotate") if k in thing}
        thing.update({"interpolation": "linear", "keys": [{"at": 0, **keys}, {"at": end, **change(keys)}]})

    if name == "cornell":
        # A box a thirtieth of a unit and four degrees a frame.
        keyed(film["objects"][-1], lambda at: {"position": [at["position"][0] - (frames - 1) / 30, 0, at["position"][2]],
                                               "rotate": at["rotate"] + 4 * (frames - 1)})
        return
    camera = film["camera"]
    way = [b - a for a, b in zip(camera["position"], camera["look_at"])]
    across = [-way[2], 0, way[0]]
    step = (frames - 1) / 250  # of the distance that it looks

    keyed(camera, lambda at: {k: [v + step * a for v, a in zip(at[k], across)] for k in ("position", "look_at")})


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("out")
    parser.add_argument("--models")
    parser.add_argument("--frames", type=int, default=1)
    parser.add_argument("names", nargs="*")
    arguments = parser.parse_args()
    scenes = list(checks()) + list(own()) + list(hard())
    if arguments.models:
        scenes += [(name, film, {"model": file, "left_out": out}) for name, (file, out, film) in MODELS.items()]
    for name, film, side in scenes:
        if arguments.names and name not in arguments.names:
            continue
        folder = os.path.join(arguments.out, name)
        os.makedirs(folder, exist_ok=True)
        film = {"size": [192, 128], "frames": arguments.frames, "frame_rate": 25, **film}
        if arguments.frames > 1:
            moved(name, film, arguments.frames)
        else:
            film["exposure"] = 0
        if "model" in side:
            film["scene"] = "model.glb"
            with open(os.path.join(folder, "model.glb"), "wb") as file:
                file.write(matt_model(os.path.join(arguments.models, side["model"]), side["left_out"]))
        for image, rows in images().items():
            if image in json.dumps(film):
                open(os.path.join(folder, image), "wb").write(png(rows))
        side["seed"] = zlib.crc32(name.encode()) % 1000
        json.dump(film, open(os.path.join(folder, "film.json"), "w"), indent=1)
        json.dump(side, open(os.path.join(folder, "side.json"), "w"))
        print(name)


main()
