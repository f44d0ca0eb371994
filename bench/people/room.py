"""A living room by day: sun and sky through a window, a lamp with a shade, a ceiling lamp; the camera walks in."""
import sys

sys.path.insert(0, __file__.rpartition("/")[0] or ".")
from making import *  # noqa: E402,F403

start(4)
sky(0.35, sky_type="NISHITA", sun_disc=False, sun_elevation=math.radians(30), sun_rotation=math.radians(250))
lamp("SUN", (0, 0, 9), (6, 1.2, 5.2), 4, (1, 0.88, 0.72), angle=math.radians(1))

wall = texture(material("Wall", roughness=0.9), "Noise", (0.7, 0.68, 0.62), (0.74, 0.72, 0.66), 0.1, scale=30)
parquet = texture(material("Parquet", roughness=0.3), "Brick", (0.3, 0.15, 0.07), (0.42, 0.24, 0.12), 0.1, low=0.0, high=1.0, scale=1.2)
brick = next(n for n in parquet.node_tree.nodes if n.type == "TEX_BRICK")
brick.inputs["Color1"].default_value, brick.inputs["Color2"].default_value = (0.36, 0.19, 0.09, 1), (0.27, 0.13, 0.06, 1)
brick.inputs["Mortar"].default_value, brick.inputs["Mortar Size"].default_value = (0.08, 0.04, 0.02, 1), 0.004
parquet.node_tree.links.new(brick.outputs["Color"], parquet.node_tree.nodes["Principled BSDF"].inputs["Base Color"])
white = material("White Lacquer", (0.8, 0.8, 0.78), roughness=0.3)
# A room of 5 x 6 x 2.7 m; its left wall has a window of 1.8 x 1.5 m, its corner lies at (-2.5, -3).
plane("Floor", (5, 6), (0, 0, 0), parquet)
box("Ceiling", (5.4, 6.4, 0.2), (0, 0, 2.7), wall, 0)
box("Wall Back", (5.4, 0.2, 2.7), (0, 3.1, 0), wall, 0)
box("Wall Front", (5.4, 0.2, 2.7), (0, -3.1, 0), wall, 0)
box("Wall Right", (0.2, 6, 2.7), (2.6, 0, 0), wall, 0)
for name, size, place in (("A", (0.2, 2.9, 2.7), (-2.6, -1.55, 0)), ("B", (0.2, 1.3, 2.7), (-2.6, 2.35, 0)),
                          ("C", (0.2, 1.8, 0.8), (-2.6, 0.8, 0)), ("D", (0.2, 1.8, 0.4), (-2.6, 0.8, 2.3))):
    box(f"Wall {name}", size, place, wall, 0)
for size, place in (((0.08, 1.8, 0.06), (-2.6, 0.8, 0.8)), ((0.08, 1.8, 0.06), (-2.6, 0.8, 2.24)), ((0.08, 0.06, 1.5), (-2.6, -0.07, 0.8)),
                    ((0.08, 0.06, 1.5), (-2.6, 1.67, 0.8)), ((0.06, 0.05, 1.5), (-2.6, 0.8, 0.8))):
    box("Window Frame", size, place, white)
plane("Pane", (1.42, 1.7), (-2.6, 0.8, 1.55), pane("Pane"), (0, math.pi / 2, 0))  # one face: in two Fresnel would mirror within
box("Window Sill", (0.3, 1.9, 0.04), (-2.4, 0.8, 0.78), white)
plane("Lawn outside", (60, 60), (-33, 0, -0.5), material("Grass", (0.1, 0.2, 0.05), roughness=0.9))
for side in (-1, 1):
    folds = [(-2.4 + 0.04 * math.sin(1.1 * n), 0.8 + side * (0.85 + 0.022 * n), z) for z in (0.06, 2.5) for n in range(24)]
    curtain = mesh("Curtain", folds, [(n, n + 1, n + 25, n + 24) for n in range(23)], material("Linen", (0.55, 0.5, 0.42), roughness=0.9), smooth=True)
for x, y, size in ((0, 2.97, (5, 0.03, 0.1)), (2.47, 0, (0.03, 6, 0.1))):
    box("Skirting", size, (x, y, 0), white, 0.005)

cloth = texture(material("Cloth", (0.12, 0.2, 0.22), roughness=0.95, sheen=0.5), "Voronoi", bump=0.35, scale=70)
for size, place, bevel in (((2.1, 0.9, 0.3), (0.7, 2.35, 0.12), 0.06), ((2.1, 0.25, 0.8), (0.7, 2.75, 0.12), 0.08), ((0.22, 0.9, 0.58), (-0.4, 2.35, 0.12), 0.07),
                           ((0.22, 0.9, 0.58), (1.8, 2.35, 0.12), 0.07), ((0.9, 0.75, 0.16), (0.22, 2.3, 0.42), 0.06), ((0.9, 0.75, 0.16), (1.18, 2.3, 0.42), 0.06)):
    box("Sofa", size, place, cloth, bevel)
cushion = material("Cushion", (0.6, 0.27, 0.08), roughness=0.9, sheen=0.3)
ball("Cushion", 0.26, (0.05, 2.5, 0.75), cushion, None, (0.9, 0.4, 0.9)).rotation_euler = (-0.35, 0.2, 0.3)
oak = texture(material("Oak", roughness=0.35), "Wave", (0.3, 0.17, 0.08), (0.42, 0.26, 0.13), 0.1, scale=4, distortion=4, stretch=(0.2, 1, 1))
box("Table Top", (1.2, 0.7, 0.04), (0.6, 1.0, 0.4), oak)
for x in (0.08, 1.12):
    for y in (0.72, 1.28):
        box("Table Leg", (0.05, 0.05, 0.4), (x, y, 0), oak, 0.005)
box("Rug", (2.4, 1.7, 0.02), (0.6, 1.05, 0.001), texture(material("Rug", roughness=1.0), "Magic", (0.4, 0.08, 0.06), (0.55, 0.42, 0.3), 0.3, scale=3, low=0.3, high=0.7))
turned("Bowl", [(0, 0), (0.08, 0), (0.16, 0.08), (0.17, 0.1), (0.15, 0.09), (0.07, 0.02), (0, 0.015)], glass("Blue Glass", (0.5, 0.7, 0.95), 1.5), (0.9, 1.05, 0.44))
for k, color in enumerate(((0.6, 0.05, 0.03), (0.7, 0.35, 0.04), (0.35, 0.5, 0.06))):
    ball(f"Fruit {k}", 0.055, (0.9 + 0.06 * math.cos(2.1 * k), 1.05 + 0.06 * math.sin(2.1 * k), 0.53), material(f"Fruit {k}", color, roughness=0.3))
for k in range(3):
    box(f"Book {k}", (0.28, 0.2, 0.03), (0.35, 0.95, 0.44 + 0.03 * k), material(f"Cover {k}", ((0.5, 0.1, 0.1), (0.1, 0.25, 0.4), (0.75, 0.7, 0.55))[k], roughness=0.6), 0.003, (0, 0, 0.3 * k))
for k in range(4):
    box("Shelf", (0.3, 1.2, 0.03), (2.33, 1.0, 0.6 + 0.45 * k), white, 0.003)
    for n in range(14 if k < 3 else 0):
        high, color = random.uniform(0.2, 0.33), [random.uniform(0.05, 0.6) for _ in range(3)]
        box(f"Volume {k} {n}", (0.2, 0.05, high), (2.36, 0.45 + 0.065 * n, 0.63 + 0.45 * k), material(f"Back {k} {n}", color, roughness=0.6), 0.004)
painting = texture(material("Painting", roughness=0.7), "Noise", (0.05, 0.1, 0.3), (0.85, 0.6, 0.3), scale=2, detail=4, distortion=3)
plane("Painting", (1.1, 0.75), (0.7, 2.975, 1.65), painting, (math.pi / 2, 0, 0))
gold = material("Gilt", (0.8, 0.58, 0.25), metallic=1.0, roughness=0.35)
for size, place in (((1.22, 0.06, 0.06), (0.7, 2.97, 1.24)), ((1.22, 0.06, 0.06), (0.7, 2.97, 2.0)), ((0.06, 0.06, 0.76), (0.12, 2.97, 1.27)), ((0.06, 0.06, 0.76), (1.28, 2.97, 1.27))):
    box("Picture Frame", size, place, gold, 0.015)
plane("Mirror", (0.7, 1.5), (-1.6, 2.985, 1.25), material("Mirror", (0.95, 0.95, 0.95), metallic=1.0, roughness=0.0), (math.pi / 2, 0, 0))

# A lamp of a bulb in a shade through which light comes, and a ceiling lamp that glows.
shade = leafy("Shade", (0.8, 0.72, 0.58), (0.8, 0.66, 0.45), 0.5, roughness=0.9)
turned("Foot", [(0, 0), (0.15, 0), (0.15, 0.02), (0.015, 0.04), (0.012, 1.4), (0, 1.4)], gold, (2.15, 2.55, 0))
turned("Shade", [(0.22, 1.3), (0.14, 1.62)], shade, (2.15, 2.55, 0), subdivided=1)
lamp("POINT", (2.15, 2.55, 1.46), (0, 0, 0), 22, (1, 0.72, 0.42), "Bulb", shadow_soft_size=0.04)
glow = material("Glow", (0.8, 0.8, 0.8), emission=(1, 0.82, 0.6, 1), emission_strength=6)
ball("Globe", 0.16, (-0.9, 1.5, 2.2), glow)
box("Rod", (0.02, 0.02, 0.35), (-0.9, 1.5, 2.35), gold, 0)
camera([(1.3, -2.7, 1.5), (0.8, -1.7, 1.45)], (0.15, 1.8, 1.05), 22)
save()
