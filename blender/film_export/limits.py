# SPDX-License-Identifier: Apache-2.0 OR GPL-3.0-or-later
"""Limits by which Cycles leaves out light that a film shows."""
import numpy as np

from .looks import Constant

USUAL_CLAMP = 10  # Cycles' own of indirect light, above which it holds back little but stray bright pixels
FEWEST = 2        # bounces with which the rest is a few hundredths of the light


def islands_of(triangles):
    """How many parts hang together, of triangles by their vertices; about, where they are wide nets."""
    used, ends = np.unique(triangles, return_inverse=True)
    ends, labels = ends.reshape(-1, 3), np.arange(len(used))
    for _ in range(64):
        before = labels.copy()
        np.minimum.at(labels, ends, labels[ends].min(axis=1, keepdims=True))
        labels = labels[labels]
        if np.array_equal(labels, before):
            break
    return len(np.unique(labels))


def layers_of(walk, materials):
    """Parts of shapes that rays pass by their coverage: as many layers a ray may meet, or more."""
    count = 0
    for over in walk.shapes.values():
        if over.shape is None or not hasattr(over.shape, "slots"):
            continue
        looks = [materials.looks.get(m.name_full) if m is not None else None for m in over.materials]
        clear = [number for number, known in enumerate(looks) if known is not None and known[0].alpha != Constant(1.0)]
        if clear:
            uses = sum(1 for thing in walk.things.values() if walk.shapes.get(thing.shape) is over)
            count += uses * islands_of(over.shape.vertex[over.shape.corners[np.isin(over.shape.slots, clear)]])
    return count


def tell(scene, walk, materials, film, lost):
    cycles = getattr(scene, "cycles", None)
    if cycles is None or scene.render.engine.startswith(("BLENDER_EEVEE", "BLENDER_WORKBENCH")):
        return
    limit = cycles.transparent_max_bounces
    if layers_of(walk, materials) > limit:
        film["limits"] = {"layers": limit}  # told where the film does not keep to it
    if cycles.sample_clamp_direct > 0:
        lost.add(scene, f"clamp {cycles.sample_clamp_direct:g} of direct light; the film has all of it")
    if 0 < cycles.sample_clamp_indirect < USUAL_CLAMP:
        lost.add(scene, f"clamp {cycles.sample_clamp_indirect:g} of indirect light; the film has all of it")
    few = [f"{getattr(cycles, name)} {name.replace('_', ' ').replace('max bounces', 'bounces in all')}"
           for name in ("max_bounces", "diffuse_bounces", "glossy_bounces", "transmission_bounces") if getattr(cycles, name) < FEWEST]
    if few:
        lost.add(scene, f"{', '.join(few)}: the film has more light")
    if cycles.volume_bounces < FEWEST and any(np.max(volume.get("color", 0)) > 0 for volume in film.get("volumes", [])):
        lost.add(scene, f"{cycles.volume_bounces} volume bounces; the film has light that volumes scatter more often, too")
    if getattr(cycles, "use_fast_gi", False):
        lost.add(scene, "fast global illumination, an approximation; the film has the light itself")
    if not cycles.caustics_refractive and any(look.refracts for look, _ in materials.looks.values()):
        lost.add(scene, "glass without caustics; the film has them")
