# SPDX-License-Identifier: Apache-2.0 OR GPL-3.0-or-later
"""Values of nodes that no texture can hold: what depends on the ray that asks, on the eye, or on other things."""
from .nodes import incoming

PLACE = "is baked as seen from one place"
MAKER = "is of what an object is made from; baked without it"
OTHERS = "depends on other things; baked without them"
# By a node's type: the outputs, None for all, and why the film's are others.
LOST = {
    "LIGHT_PATH": (None, "tells rays apart; all see what cameras see"),
    "CAMERA": (None, PLACE),
    "NEW_GEOMETRY": ({"Incoming", "Backfacing"}, PLACE),
    "TEX_COORD": ({"Camera", "Window", "Reflection"}, PLACE),
    "VECT_TRANSFORM": (None, "turns by the camera; baked without it"),
    "AMBIENT_OCCLUSION": (None, OTHERS),
    "BEVEL": (None, "is chosen by random rays; baked, some 3 % brighter or darker"),
    "OBJECT_INFO": ({"Random"}, MAKER),
    "PARTICLE_INFO": (None, MAKER),
    "HAIR_INFO": (None, MAKER),
    "POINT_INFO": (None, MAKER),
    "VOLUME_INFO": (None, MAKER),
    "ATTRIBUTE": (None, MAKER),
    "TEX_POINTDENSITY": (None, OTHERS),
    "LIGHT_FALLOFF": (None, "is of lamps"),
    "SHADERTORGB": (None, "is of EEVEE; Cycles has none"),
    "SCRIPT": (None, "is a program, which is not executed"),
}


def is_kept(node):
    """Whether it is the film's after all."""
    if node.type == "ATTRIBUTE":
        return node.attribute_type == "GEOMETRY"
    return node.type == "VECT_TRANSFORM" and "CAMERA" not in {node.convert_from, node.convert_to}


def feeding(end):
    """Nodes on the way to a surface, and the sockets by which they feed it."""
    pending, found = [incoming(end.inputs[name]) for name in ("Surface", "Displacement")], {}
    while pending:
        socket = pending.pop()
        if socket is None:
            continue
        if socket.node.name not in found:
            found[socket.node.name] = socket.node, set()
            pending += map(incoming, socket.node.inputs)
        found[socket.node.name][1].add(socket.name)
    return found.values()


# What differs between objects of one shape.
OWN = {"OBJECT_INFO": {"Location", "Color", "Alpha", "Object Index"}, "NEW_GEOMETRY": {"Position", "Normal", "True Normal", "Tangent"}}


def differing(end):
    """A node whose value differs between objects of one shape; None without one."""
    for node, outputs in feeding(end):
        if outputs & OWN.get(node.type, set()) or node.type == "TEX_COORD" and node.object is not None and "Object" in outputs:
            return node
    return None


def tell(end, told):
    """`told(node, reason)` for each that is lost."""
    for node, outputs in feeding(end):
        lost, reason = LOST.get(node.type, (set(), ""))
        if is_kept(node):
            continue
        for name in sorted(outputs if lost is None else outputs & lost):
            told(node, f"{name} {reason}")


def look_from_camera(tree):
    """Rays of all kinds are a camera's."""
    for node in [n for n in tree.nodes if n.type == "LIGHT_PATH"]:
        for output in node.outputs:
            ends = [link.to_socket for link in output.links]
            for end in ends:
                source = tree.nodes.new("ShaderNodeValue")
                source.outputs[0].default_value = 1.0 if output.name == "Is Camera Ray" else 0.0
                tree.links.new(source.outputs[0], end)
