"""Twenty people cross a square: each a skin on bones of its own, which swing as they walk; sun, sky, and shop windows behind."""
import sys

sys.path.insert(0, __file__.rpartition("/")[0] or ".")
from making import *  # noqa: E402,F403

scene = start(3)
sky(0.4, sky_type="NISHITA", sun_disc=False, sun_elevation=math.radians(35), sun_rotation=math.radians(120))
lamp("SUN", (0, 0, 9), (-4, 5, -2), 3.5, (1, 0.92, 0.8), angle=math.radians(0.8)).rotation_euler = (0.9, 0.0, 0.7)

# Bones by name: parent, head, tail; and the skin about each: radii from its head to its tail.
BONES = {"hips": (None, (0, 0, 0.95), (0, 0, 1.1)), "chest": ("hips", (0, 0, 1.1), (0, 0, 1.48)), "head": ("chest", (0, 0, 1.5), (0, 0, 1.82))}
SKIN = {"hips": (0.12, 0.155, 0.15), "chest": (0.15, 0.19, 0.2, 0.1), "head": (0.055, 0.06, 0.105, 0.115, 0.09)}
for side, s in (("left", 1), ("right", -1)):
    BONES |= {f"thigh {side}": ("hips", (0.1 * s, 0, 0.95), (0.11 * s, 0, 0.5)), f"shin {side}": (f"thigh {side}", (0.11 * s, 0, 0.5), (0.11 * s, 0, 0.06)),
              f"foot {side}": (f"shin {side}", (0.11 * s, 0.04, 0.05), (0.12 * s, -0.2, 0.04)),
              f"arm {side}": ("chest", (0.23 * s, 0, 1.42), (0.29 * s, 0, 1.13)), f"hand {side}": (f"arm {side}", (0.29 * s, 0, 1.13), (0.31 * s, -0.05, 0.84))}
    SKIN |= {f"thigh {side}": (0.1, 0.095, 0.075), f"shin {side}": (0.072, 0.068, 0.045), f"foot {side}": (0.05, 0.05, 0.035),
             f"arm {side}": (0.07, 0.058, 0.05), f"hand {side}": (0.05, 0.043, 0.035, 0.04)}
SLOT = {"hips": 1, "thigh": 1, "shin": 1, "chest": 0, "arm": 0, "head": 2, "hand": 2, "foot": 3}


def bones():
    data = bpy.data.armatures.new("Bones")
    rig = add("Rig", data)
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="EDIT")
    for name, (parent, head, tail) in BONES.items():
        bone = data.edit_bones.new(name)
        bone.head, bone.tail = head, tail
        bone.align_roll((0, -1, 0) if "foot" not in name else (0, 0, 1))
        bone.parent = data.edit_bones[parent] if parent else None
    bpy.ops.object.mode_set(mode="OBJECT")
    bpy.data.objects.remove(rig)
    return data


def body(steps=12):
    """A closed tube about each bone; its rings near the head follow the parent by half."""
    vertices, faces, slots, weights = [], [], [], []
    for name, (parent, head, tail) in BONES.items():
        head, along = Vector(head), Vector(tail) - Vector(head)
        turn, rings = along.to_track_quat("Z", "Y"), SKIN[name]
        rows = [(0.0, 0.5 * rings[0])] + [(k / (len(rings) - 1), r) for k, r in enumerate(rings)] + [(1.0, 0.4 * rings[-1])]
        first, flat = len(vertices), 0.75 if name in ("hips", "chest") else 1.0
        for k, (at, radius) in enumerate(rows):
            middle = head + along * (at + (-0.25 if k == 0 else 0.25 if k == len(rows) - 1 else 0) * rings[0] / along.length)
            for n in range(steps):
                out = turn @ Vector((radius * math.cos(2 * math.pi * n / steps), radius * math.sin(2 * math.pi * n / steps), 0))
                vertices.append(middle + Vector((out.x, out.y * flat, out.z)))
                weights.append({name: 0.5, parent: 0.5} if parent and k <= 1 else {name: 1.0})
        made = [(first + k * steps + n, first + k * steps + (n + 1) % steps, first + (k + 1) * steps + (n + 1) % steps, first + (k + 1) * steps + n)
                for k in range(len(rows) - 1) for n in range(steps)]
        made += [tuple(first + n for n in reversed(range(steps))), tuple(first + (len(rows) - 1) * steps + n for n in range(steps))]
        faces += made
        slots += [SLOT[name.split()[0]]] * len(made)
    return vertices, faces, slots, weights


def skinned(name, armature, shape, colors, phase, ways):
    """A person on a rig of its own, `phase` of a step ahead, which walks `ways`."""
    rig = keyed(add(f"Rig {name}", armature), "location", *ways)
    bpy.context.view_layer.update()  # which makes the pose
    rig.rotation_euler.z = math.atan2(ways[1][0] - ways[0][0], ways[0][1] - ways[1][1])
    rig.scale = (random.uniform(0.92, 1.06),) * 3
    swings = {f"{part} {side}": (size, shift + (0 if side == "left" else 0.5)) for side in ("left", "right")
              for part, size, shift in (("thigh", 0.5, 0), ("arm", -0.45, 0))}
    for frame in range(scene.frame_start, scene.frame_end + 2, 3):
        step = (frame - scene.frame_start) / FPS + phase
        for bone in rig.pose.bones:
            bone.rotation_mode = "XYZ"
            size, shift = swings.get(bone.name, (0, 0))
            if bone.name.startswith("shin"):
                bone.rotation_euler.x = -0.45 + 0.45 * math.cos(2 * math.pi * (step + (0.1 if "left" in bone.name else 0.6)))
            elif bone.name.startswith("hand"):
                bone.rotation_euler.x = 0.3
            else:
                bone.rotation_euler.x = size * math.sin(2 * math.pi * (step + shift))
            bone.keyframe_insert("rotation_euler", frame=frame)
    vertices, faces, slots, weights = shape
    person = mesh(name, vertices, faces, smooth=True, parent=rig)
    for made in colors:
        person.data.materials.append(made)
    person.data.polygons.foreach_set("material_index", slots)
    groups = {bone: person.vertex_groups.new(name=bone) for bone in BONES}
    for index, shares in enumerate(weights):
        for bone, share in shares.items():
            groups[bone].add([index], share, "REPLACE")
    modifier(person, "ARMATURE", object=rig)
    modifier(person, "SUBSURF", levels=0, render_levels=1)


paving = texture(material("Paving", roughness=0.6), "Brick", (0.22, 0.2, 0.18), (0.36, 0.33, 0.3), 0.25, low=0.0, high=1.0, scale=0.7)
plane("Square", (40, 40), (0, 6, 0), paving)
stone = texture(material("Stone", roughness=0.85), "Noise", (0.45, 0.38, 0.3), (0.56, 0.49, 0.4), 0.3, scale=5, detail=6)
glazing, warm = material("Shop Glass", (0.02, 0.025, 0.03), roughness=0.05), material("Sign", (0.1, 0.1, 0.1), emission=(1, 0.6, 0.25, 1), emission_strength=3)
for k in range(5):
    x = -9.6 + 4.8 * k
    box(f"House {k}", (4.7, 3, 5 + 0.7 * (k % 3)), (x, 12, 0), stone, 0.05)
    box(f"Shop {k}", (3.4, 0.1, 2.2), (x, 10.48, 0.3), glazing, 0.02)
    box(f"Sign {k}", (2.4, 0.08, 0.3), (x, 10.46, 2.75), warm, 0.02)
    for side in (-1, 1):
        box(f"Window {k} {side}", (0.9, 0.08, 1.3), (x + side, 10.48, 3.4), glazing, 0.02)
leather = material("Leather", (0.05, 0.03, 0.02), roughness=0.4)
skins = [material(f"Skin {k}", color, roughness=0.5, subsurface=0.0) for k, color in enumerate(((0.6, 0.36, 0.26), (0.36, 0.2, 0.13), (0.72, 0.48, 0.36)))]
cloths = [texture(material(f"Cloth {k}", color, roughness=0.9, sheen=0.3), "Voronoi", bump=0.2, scale=60)
          for k, color in enumerate(((0.5, 0.06, 0.05), (0.08, 0.15, 0.36), (0.6, 0.5, 0.2), (0.1, 0.3, 0.16), (0.55, 0.55, 0.53), (0.06, 0.06, 0.07)))]
armature, shape = bones(), body()
for n in range(20):
    x, y, way = -5.4 + 1.15 * (n % 10) + random.uniform(-0.3, 0.3), 1.2 + 2.6 * (n // 10) + random.uniform(-0.9, 0.9), (-1) ** n
    ways = (x - 1.6 * way, y, 0), (x + 1.9 * way, y + random.uniform(-0.8, 0.8), 0)
    skinned(f"Person {n}", armature, shape, (cloths[n % 6], cloths[(n + 3) % 5 + 1], skins[n % 3], leather), random.random(), ways)
camera([(-0.8, -4.6, 1.9), (0.6, -4.4, 1.8)], (0, 3.5, 1.05), 28)
save()
