"""A kitchen in the morning: sun through a window's panes onto tiles with relief, steel, a mirror, spots in the ceiling; the camera glides past."""
import sys

sys.path.insert(0, __file__.rpartition("/")[0] or ".")
from making import *  # noqa: E402,F403

start(4)
sky(0.35, sky_type="NISHITA", sun_disc=False, sun_elevation=math.radians(44), sun_rotation=math.radians(260))
lamp("SUN", (0, 0, 9), (6.5, 0.6, 2.6), 6, (1, 0.9, 0.75), angle=math.radians(0.6))


def tiles(name, color, scale, roughness):
    """Bricks without offset: squares with joints, each a little different, over which light glances."""
    made = texture(material(name, color, roughness=roughness), "Brick", bump=0.35, scale=scale, mortar_size=0.02, brick_width=0.5, row_height=0.5)
    node = next(n for n in made.node_tree.nodes if n.type == "TEX_BRICK")
    node.offset = 0
    for key, share in (("Color1", 1.0), ("Color2", 0.85), ("Mortar", 0.35)):
        node.inputs[key].default_value = (*[share * c for c in color], 1)
    made.node_tree.links.new(node.outputs["Color"], made.node_tree.nodes["Principled BSDF"].inputs["Base Color"])
    next(n for n in made.node_tree.nodes if n.type == "BUMP").invert = True  # the texture is 1 in joints
    return made


floor, splash = tiles("Floor Tiles", (0.5, 0.47, 0.42), 1.6, 0.2), tiles("Wall Tiles", (0.75, 0.78, 0.76), 4, 0.12)
wall = texture(material("Wall", roughness=0.9), "Noise", (0.72, 0.68, 0.6), (0.76, 0.72, 0.64), 0.08, scale=30)
lacquer = material("Lacquer", (0.12, 0.2, 0.19), roughness=0.4)
wood = texture(material("Worktop", roughness=0.35), "Wave", (0.25, 0.13, 0.06), (0.42, 0.25, 0.13), 0.05, scale=3, distortion=6, detail=3, stretch=(0.2, 2, 1))
steel = material("Steel", (0.62, 0.61, 0.6), metallic=1.0, roughness=0.28)
chrome = material("Chrome", (0.85, 0.85, 0.85), metallic=1.0, roughness=0.06)
white = material("White", (0.8, 0.8, 0.78), roughness=0.35)

# A room of 4.4 x 4 x 2.6 m; its left wall has a window of 1.6 x 1.2 m with four panes.
plane("Floor", (4.4, 4), (0, 0, 0), floor)
box("Ceiling", (4.8, 4.4, 0.2), (0, 0, 2.6), wall, 0)
box("Wall Back", (4.8, 0.2, 2.6), (0, 2.1, 0), wall, 0)
box("Wall Front", (4.8, 0.2, 2.6), (0, -2.1, 0), wall, 0)
box("Wall Right", (0.2, 4, 2.6), (2.3, 0, 0), wall, 0)
for name, size, place in (("A", (0.2, 1.8, 2.6), (-2.3, -1.1, 0)), ("B", (0.2, 0.6, 2.6), (-2.3, 1.7, 0)),
                          ("C", (0.2, 1.6, 1.0), (-2.3, 0.6, 0)), ("D", (0.2, 1.6, 0.4), (-2.3, 0.6, 2.2))):
    box(f"Wall {name}", size, place, wall, 0)
clear = pane("Pane")
for y in (-0.2, 0.6, 1.4):
    box("Post", (0.07, 0.06, 1.2), (-2.3, y, 1.0), white)
for z in (1.0, 1.57, 2.14):
    box("Bar", (0.07, 1.6, 0.06), (-2.3, 0.6, z), white)
for y in (0.2, 1.0):
    for z in (1.315, 1.885):
        plane("Pane", (0.52, 0.74), (-2.3, y, z), clear, (0, math.pi / 2, 0))
box("Sill", (0.3, 1.7, 0.03), (-2.12, 0.6, 0.985), white)
plane("Meadow", (60, 60), (-33, 0, -0.4), material("Meadow", (0.12, 0.2, 0.06), roughness=0.9))

# A row of units along the back wall: doors with handles, a worktop with a sink's tap, an oven with a pane, a fridge at the end.
for k in range(4):
    x = -1.5 + 0.75 * k
    front = steel if k == 2 else lacquer
    box(f"Unit {k}", (0.73, 0.58, 0.82), (x, 1.7, 0.08), front, 0.008)
    box(f"Handle {k}", (0.5, 0.025, 0.02), (x, 1.39, 0.8), chrome, 0.006)
    if k != 2:
        box(f"Cupboard {k}", (0.73, 0.34, 0.62), (x, 1.82, 1.6), white, 0.008)
box("Oven Window", (0.5, 0.02, 0.34), (0, 1.4, 0.28), material("Dark Glass", (0.01, 0.01, 0.012), roughness=0.04), 0.004)
box("Hood", (0.73, 0.4, 0.25), (0, 1.78, 1.6), steel, 0.01)
box("Worktop", (3.05, 0.64, 0.04), (-0.37, 1.69, 0.9), wood, 0.004)
plane("Splash", (3.05, 0.66), (-0.37, 1.995, 1.27), splash, (math.pi / 2, 0, 0))
box("Fridge", (0.75, 0.66, 1.95), (1.65, 1.66, 0.02), steel, 0.02)
box("Fridge Handle", (0.03, 0.04, 0.9), (1.34, 1.31, 0.75), chrome, 0.01)
turned("Tap", [(0, 0), (0.03, 0), (0.025, 0.02), (0.016, 0.04), (0.016, 0.3), (0, 0.31)], chrome, (-1.5, 1.85, 0.94), steps=20, subdivided=1)
box("Spout", (0.025, 0.2, 0.02), (-1.5, 1.76, 1.22), chrome, 0.008)
box("Mirror", (0.02, 0.9, 1.1), (2.19, 0.2, 0.95), material("Mirror", (0.9, 0.9, 0.9), metallic=1.0, roughness=0.0), 0)
for y, z, size in ((0.2, 0.91, (0.03, 0.98, 0.04)), (0.2, 2.05, (0.03, 0.98, 0.04)), (-0.27, 0.91, (0.03, 0.04, 1.18)), (0.67, 0.91, (0.03, 0.04, 1.18))):
    box("Mirror Frame", size, (2.185, y, z), wood, 0.004)

# On the table and worktop what a morning leaves there.
box("Table Top", (1.3, 0.8, 0.04), (0.7, -0.1, 0.72), wood, 0.006)
for x in (0.12, 1.28):
    for y in (-0.43, 0.23):
        box("Leg", (0.05, 0.05, 0.72), (x, y, 0), white, 0.005)
bowl = [(0, 0), (0.08, 0), (0.09, 0.02), (0.17, 0.09), (0.18, 0.1), (0.165, 0.095), (0.08, 0.03), (0, 0.025)]
turned("Bowl", bowl, material("Enamel", (0.7, 0.15, 0.08), roughness=0.15), (0.6, -0.1, 0.76))
for k, (x, y, color) in enumerate(((0.53, -0.12, (0.7, 0.5, 0.05)), (0.65, -0.14, (0.35, 0.5, 0.05)), (0.61, -0.02, (0.6, 0.06, 0.04)))):
    ball(f"Fruit {k}", 0.062, (x, y, 0.86), material(f"Fruit {k}", color, roughness=0.4))
turned("Pan", [(0, 0), (0.13, 0), (0.14, 0.02), (0.14, 0.12), (0.132, 0.12), (0.13, 0.02), (0, 0.015)], steel, (0, 1.68, 0.94))
for k in range(3):
    high, glaze = 0.12 + 0.03 * k, material(f"Jar {k}", (0.8, 0.75 - 0.15 * k, 0.6 - 0.2 * k), roughness=0.2)
    turned(f"Jar {k}", [(0, 0), (0.05, 0), (0.055, 0.01), (0.055, high), (0.04, high + 0.03), (0, high + 0.03)], glaze, (-0.85 + 0.16 * k, 1.85, 0.94), steps=24, subdivided=1)
for x in (-1.2, 0.0, 1.2):
    turned("Spot Ring", [(0.045, 0.01), (0.06, 0.0), (0.065, 0.012)], chrome, (x, 0.6, 2.588), steps=24, subdivided=0)
    lamp("SPOT", (x, 0.6, 2.57), (x, 0.601, 0), 60, (1, 0.82, 0.6), name=f"Spot {x}", spot_size=math.radians(75), spot_blend=0.5, shadow_soft_size=0.03)
camera([(-0.9, -1.75, 1.5), (0.7, -1.7, 1.4)], (0.25, 1.2, 0.9), 22)
save()
