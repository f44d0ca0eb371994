# SPDX-License-Identifier: Apache-2.0 OR GPL-3.0-or-later
"""Which shapes need baked textures, which of them share theirs, and how large these are."""
import hashlib
import math

import bpy
import numpy as np
from mathutils import Matrix

from . import angles, rays
from .hair import Strands
from .looks import CHANNELS, Baked, Picture, socket_of
from .nodes import is_level, is_steady, output_of
from .shapes import BAKE_UV, array_of

SMALLEST = 64
PLACES_AT_ONCE = 64
# Nodes whose values differ between objects of one shape.
OF_ONE_OBJECT = {"NEW_GEOMETRY", "OBJECT_INFO", "ATTRIBUTE", "VERTEX_COLOR", "CAMERA", "PARTICLE_INFO", "TEX_POINTDENSITY"}


def has_own_values(tree):
    return any(n.type in OF_ONE_OBJECT or n.type == "TEX_COORD" and n.object is not None for n in tree.nodes)


def digest_of(mesh, materials):
    """Equal for meshes whose textures are equal: the same corners, coordinates and materials."""
    state = hashlib.sha256()
    for collection, attribute, width, kind in (
            (mesh.vertices, "co", 3, np.float32), (mesh.loops, "vertex_index", 1, np.int32), (mesh.polygons, "loop_total", 1, np.int32),
            (mesh.polygons, "material_index", 1, np.int32), (mesh.polygons, "use_smooth", 1, bool)):
        state.update(array_of(collection, attribute, width, kind).tobytes() + b"|")
    for layer in mesh.uv_layers:
        state.update(f"{layer.name}|{layer.active_render}|".encode() + array_of(layer.data, "uv", 2, np.float32).tobytes())
    state.update("|".join(m.name_full if m else "" for m in materials).encode())
    return state.digest()


def points_on(shape, count=1024):
    """Points all over a shape's triangles, evenly by area, and their whole area."""
    a, b, c = (shape.vertices[shape.vertex[shape.corners[:, k]]].astype(float) for k in range(3))
    areas = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2
    if not len(areas):
        return np.zeros((1, 3)), 0.0
    order = np.arange(count)
    # The plane's golden ratios, folded into the triangle.
    u, v = (order * 0.7548776662) % 1, (order * 0.5698402909) % 1
    u, v = np.where(u + v > 1, (1 - u, 1 - v), (u, v))
    ends = np.cumsum(areas)
    k = np.minimum(np.searchsorted(ends, (order + 0.5) / count * ends[-1]), len(areas) - 1)
    return a[k] + u[:, None] * (b - a)[k] + v[:, None] * (c - a)[k], float(ends[-1])


def pixels_across(shape, places, cameras, height):
    """The root of the pixels that all of a shape's surface has where it is nearest to a camera. `places`: (frame, matrix)."""
    points, area = points_on(shape)
    largest = 0.0
    for first in range(0, len(places), PLACES_AT_ONCE):
        some = places[first:first + PLACES_AT_ONCE]
        matrices = np.array([matrix for _, matrix in some])
        scales = np.linalg.norm(matrices[:, :3, :3], axis=1).max(axis=1)
        there = points @ matrices[:, :3, :3].transpose(0, 2, 1) + matrices[:, None, :3, 3]
        for poses in cameras:
            lenses = np.array([poses[frame]["lens"] for frame, _ in some])
            apart = there - np.array([poses[frame]["eye"] for frame, _ in some])[:, None]
            away = np.sqrt(np.einsum("ijk,ijk->ij", apart, apart).min(axis=1))
            away = np.where(lenses[:, 3, 3] == 1, 1.0, np.maximum(away, 1e-6))
            largest = max(largest, float((scales * lenses[:, 1, 1] / away).max()) * height / 2)
    return math.sqrt(area) * largest


class Bakes:
    def __init__(self, materials, baker, lines, lost):
        self.materials, self.baker, self.lines, self.lost = materials, baker, lines, lost
        self.jobs = {}      # (mesh's name, material's name) -> (object, slot)
        self.first = {}     # digest -> name of the first mesh that has it
        self.shown_by = {}  # mesh's name -> name of the mesh whose textures it has
        self.steady = {}    # (material's name, channel) -> pixels that are the same on every mesh

    def wanted_of(self, slots):
        """(slot, material) of those that need textures."""
        wanted = [(n, m) for n, m in enumerate(slots) if m is not None]
        return [(n, m) for n, m in wanted if self.materials.needs_bake(self.materials.look(m)[0])]

    def prepare(self, thing):
        """Before the walk: coordinates for the textures that an object's mesh needs."""
        mesh, slots = thing.data, [entry.material for entry in thing.material_slots]
        wanted = [(n, m) for n, m in self.wanted_of(slots) if (self.shown_by.get(mesh.name_full), m.name_full) not in self.jobs]
        if not wanted:
            return
        name, like = self.shown_by.get(mesh.name_full), None
        if name is None:
            name = mesh.name_full
            if mesh.shape_keys is None and not any(has_own_values(self.materials.look(m)[1].node_tree) for _, m in wanted):
                name = self.first.setdefault(digest_of(mesh, slots), name)
            like = self.jobs[name, wanted[0][1].name_full][0].data if name != mesh.name_full else None
            self.shown_by[mesh.name_full] = name
        if not self.baker.unwrap(mesh, like):
            del self.shown_by[mesh.name_full]
            self.first = {state: first for state, first in self.first.items() if first != name}
            self.lost.add_of(wanted[0][1], "there is no room for baked textures' coordinates", thing=thing.name)
            return
        for slot, material in wanted:
            self.jobs.setdefault((name, material.name_full), (thing, slot))

    def run(self, walk, cameras, tell):
        """After it, when all places of all shapes are known. `tell` is called with its steps."""
        things = {}
        for thing in walk.things.values():
            things.setdefault(thing.shape, []).append(thing)
        sizes, used = {}, {}
        for key, over in walk.shapes.items():
            if over.shape is None or isinstance(over.shape, Strands) or key not in things or not self.wanted_of(over.materials):
                continue
            self.tell_shared(over, things[key])
            over.mesh_name = self.shown_by.get(over.mesh_name)
            ready = BAKE_UV in over.shape.uv and all((over.mesh_name, m.name_full) in self.jobs for _, m in self.wanted_of(over.materials))
            size = self.size_of(over.shape, things[key], cameras)
            if not ready:
                over.mesh_name = key
                self.bake_shape(over, things[key][0], size)
            else:
                sizes[over.mesh_name] = max(size, sizes.get(over.mesh_name, 0))
                slots = np.minimum(np.unique(over.shape.slots), len(over.materials) - 1)
                used.setdefault(over.mesh_name, set()).update(over.materials[slot].name_full for slot in slots if over.materials[slot])
        jobs = [(name, of) for (name, material), of in self.jobs.items() if material in used.get(name, ())]
        for number, (name, (thing, slot)) in enumerate(jobs):
            tell(f"textures {number + 1} of {len(jobs)}")
            self.bake(name, self.baker.stage(thing.data, thing.matrix_world, thing), slot, thing.material_slots[slot].material, sizes[name])
        self.baker.clear()

    def tell_shared(self, over, things):
        """A shape has one texture, whatever objects have it."""
        for _, material in self.wanted_of(over.materials) if len(things) > 1 else ():
            node = rays.differing(output_of(self.materials.look(material)[1].node_tree))
            if node is not None:
                self.lost.add_of(material, "differs between objects of one mesh; all have the first one's", node)

    def size_of(self, shape, things, cameras):
        """A power of two with at least a texel for each pixel; the baker may make fewer."""
        if not cameras.shown:
            return self.baker.size
        # Of many instances a hundred tell how near they come.
        places = [(k, m) for t in things[::max(1, len(things) // 100)] for k, m in enumerate(t.matrices) if m is not None]
        across = pixels_across(shape, places, list(cameras.poses.values()), self.lines)
        return max(1 << max(math.ceil(math.log2(max(across, 1.0))), 0), SMALLEST)

    def bake_shape(self, over, thing, size):
        """On what a modifier, a curve, a text or a metaball came to, as it is at first."""
        over.unshare_corners()
        mesh = over.shape.as_mesh(over.materials)
        matrix = next(m for m in thing.matrices if m is not None)
        if self.baker.unwrap(mesh):
            copy = self.baker.stage(mesh, Matrix(matrix.tolist()))
            over.shape.uv[BAKE_UV] = array_of(mesh.uv_layers[BAKE_UV].data, "uv", 2, np.float32)
            for slot, material in self.wanted_of(over.materials):
                if np.any(over.shape.slots == slot):
                    self.bake(over.mesh_name, copy, slot, material, size)
            self.baker.unstage()
        bpy.data.meshes.remove(mesh)

    def bake(self, name, copy, slot, material, size):
        """All that one material needs on one mesh."""
        look, made = self.materials.look(material)
        out = self.materials.baked[name, material.name_full] = {}
        merged = isinstance(look.base, Baked) or isinstance(look.alpha, Baked)
        for channel in CHANNELS:
            source = getattr(look, channel)
            # Colour and coverage share an image, and so do roughness and metalness.
            wanted = isinstance(source, Baked) or (merged and channel in {"base", "alpha"} and isinstance(source, Picture))
            if channel in {"roughness", "metallic"} and isinstance(source, Picture):
                wanted = any(isinstance(getattr(look, n), Baked) for n in ("roughness", "metallic"))
            if wanted:
                socket = socket_of(made.node_tree, source)
                if angles.is_angled(socket) and channel in angles.COLORS + angles.NUMBERS:
                    ends = self.ends(copy, slot, material, made, socket, size)
                    out[channel], out[channel + " other"], out[channel + " share"] = ends
                else:
                    out[channel] = self.value(copy, slot, (material.name_full, channel), made, socket, size)
        if look.normal is not None and not isinstance(look.normal, tuple) and not is_level(look.normal):
            out["normal"] = self.baker.normal(copy, slot, made, look.normal, size)
        self.materials.share(name, material)

    def ends(self, copy, slot, material, made, socket, size):
        """What a socket has at the two angles between which the others lie, and the way between."""
        steps = angles.cosines(angles.ROUGH_STEPS)

        def seen(cosine, side):
            with angles.seen_at(made.node_tree, cosine, socket) as there:
                return self.baker.value(copy, slot, made, there, side)
        rough = [seen(cosine, SMALLEST) for cosine in steps]
        side = max(p.shape[0] for p in rough)
        own, other, share, error = angles.ends_of([np.broadcast_to(p, (side, side, 4)) for p in rough])
        if error > 0.03:
            self.lost.add_of(material, "the angle changes places otherwise than others; near it", socket.node)
        share = np.concatenate([share, np.ones((len(share), 1))], axis=1)[None]
        return seen(steps[own], size), seen(steps[other], size), share

    def value(self, copy, slot, what, made, socket, size):
        """What a socket has on one mesh; baked once where it has the same everywhere."""
        if not is_steady(socket):
            return self.baker.value(copy, slot, made, socket, size)
        if what not in self.steady:
            found = self.baker.value(copy, slot, made, socket, SMALLEST)
            if not found[..., 3].any():  # all faces are smaller than a texel
                return self.baker.value(copy, slot, made, socket, size)
            self.steady[what] = found
        return self.steady[what]
