"""Bakes sockets of materials to images, in a scene of its own that holds nothing but the mesh."""
import bpy
import numpy as np

from .shapes import BAKE_UV


def unwrap(window, scene, thing):
    """Gives the mesh of `thing` a layer of coordinates in which no two faces share a place."""
    mesh = thing.data
    if BAKE_UV in mesh.uv_layers:
        mesh.uv_layers.active = mesh.uv_layers[BAKE_UV]
        return True
    if len(mesh.uv_layers) >= 8 or mesh.library is not None:
        return False
    shown = next((layer.name for layer in mesh.uv_layers if layer.active_render), None)
    layer = mesh.uv_layers.new(name=BAKE_UV)
    if layer is None:
        return False
    mesh.uv_layers.active = mesh.uv_layers[BAKE_UV]
    if shown:
        mesh.uv_layers[shown].active_render = True
    with bpy.context.temp_override(window=window, scene=scene, view_layer=scene.view_layers[0], active_object=thing, object=thing,
                                   selected_objects=[thing], selected_editable_objects=[thing]):
        bpy.ops.object.mode_set(mode="EDIT")
        bpy.ops.mesh.reveal()
        bpy.ops.mesh.select_all(action="SELECT")
        bpy.ops.uv.smart_project(island_margin=0.01)
        bpy.ops.object.mode_set(mode="OBJECT")
    return True


class Baker:
    def __init__(self, size):
        self.size = size
        self.scene = None

    def prepare(self):
        scene = self.scene = bpy.data.scenes.new("render2mpeg bake")
        scene.render.engine = "CYCLES"
        scene.cycles.samples, scene.cycles.use_adaptive_sampling, scene.cycles.use_denoising = 4, False, False
        scene.cycles.device, scene.cycles.shading_system = "CPU", False
        scene.render.bake.margin = 8
        scene.render.bake.use_clear = True
        self.blank = bpy.data.materials.new("render2mpeg blank")
        self.blank.use_nodes = True
        node = self.blank.node_tree.nodes.new("ShaderNodeTexImage")
        node.image = bpy.data.images.new("render2mpeg blank", 4, 4)
        self.blank.node_tree.nodes.active = node

    def stage(self, thing):
        """A copy of an object that stands as it does, with its mesh as it was made, and nothing else in the scene."""
        if self.scene is None:
            self.prepare()
        for old in list(self.scene.collection.objects):
            self.scene.collection.objects.unlink(old)
        copy = bpy.data.objects.new("render2mpeg bake", thing.data)
        copy.matrix_world = thing.matrix_world
        self.scene.collection.objects.link(copy)
        window = bpy.context.window_manager.windows[0]
        window.scene = self.scene
        self.scene.view_layers[0].objects.active = copy
        copy.select_set(True)
        return copy if unwrap(window, self.scene, copy) else None

    def bake(self, copy, slot, material, kind):
        """EMIT or NORMAL of one of its materials: rows from the bottom up, linear, four channels."""
        window = bpy.context.window_manager.windows[0]
        tree = material.node_tree
        image = bpy.data.images.new("render2mpeg bake", self.size, self.size, alpha=True, float_buffer=True)
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
        with bpy.context.temp_override(window=window, scene=self.scene, view_layer=self.scene.view_layers[0], active_object=copy,
                                       object=copy, selected_objects=[copy]):
            bpy.ops.object.bake(type=kind, normal_space="TANGENT", target="IMAGE_TEXTURES", save_mode="INTERNAL")
        pixels = np.empty(self.size * self.size * 4, dtype=np.float32)
        image.pixels.foreach_get(pixels)
        tree.nodes.remove(node)
        bpy.data.images.remove(image)
        return pixels.reshape(self.size, self.size, 4)

    def value(self, copy, slot, material, socket):
        """What a socket has all over the mesh, shown as light of that colour."""
        from .nodes import incoming, output_of
        tree = material.node_tree
        end = output_of(tree)
        before = incoming(end.inputs["Surface"])
        light = tree.nodes.new("ShaderNodeEmission")
        tree.links.new(socket, light.inputs["Color"])
        tree.links.new(light.outputs[0], end.inputs["Surface"])
        try:
            return self.bake(copy, slot, material, "EMIT")
        finally:
            tree.nodes.remove(light)
            if before is not None:
                tree.links.new(before, end.inputs["Surface"])

    def clear(self):
        if self.scene is not None:
            bpy.data.scenes.remove(self.scene)
            self.scene = None
