# SPDX-License-Identifier: Apache-2.0 OR GPL-3.0-or-later
"""blender -b --factory-startup -P make_users_of_files.py -- FOLDER: image, volume, cache, sound and library .blend, of
which each uses the file picture.png, smoke.vdb, moves.mdd, voice.wav or part.blend of the folder. Only the last two are made."""
import os
import sys
import wave

import bpy

folder = os.path.abspath(sys.argv[sys.argv.index("--") + 1])


def path(name):
    return os.path.join(folder, name)


def of_image():
    picture = bpy.data.images.new("Picture", 1, 1)
    picture.source, picture.filepath = "FILE", path("picture.png")
    tree = bpy.data.materials["Material"].node_tree
    node = tree.nodes.new("ShaderNodeTexImage")
    node.image = picture
    tree.links.new(node.outputs["Color"], tree.nodes["Principled BSDF"].inputs["Base Color"])


def of_volume():
    smoke = bpy.data.volumes.new("Smoke")
    smoke.filepath = path("smoke.vdb")
    bpy.context.scene.collection.objects.link(bpy.data.objects.new("Smoke", smoke))


def of_cache():
    bpy.data.objects["Cube"].modifiers.new("Moves", "MESH_CACHE").filepath = path("moves.mdd")


def of_sound():
    with wave.open(path("voice.wav"), "wb") as file:
        file.setnchannels(1)
        file.setsampwidth(2)
        file.setframerate(48000)
        file.writeframes(bytes(9600))
    bpy.context.scene.sequence_editor_create().sequences.new_sound("Voice", path("voice.wav"), 1, 1)


def of_library():
    bpy.data.libraries.write(path("part.blend"), {bpy.data.objects["Cube"]})
    bpy.data.objects.remove(bpy.data.objects["Cube"])
    with bpy.data.libraries.load(path("part.blend"), link=True) as (_, linked):
        linked.objects = ["Cube"]
    bpy.context.scene.collection.objects.link(linked.objects[0])


for name, use in (("image", of_image), ("volume", of_volume), ("cache", of_cache), ("sound", of_sound), ("library", of_library)):
    bpy.ops.wm.read_homefile(use_factory_startup=True)
    bpy.context.scene.frame_end = 1
    use()
    bpy.ops.wm.save_as_mainfile(filepath=path(name + ".blend"), check_existing=False)
