"""A forest: instances of three trees whose leaves an image cuts out of cards, ferns, and a path, under sun and sky."""
import sys

sys.path.insert(0, __file__.rpartition("/")[0] or ".")
from making import *  # noqa: E402,F403

start(4).cycles.transparent_max_bounces = 64  # as cards need it; 8 leave black gaps
sky(0.35, sky_type="NISHITA", sun_disc=False, sun_elevation=math.radians(42), sun_rotation=math.radians(50))
lamp("SUN", (0, 0, 9), (-3.5, -4.2, 2.6), 4, (1, 0.9, 0.74), angle=math.radians(0.6))


def sprig(size=64):
    """A twig of seven leaves as an image, 1 inside them and 0 outside."""
    picture = bpy.data.images.new("Sprig", size, size, alpha=True)
    pixels = []
    for row in range(size):
        for column in range(size):
            x, y = 2 * (column + 0.5) / size - 1, (row + 0.5) / size
            inside = abs(x) < 0.03 and y < 0.9
            for at, side in ((0.15, -1), (0.25, 1), (0.4, -1), (0.5, 1), (0.62, -1), (0.7, 1), (0.75, 0)):
                along, across = (0.8 * side * x + 0.6 * (y - at), 0.8 * (y - at) - 0.6 * side * x) if side else (y - at, x)
                inside |= 0 < along < 0.6 and abs(across) < 0.42 * along * (0.6 - along) / 0.36 + 0.06 * (along < 0.25) * 0.3
            shade = 0.75 + 0.25 * ((row * 7 + column * 3) % 5) / 4
            pixels += [0.24 * shade, 0.42 * shade, 0.1 * shade, float(inside)]
    picture.pixels = pixels
    picture.pack()
    return picture


def cards(name, picture, tint):
    made = leafy(name, tint, tuple(1.5 * c for c in tint), 0.35, roughness=0.5)
    tree = made.node_tree
    image, clear, cut = (tree.nodes.new("ShaderNode" + k) for k in ("TexImage", "BsdfTransparent", "MixShader"))
    image.image, leaf = picture, next(n for n in tree.nodes if n.type == "MIX_SHADER")
    tree.links.new(image.outputs["Alpha"], cut.inputs[0])
    tree.links.new(clear.outputs[0], cut.inputs[1])
    tree.links.new(leaf.outputs[0], cut.inputs[2])
    tree.links.new(cut.outputs[0], tree.nodes["Material Output"].inputs["Surface"])
    tree.links.new(image.outputs["Color"], tree.nodes["Principled BSDF"].inputs["Base Color"])
    made.blend_method = "CLIP"
    return made


def card_mesh(name, places, made, size):
    """Squares with the whole image on each, at (place, direction)."""
    corners, faces = [], []
    for place, turn in places:
        faces.append(tuple(range(len(corners), len(corners) + 4)))
        corners += [place + turn @ (Vector(c) * size) for c in ((-0.5, 0, 0), (0.5, 0, 0), (0.5, 1, 0.12), (-0.5, 1, 0.12))]
    thing = mesh(name, corners, faces, made)
    layer = thing.data.uv_layers.new()
    for corner in layer.data:
        corner.uv = (0, 0)
    for k in range(len(faces)):
        for corner, uv in zip(range(4 * k, 4 * k + 4), ((0, 0), (1, 0), (1, 1), (0, 1))):
            layer.data[corner].uv = uv
    return thing


def random_turn():
    return Vector([random.gauss(0, 1) for _ in range(3)]).to_track_quat("Y", "Z")


def tree(k, bark, leaf):
    """A trunk with boughs, and cards about their ends, in a collection of its own."""
    high, parts, places = 5.5 + k, [], []
    parts.append(turned(f"Trunk {k}", [(0, -0.3), (0.3, -0.3), (0.2, 0.3), (0.16, 0.5 * high), (0.05, high), (0, high)], bark, steps=14, subdivided=1))
    for b in range(16):
        z, turn = high * (0.4 + 0.6 * b / 16), 2.4 * b
        reach = 2.2 * (1.15 - b / 16)
        bough = turned(f"Bough {k} {b}", [(0, 0), (0.05, 0), (0.012, reach), (0, reach)], bark, (0, 0, z), steps=6, subdivided=0)
        lean = Vector((math.cos(turn), math.sin(turn), 0.45)).normalized()
        bough.rotation_euler = lean.to_track_quat("Z", "Y").to_euler()
        parts.append(bough)
        for _ in range(45):
            at = Vector((0, 0, z)) + lean * reach * random.uniform(0.3, 1.05) + Vector([random.gauss(0, 0.22) for _ in range(3)])
            places.append((at, random_turn()))
    parts.append(card_mesh(f"Leaves {k}", places, leaf, 0.42))
    grown = bpy.data.collections.new(f"Tree {k}")
    for part in parts:
        bpy.context.scene.collection.objects.unlink(part)
        grown.objects.link(part)
    return grown


soil = texture(material("Soil", roughness=0.95), "Noise", (0.06, 0.045, 0.025), (0.14, 0.11, 0.05), 0.7, scale=2.5, detail=6)
ground = mesh("Ground", [(1.6 * x, 1.6 * y, 0.12 * math.sin(0.7 * x) * math.cos(0.5 * y)) for y in range(-6, 24) for x in range(-15, 16)],
              [(31 * j + i, 31 * j + i + 1, 31 * j + i + 32, 31 * j + i + 31) for j in range(29) for i in range(30)], soil, smooth=True)
bark = texture(material("Bark", roughness=0.95), "Noise", (0.06, 0.045, 0.035), (0.19, 0.15, 0.11), 0.8, scale=4, stretch=(4, 4, 0.6))
picture = sprig()
kinds = [tree(k, bark, cards(f"Leaf {k}", picture, tint)) for k, tint in enumerate(((0.1, 0.22, 0.03), (0.16, 0.24, 0.04), (0.08, 0.17, 0.04)))]
for n in range(60):
    x, y = random.uniform(-16, 16), 1.5 + 30 * n / 60 + random.uniform(-0.6, 0.6)
    if abs(x - 1.2 * math.sin(0.25 * y)) < 1.4:
        x += math.copysign(2, x)  # the path stays free
    place = add(f"Tree {n}", None, (x, y, 0), (0, 0, random.uniform(0, 6)))
    place.scale = (random.uniform(0.8, 1.2),) * 3
    place.instance_type, place.instance_collection = "COLLECTION", kinds[n % 3]
fern = card_mesh("Fern", [(Vector(), (Vector((math.cos(k), math.sin(k), 0.9))).to_track_quat("Y", "Z")) for k in (0, 1.1, 2.2, 3.1, 4.2, 5.2)], cards("Fern", picture, (0.1, 0.2, 0.03)), 0.45)
fern.location.z = -5
scatter(ground, fern, 1500, 1.0, hair_length=1.0)
for k in range(14):
    stone = ball(f"Stone {k}", 0.16 + 0.05 * (k % 3), (1.2 * math.sin(0.25 * 1.7 * k) + 0.9 * (-1) ** k, 1.7 * k - 3, 0.03),
                 texture(material(f"Stone {k}", roughness=0.85), "Noise", (0.2, 0.2, 0.19), (0.36, 0.35, 0.33), 0.4, scale=9), None, (1.3, 1, 0.6))
camera([(0.3, -5.5, 1.6), (0.1, -4.0, 1.65)], (0.6, 8, 2.2), 28)
save()
