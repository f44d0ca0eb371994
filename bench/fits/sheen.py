#!/usr/bin/env python3
"""bench/fits/sheen.py FOLDER

The fit of the albedo of Blender 4's fibres (docs/measurements.md#sheen). The Python has the modules bpy, from Blender 4 on, and numpy.
Cycles shows balls of a Sheen BSDF in an even world, each as no other saw it; what they reflect is sorted by cosine, and ln albedo fitted by powers
of the cosine's root and the roughness' logarithm. Prints coefficients and the largest error."""
import math
import pathlib
import sys

import bpy
import numpy as np

SIDE, BINS = 512, 40
ROUGHNESS = [0.1, 0.15, 0.2, 0.25, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0]
POWERS = (3, 4)


def film(path):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.engine, scene.cycles.samples, scene.cycles.max_bounces, scene.cycles.use_denoising = "CYCLES", 128, 0, False
    scene.world = bpy.data.worlds.new("even")
    scene.world.use_nodes = True
    scene.world.node_tree.nodes["Background"].inputs[0].default_value = (1, 1, 1, 1)
    for k, roughness in enumerate(ROUGHNESS):
        material = bpy.data.materials.new(str(k))
        material.use_nodes = True
        tree = material.node_tree
        tree.nodes.clear()
        sheen = tree.nodes.new("ShaderNodeBsdfSheen")
        sheen.inputs["Color"].default_value, sheen.inputs["Roughness"].default_value = (1, 1, 1, 1), roughness
        tree.links.new(sheen.outputs[0], tree.nodes.new("ShaderNodeOutputMaterial").inputs["Surface"])
        bpy.ops.mesh.primitive_uv_sphere_add(radius=0.48, segments=256, ring_count=128, location=(k, 0, 0))
        ball = bpy.context.object
        ball.data.materials.append(material)
        ball.data.polygons.foreach_set("use_smooth", [True] * len(ball.data.polygons))
        ball.visible_diffuse = ball.visible_glossy = ball.visible_shadow = False
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    scene.collection.objects.link(camera)
    scene.camera, camera.data.type, camera.data.ortho_scale = camera, "ORTHO", len(ROUGHNESS)
    camera.location, camera.rotation_euler = ((len(ROUGHNESS) - 1) / 2, -10, 0), (math.pi / 2, 0, 0)
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = SIDE * len(ROUGHNESS), SIDE, 100
    scene.render.image_settings.file_format, scene.render.image_settings.color_depth = "OPEN_EXR", "32"
    scene.render.filepath = str(path)
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(str(path))
    pixels = np.empty(SIDE * len(ROUGHNESS) * SIDE * 4, dtype=np.float32)
    image.pixels.foreach_get(pixels)
    return pixels.reshape(SIDE, -1, 4)[..., 1]


def table(pixels):
    """Rows of roughness, cosine, albedo."""
    y, x = np.mgrid[0:SIDE, 0:SIDE]
    across = np.hypot(x + 0.5 - SIDE / 2, y + 0.5 - SIDE / 2) / (0.48 * SIDE)
    cosine = np.sqrt(np.clip(1 - across**2, 0, 1))
    rows = []
    for k, roughness in enumerate(ROUGHNESS):
        for b in range(BINS):
            within = (cosine > b / BINS) & (cosine <= (b + 1) / BINS) & (across < 0.998)
            if within.any():
                rows.append((roughness, cosine[within].mean(), pixels[:, k * SIDE:(k + 1) * SIDE][within].mean()))
    return np.array(rows).T


def main():
    r, c, albedo = table(film(pathlib.Path(sys.argv[1]) / "sheen.exr"))
    albedo = np.maximum(albedo, 1e-5)
    u, v = np.sqrt(c), np.log(r)
    terms = np.stack([u**i * v**j for i in range(POWERS[0] + 1) for j in range(POWERS[1] + 1)], 1)
    weight = even = np.maximum(albedo, 1e-3)
    for _ in range(40):  # those that err most weigh most
        found = np.linalg.lstsq(terms * weight[:, None], np.log(albedo) * weight, rcond=None)[0]
        error = np.abs(np.exp(terms @ found) - albedo)
        weight = even * (1 + 60 * error)
    print(np.array2string(found.reshape(POWERS[0] + 1, -1), precision=5, separator=", "))
    print(f"cosines from {c.min():.3f} on; largest error {error.max():.4f}, root of mean square {np.sqrt((error**2).mean()):.4f}")


main()
