"""A market by night: strings of bulbs, lanterns, a shop's window, wet cobbles; the camera goes along the stalls."""
import sys

sys.path.insert(0, __file__.rpartition("/")[0] or ".")
from making import *  # noqa: E402,F403

start(4)
sky(0.02, color=(0.3, 0.45, 0.9))

cobbles = texture(material("Cobbles", (0.1, 0.1, 0.1), roughness=0.25), "Voronoi", (0.06, 0.055, 0.05), (0.14, 0.13, 0.12), 0.6, scale=9)
brick = texture(material("Brick", roughness=0.9), "Brick", (0.25, 0.11, 0.07), (0.4, 0.2, 0.13), 0.3, low=0.0, high=1.0, scale=3)
wood = texture(material("Planks", roughness=0.6), "Wave", (0.2, 0.12, 0.06), (0.34, 0.22, 0.12), 0.2, scale=3, distortion=3, stretch=(0.2, 1, 1))
iron = material("Iron", (0.05, 0.05, 0.05), metallic=1.0, roughness=0.5)
plane("Ground", (30, 40), (0, 10, 0), cobbles)
box("House Left", (1, 30, 8), (-5.5, 10, 0), brick, 0)
box("House Right", (1, 30, 8), (5.5, 10, 0), brick, 0)
box("House End", (12, 1, 8), (0, 24, 0), brick, 0)

# A shop's window of an emitter behind a pane.
plane("Shop", (1.6, 2.4), (-4.98, 5.0, 1.7), material("Shop Light", emission=(1, 0.85, 0.6, 1), emission_strength=4), (0, math.pi / 2, 0))
plane("Shop Pane", (1.7, 2.5), (-4.9, 5.0, 1.7), pane("Shop Pane"), (0, math.pi / 2, 0))

goods = [material(f"Goods {k}", c, roughness=0.35) for k, c in enumerate(((0.6, 0.05, 0.03), (0.75, 0.38, 0.04), (0.3, 0.45, 0.06), (0.5, 0.42, 0.1)))]
glow = [material(f"Lantern {k}", c, emission=(*c, 1), emission_strength=5) for k, c in enumerate(((1, 0.5, 0.2), (1, 0.75, 0.4), (0.9, 0.25, 0.15)))]
for k in range(6):
    side, y = 1 - 2 * (k % 2), 3 + 2.6 * k
    x = 2.9 * side
    box("Counter", (1.3, 2, 0.9), (x, y, 0), wood)
    color = ((0.6, 0.08, 0.06), (0.08, 0.25, 0.4), (0.7, 0.6, 0.35))[k % 3]
    awning = leafy(f"Awning {k}", color, color, 0.4, roughness=0.9)
    mesh("Awning", [(x - 0.9 * side, y - 1.2, 2.2), (x - 0.9 * side, y + 1.2, 2.2), (x + 0.9 * side, y + 1.2, 2.7), (x + 0.9 * side, y - 1.2, 2.7)], [(0, 1, 2, 3)], awning)
    for dx in (-0.85, 0.85):
        for dy in (-1.1, 1.1):
            box("Post", (0.05, 0.05, 2.3), (x + dx, y + dy, 0), iron, 0)
    for n in range(14):
        ball("Fruit", 0.09, (x + 0.22 * (n % 4) - 0.33, y - 0.6 + 0.3 * (n // 4), 0.98), goods[(k + n // 4) % 4])
    ball("Lantern", 0.14, (x - 0.6 * side, y, 1.95), glow[k % 3])
    lamp("SPOT", (x, y, 2.3), (x, y, 0), 30, (1, 0.8, 0.55), spot_size=math.radians(95), spot_blend=0.4, shadow_soft_size=0.04)
for row in range(5):
    for n in range(9):
        t = n / 8
        place = (-4.9 + 9.8 * t, 1.5 + 3.5 * row, 4.3 - 2.2 * t * (1 - t))
        lamp("POINT", place, (0, 0, 0), 6, (1, 0.7, 0.38), "Bulb", shadow_soft_size=0.03)
passer = material("Coat", (0.1, 0.12, 0.2), roughness=0.8)
walker = turned("Passer", [(0, 0), (0.25, 0), (0.22, 0.9), (0.28, 1.35), (0.1, 1.5), (0.12, 1.6), (0.11, 1.72), (0, 1.78)], passer, (0.6, 9, 0))
keyed(walker, "location", Vector((0.6, 9, 0)), Vector((-0.4, 5, 0)))
camera([(0.3, -1.5, 1.65), (-0.3, 1.5, 1.6)], (0, 10, 1.4), 28)
save()
