"""A title by night: letters of metal turn above a wet floor between strips of light; lens and shutter."""
import sys

sys.path.insert(0, __file__.rpartition("/")[0] or ".")
from making import *  # noqa: E402,F403

scene = start(3)
scene.render.use_motion_blur = True
sky(0.3, color=(0.012, 0.016, 0.03))
wet = texture(material("Wet Floor", (0.03, 0.032, 0.036), roughness=0.15), "Noise", bump=0.06, scale=1.5, detail=4)
plane("Floor", (30, 30), (0, 5, 0), wet)
plane("Wall", (30, 9), (0, 6, 4.5), texture(material("Concrete", roughness=0.85), "Noise", (0.16, 0.15, 0.15), (0.26, 0.25, 0.24), 0.3, scale=3, detail=8),
      (math.pi / 2, 0, 0))

metals = [material("Gold", (0.95, 0.68, 0.3), metallic=1.0, roughness=0.12), material("Steel", (0.75, 0.76, 0.78), metallic=1.0, roughness=0.22)]
for k, letter in enumerate("LUMEN"):
    text = bpy.data.curves.new(letter, "FONT")
    text.body, text.size, text.align_x = letter, 1.5, "CENTER"
    text.extrude, text.bevel_depth, text.bevel_resolution, text.resolution_u = 0.13, 0.025, 2, 6
    text.materials.append(metals[k % 2])
    turn = -0.5 + 0.15 * k
    keyed(add(f"Letter {k}", text, (-2.3 + 1.15 * k, 0.08 * (-1) ** k, 0.16)), "rotation_euler", (math.pi / 2, 0, turn), (math.pi / 2, 0, turn + 1.1))

for k, (color, x) in enumerate((((1, 0.25, 0.1), -3.1), ((0.15, 0.5, 1), 3.1), ((1, 0.75, 0.45), 0))):
    strip = material(f"Strip {k}", (0.02, 0.02, 0.02), emission=(*color, 1), emission_strength=14)
    box(f"Strip {k}", (0.07, 0.07, 3.4) if x else (5.6, 0.06, 0.06), (x, 1.6, 0.1) if x else (0, 5.6, 3.6), strip, 0.01)
spinner = turned("Spinner", [(0, 0), (0.28, 0.05), (0.3, 0.1), (0.06, 0.2), (0.04, 0.4), (0, 0.4)], metals[1], (1.9, -1.1, 0.02))
keyed(spinner, "rotation_euler", (0.12, 0, 0), (0.12, 0, 40))
lamp("AREA", (-1.5, -3.5, 4.5), (0, 0, 0.8), 130, (0.9, 0.95, 1), shape="RECTANGLE", size=2.5, size_y=0.5)
camera([(-1.6, -6.2, 1.1), (0.8, -5.6, 0.9)], (0, 0, 0.75), 32, 1.4)
save()
