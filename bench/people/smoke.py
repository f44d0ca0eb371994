"""Smoke out of a brazier in a courtyard, drifting in the sun: one grid of OpenVDB a frame beside the file. Needs python3-openvdb."""
import sys

sys.path.insert(0, __file__.rpartition("/")[0] or ".")
from making import *  # noqa: E402,F403
import numpy as np  # noqa: E402
import pyopenvdb as vdb  # noqa: E402

scene = start(1)
scene.cycles.volume_bounces = 12
sky(0.6, sky_type="NISHITA", sun_disc=False, sun_elevation=math.radians(40), sun_rotation=math.radians(210))
lamp("SUN", (6, -4, 8), (0, 0, 0), 3.5, (1, 0.9, 0.78), angle=math.radians(0.6))
stone = texture(material("Stone", roughness=0.85), "Noise", (0.4, 0.36, 0.3), (0.52, 0.47, 0.4), 0.3, scale=5, detail=6)
plane("Yard", (16, 16), (0, 0, 0), texture(material("Paving", roughness=0.7), "Brick", (0.25, 0.22, 0.19), (0.4, 0.36, 0.31), 0.2, low=0.0, high=1.0, scale=0.6))
box("Wall Back", (16, 0.5, 4), (0, 6, 0), stone, 0.03)
box("Wall Left", (0.5, 16, 4), (-6, 0, 0), stone, 0.03)
for k in range(5):
    turned(f"Pillar {k}", [(0, 0), (0.4, 0), (0.4, 0.2), (0.28, 0.3), (0.25, 3.2), (0.42, 3.5), (0, 3.5)], stone, (-4 + 2 * k, 4.5, 0), subdivided=1)
box("Beam", (10, 0.5, 0.4), (0, 4.5, 3.5), stone, 0.02)
turned("Brazier", [(0, 0), (0.35, 0), (0.1, 0.1), (0.08, 0.5), (0.5, 0.8), (0.45, 0.82), (0, 0.62)], material("Iron", (0.12, 0.11, 0.1), metallic=1.0, roughness=0.5), (0, 0.5, 0))
ball("Embers", 0.38, (0, 0.5, 0.62), material("Embers", (0.1, 0.02, 0.01), emission=(1, 0.25, 0.05, 1), emission_strength=8), None, (1, 1, 0.4))

# Rising rings of noise: values on a lattice of four octaves, moved up and turned with time.
rng = np.random.default_rng(7)
octaves = [rng.standard_normal((2**o * 6,) * 3) for o in range(4)]


def noise(*at):
    total = 0
    for o, values in enumerate(octaves):
        place = [p * 2**o * 4 for p in at]
        low = [np.floor(p).astype(int) for p in place]
        t = [(p - i) ** 2 * (3 - 2 * (p - i)) for p, i in zip(place, low)]
        part = 0
        for c in np.ndindex(2, 2, 2):
            weight = np.prod([w if d else 1 - w for w, d in zip(t, c)], axis=0)
            part = part + weight * values[tuple((i + d) % values.shape[0] for i, d in zip(low, c))]
        total = total + 0.5**o * part
    return total


x, y, z = np.meshgrid((np.arange(64) + 0.5) / 64, (np.arange(64) + 0.5) / 64, (np.arange(128) + 0.5) / 64, indexing="ij")
folder = os.path.dirname(os.path.abspath(sys.argv[sys.argv.index("--") + 1]))
for frame in range(scene.frame_start, scene.frame_end + 1):
    t = frame / FPS
    bend = 0.08 * z**2
    radius = np.hypot(x - 0.4 - bend - 0.05 * np.sin(5 * z - 4 * t), y - 0.5 - 0.05 * np.cos(4 * z - 3 * t))
    density = np.clip(1.1 - 1.2 * radius / (0.07 + 0.13 * z) + 0.45 * noise(x, y, z - 0.5 * t), 0, None) * np.clip(8 * z, 0, 1) * np.clip(2 * (1.95 - z), 0, 1)
    density[density < 0.02] = 0
    grid = vdb.FloatGrid()
    grid.copyFromArray(density.astype(np.float32))
    grid.prune()
    grid.name, grid.gridClass = "density", vdb.GridClass.FOG_VOLUME
    grid.transform = vdb.createLinearTransform([[2.4 / 64, 0, 0, 0], [0, 2.4 / 64, 0, 0], [0, 0, 2.4 / 64, 0], [-0.96, -0.7, 0.7, 1]])
    vdb.write(os.path.join(folder, f"smoke_{frame:04d}.vdb"), grids=[grid])
bpy.ops.object.volume_import(filepath=os.path.join(folder, "smoke_0001.vdb"))
thing = bpy.context.object
thing.location, thing.rotation_euler = (0, 0, 0), (0, 0, 0)
thing.data.is_sequence, thing.data.frame_start, thing.data.frame_duration = True, scene.frame_start, scene.frame_end
made = bpy.data.materials.new("Smoke")
made.use_nodes = True
tree = made.node_tree
tree.nodes.clear()
medium, output = tree.nodes.new("ShaderNodeVolumePrincipled"), tree.nodes.new("ShaderNodeOutputMaterial")
medium.inputs["Density"].default_value, medium.inputs["Color"].default_value, medium.inputs["Anisotropy"].default_value = 5, (0.7, 0.68, 0.65, 1), 0.2
tree.links.new(medium.outputs[0], output.inputs["Volume"])
thing.data.materials.append(made)
camera([(-2.6, -7.4, 1.8), (-1.6, -7.6, 1.8)], (0.2, 0.6, 1.8), 32)
save()
