"""A yard before a house in the afternoon: window panes, grass, a tree of ten thousand leaves, under sun and sky."""
import sys

sys.path.insert(0, __file__.rpartition("/")[0] or ".")
from making import *  # noqa: E402,F403

start(4)
sky(0.3, sky_type="NISHITA", sun_disc=False, sun_elevation=math.radians(38), sun_rotation=math.radians(60))
lamp("SUN", (0, 0, 9), (3.2, 4.5, 2.5), 3.5, (1, 0.9, 0.76), angle=math.radians(1))

ground = texture(material("Ground", roughness=0.95), "Noise", (0.05, 0.035, 0.02), (0.12, 0.1, 0.04), 0.6, scale=3)
lawn = mesh("Lawn", [(9 * x / 20, 7 * y / 20, 0.05 * math.sin(0.5 * x) * math.cos(0.4 * y)) for y in range(-20, 21) for x in range(-20, 21)],
            [(41 * j + i, 41 * j + i + 1, 41 * j + i + 42, 41 * j + i + 41) for j in range(40) for i in range(40)], ground, smooth=True)
blade = material("Blade", (0.12, 0.27, 0.04), roughness=0.5)
tuft = mesh("Tuft", [], [], blade)
corners = []
for k in range(9):
    turn, lean, high = 2.4 * k, 0.04 + 0.02 * (k % 3), 0.1 + 0.02 * (k % 4)
    root = Vector((0.03 * math.cos(1.7 * k), 0.03 * math.sin(1.7 * k), 0))
    side, out = Vector((-math.sin(turn), math.cos(turn), 0)) * 0.006, Vector((math.cos(turn), math.sin(turn), 0)) * lean
    corners += [root - side, root + side, root + 0.4 * out + side + Vector((0, 0, 0.6 * high)), root + 0.4 * out - side + Vector((0, 0, 0.6 * high)),
                root + out + Vector((0, 0, high))]
tuft.data.from_pydata(corners, [], [f for k in range(9) for f in ((5 * k, 5 * k + 1, 5 * k + 2, 5 * k + 3), (5 * k + 3, 5 * k + 2, 5 * k + 4))])
tuft.location.z = -5
scatter(lawn, tuft, 20000, 1.0, hair_length=1.0)
path = texture(material("Flags", roughness=0.8), "Voronoi", (0.25, 0.24, 0.22), (0.42, 0.4, 0.37), 0.6, scale=2.2, low=0.05, high=0.4)
for k in range(7):
    box(f"Flag {k}", (0.9, 0.6, 0.12), (0.9 + 0.1 * math.sin(k), 2.2 - 0.8 * k, 0), path, 0.03, (0, 0, 0.2 * math.sin(3 * k)))

plaster = texture(material("Plaster", roughness=0.9), "Noise", (0.62, 0.5, 0.36), (0.72, 0.6, 0.45), 0.35, scale=14, detail=8)
frame = material("Frame", (0.8, 0.8, 0.77), roughness=0.35)
pane, curtain = glass("Pane"), material("Curtain", (0.75, 0.7, 0.6), roughness=0.9)
wood = texture(material("Door", roughness=0.5), "Wave", (0.1, 0.05, 0.025), (0.2, 0.1, 0.05), 0.2, scale=3, distortion=5, stretch=(1, 1, 0.1))
# The house is walls about its openings, with a dark room behind.
openings = [(-3.4, 1.3), (-0.9, 1.3), (2.9, 1.3)]
y = 3.2
posts = [(-5.2, -4.05), (-2.75, -1.55), (-0.25, 0.4), (1.4, 2.25), (3.55, 5.2)]
for k, (a, b) in enumerate(posts):
    box(f"Wall {k}", (b - a, 0.3, 3.2), ((a + b) / 2, y, 0), plaster, 0)
for k, (x, _) in enumerate(openings):
    box(f"Sill Wall {k}", (1.3, 0.3, 1.0), (x, y, 0), plaster, 0)
    box(f"Lintel {k}", (1.3, 0.3, 0.8), (x, y, 2.4), plaster, 0)
    box(f"Sill {k}", (1.5, 0.5, 0.06), (x, y - 0.08, 0.98), frame)
    for turn, size, place in ((0, (1.3, 0.08, 0.07), (x, y, 1.04)), (0, (1.3, 0.08, 0.07), (x, y, 2.33)), (0, (0.07, 0.08, 1.36), (x, y, 1.04)),
                              (0, (0.07, 0.08, 1.36), (x - 0.62, y, 1.04)), (0, (0.07, 0.08, 1.36), (x + 0.62, y, 1.04))):
        box(f"Frame {k}", size, place, frame, 0.01)
    box(f"Pane {k}", (1.25, 0.012, 1.3), (x, y, 1.07), pane, 0)
    for side in (-1, 1):
        folds = [(x + side * (0.6 - 0.02 * n), y + 0.25 + 0.03 * math.sin(1.3 * n), z) for z in (1.0, 2.4) for n in range(16)]
        mesh(f"Curtain {k}", folds, [(n, n + 1, n + 17, n + 16) for n in range(15)], curtain, smooth=True)
box("Lintel D", (1.0, 0.3, 0.9), (0.9, y, 2.3), plaster, 0)
box("Door", (1.0, 0.08, 2.3), (0.9, y + 0.05, 0), wood)
ball("Knob", 0.05, (1.28, y - 0.05, 1.05), material("Brass", (0.8, 0.6, 0.25), metallic=1.0, roughness=0.25))
plane("Floor inside", (10.4, 3), (0, y + 1.6, 0.02), wood)
plane("Back inside", (10.4, 3.2), (0, y + 3.1, 1.6), plaster, (math.pi / 2, 0, 0))
tiles = texture(material("Tiles", roughness=0.7), "Wave", (0.2, 0.06, 0.035), (0.36, 0.12, 0.06), 0.7, scale=2.2, low=0.1, high=0.6, stretch=(0, 1, 0))
roof = plane("Roof", (11.4, 3.8), (0, y + 1.1, 3.95), tiles, (0.5, 0, 0))
modifier(roof, "SOLIDIFY", thickness=0.12)
box("Gutter", (11.4, 0.12, 0.1), (0, y - 0.62, 3.02), frame, 0.03)

bark = texture(material("Bark", roughness=0.95), "Noise", (0.07, 0.05, 0.035), (0.2, 0.15, 0.11), 0.8, scale=5, stretch=(4, 4, 0.7))
leaf = leafy("Leaf", (0.09, 0.2, 0.025), (0.2, 0.4, 0.04), roughness=0.45)
branches = bpy.data.curves.new("Tree", "CURVE")
branches.dimensions, branches.bevel_depth, branches.use_fill_caps = "3D", 1.0, True
branches.materials.append(bark)
tips = []


def grow(at, along, length, radius, level):
    spline = branches.splines.new("POLY")
    spline.points.add(3)
    for k, point in enumerate(spline.points):
        point.co, point.radius = (*at, 1), radius * (1 - 0.13 * k)
        at, along = at + along * length / 3, (along + Vector([random.uniform(-0.12, 0.12) for _ in range(3)])).normalized()
        if level >= 3 and k:
            tips.append(at.copy())
    if level < 4:
        for k in range(3 if level else 5):
            turn = 2 * math.pi * (k + random.random() * 0.6) / (3 if level else 5)
            lean = random.uniform(0.5, 0.9)
            grow(at - along * length * random.uniform(0.2, 0.45), (along + Vector((math.cos(turn), math.sin(turn), 0.1)) * lean).normalized(),
                 length * random.uniform(0.6, 0.8), radius * 0.55, level + 1)


grow(Vector((0, 0, -0.05)), Vector((0.05, 0, 1)), 1.6, 0.16, 0)
add("Tree", branches, (-2.6, 0.6, 0))
leaves, faces = [], []
bush = Vector((4.6, 1.8, 0.65))  # from the tree, in a pot
for tip in tips + 40 * [bush]:
    for _ in range(9):
        at = tip + Vector([random.gauss(0, 0.13) for _ in range(3)])
        turn = Vector([random.gauss(0, 1) for _ in range(3)]).to_track_quat("Z", "Y")
        first = len(leaves)
        leaves += [at + turn @ Vector(c) for c in ((-0.055, 0, 0), (0, -0.028, 0.012), (0.06, 0, 0), (0, 0.028, 0.012))]
        faces += [(first, first + 1, first + 2), (first, first + 2, first + 3)]
mesh("Leaves", leaves, faces, leaf, place=(-2.6, 0.6, 0))
pot = texture(material("Clay", roughness=0.8), "Noise", (0.4, 0.16, 0.08), (0.5, 0.22, 0.12), 0.2, scale=12)
turned("Pot", [(0, 0.02), (0.16, 0.02), (0.22, 0.4), (0.25, 0.4), (0.25, 0.45), (0.21, 0.45), (0.19, 0.35), (0, 0.33)], pot, (2.0, 2.4, 0.05))
camera([(1.9, -5.4, 1.5), (0.2, -5.6, 1.7)], (-0.4, 2.5, 1.5), 30)
save()
