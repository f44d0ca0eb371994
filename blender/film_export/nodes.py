# SPDX-License-Identifier: Apache-2.0 OR GPL-3.0-or-later
"""Node trees of materials: followed, and rewritten as far as that makes them simpler."""
import bpy


def incoming(socket):
    """The socket that feeds this one, past reroutes; None where nothing does."""
    while socket.is_linked and socket.links:
        link = socket.links[0]
        if link.is_muted or not link.is_valid:
            return None
        if link.from_node.type != "REROUTE":
            return link.from_socket
        socket = link.from_node.inputs[0]
    return None


# Nodes that give the same value all over a surface if their inputs do.
STEADY = {"RGB", "VALUE", "MATH", "MIX_RGB", "MIX", "VALTORGB", "HUE_SAT", "GAMMA", "BRIGHTCONTRAST", "INVERT", "RGBTOBW", "COMBRGB", "SEPRGB",
          "COMBINE_COLOR", "SEPARATE_COLOR", "COMBXYZ", "SEPXYZ", "CLAMP", "MAP_RANGE", "CURVE_RGB", "CURVE_FLOAT", "VECT_MATH", "BLACKBODY"}


def is_steady(socket, steady=STEADY):
    """Whether nothing that feeds a socket depends on where it is asked."""
    return socket.node.type in steady and all(is_steady(s, steady) for s in map(incoming, socket.node.inputs) if s is not None)


def is_level(socket):
    """Whether a socket's normals are the surface's own: a bump of one height."""
    node = socket.node
    if node.type != "BUMP" or incoming(node.inputs["Normal"]) is not None:
        return False
    height = incoming(node.inputs["Height"])
    return height is None or is_steady(height)


def output_of(tree):
    """The output node that Cycles shows."""
    node = tree.get_output_node("CYCLES")
    return node if node is not None else tree.get_output_node("ALL")


def copy_settings(source, target):
    """What a node is besides its links."""
    for prop in source.bl_rna.properties:
        if prop.is_readonly or prop.identifier in {"name", "select", "parent", "location", "location_absolute"}:
            continue
        try:
            setattr(target, prop.identifier, getattr(source, prop.identifier))
        except (AttributeError, TypeError):
            pass
    if hasattr(source, "color_ramp"):
        ramp, copy = source.color_ramp, target.color_ramp
        copy.color_mode, copy.interpolation, copy.hue_interpolation = ramp.color_mode, ramp.interpolation, ramp.hue_interpolation
        while len(copy.elements) > 1:
            copy.elements.remove(copy.elements[0])
        copy.elements[0].position, copy.elements[0].color = ramp.elements[0].position, ramp.elements[0].color
        for element in ramp.elements[1:]:
            copy.elements.new(element.position).color = element.color
    if hasattr(source, "mapping") and hasattr(source.mapping, "curves"):
        for curve, copy in zip(source.mapping.curves, target.mapping.curves):
            while len(copy.points) < len(curve.points):
                copy.points.new(0, 0)
            for point, other in zip(curve.points, copy.points):
                other.location, other.handle_type = point.location, point.handle_type
        target.mapping.update()
    for socket, copy in zip(source.inputs, target.inputs):
        if hasattr(socket, "default_value"):
            copy.default_value = socket.default_value


def inline_group(tree, group):
    """Replaces one group's node by what is in it."""
    inner = group.node_tree
    copies, ends = {}, {}
    for node in inner.nodes:
        if node.type in {"GROUP_INPUT", "GROUP_OUTPUT", "FRAME"}:
            continue
        copy = copies[node.name] = tree.nodes.new(node.bl_idname)
        copy_settings(node, copy)
    index = {s.identifier: i for i, s in enumerate(group.inputs)}
    outside = [incoming(s) for s in group.inputs]
    for link in inner.links:
        source, target = link.from_node, link.to_node
        if target.type == "GROUP_OUTPUT":
            if getattr(target, "is_active_output", True):
                ends[link.to_socket.identifier] = link
            continue
        if target.type == "FRAME" or target.name not in copies:
            continue
        entry = copies[target.name].inputs[list(target.inputs).index(link.to_socket)]
        if source.type == "GROUP_INPUT":
            feed(tree, group, index.get(link.from_socket.identifier), outside, entry)
        elif source.name in copies:
            tree.links.new(copies[source.name].outputs[list(source.outputs).index(link.from_socket)], entry)
    for socket in group.outputs:
        link = ends.get(socket.identifier)
        for out in [l.to_socket for l in socket.links]:
            if link is None:
                continue
            if link.from_node.type == "GROUP_INPUT":
                feed(tree, group, index.get(link.from_socket.identifier), outside, out)
            elif link.from_node.name in copies:
                tree.links.new(copies[link.from_node.name].outputs[list(link.from_node.outputs).index(link.from_socket)], out)
    tree.nodes.remove(group)


def feed(tree, group, number, outside, entry):
    """What comes in through a group's input."""
    if number is None:
        return
    if outside[number] is not None:
        tree.links.new(outside[number], entry)
    elif hasattr(entry, "default_value") and hasattr(group.inputs[number], "default_value"):
        value = group.inputs[number].default_value
        try:
            entry.default_value = value
        except (TypeError, ValueError):  # a number where a colour is asked, or the other way about
            number_of = value if isinstance(value, (int, float)) else sum(value[:3]) / 3
            width = len(entry.default_value) if hasattr(entry.default_value, "__len__") else 0
            entry.default_value = [number_of] * min(width, 3) + [1.0] * (width - 3) if width else number_of


def inline_groups(tree):
    for _ in range(1000):  # groups in groups
        group = next((n for n in tree.nodes if n.type == "GROUP" and n.node_tree), None)
        if group is None:
            return
        inline_group(tree, group)


def number_of(value):
    """A number for a socket's value: of colours the mean."""
    return float(value) if isinstance(value, (int, float)) else sum(value[:3]) / 3
