# SPDX-License-Identifier: Apache-2.0 OR GPL-3.0-or-later
"""What becomes of a material's nodes: the table in docs/scenes.md. `python3 kept.py` prints it.

KEPT: as Cycles has it, as far as src/renderer/surface goes. NEAR: something like it, which is told. LOST: told. Each node
that Reader (looks.py) reads has a row."""

KEPT, NEAR, LOST = "kept", "near", "lost"

# Node's type, its name, what becomes of it.
SHADERS = [
    ("BSDF_PRINCIPLED", "Principled BSDF", KEPT, "of its version"),
    ("BSDF_DIFFUSE", "Diffuse BSDF", KEPT, "with its roughness"),
    ("BSDF_GLOSSY", "Glossy BSDF", KEPT, "a lobe of one reflectance"),
    ("BSDF_ANISOTROPIC", "Anisotropic BSDF", KEPT, "stretched, about the axis where it has no tangent"),
    ("BSDF_GLASS", "Glass BSDF", KEPT, "reflects white; a body if closed, else a pane"),
    ("BSDF_TRANSPARENT", "Transparent BSDF", KEPT, "coverage"),
    ("BSDF_TRANSLUCENT", "Translucent BSDF", KEPT, "light from behind"),
    ("SUBSURFACE_SCATTERING", "Subsurface Scattering", KEPT, "a random walk"),
    ("EMISSION", "Emission", KEPT, "animated, too"),
    ("BACKGROUND", "Background", KEPT, "as Emission"),
    ("HOLDOUT", "Holdout", KEPT, ""),
    ("ADD_SHADER", "Add Shader", KEPT, "Emission to anything; plain Diffuse and Glossy; else the first, told"),
    ("MIX_SHADER", "Mix Shader", KEPT, "Transparent is coverage; plain Diffuse and Glossy; else input by input"),
    ("BSDF_HAIR_PRINCIPLED", "Principled Hair BSDF", KEPT, "Chiang's; textures and random values told"),
    ("BSDF_SHEEN", "Sheen BSDF", KEPT, "Ashikhmin's as glTF's fibres, told"),
    ("BSDF_VELVET", "Velvet BSDF", NEAR, "glTF's fibres"),
    ("BSDF_METALLIC", "Metallic BSDF", NEAR, "one reflectance"),
    ("BSDF_REFRACTION", "Refraction BSDF", NEAR, "glass, which reflects"),
    ("BSDF_TOON", "Toon BSDF", LOST, "matt"),
    ("BSDF_HAIR", "Hair BSDF", LOST, "matt"),
]
OTHERS = [
    ("VOLUME_ABSORPTION", "Volume Absorption", KEPT, "volumes; in closed glass"),
    ("PRINCIPLED_VOLUME", "Principled Volume", KEPT, "volumes; in closed glass, if it only absorbs"),
    ("VOLUME_SCATTER", "Volume Scatter", KEPT, "volumes; of the world: fog"),
    ("DISPLACEMENT", "Displacement", LOST, "smooth"),
    ("TEX_IMAGE", "Image Texture", KEPT, "the file, on a UV map; else baked"),
    ("NORMAL_MAP", "Normal Map", KEPT, "likewise"),
    ("BUMP", "Bump", KEPT, "baked"),
    ("FRESNEL", "Fresnel", KEPT, "curves over the angle, between two bakes where textures mix; both sides have the front's"),
    ("LAYER_WEIGHT", "Layer Weight", KEPT, "likewise"),
    (None, "other textures, ramps, maths", KEPT, "baked, 64 to 1024 across: a texel per pixel of the nearest view"),
    (None, "textures of specular, IOR, subsurface, anisotropy, film", LOST,
     "the node's own value"),
    (None, "keys of other than emission's strength", LOST, "the first frame's"),
]


def table():
    """Markdown; what is kept has no word for it."""
    rows = ["| node | in the film | |", "|---|---|---|"]
    rows += [f"| {name} | {'' if state == KEPT else state} | {what} |" for _, name, state, what in SHADERS + OTHERS]
    return "\n".join(rows)


if __name__ == "__main__":
    print(table())
