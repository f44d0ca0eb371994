"""blender -b -noaudio --factory-startup --python-exit-code 1 -P cycles.py -- FOLDER SAMPLES SIZE [NAME...]

Renders the balls of models.py with Cycles, FOLDER/NAME_cycles.exr, as far as it has their materials: 3.4 has neither thin
films nor Charlie's sheen, and no pane whose two sides are alike.
"""
import math
import os
import sys

import bpy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import models


def node(tree, kind, **inputs):
    made = tree.nodes.new(kind)
    for name, value in inputs.items():
        made.inputs[name.replace("_", " ")].default_value = value
    return made


def mix(tree, factor, first, second):
    made = tree.nodes.new("ShaderNodeMixShader")
    if isinstance(factor, float):
        made.inputs[0].default_value = factor
    else:
        tree.links.new(factor, made.inputs[0])
    tree.links.new(first.outputs[0], made.inputs[1])
    tree.links.new(second.outputs[0], made.inputs[2])
    return made


def shader(tree, says):
    """The material's last node; none where Cycles has no such material."""
    base = says["pbrMetallicRoughness"]
    color, metallic, roughness = base["baseColorFactor"], base["metallicFactor"], base["roughnessFactor"]
    extensions = {name.removeprefix("KHR_materials_"): values for name, values in says.get("extensions", {}).items()}
    if extensions.keys() & {"sheen", "iridescence", "transmission"}:
        return None
    if "diffuse_transmission" in extensions:
        leaf = extensions["diffuse_transmission"]
        back = node(tree, "ShaderNodeBsdfTranslucent", Color=(*leaf["diffuseTransmissionColorFactor"], 1))
        return mix(tree, leaf["diffuseTransmissionFactor"], node(tree, "ShaderNodeBsdfDiffuse", Color=color), back)
    made = node(tree, "ShaderNodeBsdfPrincipled", Base_Color=color, Metallic=metallic, Roughness=roughness)
    made.distribution = "GGX"
    if "ior" in extensions:
        f0 = ((extensions["ior"]["ior"] - 1) / (extensions["ior"]["ior"] + 1)) ** 2
        made.inputs["Specular"].default_value = f0 / 0.08
    if "specular" in extensions:
        tint = extensions["specular"]["specularColorFactor"]
        below = node(tree, "ShaderNodeBsdfDiffuse", Color=color)
        above = node(tree, "ShaderNodeBsdfGlossy", Roughness=roughness)
        lit = node(tree, "ShaderNodeLayerWeight", Blend=0.5)  # its output "Facing" is 1 - n.v
        grazing = tree.nodes.new("ShaderNodeMath")
        grazing.operation = "POWER"
        grazing.inputs[1].default_value = 5
        tree.links.new(lit.outputs["Facing"], grazing.inputs[0])
        blend = node(tree, "ShaderNodeMixRGB", Color1=(*(0.04 * t for t in tint), 1), Color2=(1, 1, 1, 1))
        tree.links.new(grazing.outputs[0], blend.inputs["Fac"])
        tree.links.new(blend.outputs[0], above.inputs["Color"])
        largest = node(tree, "ShaderNodeMixRGB", Color1=(*(1 - 0.04 * max(tint) for _ in tint), 1), Color2=(0, 0, 0, 1))
        tree.links.new(grazing.outputs[0], largest.inputs["Fac"])
        times = node(tree, "ShaderNodeMixRGB", Color2=color, Fac=1.0)
        times.blend_type = "MULTIPLY"
        tree.links.new(largest.outputs[0], times.inputs["Color1"])
        tree.links.new(times.outputs[0], below.inputs["Color"])
        sum_ = tree.nodes.new("ShaderNodeAddShader")
        tree.links.new(below.outputs[0], sum_.inputs[0])
        tree.links.new(above.outputs[0], sum_.inputs[1])
        return sum_
    if "clearcoat" in extensions:
        # Principled's own coat is a quarter of a film of index 1.5.
        coat = extensions["clearcoat"]
        made.inputs["Specular"].default_value = 0.5
        film = node(tree, "ShaderNodeBsdfGlossy", Roughness=coat.get("clearcoatRoughnessFactor", 0.0))
        return mix(tree, node(tree, "ShaderNodeFresnel", IOR=1.5).outputs[0], made, film)
    if "anisotropy" in extensions:
        brushed = extensions["anisotropy"]
        alpha = roughness ** 2
        along = alpha + (1 - alpha) * brushed["anisotropyStrength"] ** 2
        # Cycles' glossy node makes widths a^2 (1 + s) and a^2 / (1 - s) of its roughness a, for s < 0.
        s = math.sqrt(along / alpha)
        made = node(tree, "ShaderNodeBsdfAnisotropic", Color=color, Roughness=math.sqrt(alpha * s), Anisotropy=1 - 1 / s)
        made.distribution = "GGX"
        made.inputs["Rotation"].default_value = 0.25 + brushed.get("anisotropyRotation", 0) / (2 * math.pi)
        tangent = tree.nodes.new("ShaderNodeTangent")
        tangent.direction_type = "UV_MAP"
        tree.links.new(tangent.outputs[0], made.inputs["Tangent"])
    if "emissive_strength" in extensions:
        made.inputs["Emission"].default_value = (*says["emissiveFactor"], 1)
        made.inputs["Emission Strength"].default_value = extensions["emissive_strength"]["emissiveStrength"]
    return made


def to_blender(v):
    return (v[0], -v[2], v[1])


def main():
    folder, samples, size, *names = sys.argv[sys.argv.index("--") + 1:]
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.render.resolution_x = scene.render.resolution_y = int(size)
    scene.render.image_settings.file_format, scene.render.image_settings.color_depth = "OPEN_EXR", "32"
    scene.cycles.samples, scene.cycles.use_adaptive_sampling, scene.cycles.use_denoising = int(samples), False, False
    scene.cycles.pixel_filter_type, scene.cycles.filter_width = "BOX", 1.0
    scene.cycles.sample_clamp_indirect = 0

    scene.world = bpy.data.worlds.new("world")
    scene.world.use_nodes = True
    sky = scene.world.node_tree
    image = sky.nodes.new("ShaderNodeTexEnvironment")
    image.image = bpy.data.images.load(os.path.join(folder, "sky.hdr"))
    turn = node(sky, "ShaderNodeMapping")
    turn.inputs["Rotation"].default_value[2] = -math.pi / 2  # its middle is +x, ours -z, which is +y there
    sky.links.new(sky.nodes.new("ShaderNodeTexCoord").outputs["Generated"], turn.inputs[0])
    sky.links.new(turn.outputs[0], image.inputs[0])
    sky.links.new(image.outputs[0], sky.nodes["Background"].inputs[0])

    places, _, uvs, triangles = models.ball()
    mesh = bpy.data.meshes.new("ball")
    mesh.from_pydata([to_blender(p) for p in places], [], triangles)
    layer = mesh.uv_layers.new()
    for loop, corner in zip(mesh.loops, layer.data):
        corner.uv = (uvs[loop.vertex_index][0], 1 - uvs[loop.vertex_index][1])
    mesh.polygons.foreach_set("use_smooth", [True] * len(mesh.polygons))
    mesh.use_auto_smooth = True
    mesh.normals_split_custom_set_from_vertices([to_blender(p) for p in places])
    thing = bpy.data.objects.new("ball", mesh)
    scene.collection.objects.link(thing)
    camera = bpy.data.cameras.new("camera")
    camera.lens_unit, camera.angle = "FOV", 0.5
    eye = bpy.data.objects.new("camera", camera)
    eye.location, eye.rotation_euler = (0, -5, 0), (math.pi / 2, 0, 0)
    scene.collection.objects.link(eye)
    scene.camera = eye

    for name, says in models.materials().items():
        material = bpy.data.materials.new(name)
        material.use_nodes = True
        tree = material.node_tree
        tree.nodes.clear()
        last = shader(tree, says)
        if last is None or (names and name not in names):
            continue
        tree.links.new(last.outputs[0], tree.nodes.new("ShaderNodeOutputMaterial").inputs["Surface"])
        mesh.materials.clear()
        mesh.materials.append(material)
        scene.render.filepath = os.path.join(folder, name + "_cycles.exr")
        bpy.ops.render.render(write_still=True)


main()
