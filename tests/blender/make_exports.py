# SPDX-License-Identifier: Apache-2.0 OR GPL-3.0-or-later
"""blender -b --factory-startup -noaudio --python-exit-code 1 -P make_exports.py -- FOLDER NAME...

Writes FOLDER/NAME.blend: `workshop`, whose export has to be right in itself, and `wide_spot`, to be held against Cycles.
"""
import math
import os
import sys

import bpy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from make_blends import add_camera, add_hair, add_lamp, add_material, add_matt, add_object, add_particles, add_primitive, link, start, world_of  # noqa: E402


def checkered(name, dark, light):
    material = add_matt(name, (1, 1, 1))
    checker = material.node_tree.nodes.new("ShaderNodeTexChecker")
    place = material.node_tree.nodes.new("ShaderNodeTexCoord")
    material.node_tree.links.new(place.outputs["Generated"], checker.inputs["Vector"])
    checker.inputs["Color1"].default_value, checker.inputs["Color2"].default_value = (*dark, 1), (*light, 1)
    checker.inputs["Scale"].default_value = 4
    link(material, checker.outputs["Color"])
    return material


def mixed(name, a, b):
    """A colour that is the same all over, by a node."""
    material = add_matt(name, (1, 1, 1))
    mix = material.node_tree.nodes.new("ShaderNodeMixRGB")
    mix.inputs[0].default_value, mix.inputs[1].default_value, mix.inputs[2].default_value = 0.5, (*a, 1), (*b, 1)
    link(material, mix.outputs[0])
    return material


def bumped(name, strength):
    material = add_material(name, (0.6, 0.4, 0.3))
    nodes, links = material.node_tree.nodes, material.node_tree.links
    noise, bump = nodes.new("ShaderNodeTexNoise"), nodes.new("ShaderNodeBump")
    bump.inputs["Strength"].default_value, bump.inputs["Distance"].default_value = strength, 1.0
    links.new(noise.outputs["Fac"], bump.inputs["Height"])
    links.new(bump.outputs[0], nodes["Principled BSDF"].inputs["Normal"])
    return material


def instances_that_change_places():
    """Two things at one place in turn; ten instances of a moving thing beside a lamp of their own."""
    for k, name in enumerate(("First", "Second")):
        thing = add_primitive("cube", add_matt(name, (0.3, 0.3, 0.3)), size=0.2, location=(3 + k, 0, 0.1))
        for frame in (1, 3):
            thing.hide_render = (frame == 1) == (k == 1)
            thing.keyframe_insert("hide_render", frame=frame)
    flock = bpy.data.collections.new("Flock")
    bird = add_primitive("cone", add_matt("Bird", (0.2, 0.2, 0.4)), radius1=0.05, depth=0.1)
    bpy.context.scene.collection.objects.unlink(bird)
    flock.objects.link(bird)
    for k in range(10):
        whole = add_object(f"Flock {k}", None, (-3, 0.3 * k, 2))
        whole.instance_type, whole.instance_collection = "COLLECTION", flock
        if k % 2:
            for frame, high in ((1, 2), (4, 3)):
                whole.location.z = high
                whole.keyframe_insert("location", frame=frame)


def workshop():
    start(4)
    world_of((0.4, 0.5, 0.7))
    ball = add_primitive("uv_sphere", add_matt("Skin", (0.6, 0.4, 0.3)), location=(0, 6, 4), segments=12, ring_count=6)
    ball.data.materials.append(add_hair(0.6))
    settings = add_particles(ball, 20, 0.5, 10, 0.03).settings
    settings.render_step, settings.child_length = 4, 0.6
    branch = bpy.data.curves.new("Branch", "CURVE")
    branch.dimensions, branch.bevel_depth, branch.use_fill_caps = "3D", 0.3, True
    spline = branch.splines.new("POLY")
    spline.points.add(1)
    spline.points[0].co, spline.points[1].co = (-1.5, 2, 0, 1), (-1.5, 2, 3, 1)
    branch.materials.append(checkered("Bark", (0.1, 0.05, 0.02), (0.2, 0.1, 0.04)))
    add_object("Branch", branch)
    tiles = checkered("Tiles", (0.1, 0.1, 0.1), (0.7, 0.7, 0.7))
    for k in range(3):
        add_primitive("cube", tiles, name=f"Box {k}", size=1, location=(1.5 * k, 1, 0.5))
    far = add_primitive("cube", tiles, name="Far", size=0.9, location=(0, 60, 0.5))
    far.data.materials[0] = checkered("Far Tiles", (0.1, 0.1, 0.1), (0.7, 0.7, 0.7))
    for name, strength in (("Worn", 0.0), ("Rough", 1.0)):
        made = bumped(name, strength)
        for k, kind in enumerate(("cube", "cone", "plane")):
            add_primitive(kind, made, name=f"{name} {kind}", location=(4 + 3 * k, 3 + 9 * strength, 0.5))
    # None of its faces has the second material.
    bpy.data.objects["Worn cube"].data.materials.append(bpy.data.materials["Rough"])
    add_primitive("plane", mixed("Even", (0.2, 0.4, 0.6), (0.4, 0.2, 0.2)), size=20)
    add_lamp("SPOT", (0, 0, 5), (0, 0.01, 0), name="Spot", energy=400 * math.pi, spot_size=math.radians(120), spot_blend=0.4, shadow_soft_size=0)
    instances_that_change_places()
    add_camera((0, -4, 2), (0, 1, 1))


def wide_spot():
    start(1)
    world_of((0, 0, 0))
    add_primitive("plane", add_matt("Ground", (0.3, 0.3, 0.3)), size=30)
    add_lamp("SPOT", (0, 0, 4.8), (0, 0.001, 0), energy=2000, spot_size=math.radians(120), spot_blend=0.4, shadow_soft_size=0)
    add_camera((0, -0.01, 14), (0, 0, 0), lens=50)


FILMS = {film.__name__: film for film in (workshop, wide_spot)}


def main():
    folder, *names = sys.argv[sys.argv.index("--") + 1:]
    for name in names or FILMS:
        FILMS[name]()
        bpy.ops.wm.save_as_mainfile(filepath=os.path.join(os.path.abspath(folder), name + ".blend"), check_existing=False)


if __name__ == "__main__":
    main()
