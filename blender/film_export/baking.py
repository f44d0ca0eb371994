# SPDX-License-Identifier: Apache-2.0 OR GPL-3.0-or-later
"""Bakes sockets of materials to images, in a scene of its own that holds nothing but the mesh."""
import bpy
import numpy as np
from mathutils import Matrix

from . import angles
from .nodes import incoming, output_of
from .shapes import BAKE_UV, array_of

# Side of the bake that tells whether a larger one is worth it, and texels that it must have.
PROBE, LEAST_PROBED = 64, 256
# Samples of a texel that is larger than a pixel, since no texture may have more.
SAMPLES_OF_LARGE = 4


def are_level(normals):
    """Whether all normals of a bake are the surface's own, by codes of 8 bits, or none is seen."""
    return float(np.max(np.abs(normals[..., :3] - (0.5, 0.5, 1.0)))) < 0.5 / 255 or float(normals[..., 3].max()) == 0


class Baker:
    def __init__(self, size):
        self.size = size
        self.scene = None

    def prepare(self):
        scene = self.scene = bpy.data.scenes.new("render2mpeg bake")
        scene.render.engine = "CYCLES"
        scene.cycles.use_adaptive_sampling, scene.cycles.use_denoising = False, False
        scene.cycles.max_bounces = 0
        scene.cycles.device, scene.cycles.shading_system = "CPU", False
        scene.render.bake.margin = 8
        scene.render.bake.use_clear = False
        self.blank = bpy.data.materials.new("render2mpeg blank")
        self.blank.use_nodes = True
        node = self.blank.node_tree.nodes.new("ShaderNodeTexImage")
        node.image = bpy.data.images.new("render2mpeg blank", 4, 4)
        self.blank.node_tree.nodes.active = node

    def stage(self, mesh, matrix, like=None):
        """An object of a mesh, with what an object says of itself, and nothing else in the scene."""
        if self.scene is None:
            self.prepare()
        self.unstage()
        copy = bpy.data.objects.new("render2mpeg bake", mesh)
        copy.matrix_world = matrix
        if like is not None:
            copy.color, copy.pass_index = like.color, like.pass_index
        self.scene.collection.objects.link(copy)
        bpy.context.window_manager.windows[0].scene = self.scene
        self.scene.view_layers[0].objects.active = copy
        copy.select_set(True)
        return copy

    def unstage(self):
        for old in list(self.scene.collection.objects):
            bpy.data.objects.remove(old)

    def unwrap(self, mesh, like=None):
        """Gives a mesh a layer of coordinates in which no two faces share a place: that of `like`, an equal mesh, where there
        is one."""
        if BAKE_UV in mesh.uv_layers:
            return True
        if len(mesh.uv_layers) >= 8 or mesh.library is not None:
            return False
        shown = next((layer.name for layer in mesh.uv_layers if layer.active_render), None)
        if mesh.uv_layers.new(name=BAKE_UV) is None:
            return False
        mesh.uv_layers.active = mesh.uv_layers[BAKE_UV]
        if shown:
            mesh.uv_layers[shown].active_render = True
        if like is not None:
            mesh.uv_layers[BAKE_UV].data.foreach_set("uv", array_of(like.uv_layers[BAKE_UV].data, "uv", 2, np.float32).ravel())
            return True
        copy = self.stage(mesh, Matrix())
        with self.attended(copy):
            bpy.ops.object.mode_set(mode="EDIT")
            bpy.ops.mesh.reveal()
            bpy.ops.mesh.select_all(action="SELECT")
            bpy.ops.uv.smart_project(island_margin=0.01)
            bpy.ops.object.mode_set(mode="OBJECT")
        return True

    def attended(self, copy):
        """What Blender's operators work on."""
        return bpy.context.temp_override(window=bpy.context.window_manager.windows[0], scene=self.scene, view_layer=self.scene.view_layers[0],
                                         active_object=copy, object=copy, selected_objects=[copy], selected_editable_objects=[copy])

    def bake(self, copy, slot, material, kind, size, alike=0.5 / 255, most=None):
        """EMIT or NORMAL of one of its materials: rows from the bottom up, linear, four channels. Where no face is, it is the
        mean of the rest; one texel where they all are alike (by default within half of a code of 8 bits), or none has a face.
        Texels of a film's pixel are averaged there; where none is as small, since there are `most` to a side,
        by default as many as textures may have, a texel is the mean of some places."""
        most = most or self.size
        samples, size = SAMPLES_OF_LARGE if size > most else 1, min(size, most)
        for side in (PROBE, size) if size > 2 * PROBE else (size,):
            pixels = self.texels(copy, slot, material, kind, side, samples)
            covered = pixels[..., 3] > 0
            if covered.any():
                pixels[~covered] = pixels[covered].mean(axis=0, dtype=float)
            # What is no number is not even.
            even = np.max(np.ptp(pixels[..., :3].reshape(-1, 3), axis=0)) < alike or (kind == "NORMAL" and are_level(pixels))
            if even and (side == size or np.count_nonzero(covered) >= LEAST_PROBED):
                return pixels.mean(axis=(0, 1), keepdims=True)
        return pixels

    def texels(self, copy, slot, material, kind, size, samples):
        """As they are baked; alpha tells where a face is."""
        self.scene.cycles.samples = samples
        tree = material.node_tree
        copy.data.uv_layers.active = copy.data.uv_layers[BAKE_UV]
        image = bpy.data.images.new("render2mpeg bake", size, size, alpha=True, float_buffer=True)
        image.generated_color = 0, 0, 0, 0
        image.colorspace_settings.name = "Non-Color"
        node = tree.nodes.new("ShaderNodeTexImage")
        node.image = image
        for other in tree.nodes:
            other.select = False
        node.select = True
        tree.nodes.active = node
        for number, entry in enumerate(copy.material_slots):
            entry.link = "OBJECT"
            entry.material = material if number == slot else self.blank
        with self.attended(copy):
            bpy.ops.object.bake(type=kind, normal_space="TANGENT", target="IMAGE_TEXTURES", save_mode="INTERNAL")
        pixels = np.empty(size * size * 4, dtype=np.float32)
        image.pixels.foreach_get(pixels)
        tree.nodes.remove(node)
        bpy.data.images.remove(image)
        return pixels.reshape(size, size, 4)

    def value(self, copy, slot, material, socket, size, **more):
        """What a socket has all over the mesh, shown as light of that colour."""
        return self.bake_through(copy, slot, material, socket, ("ShaderNodeEmission", "Color", "EMIT"), size, **more)

    def by_angle(self, material, socket):
        """What a socket has, where only the angle decides, by its steps: a row of pixels, each seen at one angle."""
        mesh = bpy.data.meshes.new("render2mpeg angles")
        mesh.from_pydata([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], [], [(0, 1, 2, 3)])
        mesh.uv_layers.new(name=BAKE_UV).data.foreach_set("uv", [0, 0, 1, 0, 1, 1, 0, 1])
        mesh.materials.append(None)
        copy = self.stage(mesh, Matrix())
        with angles.seen_at(material.node_tree, angles.cosines(angles.STEPS), socket) as seen:
            pixels = self.value(copy, 0, material, seen, angles.STEPS)
        self.unstage()
        bpy.data.meshes.remove(mesh)
        return np.broadcast_to(pixels[0], (angles.STEPS, 4))[:, :3].astype(float)

    def normal(self, copy, slot, material, socket, size):
        """A socket's normals: those of a matt surface, whose light Cycles need not follow."""
        return self.bake_through(copy, slot, material, socket, ("ShaderNodeBsdfDiffuse", "Normal", "NORMAL"), size)

    def bake_through(self, copy, slot, material, socket, means, size, **more):
        shader, entry, kind = means
        tree = material.node_tree
        end = output_of(tree)
        before = incoming(end.inputs["Surface"])
        node = tree.nodes.new(shader)
        tree.links.new(socket, node.inputs[entry])
        tree.links.new(node.outputs[0], end.inputs["Surface"])
        try:
            return self.bake(copy, slot, material, kind, size, **more)
        finally:
            tree.nodes.remove(node)
            if before is not None:
                tree.links.new(before, end.inputs["Surface"])

    def clear(self):
        if self.scene is not None:
            self.unstage()
            bpy.data.scenes.remove(self.scene)
            self.scene = None
