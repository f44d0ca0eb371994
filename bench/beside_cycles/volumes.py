"""blender -b --python volumes.py -- OUT_FOLDER

Writes films of one frame that this program and Cycles both read, and their grids: smoke.blend, a column in the sun, cloud.blend, over
a plain, fire.blend, in a room. Cycles takes all orders of scattering, 128 samples, no denoiser. Needs Debian's python3-openvdb.
"""
import math
import pathlib
import sys

import bpy
import mathutils
import numpy as np
import pyopenvdb as vdb

out = pathlib.Path(sys.argv[sys.argv.index("--") + 1]).absolute()


def noise(shape, seed):
    """Four octaves of interpolated random values."""
    rng = np.random.default_rng(seed)
    total, cells = np.zeros(shape), 4
    for octave in range(4):
        values = rng.standard_normal((cells + 2,) * 3)
        at = [np.linspace(0, cells, side, endpoint=False) for side in shape]
        low = [a.astype(int) for a in at]
        t = [(a - i) ** 2 * (3 - 2 * (a - i)) for a, i in zip(at, low)]
        weights = [np.stack([1 - w, w]) for w in t]
        for c in np.ndindex(2, 2, 2):
            corner = values[np.ix_(*[i + d for i, d in zip(low, c)])]
            total += 0.5**octave * corner * np.einsum("i,j,k->ijk", *[w[d] for w, d in zip(weights, c)])
        cells *= 2
    return total


def places(*sides):
    """Middles of voxels, the first side 1 wide."""
    return np.meshgrid(*[(np.arange(n) + 0.5) / sides[0] for n in sides], indexing="ij")


def write(name, arrays, width):
    """Grids whose box stands on the origin, `width` wide."""
    grids = []
    for kind, values in arrays.items():
        grid = vdb.FloatGrid()
        grid.copyFromArray(values.astype(np.float32))
        grid.prune()
        grid.name, grid.gridClass = kind, vdb.GridClass.FOG_VOLUME
        voxel = width / values.shape[0]
        middle = voxel / 2 - width / 2
        grid.transform = vdb.createLinearTransform([[voxel, 0, 0, 0], [0, voxel, 0, 0], [0, 0, voxel, 0], [middle, middle, voxel / 2, 1]])
        grids.append(grid)
    vdb.write(str(out / name), grids=grids)
    return str(out / name)


def begin(sky):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 256, 144, 100
    cycles = scene.cycles
    cycles.samples, cycles.use_denoising, cycles.use_adaptive_sampling = 128, False, False
    cycles.max_bounces = cycles.volume_bounces = 64
    cycles.diffuse_bounces, cycles.sample_clamp_indirect, cycles.volume_step_rate = 16, 0, 0.5
    scene.view_settings.view_transform = "Standard"
    scene.frame_start = scene.frame_end = 1
    scene.world = bpy.data.worlds.new("sky")
    scene.world.use_nodes = True
    scene.world.node_tree.nodes["Background"].inputs[0].default_value = (*sky, 1)


def plane(size, colour, location=(0, 0, 0), rotation=(0, 0, 0)):
    bpy.ops.mesh.primitive_plane_add(size=size, location=location, rotation=rotation)
    material = bpy.data.materials.new("matt")
    material.use_nodes = True
    inputs = material.node_tree.nodes["Principled BSDF"].inputs
    inputs["Base Color"].default_value = (*colour, 1)
    inputs["Specular"].default_value, inputs["Roughness"].default_value = 0, 1
    bpy.context.object.data.materials.append(material)


def volume(path, height=0, **inputs):
    bpy.ops.object.volume_import(filepath=path)
    thing = bpy.context.object
    thing.location, thing.rotation_euler = (0, 0, height), (0, 0, 0)
    material = bpy.data.materials.new("medium")
    material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    principled, output = tree.nodes.new("ShaderNodeVolumePrincipled"), tree.nodes.new("ShaderNodeOutputMaterial")
    tree.links.new(principled.outputs[0], output.inputs["Volume"])
    for name, value in inputs.items():
        principled.inputs[name.replace("_", " ")].default_value = value
    thing.data.materials.append(material)


def sun(tilt, turn):
    lamp = bpy.data.lights.new("sun", "SUN")
    lamp.energy, lamp.angle = 3, 0.009
    thing = bpy.data.objects.new("sun", lamp)
    thing.rotation_euler = (math.radians(tilt), 0, math.radians(turn))
    bpy.context.collection.objects.link(thing)


def save(name, eye, target, degrees):
    camera = bpy.data.cameras.new("camera")
    camera.angle = math.radians(degrees)
    thing = bpy.data.objects.new("camera", camera)
    thing.location = eye
    thing.rotation_euler = (mathutils.Vector(target) - mathutils.Vector(eye)).to_track_quat("-Z", "Y").to_euler()
    bpy.context.collection.objects.link(thing)
    bpy.context.scene.camera = thing
    bpy.ops.wm.save_as_mainfile(filepath=str(out / name))


def smoke():
    begin((0.35, 0.45, 0.6))
    x, y, z = places(64, 64, 128)
    r = np.hypot(x - 0.5 - 0.06 * np.sin(5 * z), y - 0.5 - 0.06 * np.cos(4 * z))
    density = np.clip(1.2 - 1.3 * r / (0.08 + 0.12 * z) + 0.45 * noise(x.shape, 1), 0, None) * np.clip(6 * z, 0, 1) * np.clip(3 * (1.9 - z), 0, 1)
    density[density < 0.02] = 0
    plane(40, (0.4, 0.36, 0.3))
    volume(write("smoke.vdb", {"density": density}, 2), Density=5, Color=(0.75, 0.75, 0.75, 1))
    sun(50, 60)
    save("smoke.blend", (0, -9, 2.2), (0, 0, 1.8), 45)


def cloud():
    begin((0.3, 0.45, 0.8))
    x, y, z = places(96, 96, 48)
    r = np.sqrt((x - 0.5) ** 2 + (y - 0.5) ** 2 + (2 * (z - 0.2)) ** 2)
    density = np.clip(0.9 - r / 0.42 + 0.3 * noise(x.shape, 2), 0, 1)
    density = np.where(density > 0.05, np.minimum(3 * density, 1), 0)
    plane(200, (0.2, 0.3, 0.12))
    volume(write("cloud.vdb", {"density": density}, 4), 2, Density=8, Color=(0.98, 0.98, 0.98, 1), Anisotropy=0.3)
    sun(40, -50)
    save("cloud.blend", (0, -12, 1.5), (0, 0, 2.4), 45)


def fire():
    begin((0, 0, 0))
    x, y, z = places(64, 64, 96)
    r = np.hypot(x - 0.5, y - 0.5)
    heat = np.clip(1.3 - r / (0.22 * np.clip(1.2 - 0.8 * z, 0, 1) + 0.001) + 0.35 * noise(x.shape, 3), 0, 1.3) * np.clip(10 * z, 0, 1)
    heat[heat < 0.05] = 0
    soot = np.clip(0.6 - r / (0.2 + 0.1 * z) + 0.3 * noise(x.shape, 4), 0, 1) * np.clip(2 * z - 0.6, 0, 1)
    across = math.pi / 2
    plane(8, (0.4, 0.35, 0.3))
    plane(8, (0.7, 0.7, 0.7), (0, 0, 3), (math.pi, 0, 0))
    plane(8, (0.6, 0.6, 0.6), (0, 2, 1.5), (across, 0, 0))
    plane(8, (0.6, 0.3, 0.2), (-2, 0, 1.5), (0, across, 0))
    plane(8, (0.2, 0.4, 0.6), (2, 0, 1.5), (0, -across, 0))
    plane(8, (0.6, 0.6, 0.6), (0, -4, 1.5), (-across, 0, 0))
    volume(write("fire.vdb", {"density": soot, "temperature": heat}, 1), Density=6, Color=(0.3, 0.3, 0.3, 1), Blackbody_Intensity=1, Temperature=2200)
    save("fire.blend", (0, -3.6, 1.3), (0, 0, 0.9), 60)


out.mkdir(parents=True, exist_ok=True)
smoke()
cloud()
fire()
