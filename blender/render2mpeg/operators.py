# SPDX-FileCopyrightText: The render2mpeg authors
# SPDX-License-Identifier: Apache-2.0 OR GPL-3.0-or-later
"""What the program does besides rendering for the engine: films of a size, forecasts, costs, and folders for elsewhere."""
import os
import shlex
import shutil
import time

import bpy

from .program import INTERRUPTED, Refused, Run, check_program, keep_text
from .scene_copy import new_folder, own_folder, write_copy
from .settings import coding_words, light_words, output_of


def saved_copy():
    """A .blend that holds what Blender shows: the file itself, or a copy where it was changed since it was saved."""
    if bpy.data.filepath and not bpy.data.is_dirty:
        return bpy.data.filepath
    return write_copy(own_folder().name, bpy.context.scene)


def last_frame_file():
    return os.path.join(own_folder().name, "last_frame.png")


def show_last_frame(seen):
    """Shows the frame lit last in Blender's image editors, where it is newer than `seen`; returns how new it is."""
    file = last_frame_file()
    if not os.path.isfile(file) or os.stat(file).st_mtime_ns <= seen:
        return seen
    image = bpy.data.images.get("render2mpeg")
    if image is None:
        image = bpy.data.images.load(file)
        image.name = "render2mpeg"
    image.reload()
    for window in bpy.context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "IMAGE_EDITOR":
                area.spaces.active.image = image
                area.tag_redraw()
    return os.stat(file).st_mtime_ns


def film_words(scene, blend):
    """What makes the film."""
    settings, output = scene.render2mpeg, output_of(scene)
    words = [blend, "-o", output, "--overwrite"] + coding_words(settings)
    if settings.control == "SIZE":
        return ["tune"] + words + ["--max-size", f"{settings.megabytes:g}M"]
    if settings.control == "QUALITY":
        return ["tune"] + words + ["--target-psnr", f"{settings.decibels:g}"]
    words = ["render"] + words + light_words(settings, film=True) + ["--resume", "--last-frame", last_frame_file()]
    return words + (["--report", os.path.splitext(output)[0] + ".html"] if settings.report else [])


class Working:
    """An operator that runs the program: waits for it in the background, else lets Blender live on and shows how far it is."""

    running = None
    timer = None
    seen = 0

    def words(self, context):
        raise NotImplementedError

    def finish(self, context):
        """Called when the program ended well."""

    def begin(self, context):
        try:
            check_program()
            self.running = Run(self.words(context))
        except Refused as reason:
            self.report({"ERROR"}, str(reason))
            return False
        self.seen = time.time_ns()
        return True

    def end(self, context, status):
        keep_text("render2mpeg", self.running.lines)
        if status in INTERRUPTED:
            self.report({"WARNING"}, "Stopped; the same film goes on where it was")
            return {"CANCELLED"}
        if status != 0:
            self.report({"ERROR"}, self.running.message())
            return {"CANCELLED"}
        self.finish(context)
        return {"FINISHED"}

    def execute(self, context):
        return self.end(context, self.running.wait()) if self.begin(context) else {"CANCELLED"}

    def invoke(self, context, _event):
        if not self.begin(context):
            return {"CANCELLED"}
        manager = context.window_manager
        manager.progress_begin(0, 100)
        self.timer = manager.event_timer_add(0.2, window=context.window)
        manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        run = self.running
        if event.type == "ESC":
            run.stop()
        status = run.status()
        if status is None:
            self.seen = show_last_frame(self.seen)
            context.window_manager.progress_update(100 * run.share)
            context.workspace.status_text_set(f"render2mpeg: {run.done} of {run.total}   (Esc stops)" if run.total
                                              else "render2mpeg: exporting   (Esc stops)")
            return {"RUNNING_MODAL"} if event.type in {"TIMER", "ESC"} else {"PASS_THROUGH"}
        context.window_manager.event_timer_remove(self.timer)
        context.window_manager.progress_end()
        context.workspace.status_text_set(None)
        return self.end(context, status)


class RENDER2MPEG_OT_film(Working, bpy.types.Operator):
    bl_idname, bl_label = "render2mpeg.film", "Render Film (render2mpeg)"
    bl_description = "Render the scene's frames with global illumination straight to a film"

    def words(self, context):
        return film_words(context.scene, saved_copy())

    def finish(self, context):
        output, lost = output_of(context.scene), self.running.lost()
        self.report({"INFO"}, output + (f"; {len(lost)} things are not kept, see the text render2mpeg" if lost else ""))
        if context.scene.render2mpeg.open_film and not bpy.app.background:
            bpy.ops.wm.path_open(filepath=output)


class RENDER2MPEG_OT_forecast(Working, bpy.types.Operator):
    bl_idname, bl_label = "render2mpeg.forecast", "Forecast"
    bl_description = "What the film will take: time, size, memory, from a few of its frames"

    def words(self, context):
        settings = context.scene.render2mpeg
        words = ["plan", saved_copy(), "-o", "film" + os.path.splitext(settings.output)[1]]
        return words + coding_words(settings) + light_words(settings, film=True)

    def finish(self, context):
        told = [line for line in self.running.lines if line.startswith(("Takes ", "Memory: "))]
        context.window_manager.render2mpeg_forecast = "\n".join(told)
        self.report({"INFO"}, " ".join(told))


class RENDER2MPEG_OT_cost(Working, bpy.types.Operator):
    bl_idname, bl_label = "render2mpeg.cost", "Cost"
    bl_description = "What accuracy costs in time, on a few frames of the film"

    def words(self, context):
        return ["cost", saved_copy()]

    def finish(self, context):
        self.report({"INFO"}, "See the text render2mpeg")


class RENDER2MPEG_OT_folder(Working, bpy.types.Operator):
    bl_idname, bl_label = "render2mpeg.folder", "Write Folder"
    bl_description = "Write the film's scene to a folder that is rendered elsewhere, without Blender"
    blend = ""

    def words(self, context):
        self.blend = write_copy(new_folder(), context.scene)
        return ["plan", self.blend, "--within", "0"]

    def finish(self, context):
        made, target = self.blend + ".export", bpy.path.abspath(context.scene.render2mpeg.folder)
        shutil.copytree(os.path.join(made, os.listdir(made)[0]), target, dirs_exist_ok=True, ignore=shutil.ignore_patterns("blender.log"))
        shutil.rmtree(os.path.dirname(self.blend), ignore_errors=True)
        words = film_words(context.scene, ".")
        if "--last-frame" in words:
            at = words.index("--last-frame")
            del words[at:at + 2]
        for option in {"-o", "--report"}.intersection(words):
            words[words.index(option) + 1] = os.path.join(".", os.path.basename(words[words.index(option) + 1]))
        with open(os.path.join(target, "render.sh"), "w") as file:
            file.write("#!/bin/sh\n# Makes the film where render2mpeg is installed.\ncd -- \"$(dirname -- \"$0\")\" && render2mpeg "
                       + shlex.join(w for w in words if w != "--resume") + "\n")
        os.chmod(os.path.join(target, "render.sh"), 0o755)
        self.report({"INFO"}, target)


CLASSES = (RENDER2MPEG_OT_film, RENDER2MPEG_OT_forecast, RENDER2MPEG_OT_cost, RENDER2MPEG_OT_folder)
