"""blender -b -noaudio --factory-startup --python-exit-code 1 -P cycles.py -- FOLDER SAMPLES [WIDTH HEIGHT]

Renders FOLDER/film.json (as scenes.py writes it: linear keys, constant sky) with Cycles, twice with SAMPLES samples and
different seeds: FOLDER/cycles0.exr, cycles1.exr; of a film of several frames cycles0_0000.exr and so on, with a seed for each
frame, and FOLDER/cycles_film_seconds: CPU seconds of one sample of one frame, starting and loading aside. No denoiser, no clamp, no adaptive sampling, box filter of one pixel, paths
of up to 128 surfaces.

Units. A sun's strength is its irradiance. Panels and spheres are meshes of that radiance. The power of a point lamp is
POINT_POWER times its radiant intensity. The scenes check_* prove all of them by closed form.
"""
import json
import math
import os
import struct
import sys

import bpy
from mathutils import Matrix, Quaternion, Vector

POINT_POWER = 4 * math.pi  # watts of a Blender point lamp per W/sr
TO_BLENDER = Matrix(((1, 0, 0, 0), (0, 0, -1, 0), (0, 1, 0, 0), (0, 0, 0, 1)))  # y up to z up


def at(thing, seconds):
    """A thing with keys as it is then."""
    if "keys" not in thing:
        return thing
    first, last = thing["keys"]
    part = seconds / last["at"]

    def between(a, b):
        return [between(x, y) for x, y in zip(a, b)] if isinstance(a, list) else a + part * (b - a)
    return {**thing, **{k: between(v, last[k]) for k, v in first.items() if k != "at"}}


def colour(value, length=3):
    return tuple(value)[:length] if isinstance(value, (list, tuple)) else (value,) * length


def pose(thing):
    """Roll is done first, yaw last."""
    turn = thing.get("rotate", 0)
    pitch, yaw, roll = (math.radians(a) for a in (turn if isinstance(turn, list) else (0, turn, 0)))
    rotation = Matrix.Rotation(yaw, 4, "Y") @ Matrix.Rotation(pitch, 4, "X") @ Matrix.Rotation(roll, 4, "Z")
    return Matrix.Translation(thing.get("position", (0, 0, 0))) @ rotation


def round_body(segments, profile):
    """Vertices and faces of a body of revolution; profile: (radius, height) upwards."""
    vertices, faces, rings = [], [], []
    for radius, height in profile:
        count = segments if radius > 1e-9 else 1
        rings.append([len(vertices) + i for i in range(count)])
        for i in range(count):
            angle = 2 * math.pi * i / segments
            vertices.append((radius * math.sin(angle), height, radius * math.cos(angle)))
    for low, high in zip(rings, rings[1:]):
        for i in range(segments):
            corners = [low[i % len(low)], low[(i + 1) % len(low)], high[(i + 1) % len(high)], high[i % len(high)]]
            corners = [c for k, c in enumerate(corners) if c not in corners[:k]]
            if len(corners) > 2:
                faces.append(corners)
    return vertices, faces


def shape(thing):
    """Vertices, faces, whether smooth."""
    kind = thing["shape"]
    if kind in ("plane", "quad"):
        a, b = (s / 2 for s in thing["size"])
        flat = [(-a, -b), (a, -b), (a, b), (-a, b)]
        return [(x, 0, -y) if kind == "plane" else (x, y, 0) for x, y in flat], [(0, 1, 2, 3)], False
    if kind == "box":
        x, y, z = colour(thing["size"])
        corners = [(i * x / 2, j * y, k * z / 2) for j in (0, 1) for k in (-1, 1) for i in (-1, 1)]
        return corners, [(0, 1, 3, 2), (4, 6, 7, 5), (2, 3, 7, 6), (1, 0, 4, 5), (0, 2, 6, 4), (3, 1, 5, 7)], False
    count = thing.get("segments", 128)
    if kind == "sphere":
        steps = [math.pi * (i / (count // 2) - 0.5) for i in range(count // 2 + 1)]
        profile = [(thing["radius"] * math.cos(a), thing["radius"] * math.sin(a)) for a in steps]
        return (*round_body(count, profile), True)
    if kind == "cylinder":
        r, h = thing["radius"], thing["height"]
        return (*round_body(count, [(0, 0), (r, 0), (r, h), (0, h)]), False)
    if kind == "lathe":
        return (*round_body(count, thing["profile"]), "creased")
    raise ValueError("no shape " + kind)


class Nodes:
    """A material or world of nodes."""

    def __init__(self, owner, output):
        owner.use_nodes = True
        self.tree = owner.node_tree
        self.tree.nodes.clear()
        self.output = self.tree.nodes.new(output)

    def add(self, kind, **inputs):
        node = self.tree.nodes.new(kind)
        for name, value in inputs.items():
            node.inputs[name].default_value = value
        return node

    def link(self, source, target):
        self.tree.links.new(source, target)

    def end(self, node):
        self.link(node.outputs[0], self.output.inputs["Surface"])

    def math(self, operation, first, second):
        """Of outputs or numbers."""
        node = self.tree.nodes.new("ShaderNodeMath")
        node.operation = operation
        for value, entry in zip((first, second), node.inputs):
            if isinstance(value, (int, float)):
                entry.default_value = value
            else:
                self.link(value, entry)
        return node.outputs[0]

    def mix(self, factor, first, second):
        node = self.add("ShaderNodeMixShader")
        self.link(factor, node.inputs[0])
        self.link(first.outputs[0], node.inputs[1])
        self.link(second.outputs[0], node.inputs[2])
        return node

    def from_front(self, light):
        back = self.add("ShaderNodeBsdfDiffuse", Color=(0, 0, 0, 1))
        return self.mix(self.add("ShaderNodeNewGeometry").outputs["Backfacing"], light, back)


def emitter(radiance, one_sided):
    material = bpy.data.materials.new("lamp")
    nodes = Nodes(material, "ShaderNodeOutputMaterial")
    light = nodes.add("ShaderNodeEmission", Color=(*radiance, 1), Strength=1)
    nodes.end(nodes.from_front(light) if one_sided else light)
    return material


def surface(name, says, side):
    material = bpy.data.materials.new(name)
    nodes = Nodes(material, "ShaderNodeOutputMaterial")
    base = (*colour(says["base_color"]), 1)
    if says.get("solid"):
        body(nodes, says)
    elif says.get("transmission"):
        nodes.end(pane(nodes, base))
    elif "emission" in says:
        image = picture(nodes, says["emission_texture"], side)
        node = nodes.add("ShaderNodeEmission", Strength=says["emission"])
        nodes.link(image.outputs[0], node.inputs["Color"])
        nodes.end(nodes.from_front(node))
    elif "texture" in says:
        node = nodes.add("ShaderNodeBsdfDiffuse", Color=base)
        factor = picture(nodes, says["texture"], side).outputs["Alpha"]
        cut = nodes.math("GREATER_THAN", factor, says.get("alpha_cutoff", 0.5))
        nodes.end(nodes.mix(cut, nodes.add("ShaderNodeBsdfTransparent"), node))
    elif says.get("metallic") == 1 and says["roughness"] < 0.1:
        node = nodes.add("ShaderNodeBsdfGlossy", Roughness=0)
        node.distribution = "SHARP"
        nodes.link(schlick(nodes, base), node.inputs["Color"])
        nodes.end(node)
    elif "metallic" not in says and "roughness" not in says:
        nodes.end(nodes.add("ShaderNodeBsdfDiffuse", Color=base))
    elif side.get("dielectric") == "mix":
        nodes.end(nodes.mix(nodes.add("ShaderNodeFresnel", IOR=1.5).outputs[0], nodes.add("ShaderNodeBsdfDiffuse", Color=base),
                            glossy(nodes, says["roughness"])))
    else:
        node = nodes.add("ShaderNodeBsdfPrincipled", **{"Base Color": base, "Metallic": says["metallic"],
                                                       "Roughness": says["roughness"], "Specular": 0.5})
        node.distribution = "MULTI_GGX"
        nodes.end(node)
    return material


def picture(nodes, name, side):
    """An image of the film's folder, once over the face, which our quads and these share."""
    node = nodes.add("ShaderNodeTexImage")
    node.image = bpy.data.images.load(os.path.join(side["folder"], name))
    node.extension = "REPEAT"
    return node


def schlick(nodes, normal):
    """Fresnel's colour by Schlick's formula, from that at normal incidence."""
    geometry = nodes.add("ShaderNodeNewGeometry")
    cosine = nodes.tree.nodes.new("ShaderNodeVectorMath")
    cosine.operation = "DOT_PRODUCT"
    nodes.link(geometry.outputs["Incoming"], cosine.inputs[0])
    nodes.link(geometry.outputs["Normal"], cosine.inputs[1])
    grazing = nodes.math("POWER", nodes.math("SUBTRACT", 1, nodes.math("ABSOLUTE", cosine.outputs["Value"], 0)), 5)
    blend = nodes.add("ShaderNodeMixRGB", Color1=normal, Color2=(1, 1, 1, 1))
    nodes.link(grazing, blend.inputs["Fac"])
    return blend.outputs[0]


def pane(nodes, tint):
    """Thin glass of index 1.5: what is not mirrored goes straight on, tinted."""
    mirror = nodes.add("ShaderNodeBsdfGlossy", Color=(1, 1, 1, 1), Roughness=0)
    mirror.distribution = "SHARP"
    return nodes.mix(schlick(nodes, (0.04, 0.04, 0.04, 1)), nodes.add("ShaderNodeBsdfTransparent", Color=tint), mirror)


def body(nodes, says):
    """Solid glass; what it takes on the way is a volume."""
    node = nodes.add("ShaderNodeBsdfGlass", Color=(1, 1, 1, 1), Roughness=0, IOR=says.get("ior", 1.5))
    node.distribution = "SHARP"
    nodes.end(node)
    if "attenuation" in says:
        taken = [-math.log(a) / says.get("attenuation_distance", 1) for a in says["attenuation"]]
        # Absorption is density times one less the colour.
        density = max(taken)
        volume = nodes.add("ShaderNodeVolumeAbsorption", Color=(*[1 - t / density for t in taken], 1), Density=density)
        nodes.link(volume.outputs[0], nodes.output.inputs["Volume"])


def glossy(nodes, roughness):
    node = nodes.add("ShaderNodeBsdfGlossy", Color=(1, 1, 1, 1), Roughness=roughness)
    node.distribution = "MULTI_GGX"
    return node


def add_mesh(vertices, faces, material, matrix, smooth, normals=None):
    mesh = bpy.data.meshes.new("mesh")
    mesh.from_pydata(vertices, [], faces)
    mesh.materials.append(material)
    if len(faces) == 1 and len(faces[0]) == 4:
        layer = mesh.uv_layers.new()
        for corner, place in zip(layer.data, ((0, 0), (1, 0), (1, 1), (0, 1))):
            corner.uv = place
    if smooth or normals:
        mesh.polygons.foreach_set("use_smooth", [True] * len(mesh.polygons))
    if smooth == "creased":
        mesh.use_auto_smooth, mesh.auto_smooth_angle = True, math.radians(30)
    if normals:
        mesh.use_auto_smooth = True
        mesh.normals_split_custom_set_from_vertices(normals)
    mesh.update()
    thing = bpy.data.objects.new("object", mesh)
    thing.matrix_world = TO_BLENDER @ matrix
    bpy.context.scene.collection.objects.link(thing)
    return thing


def add_model(path):
    """A .glb of triangles with positions and normals."""
    data = open(path, "rb").read()
    length = struct.unpack("<I", data[12:16])[0]
    document, binary = json.loads(data[20:20 + length]), data[28 + length:]
    materials = []
    for says in document["materials"]:
        strength = says["extensions"].get("KHR_materials_emissive_strength", {}).get("emissiveStrength", 1)
        emission = [strength * e for e in says["emissiveFactor"]]
        if max(emission) > 0:
            materials.append(emitter(emission, False))
        else:
            materials.append(surface(says["name"], {"base_color": says["pbrMetallicRoughness"]["baseColorFactor"][:3]}, {}))

    def read(index):
        accessor = document["accessors"][index]
        view = document["bufferViews"][accessor["bufferView"]]
        code = {5126: "f", 5125: "I", 5123: "H", 5121: "B"}[accessor["componentType"]]
        width = {"SCALAR": 1, "VEC3": 3}[accessor["type"]]
        start = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
        flat = struct.unpack_from(f"<{accessor['count'] * width}{code}", binary, start)
        return flat if width == 1 else list(zip(flat[::3], flat[1::3], flat[2::3]))

    def visit(index, above):
        node = document["nodes"][index]
        if "matrix" in node:
            local = Matrix([node["matrix"][i::4] for i in range(4)])
        else:
            x, y, z, w = node.get("rotation", (0, 0, 0, 1))
            local = Matrix.LocRotScale(Vector(node.get("translation", (0, 0, 0))), Quaternion((w, x, y, z)),
                                       Vector(node.get("scale", (1, 1, 1))))
        here = above @ local
        for part in document["meshes"][node["mesh"]]["primitives"] if "mesh" in node else ():
            order = read(part["indices"])
            add_mesh(read(part["attributes"]["POSITION"]), list(zip(order[::3], order[1::3], order[2::3])),
                     materials[part["material"]], here, True, read(part["attributes"]["NORMAL"]))
        for child in node.get("children", ()):
            visit(child, here)

    for root in document["scenes"][document.get("scene", 0)]["nodes"]:
        visit(root, Matrix())


def add_light(says):
    light = [c * says["intensity"] for c in colour(says.get("color", 1))]
    kind = says["kind"]
    if kind == "panel":
        add_mesh(*shape({"shape": "quad", "size": says["size"]})[:2], emitter(light, True), pose(says) @ Matrix.Rotation(math.pi, 4, "Y"),
                 False)
    elif kind == "sphere":
        vertices, faces, _ = shape({"shape": "sphere", "radius": says["radius"]})
        add_mesh(vertices, faces, emitter(light, False), pose(says), True)
    else:
        lamp = bpy.data.lights.new(kind, "SUN" if kind == "sun" else "POINT")
        thing = bpy.data.objects.new(kind, lamp)
        lamp.color, lamp.cycles.max_bounces = [c / says["intensity"] for c in light], 1024
        if kind == "sun":
            lamp.energy, lamp.angle = says["intensity"], math.radians(says.get("angle", 0))
            up, round_ = math.radians(says["elevation"]), math.radians(says["azimuth"])
            towards = Vector((math.cos(up) * math.sin(round_), math.sin(up), math.cos(up) * math.cos(round_)))
            thing.rotation_euler = (TO_BLENDER.to_3x3() @ towards).to_track_quat("Z", "Y").to_euler()
        else:
            lamp.energy, lamp.shadow_soft_size = POINT_POWER * says["intensity"], 0
            thing.location = TO_BLENDER @ Vector(says["position"])
        bpy.context.scene.collection.objects.link(thing)


def add_camera(says):
    camera = bpy.data.cameras.new("camera")
    camera.sensor_fit, camera.lens_unit, camera.angle_y = "VERTICAL", "FOV", math.radians(says["fov"])
    camera.clip_start, camera.clip_end = 1e-3, 1e5
    thing = bpy.data.objects.new("camera", camera)
    bpy.context.scene.collection.objects.link(thing)
    bpy.context.scene.camera = thing
    return thing


def aim_camera(thing, says):
    place, aim = (TO_BLENDER @ Vector(says[k]) for k in ("position", "look_at"))
    thing.location, thing.rotation_euler = place, (aim - place).to_track_quat("-Z", "Y").to_euler()


def set_up(film, samples, size, bounces, caustics):
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.render.resolution_x, scene.render.resolution_y = size
    scene.render.resolution_percentage = 100
    scene.render.threads_mode, scene.render.threads = "FIXED", 1
    scene.render.use_persistent_data = True
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_depth = "32"
    cycles = scene.cycles
    cycles.device, cycles.samples, cycles.use_adaptive_sampling, cycles.use_denoising = "CPU", samples, False, False
    cycles.max_bounces = cycles.diffuse_bounces = cycles.glossy_bounces = bounces
    cycles.caustics_reflective = cycles.caustics_refractive = caustics
    cycles.transmission_bounces, cycles.blur_glossy = bounces, 0
    cycles.transparent_max_bounces = 64
    cycles.pixel_filter_type, cycles.filter_width = "BOX", 1.0
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0
    cycles.light_sampling_threshold = 0
    scene.world = bpy.data.worlds.new("world")
    nodes = Nodes(scene.world, "ShaderNodeOutputWorld")
    nodes.end(nodes.add("ShaderNodeBackground", Color=(*colour(film.get("sky", 0)), 1), Strength=1))


def main():
    folder, samples = sys.argv[sys.argv.index("--") + 1:][:2]
    film = json.load(open(os.path.join(folder, "film.json")))
    side = {**json.load(open(os.path.join(folder, "side.json"))), "folder": folder}
    size = [int(a) for a in sys.argv[sys.argv.index("--") + 3:]] or film["size"]
    bpy.ops.wm.read_factory_settings(use_empty=True)
    set_up(film, int(samples), size, side.get("bounces", 128), side.get("caustics", True))
    materials = {name: surface(name, says, side) for name, says in film.get("materials", {}).items()}
    movers = []
    for thing in film.get("objects", []):
        vertices, faces, smooth = shape(thing)
        made = add_mesh(vertices, faces, materials[thing["material"]], pose(at(thing, 0)), smooth)
        if "keys" in thing:
            movers.append((made, thing))
    for light in film.get("lights", []):
        add_light(light)
    if "scene" in film:
        add_model(os.path.join(folder, film["scene"]))
    camera = add_camera(film["camera"])
    begin = None
    for frame in range(film["frames"]):
        aim_camera(camera, at(film["camera"], frame / film["frame_rate"]))
        for made, thing in movers:
            made.matrix_world = TO_BLENDER @ pose(at(thing, frame / film["frame_rate"]))
        for seed in (0, 1):
            bpy.context.scene.cycles.seed = 2 * side["seed"] + seed + 10000 * frame
            name = f"cycles{seed}_{frame:04d}" if film["frames"] > 1 else f"cycles{seed}"
            bpy.context.scene.render.filepath = os.path.join(folder, name + ".exr")
            bpy.ops.render.render(write_still=True)
            begin = begin or cpu_seconds()  # after the first, which loads
    open(os.path.join(folder, "cycles_seconds"), "w").write(f"{cpu_seconds():.0f}")
    if film["frames"] > 1:
        each = (cpu_seconds() - begin) / (2 * film["frames"] - 1)
        open(os.path.join(folder, "cycles_film_seconds"), "w").write(f"{each / int(samples):.6f}")


def cpu_seconds():
    times = os.times()
    return times.user + times.system


main()
