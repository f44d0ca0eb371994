# SPDX-License-Identifier: Apache-2.0 OR GPL-3.0-or-later
"""What a film cannot show of a .blend: one line each, by object, material, node and reason."""
import bpy


class Lost:
    def __init__(self):
        self.lines = []

    def add(self, thing, reason):
        """`thing`: a name, or something that has one."""
        line = f"{getattr(thing, 'name', thing)}: {reason}"
        if line not in self.lines:
            self.lines.append(line)

    def add_of(self, material, reason, node=None, thing=None):
        """What is lost of a material, on one thing or on all that have it."""
        names = [thing] if thing else [t.name for t in bpy.data.objects if any(s.material == material for s in t.material_slots)]
        who = ", ".join(names[:2]) + (f" and {len(names) - 2} others" if len(names) > 2 else "")
        what = f"material {material.name}" + (f", node {node.label or node.name}" if node is not None else "")
        self.add(f"{who}: {what}" if who else what, reason)
