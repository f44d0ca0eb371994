# SPDX-License-Identifier: Apache-2.0 OR GPL-3.0-or-later
"""blender -b --factory-startup -noaudio --python-exit-code 1 -P walk_nodes.py -- FOLDER [--compare | --table]

Writes FOLDER/nodes.blend: a ball for each output of each shader node that this Blender has, in rows, and FOLDER/nodes.json, their
names. With --compare holds FOLDER/ours0000.exr against cycles0000.exr, made of it: a line for each ball, OFF, by how much its
mean is off, as a share of it, and by how much those of its sixteen parts are, and NAME. With --table prints the rows of
docs/scenes.md that say what is baked and what is told, by FOLDER/export.json, what the export told of it.
"""
import json
import math
import os
import sys

import bpy
import numpy as np

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [HERE, os.path.join(HERE, "..", "..", "blender")]
from make_blends import add_camera, add_lamp, start, world_of  # noqa: E402

COLUMNS, SIDE, APART = 16, 16, 20
# Of other trees than materials' (lines, lamps, worlds), and what holds others.
ELSEWHERE = {"GROUP", "SCRIPT", "UVALONGSTROKE", "OUTPUT_AOV", "OUTPUT_LIGHT", "OUTPUT_LINESTYLE", "OUTPUT_MATERIAL", "OUTPUT_WORLD"}
VOLUMES = {"VOLUME_ABSORPTION", "VOLUME_SCATTER", "PRINCIPLED_VOLUME"}


def kinds():
    """Nodes by name, in the order of their names."""
    probe = bpy.data.materials.new("probe")
    probe.use_nodes = True
    tree, out = probe.node_tree, []
    for name in sorted(n for n in dir(bpy.types) if n.startswith("ShaderNode")):
        try:
            node = tree.nodes.new(name)
        except (RuntimeError, TypeError):
            continue
        if node.type not in ELSEWHERE:
            out.append((name, [k for k, o in enumerate(node.outputs) if o.enabled]))
        tree.nodes.remove(node)
    bpy.data.materials.remove(probe)
    return out


def feed(tree, node):
    """Gives what changes values something to change."""
    if node.type.startswith("TEX_") or any(s.type == "SHADER" for s in node.outputs):
        return
    place = tree.nodes.new("ShaderNodeTexCoord").outputs["Generated"]
    entry = next((s for s in node.inputs if s.enabled and s.type in {"RGBA", "VECTOR"} and s.name not in {"Normal", "Tangent"}), None)
    entry = entry or next((s for s in node.inputs if s.enabled and s.type == "VALUE" and node.type not in {"FRESNEL", "LAYER_WEIGHT", "BLACKBODY", "WAVELENGTH"}), None)
    if entry is not None:
        if node.type == "NORMAL_MAP":  # a little off
            bend = tree.nodes.new("ShaderNodeMixRGB")
            bend.inputs[0].default_value, bend.inputs[1].default_value = 0.2, (0.5, 0.5, 1, 1)
            tree.links.new(place, bend.inputs[2])
            place = bend.outputs[0]
        tree.links.new(place, entry)


def material_of(name, kind, output):
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    tree = material.node_tree
    shader, end = tree.nodes["Principled BSDF"], tree.nodes["Material Output"]
    node = tree.nodes.new(kind)
    node.name = name
    feed(tree, node)
    socket = node.outputs[output]
    if node.type == "TEX_IMAGE":
        node.image = bpy.data.images.new("grid", 64, 64)
        node.image.generated_type = "COLOR_GRID"
    if node.type in VOLUMES:
        tree.nodes.remove(shader)
        tree.links.new(socket, end.inputs["Volume"])
    elif socket.type == "SHADER":
        tree.links.new(socket, end.inputs["Surface"])
    elif "DISPLACEMENT" in node.type:
        tree.links.new(socket, end.inputs["Displacement"])
    elif node.type in {"BUMP", "BEVEL", "NORMAL_MAP"}:
        tree.links.new(socket, shader.inputs["Normal"])
    else:
        clamp = tree.nodes.new("ShaderNodeMixRGB")
        clamp.use_clamp, clamp.inputs[0].default_value = True, 0
        tree.links.new(socket, clamp.inputs[1])
        # White would send more than it receives, which only Cycles' Principled BSDF does.
        dim = tree.nodes.new("ShaderNodeMixRGB")
        dim.inputs[0].default_value, dim.inputs[2].default_value = 0.2, (0, 0, 0, 1)
        tree.links.new(clamp.outputs[0], dim.inputs[1])
        tree.links.new(dim.outputs[0], shader.inputs["Base Color"])
    return material


def make(folder):
    scene = start(1)
    scene.cycles.volume_bounces = 12  # its own 0 are a limit, which is told
    world_of((0.5, 0.5, 0.5))
    balls = []
    for kind, outputs in kinds():
        for output in outputs:
            material = material_of(f"{kind[10:]} {output}", kind, output)
            balls.append(material)
    rows = math.ceil(len(balls) / COLUMNS)
    scene.render.resolution_x, scene.render.resolution_y = SIDE * COLUMNS, SIDE * rows
    add_lamp("SUN", (0, -5, 3), (-2, 0, 0), name="Sun", energy=1.5, angle=0.1)
    for k, material in enumerate(balls):
        column, row = k % COLUMNS, k // COLUMNS
        # Neighbours stand so far apart in depth that none lights another, nor throws its shadow there.
        place = (column - (COLUMNS - 1) / 2, APART * ((column + 3 * row) % 8), (rows - 1) / 2 - row)
        volume = not material.node_tree.nodes["Material Output"].inputs["Surface"].is_linked and material.node_tree.nodes["Material Output"].inputs["Volume"].is_linked
        if volume:
            bpy.ops.mesh.primitive_cube_add(size=0.7, location=place)
        else:
            bpy.ops.mesh.primitive_uv_sphere_add(radius=0.42, location=place, segments=32, ring_count=16)
            bpy.ops.object.shade_smooth()
        thing = bpy.context.object
        thing.name = material.name
        thing.color, thing.pass_index, material.pass_index = (0.2, 0.7, 0.4, 0.6), 1, 1
        thing.data.materials.append(material)
    camera = add_camera((0, -20, 0), (0, 0, 0))
    camera.data.type, camera.data.ortho_scale, camera.data.clip_end = "ORTHO", max(COLUMNS, rows), 10 * APART
    with open(os.path.join(folder, "nodes.json"), "w") as file:
        json.dump([m.name for m in balls], file)
    bpy.ops.wm.save_as_mainfile(filepath=os.path.join(os.path.abspath(folder), "nodes.blend"), check_existing=False)


def load(path):
    image = bpy.data.images.load(path)
    image.colorspace_settings.name = "Non-Color"
    pixels = np.empty(image.size[0] * image.size[1] * image.channels, dtype=np.float32)
    image.pixels.foreach_get(pixels)
    return pixels.reshape(image.size[1], image.size[0], image.channels)[::-1, :, :3].astype(float)


def compare(folder):
    with open(os.path.join(folder, "nodes.json")) as file:
        names = json.load(file)
    ours, truth = (load(os.path.join(folder, who + "0000.exr")) for who in ("ours", "cycles"))
    for k, name in enumerate(names):
        top, left = k // COLUMNS * SIDE, k % COLUMNS * SIDE
        parts = [p[top:top + SIDE, left:left + SIDE].reshape(4, SIDE // 4, 4, SIDE // 4, 3).mean(axis=(1, 3)) for p in (ours, truth)]
        mean = max(parts[1].mean(), 0.02)
        print(f"OFF {abs(parts[0].mean() - parts[1].mean()) / mean:.4f} {np.sqrt(((parts[0] - parts[1]) ** 2).mean()) / mean:.4f} {name}")


def table(folder):
    from film_export.kept import OTHERS, SHADERS
    with open(os.path.join(folder, "export.json")) as file:
        told = {line.split(":")[0] for line in json.load(file)["lost"]}
    probe = bpy.data.materials.new("probe")
    probe.use_nodes = True
    by_itself = {kind for kind, *_ in SHADERS + OTHERS}
    rows = {"baked": [], "told": []}
    for kind, outputs in kinds():
        node = probe.node_tree.nodes.new(kind)
        if node.type in by_itself:
            continue
        lost = [node.outputs[k].name for k in outputs if f"{kind[10:]} {k}" in told]
        label = node.bl_label.replace(" (Legacy)", "")
        if len(lost) < len(outputs):
            rows["baked"].append(label)
        if lost:
            rows["told"].append(label if len(lost) == len(outputs) else f"{label} ({', '.join(lost)})")
    for fate, names in rows.items():
        print(f"ROW | {fate} | {', '.join(dict.fromkeys(names))} |")


def main():
    folder, *rest = sys.argv[sys.argv.index("--") + 1:]
    (compare if "--compare" in rest else table if "--table" in rest else make)(folder)


main()
