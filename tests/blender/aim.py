# SPDX-License-Identifier: Apache-2.0 OR GPL-3.0-or-later
"""blender -b --factory-startup -noaudio --python-exit-code 1 -P aim.py -- REPOSITORY FOLDER

Writes FOLDER/plain.blend, a car-like body with smooth paint that drives past lamps and a sign, and FOLDER/aimed.blend, in which the
add-on's Aim Reflection has its door show the sign and its bonnet a blue lamp. Prints where frame 1 shows the point of the door.
"""
import math
import os
import sys

import bpy
from bpy_extras.object_utils import world_to_camera_view
from mathutils import Vector

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
sys.dont_write_bytecode = True
from install_extension import install  # noqa: E402

repository, folder = sys.argv[sys.argv.index("--") + 1:]
LAST = 12


def add(name, vertices, faces, material, place=(0, 0, 0), smooth=False):
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(vertices, [], faces)
    mesh.polygons.foreach_set("use_smooth", [smooth] * len(faces))
    mesh.materials.append(material)
    thing = bpy.data.objects.new(name, mesh)
    thing.location = place
    bpy.context.scene.collection.objects.link(thing)
    return thing


def paint(name, color, metallic=0.0, roughness=0.9, coat=0.0, light=0.0):
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    inputs = material.node_tree.nodes["Principled BSDF"].inputs
    says = {"Base Color": (*color, 1), "Metallic": metallic, "Roughness": roughness, "Clearcoat": coat, "Coat Weight": coat,
            "Clearcoat Roughness": 0.0, "Coat Roughness": 0.0, "Emission": (*color, 1), "Emission Color": (*color, 1),
            "Emission Strength": light}
    for key, value in says.items():
        if key in inputs:
            inputs[key].default_value = value
    return material


def body():
    """Rings of superellipses along x: bonnet, cabin, boot."""
    rings, sides, vertices = 48, 48, []
    for i in range(rings + 1):
        u = -1 + 2 * i / rings
        end = max(1 - abs(u) ** 4, 0.0) ** 0.5
        height = 0.75 * end + 0.5 * math.exp(-((u + 0.1) / 0.42) ** 4)
        for k in range(sides):
            t = 2 * math.pi * k / sides
            c, s = math.cos(t), math.sin(t)
            y = 0.85 * (0.35 + 0.65 * end) * math.copysign(abs(c) ** 0.7, c)
            z = 0.75 + 0.5 * height * math.copysign(abs(s) ** 0.8, s)
            vertices.append((2.1 * u, y * (1 - 0.25 * max(z - 0.9, 0)), max(z, 0.25)))
    faces = [(i * sides + k, i * sides + (k + 1) % sides, (i + 1) * sides + (k + 1) % sides, (i + 1) * sides + k)
             for i in range(rings) for k in range(sides)]
    faces += [tuple(range(sides))[::-1], tuple(rings * sides + k for k in range(sides))]
    return add("Body", vertices, [f[::-1] for f in faces], paint("Paint", (0.35, 0.4, 0.5), 0.9, 0.05, 1.0), smooth=True)


def board(name, material, place, size, aim):
    w, h = size
    thing = add(name, [(-w, -h, 0), (w, -h, 0), (w, h, 0), (-w, h, 0)], [(0, 1, 2, 3)], material, place)
    thing.rotation_euler = (Vector(aim) - Vector(place)).to_track_quat("Z", "Y").to_euler()
    return thing


def keyed(thing, path, *values):
    for frame, value in zip((1, LAST), values):
        setattr(thing, path, value)
        thing.keyframe_insert(path, frame=frame)


scene = bpy.context.scene
for thing in list(bpy.data.objects):
    bpy.data.objects.remove(thing)
scene.frame_start, scene.frame_end, scene.render.fps = 1, LAST, 24
scene.render.resolution_x, scene.render.resolution_y, scene.view_settings.view_transform = 640, 288, "Standard"
scene.world = bpy.data.worlds.new("World")
scene.world.use_nodes = True
scene.world.node_tree.nodes["Background"].inputs[0].default_value = (0.3, 0.34, 0.4, 1)
floor = add("Floor", [(-30, -30, 0), (30, -30, 0), (30, 30, 0), (-30, 30, 0)], [(0, 1, 2, 3)], paint("Floor", (0.4, 0.38, 0.35)))
car = body()
wheel = paint("Tyre", (0.01, 0.01, 0.01))
for x in (-1.3, 1.3):
    for y in (-0.72, 0.72):
        bpy.ops.mesh.primitive_cylinder_add(radius=0.34, depth=0.22, location=(x, y, 0.34), rotation=(math.pi / 2, 0, 0))
        bpy.context.object.data.materials.append(wheel)
        bpy.context.object.parent = car
board("Front box", paint("Soft box", (1, 0.98, 0.95), light=5), (3, -4, 4.5), (2, 0.5), (0, 0, 0.5))
board("Back box", bpy.data.materials["Soft box"], (5, 2, 3), (1.2, 1.2), (0, 0, 0.5))
# A striped sign beside the road, which the car mirrors on its shoulders, and a lamp behind the car.
sign = board("Sign", paint("Red", (1, 0.05, 0.03), light=2.5), (1.8, -7.5, 1.5), (0.5, 0.5), (0, 0, 1))
stripe = board("Stripe", paint("White", (1, 1, 1), light=3), (1.8, -7.48, 1.5), (0.5, 0.12), (0, 0, 1))
board("Blue lamp", paint("Blue", (0.1, 0.3, 1), light=4), (-0.6, 6, 3.6), (0.7, 0.7), (0, 0, 1))
stripe.rotation_euler = sign.rotation_euler
stripe.parent, stripe.matrix_parent_inverse = sign, sign.matrix_basis.inverted()
keyed(car, "location", (-0.35, 0, 0), (0.35, 0, 0))
keyed(sign, "location", (1.8, -7.5, 1.5), (1.4, -7.5, 1.4))
camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
scene.collection.objects.link(camera)
scene.camera, camera.data.lens = camera, 40
track = camera.constraints.new("TRACK_TO")
track.target, track.track_axis, track.up_axis = car, "TRACK_NEGATIVE_Z", "UP_Y"
keyed(camera, "location", (-1.6, -6.2, 1.9), (-0.6, -6.4, 1.7))
bpy.ops.wm.save_as_mainfile(filepath=os.path.join(folder, "plain.blend"))

aims = install(repository).aims
bpy.context.view_layer.objects.active = car
bpy.context.view_layer.update()
assert aims.RENDER2MPEG_OT_aim.poll(bpy.context)


def on_body(origin, direction):
    met, place, _, _ = car.ray_cast(car.matrix_world.inverted() @ Vector(origin), Vector(direction))
    assert met
    return car.matrix_world @ place


scene.frame_set(1)
bpy.context.view_layer.update()
door, bonnet = on_body((-0.8, -9, 0.85), (0, 1, 0)), on_body((-1.5, -0.3, 9), (0, 0, -1))
assert bpy.ops.render2mpeg.aim(point=door, target="Sign") == {"FINISHED"}
assert bpy.ops.render2mpeg.aim(point=bonnet, target="Blue lamp") == {"FINISHED"}
assert bpy.ops.render2mpeg.aim(point=door, target="Front box") == {"FINISHED"}
first, second, third = (bpy.data.objects[name] for name in ("Aim Sign", "Aim Blue lamp", "Aim Front box"))
assert set(aims.aims_of(car)) == {first, second, third}
bpy.context.view_layer.update()
assert first.parent == car and first["aim_target"] == sign and (first.matrix_world.translation - door).length < 1e-4, (first.matrix_world, door)
for aim, radius in ((first, 0.22), (second, 0.15)):
    aim["aim_radius"], aim["aim_border"] = radius, 0.25
first["aim_radius"] = 0.1
first.keyframe_insert('["aim_radius"]', frame=1)
first["aim_radius"] = 0.22
first.keyframe_insert('["aim_radius"]', frame=LAST)
assert bpy.ops.render2mpeg.forget_aim(aim=third.name) == {"FINISHED"}
assert set(aims.aims_of(car)) == {first, second}
try:
    bpy.ops.render2mpeg.aim(point=door, target="Nobody")
    raise AssertionError("it was not refused")
except RuntimeError as error:
    assert "Nobody" in str(error), error
bpy.ops.wm.save_as_mainfile(filepath=os.path.join(folder, "aimed.blend"))
x, y, _ = world_to_camera_view(scene, camera, door)
print(f"AIM WORKS {x:.4f} {1 - y:.4f}")
