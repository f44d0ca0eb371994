# SPDX-License-Identifier: Apache-2.0 OR GPL-3.0-or-later
"""Lamps in the units of animation files.

Measured with Cycles of Blender 3.4, with P the power in W and A the area: a point of radius r has the radiant intensity
P / (4 pi), as a sphere the radiance P / (4 pi^2 r^2); a spot has a point's intensity times the cosine to its axis; an
area lamp has the radiance P / (4 A), from Blender 4 on P / (pi A); a sun of half angle s has the irradiance
E (1 + cos s) / 2. Without Blender 4.5's normalisation the power counts per A, of points and spots per 4 pi r^2. Cameras see no
lamp, mirrors and glass those that Cycles samples by rays as well.
"""
import math

import bpy
import numpy as np

from .cameras import TO_FILM, rotation_of
from .keys import json_number, thinned, turns, unwound


def energy_of(thing, number):
    color, energy, _ = thing.values[number]
    return max(0.0, energy) * max(max(color), 0.0)


def color_of(color):
    largest = max(color)
    return [json_number(max(c, 0) / largest) for c in color] if largest > 0 else [1, 1, 1]


def area_of(light, scale):
    x = light.size * scale[0]
    y = (light.size_y if light.shape in {"RECTANGLE", "ELLIPSE"} else light.size) * scale[1]
    return max(x, 1e-4), max(y, 1e-4)


def spot_keys(light, seen, says, lost, name):
    """Cycles' edge is a smooth step in the cosine, and before Blender 4 it dims by the cosine to the axis, too. The film's
    own edge is the square of a line: with three quarters of the width both cut off the same light."""
    old = bpy.app.version < (4, 0, 0)
    half = min(light.spot_size / 2, math.radians(89.9))
    outer = math.cos(half)
    inner = outer + (1 if old else 0.75) * light.spot_blend * (1 - outer)
    if old:
        says["falloff"] = "blender-3"
    says["angle"] = json_number(2 * math.degrees(half))
    says["softness"] = json_number(1 - math.acos(min(1.0, inner)) / half)
    if light.shadow_soft_size >= 1e-3 and seen:
        says["radius"] = json_number(light.shadow_soft_size)
    if light.shadow_soft_size > 0.01:
        lost.add(name, f"soft size of a spot ({light.shadow_soft_size:.3g} m); its shadows are sharp")


def seen_by_mirrors(thing, lost):
    """Whether rays of mirrors and glass meet it."""
    eyes = {name: getattr(thing.original, "visible_" + name, True) for name in ("diffuse", "glossy", "transmission", "volume_scatter")}
    if len(set(eyes.values())) > 1:
        lost.add(thing.name, "ray visibility of a lamp that is not the same for all rays; it lights all")
    # Blender before 4.3 asks Cycles' own settings.
    return eyes["glossy"] and getattr(getattr(thing.light, "cycles", None), "use_multiple_importance_sampling", True)


def strength_keys(thing, light, scale, says, lost):
    """Fills in kind and size; returns intensity per watt."""
    seen = seen_by_mirrors(thing, lost)
    if light.type == "SUN":
        says["kind"] = "sun"
        if light.angle > 0:
            says["angle"] = json_number(math.degrees(min(light.angle, math.pi)))
            says.update({"seen": "mirrors"} if seen else {})
        return (1 + math.cos(light.angle / 2)) / 2
    if light.type == "SPOT":
        says["kind"] = "spot"
        spot_keys(light, seen, says, lost, thing.name)
        return 1 / (4 * math.pi)
    if light.type == "POINT":
        radius = light.shadow_soft_size
        if radius < 1e-3:
            says["kind"] = "point"
            return 1 / (4 * math.pi)
        says.update(kind="sphere", radius=json_number(radius), seen="mirrors" if seen else False)
        return 1 / (4 * math.pi**2 * radius**2)
    x, y = area_of(light, scale)
    area = x * y
    if light.shape in {"DISK", "ELLIPSE"}:
        area *= math.pi / 4
        says["round"] = True
    if light.spread < math.radians(179):
        lost.add(thing.name, f"spread of an area lamp ({math.degrees(light.spread):.3g} degrees); it shines to all sides of its front")
    says.update(kind="panel", size=[json_number(x), json_number(y)], seen="mirrors" if seen else False)
    per_area = 1 / (4 if bpy.app.version < (4, 0, 0) else math.pi)
    return per_area / area if getattr(light, "normalize", True) else per_area


def settings_of(thing, light, lost):
    """Blender 4.5's settings of a lamp: colour and strength as factors."""
    strength = 2 ** getattr(light, "exposure", 0.0)
    if not getattr(light, "normalize", True) and light.type in {"POINT", "SPOT"}:
        strength *= 4 * math.pi * light.shadow_soft_size**2
    if not getattr(light, "normalize", True) and light.type == "SUN":
        lost.add(thing.name, "a sun whose strength is not normalised; it is taken as if it were")
    return tuple(light.temperature_color)[:3] if getattr(light, "use_temperature", False) else (1, 1, 1), strength


def node_strength(thing, light, lost):
    """A lamp's nodes: colour and strength of one emission as factors."""
    if not light.use_nodes or light.node_tree is None:
        return (1, 1, 1), 1.0
    for node in light.node_tree.nodes:
        if node.type == "EMISSION":
            if any(socket.is_linked for socket in node.inputs):
                lost.add(thing.name, "nodes of the lamp")
            if node.inputs["Strength"].is_linked:
                return (1, 1, 1), 1.0
            return tuple(node.inputs["Color"].default_value)[:3], node.inputs["Strength"].default_value
    return (1, 1, 1), 1.0


def is_portal(light):
    """Whether it only tells Cycles where light of the world comes in."""
    return light.type == "AREA" and getattr(getattr(light, "cycles", None), "is_portal", False)


def described(thing, times, lost):
    light = thing.light
    if is_portal(light):
        return None
    present = [n for n, m in enumerate(thing.matrices) if m is not None]
    first = thing.matrices[present[0]]
    scale = np.linalg.norm(first[:3, :3], axis=0)
    says = {"name": thing.name}
    factor = strength_keys(thing, light, scale, says, lost)
    tint, strength = node_strength(thing, light, lost)
    warmth, exposed = settings_of(thing, light, lost)
    tint, strength = tuple(a * b for a, b in zip(tint, warmth)), strength * exposed
    color = thing.values[0][0]
    says["color"] = color_of([a * b for a, b in zip(color, tint)])
    factor *= strength * max(a * b for a, b in zip(color, tint)) / max(max(color), 1e-9)
    if any(max(abs(a - b) for a, b in zip(color_of(v[0]), color_of(color))) > 1e-3 for v in thing.values):
        lost.add(thing.name, "animated colour of a lamp; as on the first frame")

    if any(max(abs(a - b) for a, b in zip(v[2], thing.values[0][2])) > 1e-4 for v in thing.values):
        lost.add(thing.name, "animated size or angle of a lamp; as on the first frame")
    # Blender 4.3 has one switch for all its renderers.
    if not getattr(getattr(light, "cycles", light), "cast_shadow", getattr(light, "use_shadow", True)):
        lost.add(thing.name, "a lamp without shadows; it casts some")

    power = [0.0] * len(times)
    for k, number in enumerate(present):
        power[number] = factor * energy_of(thing, k)
    peak = max(power)
    if peak <= 0:
        return None
    says["intensity"] = json_number(peak)
    # Where it is not there it keeps its place and is dark.
    matrices, last = [], first
    for matrix in thing.matrices:
        last = matrix if matrix is not None else last
        matrices.append(TO_FILM @ last)
    quantities = {"position": ([m[:3, 3] for m in matrices], 1e-5), "rotate": (unwound([turns(rotation_of(m)) for m in matrices]), 1e-3)}
    if says["kind"] in {"point", "sphere"}:
        del quantities["rotate"]
    if says["kind"] == "sun":
        del quantities["position"]
    if max(power) - min(power) > 1e-6 * peak:
        quantities["power"] = ([[p / peak] for p in power], 1e-5)
    keys = {}
    for name, (values, tolerance) in quantities.items():
        needed = thinned(times, values, tolerance)
        for k in needed:
            value = [json_number(v) for v in values[k]]
            value = value[0] if name == "power" else value
            if len(needed) == 1:
                says[name] = value
            else:
                keys.setdefault(k, {"at": json_number(times[k])})[name] = value
    if keys:
        says["keys"], says["interpolation"] = [keys[k] for k in sorted(keys)], "linear"
    return says
