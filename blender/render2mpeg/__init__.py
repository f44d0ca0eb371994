# SPDX-FileCopyrightText: The render2mpeg authors
# SPDX-License-Identifier: Apache-2.0 OR GPL-3.0-or-later
"""render2mpeg in Blender: a render engine that makes films, its settings, and aimed reflections.

Installed from the zip that scripts/extension makes: an extension from Blender 4.2 on, an add-on before.
"""
import bpy

from . import aims, engine, operators, panels, settings

# Blender before 4.2 reads this, later ones blender_manifest.toml.
bl_info = {
    "name": "render2mpeg",
    "author": "The render2mpeg authors",
    "version": (0, 3, 0),
    "blender": (3, 4, 0),
    "location": "Render engine; Render menu; render properties",
    "description": "Films with global illumination, rendered straight to MPEG",
    "category": "Render",
}

CLASSES = settings.CLASSES + operators.CLASSES + panels.CLASSES + aims.CLASSES + engine.CLASSES


def draw_menu(self, _context):
    self.layout.operator("render2mpeg.film", icon="RENDER_ANIMATION")


def register():
    for cls in CLASSES:
        bpy.utils.register_class(cls)
    bpy.types.Scene.render2mpeg = bpy.props.PointerProperty(type=settings.Render2mpegSettings)
    bpy.types.WindowManager.render2mpeg_forecast = bpy.props.StringProperty()
    bpy.types.TOPBAR_MT_render.append(draw_menu)
    bpy.types.VIEW3D_MT_object.append(aims.draw_aim)
    panels.register_blenders()
    engine.register_handlers()


def unregister():
    engine.unregister_handlers()
    panels.unregister_blenders()
    bpy.types.VIEW3D_MT_object.remove(aims.draw_aim)
    bpy.types.TOPBAR_MT_render.remove(draw_menu)
    del bpy.types.WindowManager.render2mpeg_forecast
    del bpy.types.Scene.render2mpeg
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
