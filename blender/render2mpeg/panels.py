# SPDX-FileCopyrightText: The render2mpeg authors
# SPDX-License-Identifier: Apache-2.0 OR GPL-3.0-or-later
"""The panel of the render properties, and Blender's own panels that mean something to this engine."""
import bpy

from .program import program

ENGINE = "RENDER2MPEG"
# Panels of EEVEE that show what all engines read; by other names in some versions.
SHARED = {"DATA_PT_EEVEE_light", "DATA_PT_camera_dof", "DATA_PT_camera_dof_aperture", "EEVEE_MATERIAL_PT_context_material",
          "EEVEE_MATERIAL_PT_surface", "EEVEE_MATERIAL_PT_volume", "EEVEE_WORLD_PT_surface", "EEVEE_WORLD_PT_volume"}
# Panels of all engines for what is told as not kept, or what EEVEE's show in full.
FOREIGN = {"DATA_PT_light", "RENDER_PT_stereoscopy", "RENDER_PT_gpencil", "RENDER_PT_freestyle", "RENDER_PT_hydra_debug",
           "VIEWLAYER_PT_layer", "MATERIAL_PT_freestyle_line", "RENDER_PT_time_stretching"}


class RenderPanel:
    bl_space_type, bl_region_type, bl_context = "PROPERTIES", "WINDOW", "render"

    def begin(self):
        self.layout.use_property_split = True
        self.layout.use_property_decorate = False
        return self.layout


class RENDER2MPEG_PT_panel(RenderPanel, bpy.types.Panel):
    bl_label, bl_idname = "render2mpeg", "RENDER2MPEG_PT_panel"

    def draw(self, context):
        settings, layout = context.scene.render2mpeg, self.begin()
        if program() is None:
            layout.label(text="render2mpeg is not installed", icon="ERROR")
        layout.prop(settings, "output")
        layout.prop(settings, "codec")
        layout.prop(settings, "control")
        layout.prop(settings, {"QUANTISER": "quantiser", "SIZE": "megabytes", "QUALITY": "decibels"}[settings.control])
        layout.prop(settings, "report")
        if context.engine == ENGINE and settings.control == "QUANTISER" and settings.effort != "DRAFT":
            layout.operator("render.render", text="Render Animation", icon="RENDER_ANIMATION").animation = True
        else:
            layout.prop(settings, "open_film")
            layout.operator("render2mpeg.film", text="Render Film", icon="RENDER_ANIMATION")


class RENDER2MPEG_PT_light(RenderPanel, bpy.types.Panel):
    bl_label, bl_idname, bl_parent_id = "Light", "RENDER2MPEG_PT_light", "RENDER2MPEG_PT_panel"

    def draw(self, context):
        settings, render, layout = context.scene.render2mpeg, context.scene.render, self.begin()
        layout.prop(settings, "effort")
        layout.prop(settings, "tolerance")
        layout.prop(settings, "loss" if settings.tolerance == "HIDDEN" else "percent")
        if context.engine == ENGINE:
            layout.prop(render, "use_motion_blur", text="Motion Blur")
            row = layout.row()
            row.active = render.use_motion_blur
            row.prop(render, "motion_blur_shutter")
            layout.prop(render, "film_transparent", text="Transparent")


class RENDER2MPEG_PT_forecast(RenderPanel, bpy.types.Panel):
    bl_label, bl_idname, bl_parent_id = "Forecast", "RENDER2MPEG_PT_forecast", "RENDER2MPEG_PT_panel"

    def draw(self, context):
        layout = self.begin()
        row = layout.row(align=True)
        row.operator("render2mpeg.forecast", icon="TIME")
        row.operator("render2mpeg.cost")
        told = layout.column(align=True)
        for line in context.window_manager.render2mpeg_forecast.replace("; ", "\n").replace(". ", "\n").splitlines():
            told.label(text=line[0].upper() + line[1:].rstrip("."))


class RENDER2MPEG_PT_elsewhere(RenderPanel, bpy.types.Panel):
    bl_label, bl_idname, bl_parent_id = "Render Elsewhere", "RENDER2MPEG_PT_elsewhere", "RENDER2MPEG_PT_panel"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        layout = self.begin()
        layout.prop(context.scene.render2mpeg, "folder")
        layout.operator("render2mpeg.folder")


def blenders_panels():
    """Those that this engine shares."""
    return [panel for panel in bpy.types.Panel.__subclasses__() if hasattr(panel, "COMPAT_ENGINES")
            and ("BLENDER_RENDER" in panel.COMPAT_ENGINES or panel.__name__ in SHARED) and panel.__name__ not in FOREIGN]


def register_blenders():
    for panel in blenders_panels():
        panel.COMPAT_ENGINES.add(ENGINE)


def unregister_blenders():
    for panel in bpy.types.Panel.__subclasses__():
        getattr(panel, "COMPAT_ENGINES", set()).discard(ENGINE)


CLASSES = (RENDER2MPEG_PT_panel, RENDER2MPEG_PT_light, RENDER2MPEG_PT_forecast, RENDER2MPEG_PT_elsewhere)
