# SPDX-FileCopyrightText: The render2mpeg authors
# SPDX-License-Identifier: Apache-2.0 OR GPL-3.0-or-later
"""Aimed reflections: empties below a mirror that tell it what to show, made by two clicks and listed with the object."""
import bpy
from bpy_extras import view3d_utils
from mathutils import Matrix, Vector


def aims_of(mirror):
    """Empties that tell it what to show."""
    return [thing for thing in mirror.children if thing.type == "EMPTY" and "aim_radius" in thing.keys()]


def view_under(context, event):
    """The view's region and the place in it under the mouse; None elsewhere."""
    for area in context.window.screen.areas:
        region = next((r for r in area.regions if r.type == "WINDOW"), None)
        if area.type == "VIEW_3D" and region:
            place = Vector((event.mouse_x - region.x, event.mouse_y - region.y))
            if 0 <= place.x < region.width and 0 <= place.y < region.height:
                return region, area.spaces.active.region_3d, place
    return None


def thing_under(context, view):
    """What is seen at a place of a view, and where: by its surface, else by its origin within 30 pixels."""
    origin, direction = view3d_utils.region_2d_to_origin_3d(*view), view3d_utils.region_2d_to_vector_3d(*view)
    met, place, _, _, thing, _ = context.scene.ray_cast(context.evaluated_depsgraph_get(), origin, direction)
    if met:
        return thing.original, place
    region, region_3d, mouse = view
    near = []
    for other in context.visible_objects:
        at = view3d_utils.location_3d_to_region_2d(region, region_3d, other.matrix_world.translation)
        if at is not None and (at - mouse).length < 30:
            near.append(((at - mouse).length, other.name, other))
    return (min(near)[2], None) if near else (None, None)


class RENDER2MPEG_OT_aim(bpy.types.Operator):
    bl_idname, bl_label = "render2mpeg.aim", "Aim Reflection"
    bl_description = "Have the active object mirror something at a point: click the point on it, then what is to be seen there"
    bl_options = {"REGISTER", "UNDO"}
    point: bpy.props.FloatVectorProperty(name="Point", subtype="XYZ", description="On the mirror, in the world")
    target: bpy.props.StringProperty(name="Target", description="Name of the object to be seen there")
    picked = False

    @classmethod
    def poll(cls, context):
        return context.object is not None and context.object.type in {"MESH", "CURVE", "SURFACE", "FONT", "META"}

    def execute(self, context):
        mirror, target = context.object, bpy.data.objects.get(self.target)
        if target is None or target == mirror:
            self.report({"ERROR"}, f'"{self.target}" cannot be seen in {mirror.name}')
            return {"CANCELLED"}
        aim = bpy.data.objects.new(f"Aim {target.name}", None)
        mirror.users_collection[0].objects.link(aim)
        aim.parent, aim.matrix_parent_inverse = mirror, Matrix()
        aim.location = mirror.matrix_world.inverted_safe() @ Vector(self.point)
        aim.empty_display_type = "SPHERE"
        sizes = [max(c) - min(c) for c in zip(*mirror.bound_box)]
        aim["aim_target"] = target
        for name, says in (("aim_radius", "So far about the point the reflection is moved as a whole"),
                           ("aim_border", "So wide at least is the ring about it in which it fades")):
            aim[name] = 0.1 * max(sizes)
            aim.id_properties_ui(name).update(min=1e-4, soft_max=max(sizes), description=says)
        aim.empty_display_size = aim["aim_radius"]
        return {"FINISHED"}

    def invoke(self, context, _event):
        self.picked = False
        context.workspace.status_text_set(f"Click the point on {context.object.name}   (Esc ends)")
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        if event.type in {"ESC", "RIGHTMOUSE"}:
            context.workspace.status_text_set(None)
            return {"CANCELLED"}
        view = view_under(context, event)
        if event.type != "LEFTMOUSE" or event.value != "PRESS" or view is None:
            return {"PASS_THROUGH"}
        thing, place = thing_under(context, view)
        if not self.picked and thing == context.object and place is not None:
            self.picked, self.point = True, place
            context.workspace.status_text_set("Click what is to be seen there   (Esc ends)")
        elif self.picked and thing is not None and thing != context.object:
            context.workspace.status_text_set(None)
            self.target = thing.name
            return self.execute(context)
        return {"RUNNING_MODAL"}


class RENDER2MPEG_OT_forget_aim(bpy.types.Operator):
    bl_idname, bl_label = "render2mpeg.forget_aim", "Remove"
    bl_description = "Let this point mirror what it does by itself"
    bl_options = {"REGISTER", "UNDO"}
    aim: bpy.props.StringProperty()

    def execute(self, _context):
        aim = bpy.data.objects.get(self.aim)
        if aim is None or "aim_radius" not in aim.keys():
            return {"CANCELLED"}
        bpy.data.objects.remove(aim)
        return {"FINISHED"}


class RENDER2MPEG_PT_aims(bpy.types.Panel):
    bl_label, bl_idname = "Aimed Reflections (render2mpeg)", "RENDER2MPEG_PT_aims"
    bl_space_type, bl_region_type, bl_context = "PROPERTIES", "WINDOW", "object"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context):
        return RENDER2MPEG_OT_aim.poll(context)

    def draw(self, context):
        self.layout.operator("render2mpeg.aim", icon="EMPTY_SINGLE_ARROW")
        for aim in aims_of(context.object):
            box = self.layout.box()
            row = box.row()
            row.label(text=getattr(aim.get("aim_target"), "name", "no target"))
            row.operator("render2mpeg.forget_aim", text="", icon="X").aim = aim.name
            box.prop(aim, '["aim_radius"]', text="Radius")
            box.prop(aim, '["aim_border"]', text="Border")


def draw_aim(self, _context):
    self.layout.operator_context = "INVOKE_DEFAULT"
    self.layout.operator("render2mpeg.aim")


CLASSES = (RENDER2MPEG_OT_aim, RENDER2MPEG_OT_forget_aim, RENDER2MPEG_PT_aims)
