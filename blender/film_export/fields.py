# SPDX-License-Identifier: Apache-2.0 OR GPL-3.0-or-later
"""Media of meshes as grids: densities that nodes make, baked slice by slice, and shapes that are no boxes."""
import math

import bpy
import numpy as np
from mathutils import Matrix, Vector
from mathutils.bvhtree import BVHTree

from . import vdb
from .bakes import pixels_across, points_on
from .nodes import incoming
from .shapes import BAKE_UV

GRID = "density"
# A voxel is as wide as two pixels where it is nearest; 128^3 of them are 8 MB a frame.
PIXELS, MOST_VOXELS, MOST_ALONG, LEAST_ALONG = 2, 128 ** 3, 256, 16
# Nodes by which a place of an object has other values when the object moves.
OF_THE_WORLD = {"NEW_GEOMETRY", "OBJECT_INFO", "VECT_TRANSFORM"}
OF_THE_CAMERA = {"Camera", "Window", "Reflection"}  # outputs of Texture Coordinate


def is_field(grid):
    """Whether a grid is the socket of nodes."""
    return isinstance(grid, bpy.types.NodeSocket)


def nodes_before(socket):
    """Names of the nodes that a socket's values come from."""
    names, waiting = {}, [socket.node] if socket is not None else []
    while waiting:
        node = waiting.pop()
        if node.name not in names:
            names[node.name] = node
            waiting += [s.node for s in map(incoming, node.inputs) if s is not None]
    return names


def moves_by_nodes(material, field):
    """(whether values change in time, whether they do where the object moves)."""
    if field is None:
        return False, False
    nodes, animation = nodes_before(field).values(), material.node_tree.animation_data
    keyed = bool(animation and (animation.action or animation.drivers or animation.nla_tracks))
    keyed |= any(is_of_another(n) or n.type == "TEX_IMAGE" and n.image is not None and n.image.source in {"SEQUENCE", "MOVIE"} for n in nodes)
    return keyed, any(n.type in OF_THE_WORLD for n in nodes)


def is_of_another(node):
    """Whether places are those of another object or of the camera, which may move."""
    if node.type == "TEX_COORD":
        return node.object is not None or any(out.is_linked and out.name in OF_THE_CAMERA for out in node.outputs)
    return node.type == "CAMERA"


def share_within(shape, low, sides, cells):
    """Of each voxel, the share within a closed shape: by z, y, x. Lengths along x are exact, four lines to a voxel."""
    tree = BVHTree.FromPolygons(shape.vertices.tolist(), shape.vertex[shape.corners].tolist())
    nx, ny, nz = cells
    share = np.zeros((nz, ny, nx))
    step = 1e-5 * float((sides * cells).max())
    edges = low[0] + sides[0] * np.arange(nx + 1)
    # A line through an edge or a corner of the mesh would count twice: these offsets are no simple share of a voxel.
    offsets = (0.2503, 0.7496)
    for k, j, dz, dy in ((k, j, dz, dy) for k in range(nz) for j in range(ny) for dz in offsets for dy in offsets):
        at = Vector((low[0] - step, low[1] + (j + dy) * sides[1], low[2] + (k + dz) * sides[2]))
        deep = 0  # in how many of the mesh's shells, which may overlap
        while (hit := tree.ray_cast(at, Vector((1, 0, 0))))[0] is not None:
            here, at.x = hit[0].x, hit[0].x + step
            enters = hit[1].x < 0
            if enters and deep == 0:
                begin = here
            elif not enters and deep == 1:
                share[k, j] += 0.25 * np.clip(np.minimum(edges[1:], here) - np.maximum(edges[:-1], begin), 0, None) / sides[0]
            deep = max(deep + (1 if enters else -1), 0)
    return share


class Grid:
    """A mesh's density at any frame."""

    def __init__(self, voxels, thing, over, material, field, fills):
        self.voxels, self.over, self.material, self.field = voxels, over, material, field
        keyed, of_the_world = moves_by_nodes(material, field)
        there = [m for m in thing.matrices if m is not None]
        self.moves = keyed or of_the_world and any(not np.array_equal(m, there[0]) for m in there)
        self.low = over.shape.vertices.min(axis=0).astype(float)
        size = over.shape.vertices.max(axis=0) - self.low
        self.cells = voxels.cells(over.shape, thing.matrices, size)
        self.sides = size / self.cells
        self.share = None if fills else share_within(over.shape, self.low, self.sides, self.cells)

    def write(self, path, frame, matrix):
        values = np.ones(self.cells[::-1]) if self.share is None else self.share
        if self.field is not None:
            values = values * self.voxels.bake(self, frame, matrix)
        vdb.write(path, GRID, values, self.low, self.sides)


class Voxels:
    """Makes grids, as fine as the film shows them."""

    def __init__(self, baker, cameras, lines, tell):
        self.baker, self.cameras, self.lines, self.tell = baker, cameras, lines, tell

    def cells(self, shape, matrices, size):
        """Voxels along x, y and z."""
        places = [(k, m) for k, m in enumerate(matrices) if m is not None]
        across, area = pixels_across(shape, places, list(self.cameras.poses.values()), self.lines), points_on(shape)[1]
        side = PIXELS * math.sqrt(area) / max(across, 1e-9)
        side = max(min(side, size.max() / LEAST_ALONG), size.max() / MOST_ALONG, (size.prod() / MOST_VOXELS) ** (1 / 3))
        return np.maximum(np.ceil(size / side - 1e-6), 1).astype(int)

    def bake(self, grid, frame, matrix):
        """What a socket has in the middle of each voxel: by z, y, x. Slices lie beside each other in one image."""
        self.tell(f"density of {grid.over.object_name}, frame {frame}")
        nx, ny, nz = (int(n) for n in grid.cells)
        columns = max(1, round(math.sqrt(nz * ny / nx)))
        side = max(columns * nx, -(-nz // columns) * ny)
        mesh = self.slices(grid, columns, side)
        copy = self.baker.stage(mesh, Matrix(matrix.tolist()), bpy.data.objects.get(grid.over.object_name))
        copy.material_slots[0].link, copy.material_slots[0].material = "OBJECT", grid.material
        self.baker.scene.frame_set(math.floor(frame), subframe=frame - math.floor(frame))  # what is in the scene by now follows
        pixels = self.baker.value(copy, 0, grid.material, grid.field, side, alike=0, most=side)
        self.baker.unstage()
        bpy.data.meshes.remove(mesh)
        pixels = np.broadcast_to(pixels, (side, side, 4))[..., :3].mean(axis=2)
        values = [pixels[k // columns * ny:, k % columns * nx:][:ny, :nx] for k in range(nz)]
        return np.nan_to_num(np.clip(np.stack(values), 0, 1e9), nan=0.0)

    def slices(self, grid, columns, side):
        """A rectangle for each layer of voxels, through its middle, whose texels are the voxels."""
        (nx, ny, nz), corners = grid.cells, np.array([(0, 0), (1, 0), (1, 1), (0, 1)])
        k = np.repeat(np.arange(nz), 4)
        across = np.tile(corners, (nz, 1))
        places = np.column_stack([across, (k + 0.5) / nz]) * (grid.sides * grid.cells) + grid.low
        mesh = bpy.data.meshes.new("render2mpeg slices")
        mesh.from_pydata(places.tolist(), [], np.arange(4 * nz).reshape(-1, 4).tolist())
        texels = (across + np.column_stack([k % columns, k // columns])) * (nx, ny) / side
        mesh.uv_layers.new(name=BAKE_UV).data.foreach_set("uv", texels.astype(np.float32).ravel())
        mesh.use_auto_texspace = False
        mesh.texspace_location, mesh.texspace_size = grid.over.shape.texture_space
        mesh.materials.append(None)
        return mesh

    def done(self, scene):
        """Gives Blender the film's scene back."""
        self.baker.clear()
        bpy.context.window_manager.windows[0].scene = scene
