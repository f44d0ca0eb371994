# SPDX-License-Identifier: Apache-2.0 OR GPL-3.0-or-later
"""blender -b --factory-startup -noaudio --python-exit-code 1 -P make_blends.py -- FOLDER [NAME...]

Writes FOLDER/NAME.blend for each film below, or for those named: small scenes of what animators use, ready for Cycles.
"""
import math
import os
import struct
import sys
import wave

import bpy
from mathutils import Vector


def look_at(thing, aim):
    thing.rotation_euler = (Vector(aim) - thing.location).to_track_quat("-Z", "Y").to_euler()


def add_object(name, data, place=(0, 0, 0), turn=(0, 0, 0)):
    thing = bpy.data.objects.new(name, data)
    thing.location, thing.rotation_euler = place, turn
    bpy.context.scene.collection.objects.link(thing)
    return thing


def add_camera(place, aim, lens=35, name="Camera"):
    camera = add_object(name, bpy.data.cameras.new(name), place)
    camera.data.lens = lens
    look_at(camera, aim)
    bpy.context.scene.camera = camera
    return camera


def add_lamp(kind, place, aim=(0, 0, 0), name=None, **says):
    lamp = bpy.data.lights.new(name or kind.title(), kind)
    for key, value in says.items():
        setattr(lamp, key, value)
    thing = add_object(name or kind.title(), lamp, place)
    look_at(thing, aim)
    return thing


def add_primitive(kind, material=None, smooth=False, name=None, **says):
    getattr(bpy.ops.mesh, f"primitive_{kind}_add")(**says)
    thing = bpy.context.object
    thing.name = name or (material.name if material else thing.name)
    if material:
        thing.data.materials.append(material)
    if smooth:
        thing.data.polygons.foreach_set("use_smooth", [True] * len(thing.data.polygons))
    return thing


# Inputs of the Principled BSDF in Blender 4.
LATER_NAMES = {"Specular": "Specular IOR Level", "Sheen": "Sheen Weight", "Clearcoat": "Coat Weight", "Clearcoat Roughness": "Coat Roughness",
               "Transmission": "Transmission Weight", "Subsurface": "Subsurface Weight", "Emission": "Emission Color"}


def add_material(name, color=(0.8, 0.8, 0.8), **inputs):
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    node = material.node_tree.nodes["Principled BSDF"]
    node.inputs["Base Color"].default_value = (*color, 1)
    node.inputs["Roughness"].default_value = 0.9
    for key, value in inputs.items():
        key = key.replace("_", " ").title()
        input_of(node, key, LATER_NAMES.get(key, key)).default_value = value
    return material


def input_of(node, *names):
    """The input by the first of its names that this Blender knows: Blender 4 renamed some."""
    return next(node.inputs[name] for name in names if name in node.inputs)


def add_socket(group, kind, name, is_input=False):
    """A socket of a node group, which Blender 4 keeps in an interface."""
    if hasattr(group, "interface"):
        group.interface.new_socket(name, in_out="INPUT" if is_input else "OUTPUT", socket_type=kind)
    else:
        (group.inputs if is_input else group.outputs).new(kind, name)


def add_matt(name, color):
    """A Diffuse shader: the same in both renderers, which Principled's rough surfaces are not."""
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    tree = material.node_tree
    node = tree.nodes.new("ShaderNodeBsdfDiffuse")
    node.inputs["Color"].default_value = (*color, 1)
    tree.links.new(node.outputs[0], tree.nodes["Material Output"].inputs["Surface"])
    return material


def world_of(color, strength=1.0):
    world = bpy.data.worlds.new("World")
    bpy.context.scene.world = world
    world.use_nodes = True
    node = world.node_tree.nodes["Background"]
    node.inputs[0].default_value, node.inputs[1].default_value = (*color, 1), strength
    return world


def linear(thing):
    """Straight lines between the keys of a thing's action."""
    for curve in thing.animation_data.action.fcurves:
        for key in curve.keyframe_points:
            key.interpolation = "LINEAR"


def start(last):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end = 1, last
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 160, 90, 100
    scene.render.fps = 24
    scene.render.engine = "CYCLES"
    cycles = scene.cycles
    cycles.device, cycles.samples, cycles.use_adaptive_sampling, cycles.use_denoising = "CPU", 256, False, False
    cycles.pixel_filter_type, cycles.filter_width = "BOX", 1.0
    cycles.caustics_reflective = cycles.caustics_refractive = False
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0
    cycles.light_sampling_threshold = 0
    scene.view_settings.view_transform = "Standard"
    return scene


def tracked_camera():
    """A camera on a path that tracks what moves; its lens follows a driver that is no Python."""
    start(12)
    world_of((0.5, 0.6, 0.8))
    add_lamp("SUN", (0, 0, 5), (1, 2, 0), energy=2.0, angle=0.1)
    add_primitive("plane", add_matt("Floor", (0.5, 0.5, 0.45)), size=30)
    ball = add_primitive("uv_sphere", add_matt("Ball", (0.7, 0.2, 0.1)), smooth=True, radius=0.7, location=(-2, 0, 0.7), segments=48, ring_count=24)
    for x in (-3, -1, 1, 3):
        add_primitive("cube", add_matt(f"Box {x}", (0.2, 0.4, 0.3)), size=0.8, location=(x, 2, 0.4), rotation=(0, 0, 0.3 * x))
    ball.keyframe_insert("location", frame=1)
    ball.location.x = 2
    ball.keyframe_insert("location", frame=12)
    camera = add_camera((0, -7, 2.5), (0, 0, 0))
    track = camera.constraints.new("TRACK_TO")
    track.target, track.track_axis, track.up_axis = ball, "TRACK_NEGATIVE_Z", "UP_Y"
    rail = bpy.data.curves.new("Rail", "CURVE")
    rail.dimensions = "3D"
    spline = rail.splines.new("POLY")
    spline.points.add(1)
    spline.points[0].co, spline.points[1].co = (-3, -7, 2, 1), (3, -6, 3, 1)
    path = camera.constraints.new("FOLLOW_PATH")
    path.target, path.use_fixed_location = add_object("Rail", rail), True
    camera.location = (0, 0, 0)
    camera.constraints.move(1, 0)
    path.offset_factor = 0
    path.keyframe_insert("offset_factor", frame=1)
    path.offset_factor = 1
    path.keyframe_insert("offset_factor", frame=12)
    driver = camera.data.driver_add("lens").driver
    driver.expression = "30 + frame"


def street(last=4):
    """Things on a chequered floor under a sky and a sun."""
    scene = start(last)
    world_of((0.5, 0.6, 0.8))
    add_lamp("SUN", (0, 0, 5), (1, 2, 0), energy=2.0, angle=0.1)
    add_primitive("plane", add_matt("Floor", (0.5, 0.5, 0.45)), size=30)
    dark = add_matt("Dark", (0.1, 0.12, 0.15))
    for x in range(-4, 5):
        for y in range(-2, 7):
            if (x + y) % 2:
                add_primitive("plane", dark, name="Tile", size=0.5, location=(0.5 * x, y, 0.002))
    for x in (-2.2, -0.8, 0.8, 2.2):
        add_primitive("cube", add_matt(f"Box {x}", (0.2, 0.4, 0.3)), size=0.8, location=(x, 3, 0.4), rotation=(0, 0, 0.3 * x))
    return scene


def open_shutter():
    """A camera that pans over a bar that turns and a ball that flies."""
    scene = street()
    bar = add_primitive("cube", add_matt("Bar", (0.7, 0.5, 0.1)), size=1, location=(-1, 0, 1.2), scale=(1.8, 0.1, 0.2))
    ball = add_primitive("uv_sphere", add_matt("Ball", (0.7, 0.2, 0.1)), smooth=True, radius=0.4, location=(0, -0.5, 0.6), segments=48, ring_count=24)
    camera = add_camera((0, -7, 2.2), (0, 0, 0.6))
    for frame in (1, 2, 3, 4):
        bar.rotation_euler.y = 0.5 * frame
        bar.keyframe_insert("rotation_euler", frame=frame)
        ball.location.x = 0.5 * frame - 0.5
        ball.keyframe_insert("location", frame=frame)
        camera.location.x = 0.15 * frame - 0.375
        camera.keyframe_insert("location", frame=frame)
    for thing in (bar, ball, camera):
        linear(thing)
    scene.render.use_motion_blur, scene.render.motion_blur_shutter = True, 0.5


def shallow_focus():
    """A still life before a lens with five blades, so wide open that small pictures are blurred, focused on an object."""
    street()
    for k, y in enumerate((-4, -2, 0.5)):
        add_primitive("uv_sphere", add_matt(f"Ball {k}", (0.7, 0.2 + 0.2 * k, 0.1)), smooth=True, radius=0.4, location=(0.7 * k - 0.9, y, 0.4), segments=48, ring_count=24)
    dof = add_camera((0, -7, 2.2), (0, 0, 0.2)).data.dof
    dof.use_dof, dof.aperture_fstop, dof.aperture_blades = True, 0.05, 5
    dof.focus_object = bpy.data.objects["Ball 1"]


def markers():
    """Three cameras, cut by markers; one is parallel."""
    scene = start(12)
    world_of((0.4, 0.4, 0.4))
    add_lamp("POINT", (2, -2, 4), energy=300, shadow_soft_size=0.3)
    add_primitive("plane", add_matt("Floor", (0.6, 0.6, 0.6)), size=30)
    add_primitive("monkey", add_material("Head", (0.6, 0.4, 0.2)), smooth=True, size=2, location=(0, 0, 1))
    editor = scene.sequence_editor_create()
    editor.sequences.new_sound("Clap", write_clap(), channel=1, frame_start=1)
    for frame, (place, kind) in {1: ((0, -6, 2), "PERSP"), 5: ((4, -3, 1.5), "PERSP"), 9: ((-4, -5, 4), "ORTHO")}.items():
        camera = add_camera(place, (0, 0, 1), name=f"Shot {frame}")
        camera.data.type, camera.data.ortho_scale = kind, 5
        camera.data.shift_x, camera.data.shift_y = 0.02 * (frame - 1), -0.01 * (frame - 1)
        marker = scene.timeline_markers.new(f"Cut {frame}", frame=frame)
        marker.camera = camera
    for name, frame in {"Before": -20, "Dawn": 0, "Noon": 7, "Behind": 40}.items():
        scene.timeline_markers.new(name, frame=frame)


def write_clap():
    """A second of silence with a clap at a quarter, in the folder of the film."""
    path = os.path.join(os.path.abspath(sys.argv[sys.argv.index("--") + 1]), "clap.wav")
    with wave.open(path, "wb") as file:
        file.setparams((1, 2, 44100, 0, "NONE", ""))
        file.writeframes(b"".join(struct.pack("<h", round(30000 * math.sin(0.15 * k)) if 11025 <= k < 11500 else 0) for k in range(44100)))
    return path


def holes():
    """A ball and frosted glass before a world that is hidden, holes by a shader, an object and a collection."""
    scene = start(2)
    scene.render.film_transparent, scene.render.resolution_percentage = True, 50
    world_of((0.6, 0.6, 0.6))
    add_lamp("SUN", (0, 0, 5), (1, 2, 0), energy=2.0, angle=0.1)
    add_primitive("uv_sphere", add_matt("Ball", (0.7, 0.2, 0.1)), smooth=True, radius=1, location=(0, 1, 0), segments=48, ring_count=24)
    frosted = add_material("Frosted", (1, 1, 1), Roughness=0.1, Transmission=1.0)
    if "Transmission Roughness" in frosted.node_tree.nodes["Principled BSDF"].inputs:
        frosted.node_tree.nodes["Principled BSDF"].inputs["Transmission Roughness"].default_value = 0.5
    add_primitive("cube", frosted, size=0.8, location=(-2, 1, 0), rotation=(0, 0, 0.4))
    hole = bpy.data.materials.new("Hole")
    hole.use_nodes = True
    shader = hole.node_tree.nodes.new("ShaderNodeHoldout")
    hole.node_tree.links.new(shader.outputs[0], hole.node_tree.nodes["Material Output"].inputs["Surface"])
    add_primitive("cube", hole, name="By shader", size=0.5, location=(0, -0.5, 0.6))
    grey = add_matt("Grey", (0.5, 0.5, 0.5))
    add_primitive("cube", grey, name="By object", size=0.5, location=(0.7, -0.5, -0.3)).is_holdout = True
    thing = add_primitive("cube", grey, name="By collection", size=0.5, location=(-0.7, -0.5, -0.3))
    apart = bpy.data.collections.new("Apart")
    scene.collection.children.link(apart)
    scene.collection.objects.unlink(thing)
    apart.objects.link(thing)
    bpy.context.view_layer.layer_collection.children["Apart"].holdout = True
    add_primitive("cube", grey, name="Seen", size=0.5, location=(1.6, 0, 0.5), rotation=(0, 0.3, 0.5))
    add_camera((0, -6, 0.5), (0, 1, 0))


def lamps_and_sky():
    """An area lamp that moves and dims, a soft sun, and a sky texture."""
    scene = start(6)
    scene.view_settings.exposure = -0.5
    world = world_of((0, 0, 0))
    sky = world.node_tree.nodes.new("ShaderNodeTexSky")
    sky.sky_type, sky.sun_elevation, sky.sun_rotation = "NISHITA", math.radians(35), math.radians(60)
    world.node_tree.links.new(sky.outputs[0], world.node_tree.nodes["Background"].inputs[0])
    world.node_tree.nodes["Background"].inputs[1].default_value = 0.05
    add_primitive("plane", add_matt("Floor", (0.6, 0.6, 0.6)), size=40)
    add_primitive("cube", add_matt("Wall", (0.7, 0.5, 0.4)), size=1, location=(0, 2.5, 1), scale=(6, 0.2, 2))
    add_primitive("uv_sphere", add_matt("Ball", (0.3, 0.4, 0.7)), smooth=True, radius=0.6, location=(0.5, 0, 0.6), segments=48, ring_count=24)
    lamp = add_lamp("AREA", (-1.5, 0.5, 2), (-0.5, 1, 0), energy=60, shape="RECTANGLE", size=1.0, size_y=0.5, color=(1, 0.7, 0.4))
    lamp.data.keyframe_insert("energy", frame=1)
    lamp.data.energy = 20
    lamp.data.keyframe_insert("energy", frame=6)
    add_camera((1, -6, 2), (0, 1, 0.7))


def armature_and_shapes():
    """A tube that bones bend, and a ball with a shape key."""
    start(8)
    world_of((0.6, 0.6, 0.65))
    add_lamp("SUN", (0, 0, 5), (-2, 3, 0), energy=2.0, angle=0.05)
    add_primitive("plane", add_matt("Floor", (0.5, 0.5, 0.5)), size=30)
    tube = add_primitive("cylinder", add_matt("Tube", (0.2, 0.5, 0.3)), smooth=True, radius=0.4, depth=3, location=(-1.5, 0, 1.5), vertices=24)
    subdivide(tube, 12)
    bones = bpy.data.armatures.new("Bones")
    rig = add_object("Rig", bones, (-1.5, 0, 0))
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="EDIT")
    for k in range(2):
        bone = bones.edit_bones.new(f"Bone {k}")
        bone.head, bone.tail = (0, 0, 1.5 * k), (0, 0, 1.5 * (k + 1))
        if k:
            bone.parent = bones.edit_bones["Bone 0"]
    bpy.ops.object.mode_set(mode="OBJECT")
    for k in range(2):
        group = tube.vertex_groups.new(name=f"Bone {k}")
        for vertex in tube.data.vertices:
            upper = min(max((vertex.co.z + 0.4) / 0.8, 0), 1)
            group.add([vertex.index], upper if k else 1 - upper, "REPLACE")
    tube.modifiers.new("Armature", "ARMATURE").object = rig
    pose = rig.pose.bones["Bone 1"]
    pose.rotation_mode = "XYZ"
    pose.keyframe_insert("rotation_euler", frame=1)
    pose.rotation_euler.x = math.radians(80)
    pose.rotation_euler.z = math.radians(-40)
    pose.keyframe_insert("rotation_euler", frame=8)
    ball = add_primitive("uv_sphere", add_matt("Ball", (0.7, 0.3, 0.3)), smooth=True, radius=0.8, location=(1.5, 0, 0.9), segments=48, ring_count=24)
    ball.shape_key_add(name="Basis")
    key = ball.shape_key_add(name="Tall")
    for vertex, moved in zip(ball.data.vertices, key.data):
        moved.co = Vector((vertex.co.x * 0.6, vertex.co.y * 0.6, vertex.co.z * 1.6 + 0.4))
    key.keyframe_insert("value", frame=1)
    key.value = 1
    key.keyframe_insert("value", frame=8)
    add_camera((0, -7, 2.5), (0, 0, 1.2))


def add_shader(name, kind, **inputs):
    """A material of one shader."""
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    nodes = material.node_tree.nodes
    nodes.clear()
    shader, end = nodes.new(kind), nodes.new("ShaderNodeOutputMaterial")
    for key, value in inputs.items():
        shader.inputs[key.replace("_", " ").title()].default_value = value
    material.node_tree.links.new(shader.outputs[0], end.inputs["Surface"])
    return material, shader


def add_hair(melanin):
    material, shader = add_shader("Fur", "ShaderNodeBsdfHairPrincipled")
    shader.parametrization = "MELANIN"
    shader.inputs["Melanin"].default_value, shader.inputs["Melanin Redness"].default_value = melanin, 0.5
    return material


def add_particles(thing, count, length, children, radius):
    """Hair of a thing's second material."""
    system = thing.modifiers.new("Fur", "PARTICLE_SYSTEM").particle_system
    settings = system.settings
    settings.type, settings.count, settings.hair_length, settings.material = "HAIR", count, length, 2
    settings.child_type, settings.rendered_child_count, settings.render_step = "INTERPOLATED", children, 2
    settings.root_radius, settings.tip_radius, settings.radius_scale = 1, 0.2, radius
    return system


def fur():
    """A ball of fur with children that bends with two bones, by Principled Hair."""
    start(3)
    world_of((0.4, 0.5, 0.7))
    hair = add_hair(0.6)
    ball = add_primitive("uv_sphere", add_matt("Skin", (0.6, 0.4, 0.3)), location=(0, 0, 1), segments=24, ring_count=12)
    ball.data.materials.append(hair)
    add_primitive("plane", add_matt("Floor", (0.5, 0.5, 0.5)), size=20, location=(0, 0, -0.3))
    rig = add_object("Rig", bpy.data.armatures.new("Rig"))
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="EDIT")
    for name, low, high in (("low", 0, 1), ("high", 1, 2)):
        bone = rig.data.edit_bones.new(name)
        bone.head, bone.tail = (0, 0, low), (0, 0, high)
    bpy.ops.object.mode_set(mode="OBJECT")
    for name, sign in (("low", -1), ("high", 1)):
        ball.vertex_groups.new(name=name).add([v.index for v in ball.data.vertices if sign * v.co.z >= 0], 1, "REPLACE")
    ball.modifiers.new("Bend", "ARMATURE").object = rig
    add_particles(ball, 80, 0.5, 10, 0.03)
    bone = rig.pose.bones["high"]
    bone.rotation_mode = "XYZ"
    for frame, turn in ((1, 0), (3, 0.8)):
        bone.rotation_euler.x = turn
        bone.keyframe_insert("rotation_euler", frame=frame)
    add_lamp("SUN", (3, -4, 6), energy=3, angle=0.1)
    add_camera((0, -6, 2), (0, 0, 1))


def groomed_head():
    """A head of skin whose hair falls to all sides, and curls."""
    start(1)
    world_of((0.4, 0.5, 0.7))
    skin, shader = add_shader("Skin", "ShaderNodeSubsurfaceScattering", Color=(0.72, 0.42, 0.32, 1), Scale=0.12, Radius=(1, 0.4, 0.25))
    shader.falloff = "RANDOM_WALK"
    head = add_primitive("uv_sphere", skin, True, location=(0, 0, 1), segments=48, ring_count=32)
    for vertex in head.data.vertices:
        x, y, z = vertex.co
        nose = math.exp(-((x / 0.16) ** 2 + ((z + 0.1) / 0.28) ** 2)) if y < 0 else 0
        jaw = 1 - 0.25 * max(-z, 0)
        vertex.co = Vector((0.78 * x * jaw, (0.92 - 0.05 * max(-z, 0)) * y - 0.2 * nose, 1.1 * z))
    for side in (-1, 1):
        ear = add_primitive("uv_sphere", skin, True, name=f"Ear {side}", location=(0.77 * side, 0.05, 0.95), segments=24, ring_count=12)
        ear.scale = (0.07, 0.16, 0.26)
        add_primitive("uv_sphere", add_matt("Eye", (0.05, 0.05, 0.08)), True, location=(0.27 * side, -0.74, 1.15), radius=0.11)
    head.data.materials.append(add_hair(0.55))
    scalp = [v.index for v in head.data.vertices if v.co.z > 0.45 or v.co.y > 0.3 and v.co.z > -0.3]
    head.vertex_groups.new(name="Scalp").add(scalp, 1, "REPLACE")
    system = add_particles(head, 150, 0.5, 40, 0.012)
    system.vertex_group_density = "Scalp"
    settings = system.settings
    settings.use_advanced_hair, settings.hair_step, settings.child_length = True, 6, 1.0
    settings.kink, settings.kink_amplitude, settings.kink_frequency, settings.clump_factor = "CURL", 0.03, 3, 0.5
    # Guides grow as what is thrown falls.
    settings.physics_type, settings.normal_factor, settings.effector_weights.gravity = "NEWTON", 0.1, 0.03
    add_primitive("cube", add_matt("Shoulders", (0.2, 0.25, 0.3)), location=(0, 0.1, -0.75), scale=(1.3, 0.6, 0.5))
    add_lamp("SUN", (3, -4, 6), energy=3, angle=0.1)
    add_camera((1.4, -5.6, 1.5), (0, 0, 1), lens=45)


def curves():
    """A Curves object: the strands of particle hair, taken over."""
    start(1)
    world_of((0.4, 0.5, 0.7))
    ball = add_primitive("uv_sphere", add_matt("Skin", (0.6, 0.4, 0.3)), location=(0, 0, 1), segments=24, ring_count=12)
    ball.data.materials.append(add_hair(0.3))
    add_particles(ball, 1500, 0.4, 0, 0.02).settings.child_type = "NONE"
    bpy.ops.curves.convert_from_particle_system()
    strands = bpy.context.object
    strands.data.materials.clear()
    strands.data.materials.append(ball.data.materials[1])
    ball.modifiers.clear()
    add_primitive("plane", add_matt("Floor", (0.5, 0.5, 0.5)), size=20, location=(0, 0, -0.3))
    add_lamp("SUN", (3, -4, 6), energy=3, angle=0.1)
    add_camera((0, -6, 2), (0, 0, 1))


def subdivide(thing, cuts):
    """Rings along z for what was one long cylinder."""
    import bmesh
    mesh = bmesh.new()
    mesh.from_mesh(thing.data)
    low, high = min(v.co.z for v in mesh.verts), max(v.co.z for v in mesh.verts)
    for k in range(1, cuts):
        z = low + (high - low) * k / cuts
        bmesh.ops.bisect_plane(mesh, geom=mesh.verts[:] + mesh.edges[:] + mesh.faces[:], plane_co=(0, 0, z), plane_no=(0, 0, 1))
    mesh.to_mesh(thing.data)
    mesh.free()


def looks():
    """Filmic with a look and a gamma: a lamp that is seen, strong colours, deep shadows, a round lamp."""
    scene = start(2)
    view = scene.view_settings
    view.view_transform, view.look, view.exposure, view.gamma = "Filmic", "High Contrast", 0.5, 1.1
    world_of((0.05, 0.06, 0.08))
    add_lamp("AREA", (2, -1.5, 3), (0, 0.5, 0.5), name="Disc", energy=150, shape="DISK", size=1.2)
    add_lamp("POINT", (-2, -1, 1), energy=20, shadow_soft_size=0.2, color=(0.2, 0.4, 1))
    add_primitive("plane", add_matt("Floor", (0.5, 0.5, 0.5)), size=40)
    for k, color in enumerate(((0.8, 0.02, 0.02), (0.02, 0.6, 0.05), (0.02, 0.05, 0.8), (0.8, 0.6, 0.02), (0.9, 0.9, 0.9))):
        add_primitive("uv_sphere", add_matt(f"Ball {k}", color), smooth=True, radius=0.45, location=(k - 2, 1, 0.45), segments=48, ring_count=24)
    glow = bpy.data.materials.new("Glow")
    glow.use_nodes = True
    tree = glow.node_tree
    shine = tree.nodes.new("ShaderNodeEmission")
    shine.inputs["Color"].default_value, shine.inputs["Strength"].default_value = (1, 0.3, 0.05, 1), 30
    tree.links.new(shine.outputs[0], tree.nodes["Material Output"].inputs["Surface"])
    add_primitive("cube", glow, size=0.3, location=(0, -0.3, 0.3), rotation=(0, 0, 0.4))
    add_camera((0, -5, 2), (0, 0.5, 0.4))


def instances():
    """Particles, a collection's instances, an array, and a thing that comes while the film runs."""
    start(8)
    world_of((0.5, 0.55, 0.6))
    add_lamp("SUN", (0, 0, 5), (2, 2, 0), energy=2.5, angle=0.1)
    add_primitive("plane", add_matt("Floor", (0.5, 0.5, 0.5)), size=30)
    cone = add_primitive("cone", add_matt("Cone", (0.6, 0.5, 0.1)), radius1=0.5, depth=1, location=(0, 0, -20))
    trees = bpy.data.collections.new("Trees")
    bpy.context.scene.collection.objects.unlink(cone)
    trees.objects.link(cone)
    trees.instance_offset = (0, 0, -20.5)
    for k in range(4):
        place = add_object(f"Tree {k}", None, (-3 + 2 * k, 3, 0), (0, 0, 0.5 * k))
        place.instance_type, place.instance_collection = "COLLECTION", trees
    grain = add_primitive("ico_sphere", add_matt("Grain", (0.7, 0.2, 0.2)), radius=0.15, subdivisions=2, location=(0, 50, 0))
    grain.hide_render = True
    source = add_primitive("plane", add_matt("Source", (0.3, 0.3, 0.6)), size=2, location=(-1.5, 0, 2))
    system = source.modifiers.new("Particles", "PARTICLE_SYSTEM").particle_system.settings
    system.count, system.frame_start, system.frame_end, system.lifetime = 40, -10, 6, 50
    system.render_type, system.instance_object, system.particle_size = "OBJECT", grain, 1.0
    row = add_primitive("cube", add_matt("Row", (0.2, 0.5, 0.4)), size=0.5, location=(1, 0, 0.25))
    array = row.modifiers.new("Array", "ARRAY")
    array.count, array.relative_offset_displace = 4, (1.5, 0, 0)
    late = add_primitive("cube", add_matt("Late", (0.8, 0.8, 0.2)), size=0.6, location=(2, -1.5, 0.3))
    for frame, hidden in ((1, True), (5, False)):
        late.hide_render = hidden
        late.keyframe_insert("hide_render", frame=frame)
    add_camera((0, -8, 3), (0, 0, 1))


def glass_and_emission():
    """A pane of glass, metal, a lamp of emission that grows brighter."""
    scene = start(6)
    scene.view_settings.view_transform = "Filmic"
    world_of((0.05, 0.05, 0.06))
    add_primitive("plane", add_matt("Floor", (0.6, 0.6, 0.6)), size=20)
    add_primitive("cube", add_matt("Wall", (0.6, 0.3, 0.2)), size=1, location=(0, 3, 2), scale=(10, 0.2, 4))
    add_primitive("plane", pane(), size=2, location=(-1, 0, 1.1), rotation=(math.pi / 2, 0, 0.4))
    add_primitive("uv_sphere", add_material("Metal", (0.9, 0.7, 0.4), metallic=1.0, roughness=0.3), smooth=True, radius=0.6,
                  location=(1.4, 0, 0.6), segments=48, ring_count=24)
    bulb = add_material("Bulb", (0, 0, 0))
    node = bulb.node_tree.nodes["Principled BSDF"]
    input_of(node, "Emission Color", "Emission").default_value = (1, 0.8, 0.6, 1)
    input_of(node, "Specular IOR Level", "Specular").default_value = 0
    strength = node.inputs["Emission Strength"]
    strength.default_value = 8
    strength.keyframe_insert("default_value", frame=1)
    strength.default_value = 16
    strength.keyframe_insert("default_value", frame=6)
    add_primitive("uv_sphere", bulb, smooth=True, radius=0.5, location=(0, 0.8, 3), segments=48, ring_count=24)
    add_camera((0, -6, 2), (0, 0, 1.2))


def pane():
    """Glass as architects have it: what Fresnel does not mirror goes straight on."""
    material = bpy.data.materials.new("Pane")
    material.use_nodes = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    nodes.remove(nodes["Principled BSDF"])
    clear, mirror, fresnel, mix = (nodes.new("ShaderNode" + kind) for kind in ("BsdfTransparent", "BsdfGlossy", "Fresnel", "MixShader"))
    clear.inputs["Color"].default_value = (0.7, 0.9, 0.8, 1)
    mirror.inputs["Color"].default_value, mirror.inputs["Roughness"].default_value = (1, 1, 1, 1), 0
    fresnel.inputs["IOR"].default_value = 1.5
    links.new(fresnel.outputs[0], mix.inputs[0])
    links.new(clear.outputs[0], mix.inputs[1])
    links.new(mirror.outputs[0], mix.inputs[2])
    links.new(mix.outputs[0], nodes["Material Output"].inputs["Surface"])
    return material


def cloud():
    """A drifting cloud of noise in a ball, which scatters as often as light does."""
    scene = start(6)
    scene.cycles.volume_bounces = scene.cycles.max_bounces = 64
    world_of((0.3, 0.4, 0.5))
    add_lamp("SUN", (0, 0, 5), (3, 2, 0), energy=3, angle=0.1)
    material = bpy.data.materials.new("Cloud")
    material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    end, medium, place, noise, shape = (tree.nodes.new("Shader" + kind) for kind in (
        "NodeOutputMaterial", "NodeVolumePrincipled", "NodeTexCoord", "NodeTexNoise", "NodeMapRange"))
    noise.noise_dimensions = "4D"
    noise.inputs["Scale"].default_value = 2
    shape.inputs["From Min"].default_value, shape.inputs["From Max"].default_value, shape.inputs["To Max"].default_value = 0.4, 0.7, 5
    medium.inputs["Color"].default_value = (0.8, 0.7, 0.6, 1)
    for source, entry in ((place.outputs["Object"], noise.inputs["Vector"]), (noise.outputs["Fac"], shape.inputs["Value"]),
                          (shape.outputs[0], medium.inputs["Density"]), (medium.outputs[0], end.inputs["Volume"])):
        tree.links.new(source, entry)
    for frame, noise.inputs["W"].default_value in ((1, 0), (6, 2)):
        noise.inputs["W"].keyframe_insert("default_value", frame=frame)
    add_primitive("uv_sphere", material, radius=1.3, location=(0, 0, 1.5), segments=48, ring_count=24)
    add_primitive("plane", add_matt("Floor", (0.6, 0.6, 0.6)), size=12)
    add_camera((0, -6, 2.5), (0, 0, 1.2))


def procedural():
    """Materials of noise, bricks and bumps that only Blender can evaluate; one in a group."""
    start(4)
    world_of((0.7, 0.7, 0.7))
    add_lamp("SUN", (0, 0, 5), (2, 3, 0), energy=1.5, angle=0.2)
    floor, wall, ball = (add_matt(name, (1, 1, 1)) for name in ("Tiles", "Bricks", "Marble"))
    checker = floor.node_tree.nodes.new("ShaderNodeTexChecker")
    checker.inputs["Scale"].default_value = 8
    link(floor, checker.outputs["Color"])
    bricks = wall.node_tree.nodes.new("ShaderNodeTexBrick")
    bricks.inputs["Scale"].default_value = 6
    place = wall.node_tree.nodes.new("ShaderNodeTexCoord")
    wall.node_tree.links.new(place.outputs["Generated"], bricks.inputs["Vector"])
    link(wall, bricks.outputs["Color"])
    group = bpy.data.node_groups.new("Marble", "ShaderNodeTree")
    add_socket(group, "NodeSocketColor", "Color")
    noise, ramp, end = (group.nodes.new(kind) for kind in ("ShaderNodeTexNoise", "ShaderNodeValToRGB", "NodeGroupOutput"))
    noise.inputs["Scale"].default_value = 3
    ramp.color_ramp.elements[0].color, ramp.color_ramp.elements[1].color = (0.1, 0.05, 0.3, 1), (0.9, 0.8, 0.6, 1)
    ramp.color_ramp.elements[0].position, ramp.color_ramp.elements[1].position = 0.4, 0.6
    group.links.new(noise.outputs["Fac"], ramp.inputs["Fac"])
    group.links.new(ramp.outputs["Color"], end.inputs["Color"])
    use = ball.node_tree.nodes.new("ShaderNodeGroup")
    use.node_tree = group
    link(ball, use.outputs["Color"])
    add_primitive("plane", floor, size=12)
    add_primitive("cube", wall, size=1, location=(0, 3, 1.5), scale=(8, 0.2, 3))
    add_primitive("uv_sphere", ball, smooth=True, radius=1, location=(0, 0, 1), segments=48, ring_count=24)
    add_camera((1, -6, 2.5), (0, 0, 1.2))


def link(material, output):
    node = next(n for n in material.node_tree.nodes if n.type == "BSDF_DIFFUSE")
    material.node_tree.links.new(output, node.inputs["Color"])


def odds_and_ends():
    """Texts, curves, hair, geometry nodes, shear, a shape that changes its corners, 12 frames per second: what is kept in
    part or not at all."""
    scene = start(3)
    scene.render.fps, scene.render.use_motion_blur = 12, True
    world_of((0.5, 0.5, 0.5))
    text = bpy.data.curves.new("Text", "FONT")
    text.body, text.extrude = "Text", 0.1
    noisy = add_matt("Noisy", (1, 1, 1))
    link(noisy, noisy.node_tree.nodes.new("ShaderNodeTexNoise").outputs["Color"])
    text.materials.append(noisy)
    add_object("Text", text, (-3, 2, 0), (math.pi / 2, 0, 0))
    add_primitive("uv_sphere", add_matt("Fur", (0.5, 0.3, 0.2)), location=(-2, 0, 1)).modifiers.new("Fur", "PARTICLE_SYSTEM") \
        .particle_system.settings.type = "HAIR"
    growing = add_primitive("ico_sphere", add_matt("Growing", (0.5, 0.5, 0.5)), subdivisions=3, location=(2, 0, 1)).modifiers.new("Build", "BUILD")
    growing.frame_start, growing.frame_duration = 1, 6
    parent = add_object("Parent", None)
    parent.scale = (1, 3, 1)
    sheared = add_primitive("cube", add_matt("Sheared", (0.5, 0.5, 0.8)), size=0.4, location=(0, 0, 3), rotation=(0.5, 0.5, 0))
    sheared.parent = parent
    for frame, turn in ((1, 0), (3, 1)):
        parent.rotation_euler.z = turn
        parent.keyframe_insert("rotation_euler", frame=frame)
    scattered = add_primitive("grid", add_matt("Scattered", (0.2, 0.6, 0.2)), size=2, location=(0, -2, 0)).modifiers.new("Scatter", "NODES")
    scattered.node_group = scatter()
    add_lamp("AREA", (-3, -3, 3), energy=50, shape="DISK", size=0.8)
    camera = add_camera((0, -9, 4), (0, 0, 1)).data
    camera.dof.use_dof = True


def scatter():
    """Geometry nodes that put small cubes all over a surface."""
    group = bpy.data.node_groups.new("Scatter", "GeometryNodeTree")
    add_socket(group, "NodeSocketGeometry", "Geometry", is_input=True)
    add_socket(group, "NodeSocketGeometry", "Geometry")
    begin, points, cube, put, end = (group.nodes.new(kind) for kind in (
        "NodeGroupInput", "GeometryNodeDistributePointsOnFaces", "GeometryNodeMeshCube", "GeometryNodeInstanceOnPoints", "NodeGroupOutput"))
    cube.inputs["Size"].default_value = (0.1, 0.1, 0.1)
    for source, target in ((begin.outputs[0], points.inputs["Mesh"]), (points.outputs["Points"], put.inputs["Points"]),
                           (cube.outputs["Mesh"], put.inputs["Instance"]), (put.outputs[0], end.inputs[0])):
        group.links.new(source, target)
    return group


def hostile():
    """Everything in a .blend that could execute something. None of it may: each would make a file beside the .blend."""
    scene = start(2)
    world_of((0.5, 0.5, 0.5))
    cube = add_primitive("cube", add_material("Cube"), size=1)
    add_camera((0, -5, 0), (0, 0, 0))
    evil = "import os, bpy; open(os.path.join(os.path.dirname(bpy.data.filepath), 'EXECUTED'), 'w')"
    text = bpy.data.texts.new("registers.py")
    text.use_module = True
    text.write(evil + "\n")
    text.write("def handler(*_):\n    " + evil + "\nimport bpy\nfor h in (bpy.app.handlers.load_post, bpy.app.handlers.frame_change_pre,"
               " bpy.app.handlers.render_init, bpy.app.handlers.depsgraph_update_post):\n    h.append(handler)\n")
    bomb = bpy.data.texts.new("bomb.py")
    bomb.use_module = True
    bomb.write("import os\nwhile True:\n    os.fork()\n")
    cube.driver_add("location", 2).driver.expression = "__import__('os').system('touch EXECUTED') * 0"
    other = cube.driver_add("location", 1).driver
    other.expression = "[c for c in ().__class__.__base__.__subclasses__()] and open('EXECUTED', 'w') and 0"
    script = scene.node_tree
    assert script is None
    material = add_material("Scripted")
    node = material.node_tree.nodes.new("ShaderNodeScript")
    node.mode, node.script = "INTERNAL", bpy.data.texts.new("shader.osl")
    node.script.write('shader evil(output color c = 1) { c = 1; printf("EXECUTED"); }')
    cube.data.materials[0] = material


def panorama(longitudes=(-180, 180), latitudes=(-90, 90)):
    """All about a tilted camera, with things behind it, above and below."""
    scene = start(1)
    scene.render.resolution_x, scene.render.resolution_y = 256, 128
    world_of((0.5, 0.6, 0.8))
    add_lamp("SUN", (0, 0, 5), (1, 2, 0), energy=2.0, angle=0.1)
    add_primitive("plane", add_matt("Floor", (0.5, 0.5, 0.45)), size=30)
    for k in range(7):
        turn = 0.9 * k
        add_primitive("cube", add_matt(f"Box {k}", (0.2 + 0.1 * k, 0.4, 0.8 - 0.1 * k)), size=0.9, rotation=(0, 0, 0.3 * k),
                      location=(3 * math.cos(turn), 3 * math.sin(turn), 0.45))
    add_primitive("cube", add_matt("Above", (0.7, 0.3, 0.2)), size=1.2, location=(0.2, 0.1, 4))
    add_primitive("uv_sphere", add_matt("Below", (0.3, 0.6, 0.3)), smooth=True, radius=0.4, location=(0, 0.1, 0.4), segments=48, ring_count=24)
    camera = add_camera((0, 0, 1.8), (1, -2, 1.5))
    camera.data.type = "PANO"
    seen = camera.data if hasattr(camera.data, "panorama_type") else camera.data.cycles
    seen.panorama_type = "EQUIRECTANGULAR"
    seen.longitude_min, seen.longitude_max = map(math.radians, longitudes)
    seen.latitude_min, seen.latitude_max = map(math.radians, latitudes)


def panorama_window():
    """A part of it, as wide as it is high."""
    panorama((-40, 80), (-70, 50))
    bpy.context.scene.render.resolution_x = 128


FILMS = {film.__name__: film for film in (tracked_camera, markers, lamps_and_sky, looks, armature_and_shapes, fur, groomed_head, curves, instances, glass_and_emission,
                                          procedural, cloud, odds_and_ends, hostile, open_shutter, shallow_focus, holes, panorama, panorama_window)}


def main():
    folder, *names = sys.argv[sys.argv.index("--") + 1:]
    for name in names or FILMS:
        FILMS[name]()
        bpy.ops.wm.save_as_mainfile(filepath=os.path.join(os.path.abspath(folder), name + ".blend"), check_existing=False)


if __name__ == "__main__":
    main()
