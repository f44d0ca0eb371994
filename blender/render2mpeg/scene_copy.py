# SPDX-FileCopyrightText: The render2mpeg authors
# SPDX-License-Identifier: Apache-2.0 OR GPL-3.0-or-later
"""The scene that Blender shows, as a .blend for the program and as the folder that the program exports from it."""
import contextlib
import functools
import json
import os
import shutil
import tempfile
import threading

import bpy

from .program import Refused, Run, check_program


@functools.lru_cache(maxsize=None)
def own_folder():
    """Of this Blender, until it ends."""
    return tempfile.TemporaryDirectory(prefix="render2mpeg-")


def new_folder():
    return tempfile.mkdtemp(dir=own_folder().name)


def on_main_thread(function, given_up=lambda: False):
    """Calls where Blender's data may be saved and changed: a render runs in a thread of its own. None where it was given up."""
    if threading.current_thread() is threading.main_thread():
        return function()
    done, gone, results, errors = threading.Event(), threading.Event(), [], []

    def call():
        if gone.is_set():
            return
        try:
            results.append(function())
        except Exception as error:  # told where it was asked for
            errors.append(error)
        done.set()

    bpy.app.timers.register(call, first_interval=0)
    while not done.wait(0.05):
        if given_up():
            gone.set()
            return None
    if errors:
        raise errors[0]
    return results[0]


@contextlib.contextmanager
def frames_about(scene, frame):
    """The scene is a film of this frame for a while, with its neighbours where the shutter sees them."""
    kept = scene.frame_start, scene.frame_end, scene.frame_step
    about = 1 if scene.render.use_motion_blur else 0
    try:
        set_frames(scene, max(frame - about, 0), frame + about, 1)
        yield
    finally:
        set_frames(scene, *kept)


def set_frames(scene, start, end, step):
    # Each moves the other where they would cross.
    scene.frame_start, scene.frame_end = start, end
    scene.frame_start, scene.frame_step = start, step


def write_copy(folder, scene, frame=None):
    """A .blend of what Blender shows now; of one frame alone where one is named."""
    if scene != bpy.context.window_manager.windows[0].scene:
        raise Refused(f"{scene.name} is not the scene that Blender's window shows")
    if frame is not None and frame < 0:
        raise Refused(f"Frame {frame} lies before 0, where no film can begin")
    path = os.path.join(folder, os.path.basename(bpy.data.filepath) or "untitled.blend")
    window = bpy.context.window_manager.windows[0]
    with bpy.context.temp_override(window=window), frames_about(scene, frame) if frame is not None else contextlib.nullcontext():
        bpy.ops.wm.save_as_mainfile(filepath=path, copy=True, check_existing=False)
    return path


class Export:
    """The program's export of a copy: a folder with film.json that needs no Blender."""

    def __init__(self, scene, frame=None, given_up=lambda: False):
        check_program()
        self.place = new_folder()
        try:
            self.blend = on_main_thread(lambda: write_copy(self.place, scene, frame), given_up)
        except Refused:
            self.remove()
            raise
        if self.blend is None:
            self.remove()
        self.run = Run(["plan", self.blend, "--within", "0"]) if self.blend else None

    def folder(self):
        """Once the run has ended well."""
        made = self.blend + ".export"
        return os.path.join(made, os.listdir(made)[0])

    def move_to(self, target):
        """Takes the place of an older one."""
        shutil.rmtree(target, ignore_errors=True)
        shutil.copytree(self.folder(), target, ignore=shutil.ignore_patterns("blender.log"))
        self.remove()

    def remove(self):
        shutil.rmtree(self.place, ignore_errors=True)


def frame_of_film(folder, scene, frames_on):
    """Number of the film's frame that shows the scene's frame so many steps after its first."""
    with open(os.path.join(folder, "film.json")) as file:
        film = json.load(file)
    named = float(film["frame_rate"])
    rate = named if named.is_integer() else round(named) * 1000 / 1001
    return min(round(frames_on * rate * scene.render.fps_base / scene.render.fps), film["frames"] - 1)
