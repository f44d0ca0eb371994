# SPDX-License-Identifier: Apache-2.0 OR GPL-3.0-or-later
"""Materials as glTF's: constants, the .blend's own images, and baked ones."""
import os
import re

import bpy
import numpy as np

from . import angles, png
from .baking import are_level
from .hair import Strands
from .looks import CHANNELS, Angled, Baked, Constant, Picture, free_path, look_of, without_bakes
from .nodes import inline_groups, number_of
from .shapes import BAKE_UV
from .walk import curves_of

# Where each field of the renderer's materials (src/scene/model/material.h) comes from; None: Blender has nothing like it.
FIELDS = {
    "name": "the material's", "model": "the version", "specular_level": "specular", "multiscatter": "distribution", "gloss": "gloss",
    "coat_ior": "coat_ior", "coat_tint": "coat_tint", "diffuse_roughness": "diffuse_roughness", "base_color": "base, alpha", "base_color_texture": "base, alpha", "metallic": "metallic",
    "roughness": "roughness", "metallic_roughness_texture": "metallic, roughness", "specular_glossiness": None, "specular": None,
    "glossiness": None, "specular_glossiness_texture": None, "normal_texture": "normal", "normal_scale": "normal",
    "emission": "emission, strength", "emission_texture": "emission, strength", "alpha_mode": "blend method",
    "alpha_texture": "in base_color_texture", "alpha_cutoff": "alpha_threshold", "double_sided": "whether the shape is closed",
    "unlit": None, "transmission": "transmission", "transmission_texture": "transmission", "ior": "ior",
    "thickness": "refracts, where the shape is closed", "attenuation_color": "volume absorption",
    "attenuation_distance": "volume absorption", "dispersion": None, "specular_weight": None,
    "specular_weight_texture": None, "specular_tint": "specular_tint", "specular_tint_texture": "specular_tint", "coat": "coat",
    "coat_texture": "coat", "coat_roughness": "coat_roughness", "coat_roughness_texture": "coat_roughness", "sheen": "sheen",
    "sheen_texture": "sheen", "sheen_roughness": "sheen_roughness", "sheen_roughness_texture": None,
    "iridescence": "film", "iridescence_texture": None, "film_ior": "film_ior", "film_thinnest": "film", "film_thickest": "film",
    "film_texture": None, "holdout": "hole", "seen": "visible_camera", "mirrored": None, "anisotropy": "anisotropy", "anisotropy_rotation": "anisotropy_rotation", "anisotropy_texture": None,
    "diffuse_transmission": "leaf", "diffuse_transmission_texture": None, "diffuse_transmission_color": "leaf_color",
    "diffuse_transmission_color_texture": None, "hair": "hair", "subsurface": "subsurface",
    "by_angle": "Layer Weight, Fresnel", "other_base_color_texture": "likewise", "other_emission_texture": "likewise",
}
READ_AS_THEY_ARE = {".png", ".jpg", ".jpeg", ".bmp", ".tga", ".tif", ".tiff", ".webp"}


class Told:
    """A texture: an image's index, its layer of coordinates (a name, None: the main one) and its place."""

    def __init__(self, image, layer, transform=None, clamped=False):
        self.image, self.layer, self.transform, self.clamped = image, layer, transform, clamped


class Materials:
    """glTF materials of a .blend's, each made when a shape first asks for it."""

    def __init__(self, glb, folder, baker, lost):
        self.glb, self.folder, self.baker, self.lost = glb, folder, baker, lost
        self.looks, self.made, self.images, self.textures = {}, {}, {}, {}
        self.baked = {}     # (mesh, material) -> channel -> pixels
        self.alike = {}     # (mesh, material) -> the first mesh on which the material has the same pixels
        self.first = {}     # (material, hash of rounded pixels) -> that mesh
        self.holes = []     # names of glTF materials
        self.by_angle = {}  # glTF material's name -> an animation file's curves
        self.strengths = {} # glTF material's name -> (material, node, input, factor at first)

    # Before the walk: what only Cycles can tell.

    def look(self, material):
        """(look, copy of the material) or None for no nodes at all."""
        known = self.looks.get(material.name_full)
        if known is None:
            copy = material.copy()
            if copy.use_nodes and copy.node_tree is not None:
                inline_groups(copy.node_tree)
                look = look_of(material, copy.node_tree, self.lost)
                self.bend(look, copy)
            else:
                from .looks import Look
                look = Look(base=Constant(tuple(material.diffuse_color)[:3]), metallic=Constant(float(material.metallic)),
                            roughness=Constant(float(material.roughness)))
            known = self.looks[material.name_full] = (look, copy)
            if not known[0].nowhere:  # media tell their own
                self.tell_motion(material)
        return known

    def bend(self, look, copy):
        """Bakes what depends on the angle alone."""
        for name in angles.COLORS + angles.NUMBERS:
            value = getattr(look, name)
            if isinstance(value, Baked) and angles.is_angled(value.socket) and angles.is_angled_alone(value.socket):
                table = self.baker.by_angle(copy, value.socket)
                own, other, share = angles.curve_of(table)
                if name in angles.NUMBERS:
                    own, other, share = own.mean(), other.mean(), share.mean(axis=1)
                own = float(own) if name in angles.NUMBERS else tuple(own.tolist())
                setattr(look, name, Angled(own, other.tolist(), share.tolist()))

    def tell_motion(self, material, followed=()):
        """Tells what moves by keys or drivers and is not followed, but for nodes of these names."""
        tree = material.node_tree
        if tree is None or tree.animation_data is None:
            return
        animation = tree.animation_data
        curves = curves_of(animation)
        look = self.looks[material.name_full][0]
        follows = f'nodes["{look.animated[0]}"]' if look.animated else None
        for curve in curves:
            if follows and curve.data_path.startswith(follows) and isinstance(look.strength, Constant):
                node = tree.nodes.get(look.animated[0])
                where = list(node.inputs).index(node.inputs[look.animated[1]])
                if curve.data_path == f"{follows}.inputs[{where}].default_value":
                    continue
            if any(curve.data_path.startswith(f'nodes["{bpy.utils.escape_identifier(name)}"]') for name in followed):
                continue
            self.lost.add_of(material, f"animated {curve.data_path}; as on the first frame")

    def needs_bake(self, look):
        sources = [getattr(look, name) for name in CHANNELS]
        return any(isinstance(s, Baked) for s in sources) or (look.normal is not None and not isinstance(look.normal, tuple))

    def share(self, mesh_name, material):
        """Makes one material of those whose textures came out alike, such as those that have none."""
        name, own = material.name_full, self.baked[mesh_name, material.name_full]
        looks = tuple((n, own[n].shape, (np.round(own[n] * 4096) + 0.0).tobytes()) for n in sorted(own))
        self.alike[mesh_name, name] = self.first.setdefault((name, hash(looks)), mesh_name)

    # While shapes are written.

    def index(self, material, mesh_name, thing, closed, shape):
        """(index of the glTF material, names of its layers of coordinates)."""
        if material is None:
            return self.plain(), [None]
        look, _ = self.look(material)
        baked = self.baked.get((mesh_name, material.name_full))
        if baked is None and self.needs_bake(look):
            self.lost.add_of(material, "textures that cannot be baked on this shape; grey", thing=thing)
            look = without_bakes(look)
        if look.hair and not isinstance(shape, Strands):
            self.lost.add_of(material, "scattering of hair on a surface, which is no hair", thing=thing)
        shines = look.strength != Constant(0.0) and look.emission != Constant((0.0, 0.0, 0.0))
        sides = closed and shines
        body = closed and look.refracts
        if look.refracts and not closed and not shape.is_sheet():
            self.lost.add_of(material, "refraction: the shape is open, so that its glass is a thin pane; close its holes (Mesh > Clean Up > "
                             "Fill Holes), give it a Solidify modifier, or turn its normals outwards", thing=thing)
        mesh_name = self.alike.get((mesh_name, material.name_full), mesh_name) if self.needs_bake(look) else None
        key = (material.name_full, mesh_name, sides, body)
        if key not in self.made:
            self.made[key] = self.make(material, look, baked or {}, not sides, body)
        return self.made[key]

    def write_more(self, film):
        """What glTF has no words for: Blender's models, fibres of hair, light below surfaces."""
        for key, made in self.made.items():
            if key is None:  # of what has no material
                continue
            look = self.looks[key[0]][0]
            model = self.model_of(look, self.baked.get((key[1], key[0]), {}))
            name = self.glb.document["materials"][made[0]]["name"]
            if name in self.by_angle:
                model["by_angle"] = self.by_angle[name]
            if not (look.hair or look.subsurface or model):
                continue
            says = film.setdefault("materials", {}).setdefault(name, {})
            says.update(model)
            if look.hair:
                says["hair"] = look.hair
            if look.subsurface:
                below, base = look.subsurface, self.mean_base(look, self.baked.get((key[1], key[0]), {}).get("base"))
                says["subsurface"] = {"weight": round(below["weight"], 6), "free_path": [
                    round(free_path(r, a, below["method"], below["ior"]), 9) for r, a in zip(below["radius"], base)]}

    def model_of(self, look, baked):
        """Whose Principled BSDF it is, and the inputs that glTF lacks."""
        says = {}
        if look.model != "gltf":
            says = {"model": look.model, "specular": round(min(max(look.specular, 0.0), 10.0), 6)}
            if look.multiscatter != (look.model == "principled-4"):
                says["multiscatter"] = look.multiscatter
            gloss = look.gloss.value if isinstance(look.gloss, Constant) else baked.get("gloss", np.zeros((1, 1, 4)))[..., :3].reshape(-1, 3).mean(axis=0)
            if any(gloss):
                says["gloss"] = [round(min(max(float(c), 0.0), 1.0), 6) for c in gloss]
            if look.coat != Constant(0.0) and (look.coat_ior, look.coat_tint) != (1.5, (1.0, 1.0, 1.0)):
                says["coat_ior"], says["coat_tint"] = round(min(max(look.coat_ior, 1.0), 5.0), 6), list(look.coat_tint)
        if look.diffuse_roughness:
            says["diffuse_roughness"] = round(min(max(look.diffuse_roughness, 0.0), 1.0), 6)
        return says

    def mean_base(self, look, baked):
        """One free path goes for all of a texture."""
        if isinstance(look.base, Constant):
            return [min(max(float(c), 0.0), 1.0) for c in look.base.value]
        pixels = self.values(look.base, baked, True)
        return np.clip(pixels[..., :3].reshape(-1, 3).mean(axis=0), 0, 1).tolist()

    def plain(self):
        if None not in self.made:
            self.made[None] = self.glb.add("materials", {"name": "(no material)", "doubleSided": True, "pbrMetallicRoughness": {
                "baseColorFactor": [0.8, 0.8, 0.8, 1], "metallicFactor": 0, "roughnessFactor": 1}, **self.extension("ior", ior=1.0)})
        return self.made[None]

    def extension(self, name, **says):
        self.glb.extensions.add("KHR_materials_" + name)
        return {"extensions": {"KHR_materials_" + name: says}}

    def make(self, material, look, baked, two_sided, body):
        layers = []
        name = material.name_full
        while any(m["name"] == name for m in self.glb.document["materials"]):
            name += "'"
        pbr, extensions = {}, {}
        says = {"name": name, "doubleSided": two_sided, "pbrMetallicRoughness": pbr}
        stem = re.sub(r"[^A-Za-z0-9_.-]", "_", name)
        self.make_base(look, baked, stem, says, layers, material)
        self.make_roughness(look, baked, stem, says, layers)
        self.make_emission(look, baked, stem, says, extensions, layers, material)
        if look.transmission != Constant(0.0):
            extensions["KHR_materials_transmission"] = glass = {"transmissionFactor": 1.0}
            told = self.told(look.transmission, baked.get("transmission"), stem + "-transmission", False)
            if told is None:
                glass["transmissionFactor"] = self.constant(look.transmission, baked.get("transmission"))
            else:
                glass["transmissionTexture"] = self.use(told, layers)
            if body:
                extensions["KHR_materials_volume"] = volume = {"thicknessFactor": 1.0}
                if look.attenuation:
                    volume["attenuationColor"], volume["attenuationDistance"] = list(look.attenuation[0]), look.attenuation[1]
        self.make_layers(look, baked, stem, extensions, layers)
        self.make_curves(look, baked, stem, says, material)
        if abs(look.ior - 1.5) > 1e-4:
            extensions["KHR_materials_ior"] = {"ior": min(max(look.ior, 1.0), 10.0)}
        if isinstance(look.normal, tuple):
            picture, strength = look.normal
            says["normalTexture"] = {**self.use(self.picture(picture), layers), "scale": strength}
        elif "normal" in baked and not are_level(baked["normal"]):
            says["normalTexture"] = self.use(self.write(stem + "-normal", baked["normal"][..., :3]), layers)
        if extensions:
            says["extensions"] = extensions
            self.glb.extensions.update(extensions)
        if look.hole:
            self.holes.append(name)
        if len(layers) > 2:
            self.lost.add_of(material, "more than two layers of texture coordinates; the first two are kept")
        index = self.glb.add("materials", says)
        if look.anisotropy > 0 and look.brushed and look.normal is None:
            self.glb.brushed.add(index)
        return index, layers or [None]

    def make_curves(self, look, baked, stem, says, material):
        """Inputs that depend on the angle; glTF has the ends that are larger."""
        curves = {}
        for name in angles.COLORS + angles.NUMBERS:
            value, other = getattr(look, name), baked.get(name + " other")
            is_color = name in angles.COLORS
            if isinstance(value, Angled):
                curve = {"other": value.other, "share": value.share}
            elif other is not None:
                share = baked[name + " share"][0, :, :3]
                flat = other[..., :3].reshape(-1, 3).mean(axis=0)
                curve = {"other": flat.tolist() if is_color else float(flat.mean()), "share": (share if is_color else share.mean(axis=1)).tolist()}
                if not self.is_flat(other) and name in {"base", "emission"}:
                    peak = max(float(other[..., :3].max()), 1e-9) if name == "emission" else 1.0
                    curve["other"] = peak
                    curve["texture"] = f"{stem}-{name}-other.png"
                    png.write(os.path.join(self.folder, curve["texture"]), png.srgb(np.clip(other[..., :3] / peak, 0, 1)))
                elif not self.is_flat(other):
                    self.lost.add_of(material, f"texture of {name} by the angle; its mean is used")
            else:
                continue
            if name == "emission":
                strength = look.strength.value if isinstance(look.strength, Constant) else 1.0
                curve["other"] = (np.array(curve["other"]) * strength).tolist()
            top = 1e6 if name == "emission" else 1.0
            curves["base_color" if name == "base" else name] = {key: np.clip(v, 0, top if key == "other" else 1).round(6).tolist()
                                                               if key != "texture" else v for key, v in curve.items()}
        if curves:
            self.by_angle[says["name"]] = curves

    def is_textured(self, baked, name):
        """Whether one of its ends is; the other one has the same coordinates then."""
        return any(not self.is_flat(baked[end]) for end in (name, name + " other") if end in baked)

    def make_base(self, look, baked, stem, says, layers, material):
        pbr = says["pbrMetallicRoughness"]
        base, alpha = baked.get("base"), baked.get("alpha")
        factor = [1.0, 1.0, 1.0, 1.0]
        if isinstance(look.base, Constant):
            factor[:3] = [min(max(c, 0.0), 1.0) for c in look.base.value]
        if isinstance(look.alpha, Constant):
            factor[3] = min(max(look.alpha.value, 0.0), 1.0)
        pixels = layer = transform = None
        if isinstance(look.alpha, Picture) and alpha is None and isinstance(look.base, Picture) and base is None and \
                look.alpha.channel == "A" and look.alpha.image == look.base.image:
            pbr["baseColorTexture"] = self.use(self.picture(look.base), layers)
        elif not isinstance(look.alpha, Constant):
            pixels = np.ones((*self.size_of(look, baked), 4), dtype=np.float32)
            if not isinstance(look.base, Constant):
                pixels[..., :3] = self.fitted(self.values(look.base, base, True), pixels)[..., :3]
            pixels[..., 3] = self.fitted(self.values(look.alpha, alpha, False), pixels)[..., 0]
            layer = BAKE_UV if alpha is not None else look.alpha.layer
            transform = None if alpha is not None else look.alpha.transform
            pixels[..., :3] = png.srgb(pixels[..., :3])
        elif base is not None:
            if not self.is_textured(baked, "base"):
                factor[:3] = [float(min(max(c, 0), 1)) for c in base[0, 0, :3]]
            else:
                pixels, layer = png.srgb(base[..., :3]), BAKE_UV
        elif isinstance(look.base, Picture):
            pbr["baseColorTexture"] = self.use(self.picture(look.base), layers)
        if pixels is not None:
            pbr["baseColorTexture"] = self.use(self.write(stem + "-colour", pixels, layer, transform), layers)
        pbr["baseColorFactor"] = factor
        if not isinstance(look.alpha, Constant) or factor[3] < 1 or isinstance(look.alpha, Angled):
            clip = getattr(material, "blend_method", "") == "CLIP"
            says["alphaMode"] = "MASK" if clip else "BLEND"
            if clip:
                says["alphaCutoff"] = material.alpha_threshold

    def make_roughness(self, look, baked, stem, says, layers):
        pbr = says["pbrMetallicRoughness"]
        sources = {"roughness": (look.roughness, baked.get("roughness")), "metallic": (look.metallic, baked.get("metallic"))}
        textured = {}
        for name, (source, pixels) in sources.items():
            if isinstance(source, Constant) or (pixels is not None and self.is_flat(pixels)):
                pbr[name + "Factor"] = min(max(self.constant(source, pixels), 0.0), 1.0)
            else:
                textured[name] = self.values(source, pixels, False)
        if not textured:
            return
        height, width = max((v.shape[:2] for v in textured.values()))
        packed = np.ones((height, width, 3), dtype=np.float32)
        for name, values in textured.items():
            packed[..., 1 if name == "roughness" else 2] = self.fitted(values, packed)[..., 0]
            pbr[name + "Factor"] = 1.0
        first = next(iter(textured))
        source, pixels = sources[first]
        layer, transform = (BAKE_UV, None) if pixels is not None else (source.layer, source.transform)
        pbr["metallicRoughnessTexture"] = self.use(self.write(stem + "-roughness", packed, layer, transform), layers)

    def make_layers(self, look, baked, stem, extensions, layers):
        """What lies on the surface."""
        def layer(extension, *parts):
            says = {}
            for name, factor, texture, is_color in parts:
                source = getattr(look, name)
                told = self.told(source, baked.get(name), f"{stem}-{name}", is_color)
                if told is not None:
                    says[texture] = self.use(told, layers)
                    says[factor] = [1.0] * 3 if is_color else 1.0
                elif is_color:
                    value = source.value if isinstance(source, Constant) else baked[name][0, 0, :3]
                    # Fibres reflect no more than comes; a tint may.
                    says[factor] = [float(min(max(c, 0.0), 1.0 if name == "sheen" else 10.0)) for c in value]
                else:
                    says[factor] = min(max(self.constant(source, baked.get(name)), 0.0), 1.0)
            extensions["KHR_materials_" + extension] = says

        if look.coat != Constant(0.0):
            layer("clearcoat", ("coat", "clearcoatFactor", "clearcoatTexture", False),
                  ("coat_roughness", "clearcoatRoughnessFactor", "clearcoatRoughnessTexture", False))
        if look.sheen != Constant((0.0, 0.0, 0.0)):
            layer("sheen", ("sheen", "sheenColorFactor", "sheenColorTexture", True))
            extensions["KHR_materials_sheen"]["sheenRoughnessFactor"] = min(max(look.sheen_roughness, 0.0), 1.0)
        if look.specular_tint != Constant((1.0, 1.0, 1.0)):
            layer("specular", ("specular_tint", "specularColorFactor", "specularColorTexture", True))
        if look.anisotropy > 0:
            extensions["KHR_materials_anisotropy"] = {"anisotropyStrength": min(look.anisotropy, 1.0),
                                                      "anisotropyRotation": look.anisotropy_rotation}
        if look.film > 0:
            extensions["KHR_materials_iridescence"] = {
                "iridescenceFactor": 1.0, "iridescenceIor": max(look.film_ior, 1.0),
                "iridescenceThicknessMinimum": look.film, "iridescenceThicknessMaximum": look.film}
        if look.leaf > 0:
            extensions["KHR_materials_diffuse_transmission"] = {
                "diffuseTransmissionFactor": min(look.leaf, 1.0),
                "diffuseTransmissionColorFactor": [min(max(c, 0.0), 1.0) for c in look.leaf_color]}

    def make_emission(self, look, baked, stem, says, extensions, layers, material):
        color, strength = look.emission, look.strength
        if color == Constant((0.0, 0.0, 0.0)) or strength == Constant(0.0):
            return
        factor, told = np.ones(3), None
        pixels = baked.get("emission")
        if isinstance(color, Constant):
            factor = np.maximum(np.array(color.value, dtype=float), 0)
        elif isinstance(color, Picture) and pixels is None:
            told = self.picture(color)
        elif not self.is_textured(baked, "emission"):
            factor = np.maximum(pixels[0, 0, :3].astype(float), 0)
        power = max(self.constant(strength, None), 0.0) if isinstance(strength, Constant) else 1.0
        lit = baked.get("strength")
        if not isinstance(strength, Constant) or (pixels is not None and self.is_textured(baked, "emission")):
            light = np.ones((1, 1, 3)) if pixels is None else pixels[..., :3]
            if lit is not None:
                light = light * self.fitted(lit, light if light.shape[0] > 1 else lit)[..., :1]
            light = np.maximum(light, 0)
            peak = float(light.max()) or 1.0
            power *= peak
            if told is None:
                told = self.write(stem + "-emission", png.srgb(light / peak), BAKE_UV)
            elif lit is not None:
                self.lost.add_of(material, "texture of the emission's strength")
        largest = float(factor.max())
        if largest <= 0:
            return
        says["emissiveFactor"] = [float(c / largest) for c in factor]
        extensions["KHR_materials_emissive_strength"] = {"emissiveStrength": power * largest}
        if told is not None:
            says["emissiveTexture"] = self.use(told, layers)
        if look.animated and isinstance(strength, Constant) and strength.value > 0:
            self.strengths[says["name"]] = (material, *look.animated, strength.value)

    # Values and images.

    def is_flat(self, pixels):
        return float(np.max(np.ptp(pixels[..., :3].reshape(-1, 3), axis=0))) < 0.5 / 255 and float(pixels[..., 3].max()) > 0

    def constant(self, source, pixels):
        return number_of(source.value) if isinstance(source, Constant) else float(pixels[..., :3].mean())

    def size_of(self, look, baked):
        sizes = [p.shape[:2] for n, p in baked.items() if n in {"base", "alpha"}]
        sizes += [(s.image.size[1], s.image.size[0]) for s in (look.base, look.alpha) if isinstance(s, Picture)]
        return max(sizes)

    def fitted(self, values, like):
        """The nearest texels, for as many as `like` has."""
        height, width = like.shape[:2]
        rows = np.arange(height) * values.shape[0] // height
        columns = np.arange(width) * values.shape[1] // width
        return values[rows][:, columns]

    def values(self, source, pixels, is_color):
        """Linear values of a texture, rows from the bottom up."""
        if pixels is None:
            image = source.image
            pixels = np.empty(image.size[0] * image.size[1] * image.channels, dtype=np.float32)
            image.pixels.foreach_get(pixels)
            pixels = pixels.reshape(image.size[1], image.size[0], image.channels)
            if source.channel is not None:
                pixels = pixels[..., ["RGBA".index(source.channel)] * 3]
            elif is_color:
                c = pixels[..., :3]
                pixels = np.where(c <= 0.04045, c / 12.92, np.power((c + 0.055) / 1.055, 2.4))
        if not is_color:
            pixels = pixels[..., :3].mean(axis=2, keepdims=True)
        return pixels

    def told(self, source, pixels, stem, is_color):
        """A texture of its own for a source that is none of glTF's merged ones; None where it is a constant."""
        if isinstance(source, Constant) or (pixels is not None and self.is_flat(pixels)):
            return None
        if pixels is None and source.channel is None:
            return self.picture(source)
        layer, transform = (BAKE_UV, None) if pixels is not None else (source.layer, source.transform)
        values = self.values(source, pixels, is_color)
        return self.write(stem, png.srgb(values[..., :3]) if is_color else np.repeat(values, 3, axis=2), layer, transform)

    def write(self, stem, pixels, layer=BAKE_UV, transform=None):
        name = f"{stem}.png"
        png.write(os.path.join(self.folder, name), pixels)
        return Told(self.glb.add("images", {"uri": name.replace("%", "%25")}), layer, transform, layer == BAKE_UV)

    def picture(self, picture):
        """The .blend's own image, as it is stored where that can be read."""
        image = picture.image
        if image.name_full not in self.images:
            self.images[image.name_full] = self.glb.add("images", {"uri": self.store(image)})
        return Told(self.images[image.name_full], picture.layer, picture.transform, picture.node.extension == "EXTEND")

    def store(self, image):
        path = bpy.path.abspath(image.filepath_from_user() if hasattr(image, "filepath_from_user") else image.filepath, library=image.library)
        ending = os.path.splitext(path)[1].lower()
        name = f"image{len(self.images):03d}{ending if ending in READ_AS_THEY_ARE else '.png'}"
        out = os.path.join(self.folder, name)
        data = None
        if ending in READ_AS_THEY_ARE and not image.is_dirty:
            if image.packed_file:
                data = image.packed_file.data
            elif os.path.isfile(path):
                with open(path, "rb") as file:
                    data = file.read()
        if data:
            with open(out, "wb") as file:
                file.write(data)
            return name
        name = os.path.splitext(name)[0] + ".png"
        pixels = np.empty(image.size[0] * image.size[1] * image.channels, dtype=np.float32)
        image.pixels.foreach_get(pixels)
        pixels = pixels.reshape(image.size[1], image.size[0], image.channels)
        png.write(os.path.join(self.folder, name), pixels if image.channels in (3, 4) else np.repeat(pixels[..., :1], 3, axis=2))
        return name

    def use(self, told, layers):
        """A textureInfo, whose layer of coordinates the shape will have."""
        key = (told.image, told.clamped)
        if key not in self.textures:
            texture = {"source": told.image}
            if told.clamped:
                texture["sampler"] = self.glb.add("samplers", {"wrapS": 33071, "wrapT": 33071})
            self.textures[key] = self.glb.add("textures", texture)
        if told.layer not in layers:
            layers.append(told.layer)
        says = {"index": self.textures[key]}
        number = min(layers.index(told.layer), 1)
        if number:
            says["texCoord"] = number
        if told.transform:
            self.glb.extensions.add("KHR_texture_transform")
            says["extensions"] = {"KHR_texture_transform": told.transform}
        return says
