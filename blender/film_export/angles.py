# SPDX-License-Identifier: Apache-2.0 OR GPL-3.0-or-later
"""Values that depend on the angle a surface is seen at, as Layer Weight and Fresnel say it: a curve over the root of the
cosine to the normal, between two ends."""
import contextlib

import bpy
import numpy as np

from .nodes import STEADY, incoming, is_steady, number_of

NODES = {"FRESNEL", "LAYER_WEIGHT"}
STEPS = 64       # of a curve that is the same all over
ROUGH_STEPS = 17  # of one that is not
# Numbers that the film's materials may have by the angle; colours beside them: base, emission, gloss.
NUMBERS = ("metallic", "roughness", "alpha", "transmission", "coat")
COLORS = ("base", "emission", "gloss")


def cosines(count):
    return np.linspace(0, 1, count) ** 2


def is_angled(socket):
    pending, known = [socket.node], set()
    while pending:
        node = pending.pop()
        if node.type in NODES:
            return True
        known.add(node.name)
        feeding = [s.node for s in map(incoming, node.inputs) if s is not None]
        pending += [n for n in feeding if n.name not in known]
    return False


def is_angled_alone(socket):
    """Whether it depends on nothing else."""
    return is_steady(socket, STEADY | NODES)


def reflectance(cosine, index):
    """Of a dielectric, without regard to polarisation."""
    beyond = index**2 - 1 + cosine**2
    g = np.sqrt(np.maximum(beyond, 0))
    a = (g - cosine) / np.maximum(g + cosine, 1e-9)
    b = (cosine * (g + cosine) - 1) / np.where(np.abs(cosine * (g - cosine) + 1) > 1e-9, cosine * (g - cosine) + 1, 1e-9)
    return np.where(beyond > 0, 0.5 * a**2 * (1 + b**2), 1.0)


def outputs_at(node, cosine):
    """What a node's outputs say of a front that is seen with these cosines."""
    if node.type == "FRESNEL":
        return {"Fac": reflectance(cosine, max(number_of(node.inputs["IOR"].default_value), 1e-5))}
    blend = number_of(node.inputs["Blend"].default_value)
    bent = min(max(blend, 0.0), 1 - 1e-5)
    power = 1.0 if blend == 0.5 else 2 * bent if bent < 0.5 else 0.5 / (1 - bent)
    return {"Fresnel": reflectance(cosine, 1 / max(1 - blend, 1e-5)), "Facing": 1 - cosine**power}


@contextlib.contextmanager
def seen_at(tree, cosine, socket):
    """What `socket` is where the nodes have their values at one cosine; along its coordinates, where many are named."""
    added, links, images = [], [], []
    for node in [n for n in tree.nodes if n.type in NODES]:
        for name, value in outputs_at(node, cosine).items():
            ends = [link.to_socket for link in node.outputs[name].links]
            if not ends and node.outputs[name] != socket:
                continue
            if np.ndim(value) == 0:
                source = tree.nodes.new("ShaderNodeValue")
                source.outputs[0].default_value = float(value)
            else:
                source = tree.nodes.new("ShaderNodeTexImage")
                source.image = bpy.data.images.new("render2mpeg angles", len(value), 1, float_buffer=True)
                source.image.colorspace_settings.name = "Non-Color"
                source.image.pixels.foreach_set(np.repeat(value, 4).astype(np.float32))
                source.interpolation, source.extension = "Closest", "EXTEND"
                images.append(source.image)
            added.append(source)
            links += [(node.outputs[name], end) for end in ends]
            for end in ends:
                tree.links.new(source.outputs[0], end)
            if node.outputs[name] == socket:
                socket = source.outputs[0]
    try:
        yield socket
    finally:
        for source in added:
            tree.nodes.remove(source)
        for image in images:
            bpy.data.images.remove(image)
        for start, end in links:
            tree.links.new(start, end)


def curve_of(table):
    """(own, other, share) of values by steps of the angle: the largest of each channel, the smallest, and the way between."""
    high, low = table.max(axis=0), table.min(axis=0)
    return high, low, np.where(high - low > 1e-6, (high - table) / np.maximum(high - low, 1e-6), 0.0)


def ends_of(pictures):
    """(number of one end, of the other, share, error) of pictures by steps of the angle: the two that differ most, the way
    of the rest between them, and what that leaves of the range, root mean square."""
    flat = np.array([p[..., :3].reshape(-1, 3) for p in pictures], dtype=float)
    centred = (flat - flat.mean(axis=0)).reshape(len(flat), -1)
    scores = np.linalg.eigh(centred @ centred.T)[1][:, -1]
    ends = sorted((int(np.argmax(scores)), int(np.argmin(scores))), key=lambda k: -flat[k].mean())
    own, other = (flat[k] for k in ends)
    way = other - own
    share = ((flat - own) * way).sum(axis=1) / np.maximum((way**2).sum(axis=0), 1e-12)
    share = np.clip(share, 0, 1)
    rest = flat - own - share[:, None] * way
    return *ends, share, float(np.sqrt((rest**2).mean()) / max(np.ptp(flat), 1e-6))
