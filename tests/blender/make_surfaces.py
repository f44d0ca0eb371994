# SPDX-License-Identifier: Apache-2.0 OR GPL-3.0-or-later
"""blender -b --factory-startup -noaudio --python-exit-code 1 -P make_surfaces.py -- FOLDER NAME...

Writes FOLDER/NAME.blend: `chart`, `angles`, `room_KIND_GREY` (a closed room of KIND diffuse or of a Principled specular, of that
reflectance in hundredths), `furnished`, `outdoors`, `mirrors`, `foggy`. What surfaces reflect is what they are about.
"""
import math
import os
import sys

import bpy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from make_blends import LATER_NAMES, add_camera, add_lamp, add_material, add_matt, add_object, add_primitive, input_of, start, world_of  # noqa: E402

COLUMNS, ROWS = 6, 4


def start_of_all_light(bounces=24):
    """All light that surfaces send to each other, whatever they are."""
    scene = start(1)
    scene.render.resolution_percentage = 50
    cycles = scene.cycles
    cycles.max_bounces = cycles.diffuse_bounces = cycles.glossy_bounces = cycles.transmission_bounces = bounces
    cycles.caustics_reflective, cycles.blur_glossy = True, 0
    return scene


def shader_of(name, kind, color, **says):
    """A material of one shader: inputs by name, properties in capitals."""
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    nodes = material.node_tree.nodes
    nodes.clear()
    node = nodes.new("ShaderNode" + kind)
    node.inputs["Base Color" if "Base Color" in node.inputs else "Color"].default_value = (*color, 1)
    for key, value in says.items():
        if key.isupper():
            setattr(node, key.lower(), value)
        else:
            key = key.replace("_", " ").title()
            entry = input_of(node, key, LATER_NAMES.get(key, key))
            is_tint = hasattr(entry.default_value, "__len__") and not hasattr(value, "__len__")  # a share of the colour in Blender 3
            entry.default_value = (value,) * 3 + (1,) if is_tint else value
    material.node_tree.links.new(node.outputs[0], nodes.new("ShaderNodeOutputMaterial").inputs["Surface"])
    return material


def joined(name, kind, first, second, factor=None):
    """Diffuse and Glossy BSDFs, mixed or added."""
    material = shader_of(name, "BsdfDiffuse", first)
    nodes, links = material.node_tree.nodes, material.node_tree.links
    gloss, both = nodes.new("ShaderNodeBsdfGlossy"), nodes.new(kind)
    gloss.inputs["Color"].default_value, gloss.inputs["Roughness"].default_value = (*second, 1), 0.4
    gloss.distribution = "GGX"
    if factor is not None:
        both.inputs[0].default_value = factor
    links.new(nodes["Diffuse BSDF"].outputs[0], both.inputs[-2])
    links.new(gloss.outputs[0], both.inputs[-1])
    links.new(both.outputs[0], nodes["Material Output"].inputs["Surface"])
    return material


def chart_materials():
    """24 of them, of Blender 3's Principled and of plain shaders."""
    red, gold, grey, blue = (0.6, 0.2, 0.15), (0.9, 0.65, 0.3), (0.5, 0.5, 0.5), (0.1, 0.2, 0.5)

    def principled(name, color, **says):
        return shader_of(name, "BsdfPrincipled", color, DISTRIBUTION=says.pop("distribution", "GGX"), **says)
    return [
        principled("grey .5", grey, roughness=0.5), principled("grey .9 dull", grey, roughness=0.9, specular=0.0),
        principled("grey .9", grey, roughness=0.9), principled("red .25", red, roughness=0.25),
        principled("red .02", red, roughness=0.02), principled("red specular 1", red, roughness=0.4, specular=1.0),
        principled("tinted", red, roughness=0.35, specular=1.0, specular_tint=1.0), principled("gold .2", gold, roughness=0.2, metallic=1.0),
        principled("gold .5", gold, roughness=0.5, metallic=1.0), principled("gold .8", gold, roughness=0.8, metallic=1.0),
        principled("half metal", gold, roughness=0.5, metallic=0.5), principled("sheen", blue, roughness=0.8, sheen=1.0),
        principled("tinted sheen", blue, roughness=0.8, sheen=1.0, sheen_tint=1.0),
        principled("coat", red, roughness=0.6, clearcoat=1.0, clearcoat_roughness=0.03),
        principled("rough coat", red, roughness=0.6, clearcoat=1.0, clearcoat_roughness=0.3),
        principled("brushed", gold, roughness=0.4, metallic=1.0, anisotropic=0.7),
        principled("multiple", gold, roughness=0.7, metallic=1.0, distribution="MULTI_GGX"), add_matt("diffuse", red),
        shader_of("rough diffuse", "BsdfDiffuse", red, roughness=1.0), shader_of("glossy", "BsdfGlossy", gold, roughness=0.3, DISTRIBUTION="GGX"),
        joined("mixed", "ShaderNodeMixShader", blue, gold, 0.3), joined("added", "ShaderNodeAddShader", blue, (0.2, 0.2, 0.2)),
        shader_of("translucent", "BsdfTranslucent", red), principled("white", (0.8, 0.8, 0.8), roughness=0.7),
    ]


def chart():
    """A board and a ball of each material, lit by a panel, a sun and a grey sky."""
    scene = start_of_all_light()
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 32 * COLUMNS, 32 * ROWS, 100
    world_of((0.4, 0.4, 0.4))
    add_lamp("AREA", (-8, -9, 10), (0, 0, 0), shape="SQUARE", size=4, energy=3000)
    add_lamp("SUN", (0, -5, 3), (-2, 0, 0), energy=0.6, angle=0.1)
    for k, material in enumerate(chart_materials()):
        x, z = k % COLUMNS - (COLUMNS - 1) / 2, (ROWS - 1) / 2 - k // COLUMNS
        add_primitive("plane", material, size=0.96, location=(x, 0.3, z), rotation=(math.pi / 2, 0, 0))
        add_primitive("uv_sphere", material, smooth=True, radius=0.34, location=(x, 0, z), segments=48, ring_count=24)
    camera = add_camera((0, -20, 0), (0, 0, 0))
    camera.data.type, camera.data.ortho_scale = "ORTHO", COLUMNS


def by_angle(name, feed, **inputs):
    """A Principled BSDF of which `feed`, given the tree, names input and socket."""
    material = add_material(name, (0.5, 0.3, 0.2))
    nodes, links = material.node_tree.nodes, material.node_tree.links
    entry, socket = feed(lambda kind, **says: filled(nodes.new("ShaderNode" + kind), says), links)
    shader = nodes["Principled BSDF"]
    for key, value in inputs.items():
        input_of(shader, LATER_NAMES.get(key, key), key).default_value = value
    if entry == "Surface":
        links.new(socket(shader), nodes["Material Output"].inputs["Surface"])
    else:
        links.new(socket, input_of(shader, LATER_NAMES.get(entry, entry), entry))
    return material


def filled(node, says):
    for key, value in says.items():
        node.inputs[key].default_value = value
    return node


def angled_materials():
    """Layer Weight and Fresnel in a colour, between textures, in light, in roughness, between shaders, in coverage."""
    def ramp(new, links):
        node = new("ValToRGB")
        node.color_ramp.elements[0].color, node.color_ramp.elements[1].color = (0.6, 0.05, 0.02, 1), (0.05, 0.1, 0.7, 1)
        node.color_ramp.elements.new(0.5).color = (0.05, 0.5, 0.1, 1)
        links.new(new("LayerWeight", Blend=0.3).outputs["Facing"], node.inputs[0])
        return "Base Color", node.outputs[0]

    def textures(new, links):
        mix = new("MixRGB")
        for source, entry in zip((new("Fresnel", IOR=2.0), new("TexNoise", Scale=2.0), new("TexVoronoi")), mix.inputs):
            links.new(source.outputs["Color" if "Color" in source.outputs else 0], entry)
        return "Base Color", mix.outputs[0]

    def shaders(new, links):
        def joined(_):
            mix = new("MixShader")
            for source, entry in zip((new("Fresnel"), new("BsdfDiffuse", Color=(0.5, 0.3, 0.2, 1)), new("BsdfGlossy", Roughness=0.3)), mix.inputs):
                links.new(source.outputs[0], entry)
            return mix.outputs[0]
        return "Surface", joined

    def cover(new, links):
        def veiled(shader):
            mix = new("MixShader")
            for source, entry in zip((new("LayerWeight").outputs["Facing"], new("BsdfTransparent").outputs[0], shader.outputs[0]), mix.inputs):
                links.new(source, entry)
            return mix.outputs[0]
        return "Surface", veiled

    return [by_angle("ramp", ramp), by_angle("textures", textures), by_angle("shaders", shaders), by_angle("veil", cover),
            by_angle("fresnel", lambda new, links: ("Base Color", new("Fresnel").outputs[0])),
            by_angle("light", lambda new, links: ("Emission Strength", new("LayerWeight").outputs["Facing"]), Emission=(1, 0.5, 0.2, 1))]


def angles():
    """A ball of each on a floor that faces away."""
    scene = start_of_all_light()
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 144, 96, 100
    world_of((0.3, 0.4, 0.6))
    add_lamp("SUN", (0, 0, 9), (-2, 3, 0), energy=2, angle=0.1)
    add_primitive("plane", by_angle("floor", lambda new, links: ("Base Color", new("LayerWeight").outputs["Facing"])), size=12)
    for k, material in enumerate(angled_materials()):
        add_primitive("uv_sphere", material, smooth=True, radius=0.6, location=(1.4 * (k % 3 - 1), 1.6 * (k // 3), 0.6), segments=48, ring_count=24)
    add_camera((0, -6, 2.5), (0, 0.6, 0.5))


def room(kind, grey):
    """A closed one, of 6 m, with a lamp below its ceiling."""
    scene = start_of_all_light(48)
    scene.render.resolution_x = scene.render.resolution_y = 128
    color = (grey, grey, grey)
    walls = add_matt("walls", color) if kind == "diffuse" else add_material("walls", color)
    if kind != "diffuse":
        input_of(walls.node_tree.nodes["Principled BSDF"], "Specular IOR Level", "Specular").default_value = float(kind)
    add_primitive("cube", walls, size=6, location=(0, 0, 3)).data.flip_normals()
    add_lamp("AREA", (0, 0, 5.9), shape="SQUARE", size=1, energy=100)
    add_camera((0, -2.9, 3), (0, 0, 3), lens=18)


def furnished():
    """Seen through an open side: table, chairs, a cabinet, a lamp, as Principled makes them."""
    scene = start_of_all_light()
    scene.render.resolution_x, scene.render.resolution_y = 160, 100
    world_of((0.05, 0.06, 0.08))
    wall, floor = add_material("wall", (0.75, 0.72, 0.66)), add_material("floor", (0.4, 0.25, 0.15), roughness=0.4)
    wood, cloth = add_material("wood", (0.35, 0.2, 0.1), roughness=0.5), add_material("cloth", (0.2, 0.3, 0.5), sheen=0.5)
    steel, china = add_material("steel", (0.7, 0.7, 0.72), metallic=1.0, roughness=0.3), add_material("china", (0.8, 0.8, 0.78), roughness=0.2)
    box = dict(size=1)
    add_primitive("cube", floor, name="floor", location=(0, 0, -0.05), scale=(6, 6, 0.1), **box)
    add_primitive("cube", wall, name="ceiling", location=(0, 0, 3.05), scale=(6, 6, 0.1), **box)
    add_primitive("cube", wall, name="back", location=(0, 3.05, 1.5), scale=(6, 0.1, 3), **box)
    for side in (-1, 1):
        add_primitive("cube", wall, name="side", location=(3.05 * side, 0, 1.5), scale=(0.1, 6, 3), **box)
    add_primitive("cube", wood, name="top", location=(0, 0.5, 0.75), scale=(2, 1, 0.06), **box)
    for x in (-0.9, 0.9):
        for y in (0.1, 0.9):
            add_primitive("cylinder", steel, name="leg", radius=0.03, depth=0.72, location=(x, y, 0.36))
    for x in (-0.6, 0.6):
        add_primitive("cube", cloth, name="seat", location=(x, -0.5, 0.45), scale=(0.45, 0.45, 0.08), **box)
        add_primitive("cube", cloth, name="rest", location=(x, -0.75, 0.8), scale=(0.45, 0.06, 0.6), **box)
    add_primitive("cube", wood, name="cabinet", location=(-2.2, 2.6, 0.9), scale=(1.2, 0.6, 1.8), **box)
    add_primitive("uv_sphere", china, smooth=True, radius=0.15, location=(0.3, 0.5, 0.93), segments=48, ring_count=24)
    add_lamp("AREA", (0, 0, 2.95), shape="SQUARE", size=1.2, energy=120)
    add_camera((0, -2.95, 1.6), (0, 1, 1.1), lens=18)


def outdoors():
    """A figure of balls under a sun and a sky, on a path between walls of plaster and brick."""
    start_of_all_light()
    world_of((0.35, 0.5, 0.8))
    add_lamp("SUN", (4, -4, 8), (0, 0, 0), energy=3, angle=0.02)
    skin, shirt = add_material("skin", (0.7, 0.45, 0.35), roughness=0.5), add_material("shirt", (0.6, 0.1, 0.1), sheen=0.6)
    trousers, shoes = add_material("trousers", (0.1, 0.12, 0.25), roughness=0.8), add_material("shoes", (0.05, 0.04, 0.03), roughness=0.25)
    add_primitive("plane", add_material("path", (0.5, 0.48, 0.42), roughness=0.95), size=40)
    add_primitive("cube", add_material("plaster", (0.8, 0.76, 0.66)), size=1, location=(-3, 2, 1.5), scale=(0.3, 8, 3))
    add_primitive("cube", add_material("brick", (0.45, 0.2, 0.14), roughness=0.85), size=1, location=(0, 5, 2), scale=(10, 0.3, 4))
    round_ = dict(smooth=True, segments=32, ring_count=16)
    add_primitive("uv_sphere", skin, name="head", radius=0.16, location=(0, 0, 1.62), **round_)
    add_primitive("uv_sphere", shirt, name="body", radius=0.3, location=(0, 0, 1.15), scale=(0.8, 0.6, 1.2), **round_)
    for side in (-1, 1):
        add_primitive("uv_sphere", shirt, name="arm", radius=0.1, location=(0.32 * side, 0, 1.15), scale=(0.8, 0.8, 3), **round_)
        add_primitive("uv_sphere", trousers, name="leg", radius=0.12, location=(0.14 * side, 0, 0.5), scale=(1, 1, 4), **round_)
        add_primitive("uv_sphere", shoes, name="shoe", radius=0.1, location=(0.14 * side, -0.06, 0.06), scale=(0.9, 1.8, 0.6), **round_)
    add_primitive("cylinder", add_material("barrel", (0.6, 0.6, 0.62), metallic=1.0, roughness=0.5), radius=0.4, depth=1, location=(1.2, 1, 0.5))
    add_camera((0.6, -5, 1.5), (0, 0, 1.0), lens=40)


def mirrors():
    """Balls of a mirror, of glass and of black paint under a clear coat, and nothing else but lamps of all kinds."""
    start_of_all_light()
    world_of((0, 0, 0))
    black = shader_of("paint", "BsdfPrincipled", (0, 0, 0), specular=0.0, clearcoat=1.0, clearcoat_roughness=0.03)
    glass = shader_of("glass", "BsdfPrincipled", (1, 1, 1), transmission=1.0, roughness=0.0)
    for x, made in ((-1.1, add_material("mirror", (0.8, 0.8, 0.8), metallic=1.0, roughness=0.0)), (0, black), (1.1, glass)):
        add_primitive("uv_sphere", made, smooth=True, radius=0.5, location=(x, 0, 0), segments=96, ring_count=48)
    add_lamp("AREA", (-3, -4, 4), shape="SQUARE", size=2, energy=900)
    add_lamp("SPOT", (2, -5, 3), energy=700, shadow_soft_size=0.5, spot_size=math.radians(50), spot_blend=0.3)
    add_lamp("POINT", (0, 3, 3), energy=500, shadow_soft_size=0.6)
    add_lamp("SUN", (0, -5, -1), (0, 0, 0), energy=1, angle=0.3)
    # Mirrors alone show it: no ray of theirs may meet this one.
    hidden = add_lamp("AREA", (4, -3, 0), shape="DISK", size=2, energy=900)
    hidden.visible_diffuse = hidden.visible_glossy = hidden.visible_transmission = hidden.visible_volume_scatter = False
    add_camera((0, -8, 0.6), (0, 0, 0), lens=70)


def foggy():
    """A street lamp over a road, in an even volume that hides sky and sun."""
    start_of_all_light()
    world = world_of((0.3, 0.3, 0.3))
    nodes = world.node_tree.nodes
    fog = nodes.new("ShaderNodeVolumeScatter")
    fog.inputs["Density"].default_value, fog.inputs["Anisotropy"].default_value = 0.05, 0.3
    world.node_tree.links.new(fog.outputs[0], nodes["World Output"].inputs["Volume"])
    add_primitive("plane", add_matt("road", (0.4, 0.4, 0.4)), size=40, location=(0, 10, 0))
    add_lamp("SPOT", (0, 4, 5), (0, 4.001, 0), energy=2000, shadow_soft_size=0, spot_size=math.radians(100), spot_blend=0.4)
    add_lamp("SUN", (0, 0, 9), (0, 0, 0), energy=1)
    add_camera((0, -6, 2), (0, 4, 2))


def lost_nodes():
    """A thing for each node that is not kept as it is: kept.py has them; and bodies of coloured glass that modifiers turn."""
    start(1)
    world_of((0.5, 0.5, 0.5))
    sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "blender"))
    from film_export.kept import LOST, NEAR, SHADERS
    for kind, _, fate, _ in SHADERS:
        node = "Bsdf" + kind[5:].title()
        if fate in {NEAR, LOST} and hasattr(bpy.types, "ShaderNode" + node):
            add_primitive("plane", shader_of(f"M {kind}", node, (0.5, 0.5, 0.5)), size=1, name=f"T {kind}")
    smoke = volume_of("Smoke", "ShaderNodeVolumePrincipled")
    smoke.node_tree.nodes.remove(smoke.node_tree.nodes["Principled BSDF"])
    add_primitive("cube", smoke, size=1, name="Domain")
    add_primitive("cube", volume_of("Milk", "ShaderNodeVolumeScatter"), size=1, name="Bottle")
    bottle = volume_of("Green", "ShaderNodeVolumeAbsorption", color=(0.1, 0.6, 0.2, 1), density=2.0)
    node = bottle.node_tree.nodes["Principled BSDF"]
    input_of(node, "Transmission Weight", "Transmission").default_value = 1
    mesh = bpy.data.meshes.new("Lathe")
    profile = [(0, 0, 0), (0.3, 0, 0), (0.35, 0, 0.5), (0.1, 0, 0.8), (0, 0, 0.85)]
    mesh.from_pydata(profile, [(k, k + 1) for k in range(4)], [])
    for name in ("Vase", "Open Vase"):
        vase = add_object(name, mesh.copy())
        vase.data.materials.append(bottle)
        turned = vase.modifiers.new("Screw", "SCREW")
        turned.steps = turned.render_steps = 24
        turned.use_merge_vertices = False
        turned.use_normal_calculate = True
        if name == "Open Vase":
            turned.angle = 5
    add_primitive("plane", bottle, size=1, name="Window")
    add_camera((0, -6, 2), (0, 0, 0.5))


def volume_of(name, kind, **inputs):
    material = add_material(name)
    nodes = material.node_tree.nodes
    node = nodes.new(kind)
    for key, value in inputs.items():
        node.inputs[key.title()].default_value = value
    material.node_tree.links.new(node.outputs[0], nodes["Material Output"].inputs["Volume"])
    return material


def main():
    folder, *names = sys.argv[sys.argv.index("--") + 1:]
    for name in names:
        what, *parts = [name] if name == "lost_nodes" else name.split("_")
        {"lost_nodes": lost_nodes, "chart": chart, "angles": angles, "furnished": furnished, "outdoors": outdoors, "mirrors": mirrors, "foggy": foggy, "room": lambda: room(parts[0], int(parts[1]) / 100)}[what]()
        bpy.ops.wm.save_as_mainfile(filepath=os.path.join(os.path.abspath(folder), name + ".blend"), check_existing=False)


main()
