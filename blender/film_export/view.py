# SPDX-License-Identifier: Apache-2.0 OR GPL-3.0-or-later
"""The scene's view as the film's own (docs/model/display.md)."""

FILMIC = {"None", "", "Medium Contrast"}
OTHERS = {"Very High Contrast", "High Contrast", "Medium High Contrast", "Medium Low Contrast", "Low Contrast", "Very Low Contrast"}


def view_of(scene, tell):
    """(name, gamma) of the view that is nearest to the scene's. What is not kept goes to `tell` as a text."""
    view, name = scene.view_settings, "standard"
    look = view.look.split(" - ")[-1]  # from Blender 4 on looks begin with their view's name
    kept = look in {"None", ""}
    if view.view_transform == "Filmic":
        kept = look in FILMIC | OTHERS
        name = "filmic-" + look.lower().replace(" ", "-") if look in OTHERS else "filmic"
    elif view.view_transform == "AgX":
        kept = kept or look == "Base Contrast"
        name = "agx"
        tell("view transform AgX; strong colours differ a little")
    elif view.view_transform == "Khronos PBR Neutral":
        name = "neutral"
        tell("view transform Khronos PBR Neutral; the film's own curve is near to it")
    elif view.view_transform != "Standard":
        tell(f"view transform {view.view_transform}; shown as Standard")
    if not kept:
        tell(f"look {view.look}")
    if view.use_curve_mapping:
        tell("curves of the view")
    if scene.display_settings.display_device != "sRGB":
        tell(f"display {scene.display_settings.display_device}; the film is for sRGB")
    gamma = min(max(view.gamma, 0.1), 5.0)
    if name == "neutral" and abs(gamma - 1) > 1e-4:
        tell(f"gamma {gamma:g} of the view")
        gamma = 1.0
    return name, gamma
