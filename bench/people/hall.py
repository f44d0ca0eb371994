"""A pillared hall by day: the sun through tall windows on a polished floor, columns, vaults, banners; the camera walks down the nave."""
import sys

sys.path.insert(0, __file__.rpartition("/")[0] or ".")
from making import *  # noqa: E402,F403

start(5)
sky(0.5, sky_type="NISHITA", sun_disc=False, sun_elevation=math.radians(38), sun_rotation=math.radians(100))
lamp("SUN", (12, -3, 12), (0, 2, 0), 5, (1, 0.93, 0.82), angle=math.radians(0.6))

stone = texture(material("Stone", roughness=0.8), "Noise", (0.42, 0.38, 0.32), (0.56, 0.51, 0.43), 0.2, scale=6, detail=6)
plaster = texture(material("Plaster", roughness=0.9), "Noise", (0.62, 0.58, 0.5), (0.72, 0.68, 0.6), 0.1, scale=12)
marble = texture(material("Marble", roughness=0.15), "Wave", (0.3, 0.27, 0.24), (0.62, 0.6, 0.56), scale=0.8, distortion=6, detail=3)
oak = texture(material("Oak", roughness=0.4), "Wave", (0.16, 0.08, 0.04), (0.26, 0.15, 0.08), 0.1, scale=4, distortion=4, stretch=(0.2, 1, 1))
brass = material("Brass", (0.8, 0.6, 0.28), metallic=1.0, roughness=0.3)

# A nave of 6 x 24 x 7 m between aisles of 3 m, its axis along y; windows in the wall at x = 6 only.
LENGTH, BAY = 24, 4
plane("Floor", (12, LENGTH), (0, LENGTH / 2, 0), marble)
box("Wall Left", (0.4, LENGTH, 7.2), (-6.2, LENGTH / 2, 0), plaster, 0)
box("Wall Front", (12.8, 0.4, 7.2), (0, -0.2, 0), plaster, 0)
box("Wall Back", (12.8, 0.4, 7.2), (0, LENGTH + 0.2, 0), plaster, 0)
for bay in range(LENGTH // BAY):
    y = BAY * bay
    box(f"Pier {bay}", (0.4, 2.4, 7.2), (6.2, y, 0), plaster, 0)
    box(f"Parapet {bay}", (0.4, 1.6, 1.4), (6.2, y + 2, 0), plaster, 0)
    box(f"Lintel {bay}", (0.4, 1.6, 1.2), (6.2, y + 2, 6), plaster, 0)
    for side in (-1, 1):
        x = side * 3
        turned(f"Column {bay} {side}", [(0, 0), (0.45, 0), (0.45, 0.25), (0.32, 0.35), (0.28, 3.6), (0.3, 3.7), (0.5, 4.0), (0.5, 4.1), (0, 4.1)], stone, (x, y + 2, 0), subdivided=1)
        # Arches from column to column, a box of 16 wedges.
        for n in range(16):
            a = math.pi * (n + 0.5) / 16
            box("Arch", (0.5, 0.42, 0.3), (x, y + 4 - 1.9 * math.cos(a), 4.1 + 1.5 * math.sin(a)), stone, 0.01, (a - math.pi / 2, 0, 0))
        box("Wall Above", (0.3, BAY, 1.3), (x, y + 2, 5.9), plaster, 0)
    for n in range(10):  # A barrel vault over the nave.
        a = math.pi * (n + 0.5) / 10
        box("Vault", (1.0, BAY, 0.15), (3 * math.cos(a), y + 2, 7.0 + 1.8 * math.sin(a)), plaster, 0, (0, math.pi / 2 - a, 0))
    for side in (-1, 1):
        box("Aisle Ceiling", (3.4, BAY, 0.2), (4.6 * side, y + 2, 7.0), oak, 0)
    if bay % 2:
        color = ((0.5, 0.04, 0.05), (0.05, 0.12, 0.4))[bay // 2 % 2]
        folds = [(-3.0 + 0.05 * math.sin(1.3 * n), y + 1.5 + 0.06 * n, z) for z in (2.2, 5.2) for n in range(18)]
        mesh("Banner", folds, [(n, n + 1, n + 19, n + 18) for n in range(17)], leafy(f"Banner {bay}", color, color, 0.3, roughness=0.9), smooth=True)
for row in range(5):
    for side in (-1, 1):
        y = 10 + 1.5 * row
        box("Bench", (2.2, 0.4, 0.06), (side * 1.5, y, 0.42), oak)
        box("Bench Back", (2.2, 0.06, 0.5), (side * 1.5, y + 0.2, 0.44), oak)
        for x in (-0.95, 0.95):
            box("Bench Side", (0.08, 0.44, 0.44), (side * 1.5 + x, y, 0), oak)
turned("Font", [(0, 0), (0.5, 0), (0.5, 0.1), (0.15, 0.2), (0.15, 0.8), (0.5, 1.05), (0.5, 1.1), (0.4, 1.05), (0, 0.95)], marble, (0, 20, 0))
ball("Orb", 0.3, (0, 20, 1.45), brass)
camera([(-0.8, 1.2, 1.7), (0.4, 4.5, 1.8)], (0.3, 18, 2.2), 24)
save()
