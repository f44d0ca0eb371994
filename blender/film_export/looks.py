# SPDX-License-Identifier: Apache-2.0 OR GPL-3.0-or-later
"""What a material's shaders come to: the inputs of one Principled-like surface, each a constant, an image, or a socket
whose value has to be baked."""
import math

import bpy

from . import rays
from .angles import COLORS, NODES, NUMBERS, is_angled
from .nodes import incoming, number_of


# Inputs that may be textures.
CHANNELS = ("base", "metallic", "roughness", "emission", "strength", "alpha", "transmission", "coat", "coat_roughness", "sheen",
            "specular_tint", "gloss")


def dipole_reflectance(root, ior):
    """Of a half space whose sqrt(3 (1 - albedo of scattering)) is `root`. [Jensen2001]"""
    inside = -1.44 / ior**2 + 0.71 / ior + 0.668 + 0.0636 * ior
    return 0.5 * (1 - root**2 / 3) * (1 + math.exp(-4 / 3 * (1 + inside) / (1 - inside) * root)) * math.exp(-root)


def free_path(radius, albedo, method, ior):
    """Mean free path of a channel for [Christensen2015, eq. 6], of what Cycles makes of a radius."""
    if method != "RANDOM_WALK":
        # The walk's path is the radius over 4 pi, by a convention of old; the profile's own is so long without regard to albedo.
        return radius / (4 * math.pi) * (1.9 - albedo + 3.5 * (albedo - 0.8) ** 2 if method == "BURLEY" else 1.0)
    # The radius is the diffuse path: [Jensen2001]'s reflectance is the albedo, and falls with the root.
    low, high = 0.0, math.sqrt(3)
    for _ in range(24):
        root = (low + high) / 2
        low, high = (root, high) if dipole_reflectance(root, ior) > albedo else (low, root)
    return radius * low


class Constant:
    def __init__(self, value):
        self.value = value

    def __eq__(self, other):
        return isinstance(other, Constant) and self.value == other.value


class Angled(Constant):
    """The same all over: `value` and `other`, and by steps of the angle (angles.py) the share of `other`."""

    def __init__(self, value, other, share):
        super().__init__(value)
        self.other, self.share = other, share


class Picture:
    """An image node's picture by a layer of coordinates: `channel` None for colour, else one of "RGBA"."""

    def __init__(self, node, channel, layer, transform):
        self.node, self.image, self.channel, self.layer, self.transform = node, node.image, channel, layer, transform


class Baked:
    def __init__(self, socket):
        self.socket = socket


class Look:
    def __init__(self, **channels):
        self.base, self.metallic, self.roughness = Constant((0.8, 0.8, 0.8)), Constant(0.0), Constant(1.0)
        self.emission, self.strength = Constant((0.0, 0.0, 0.0)), Constant(0.0)
        self.alpha, self.transmission = Constant(1.0), Constant(0.0)
        self.ior = 1.5
        self.coat, self.coat_roughness = Constant(0.0), Constant(0.0)
        self.sheen, self.sheen_roughness = Constant((0.0, 0.0, 0.0)), 0.5
        self.specular_tint = Constant((1.0, 1.0, 1.0))
        self.model = "gltf"         # whose Principled BSDF the inputs are of
        self.specular = 0.5         # Blender's level
        self.gloss = Constant((0.0, 0.0, 0.0))  # of a lobe that reflects alike from all sides, over the rest
        self.multiscatter = False
        self.coat_ior, self.coat_tint = 1.5, (1.0, 1.0, 1.0)
        self.diffuse_roughness = 0.0
        self.anisotropy, self.anisotropy_rotation = 0.0, 0.0  # glTF's strength, and radians from the tangent
        self.brushed = False                                  # about the object's axis, not along texture coordinates
        self.film, self.film_ior = 0.0, 1.3                   # nanometres of a thin film; 0: none
        self.leaf, self.leaf_color = 0.0, (1.0, 1.0, 1.0)     # diffuse light that leaves on the other side
        self.attenuation = None                               # (colour, distance) of light in a body
        self.normal = None    # (Picture, strength), or a socket to bake
        self.hair = None      # an animation file's parameters of fibres
        self.subsurface = None  # weight, radius, method and index of light below a surface, as Cycles has them
        self.surface = True   # False: reflects nothing
        self.refracts = False
        self.hole = False     # Holdout
        self.nowhere = False  # a volume alone
        self.animated = None  # (node's name, input's name) of the emission's strength
        self.__dict__.update(channels)

    def is_plain(self):
        """Whether it reflects, and nothing else."""
        return (self.surface and not (self.hair or self.subsurface or self.leaf or self.film or self.hole)
                and self.transmission == self.strength == self.coat == Constant(0.0) and self.alpha == Constant(1.0)
                and self.sheen == Constant((0.0, 0.0, 0.0)))

    def is_matt(self):
        """Whether it is a Diffuse BSDF."""
        shines = self.model != "gltf" and (self.specular, self.gloss) != (0.0, Constant((0.0, 0.0, 0.0)))
        return self.is_plain() and not shines and self.ior == 1.0 and self.metallic == Constant(0.0)

    def is_gloss(self):
        """Whether it is a Glossy BSDF."""
        return self.is_plain() and self.model == "principled-3" and self.specular == 0.0 and self.metallic == Constant(1.0)


def mapping_of(node):
    """KHR_texture_transform of a Mapping node; None where it has none."""
    if node.vector_type not in {"POINT", "TEXTURE"} or any(s.is_linked for s in node.inputs[1:]):
        return None
    place, turn, scale = (tuple(node.inputs[k].default_value) if k in node.inputs else (0, 0, 0) for k in ("Location", "Rotation", "Scale"))
    if node.vector_type == "TEXTURE" or abs(turn[0]) > 1e-6 or abs(turn[1]) > 1e-6:
        return None
    s, c = math.sin(turn[2]), math.cos(turn[2])
    offset = [-scale[1] * s + place[0], 1 - scale[1] * c - place[1]]
    return {"offset": offset, "rotation": turn[2], "scale": [scale[0], scale[1]]}


def place_of(node):
    """(layer or None for the main one, transform or None) of an image node's coordinates; None where they are others."""
    source, transform = incoming(node.inputs["Vector"]), None
    if source is not None and source.node.type == "MAPPING":
        transform = mapping_of(source.node)
        if transform is None:
            return None
        source = incoming(source.node.inputs["Vector"])
        if source is None:
            return None
    if source is None:
        return None, transform
    if source.node.type == "UVMAP" and not source.node.from_instancer:
        return source.node.uv_map or None, transform
    if source.node.type == "TEX_COORD" and source.name == "UV" and not source.node.from_instancer:
        return None, transform
    return None


def picture_of(socket, is_color):
    """A plain image that glTF can name; None where it cannot."""
    node, channel = socket.node, None
    if node.type in {"SEPARATE_COLOR", "SEPRGB"} and getattr(node, "mode", "RGB") == "RGB":
        channel = "RGB"[list(node.outputs).index(socket)]
        socket = incoming(node.inputs[0])
        if socket is None or socket.name != "Color":
            return None
        node = socket.node
    if node.type != "TEX_IMAGE" or node.image is None:
        return None
    if socket.name == "Alpha":
        channel = "A"
    image = node.image
    plain = (image.source == "FILE" and not image.is_float and node.projection == "FLAT" and node.extension in {"REPEAT", "EXTEND"}
             and image.size[0] > 0 and image.size[1] > 0)
    if not plain:
        return None
    encoded = image.colorspace_settings.name == "sRGB"
    if channel != "A" and encoded != (is_color and channel is None):
        return None
    place = place_of(node)
    return Picture(node, channel, *place) if place else None


class Reader:
    """Reads one material's tree (a copy without groups). What is not understood is told to `lost`."""

    def __init__(self, tree, material, lost):
        self.tree, self.material, self.lost = tree, material, lost

    def tell(self, node, reason):
        self.lost.add_of(self.material, reason, node)

    def value(self, socket, is_color=False):
        source = incoming(socket)
        if source is None:
            raw = socket.default_value
            return Constant(tuple(raw)[:3] if is_color and hasattr(raw, "__len__") else number_of(raw))
        if source.node.type in {"RGB", "VALUE"}:
            raw = source.default_value
            if is_color:
                return Constant(tuple(raw)[:3] if hasattr(raw, "__len__") else (raw,) * 3)
            return Constant(number_of(raw))
        return picture_of(source, is_color) or Baked(source)

    def input(self, node, names, is_color=False, otherwise=None):
        for name in names:
            if name in node.inputs:
                return self.value(node.inputs[name], is_color)
        return Constant(otherwise)

    def constant(self, node, names, otherwise):
        value = self.input(node, names, otherwise=otherwise)
        if isinstance(value, Constant):
            return value.value
        self.tell(node, f"texture of {names[0]}; its node's own value is used")
        return next(number_of(node.inputs[n].default_value) for n in names if n in node.inputs)

    def normal(self, node):
        source = incoming(node.inputs["Normal"]) if "Normal" in node.inputs else None
        if source is None:
            return None
        if source.node.type == "NORMAL_MAP" and source.node.space == "TANGENT":
            color, strength = incoming(source.node.inputs["Color"]), self.value(source.node.inputs["Strength"])
            picture = picture_of(color, False) if color is not None else None
            if isinstance(picture, Picture) and picture.channel is None and isinstance(strength, Constant):
                if source.node.uv_map and picture.layer is None:
                    picture.layer = source.node.uv_map
                return picture, strength.value
        return source

    def shader(self, socket):
        """The look of a shader's output."""
        node = socket.node
        reader = getattr(self, "read_" + node.type.lower(), None)
        if reader is not None:
            return reader(node)
        self.tell(node, f"shader {node.bl_label}; shown as a matt surface of its colour")
        return Look(base=self.input(node, ["Color"], True, (0.8, 0.8, 0.8)), ior=1.0)

    def read_bsdf_principled(self, node):
        look = Look(base=self.input(node, ["Base Color"], True), metallic=self.input(node, ["Metallic"], otherwise=0.0),
                    roughness=self.input(node, ["Roughness"]), alpha=self.input(node, ["Alpha"], otherwise=1.0),
                    emission=self.input(node, ["Emission Color", "Emission"], True, (0, 0, 0)),
                    strength=self.input(node, ["Emission Strength"], otherwise=1.0),
                    transmission=self.input(node, ["Transmission Weight", "Transmission"], otherwise=0.0),
                    normal=self.normal(node))
        look.animated = (node.name, "Emission Strength")
        look.ior = self.constant(node, ["IOR"], 1.45)
        look.refracts = look.transmission != Constant(0.0) and abs(look.ior - 1) > 1e-3
        look.model = "principled-4" if "Specular IOR Level" in node.inputs else "principled-3"
        look.specular = self.constant(node, ["Specular IOR Level", "Specular"], 0.5)
        look.multiscatter = node.distribution == "MULTI_GGX"
        look.diffuse_roughness = self.constant_or(node, ["Diffuse Roughness"], 0.0)
        self.read_layers(node, look)
        self.sink(node, look)
        self.frost(node, look)
        return look

    def frost(self, node, look):
        """Blender 3 has a roughness more of what is seen through a surface; clear ones share it with their reflection."""
        more = self.input(node, ["Transmission Roughness"], otherwise=0.0)
        if more == Constant(0.0) or look.transmission == Constant(0.0) or node.distribution != "GGX":
            return
        if all(isinstance(v, Constant) for v in (more, look.roughness, look.transmission)) and look.transmission.value > 0.5:
            look.roughness = Constant(1 - (1 - look.roughness.value) * (1 - more.value))
        else:
            self.tell(node, "another roughness of what is seen through it")

    def sink(self, node, look):
        """Light below the surface. Blender 3 scales the radius by the weight, and mixes the colours."""
        weight = self.constant_or(node, ["Subsurface Weight", "Subsurface"], 0.0)
        if not weight:
            return
        scale = self.constant_or(node, ["Subsurface Scale"], weight)
        if "Subsurface Color" in node.inputs:
            color = self.input(node, ["Subsurface Color"], True)
            if isinstance(color, Constant) and isinstance(look.base, Constant):
                look.base = Constant(tuple(b + weight * (s - b) for b, s in zip(look.base.value, color.value)))
            weight = 1.0
        self.spread(node, look, "Subsurface ", node.subsurface_method, weight, scale)

    def spread(self, node, look, prefix, method, weight, scale):
        if self.constant_or(node, [prefix + "Anisotropy"], 0.0):
            self.tell(node, "anisotropy of light below the surface")
        if node.inputs[prefix + "Radius"].is_linked:
            self.tell(node, "texture of how far light goes below the surface; the node's own value is used")
        # Blender 4 has other names for the same.
        methods = node.bl_rna.properties["subsurface_method" if prefix else "falloff"].enum_items.keys()
        if "RANDOM_WALK_SKIN" in methods:
            method = {"RANDOM_WALK": "RANDOM_WALK_FIXED_RADIUS", "RANDOM_WALK_SKIN": "RANDOM_WALK"}.get(method, method)
        look.subsurface = {"weight": weight, "radius": [scale * r for r in node.inputs[prefix + "Radius"].default_value], "method": method,
                           "ior": min(max(self.constant_or(node, [prefix + "IOR"], 1.4), 1.01), 3.8)}

    def read_subsurface_scattering(self, node):
        look = Look(base=self.input(node, ["Color"], True), ior=1.0, normal=self.normal(node))
        self.spread(node, look, "", node.falloff, 1.0, self.constant(node, ["Scale"], 1.0))
        return look

    def read_layers(self, node, look):
        """What lies on a Principled surface. Blender 3 has it in Disney's terms, 4 in OpenPBR's."""
        is_old = "Clearcoat" in node.inputs
        look.coat = self.scaled(self.input(node, ["Coat Weight", "Clearcoat"], otherwise=0.0), 0.25 if is_old else 1.0)
        look.coat_roughness = self.input(node, ["Coat Roughness", "Clearcoat Roughness"], otherwise=0.0)
        look.coat_ior = self.constant_or(node, ["Coat IOR"], 1.5)
        if "Coat Tint" in node.inputs:
            look.coat_tint = tuple(self.color(node, "Coat Tint"))
        look.sheen = self.sheen_of(node, look)
        look.sheen_roughness = self.constant_or(node, ["Sheen Roughness"], 0.5)
        look.specular_tint = self.tinted(node, "Specular Tint", look.base)
        strength = self.constant_or(node, ["Anisotropic"], 0.0)
        self.brush(node, look, strength, math.sqrt(1 - 0.9 * min(abs(strength), 1.0)), self.constant_or(node, ["Anisotropic Rotation"], 0.0))
        look.film = self.constant_or(node, ["Thin Film Thickness"], 0.0)
        look.film_ior = self.constant_or(node, ["Thin Film IOR"], 1.3)

    def constant_or(self, node, names, otherwise):
        return self.constant(node, names, otherwise) if any(n in node.inputs for n in names) else otherwise

    def tinted(self, node, name, base):
        """A colour as it is given, or white mixed with the base's by a share of it."""
        if not hasattr(node.inputs[name].default_value, "__len__"):
            share = self.constant(node, [name], 0.0)
            if share == 0 or not isinstance(base, Constant):
                return Constant((1.0, 1.0, 1.0))
            luminance = sum(c * w for c, w in zip(base.value, (0.3, 0.6, 0.1)))  # Disney's
            hue = [c / luminance if luminance > 0 else 1.0 for c in base.value]
            return Constant(tuple(1 - share + share * h for h in hue))
        return self.input(node, [name], True)

    def sheen_of(self, node, look):
        weight = self.input(node, ["Sheen Weight", "Sheen"], otherwise=0.0)
        if weight == Constant(0.0):
            return Constant((0.0, 0.0, 0.0))
        tint = self.tinted(node, "Sheen Tint", look.base)
        if isinstance(weight, Constant) and isinstance(tint, Constant):
            return Constant(tuple(weight.value * c for c in tint.value))
        return self.product(weight, tint)

    def product(self, *values):
        mixed = self.tree.nodes.new("ShaderNodeMixRGB")
        mixed.blend_type = "MULTIPLY"
        mixed.inputs[0].default_value = 1.0
        for value, entry in zip(values, mixed.inputs[1:]):
            self.feed(value, entry)
        return Baked(mixed.outputs[0])

    def tell_angles(self, look):
        """What the film has no curve of."""
        for node in self.tree.nodes:
            if node.type in NODES and any(s.is_linked for s in node.inputs if s.name != "Normal"):
                self.tell(node, "texture of its curve; the node's own value is used")
        if isinstance(look.strength, Baked) and is_angled(look.strength.socket):
            look.emission, look.strength, look.animated = self.product(look.emission, look.strength), Constant(1.0), None
        for name in CHANNELS:
            value = getattr(look, name)
            if isinstance(value, Baked) and is_angled(value.socket) and name not in COLORS + NUMBERS:
                self.tell(value.socket.node, f"{name.replace('_', ' ')} by the angle; as seen at one angle")

    def scaled(self, value, factor):
        if isinstance(value, Constant) or factor == 1.0:
            return Constant(value.value * factor) if isinstance(value, Constant) else value
        node = self.tree.nodes.new("ShaderNodeMath")
        node.operation = "MULTIPLY"
        node.inputs[1].default_value = factor
        self.tree.links.new(socket_of(self.tree, value), node.inputs[0])
        return Baked(node.outputs[0])

    def feed(self, value, entry):
        if isinstance(value, Constant):
            entry.default_value = (*value.value, 1.0) if isinstance(value.value, tuple) else (value.value,) * 3 + (1.0,)
        else:
            self.tree.links.new(socket_of(self.tree, value), entry)

    def brush(self, node, look, strength, aspect, turns):
        """Cycles' lobe is alpha / aspect by alpha * aspect wide, glTF's alpha + (1 - alpha) strength^2 by alpha."""
        if not strength:
            return
        if not isinstance(look.roughness, Constant):
            look.anisotropy = math.sqrt(abs(strength))
        else:
            alpha = look.roughness.value ** 2
            narrow, wide = alpha * aspect, min(alpha / aspect, 1.0)
            look.roughness = Constant(math.sqrt(narrow))
            look.anisotropy = math.sqrt(max(wide - narrow, 0.0) / max(1 - narrow, 1e-6))
        look.brushed = incoming(node.inputs["Tangent"]) is None
        look.anisotropy_rotation = 2 * math.pi * turns + (math.pi / 2 if strength < 0 else 0.0)

    def read_bsdf_hair_principled(self, node):
        if getattr(node, "model", "CHIANG") != "CHIANG":
            self.tell(node, "hair of the Huang model; shown by Chiang's, with round fibres")
        hair = {key: self.constant(node, [name], value) for key, name, value in (
            ("roughness", "Roughness", 0.3), ("azimuthal_roughness", "Radial Roughness", 0.3), ("coat", "Coat", 0.0), ("ior", "IOR", 1.55))}
        hair["tilt"] = math.degrees(self.constant(node, ["Offset"], math.radians(2)))
        if any(self.constant_or(node, [name], 0.0) for name in ("Random Color", "Random Roughness")):
            self.tell(node, "random colour or roughness of hair; all strands have the mean's")
        color = self.color(node, "Tint" if node.parametrization == "MELANIN" else "Color")
        if node.parametrization == "ABSORPTION":
            hair["absorption"] = list(node.inputs["Absorption Coefficient"].default_value)
        elif node.parametrization == "MELANIN":
            hair["melanin"], hair["redness"] = self.constant(node, ["Melanin"], 0.8), self.constant(node, ["Melanin Redness"], 1.0)
        if node.parametrization == "COLOR" or (node.parametrization == "MELANIN" and min(color) < 1):
            hair["color"] = color
        return Look(base=Constant(tuple(color)), ior=1.0, hair={k: v if isinstance(v, list) else round(v, 6) for k, v in hair.items()})

    def color(self, node, name):
        """A colour that is no texture."""
        value = self.value(node.inputs[name], True)
        if not isinstance(value, Constant):
            self.tell(node, f"texture of {name}; its node's own value is used")
            value = Constant(tuple(node.inputs[name].default_value)[:3])
        return [round(min(max(c, 0.0), 1.0), 6) for c in value.value]

    def read_bsdf_diffuse(self, node):
        look = Look(base=self.input(node, ["Color"], True), ior=1.0, normal=self.normal(node),
                    diffuse_roughness=self.constant(node, ["Roughness"], 0.0))
        if look.diffuse_roughness and bpy.app.version >= (4, 3, 0):  # light goes on among its facets
            look.model, look.specular = "principled-4", 0.0
        return look

    def read_bsdf_glossy(self, node):
        """A metal whose edges reflect as its middle does."""
        return Look(base=self.input(node, ["Color", "Base Color"], True), metallic=Constant(1.0), roughness=self.glossiness(node), normal=self.normal(node),
                    model="principled-3", specular=0.0, multiscatter=getattr(node, "distribution", "") == "MULTI_GGX")

    def read_bsdf_anisotropic(self, node):
        look = self.read_bsdf_glossy(node)
        strength = self.constant_or(node, ["Anisotropy"], 0.0)
        # Narrow along the tangent, where the Principled BSDF is wide.
        self.brush(node, look, -strength, 1 - min(abs(strength), 0.99), self.constant_or(node, ["Rotation"], 0.0))
        return look

    def read_bsdf_metallic(self, node):
        self.tell(node, "reflectance that depends on the angle; it is the same from all sides")
        look = self.read_bsdf_glossy(node)
        if getattr(node, "fresnel_type", "") == "PHYSICAL_CONDUCTOR":
            # Fresnel's reflectance of a conductor, straight on.
            index, extinction = (self.input(node, [name], True) for name in ("IOR", "Extinction"))
            if isinstance(index, Constant) and isinstance(extinction, Constant):
                squares = [((n - 1) ** 2 + k**2, (n + 1) ** 2 + k**2) for n, k in zip(index.value, extinction.value)]
                look.base = Constant(tuple(a / b for a, b in squares))
        return look

    def read_bsdf_translucent(self, node):
        look = Look(base=self.input(node, ["Color"], True), ior=1.0, normal=self.normal(node), leaf=1.0)
        if isinstance(look.base, Constant):
            look.leaf_color = look.base.value
        return look

    def read_bsdf_sheen(self, node):
        rough = self.constant_or(node, [n for n in ("Roughness", "Sigma") if n in node.inputs], 0.5)
        look = Look(base=Constant((0.0, 0.0, 0.0)), ior=1.0, sheen=self.input(node, ["Color"], True), sheen_roughness=rough)
        if getattr(node, "distribution", "") == "MICROFIBER":
            look.model, look.specular = "principled-4", 0.0
        else:
            self.tell(node, f"{node.bl_label}; shown by glTF's fibres")
        return look

    read_bsdf_velvet = read_bsdf_sheen

    def glossiness(self, node):
        if getattr(node, "distribution", "") == "SHARP":
            return Constant(0.0)
        return self.input(node, ["Roughness"], otherwise=0.0)

    def read_bsdf_glass(self, node):
        return Look(base=self.input(node, ["Color"], True), transmission=Constant(1.0), roughness=self.glossiness(node),
                    ior=self.constant(node, ["IOR"], 1.45), normal=self.normal(node), refracts=True)

    def read_bsdf_refraction(self, node):
        self.tell(node, "refraction without reflection; it reflects as glass does")
        return self.read_bsdf_glass(node)

    def read_bsdf_transparent(self, node):
        return Look(base=Constant((0.0, 0.0, 0.0)), alpha=Constant(0.0), surface=False)

    def read_holdout(self, node):
        return Look(base=Constant((0.0, 0.0, 0.0)), ior=1.0, hole=True)

    def read_emission(self, node):
        return Look(base=Constant((0.0, 0.0, 0.0)), ior=1.0, emission=self.input(node, ["Color"], True),
                    strength=self.input(node, ["Strength"]), surface=False, animated=(node.name, "Strength"))

    read_background = read_emission

    def read_add_shader(self, node):
        looks = [self.shader(s) for s in (incoming(i) for i in node.inputs[:2]) if s is not None]
        if not looks:
            return Look(base=Constant((0.0, 0.0, 0.0)), ior=1.0)
        looks.sort(key=lambda look: not look.surface)
        first = looks[0]
        if len(looks) > 1:
            second = looks[1]
            sum_of_both = self.glossed(first, second, 1.0, 1.0)
            if sum_of_both is not None:
                return sum_of_both
            if second.surface or first.strength != Constant(0.0) and first.emission != Constant((0.0, 0.0, 0.0)):
                self.tell(node, "sum of two shaders; only the first is kept")
            else:
                first.emission, first.strength, first.animated = second.emission, second.strength, second.animated
        return first

    def read_mix_shader(self, node):
        shaders = [incoming(i) for i in node.inputs[1:3]]
        looks = [self.shader(s) if s is not None else Look(base=Constant((0.0, 0.0, 0.0)), ior=1.0) for s in shaders]
        factor = self.value(node.inputs[0])
        if isinstance(factor, Constant) and factor.value in (0.0, 1.0):
            return looks[int(factor.value)]
        source = incoming(node.inputs[0])
        if all(s is not None for s in shaders) and shaders[0].node.type == "BSDF_TRANSPARENT" and looks[1].surface:
            index = self.index_of(source)
            if index is not None:  # a pane as architects have it
                return Look(base=self.input(shaders[0].node, ["Color"], True), transmission=Constant(1.0), roughness=looks[1].roughness,
                            ior=index, normal=looks[1].normal)
        clear = [look.alpha == Constant(0.0) for look in looks]
        if clear[0] != clear[1]:
            return self.cut_out(node, looks[0] if clear[1] else looks[1], factor, clear[1])
        sum_of_both = None
        if isinstance(factor, Constant):
            sum_of_both = self.glossed(*looks, 1 - factor.value, factor.value)
        elif is_angled(source):
            sum_of_both = self.glossed(*looks, self.rest_of(source), source)
        return sum_of_both or self.mixed(node, looks, node.inputs[0])

    def index_of(self, source):
        """Of refraction, where a factor is Fresnel's; else None."""
        if source is None or source.node.type not in NODES or source.name == "Facing":
            return None
        if source.node.type == "FRESNEL":
            return self.constant(source.node, ["IOR"], 1.5)
        return 1 / max(1 - self.constant(source.node, ["Blend"], 0.5), 1e-5)

    def rest_of(self, source):
        rest = self.tree.nodes.new("ShaderNodeMath")
        rest.operation = "SUBTRACT"
        rest.inputs[0].default_value = 1.0
        self.tree.links.new(source, rest.inputs[1])
        return rest.outputs[0]

    def glossed(self, first, second, a, b):
        """Shares (numbers, or sockets) of a Diffuse BSDF and of a Glossy one, or of two Diffuse ones, as one surface; None for
        others."""
        def scaled(look, share):
            return Constant(tuple(min(share * c, 1.0) for c in look.base.value)) if isinstance(share, float) else self.product(look.base, Baked(share))
        if not all(isinstance(look.base, Constant) for look in (first, second)):
            return None
        if first.is_gloss() and second.is_matt():
            first, second, a, b = second, first, b, a
        if not first.is_matt() or first.diffuse_roughness != second.diffuse_roughness and second.is_matt():
            return None
        if second.is_matt() and isinstance(a, float):
            first.base = Constant(tuple(min(x + y, 1.0) for x, y in zip(scaled(first, a).value, scaled(second, b).value)))
            return first
        if not second.is_gloss():
            return None
        second.base, second.gloss, second.metallic = scaled(first, a), scaled(second, b), Constant(0.0)
        second.model, second.diffuse_roughness = "principled-4", first.diffuse_roughness  # whose diffuse part is Lambert's
        second.normal = second.normal or first.normal
        return second

    def cut_out(self, node, look, factor, flipped):
        """A shader mixed with nothing."""
        if look.alpha != Constant(1.0):
            self.tell(node, "transparency in transparency; only the outer one is kept")
        look.alpha = factor
        if flipped:
            if isinstance(factor, Constant):
                look.alpha = Constant(1 - factor.value)
            else:
                source = factor.socket if isinstance(factor, Baked) else factor.node.outputs["Alpha" if factor.channel == "A" else "Color"]
                look.alpha = Baked(self.rest_of(source))
        return look

    def mixed(self, node, looks, factor):
        """Each input mixed by itself."""
        first, second = looks
        out = Look(normal=first.normal or second.normal, surface=first.surface or second.surface)
        total = self.value(factor)
        share = total.value if isinstance(total, Constant) else 0.5
        models = ({look.model for look in looks if not look.is_matt()} or {look.model for look in looks if look.diffuse_roughness}
                  or {"gltf"})
        if len(models) > 1:
            self.tell(node, "mix of shaders of different models; all of it is that of the heavier part")
        out.model = models.pop() if len(models) == 1 else (first if share <= 0.5 else second).model
        # A Diffuse BSDF has no gloss, in whose terms ever.
        levels = [0.0 if look.is_matt() and out.model != "gltf" else look.specular for look in looks]
        out.specular = levels[0] * (1 - share) + levels[1] * share
        ior = [second.ior if first.is_matt() and out.model != "gltf" else first.ior, first.ior if second.is_matt() and out.model != "gltf" else second.ior]
        out.ior = ior[0] * (1 - share) + ior[1] * share
        out.multiscatter = first.multiscatter or second.multiscatter
        for name in ("diffuse_roughness", "coat_ior", "sheen_roughness", "anisotropy", "anisotropy_rotation", "film", "film_ior", "leaf"):
            setattr(out, name, getattr(first, name) * (1 - share) + getattr(second, name) * share)
        out.coat_tint = (first if first.coat != Constant(0.0) else second).coat_tint
        out.leaf_color = second.leaf_color if second.leaf else first.leaf_color
        out.refracts, out.attenuation = first.refracts or second.refracts, first.attenuation or second.attenuation
        heavier, lighter = looks if share <= 0.5 else looks[::-1]
        out.hair, out.subsurface = heavier.hair or lighter.hair, heavier.subsurface or lighter.subsurface
        if (first.hair, first.subsurface) != (second.hair, second.subsurface):
            self.tell(node, "mix of fibres or light below surfaces with others; the heavier part's are kept")
        for name in CHANNELS:
            a, b = getattr(first, name), getattr(second, name)
            # What only one of them has is that one's: black emits nothing, whatever its colour.
            if name == "emission":
                a, b = (b, b) if first.strength == Constant(0.0) else (a, a) if second.strength == Constant(0.0) else (a, b)
            if name == "coat_roughness":
                a, b = (b, b) if first.coat == Constant(0.0) else (a, a) if second.coat == Constant(0.0) else (a, b)
            if name == "base" and first.leaf != second.leaf:
                out.base = a if first.leaf < second.leaf else b
                continue
            if name in {"base", "roughness"} and first.surface != second.surface:
                out.__dict__[name] = a if first.surface else b
                continue
            if name == "roughness" and first.is_matt() != second.is_matt():
                out.roughness = b if first.is_matt() else a
                continue
            out.__dict__[name] = self.between(a, b, factor, total)
        if first.surface != second.surface:
            out.surface = True
            dim = self.between(*((out.base, Constant((0.0, 0.0, 0.0))) if first.surface else (Constant((0.0, 0.0, 0.0)), out.base)),
                               factor, total)
            out.base = dim
        return out

    def between(self, a, b, factor, total):
        if isinstance(a, Constant) and isinstance(b, Constant):
            if a == b:
                return a
            if isinstance(total, Constant):
                t = total.value
                if isinstance(a.value, tuple):
                    return Constant(tuple(x * (1 - t) + y * t for x, y in zip(a.value, b.value)))
                return Constant(a.value * (1 - t) + b.value * t)
        node = self.tree.nodes.new("ShaderNodeMixRGB")
        source = incoming(factor)
        if source is not None:
            self.tree.links.new(source, node.inputs[0])
        else:
            node.inputs[0].default_value = factor.default_value
        for value, entry in zip((a, b), node.inputs[1:]):
            self.feed(value, entry)
        return Baked(node.outputs[0])


def socket_of(tree, value):
    """The socket that gives a picture's or a baked value."""
    if isinstance(value, Baked):
        return value.socket
    if value.channel is None or value.channel == "A":
        return value.node.outputs["Alpha" if value.channel == "A" else "Color"]
    node = tree.nodes.new("ShaderNodeSeparateRGB")
    tree.links.new(value.node.outputs["Color"], node.inputs[0])
    return node.outputs["RGB".index(value.channel)]


def look_of(material, tree, lost):
    """The look of a material, whose tree is a copy without groups."""
    from .nodes import output_of
    reader = Reader(tree, material, lost)
    end = output_of(tree)
    if end is None:
        return Look(base=Constant((0.0, 0.0, 0.0)), ior=1.0)
    rays.tell(end, reader.tell)
    rays.look_from_camera(tree)
    volume = incoming(end.inputs["Volume"])
    raised = incoming(end.inputs["Displacement"])
    if raised is not None:
        reader.tell(raised.node, "displacement of the surface; it stays smooth")
    surface = incoming(end.inputs["Surface"])
    if surface is None:
        return Look(base=Constant((0.0, 0.0, 0.0)), ior=1.0, alpha=Constant(0.0 if end.inputs["Volume"].is_linked else 1.0), nowhere=volume is not None)
    look = reader.shader(surface)
    reader.tell_angles(look)
    look.attenuation = attenuation_of(reader, volume.node, look) if volume is not None else None
    if volume is not None and look.attenuation is None:
        reader.tell(volume.node, "volume within the surface" + ("" if look.refracts else ", which is no glass"))
    return look


def attenuation_of(reader, node, look):
    """(colour, distance) of light in glass that absorbs: per scene unit `density` (1 - colour); None where it does something else."""
    if node.type == "ADD_SHADER":
        parts = [attenuation_of(reader, s.node, look) for s in (incoming(i) for i in node.inputs[:2]) if s is not None]
        if not parts or None in parts:
            return None
        lost = [sum(-math.log(max(p[0][c], 1e-30)) / p[1] for p in parts) for c in range(3)]
        return tuple(math.exp(-v / max(*lost, 1e-9)) for v in lost), 1 / max(*lost, 1e-9)
    if node.type not in {"VOLUME_ABSORPTION", "PRINCIPLED_VOLUME"} or not look.refracts:
        return None
    color, density = reader.input(node, ["Color"], True), reader.input(node, ["Density"], otherwise=1.0)
    if not isinstance(color, Constant) or not isinstance(density, Constant) or density.value <= 0:
        return None
    kept = [min(max(c, 0.0), 1.0) for c in color.value]
    if node.type == "PRINCIPLED_VOLUME":
        absorbed = reader.input(node, ["Absorption Color"], True)
        if max(kept) > 0.0 or not isinstance(absorbed, Constant):
            return None  # it scatters
        kept = [max(c, 0.0) ** 0.5 for c in absorbed.value]
    return tuple(math.exp(-(1 - c)) for c in kept), 1 / density.value


def without_bakes(look):
    """A look whose baked inputs have some value instead."""
    usual = Look(base=Constant((0.5, 0.5, 0.5)), roughness=Constant(0.5))
    out = Look(**look.__dict__)
    for name, value in look.__dict__.items():
        if isinstance(value, Baked):
            setattr(out, name, getattr(usual, name))
    if out.normal is not None and not isinstance(out.normal, tuple):
        out.normal = None
    return out
