# SPDX-License-Identifier: Apache-2.0 OR GPL-3.0-or-later
"""The world as an animation file's sky: a colour, or an image that Cycles renders of it."""
import math
import os

import bpy
import numpy as np

from .cameras import TO_FILM
from .keys import json_number, turns
from .looks import Constant, Reader
from .nodes import incoming, output_of

WIDTH, HEIGHT, SAMPLES = 1024, 512, 16
# Four samples of a sky that is smooth but for its horizon are within 0.3 % of sixteen.
SAMPLES_OF_SMOOTH, SMOOTH = 4, {"TEX_SKY", "BACKGROUND", "OUTPUT_WORLD", "REROUTE", "FRAME"}


def has_sun(sky):
    """Of the models of scattered light, Nishita's before Blender 5."""
    return sky.sky_type not in {"PREETHAM", "HOSEK_WILKIE"} and sky.sun_disc


def sun_of(world):
    """The sky texture whose sun is shown, None where there is none."""
    for node in world.node_tree.nodes:
        if node.type == "TEX_SKY" and node.outputs[0].is_linked and has_sun(node) and node.sun_intensity > 0:
            return node
    return None


class Studio:
    """A scene with the world and a camera, nothing else."""

    def __init__(self, world, folder):
        self.scene = scene = bpy.data.scenes.new("render2mpeg world")
        scene.world, self.path = world, os.path.join(folder, "sky.exr")
        # Maps of where a world is bright serve surfaces, of which there are none.
        self.sampling, world.cycles.sampling_method = world.cycles.sampling_method, "NONE"
        scene.render.engine = "CYCLES"
        cycles = scene.cycles
        cycles.device, cycles.use_denoising, cycles.use_adaptive_sampling, cycles.shading_system = "CPU", False, False, False
        cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0
        scene.render.film_transparent = False
        scene.render.use_compositing = scene.render.use_sequencer = False
        scene.render.resolution_percentage = 100
        scene.render.image_settings.file_format, scene.render.image_settings.color_depth = "OPEN_EXR", "32"
        camera = bpy.data.cameras.new("render2mpeg world")
        self.camera = bpy.data.objects.new("render2mpeg world", camera)
        scene.collection.objects.link(self.camera)
        scene.camera = self.camera

    def render(self, width, height, samples):
        self.scene.render.resolution_x, self.scene.render.resolution_y = width, height
        self.scene.cycles.samples = samples
        self.scene.render.filepath = self.path
        bpy.ops.render.render(write_still=True, scene=self.scene.name)

    def all_around(self):
        camera = self.camera.data
        camera.type = "PANO"
        if hasattr(camera, "panorama_type"):  # Blender 4.x
            camera.panorama_type = "EQUIRECTANGULAR"
        else:
            camera.cycles.panorama_type = "EQUIRECTANGULAR"
        self.camera.rotation_mode = "XYZ"
        self.camera.rotation_euler = (math.pi / 2, 0, 0)  # the middle looks along Blender's y: the film's -z
        smooth = all(node.type in SMOOTH for node in self.scene.world.node_tree.nodes)
        self.render(WIDTH, HEIGHT, SAMPLES_OF_SMOOTH if smooth else SAMPLES)

    def light_towards(self, direction, half):
        """Irradiance across the beam from a cone of this half angle."""
        camera, size = self.camera.data, 128
        camera.type, camera.lens_unit, camera.angle = "PERSP", "FOV", 2.2 * half
        self.camera.rotation_mode = "QUATERNION"
        self.camera.rotation_quaternion = direction.to_track_quat("-Z", "Y")
        self.render(size, size, 16)
        image = bpy.data.images.load(self.path)
        image.colorspace_settings.name = "Non-Color"
        pixels = np.array(image.pixels[:]).reshape(size, size, -1)[..., :3]
        bpy.data.images.remove(image)
        os.remove(self.path)
        edge = math.tan(1.1 * half)
        places = (np.arange(size) + 0.5) / size * 2 - 1
        x, y = np.meshgrid(places * edge, places * edge)
        solid = (2 * edge / size) ** 2 / (1 + x * x + y * y) ** 1.5
        return np.sum(pixels * solid[..., None], axis=(0, 1))

    def end(self):
        self.scene.world.cycles.sampling_method = self.sampling
        bpy.data.objects.remove(self.camera)
        bpy.data.scenes.remove(self.scene)


def sun_light(studio, node):
    """Measures the sky's sun by rendering it with and without, switches it off, and tells it as a lamp."""
    from mathutils import Vector
    up, around = node.sun_elevation, node.sun_rotation
    # Cycles turns the sun clockwise from y, seen from above.
    towards = Vector((math.sin(around) * math.cos(up), math.cos(around) * math.cos(up), math.sin(up)))
    half = node.sun_size / 2
    light = studio.light_towards(towards, half)
    node.sun_disc = False
    light = np.maximum(light - studio.light_towards(towards, half), 0)
    peak = float(light.max())
    if peak <= 0 or up < 0:
        return None
    shines = TO_FILM[:3, :3] @ np.array((-towards).to_track_quat("-Z", "Y").to_matrix())
    from mathutils import Matrix
    return {"name": "Sun of the sky", "kind": "sun", "seen": True, "angle": json_number(math.degrees(2 * half)), "intensity": json_number(peak),
            "color": [json_number(c / peak) for c in light],
            "rotate": [json_number(a) for a in turns(Matrix(shines.tolist()))]}


def fog_of(node):
    """Fog of a volume that is everywhere the same, None of another."""
    if node.type not in ("VOLUME_SCATTER", "PRINCIPLED_VOLUME"):
        return None
    used = ["Color", "Density", "Anisotropy"]
    if node.type == "PRINCIPLED_VOLUME":
        used += ["Density Attribute", "Color Attribute", "Absorption Color", "Emission Strength", "Blackbody Intensity"]
        if node.inputs["Emission Strength"].default_value > 0 or node.inputs["Blackbody Intensity"].default_value > 0:
            return None
    if any(node.inputs[name].is_linked for name in used if name in node.inputs):
        return None
    density = node.inputs["Density"].default_value
    if not density > 0:
        return "off"
    color = [min(max(c, 0.0), 1.0) for c in node.inputs["Color"].default_value[:3]]
    if node.type == "VOLUME_SCATTER":
        dimmed = [density * c for c in color]  # Cycles' scatter takes as much as it scatters
    else:
        # Cycles: what is not scattered is absorbed but for the absorption colour's square root.
        passes = [max(c, 0.0) ** 0.5 for c in node.inputs["Absorption Color"].default_value[:3]]
        dimmed = [density * (c + max(1 - c, 0.0) * max(1 - p, 0.0)) for c, p in zip(color, passes)]
    mean = sum(dimmed) / 3
    if not mean > 0:
        return "off"
    anisotropy = min(max(node.inputs["Anisotropy"].default_value, -0.95), 0.95)
    return {"visibility": json_number(min(max(3 / mean, 1e-4), 1e9)), "color": [json_number(min(density * c / mean, 1)) for c in color],
            "anisotropy": json_number(anisotropy)}


def hides_what_is_far(scene, film):
    """Cycles' air has no end: no light of the sky or of a sun comes through."""
    return scene.render.engine == "CYCLES" and film.get("fog", "off") != "off"


def write(scene, film, folder, lost):
    """Fills in the film's sky, and its sun among the lights."""
    world = scene.world
    if world is None:
        film["sky"] = 0
        return
    if not world.use_nodes or world.node_tree is None:
        film["sky"] = [json_number(c) for c in world.color]
        return
    if world.node_tree.animation_data is not None:
        lost.add(world, "animated world; as on the first frame")
    end = output_of(world.node_tree)
    if end is not None and incoming(end.inputs["Volume"]) is not None:
        fog = fog_of(incoming(end.inputs["Volume"]).node)
        if fog is None:
            lost.add(world, "volume of the world")
        else:
            film["fog"] = fog if scene.cycles.volume_bounces > 0 or fog == "off" else {**fog, "bounces": False}
            if hides_what_is_far(scene, film):
                film["sky"] = 0
                return
    source = incoming(end.inputs["Surface"]) if end is not None else None
    if source is None:
        film["sky"] = 0
        return
    if source.node.type == "BACKGROUND":
        reader = Reader(world.node_tree, world.name, lost)
        color, strength = reader.value(source.node.inputs["Color"], True), reader.value(source.node.inputs["Strength"])
        if isinstance(color, Constant) and isinstance(strength, Constant):
            film["sky"] = [json_number(max(0.0, c * strength.value)) for c in color.value]
            return
    if any(node.type == "LIGHT_PATH" for node in world.node_tree.nodes):
        lost.add(world, "what a world shows to some rays only; as cameras see it")
    studio = Studio(world, folder)
    try:
        sun = sun_of(world)
        light = sun_light(studio, sun) if sun is not None else None
        if light:
            film.setdefault("lights", []).append(light)
        studio.all_around()
    finally:
        studio.end()
    film["sky"] = {"image": "sky.exr"}
