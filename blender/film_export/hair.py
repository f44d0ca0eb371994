# SPDX-License-Identifier: Apache-2.0 OR GPL-3.0-or-later
"""Hair as it is rendered: strands of particle systems with their children, and Curves objects, as lines with radii."""
import numpy as np

from .shapes import array_of

PLAIN_RADIUS = 0.005  # of Curves objects that say none, as in Cycles


class Strands:
    """Strands at one frame, as Shape has corners: `vertices` (points), `radii`, `ends` (of each strand, in points)."""

    def __init__(self, points, radii, ends, slot):
        self.vertices, self.radii, self.ends, self.slot = points, radii, ends, slot
        self.vertex = np.arange(len(points), dtype=np.int64)
        self.normals = np.zeros((len(points), 3), dtype=np.float32)
        self.main_uv = None

    def is_closed(self):
        return False

    def is_sheet(self):
        return False


def systems_of(thing):
    """Particle systems of an evaluated object that are rendered as strands."""
    for modifier in thing.modifiers:
        if modifier.type == "PARTICLE_SYSTEM" and modifier.show_render:
            system = modifier.particle_system
            if system.settings.type == "HAIR" and system.settings.render_type == "PATH":
                yield system


def bends(original, system, still, moves_itself):
    """Whether strands may change otherwise than with their object."""
    keys = getattr(original.data, "shape_keys", None)
    return (moves_itself(original.data) or bool(keys and moves_itself(keys)) or system.use_hair_dynamics
            or moves_itself(system.settings) or any(m.type not in still | {"PARTICLE_SYSTEM"} for m in original.modifiers))


def radius_along(settings, share):
    """Of a strand, by the share of its length from the root."""
    shape, left = settings.shape, 1 - share
    if shape:
        left = left ** (1 + shape) if shape < 0 else left ** (1 / max(1 - shape, 1e-6))
    root, tip = (0.5 * settings.radius_scale * r for r in (settings.root_radius, settings.tip_radius))
    return tip + left * (root - tip)


def particle_strands(thing, system):
    """In the space of the object; None where there are none."""
    settings = system.settings
    steps = (1 << settings.render_step) + (settings.kink_extra_steps if settings.kink == "SPIRAL" else 0)
    parents, children = len(system.particles), len(system.child_particles)
    shown = range(parents if settings.child_type != "NONE" and children else 0, parents + children)
    places = np.array([system.co_hair(thing, particle_no=number, step=step) for number in shown for step in range(steps + 1)],
                      dtype=float).reshape(len(shown), steps + 1, 3)
    # Blender leaves steps beyond the end of a shortened strand at zero, in the world.
    last = np.array([np.flatnonzero(strand.any(axis=1))[-1:].sum() for strand in places], dtype=int)
    to_object = np.linalg.inv(np.array(thing.matrix_world, dtype=float))
    places = places @ to_object[:3, :3].T + to_object[:3, 3]
    return strands_through([strand[:end + 1] for strand, end in zip(places, last)], settings)


def strands_through(strands, settings):
    points, radii, ends = [], [], []
    for strand in strands:
        length = np.concatenate([[0.0], np.linalg.norm(np.diff(strand, axis=0), axis=1)])
        kept = np.concatenate([[True], length[1:] > 0])
        if kept.sum() < 2:
            continue
        along = np.cumsum(length)[kept]
        width = radius_along(settings, along / along[-1])
        if settings.use_close_tip:
            width[-1] = 0
        points.append(strand[kept])
        radii.append(width)
        ends.append(len(width))
    if not points:
        return None
    return Strands(np.concatenate(points).astype(np.float32), np.concatenate(radii).astype(np.float32), np.cumsum(ends),
                   settings.material - 1)


def curve_strands(curves):
    """Of a Curves datablock, whose points Cycles passes likewise; None where there are none."""
    points = array_of(curves.points, "position", 3, np.float32)
    counts = array_of(curves.curves, "points_length", 1, np.int32)
    radii = np.full(len(points), PLAIN_RADIUS, dtype=np.float32)
    if "radius" in curves.attributes:
        radii = array_of(curves.attributes["radius"].data, "value", 1, np.float32)
    ends = np.cumsum(counts)
    kept = np.repeat(counts > 1, counts)
    if not kept.any():
        return None
    return Strands(points[kept], radii[kept], np.cumsum(counts[counts > 1]), 0)


def add_strands(glb, name, strands, offsets, materials):
    """As shapes.add_mesh: a primitive of lines, each from point to point of a strand."""
    first = np.ones(len(strands.vertices), dtype=bool)
    first[strands.ends - 1] = False
    start = np.nonzero(first)[0].astype(np.uint32)
    primitive = {"mode": 1, "material": materials(strands.slot)[0], "indices": glb.accessor(np.stack([start, start + 1], axis=1).ravel()),
                 "attributes": {"POSITION": glb.accessor(strands.vertices, bounds=True), "_RADIUS": glb.accessor(strands.radii)}}
    mesh = {"name": name, "primitives": [primitive]}
    if offsets:
        primitive["targets"] = [{"POSITION": glb.accessor(o[:, :3].astype(np.float32), bounds=True)} for o in offsets]
        mesh["weights"] = [0.0] * len(offsets)
    return glb.add("meshes", mesh)
