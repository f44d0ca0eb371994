# SPDX-FileCopyrightText: The render2mpeg authors
# SPDX-License-Identifier: Apache-2.0 OR GPL-3.0-or-later
"""The render engine: stills by F12, films by Render Animation, progress, Esc and errors as Blender has them."""
import os
import time

import bpy
from bpy.app.handlers import persistent

from .exr import Damaged, read_colours
from .film import STOPPED, Film
from .live_view import LiveView
from .program import INTERRUPTED, Refused, Run, keep_text, program
from .scene_copy import Export, frame_of_film, on_main_thread
from .settings import light_words



class Given:
    """The film that is being made, between Blender's questions for its frames, and the status told last."""

    film, status = None, ""


def views_of(render):
    """Names of what Blender shows; one without a name where that is no stereoscopy."""
    if render.use_multiview and render.views_format == "STEREO_3D":
        return [view.name for view in render.views if view.use and view.name in ("left", "right")]
    return [""]


def fill(result, image, view, size, left, low):
    """A result's colours, from the part of an image that lies there in a view's picture of this size. Images of both eyes have them side
    by side, or the left one's above."""
    colours = read_colours(image)[::-1]
    rows, _, columns = colours.shape
    if view == "right":
        left += size[0] if columns == 2 * size[0] else 0
    else:
        low += size[1] if rows == 2 * size[1] else 0
    part = colours[low:low + result.resolution_y, :, left:left + result.resolution_x]
    if part.shape != (result.resolution_y, 4, result.resolution_x):
        raise Damaged(f"{image}: not of the scene's size")
    try:
        result.layers[0].passes["Combined"].rect.foreach_set(part[:, ::-1].transpose(0, 2, 1).ravel())
    except TypeError:  # before Blender 4: a file does, and lists take minutes
        result.layers[0].load_from_file(image, x=left, y=low)


class Stopped(Exception):
    """Esc."""


class Render2mpegEngine(LiveView, bpy.types.RenderEngine):
    bl_idname, bl_label = "RENDER2MPEG", "render2mpeg"
    bl_use_preview = False
    bl_use_eevee_viewport = True
    bl_use_shading_nodes_custom = False

    def live_program(self):
        return program()

    def render(self, depsgraph):
        scene = depsgraph.scene
        if depsgraph.view_layer.name != scene.view_layers[0].name:
            self.report({"WARNING"}, f"{depsgraph.view_layer.name}: the first view layer alone is rendered")
            return
        if scene.render.use_multiview and scene.render.views_format != "STEREO_3D":
            self.report({"WARNING"}, "Multi-View: one view alone is rendered; Stereo 3D has both eyes")
        try:
            if self.is_animation:
                self.answer(scene, depsgraph.view_layer)
            else:
                self.make_still(scene, depsgraph.view_layer)
        except Stopped:
            if Given.film is not None:
                self.report({"WARNING"}, STOPPED)
            end_film()
        except Refused as reason:
            end_film()
            if bpy.app.version < (4, 0, 0):  # above the picture; later ones report it, too
                self.error_set(str(reason))
            # This ends an animation before the frame is written.
            self.report({"ERROR"}, str(reason))

    def wait(self, run, says):
        """Until the run has ended well."""
        while (status := run.status()) is None:
            self.tell(run, says)
        if status in INTERRUPTED:
            raise Stopped
        if status != 0:
            raise Refused(run.message())

    def tell(self, run, says):
        """How far it is; stops it where Blender wants that."""
        if self.test_break():
            run.stop()
            run.wait()
            raise Stopped
        of = f" {run.done}/{run.total}" if run.total > 1 else ""
        status = f"render2mpeg: {says}{of}" + (f", {run.activity}" if run.activity else "")
        if status != Given.status:
            Given.status = status
            self.update_stats("", status)
        self.update_progress(run.share)
        time.sleep(0.05)

    def export(self, scene, frame=None):
        self.update_stats("", "render2mpeg: exporting")
        export = Export(scene, frame, self.test_break)
        if export.run is None:
            raise Stopped
        try:
            self.wait(export.run, "exporting")
        except (Stopped, Refused):
            export.remove()
            raise
        return export

    def make_still(self, scene, layer):
        """One frame, as of a film of its own."""
        export = self.export(scene, scene.frame_current)
        try:
            folder = export.folder()
            about = 1 if scene.render.use_motion_blur and scene.frame_current > 0 else 0
            number = frame_of_film(folder, scene, about)
            image = os.path.join(export.place, "still.%04d.exr")
            run = Run(["render", folder, "-o", image, "--frames", f"{number}:{number}"] + light_words(scene.render2mpeg, film=False))
            self.wait(run, "still")
            self.show(scene, layer, image % number)
            self.tell_lost(export.run.lost() + run.lost(), export.run.lines + run.lines)
        finally:
            export.remove()

    def answer(self, scene, layer):
        """One frame of the film, which the first one asked for begins."""
        if Given.film is None:
            film = Film(scene)
            film.begin(self.export(scene))
            Given.film = film
        film = Given.film
        number = film.number_of(scene)
        while (image := film.image(number)) is None:
            self.tell(film.run, "frame")
        if film.note:
            self.report({"WARNING"}, f"{film.note}; the film begins anew")
            film.note = ""
        self.show(scene, layer, image)
        if scene.frame_current + scene.frame_step > scene.frame_end:
            while film.run.status() is None:
                self.tell(film.run, "frame")
            film.finish()
            Given.film = None
            self.report({"INFO"}, film.output)
            self.tell_lost(film.lost + film.run.lost(), film.lost + film.run.lines)

    def show(self, scene, layer, image):
        """The picture, or the border's part of it."""
        render = scene.render
        width, height = (size * render.resolution_percentage // 100 for size in (render.resolution_x, render.resolution_y))
        left = int(render.border_min_x * width) if render.use_border else 0
        low = int(render.border_min_y * height) if render.use_border else 0
        for view in views_of(render):
            result = self.begin_result(0, 0, width, height, layer=layer.name, view=view)
            try:
                fill(result, image, view, (width, height), left, low)
            except (RuntimeError, Damaged) as error:
                raise Refused(" ".join(str(error).split())) from None
            finally:
                self.end_result(result)

    def tell_lost(self, lost, lines):
        on_main_thread(lambda: keep_text("render2mpeg", lines), self.test_break)
        if lost:
            self.report({"INFO"}, f"{len(lost)} things are not kept, see the text render2mpeg")


@persistent
def end_film(*_):
    """Of a render that ended between two frames."""
    if Given.film is not None:
        Given.film.stop()
        Given.film = None


HANDLERS = (bpy.app.handlers.render_init, bpy.app.handlers.render_cancel, bpy.app.handlers.render_complete)


def register_handlers():
    for handlers in HANDLERS:
        handlers.append(end_film)


def unregister_handlers():
    for handlers in HANDLERS:
        if end_film in handlers:
            handlers.remove(end_film)


CLASSES = (Render2mpegEngine,)
