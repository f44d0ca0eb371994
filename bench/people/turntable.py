"""A bottle of perfume on a turntable out of doors: glass with a liquid, brushed metal, clear coat, relief; lens and shutter."""
import sys

sys.path.insert(0, __file__.rpartition("/")[0] or ".")
from making import *  # noqa: E402,F403

scene = start(4)
scene.render.use_motion_blur = True
sky(0.25, sky_type="NISHITA", sun_disc=False, sun_elevation=math.radians(35), sun_rotation=math.radians(140))
lamp("AREA", (-0.9, -0.7, 1.1), (0, 0, 0.1), 12, (1, 0.95, 0.9), size=0.8)
lamp("AREA", (0.8, 0.5, 0.6), (0, 0, 0.1), 6, (0.85, 0.92, 1), shape="RECTANGLE", size=0.3, size_y=0.9)

wood = texture(material("Wood", roughness=0.45), "Wave", (0.16, 0.07, 0.03), (0.36, 0.19, 0.09), 0.15, low=0.2, high=0.9,
               scale=14, distortion=5, detail=3, stretch=(1, 0.15, 1))
plane("Table", (2.4, 2), (0, 0, 0), wood)
turntable = keyed(add("Turntable", None), "rotation_euler", (0, 0, 0), (0, 0, 2 * math.pi))
lacquer = material("Lacquer", (0.35, 0.01, 0.015), roughness=0.4, clearcoat=1.0, clearcoat_roughness=0.03)
turned("Disk", [(0, 0.002), (0.139, 0.002), (0.14, 0.004), (0.14, 0.021), (0.139, 0.022), (0, 0.022)], lacquer, parent=turntable, steps=64)
brushed = material("Brushed Metal", (0.8, 0.78, 0.75), metallic=1.0, roughness=0.3, anisotropic=0.6)
turned("Ring", [(0.141, 0.006), (0.146, 0.006), (0.146, 0.018), (0.141, 0.018), (0.141, 0.006)], brushed, parent=turntable, steps=64)

# The liquid reaches into the wall, so that no air is between.
inner = [(0, 0.034), (0.032, 0.034), (0.037, 0.038), (0.037, 0.105), (0.034, 0.118), (0.016, 0.126), (0.012, 0.13), (0.012, 0.146)]
outer = [(0, 0.023), (0.040, 0.023), (0.045, 0.027), (0.045, 0.107), (0.041, 0.124), (0.022, 0.133), (0.017, 0.136), (0.017, 0.146)]
turned("Bottle", outer + inner[::-1], glass("Glass"), parent=turntable)
turned("Perfume", [(0, 0.0335), (0.0325, 0.0335), (0.0375, 0.038), (0.0375, 0.092), (0.0375, 0.0925), (0, 0.0925)],
       glass("Perfume", (1, 0.55, 0.2), 1.33), parent=turntable)
turned("Collar", [(0.0175, 0.137), (0.021, 0.137), (0.021, 0.147), (0.0125, 0.147)], brushed, parent=turntable)
cap = texture(material("Cap", (0.02, 0.02, 0.022), roughness=0.35), "Voronoi", bump=0.2, scale=160)
box("Cap", (0.046, 0.046, 0.05), (0, 0, 0.148), cap, 0.004, parent=turntable)
label = material("Label", (0.9, 0.87, 0.8), roughness=0.6)
turned("Label", [(0.0453, 0.05), (0.0453, 0.085)], label, parent=turntable)
for k in range(7):
    angle = 0.9 * k + 0.3
    pebble = texture(material(f"Pebble {k}", roughness=0.7), "Noise", (0.2, 0.19, 0.18), (0.45, 0.43, 0.4), 0.3, scale=60)
    ball(f"Pebble {k}", 0.014 + 0.003 * (k % 3), (0.1 * math.cos(angle), 0.1 * math.sin(angle), 0.03), pebble, turntable, (1.2, 0.9, 0.6))
camera([(0, -0.66, 0.27)], (0, 0, 0.1), 60, 2.0)
save()
