"""What becomes of a material's nodes: the table in docs/scenes.md. `python3 kept.py` prints it.

KEPT: as Cycles has it, as far as src/renderer/surface goes. NEAR: something like it, which is told. LOST: told. Each node
that Reader (looks.py) reads has a row."""

KEPT, NEAR, LOST = "kept", "near", "lost"

# Node's type, its name, what becomes of it.
SHADERS = [
    ("BSDF_PRINCIPLED", "Principled BSDF", KEPT, "the model of its version, 3 or 4"),
    ("BSDF_DIFFUSE", "Diffuse BSDF", KEPT, "with its roughness"),
    ("BSDF_GLOSSY", "Glossy BSDF", KEPT, "a lobe of one reflectance"),
    ("BSDF_ANISOTROPIC", "Anisotropic BSDF", KEPT, "a stretched lobe"),
    ("BSDF_GLASS", "Glass BSDF", KEPT, "its reflection is white; a body where the shape is closed, else a thin pane, told"),
    ("BSDF_TRANSPARENT", "Transparent BSDF", KEPT, "coverage"),
    ("BSDF_TRANSLUCENT", "Translucent BSDF", KEPT, "diffuse light on the other side"),
    ("SUBSURFACE_SCATTERING", "Subsurface Scattering", KEPT, "a random walk"),
    ("EMISSION", "Emission", KEPT, "its animated strength as well"),
    ("BACKGROUND", "Background", KEPT, "as Emission"),
    ("HOLDOUT", "Holdout", KEPT, ""),
    ("ADD_SHADER", "Add Shader", KEPT, "Emission to anything; Diffuse and Glossy of constant colours; of others the first, told"),
    ("MIX_SHADER", "Mix Shader", KEPT, "Transparent as coverage; Diffuse and Glossy of constant colours; of others each input by itself"),
    ("BSDF_HAIR_PRINCIPLED", "Principled Hair BSDF", KEPT, "Chiang's model; textures and random values told"),
    ("BSDF_SHEEN", "Sheen BSDF", NEAR, "fibres by glTF's formula"),
    ("BSDF_VELVET", "Velvet BSDF", NEAR, "fibres by glTF's formula"),
    ("BSDF_METALLIC", "Metallic BSDF", NEAR, "one reflectance from all sides"),
    ("BSDF_REFRACTION", "Refraction BSDF", NEAR, "glass, which reflects as well"),
    ("BSDF_TOON", "Toon BSDF", LOST, "a matt surface of its colour"),
    ("BSDF_HAIR", "Hair BSDF", LOST, "a matt surface of its colour"),
]
OTHERS = [
    ("VOLUME_ABSORPTION", "Volume Absorption", KEPT, "in closed glass; elsewhere told"),
    ("PRINCIPLED_VOLUME", "Principled Volume", KEPT, "in closed glass where it is black and absorbs; elsewhere told"),
    ("VOLUME_SCATTER", "Volume Scatter", LOST, "of the world it is fog"),
    ("DISPLACEMENT", "Displacement", LOST, "the surface stays smooth"),
    ("TEX_IMAGE", "Image Texture", KEPT, "the .blend's file, on a UV map; else baked"),
    ("NORMAL_MAP", "Normal Map", KEPT, "of tangent space on a UV map; else baked"),
    ("BUMP", "Bump", KEPT, "baked as a normal map"),
    (None, "other textures, ramps, maths, vertex colours", KEPT, "baked by Cycles, 1024x1024 a material and mesh"),
    (None, "textures of other inputs than colour, metalness, roughness, emission, alpha, transmission, coat, sheen, tint", LOST,
     "the node's own value"),
    (None, "keys and drivers of all but the emission's strength", LOST, "as on the first frame"),
]


def table():
    """Markdown; nodes of one fate side by side."""
    rows = ["| node | in the film | |", "|---|---|---|"]
    rows += [f"| {name} | {state} | {what} |" for _, name, state, what in SHADERS + OTHERS]
    return "\n".join(rows)


if __name__ == "__main__":
    print(table())
