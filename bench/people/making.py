"""What the films of this folder are made of: each file is run as
`blender --background --factory-startup --python FILE -- OUT.blend` and makes one film as Blender's users do, of
Principled surfaces, modifiers, procedural textures and particles. Same script, same film: nothing is downloaded."""
import math
import os
import random
import sys

import bpy
from mathutils import Vector

FPS = 24


def start(seconds, samples=96):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    random.seed(1)
    scene = bpy.context.scene
    scene.render.engine, scene.cycles.device, scene.cycles.samples = "CYCLES", "CPU", samples
    scene.cycles.use_denoising = False
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 1280, 720, 100
    scene.render.fps, scene.frame_start, scene.frame_end = FPS, 1, round(seconds * FPS)
    return scene


def curves_of(action):
    """Blender 5's lie in its layers' strips."""
    if hasattr(action, "fcurves"):
        return action.fcurves
    return [curve for layer in action.layers for strip in layer.strips for bag in strip.channelbags for curve in bag.fcurves]


def save():
    """Straight keys: what turns and walks does so evenly."""
    for action in bpy.data.actions:
        for curve in curves_of(action):
            for key in curve.keyframe_points:
                key.interpolation = "LINEAR"
    bpy.ops.wm.save_as_mainfile(filepath=os.path.abspath(sys.argv[sys.argv.index("--") + 1]))


def keyed(thing, path, *values):
    """Values at even distances over the film."""
    scene = bpy.context.scene
    for k, value in enumerate(values):
        setattr(thing, path, value)
        thing.keyframe_insert(path, frame=scene.frame_start + k * (scene.frame_end + 1 - scene.frame_start) / (len(values) - 1))
    return thing


def look_at(thing, aim):
    thing.rotation_euler = (Vector(aim) - thing.location).to_track_quat("-Z", "Y").to_euler()


def add(name, data, place=(0, 0, 0), turn=(0, 0, 0), parent=None):
    thing = bpy.data.objects.new(name, data)
    thing.location, thing.rotation_euler, thing.parent = place, turn, parent
    bpy.context.scene.collection.objects.link(thing)
    return thing


def camera(places, aim, lens=50, f_stop=None):
    """On its way past the places, its eye on an empty; in focus there where it has an f-stop."""
    target = add("Aim", None, aim)
    thing = add("Camera", bpy.data.cameras.new("Camera"), places[0])
    thing.data.lens = lens
    track = thing.constraints.new("TRACK_TO")
    track.target, track.track_axis, track.up_axis = target, "TRACK_NEGATIVE_Z", "UP_Y"
    if len(places) > 1:
        keyed(thing, "location", *places)
    if f_stop:
        thing.data.dof.use_dof, thing.data.dof.focus_object, thing.data.dof.aperture_fstop = True, target, f_stop
    bpy.context.scene.camera = thing
    return thing


def lamp(kind, place, aim, energy, color=(1, 1, 1), name=None, **says):
    data = bpy.data.lights.new(name or kind.title(), kind)
    data.energy, data.color = energy, color
    for key, value in says.items():
        setattr(data, key, value)
    thing = add(data.name, data, place)
    look_at(thing, aim)
    return thing


def sky(strength=1.0, **says):
    """Blender's sky texture; without a word of it a colour."""
    world = bpy.context.scene.world = bpy.data.worlds.new("World")
    world.use_nodes = True
    background = world.node_tree.nodes["Background"]
    background.inputs["Strength"].default_value = strength
    color = says.pop("color", None)
    if color:
        background.inputs["Color"].default_value = (*color, 1)
        return world
    texture = world.node_tree.nodes.new("ShaderNodeTexSky")
    if bpy.app.version >= (5, 0, 0) and says.get("sky_type") == "NISHITA":
        says["sky_type"] = "SINGLE_SCATTERING"  # its new name
    for key, value in says.items():
        setattr(texture, key, value)
    world.node_tree.links.new(texture.outputs[0], background.inputs["Color"])
    return world


# Inputs of the Principled BSDF in Blender 4, whose coat reflects four times as much.
LATER_NAMES = {"Clearcoat": ("Coat Weight", 0.25), "Clearcoat Roughness": ("Coat Roughness", 1), "Transmission": ("Transmission Weight", 1),
               "Subsurface": ("Subsurface Weight", 1), "Sheen": ("Sheen Weight", 1), "Emission": ("Emission Color", 1)}


def material(name, color=(0.8, 0.8, 0.8), **inputs):
    """A Principled BSDF as it is added, but for what is said, in the words of Blender 3."""
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    node = made.node_tree.nodes["Principled BSDF"]
    node.inputs["Base Color"].default_value = (*color, 1)
    for key, value in inputs.items():
        key = key.replace("_", " ").title().replace("Ior", "IOR")
        key, share = LATER_NAMES.get(key, (key, 1)) if bpy.app.version >= (4, 0, 0) else (key, 1)
        node.inputs[key].default_value = value * share
    return made


def glass(name, color=(1, 1, 1), ior=1.45, roughness=0.0):
    return material(name, color, transmission=1.0, roughness=roughness, ior=ior)


def shader(made, kind):
    return made.node_tree.nodes.new("Shader" + kind)


def mixed(made, first, second, factor):
    """What a material ends in: two shaders, by a number or by what another node says."""
    tree, both = made.node_tree, shader(made, "NodeMixShader")
    if isinstance(factor, float):
        both.inputs[0].default_value = factor
    else:
        tree.links.new(factor.outputs[0], both.inputs[0])
    tree.links.new(first.outputs[0], both.inputs[1])
    tree.links.new(second.outputs[0], both.inputs[2])
    tree.links.new(both.outputs[0], tree.nodes["Material Output"].inputs["Surface"])
    return made


def leafy(name, color, through, share=0.35, **inputs):
    """Principled in front, and light from behind."""
    made = material(name, color, **inputs)
    behind = shader(made, "NodeBsdfTranslucent")
    behind.inputs["Color"].default_value = (*through, 1)
    return mixed(made, made.node_tree.nodes["Principled BSDF"], behind, share)


def pane(name):
    """A window as architects have it, through which lamps shine straight."""
    made = material(name)
    clear, mirror, fresnel = (shader(made, "Node" + k) for k in ("BsdfTransparent", "BsdfGlossy", "Fresnel"))
    mirror.inputs["Roughness"].default_value = 0
    return mixed(made, clear, mirror, fresnel)


def texture(made, kind, dark=None, bright=None, bump=0.0, into="Base Color", stretch=(1, 1, 1), low=0.4, high=0.6, **inputs):
    """A procedural texture through a ramp into an input, and into a Bump node of that strength."""
    tree = made.node_tree
    node, place, mapping = (tree.nodes.new("ShaderNode" + k) for k in ("Tex" + kind, "TexCoord", "Mapping"))
    mapping.inputs["Scale"].default_value = stretch
    tree.links.new(place.outputs["Object"], mapping.inputs["Vector"])
    tree.links.new(mapping.outputs[0], node.inputs["Vector"])
    for key, value in inputs.items():
        node.inputs[key.replace("_", " ").title()].default_value = value
    shader = tree.nodes["Principled BSDF"]
    height = node.outputs["Distance" if kind == "Voronoi" else "Fac"]
    if dark is not None:
        ramp = tree.nodes.new("ShaderNodeValToRGB")
        for element, color, at in zip(ramp.color_ramp.elements, (dark, bright), (low, high)):
            element.color, element.position = (*color, 1) if hasattr(color, "__len__") else (color, color, color, 1), at
        tree.links.new(height, ramp.inputs[0])
        tree.links.new(ramp.outputs[0], shader.inputs[into])
    if bump:
        relief = tree.nodes.new("ShaderNodeBump")
        relief.inputs["Strength"].default_value, relief.inputs["Distance"].default_value = bump, 0.02
        tree.links.new(height, relief.inputs["Height"])
        tree.links.new(relief.outputs[0], shader.inputs["Normal"])
    return made


def mesh(name, vertices, faces, made=None, smooth=False, **where):
    data = bpy.data.meshes.new(name)
    data.from_pydata(vertices, [], faces)
    data.update()
    if made:
        data.materials.append(made)
    data.polygons.foreach_set("use_smooth", [smooth] * len(data.polygons))
    return add(name, data, **where)


def modifier(thing, kind, **says):
    made = thing.modifiers.new(kind.title(), kind)
    for key, value in says.items():
        setattr(made, key, value)
    return thing


def box(name, size, place, made, bevel=0.01, turn=(0, 0, 0), parent=None):
    """Its place is the middle of its foot."""
    x, y, z = size[0] / 2, size[1] / 2, size[2]
    corners = [(-x, -y, 0), (x, -y, 0), (x, y, 0), (-x, y, 0), (-x, -y, z), (x, -y, z), (x, y, z), (-x, y, z)]
    faces = [(0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)]
    thing = mesh(name, corners, faces, made, place=place, turn=turn, parent=parent)
    return modifier(thing, "BEVEL", width=bevel, segments=2) if bevel else thing


def plane(name, size, place, made, turn=(0, 0, 0), parent=None):
    x, y = size[0] / 2, size[1] / 2
    return mesh(name, [(-x, -y, 0), (x, -y, 0), (x, y, 0), (-x, y, 0)], [(0, 1, 2, 3)], made, place=place, turn=turn, parent=parent)


def ball(name, radius, place, made, parent=None, scale=(1, 1, 1)):
    bpy.ops.mesh.primitive_uv_sphere_add(radius=radius, segments=48, ring_count=24, location=place)
    thing = bpy.context.object
    thing.name, thing.parent, thing.scale = name, parent, scale
    thing.data.materials.append(made)
    bpy.ops.object.shade_smooth()
    return thing


def turned(name, profile, made, place=(0, 0, 0), parent=None, subdivided=2, steps=32):
    """A body turned about z: (radius, height) from the axis below, outside up, to the axis again."""
    rows = [p for p in profile if p[0] > 0]
    vertices = [(r * math.cos(2 * math.pi * k / steps), r * math.sin(2 * math.pi * k / steps), z) for r, z in rows for k in range(steps)]
    faces = [(i * steps + k, i * steps + (k + 1) % steps, (i + 1) * steps + (k + 1) % steps, (i + 1) * steps + k)
             for i in range(len(rows) - 1) for k in range(steps)]
    for end, ring in ((profile[0], 0), (profile[-1], len(rows) - 1)):
        if end[0] == 0:
            vertices.append((0, 0, end[1]))
            for k in range(steps):
                edge = (ring * steps + k, ring * steps + (k + 1) % steps)
                faces.append((*(edge[::-1] if ring == 0 else edge), len(vertices) - 1))
    thing = mesh(name, vertices, faces, made, smooth=True, place=place, parent=parent)
    return modifier(thing, "SUBSURF", levels=1, render_levels=subdivided) if subdivided else thing


def cyclorama(made, width=12, depth=5, height=6, radius=1.5):
    """A floor that bends up into a wall behind."""
    bow = [(depth - radius + radius * math.sin(a), radius - radius * math.cos(a)) for a in (k * math.pi / 24 for k in range(13))]
    line = [(-depth, 0), *bow, (depth, height)]
    vertices = [(x, y, z) for y, z in line for x in (-width / 2, width / 2)]
    return mesh("Backdrop", vertices, [(2 * k, 2 * k + 1, 2 * k + 3, 2 * k + 2) for k in range(len(line) - 1)], made, smooth=True)


def hair(thing, group, count, children, length, made, radius=0.01, **says):
    """Particle hair with children, brushed by what is said of its settings."""
    system = thing.modifiers.new("Hair", "PARTICLE_SYSTEM").particle_system
    if group:
        system.vertex_group_density = group
    settings = system.settings
    settings.type, settings.count, settings.hair_length = "HAIR", count, length
    if children:
        settings.child_type, settings.rendered_child_count = "INTERPOLATED", children
    settings.root_radius, settings.tip_radius, settings.radius_scale = 1.0, 0.3, radius
    thing.data.materials.append(made)
    settings.material = len(thing.data.materials)
    for key, value in says.items():
        setattr(settings, key, value)
    return settings


def scatter(thing, instance, count, size, uneven=0.5, name="Scatter", group=None, **says):
    """Copies of an object on another's faces."""
    system = thing.modifiers.new(name, "PARTICLE_SYSTEM").particle_system
    if group:
        system.vertex_group_density = group
    settings = system.settings
    settings.type, settings.count, settings.use_advanced_hair = "HAIR", count, True
    settings.render_type, settings.instance_object, settings.particle_size, settings.size_random = "OBJECT", instance, size, uneven
    settings.use_rotations, settings.rotation_mode, settings.phase_factor_random = True, "GLOB_Z", 2.0
    for key, value in says.items():
        setattr(settings, key, value)
    return settings
