# SPDX-License-Identifier: Apache-2.0 OR GPL-3.0-or-later
"""Walks through the film's frames as a renderer would: modifiers, instances and visibility as they are when rendered.

Blender gives only a render engine the scene in that state, so this is one that makes no picture.
"""
import bpy
import numpy as np

from . import hair
from .shapes import Bending, Shape

# Modifiers whose result lies still as long as neither they nor their object's data move.
STILL_MODIFIERS = {"ARRAY", "BEVEL", "BUILD_NOT", "DECIMATE", "EDGE_SPLIT", "MASK", "MIRROR", "MULTIRES", "REMESH", "SCREW",
                   "SKIN", "SOLIDIFY", "SUBSURF", "TRIANGULATE", "UV_PROJECT", "WEIGHTED_NORMAL", "WELD", "WIREFRAME"}
SHAPED = {"MESH", "CURVE", "SURFACE", "FONT", "META"}


def moves_itself(data):
    animation = getattr(data, "animation_data", None)
    return bool(animation and (animation.action or animation.drivers or animation.nla_tracks))


def curves_of(animation):
    """What moves by keys or drivers. Actions of Blender 4.4 have slots: curves are those of the thing's own slot."""
    action = animation.action
    slot = getattr(animation, "action_slot", None)
    if action is None:
        return list(animation.drivers)
    if slot is None:
        return list(animation.drivers) + list(getattr(action, "fcurves", ()))
    bags = [strip.channelbag(slot) for layer in action.layers for strip in layer.strips]
    return list(animation.drivers) + [curve for bag in bags if bag is not None for curve in bag.fcurves]


def may_bend(thing):
    """Whether the shape of an (original) object may change over time."""
    data = thing.data
    keys = getattr(data, "shape_keys", None)
    if moves_itself(data) or (keys and moves_itself(keys)):
        return True
    if thing.type == "META" or any(m.type not in STILL_MODIFIERS for m in thing.modifiers):
        return True
    animation = thing.animation_data
    if not thing.modifiers or not moves_itself(thing):
        return False
    curves = curves_of(animation)
    return bool(animation.nla_tracks) or any(c.data_path.startswith("modifiers") for c in curves)


def sizes_of(light):
    """Whatever a lamp has of sizes and angles."""
    return tuple(float(getattr(light, name, 0)) for name in ("shadow_soft_size", "size", "size_y", "angle", "spread", "spot_size", "spot_blend"))


class Thing:
    """One object or instance on its way through the film: a world matrix (rows) per frame, None where it is not there."""

    def __init__(self, name, kind, before):
        self.name, self.kind = name, kind
        self.matrices = [None] * before
        self.shape = None  # its key in Walk.shapes
        self.values = []   # lights: (colour, energy, sizes) per frame where it is there
        self.original = self.light = None


class ShapeOverTime:
    def __init__(self, shape, object_name, materials, bends):
        self.shape, self.object_name, self.materials = shape, object_name, materials
        self.mesh_name = ""  # of the original mesh, for which textures were baked
        self.bending = Bending(shape) if bends else None
        self.missed = 0  # frames on which it was not there, or had other corners

    def unshare_corners(self):
        old = self.shape.unshare_corners()
        if self.bending:
            self.bending.number = self.bending.number[old]


class Row:
    """All objects and instances of a frame, read at once: who they are, and where."""

    def __init__(self, instances):
        count = len(instances)

        def read(attribute, width, kind):
            flat = np.empty(count * width, dtype=kind)
            instances.foreach_get(attribute, flat)
            return flat.reshape(count, width)
        self.who = np.concatenate([read("random_id", 1, np.int32), read("persistent_id", 8, np.int32)] + [
            read(name, 1, bool) for name in ("is_instance", "show_self", "show_particles")], axis=1)
        self.matrices = read("matrix_world", 16, np.float32).reshape(-1, 4, 4).transpose(0, 2, 1).astype(float)
        self.things = {}  # place -> Thing of an instance whose shape stays as it is

    def is_like(self, other):
        return np.array_equal(self.who, other.who)


class Walk:
    """What there is on each frame. `watch(frame, depsgraph)` is called on each as well."""

    def __init__(self, scene, frames, watch, lost):
        self.scene, self.frames, self.watch, self.lost = scene, frames, watch, lost
        self.things, self.shapes = {}, {}
        self.trouble = None
        self.row = None  # Row of the frame before

    def run(self):
        walk = self

        class Engine(bpy.types.RenderEngine):
            bl_idname, bl_label = "RENDER2MPEG_EXPORT", "render2mpeg's export"
            done = False

            def render(self, depsgraph):
                if Engine.done:
                    walk.lost.add(depsgraph.view_layer_eval.name, "view layers after the first")
                    return
                Engine.done = True
                try:
                    for number, frame in enumerate(walk.frames):
                        self.frame_set(int(frame // 1), frame % 1.0)
                        walk.visit(number, depsgraph)
                except Exception as trouble:  # Blender would only print it
                    walk.trouble = trouble
        bpy.utils.register_class(Engine)
        render = self.scene.render
        render.engine, render.use_compositing, render.use_sequencer = Engine.bl_idname, False, False
        # Freestyle would draw, and ends Blender where a set of lines has no style.
        render.use_multiview, render.use_border, render.use_freestyle = False, False, False
        bpy.ops.render.render(scene=self.scene.name)
        if self.trouble:
            raise self.trouble
        if not Engine.done:
            raise RuntimeError("Blender rendered nothing: every view layer is switched off")

    def visit(self, number, depsgraph):
        bent = set()
        before, self.row = self.row, Row(depsgraph.object_instances)
        known = before.things if before is not None and before.is_like(self.row) else {}
        rests = known and (self.row.matrices == before.matrices).all(axis=(1, 2)).tolist()
        for place, instance in enumerate(depsgraph.object_instances):
            seen = known.get(place)
            if seen is not None:
                seen.matrices.append(seen.matrices[-1] if rests[place] else self.row.matrices[place])
                continue
            thing = instance.object
            if instance.show_self if thing.type == "CURVES" else instance.show_particles:
                self.meet_hair(number, instance, thing, depsgraph, bent)
            if not instance.show_self:
                continue
            if thing.type in SHAPED or thing.type == "LIGHT":
                seen = self.meet(number, instance, thing, depsgraph, bent)
                if seen is not None and instance.is_instance and not instance.show_particles and thing.type in SHAPED and \
                        not self.shapes[seen.shape].bending:
                    self.row.things[place] = seen
            elif thing.type == "VOLUME":
                self.meet_volume(number, instance, thing)
            elif thing.type in {"POINTCLOUD", "GPENCIL", "GREASEPENCIL"}:
                self.lost.add(thing.original, {"POINTCLOUD": "point cloud"}.get(thing.type, "grease pencil"))
        self.row.things.update(known)
        for seen in self.things.values():
            seen.matrices += [None] * (number + 1 - len(seen.matrices))
        for key, shape in self.shapes.items():
            if shape.bending and key not in bent:
                shape.missed += 1
                if shape.bending.rows:
                    shape.bending.rows.append(list(shape.bending.rows[-1]))
        self.watch(number, depsgraph)

    def meet_volume(self, number, instance, thing):
        original = thing.original
        of = (instance.parent.original.name_full, *instance.persistent_id) if instance.is_instance else ()
        seen = self.things.get(("volume", original.name_full, *of))
        if seen is None:
            seen = self.things["volume", original.name_full, *of] = Thing(original.name, "VOLUME", number)
            seen.original = original
        seen.matrices.append(np.array(instance.matrix_world, dtype=float))

    def meet_hair(self, number, instance, thing, depsgraph, bent):
        """Strands of an object's particle systems, or of a Curves object."""
        original = thing.original
        of = f"{instance.parent.original.name}/{original.name}" if instance.is_instance else original.name
        own = ("instance", instance.parent.original.name_full, tuple(instance.persistent_id)) if instance.is_instance else ()
        sources = [(system.name, system) for system in hair.systems_of(thing)]
        if thing.type == "CURVES":
            sources.append(("", None))
        for name, system in sources:
            key = ("hair", original.name_full, name)
            known = self.shapes.get(key)
            if known is None or (known.bending and key not in bent):
                strands = hair.particle_strands(thing, system) if system else hair.curve_strands(thing.data)
                self.keep(key, strands, original, thing, number, bent, hair.bends(original, system, STILL_MODIFIERS, moves_itself)
                          if system else may_bend(original))
            if self.shapes[key].shape is None:
                continue
            seen = self.things.get(own + key)
            if seen is None:
                seen = self.things[own + key] = Thing(f"{of} {name}".strip(), "HAIR", number)
                seen.shape = key
            if len(seen.matrices) <= number:
                seen.matrices.append(np.array(instance.matrix_world, dtype=float))

    def keep(self, key, shape, original, thing, number, bent, may_bend):
        """The shape at one more frame."""
        known = self.shapes.get(key)
        if known is None:
            materials = [s.material.original if s.material else None for s in thing.material_slots]
            known = self.shapes[key] = ShapeOverTime(shape, original.name, materials, may_bend and shape is not None)
            if known.bending:
                known.missed = number
                known.bending.rows += [[]] * number
        bent.add(key)
        if known.bending and (shape is None or not known.bending.add(shape)):
            known.bending.rows.append(list(known.bending.rows[-1]) if known.bending.rows else [])
            self.lost.add(original, "its hair has other points on other frames; its first ones are kept")

    def meet(self, number, instance, thing, depsgraph, bent):
        original = thing.original
        if instance.is_instance:
            parent = instance.parent.original
            key = ("instance", parent.name_full, original.name_full, getattr(thing.data, "name_full", ""), tuple(instance.persistent_id))
            name = f"{parent.name}/{original.name}"
        else:
            key, name = ("object", original.name_full), original.name
        shape = None
        if thing.type != "LIGHT":
            shape = self.shape_of(instance, thing, number, bent)
            if shape is None:
                return None
        seen = self.things.get(key)
        if seen is None:
            seen = self.things[key] = Thing(name, thing.type, number)
            seen.shape, seen.original, seen.light = shape, original, original.data if thing.type == "LIGHT" else None
        seen.matrices.append(np.array(instance.matrix_world, dtype=float))
        if thing.type == "LIGHT":
            seen.values.append((tuple(thing.data.color), float(thing.data.energy), sizes_of(thing.data)))
        return seen

    def shape_of(self, instance, thing, number, bent):
        """The key of its shape; None where it has no triangles."""
        original = thing.original
        bends = may_bend(original)
        slots = tuple(s.material.name_full if s.material else "" for s in thing.material_slots)
        if bends or thing.modifiers or thing.type != "MESH":
            key = (original.name_full, thing.data.name_full if instance.is_instance else "", slots)
        else:
            key = (thing.data.name_full, slots)
        known = self.shapes.get(key)
        if key in bent or (known is not None and not known.bending):
            return key if known.shape is not None else None
        mesh = thing.to_mesh()
        try:
            if mesh is None or not mesh.polygons:
                if known is None and not bends:
                    self.shapes[key] = ShapeOverTime(None, original.name, [], False)
                return None
            shape = Shape(mesh)
            own = [s.material for s in thing.material_slots]
            materials = own if len(own) >= len(mesh.materials) else list(mesh.materials)
            materials = [m.original if m else None for m in materials]
        finally:
            thing.to_mesh_clear()
        bent.add(key)
        if known is None:
            known = self.shapes[key] = ShapeOverTime(shape, original.name, materials, bends)
            known.mesh_name = original.data.name_full if original.type == "MESH" else ""
            if bends:
                known.missed = number
                known.bending.rows += [[]] * number
        if known.bending and not known.bending.add(shape):
            known.bending.rows.append(list(known.bending.rows[-1]) if known.bending.rows else [])
            self.lost.add(original, "its shape has other corners on other frames; its first one is kept")
        return key
