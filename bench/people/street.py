"""A wet street at night: instances of lamp posts with their spots, lit windows, a car with its lights on, and fog."""
import sys

sys.path.insert(0, __file__.rpartition("/")[0] or ".")
from making import *  # noqa: E402,F403

start(4).cycles.volume_bounces = 12
world = sky(1.0, color=(0.004, 0.006, 0.012))
fog = world.node_tree.nodes.new("ShaderNodeVolumeScatter")
fog.inputs["Density"].default_value, fog.inputs["Anisotropy"].default_value = 0.012, 0.3
world.node_tree.links.new(fog.outputs[0], world.node_tree.nodes["World Output"].inputs["Volume"])

asphalt = texture(material("Asphalt", (0.03, 0.03, 0.032)), "Noise", 0.12, 0.6, 0.25, into="Roughness", scale=0.7, detail=8)
plane("Road", (8, 90), (0, 35, 0), asphalt)
slabs = texture(material("Pavement", roughness=0.7), "Brick", bump=0.5, scale=0.5)
slabs.node_tree.nodes["Principled BSDF"].inputs["Base Color"].default_value = (0.16, 0.15, 0.14, 1)
for side in (-1, 1):
    box("Pavement", (3, 90, 0.15), (5.5 * side, 35, 0), slabs, 0.03)
paint = material("Paint", (0.7, 0.7, 0.65), roughness=0.6)
for k in range(18):
    plane("Dash", (0.15, 2), (0, 4 * k - 2, 0.005), paint)

# One lamp post in a collection, which stands at twelve places.
post = bpy.data.collections.new("Lamp Post")
iron = material("Iron", (0.05, 0.06, 0.06), roughness=0.4, metallic=0.8)
bulb = material("Lamp Glass", (0.8, 0.8, 0.8), emission=(1, 0.62, 0.28, 1), emission_strength=40)
parts = [turned("Post", [(0, 0), (0.14, 0), (0.12, 0.5), (0.06, 0.7), (0.05, 5), (0, 5)], iron, steps=16, subdivided=1),
         box("Arm", (1.3, 0.07, 0.07), (0.6, 0, 4.95), iron), box("Hood", (0.5, 0.24, 0.12), (1.2, 0, 4.9), iron, 0.03),
         box("Lamp Glass", (0.36, 0.16, 0.04), (1.2, 0, 4.86), bulb, 0),
         lamp("SPOT", (1.2, 0, 4.8), (1.2, 0.001, 0), 2200, (1, 0.62, 0.28), spot_size=math.radians(120), spot_blend=0.4)]
for part in parts:
    bpy.context.scene.collection.objects.unlink(part)
    post.objects.link(part)
for k in range(6):
    for side in (-1, 1):
        place = add(f"Lamp Post {k} {side}", None, (4.4 * side, 10 * k + (0 if side < 0 else 5), 0.15), (0, 0, 0 if side < 0 else math.pi))
        place.instance_type, place.instance_collection = "COLLECTION", post

bricks = texture(material("Bricks", roughness=0.85), "Brick", bump=0.6, scale=1.2)
source = next(n for n in bricks.node_tree.nodes if n.type == "TEX_BRICK")
for name, color in (("Color1", (0.28, 0.1, 0.06, 1)), ("Color2", (0.2, 0.08, 0.05, 1)), ("Mortar", (0.25, 0.23, 0.2, 1))):
    source.inputs[name].default_value = color
turn = next(n for n in bricks.node_tree.nodes if n.type == "MAPPING")
turn.inputs["Rotation"].default_value = (math.pi / 2, 0, math.pi / 2)
bricks.node_tree.links.new(source.outputs["Color"], bricks.node_tree.nodes["Principled BSDF"].inputs["Base Color"])
stone = texture(material("Stone", roughness=0.8), "Noise", (0.25, 0.24, 0.22), (0.35, 0.33, 0.3), 0.3, scale=6)
dark = material("Dark Window", (0.02, 0.025, 0.03), roughness=0.05)
lit = [material(f"Lit Window {k}", (0.8, 0.8, 0.8), emission=(*c, 1), emission_strength=s)
       for k, (c, s) in enumerate((((1, 0.7, 0.35), 2.2), ((1, 0.85, 0.6), 1.2), ((0.5, 0.7, 1), 0.9)))]
for window in lit:
    window.cycles.sample_as_light = False  # large and many: rays find them
for side in (-1, 1):
    for k in range(7):
        high, depth = 6.5 + 3 * random.random(), 0.4 * random.random()
        x, y = side * (7 + depth), 9 * k + (0 if side < 0 else 3)
        box(f"House {side} {k}", (4, 8.9, high), (x + 2 * side, y, 0), bricks if (k + side) % 3 else stone, 0)
        for floor in range(int((high - 1) / 2.6)):
            for n in range(4):
                at = (x - 0.02 * side, y - 3.2 + 2.1 * n, 1.0 + 2.6 * floor)
                window = random.choice(lit) if random.random() < 0.35 else dark
                box("Window", (0.06, 1.0, 1.5), at, window, 0)
                box("Window Sill", (0.3, 1.2, 0.08), (at[0], at[1], at[2] - 0.08), stone, 0)

# A parked car, and one that drives away.
body = material("Car Paint", (0.25, 0.02, 0.02), roughness=0.35, metallic=0.4, clearcoat=1.0)
blue = material("Blue Paint", (0.02, 0.06, 0.2), roughness=0.35, metallic=0.4, clearcoat=1.0)
windows, rubber, chrome = material("Car Windows", (0.01, 0.01, 0.012), roughness=0.03), material("Rubber", (0.02, 0.02, 0.02)), material("Chrome", metallic=1.0, roughness=0.1)
rear = material("Rear Light", (0.3, 0.01, 0.01), emission=(1, 0.03, 0.02, 1), emission_strength=12)


def car(name, made, place, lights):
    whole = add(name, None, place)
    modifier(box("Body", (1.7, 4.1, 0.55), (0, 0, 0.35), made, 0.18, parent=whole), "SUBSURF", levels=1, render_levels=2)
    modifier(box("Cabin", (1.5, 2.1, 0.95), (0, -0.3, 0.6), windows, 0.35, parent=whole), "SUBSURF", levels=1, render_levels=2)
    box("Bumper", (1.6, 0.12, 0.12), (0, -2.05, 0.4), chrome, 0.03, parent=whole)
    for x in (-0.8, 0.8):
        for y in (-1.3, 1.3):
            wheel = turned("Wheel", [(0, -0.1), (0.24, -0.1), (0.33, -0.08), (0.33, 0.08), (0.24, 0.1), (0, 0.1)], rubber, (x, y, 0.33), whole, 1)
            wheel.rotation_euler = (0, math.pi / 2, 0)
        ball("Rear Light", 0.1, (0.72 * x / 0.8, -2.0, 0.68), rear if lights else rubber, whole, (1.3, 0.4, 0.7))
        if lights:
            beam = lamp("SPOT", (0.6 * x / 0.8, 2.1, 0.6), (0.6 * x / 0.8, 12, 0), 900, (0.9, 0.95, 1), spot_size=math.radians(50), spot_blend=0.6)
            beam.parent = whole
    return whole


car("Parked", blue, (3.0, 7, 0), False)
keyed(car("Driving", body, (-1.8, 9, 0), True), "location", (-1.8, 9, 0), (-1.8, 16, 0))
camera([(1.2, -4, 1.7), (0.8, -1, 1.6)], (-0.4, 14, 1.9), 28)
save()
