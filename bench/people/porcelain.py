"""A cup of coffee and a vase before white: a product studio of three soft boxes, past which the camera glides."""
import sys

sys.path.insert(0, __file__.rpartition("/")[0] or ".")
from making import *  # noqa: E402,F403

start(4)
sky(0.4, color=(0.9, 0.95, 1))
cyclorama(material("White"), 14, 6, 7, 2)
lamp("AREA", (-3, -2, 4), (0, 0, 0.5), 260, size=2)
lamp("AREA", (3.5, -1, 2.5), (0, 0, 0.5), 90, (1, 0.93, 0.85), shape="RECTANGLE", size=1, size_y=2.5)
lamp("AREA", (0.5, 3, 4.5), (0, 0.5, 0), 120, (0.85, 0.92, 1), size=1.5)

china = material("China", (0.85, 0.84, 0.82), roughness=0.12)
turned("Saucer", [(0, 0.02), (0.3, 0.02), (0.32, 0.0), (0.36, 0.0), (0.38, 0.03), (0.72, 0.11), (0.73, 0.125), (0.70, 0.12), (0.38, 0.06), (0, 0.06)],
       china, (-0.75, 0, 0))
turned("Cup", [(0, 0.07), (0.22, 0.07), (0.27, 0.062), (0.3, 0.09), (0.42, 0.3), (0.47, 0.62), (0.465, 0.63), (0.445, 0.62), (0.4, 0.32),
               (0.27, 0.12), (0, 0.11)], china, (-0.75, 0, 0))
turned("Coffee", [(0, 0.13), (0.27, 0.13), (0.425, 0.46), (0.433, 0.5), (0.42, 0.505), (0, 0.505)],
       material("Coffee", (0.045, 0.014, 0.005), roughness=0.05), (-0.75, 0, 0))
bpy.ops.mesh.primitive_torus_add(location=(-0.25, -0.02, 0.36), rotation=(math.pi / 2, 0, 0), major_radius=0.16, minor_radius=0.035)
handle = bpy.context.object
handle.name = "Handle"
handle.data.materials.append(china)
bpy.ops.object.shade_smooth()

glaze = texture(material("Glaze", roughness=0.25, clearcoat=0.8, clearcoat_roughness=0.05), "Noise", (0.02, 0.09, 0.16), (0.1, 0.35, 0.4),
                scale=2.5, detail=8, distortion=1.5)
turned("Vase", [(0, 0), (0.3, 0), (0.34, 0.02), (0.5, 0.4), (0.55, 0.75), (0.42, 1.2), (0.2, 1.5), (0.17, 1.7), (0.26, 1.9), (0.24, 1.905),
                (0.14, 1.72), (0.17, 1.48), (0.38, 1.2), (0.5, 0.75), (0.3, 0.06), (0, 0.05)], glaze, (0.75, 0.6, 0))
bark = texture(material("Bark", roughness=0.9), "Noise", (0.1, 0.06, 0.04), (0.25, 0.17, 0.12), 0.5, scale=20)
petal = material("Petal", (0.85, 0.55, 0.6), roughness=0.6, subsurface=0.0, sheen=0.3)
for k, (lean, high) in enumerate(((-0.25, 1.5), (0.1, 1.8), (0.35, 1.3))):
    twig = bpy.data.curves.new(f"Twig {k}", "CURVE")
    twig.dimensions, twig.bevel_depth = "3D", 0.018
    spline = twig.splines.new("BEZIER")
    spline.bezier_points.add(2)
    points = [(0, 0, 1.0), (0.1 * lean, 0.05, 1.9), (1.5 * lean, 0.1 * k, 1.4 + high)]
    for point, at in zip(spline.bezier_points, points):
        point.co, point.handle_left_type, point.handle_right_type = at, "AUTO", "AUTO"
    twig.materials.append(bark)
    add(twig.name, twig, (0.75, 0.6, 0))
    for n in range(9):
        share = 0.35 + 0.08 * n
        at = [a + (b - a) * share for a, b in zip(points[1], points[2])]
        ball(f"Bud {k} {n}", 0.05 + 0.02 * random.random(), [at[i] + o + random.uniform(-0.07, 0.07) for i, o in enumerate((0.75, 0.6, 0))],
             petal, None, (1, 1, 0.8))
spoon = material("Steel", (0.75, 0.75, 0.76), metallic=1.0, roughness=0.15)
ball("Spoon", 0.12, (-0.35, -0.75, 0.035), spoon, None, (1.5, 0.9, 0.22))
box("Spoon's Stem", (0.7, 0.05, 0.02), (0.1, -0.75, 0.035), spoon, 0.008)
camera([(-1.4, -7.2, 2.9), (1.0, -7.2, 2.2)], (0.1, 0.1, 1.2), 45)
save()
