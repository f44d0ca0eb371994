# SPDX-License-Identifier: Apache-2.0 OR GPL-3.0-or-later
"""blender -b --factory-startup -P make_volumes.py -- FOLDER

Writes FOLDER/volumes.blend: a baked gas domain, a sequence of its files as a Volume object, a box and a ball with even media, a moving
box whose density depends on where in the world it is, a ball whose density moves, and media that are not kept.
"""
import os
import sys

import bpy

folder = os.path.abspath(sys.argv[sys.argv.index("--") + 1])
os.chdir(folder)  # smoke's noise is written to the working directory, 25 MB
bpy.ops.wm.read_factory_settings(use_empty=True)
scene = bpy.context.scene
scene.render.fps, scene.frame_start, scene.frame_end = 24, 1, 6


def medium(name, **inputs):
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    end, node = tree.nodes.new("ShaderNodeOutputMaterial"), tree.nodes.new("ShaderNodeVolumePrincipled")
    tree.links.new(node.outputs[0], end.inputs["Volume"])
    for key, value in inputs.items():
        node.inputs[key.replace("_", " ")].default_value = value
    return material


def bake():
    """A burning cube in a domain of 2.5 x 2.5 x 4.5."""
    bpy.ops.mesh.primitive_cube_add(size=0.5, location=(1, 2, 0.5))
    bpy.context.object.name = "Source"
    bpy.ops.object.quick_smoke(style="BOTH")
    domain = next(thing for thing in scene.objects if thing.name != "Source")
    domain.name = "Domain"
    settings = domain.modifiers[0].domain_settings
    settings.resolution_max, settings.cache_type = 16, "ALL"  # with noise, as is usual
    settings.cache_directory, settings.cache_frame_end = os.path.join(folder, "cache"), 6
    with bpy.context.temp_override(object=domain, active_object=domain, selected_objects=[domain]):
        bpy.ops.fluid.bake_all()


def cube(name, material, location, scale=1):
    bpy.ops.mesh.primitive_cube_add(size=1, location=location)
    bpy.context.object.name, bpy.context.object.scale = name, (scale,) * 3
    bpy.context.object.data.materials.append(material)


bpy.ops.wm.save_as_mainfile(filepath=os.path.join(folder, "volumes.blend"))
bake()
cube("Even", medium("Even", Density=0.5, Color=(0.8, 0.7, 0.6, 1), Anisotropy=0.25), location=(4, 0, 1), scale=2)
bpy.ops.mesh.primitive_uv_sphere_add(location=(4, 4, 1))
bpy.context.object.name = "Ball"
bpy.context.object.data.materials.append(medium("Ball"))


def feed(name, *links):
    """A material whose density comes from nodes: (node, output, next node's input or setting)..."""
    material = medium(name)
    tree, source = material.node_tree, None
    for kind, entry, way_out, settings in links:
        node = tree.nodes.new(kind)
        for key, value in settings.items():
            if key in node.inputs:
                node.inputs[key].default_value = value
            else:
                setattr(node, key, value)
        if source is not None:
            tree.links.new(source, node.inputs[entry])
        source = node.outputs[way_out]
    tree.links.new(source, tree.nodes["Principled Volume"].inputs["Density"])
    return material


# Density 2 (x - 7.5) of the world's x.
cube("Ramp", feed("Ramp", ("ShaderNodeNewGeometry", None, "Position", {}), ("ShaderNodeSeparateXYZ", 0, "X", {}),
                  ("ShaderNodeMapRange", "Value", 0, {"From Min": 7.5, "From Max": 8.5, "To Max": 2.0})), location=(8, 0, 0))
ramp = bpy.context.object
ramp.keyframe_insert("location", frame=1)
ramp.location.x = 8.25
ramp.keyframe_insert("location", frame=6)
noise = feed("Noise", ("ShaderNodeTexCoord", None, "Object", {}), ("ShaderNodeTexNoise", "Vector", "Fac", {"noise_dimensions": "4D"}))
entry = noise.node_tree.nodes["Noise Texture"].inputs["W"]
for frame, entry.default_value in ((1, 0.0), (6, 3.0)):
    entry.keyframe_insert("default_value", frame=frame)
bpy.ops.mesh.primitive_uv_sphere_add(location=(8, 4, 1))
bpy.context.object.name = "Noise"
bpy.context.object.data.materials.append(noise)
tinted = medium("Tinted")
tinted.node_tree.links.new(tinted.node_tree.nodes.new("ShaderNodeTexNoise").outputs["Color"], tinted.node_tree.nodes["Principled Volume"].inputs["Color"])
cube("Tinted", tinted, location=(8, 8, 0))
bpy.ops.mesh.primitive_plane_add(location=(8, 12, 0))
bpy.context.object.name = "Open"
bpy.context.object.data.materials.append(medium("Open"))

cloud = bpy.data.volumes.new("Cloud")
cloud.filepath, cloud.is_sequence = os.path.join(folder, "cache", "data", "fluid_data_0001.vdb"), True
cloud.frame_duration, cloud.frame_start, cloud.sequence_mode = 4, 2, "CLIP"
cloud.materials.append(medium("Cloud", Density=3.0))
thing = bpy.data.objects.new("Cloud", cloud)
scene.collection.objects.link(thing)
thing.location, thing.scale = (0, 5, 0), (2, 2, 2)

camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
camera.location, camera.rotation_euler = (1, -12, 2), (1.5, 0, 0)
sun = bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN"))
for thing in (camera, sun):
    scene.collection.objects.link(thing)
scene.camera = camera
bpy.ops.wm.save_as_mainfile(filepath=os.path.join(folder, "volumes.blend"))
