# SPDX-License-Identifier: Apache-2.0 OR GPL-3.0-or-later
"""blender -b -noaudio --factory-startup --python-exit-code 1 -P exports.py -- FOLDER [SAMPLES]

Makes one scene and exports it as every format that Blender writes and render2mpeg reads: FOLDER/scene.glb, .fbx, .dae, .obj,
.blend; 40 frames at 25 a second. Renders frames 1 and 40 with Cycles, FOLDER/cycles_0001.exr, cycles_0040.exr.
What is in it: a floor, a red ball that flies in an arc, a metal box that turns, a glowing panel, a bar that an armature bends,
whose armature stands aside of the origin, a textured wall, a lamp, a sun, and a camera that moves.
"""
import math
import os
import sys

import bpy

LAST = 40


def material(name, color, metallic=0.0, roughness=0.6, emission=0.0):
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    inputs = made.node_tree.nodes["Principled BSDF"].inputs
    inputs["Base Color"].default_value = (*color, 1)
    inputs["Metallic"].default_value, inputs["Roughness"].default_value = metallic, roughness
    if emission:
        light = inputs["Emission Color" if "Emission Color" in inputs else "Emission"]
        light.default_value, inputs["Emission Strength"].default_value = (*color, 1), emission
    return made


def textured(name, path):
    made = material(name, (1, 1, 1))
    picture = bpy.data.images.new("checks", 64, 64)
    picture.pixels = [v for y in range(64) for x in range(64)
                      for v in ((0.7, 0.3, 0.1, 1) if (x // 8 + y // 8) % 2 else (0.1, 0.3, 0.5, 1))]
    picture.filepath_raw, picture.file_format = path, "PNG"
    picture.save()
    node = made.node_tree.nodes.new("ShaderNodeTexImage")
    node.image = picture
    made.node_tree.links.new(node.outputs[0], made.node_tree.nodes["Principled BSDF"].inputs["Base Color"])
    return made


def wear(worn):
    bpy.context.object.data.materials.append(worn)
    return bpy.context.object


def keyed(thing, path, *keys):
    for frame, value in keys:
        setattr(thing, path, value)
        thing.keyframe_insert(path, frame=frame)
    for curve in thing.animation_data.action.fcurves:
        for key in curve.keyframe_points:
            key.interpolation = "LINEAR"


def bent_bar():
    bpy.ops.mesh.primitive_cylinder_add(radius=0.15, depth=1.6, location=(-1.5, 0.6, 0.8), vertices=32)
    bar = wear(material("bar", (0.2, 0.5, 0.25)))
    for _ in range(2):
        bpy.ops.object.mode_set(mode="EDIT")
        bpy.ops.mesh.select_all(action="SELECT")
        bpy.ops.mesh.subdivide()
        bpy.ops.object.mode_set(mode="OBJECT")
    bpy.ops.object.armature_add(location=(-1.5, 0.6, 0))
    bones = bpy.context.object
    bpy.ops.object.mode_set(mode="EDIT")
    bones.data.edit_bones[0].tail = (0, 0, 0.8)
    upper = bones.data.edit_bones.new("upper")
    upper.head, upper.tail, upper.parent = (0, 0, 0.8), (0, 0, 1.6), bones.data.edit_bones[0]
    bpy.ops.object.mode_set(mode="POSE")
    bone = bones.pose.bones["upper"]
    bone.rotation_mode = "XYZ"
    for frame, angle in ((1, 0), (LAST, 1.2)):
        bone.rotation_euler = (angle, 0, 0)
        bone.keyframe_insert("rotation_euler", frame=frame)
    bpy.ops.object.mode_set(mode="OBJECT")
    bar.select_set(True)
    bpy.context.view_layer.objects.active = bones
    bpy.ops.object.parent_set(type="ARMATURE_AUTO")


def make(folder):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.resolution_x, scene.render.resolution_y = 240, 160
    scene.frame_start, scene.frame_end, scene.render.fps = 1, LAST, 25
    bpy.ops.mesh.primitive_plane_add(size=8)
    wear(material("floor", (0.5, 0.5, 0.5), roughness=1.0))
    bpy.ops.mesh.primitive_plane_add(size=4, location=(0, 2.5, 2), rotation=(math.pi / 2, 0, 0))
    wear(textured("wall", os.path.join(folder, "checks.png")))
    bpy.ops.mesh.primitive_uv_sphere_add(radius=0.4, segments=48, ring_count=24)
    bpy.ops.object.shade_smooth()
    ball = wear(material("ball", (0.7, 0.08, 0.06), roughness=0.4))
    keyed(ball, "location", (1, (-0.6, -0.6, 0.4)), (20, (0.2, -0.6, 1.4)), (LAST, (0.9, -0.6, 0.4)))
    bpy.ops.mesh.primitive_cube_add(size=0.9, location=(1.5, 0.6, 0.45))
    box = wear(material("steel", (0.8, 0.75, 0.7), metallic=1.0, roughness=0.35))
    keyed(box, "rotation_euler", (1, (0, 0, 0.3)), (LAST, (0, 0, 1.9)))
    bpy.ops.mesh.primitive_plane_add(size=0.8, location=(0, 2.3, 3), rotation=(-math.pi / 2, 0, 0))
    panel = wear(material("panel", (0.9, 0.8, 0.6), emission=4.0))
    panel.rotation_euler = (math.pi / 2, 0, 0)
    bent_bar()
    bpy.ops.object.light_add(type="POINT", location=(-1.8, -2, 3))
    bpy.context.object.data.energy, bpy.context.object.data.shadow_soft_size = 150, 0.0
    bpy.ops.object.light_add(type="SUN", rotation=(0.6, 0.5, 0))
    bpy.context.object.data.energy, bpy.context.object.data.angle = 1.5, 0.0
    bpy.ops.object.camera_add(rotation=(1.33, 0, 0))
    camera = bpy.context.object
    camera.data.angle = 0.8
    keyed(camera, "location", (1, (-0.5, -7, 2.4)), (LAST, (0.5, -7, 2.4)))
    scene.camera = camera
    scene.world = bpy.data.worlds.new("world")
    scene.world.color = (0, 0, 0)


def render(folder, samples):
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.cycles.samples, scene.cycles.use_denoising = samples, False
    scene.render.image_settings.file_format = "OPEN_EXR"
    for frame in (1, LAST):
        scene.frame_set(frame)
        scene.render.filepath = os.path.join(folder, f"cycles_{frame:04d}.exr")
        bpy.ops.render.render(write_still=True)


def main():
    folder, *samples = sys.argv[sys.argv.index("--") + 1:]
    make(folder)
    path = os.path.join(folder, "scene")
    bpy.ops.export_scene.gltf(filepath=path + ".glb", export_cameras=True, export_lights=True)
    bpy.ops.export_scene.fbx(filepath=path + ".fbx", path_mode="COPY", embed_textures=True)
    bpy.ops.wm.collada_export(filepath=path + ".dae")
    bpy.context.scene.frame_set(1)
    if bpy.app.version < (4, 0, 0):
        bpy.ops.export_scene.obj(filepath=path + ".obj", path_mode="RELATIVE")
    else:
        bpy.ops.wm.obj_export(filepath=path + ".obj", path_mode="RELATIVE")
    bpy.ops.wm.save_as_mainfile(filepath=path + ".blend")
    if samples:
        render(folder, int(samples[0]))


main()
