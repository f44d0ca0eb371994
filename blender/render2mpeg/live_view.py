# SPDX-FileCopyrightText: The render2mpeg authors
# SPDX-License-Identifier: Apache-2.0 OR GPL-3.0-or-later
"""The scene in the 3D viewport, drawn by `render2mpeg watch --live`.

LiveView gives a render engine view_update and view_draw. A change of the scene saves a copy, which a second Blender exports;
a change of the view is told to the program alone. Pictures come as scene-linear light, which Blender's own colour management shows.
"""
import atexit
import glob
import json
import math
import os
import queue
import shutil
import subprocess
import tempfile
import threading
import time

import bpy
import gpu
import numpy as np
from gpu_extras.presets import draw_texture_2d
from mathutils import Matrix

# Blender's z up to the film's y up, as film_export.cameras has it.
TO_FILM = Matrix(((1, 0, 0, 0), (0, 0, 1, 0), (0, -1, 0, 0), (0, 0, 0, 1)))
# Seconds without a change before the scene is saved, at least, and from one look at the processes to the next.
SETTLED, BEAT = 0.05, 0.02


class Child:
    """A process that is told by lines, and answers by lines, some with bytes behind them."""

    def __init__(self, words, mark=b"", **more):
        self.answers, self.mark = queue.Queue(), mark
        self.errors = tempfile.TemporaryFile()
        self.process = subprocess.Popen(words, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=self.errors, **more)
        threading.Thread(target=self.read, daemon=True).start()

    def read(self):
        with self.process.stdout as stream:
            for line in stream:
                if not line.startswith(self.mark):
                    continue
                says = json.loads(line[len(self.mark):])
                data = stream.read(says.get("bytes", 0))
                if len(data) == says.get("bytes", 0):  # else it ended in the middle
                    self.answers.put((says, data))

    def say(self, asked):
        try:
            self.process.stdin.write(json.dumps(asked).encode() + b"\n")
            self.process.stdin.flush()
        except OSError:  # it has ended, which has_ended() tells
            pass

    def waiting(self):
        """Answers that have come."""
        while True:
            try:
                yield self.answers.get_nowait()
            except queue.Empty:
                return

    def has_ended(self):
        return self.process.poll() is not None

    def last_words(self):
        self.errors.seek(0)
        lines = self.errors.read().decode(errors="replace").strip().splitlines()
        return lines[-1] if lines else f"render2mpeg ended with status {self.process.returncode}"

    def close(self):
        """Without input it ends by itself; in the background, since it may be in the middle of something."""
        try:
            self.process.stdin.close()
        except OSError:
            pass
        try:
            threading.Thread(target=self.end, daemon=True).start()
        except RuntimeError:  # Blender itself ends, and nobody is kept waiting
            pass

    def end(self):
        try:
            self.process.wait(10)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
        self.errors.close()


def saved_copy(folder):
    """The scene as it is now, in a file of its own."""
    path = os.path.join(folder, "scene.blend")
    if os.path.exists(path):
        os.remove(path)
    files = bpy.context.preferences.filepaths
    preview = files.file_preview_type
    files.file_preview_type = "NONE"
    try:
        bpy.ops.wm.save_as_mainfile(filepath=path, copy=True, check_existing=False, compress=False)
    finally:
        files.file_preview_type = preview
    return path


def camera_of(view_matrix, window_matrix, width, height):
    """The viewport's eye as `watch --live` takes it, whatever the viewport looks through."""
    p, to_world = window_matrix, view_matrix.inverted()
    aspect = width / height
    if p[3][3] == 0:
        near, far = p[2][3] / (p[2][2] - 1), p[2][3] / (p[2][2] + 1)
        lens = {"fov": math.degrees(2 * math.atan(1 / p[1][1])), "shift": [p[0][2] / 2 * aspect, p[1][2] / 2], "clip": [max(near, 0), max(far, 0)]}
    else:
        # What lies behind a viewport's eye is seen, too: it steps back to the nearest plane.
        near = (p[2][3] + 1) / p[2][2]
        to_world = to_world @ Matrix.Translation((0, 0, -near))
        lens = {"height": 2 / p[1][1], "shift": [-p[0][3] / 2 * aspect, -p[1][3] / 2]}
    rows = TO_FILM @ to_world
    return {"matrix": [value for row in rows for value in row], **lens}


def pixels_of(says, data):
    """Rows from the bottom up, as textures have them."""
    width, height = says["size"]
    light = np.frombuffer(data, np.float16).reshape(height, width, 4)
    return np.ascontiguousarray(light[::-1], dtype=np.float32)


def exporter_of(program):
    """live_export.py where the program has its files, built or installed; None where it is missing."""
    folder = os.path.dirname(os.path.realpath(program))
    places = ("modules", "../lib/render2mpeg", "../lib/*/render2mpeg")
    return next((path for place in places for path in glob.glob(os.path.join(glob.escape(folder), place, "blender", "live_export.py"))), None)


class Session:
    """What one viewport's engine keeps: a folder, the program, and the Blender that exports."""

    def __init__(self, engine, program):
        self.engine, self.program_path, self.program, self.exporter = engine, program, None, None
        self.place = tempfile.TemporaryDirectory(prefix="render2mpeg-live-", ignore_cleanup_errors=True)
        self.folder = self.place.name
        self.changed_at, self.exporting, self.saves, self.exports = time.monotonic(), False, False, 0
        self.film, self.kept, self.save_seconds = None, [], 0
        self.wish, self.picture, self.is_new, self.lost = None, None, False, []
        self.message, self.error, self.restarted, self.closed = "exporting the scene", None, False, False
        if program is None:
            self.error, self.changed_at = "the program render2mpeg is missing: name it in the add-on's preferences", None
        bpy.app.timers.register(self.tick, first_interval=0, persistent=True)
        atexit.register(self.close)

    # What the engine tells.

    def change(self):
        """The scene is another one."""
        if not self.saves and self.program_path is not None:
            self.changed_at = time.monotonic()

    def look(self, camera, size):
        """The view may be another one."""
        wish = {"camera": camera, "size": size}
        if wish != self.wish:
            self.wish = wish
            if self.program is not None:
                self.program.say(wish)

    def close(self):
        if self.closed:
            return
        self.closed = True
        atexit.unregister(self.close)
        for child in (self.program, self.exporter):
            if child is not None:
                child.close()
        try:
            threading.Thread(target=self.clean, daemon=True).start()
        except RuntimeError:  # Blender itself ends, and the folder with it
            pass

    def clean(self):
        """Behind its processes, which write there."""
        for child in (self.program, self.exporter):
            if child is not None:
                child.process.wait()
        self.place.cleanup()

    # What happens by and by, on Blender's main thread.

    def tick(self):
        # An engine that Blender has freed may not have told so.
        if self.closed or not any(viewports(self.engine)):
            self.close()
            return None
        try:
            self.step()
        except Exception as trouble:  # told, since nobody sees a timer's
            self.error, self.is_new = f"{type(trouble).__name__}: {trouble}", True
        if self.is_new:
            self.is_new = False
            for area in viewports(self.engine):
                area.tag_redraw()
        return BEAT

    def step(self):
        # Saving holds Blender up: what takes long waits for as long.
        settled = max(SETTLED, self.save_seconds)
        if self.changed_at is not None and not self.exporting and time.monotonic() - self.changed_at >= settled:
            self.begin_export()
        if self.exporter is not None:
            self.hear_exporter()
        if self.program is not None:
            self.hear_program()

    def begin_export(self):
        self.changed_at, start = None, time.monotonic()
        if self.exporter is None or self.exporter.has_ended():
            script = exporter_of(self.program_path)
            if script is None:
                raise FileNotFoundError("live_export.py is not where the program has its files")
            if self.exporter is not None:
                self.exporter.close()
            words = [bpy.app.binary_path, "-b", "--factory-startup", "--disable-autoexec", "-noaudio", "-P", os.path.abspath(script)]
            self.exporter = Child(words, mark=b"render2mpeg ", env=dict(os.environ, DISPLAY=""), cwd=self.folder)
        self.saves = True
        try:
            blend = saved_copy(self.folder)
        finally:
            self.saves = False
        self.save_seconds = time.monotonic() - start
        self.exports += 1
        folder = os.path.join(self.folder, str(self.exports))
        os.mkdir(folder)
        self.exporting = True
        self.exporter.say({"blend": blend, "folder": folder})

    def hear_exporter(self):
        for says, _ in self.exporter.waiting():
            self.exporting, self.is_new = False, True
            if "error" in says:
                self.error = says["error"]
                continue
            self.error, self.lost, self.restarted = None, says["lost"], False
            self.film = os.path.join(says["folder"], "film.json")
            self.kept.append(says["folder"])
            if self.program is None or self.program.has_ended():
                self.start()
            else:
                self.program.say({"scene": self.film})
        if self.exporting and self.exporter.has_ended():
            self.exporting, self.is_new, self.error = False, True, "Blender's export ended: " + self.exporter.last_words()

    def start(self):
        width, height = self.wish["size"] if self.wish else (480, 270)
        self.program = Child([self.program_path, "watch", self.film, "--live", "--quiet", "--size", f"{width}x{height}"])
        if self.wish:
            self.program.say(self.wish)

    def hear_program(self):
        for says, data in self.program.waiting():
            self.is_new = True
            if "error" in says:
                self.error = says["error"]
            elif "scene" in says:
                # Folders of scenes before are needed no more.
                while len(self.kept) > 1:
                    shutil.rmtree(self.kept.pop(0), ignore_errors=True)
            else:
                self.picture, self.error = (says, data), None
                self.message = "done" if says["best"] else says["level"] + (f" {says['pass']}" if says["level"] == "draft" else "")
        if self.program.has_ended() and self.program.answers.empty():
            words, self.is_new = self.program.last_words(), True
            self.program.close()
            self.program = None
            if self.restarted:
                self.error = words
            else:
                self.restarted = True
                self.start()

    def status(self):
        text = self.error or self.message + (", exporting a change" if self.exporting and self.picture else "")
        return text + (f"  ({len(self.lost)} things are not kept)" if self.lost and not self.error else "")


def viewports(engine):
    """Areas that show the engine's shading."""
    for window in bpy.context.window_manager.windows:
        for area in window.screen.areas if window.scene.render.engine == engine else ():
            if area.type == "VIEW_3D" and area.spaces.active.shading.type == "RENDERED":
                yield area


def is_seen(update):
    """Whether an update of the depsgraph can change the picture beyond what the view itself does."""
    if not (update.is_updated_geometry or update.is_updated_transform or update.is_updated_shading):
        return False
    return not (isinstance(update.id, bpy.types.Object) and update.id.type == "CAMERA" or isinstance(update.id, bpy.types.Camera))


class LiveView:
    """For bpy.types.RenderEngine: what its viewport shows. live_program() is the engine's: the render2mpeg that is used; None
    where there is none."""

    live_session = None
    live_objects = None
    live_texture = None

    def view_update(self, context, depsgraph):
        names = {thing.name_full for thing in depsgraph.objects}
        if self.live_session is None or self.live_session.closed:
            self.live_session = Session(self.bl_idname, self.live_program())
        elif names != self.live_objects or any(is_seen(update) for update in depsgraph.updates):
            self.live_session.change()
        self.live_objects = names

    def view_draw(self, context, depsgraph):
        region, view = context.region, context.region_data
        if self.live_session is None or self.live_session.closed:
            self.view_update(context, depsgraph)
        session = self.live_session
        size = [max(region.width, 16), max(region.height, 16)]
        session.look(camera_of(view.view_matrix, view.window_matrix, *size), size)
        self.update_stats("render2mpeg", session.status())
        if session.picture is None:
            return
        if self.live_texture is None or self.live_texture[0] is not session.picture[0]:
            pixels = pixels_of(*session.picture)
            data = gpu.types.Buffer("FLOAT", pixels.size, pixels.ravel())
            self.live_texture = session.picture[0], gpu.types.GPUTexture((pixels.shape[1], pixels.shape[0]), format="RGBA16F", data=data)
        gpu.state.blend_set("ALPHA_PREMULT")
        self.bind_display_space_shader(depsgraph.scene)
        draw_texture_2d(self.live_texture[1], (0, 0), region.width, region.height)
        self.unbind_display_space_shader()
        gpu.state.blend_set("NONE")

    def __del__(self):
        # Blender's part of the engine may have gone before, and refuses the usual way.
        session = object.__getattribute__(self, "__dict__").get("live_session")
        if session is not None:
            session.close()
