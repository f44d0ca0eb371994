# SPDX-License-Identifier: Apache-2.0 OR GPL-3.0-or-later
"""Which rays meet an object, as Cycles' ray visibility says it."""
RAYS = ("camera", "diffuse", "glossy", "transmission", "volume_scatter", "shadow")


def rays_of(thing):
    """Names of the rays that meet it."""
    return {ray for ray in RAYS if getattr(thing, "visible_" + ray, True)}


def owners(key):
    """Names of the object that a thing of the walk is, and of the one that made it an instance."""
    if key[0] == "instance":
        return {key[1], key[4] if isinstance(key[2], tuple) else key[2]}
    return {key[1]}


class Visibility:
    """Cameras may look through an object that light meets; other rays meet what is met by any."""

    def __init__(self, scene, lost):
        self.rays = {}
        for thing in scene.objects:
            rays = rays_of(thing)
            if thing.type == "LIGHT" or len(rays) == len(RAYS):
                continue
            self.rays[thing.name_full] = rays
            hidden = [ray.replace("_scatter", "") for ray in RAYS[1:] if ray not in rays]
            if hidden and rays and not thing.hide_render and thing.type not in {"EMPTY", "CAMERA", "ARMATURE", "LATTICE"}:
                lost.add(thing, f"ray visibility: hidden from {', '.join(hidden)} rays, which meet it in the film")

    def write(self, key, change):
        """`change`: an animation file's, of the thing's node."""
        left = set(RAYS)
        for owner in owners(key):
            left &= self.rays.get(owner, left)
        if not left:
            change["visible"] = False
            change.pop("keys", None)
        elif "camera" not in left:
            change.setdefault("material", {})["seen"] = False
