"""A head that turns before a studio's backdrop: skin below which light spreads, eyes, brows, and hair with children."""
import sys

sys.path.insert(0, __file__.rpartition("/")[0] or ".")
from making import *  # noqa: E402,F403


def bump(at, middle, radius):
    return math.exp(-sum(((a - m) / r) ** 2 for a, m, r in zip(at, middle, radius)))


def sculpted(p):
    """A unit sphere's point on a face that looks along -y."""
    x, y, z = p
    side = abs(x)
    at = Vector((0.76 * x, 0.95 * y, 1.08 * z))
    lower = max(0.0, -z)
    at.x *= 1 - 0.42 * lower ** 1.5
    at.y *= 1 - 0.22 * lower if y < 0 else 1 - 0.35 * lower
    push = 0.22 * bump((x, y, z), (0, -1, -0.22), (0.13, 0.6, 0.16)) + 0.13 * bump((x, y, z), (0, -1, -0.02), (0.1, 0.6, 0.22))
    push += 0.12 * bump((x, y, z), (0, -0.6, -0.9), (0.35, 0.5, 0.25)) + 0.07 * bump((x, y, z), (0, -0.85, -0.52), (0.26, 0.4, 0.08))
    push -= 0.05 * bump((x, y, z), (0, -0.85, -0.545), (0.22, 0.4, 0.022))
    push -= 0.14 * bump((side, y, z), (0.36, -0.9, 0.08), (0.2, 0.5, 0.14))
    push += 0.07 * bump((side, y, z), (0.5, -0.8, -0.2), (0.22, 0.4, 0.18)) + 0.06 * bump((side, y, z), (0.3, -0.95, 0.3), (0.3, 0.4, 0.1))
    at.y -= push
    return at


start(3)
sky(0.15, color=(0.7, 0.8, 1))
cyclorama(material("Backdrop", (0.18, 0.22, 0.26)), 16, 4, 8, 2).location.z = -2.6
lamp("AREA", (-2.6, -3, 2.4), (0, 0, 0), 280, (1, 0.93, 0.85), size=1.2)
lamp("AREA", (3, -1.8, 0.8), (0, 0, 0), 70, (0.8, 0.9, 1), size=1.8)
lamp("AREA", (1.6, 2.6, 2.6), (0, 0, 0.3), 240, shape="RECTANGLE", size=0.6, size_y=1.6)

neck = keyed(add("Turn", None), "rotation_euler", (0, 0, -0.45), (0, 0, 0.5))
skin = texture(material("Skin", (0.72, 0.42, 0.31), roughness=0.42, subsurface=0.3), "Noise", (0.68, 0.37, 0.27), (0.76, 0.47, 0.36),
               0.12, scale=9, detail=6)
skin.node_tree.nodes["Principled BSDF"].inputs["Subsurface Radius"].default_value = (0.12, 0.04, 0.02)
if bpy.app.version < (4, 0, 0):
    skin.node_tree.nodes["Principled BSDF"].inputs["Subsurface Color"].default_value = (0.72, 0.4, 0.3, 1)
bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=6)
head = bpy.context.object
head.name, head.parent = "Head", neck
head.data.materials.append(skin)
scalp, brows = head.vertex_groups.new(name="Scalp"), head.vertex_groups.new(name="Brows")
for vertex in head.data.vertices:
    x, y, z = vertex.co
    if z > 0.3 + 0.1 * math.cos(4 * x) - 0.75 * max(0, y + 0.45) and z > -0.5:
        scalp.add([vertex.index], 1.0, "REPLACE")
    if y < 0 and abs(z - 0.25 - 0.06 * math.sin(9 * (abs(x) - 0.15))) < 0.035 and 0.14 < abs(x) < 0.52:
        brows.add([vertex.index], 1.0, "REPLACE")
    vertex.co = sculpted(vertex.co)
bpy.ops.object.shade_smooth()
turned("Neck", [(0, -2.7), (0.62, -2.7), (0.5, -1.9), (0.42, -1.3), (0.4, -0.7), (0.3, -0.5), (0, -0.5)], skin, (0, 0.12, 0), neck)
shirt = texture(material("Shirt", (0.06, 0.1, 0.2), roughness=0.9, sheen=0.4), "Voronoi", bump=0.4, scale=40)
turned("Shoulders", [(0.5, -1.72), (0.56, -1.66), (0.72, -1.76), (1.35, -2.0), (1.6, -2.6), (1.6, -3)], shirt, (0, 0.12, 0), neck).scale.y = 0.6
white = material("White of the Eye", (0.85, 0.83, 0.8), roughness=0.08)
iris = material("Iris", (0.1, 0.2, 0.12), roughness=0.2)
pupil = material("Pupil", (0.005, 0.005, 0.005), roughness=0.1)
for side in (-1, 1):
    place = Vector((0.27 * side, -0.71, 0.09))
    ball(f"Eye {side}", 0.135, place, white, neck)
    ball(f"Iris {side}", 0.07, place + Vector((0, -0.082, 0)), iris, neck, (1, 0.8, 1))
    ball(f"Pupil {side}", 0.035, place + Vector((0, -0.118, 0)), pupil, neck, (1, 0.6, 1))
    ball(f"Lid {side}", 0.145, place + Vector((0, 0.025, 0.055)), skin, neck)
    ball(f"Ear {side}", 0.2, (0.74 * side, 0.1, -0.02), skin, neck, (0.35, 0.7, 1.15))
lips = material("Lips", (0.5, 0.17, 0.15), roughness=0.35)
ball("Lips", 0.14, (0, -0.74, -0.55), lips, neck, (1.2, 0.6, 0.3))


def fibres(name, melanin):
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    made.node_tree.nodes.clear()
    node, end = made.node_tree.nodes.new("ShaderNodeBsdfHairPrincipled"), made.node_tree.nodes.new("ShaderNodeOutputMaterial")
    node.parametrization = "MELANIN"
    node.inputs["Melanin"].default_value, node.inputs["Melanin Redness"].default_value = melanin, 0.6
    made.node_tree.links.new(node.outputs[0], end.inputs["Surface"])
    return made


hair(head, "Scalp", 900, 14, 0.5, fibres("Hair", 0.55), 0.009, brownian_factor=0.03, tangent_phase=0.0, normal_factor=0.06,
     object_align_factor=(0.0, 0.035, -0.03), clump_factor=0.35, roughness_2=0.03, child_length=0.9, child_radius=0.12, render_step=4)
hair(head, "Brows", 160, 6, 0.1, head.data.materials[1], 0.005, normal_factor=0.008, object_align_factor=(0, 0, 0.012), child_radius=0.04)
camera([(0.25, -5.6, 0.35), (0.0, -5.2, 0.15)], (0, -0.1, 0.08), 48)
save()
