# SPDX-License-Identifier: Apache-2.0 OR GPL-3.0-or-later
"""Volumes: OpenVDB's files of Volume objects and of baked gas domains, and meshes filled with a medium.

Measured with Cycles of Blender 3.4: a mesh's medium counts per unit of the world, whatever its object's scale, and emission is not
multiplied by density. Cycles' source: so does a domain's; a Volume object's density counts per unit of its own space, of which the
diagonal (1, 1, 1) is taken, unless its `render.space` says WORLD.
"""
import functools
import os
import re
import shutil

import bpy
import numpy as np

from . import fields
from .keys import json_number
from .nodes import incoming, number_of, output_of

MOST_ANISOTROPY = 0.95
INFO_GRIDS = {"Density": "density", "Color": "color", "Flame": "flame", "Temperature": "temperature"}


class Unknown(Exception):
    """A node that no medium here has: the node and the reason."""


def grid_and_factor(socket):
    """(grid or None, factor) of an input that is a number, a grid, or a product of both. A grid is the name of a file's, or the
    socket of nodes that say other values from place to place."""
    source = incoming(socket)
    if source is None:
        return None, number_of(socket.default_value)
    node = source.node
    if node.type in {"VALUE", "RGB"}:
        return None, number_of(source.default_value)
    if node.type == "ATTRIBUTE":
        return node.attribute_name, 1.0
    if node.type == "VOLUME_INFO":
        return INFO_GRIDS[source.name], 1.0
    if node.type == "MATH" and node.operation == "MULTIPLY" and not node.use_clamp:
        (a, x), (b, y) = map(grid_and_factor, node.inputs[:2])
        if a is None or b is None:
            return a if b is None else b, x * y
    return source, 1.0


def color_of(socket):
    """(grid's name or None, colour)."""
    source = incoming(socket)
    if source is None:
        return None, np.clip(np.array(socket.default_value[:3]), 0, None)
    if source.node.type == "RGB":
        return None, np.clip(np.array(source.default_value[:3]), 0, None)
    return name_of(grid_and_factor(socket)[0], "colours"), np.ones(3)


def name_of(grid, what):
    """The same grid, if a file has it."""
    if fields.is_field(grid):
        raise Unknown(grid.node, f"gives {what} that differ from place to place")
    return grid


def plain_color(node, socket):
    grid, color = color_of(socket)
    if grid is not None:
        raise Unknown(node, f"has colours by a grid, {grid}")
    return color


class Medium:
    """What a volume's shaders come to: coefficients per unit where the density grid is 1, and names of grids."""

    def __init__(self):
        self.scattering, self.absorption, self.emission = np.zeros(3), np.zeros(3), np.zeros(3)
        self.density_grid, self.grids = None, {}
        self.anisotropy = self.blackbody = 0.0
        self.tint, self.temperature = np.ones(3), 1000.0

    def has_density(self, node, socket, attribute=""):
        """The density's factor; its grid is that of a link, else the attribute."""
        grid, factor = grid_and_factor(socket)
        grid = grid or attribute or None
        if self.density_grid not in {None, grid}:
            raise Unknown(node, "has another density than its neighbour")
        self.density_grid = grid
        return max(factor, 0.0)

    def scatter(self, coefficients, anisotropy):
        both = self.scattering.mean() + coefficients.mean()
        if both > 0:
            self.anisotropy = (self.anisotropy * self.scattering.mean() + anisotropy * coefficients.mean()) / both
        self.scattering = self.scattering + coefficients

    def add(self, node):
        inputs = node.inputs
        if node.type == "ADD_SHADER":
            for part in map(incoming, inputs[:2]):
                if part is not None:
                    self.add(part.node)
        elif node.type == "VOLUME_SCATTER":
            self.scatter(self.has_density(node, inputs["Density"]) * plain_color(node, inputs["Color"]), number_of(inputs["Anisotropy"].default_value))
        elif node.type == "VOLUME_ABSORPTION":
            self.absorption = self.absorption + self.has_density(node, inputs["Density"]) * np.clip(1 - plain_color(node, inputs["Color"]), 0, None)
        elif node.type == "EMISSION":
            grid, strength = grid_and_factor(inputs["Strength"])
            self.glow(node, grid, strength * plain_color(node, inputs["Color"]))
        elif node.type == "PRINCIPLED_VOLUME":
            self.add_principled(node)
        else:
            raise Unknown(node, "is no volume that is kept")

    def glow(self, node, grid, radiance):
        if fields.is_field(grid) and self.density_grid is None and not np.any(self.scattering + self.absorption > 0):
            self.density_grid = grid
        if grid is not None and np.any(radiance > 0) and grid != self.density_grid:
            raise Unknown(node, f"shines by a grid of its own, {getattr(grid, 'name', grid)}")
        self.emission = self.emission + np.clip(radiance, 0, None)

    def add_principled(self, node):
        inputs = node.inputs
        density = self.has_density(node, inputs["Density"], inputs["Density Attribute"].default_value)
        grid, color = color_of(inputs["Color"])
        grid = grid or inputs["Color Attribute"].default_value
        if grid:
            self.grids["color"] = grid
        color = np.minimum(color, 1)
        passes = np.sqrt(np.clip(plain_color(node, inputs["Absorption Color"]), 0, 1))
        self.scatter(density * color, number_of(inputs["Anisotropy"].default_value))
        self.absorption = self.absorption + density * (1 - color) * (1 - passes)
        grid, strength = grid_and_factor(inputs["Emission Strength"])
        self.glow(node, grid, strength * plain_color(node, inputs["Emission Color"]))
        grid, intensity = grid_and_factor(inputs["Blackbody Intensity"])
        if grid is not None:
            raise Unknown(node, f"glows by a grid of its own, {getattr(grid, 'name', grid)}")
        self.blackbody, self.tint = min(max(intensity, 0.0), 1.0), plain_color(node, inputs["Blackbody Tint"])
        grid, self.temperature = grid_and_factor(inputs["Temperature"])
        grid = name_of(grid, "temperatures") or inputs["Temperature Attribute"].default_value
        if grid:
            self.grids["temperature"] = grid

    def says(self, scale):
        """Keys of an animation file; `scale`: world units to one of the volume's space."""
        def rounded(values):
            return [json_number(v) for v in values]
        # As Principled Volume: what is not scattered is absorbed but for the root of a colour.
        density = float((self.scattering + self.absorption).max())
        out = {"density": json_number(density * scale)}
        if density > 0:
            color = np.clip(self.scattering / density, 0, 1)
            taken = np.divide(self.absorption, density - self.scattering, out=np.zeros(3), where=density - self.scattering > 1e-9 * density)
            out["color"], out["absorption_color"] = rounded(color), rounded((1 - np.clip(taken, 0, 1)) ** 2)
        if self.anisotropy:
            out["anisotropy"] = json_number(min(max(self.anisotropy, -MOST_ANISOTROPY), MOST_ANISOTROPY))
        if self.emission.max() > 0:
            out["emission"] = json_number(self.emission.max() * scale)
            out["emission_color"] = rounded(self.emission / self.emission.max())
        if self.blackbody > 0:
            out.update(blackbody=json_number(self.blackbody), blackbody_tint=rounded(self.tint * scale), temperature=json_number(self.temperature))
        return out


def file_number(volume, frame):
    """Of a sequence, as Blender counts; None: nothing is shown."""
    count, number = volume.frame_duration, int(frame) - volume.frame_start + 1
    if count == 0 or (volume.sequence_mode == "CLIP" and not 1 <= number <= count):
        return None
    if volume.sequence_mode == "EXTEND":
        number = min(max(number, 1), count)
    elif volume.sequence_mode == "REPEAT":
        number = (number - 1) % count + 1
    elif volume.sequence_mode == "PING_PONG" and count > 1:
        number = (number - 1) % (2 * count - 2) + 1
        number = 2 * count - number if number > count else number
    return number + volume.frame_offset


def file_at(volume, frame):
    path = bpy.path.abspath(volume.filepath, library=volume.library)
    if not volume.is_sequence:
        return path
    number = file_number(volume, frame)
    found = re.fullmatch(r"(.*?)(\d+)(\D*)", os.path.basename(path))
    if number is None or not found:
        return None
    return os.path.join(os.path.dirname(path), f"{found[1]}{number:0{len(found[2])}d}{found[3]}")


def domain_of(thing):
    """Settings of a baked gas domain; None of another thing."""
    for modifier in thing.modifiers:
        if modifier.type == "FLUID" and modifier.fluid_type == "DOMAIN" and modifier.show_render:
            return modifier.domain_settings if modifier.domain_settings.domain_type == "GAS" else None
    return None


@functools.cache
def grids_of(path):
    """Name -> (whether it holds vectors, matrix of rows) of a file's grids; None where Blender does not read it."""
    volume = bpy.data.volumes.new("render2mpeg")
    try:
        volume.filepath = path
        if not os.path.isfile(path) or not volume.grids.load():
            return None
        return {grid.name: (grid.channels == 3, np.array(grid.matrix_object)) for grid in volume.grids}
    finally:
        bpy.data.volumes.remove(volume)


def box_of(shape):
    """(middle, size) of a mesh that is a box along its axes; None of another."""
    low, high = shape.vertices.min(axis=0).astype(float), shape.vertices.max(axis=0).astype(float)
    size = high - low
    ends = (np.abs(shape.vertices - low) < 1e-4 * size.max()) | (np.abs(shape.vertices - high) < 1e-4 * size.max())
    if size.min() <= 0 or not ends.all() or len(np.unique(np.round((shape.vertices - low) / size), axis=0)) != 8 or not shape.is_closed():
        return None
    return (low + high) / 2, size


class Volumes:
    """Collects the film's `volumes`."""

    def __init__(self, scene, frames, own_rate, film_rate, film, folder, materials, voxels, lost):
        """`voxels`: fields.Voxels."""
        self.voxels = voxels
        self.scene, self.frames, self.own_rate, self.film_rate, self.film = scene, frames, own_rate, film_rate, film
        self.folder, self.materials, self.lost = folder, materials, lost
        self.uses = []
        self.resolution = {}  # of domains, by name: cells along each axis

    def watch(self, number, depsgraph):
        """Remembers what only evaluated domains tell."""
        for thing in self.scene.objects:
            if thing.name_full not in self.resolution and domain_of(thing) is not None:
                settings = domain_of(thing.evaluated_get(depsgraph))
                if settings is not None and max(settings.domain_resolution) > 0:
                    self.resolution[thing.name_full] = tuple(settings.domain_resolution)

    def is_volume_alone(self, over):
        """Whether a shape's materials have volumes and no surface."""
        looks = [self.materials.look(m)[0] for m in over.materials if m is not None]
        return bool(looks) and all(look.nowhere for look in looks)

    def medium_of(self, material, name):
        """None, told, of a material that is none or is not understood."""
        if material is None:
            self.lost.add(name, "a volume without a material")
            return None
        tree = self.materials.look(material)[1].node_tree
        end = output_of(tree) if tree is not None else None
        source = incoming(end.inputs["Volume"]) if end is not None else None
        medium = Medium()
        try:
            if source is None:
                raise Unknown(None, "no volume")
            medium.add(source.node)
        except Unknown as reason:
            node, why = reason.args
            self.lost.add_of(material, f"{why}; the volume is not there in the film", node, name)
            return None
        return medium

    def add(self, node, thing, over):
        """Adds what fills a thing, if it can be kept, as standing at the node of this name."""
        first = next(m for m in thing.matrices if m is not None)
        if thing.kind == "VOLUME":
            material = next((s.material for s in thing.original.material_slots), None)
            says = self.of_files(thing, material, lambda frame: file_at(thing.original.data, frame), first)
        else:
            material = next(m for m in over.materials if m is not None)
            original = bpy.data.objects.get(over.object_name)
            domain = domain_of(original) if original is not None else None
            says = self.of_domain(thing, material, original, domain, first) if domain is not None else self.of_mesh(thing, material, over, first)
        if says:
            present = [m is not None for m in thing.matrices]
            shown = says.pop("shown", [True] * len(present))
            self.film.setdefault("volumes", []).append({"name": thing.name, "node": node, **says})
            self.hide(self.film["volumes"][-1], [a and b for a, b in zip(present, shown)])

    def hide(self, says, shown):
        if all(shown):
            return
        keys = [k for k in range(len(shown)) if k == 0 or shown[k] != shown[k - 1]]
        says["keys"] = [{"at": json_number(k / self.own_rate), "visible": shown[k]} for k in keys]

    def of_mesh(self, thing, material, over, matrix):
        medium, box = self.medium_of(material, thing.name), box_of(over.shape)
        if medium is None:
            return None
        if over.bending or box is None and not (over.shape.is_closed() and np.ptp(over.shape.vertices, axis=0).min() > 0):
            self.lost.add(thing.name, f"a volume in a shape that {'bends' if over.bending else 'is open'}; it is not there in the film")
            return None
        if medium.blackbody > 0:
            self.lost.add(thing.name, "blackbody of a volume without grids")
            medium.blackbody = 0.0
        field = medium.density_grid if fields.is_field(medium.density_grid) else None
        if box is not None and field is None:
            self.materials.tell_motion(material)
            middle, size = box
            return {"position": [json_number(v) for v in middle], "size": [json_number(v) for v in size], **medium.says(scale_of(matrix))}
        return self.of_voxels(thing, material, over, medium, field, box is not None)

    def of_voxels(self, thing, material, over, medium, field, fills):
        """Of a density that differs from place to place, or a shape that is no box: a grid, for each frame where nodes move."""
        self.materials.tell_motion(material, fields.nodes_before(field))
        made = self.materials.look(material)[1]
        grid = fields.Grid(self.voxels, thing, over, made, field, fills)
        number, names = len(self.film.get("volumes", [])), {}

        def path_at(frame):
            k = list(self.frames).index(frame)
            if thing.matrices[k] is None:
                return None
            at = k if grid.moves else 0
            if at not in names:
                names[at] = f"density{number:03d}_{at:05d}.vdb"
                grid.write(os.path.join(self.folder, names[at]), frame, thing.matrices[k])
            return names[at]
        paths = self.paths_by_frame(path_at)[0]
        self.voxels.done(self.scene)
        if field is not None and medium.emission.max() > 0 and medium.says(1)["density"] > 0:
            self.lost.add(thing.name, "emission of a volume; it shines where it is dense")
        first = next(m for m in thing.matrices if m is not None)
        return {"file": paths if grid.moves else paths[0], "density_grid": fields.GRID, **medium.says(scale_of(first))}

    def of_files(self, thing, material, path_at, matrix, place=None, more_at=None):
        """`place`: (position, scale) of a file's space in the thing's. `more_at`: files of more grids."""
        medium = self.medium_of(material, thing.name)
        if medium is None:
            return None
        paths, shown = self.paths_by_frame(path_at)
        more = self.paths_by_frame(more_at)[0] if more_at else []
        if fields.is_field(medium.density_grid):
            self.lost.add_of(material, "is none of Attribute, Volume Info, Value and their products; the volume is not there in the film", medium.density_grid.node, thing.name)
            return None
        self.materials.tell_motion(material)
        grids = next((g for g in map(grids_of, dict.fromkeys(p for p in paths if p)) if g), None)
        missing = next((p for p in paths + more if p and not os.path.isfile(p)), None)
        if grids is None or missing:
            self.lost.add(thing.name, f"a volume without its file {missing}" if missing else "a volume whose file Blender does not read")
            return None
        if not medium.density_grid:
            self.lost.add(thing.name, "a volume of even density in a file's active voxels; it is not there in the film")
            return None
        says = {"file": self.stored(paths), "shown": shown}
        if more:
            says["more"] = self.stored(more)
            grids = {**(grids_of(more[0]) or {}), **grids}
            if medium.density_grid + "_noise" in grids:
                medium.density_grid += "_noise"
        if not self.name_grids(says, thing, medium, grids):
            return None
        scale = np.eye(4)
        if place is not None:
            says.update(position=[json_number(v) for v in place[0]], scale=[json_number(v) for v in place[1]])
            scale[[0, 1, 2], [0, 1, 2]] = place[1]
        world_units = scale_of(matrix @ scale)
        says.update(medium.says(world_units))
        if thing.kind == "VOLUME" and thing.original.data.render.space == "OBJECT":
            says["density"] = json_number(says["density"] / world_units)
        if medium.emission.max() > 0:
            self.lost.add(thing.name, "emission of a volume; it shines where it is dense")
        return says

    def name_grids(self, says, thing, medium, grids):
        if medium.density_grid not in grids:
            self.lost.add(thing.name, f"a volume whose file has no grid {medium.density_grid}; there are {', '.join(grids) or 'none'}")
            return False
        says["density_grid"] = medium.density_grid
        temperature, color = medium.grids.get("temperature"), medium.grids.get("color")
        if medium.blackbody > 0:
            if temperature in grids:
                says["temperature_grid"] = temperature
            else:
                self.lost.add(thing.name, f"blackbody of a volume whose file has no grid {temperature}")
                medium.blackbody = 0.0
        if color and (color in grids or color + "_r" in grids):
            says["color_grid"] = color
        return True

    def of_domain(self, thing, material, original, domain, matrix):
        """A bake's voxels fill the domain, whatever size its files give them."""
        if domain.cache_data_format != "OPENVDB":
            self.lost.add(thing.name, "a simulation that is baked, if at all, to another format than OpenVDB")
            return None
        if domain.use_adaptive_domain:
            self.lost.add(thing.name, "a simulation with an adaptive domain")
            return None
        folder = bpy.path.abspath(domain.cache_directory, library=original.library)
        first, last = domain.cache_frame_start, domain.cache_frame_end

        def files(kind):
            def path_at(frame):
                number = int(frame) - domain.cache_frame_offset
                return os.path.join(folder, kind, f"fluid_{kind}_{min(number, last):04d}.vdb") if number >= first else None
            return path_at
        path_at, more_at = (files("noise"), files("data")) if domain.use_noise else (files("data"), None)
        cells = np.array(self.resolution.get(original.name_full, (0, 0, 0)), dtype=float) * (domain.noise_scale if domain.use_noise else 1)
        grids = next((g for g in (grids_of(p) for p in map(path_at, self.frames) if p) if g), None)
        if grids is None or not cells.min() > 0:
            self.lost.add(thing.name, f"a simulation without its bake in {folder}")
            return None
        side = next(iter(grids.values()))[1][0, 0]
        corners = np.array(original.bound_box, dtype=float)
        low, size = corners.min(axis=0), np.ptp(corners, axis=0)
        return self.of_files(thing, material, path_at, matrix, (low + size * 0.5 / cells, size / (cells * side)), more_at)

    def paths_by_frame(self, path_at):
        """Of each frame of the film, the file; and of each frame of the .blend, whether there is one."""
        own = [path_at(frame) for frame in self.frames]
        known = next((p for p in own if p), None)
        shown = [p is not None for p in own]
        filled = []
        for path in own:
            known = path or known
            filled.append(known)
        count = self.film["frames"]
        return [filled[min(len(own) - 1, int(k / self.film_rate * self.own_rate + 1e-6))] for k in range(count)], shown

    def stored(self, paths):
        """The files' names in the export's folder: links where the file system has them, else copies."""
        names = {}
        for path in dict.fromkeys(paths):
            names[path] = name = f"volume{len(self.uses):05d}.vdb"
            self.uses.append(path)
            target = os.path.join(self.folder, name)
            if os.path.exists(target):
                os.remove(target)
            try:
                os.link(path, target)
            except OSError:
                shutil.copyfile(path, target)
        out = [names[path] for path in paths]
        return out[0] if len(names) == 1 else out


def scale_of(matrix):
    """World units to one of an object's, as Cycles takes it."""
    return float(np.linalg.norm(matrix[:3, :3] @ np.full(3, 3 ** -0.5)))
