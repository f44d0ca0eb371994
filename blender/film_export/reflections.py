# SPDX-License-Identifier: Apache-2.0 OR GPL-3.0-or-later
"""What mirrors are told to show: empties below them with a radius and a target, as the add-on's Aim Reflection makes them."""
import numpy as np
from mathutils import Vector

from .cameras import TO_FILM
from .keys import json_number, thinned
from .walk import SHAPED

TARGET, RADIUS, BORDER = "aim_target", "aim_radius", "aim_border"


def middle_of(thing):
    """Of its box; the origin of what has no shape."""
    if thing.type not in SHAPED:
        return thing.matrix_world.translation
    return thing.matrix_world @ (sum((Vector(corner) for corner in thing.bound_box), Vector()) / 8)


class Reflections:
    def __init__(self, scene, times, lost):
        self.times, self.lost, self.rows = times, lost, {}
        for edit in scene.objects:
            if edit.type != "EMPTY" or RADIUS not in edit.keys():
                continue
            if edit.parent is None or getattr(edit.get(TARGET), "matrix_world", None) is None:
                lost.add(edit, "aimed reflection without a mirror above it" if edit.parent is None else "aimed reflection without a target")
                continue
            self.rows[edit] = []

    def watch(self, _number, depsgraph):
        for edit, rows in self.rows.items():
            now, mirror, target = (thing.evaluated_get(depsgraph) for thing in (edit, edit.parent, edit[TARGET]))
            radius = max(float(now[RADIUS]), 1e-6)
            rows.append({"at": list(mirror.matrix_world.inverted_safe() @ now.matrix_world.translation),
                         "see": list(TO_FILM[:3, :3] @ np.array(middle_of(target))),
                         "radius": [radius], "border": [max(float(now.get(BORDER, radius)), 1e-6)]})

    def write(self, film, names):
        """`names`: of the nodes that objects became."""
        for mirror in {edit.parent for edit in self.rows}:
            edits = [edit for edit in self.rows if edit.parent == mirror]
            if mirror.name_full not in names:
                for edit in edits:
                    self.lost.add(edit, f"aimed reflection of {mirror.name}, which has no surface in the film")
                continue
            change = film.setdefault("change", {}).setdefault(names[mirror.name_full], {})
            keys = {key["at"]: key for key in change.get("keys", [])}
            constants = change["reflections"] = [{} for _ in edits]
            for number, edit in enumerate(edits):
                for name in ("at", "see", "radius", "border"):
                    values = [row[name] for row in self.rows[edit]]
                    needed = thinned(self.times, values, 1e-5)
                    for k in needed:
                        value = [json_number(v) for v in values[k]]
                        value = value[0] if len(value) == 1 else value
                        if len(needed) == 1:
                            constants[number][name] = value
                            continue
                        at = json_number(self.times[k])
                        key = keys.setdefault(at, {"at": at})
                        key.setdefault("reflections", [{} for _ in edits])[number][name] = value
            change["interpolation"] = "linear"
            if keys:
                change["keys"] = [keys[at] for at in sorted(keys)]
