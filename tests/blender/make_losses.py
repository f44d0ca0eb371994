# SPDX-License-Identifier: Apache-2.0 OR GPL-3.0-or-later
"""blender -b --factory-startup -noaudio --python-exit-code 1 -P make_losses.py -- FOLDER

Writes FOLDER/told.blend: a scene that asks for what a film does not show as Cycles does, each of which has to be told.
"""
import os
import sys

import bpy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from make_blends import add_camera, add_lamp, add_material, add_matt, add_primitive, start, world_of  # noqa: E402


def veil():
    """A material that rays pass, and pass again."""
    material = add_material("Veil")
    material.node_tree.nodes["Principled BSDF"].inputs["Alpha"].default_value = 0.5
    return material


def with_image(name, path):
    material = add_material(name)
    node = material.node_tree.nodes.new("ShaderNodeTexImage")
    node.image = bpy.data.images.new(name, 8, 8)
    node.image.source, node.image.filepath = "FILE", path
    material.node_tree.links.new(node.outputs[0], material.node_tree.nodes["Principled BSDF"].inputs["Base Color"])
    return material


def told():
    scene = start(2)
    world_of((0.5, 0.5, 0.5))
    scene.render.use_freestyle, scene.render.use_multiview, scene.render.use_stamp = True, True, True
    scene.render.views_format = "MULTIVIEW"
    cycles = scene.cycles
    cycles.film_exposure, cycles.transparent_max_bounces = 2, 6
    cycles.sample_clamp_direct, cycles.sample_clamp_indirect, cycles.diffuse_bounces = 3, 1, 0
    portal = add_lamp("AREA", (0, 0, 3), name="Portal", energy=200)
    portal.data.cycles.is_portal = True
    add_lamp("SUN", (0, 0, 5), (1, 2, 0), name="Sun", energy=2)
    add_primitive("plane", with_image("Gone", "//nowhere/gone.png"), size=4, name="Floor")
    add_primitive("cube", add_matt("Grey", (0.4, 0.4, 0.4)), size=1, location=(0, 0, 0.5), name="Shadowless").visible_shadow = False
    for k in range(8):
        add_primitive("plane", veil(), size=1, location=(0, -1 - 0.2 * k, 0.5), name=f"Veil {k}")
    panel = add_primitive("plane", add_matt("Panel", (0.9, 0.9, 0.9)), size=1, location=(0, 0, 2), name="Unseen")
    panel.visible_camera = False
    nowhere = add_primitive("cube", add_matt("Nowhere", (1, 0, 0)), size=1, location=(2, 0, 0), name="Nowhere")
    for ray in ("camera", "diffuse", "glossy", "transmission", "volume_scatter", "shadow"):
        setattr(nowhere, "visible_" + ray, False)
    camera = add_camera((0, -6, 2), (0, 0, 0.5))
    camera.data.clip_start, camera.data.clip_end = 0.5, 40
    camera.data.keyframe_insert("clip_end", frame=1)
    camera.data.clip_end = 30
    camera.data.keyframe_insert("clip_end", frame=2)


def main():
    folder = sys.argv[sys.argv.index("--") + 1]
    told()
    bpy.ops.wm.save_as_mainfile(filepath=os.path.join(os.path.abspath(folder), "told.blend"), check_existing=False)


main()
