# SPDX-License-Identifier: Apache-2.0 OR GPL-3.0-or-later
"""Shapes of evaluated objects as glTF meshes; what bends becomes a base and a few offsets with weights over time."""
import numpy as np

BAKE_UV = "render2mpeg"  # the layer of baked textures' coordinates


def array_of(collection, attribute, width, kind):
    flat = np.empty(len(collection) * width, dtype=kind)
    collection.foreach_get(attribute, flat)
    return flat.reshape(-1, width) if width > 1 else flat


def corner_normals(mesh):
    if hasattr(mesh, "corner_normals"):  # Blender 4.1 and later
        return array_of(mesh.corner_normals, "vector", 3, np.float32)
    mesh.calc_normals_split()
    return array_of(mesh.loops, "normal", 3, np.float32)


class Shape:
    """A mesh at one frame, by corners: `positions`, `normals`, `uv` (by layer's name), `colors` (or None), `corners`
    (three per triangle, into those) and `slots` (a material's number per triangle)."""

    def __init__(self, mesh):
        mesh.calc_loop_triangles()
        self.vertex = array_of(mesh.loops, "vertex_index", 1, np.int32)
        self.vertices = array_of(mesh.vertices, "co", 3, np.float32)
        self.normals = corner_normals(mesh)
        self.corners = array_of(mesh.loop_triangles, "loops", 3, np.int32)
        self.slots = array_of(mesh.loop_triangles, "material_index", 1, np.int32)
        self.uv = {layer.name: array_of(layer.data, "uv", 2, np.float32) for layer in mesh.uv_layers}
        shown = [layer.name for layer in mesh.uv_layers if layer.active_render and layer.name != BAKE_UV]
        others = [name for name in self.uv if name != BAKE_UV]
        self.main_uv = (shown or others or [None])[0]
        self.texture_space = tuple(mesh.texspace_location), tuple(mesh.texspace_size)

    def unshare_corners(self):
        """Gives each triangle corners of its own; returns which they were."""
        old = self.corners.ravel()
        self.vertex, self.normals = self.vertex[old], self.normals[old]
        self.uv = {name: values[old] for name, values in self.uv.items()}
        self.corners = np.arange(len(old), dtype=np.int32).reshape(-1, 3)
        return old

    def as_mesh(self, materials):
        """A datablock of its triangles, once its corners are unshared."""
        import bpy
        mesh = bpy.data.meshes.new("render2mpeg bake")
        mesh.from_pydata(self.vertices.tolist(), [], self.vertex.reshape(-1, 3).tolist())
        mesh.polygons.foreach_set("material_index", self.slots.astype(np.int32))
        mesh.polygons.foreach_set("use_smooth", np.ones(len(self.slots), dtype=bool))
        for name, values in self.uv.items():
            mesh.uv_layers.new(name=name).data.foreach_set("uv", values.ravel())
        if self.main_uv in mesh.uv_layers:
            mesh.uv_layers[self.main_uv].active_render = True
        mesh.use_auto_texspace = False
        mesh.texspace_location, mesh.texspace_size = self.texture_space
        for material in materials:
            mesh.materials.append(material)
        return mesh

    def is_closed(self):
        """Whether every edge has two triangles that run along it opposite ways, and the inside has a positive volume:
        nobody sees the backs. Vertices in one place are one: poles and seams of what modifiers turn are doubled."""
        place = self.vertices - self.vertices.min(axis=0, initial=0)
        grid = np.round(place * (1 / max(2e-6 * float(np.max(place, initial=0)), 1e-30)))
        _, number = np.unique(grid, axis=0, return_inverse=True)
        triangles = number.ravel()[self.vertex[self.corners]].astype(np.int64)
        triangles = triangles[(triangles != np.roll(triangles, 1, axis=1)).all(axis=1)]
        if len(triangles) < 4:
            return False
        edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
        size = len(self.vertices)
        along, against = edges[:, 0] * size + edges[:, 1], edges[:, 1] * size + edges[:, 0]
        if not np.array_equal(np.sort(along), np.sort(against)):
            return False
        first = self.vertices[np.unique(number.ravel(), return_index=True)[1]].astype(float)
        a, b, c = (first[triangles[:, k]] for k in range(3))
        return float(np.sum(a * np.cross(b, c))) > 0

    def is_sheet(self):
        """Whether all lies in one plane, to a ten-thousandth of its size: a pane of glass as it stands."""
        place = self.vertices.astype(float)
        spread = np.linalg.svd(place - place.mean(axis=0), compute_uv=False) if len(place) > 2 else [0, 0]
        return spread[-1] <= 1e-4 * spread[0]


class Bending:
    """A base pose and orthonormal offsets of all later poses, found frame by frame by Gram and Schmidt's method, at the end
    as few as keep every corner within a ten-thousandth of the shape's size and every normal within half a degree."""

    def __init__(self, shape):
        self.corners = len(shape.vertex)
        # Corners of one vertex and one normal bend alike.
        self.first, self.number = welded([shape.vertex >> 16, shape.vertex & 65535, np.round(shape.normals, 4)])
        self.base = self.pose(shape)
        size = float(np.max(np.ptp(self.base[:, :3], axis=0))) or 1.0
        self.unit = np.array([1e-4 * size] * 3 + [1e-2] * 3, dtype=np.float32)
        self.basis, self.rows = [], []

    def pose(self, shape):
        return np.concatenate([shape.vertices[shape.vertex[self.first]], shape.normals[self.first]], axis=1)

    def add(self, shape):
        """False where the shape has other corners than the base."""
        if len(shape.vertex) != self.corners:
            return False
        rest = ((self.pose(shape) - self.base) / self.unit).ravel()
        row = []
        for offset in self.basis:
            row.append(float(rest @ offset))
            rest -= np.float32(row[-1]) * offset
        if np.max(np.abs(rest), initial=0) > 0.5:
            length = float(np.linalg.norm(rest))
            self.basis.append(rest / np.float32(length))
            row.append(length)
        self.rows.append(row)
        return True

    def result(self):
        """Offsets (a row of 6 per corner each) and weights (a row per frame)."""
        if not self.basis:
            return [], np.zeros((len(self.rows), 0))
        weights = np.zeros((len(self.rows), len(self.basis)))
        for row, said in zip(weights, self.rows):
            row[:len(said)] = said
        # The best basis of what was kept: drop what no frame needs.
        u, s, v = np.linalg.svd(weights, full_matrices=False)
        offsets = v @ np.asarray(self.basis)
        kept = len(s)
        while kept > 1 and np.max(np.abs((u[:, kept - 1:] * s[kept - 1:]) @ offsets[kept - 1:])) < 0.5:
            kept -= 1
        scaled = []
        shares = np.empty((len(self.rows), kept))
        for k in range(kept):
            strength = float(np.max(np.abs(u[:, k]))) * s[k] or 1.0
            shares[:, k] = u[:, k] * s[k] / strength
            scaled.append(((offsets[k] * strength).reshape(self.base.shape) * self.unit)[self.number])
        return scaled, shares


def welded(columns):
    """Corners that agree in all columns as one: (first corner of each, number of each corner)."""
    rows = np.ascontiguousarray(np.concatenate([np.asarray(c, dtype=np.float32).reshape(len(c), -1) for c in columns], axis=1))
    rows = rows + np.float32(0)  # no negative zeros
    view = rows.view(np.dtype((np.void, rows.dtype.itemsize * rows.shape[1]))).ravel()
    _, first, number = np.unique(view, return_index=True, return_inverse=True)
    return first, number.ravel()


def around_axis(shape, corners):
    """Cycles' tangents of a surface for which none are made: about the z axis through the middle of its box."""
    box = shape.vertices.min(axis=0), shape.vertices.max(axis=0)
    from_middle = (shape.vertices[shape.vertex[corners]] - (box[0] + box[1]) / 2) / np.maximum(box[1] - box[0], 1e-9)
    turned = np.stack([-from_middle[:, 1], from_middle[:, 0], np.zeros(len(corners))], axis=1)
    normals = shape.normals[corners]
    turned -= normals * np.sum(normals * turned, axis=1, keepdims=True)
    length = np.linalg.norm(turned, axis=1, keepdims=True)
    other = np.cross(normals, np.where(np.abs(normals[:, :1]) < 0.9, [[1.0, 0.0, 0.0]], [[0.0, 1.0, 0.0]]))
    turned = np.where(length > 1e-6, turned / np.maximum(length, 1e-9), other / np.maximum(np.linalg.norm(other, axis=1, keepdims=True), 1e-9))
    return np.concatenate([turned, np.ones((len(corners), 1))], axis=1).astype(np.float32)


def add_mesh(glb, name, shape, offsets, materials):
    """`materials`: by slot (index of a glTF material, names of its two uv layers). Returns the mesh's index."""
    primitives = []
    for slot in np.unique(shape.slots):
        material, layers = materials(int(slot))
        triangles = shape.corners[shape.slots == slot].ravel()
        used, local = np.unique(triangles, return_inverse=True)
        uv = [shape.uv[layer][used] * np.float32([1, -1]) + np.float32([0, 1]) for layer in layers if layer in shape.uv]
        rounded = np.round(shape.normals[used], 4)
        columns = [shape.vertex[used].astype(np.float32), rounded] + uv
        if len(shape.vertices) >= 1 << 24:
            columns[0] = np.stack([shape.vertex[used] >> 16, shape.vertex[used] & 65535], axis=1)
        first, number = welded(columns)
        corners = used[first]
        attributes = {"POSITION": glb.accessor(shape.vertices[shape.vertex[corners]], bounds=True),
                      "NORMAL": glb.accessor(shape.normals[corners])}
        if material in glb.brushed:
            attributes["TANGENT"] = glb.accessor(around_axis(shape, corners))
        for k, layer in enumerate(uv):
            attributes[f"TEXCOORD_{k}"] = glb.accessor(layer[first])
        primitive = {"attributes": attributes, "indices": glb.accessor(number[local.ravel()].astype(np.uint32)), "material": material}
        if offsets:
            primitive["targets"] = [{"POSITION": glb.accessor(o[corners, :3].astype(np.float32), bounds=True),
                                     "NORMAL": glb.accessor(o[corners, 3:].astype(np.float32))} for o in offsets]
        primitives.append(primitive)
    if not primitives:
        return None
    mesh = {"name": name, "primitives": primitives}
    if offsets:
        mesh["weights"] = [0.0] * len(offsets)
    return glb.add("meshes", mesh)
