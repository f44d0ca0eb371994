# SPDX-FileCopyrightText: The render2mpeg authors
# SPDX-License-Identifier: Apache-2.0 OR GPL-3.0-or-later
"""The film of Render Animation: one run of the program, whose frames Blender gets one by one as they are lit.

Blender asks a render engine for each frame by itself. Light that is shared between frames, and coding that tells how exact it must
be, need the whole film: the first question begins it, and each is answered by the layers that the program writes of that frame. Until
the film is whole its scene and frames lie in FILM.blender beside it, so that it can be resumed.
"""
import contextlib
import glob
import os
import shutil

from .exr import Damaged, take_colours
from .program import INTERRUPTED, Refused, Run
from .scene_copy import frame_of_film
from .settings import coding_words, light_words, output_of

STOPPED = "Stopped; Render Animation goes on where it was"


class Film:
    def __init__(self, scene):
        settings = scene.render2mpeg
        if settings.control != "QUANTISER":
            raise Refused("A film of a size or quality is searched for: Render Film (render2mpeg) does that")
        if settings.effort == "DRAFT":
            raise Refused("Drafts have no layers, which give Blender its frames: choose another effort, or Render Film (render2mpeg)")
        if not scene.render.use_overwrite:
            raise Refused("Blender would ask for some of the film's frames alone: tick Output > Overwrite")
        self.output = output_of(scene)
        self.work = self.output + ".blender"
        self.place, self.frames = os.path.join(self.work, "scene"), os.path.join(self.work, "frames")
        self.words = ["render", self.place, "-o", self.output, "--overwrite", "--aov", self.frames]
        self.words += coding_words(settings) + light_words(settings, film=True)
        if settings.report:
            self.words += ["--report", os.path.splitext(self.output)[0] + ".html"]
        self.run, self.resumed, self.note, self.lost = None, False, "", []

    def begin(self, export):
        """Goes on with what an earlier run left, if there is something."""
        self.lost = export.run.lost()
        try:
            export.move_to(self.place)
        except OSError as error:
            raise Refused(f"{self.work}: {error.strerror or error}") from None
        self.resumed = os.path.isdir(self.frames) and bool(os.listdir(self.frames))
        self.start()

    def start(self):
        if not self.resumed:
            shutil.rmtree(self.frames, ignore_errors=True)
        self.run = Run(self.words + (["--resume"] if self.resumed else []))

    def check(self, status):
        """Whether the run goes on or has ended well; what cannot be resumed is begun anew."""
        if status in (None, 0):
            return
        if status not in INTERRUPTED and self.resumed and not self.run.began:
            self.note, self.resumed = self.run.message(), False
            self.start()
            return
        raise Refused(STOPPED if status in INTERRUPTED else self.run.message())

    def is_recorded(self, layers):
        """Whether the record of a whole chunk may name the layers: resuming makes the chunk anew where they are missing."""
        written = os.stat(layers).st_mtime_ns
        try:
            return any(os.stat(record).st_mtime_ns >= written for record in glob.glob(glob.escape(self.output) + ".partial/chunk_*.json"))
        except FileNotFoundError:  # the film is whole
            return False

    def image(self, number):
        """The frame's picture; None while it is not there. Its layers, which are many times as large, go where Blender is
        as fast as the program."""
        status = self.run.status()
        self.check(status)
        layers, picture = (os.path.join(self.frames, f"{name}_{number:04d}.exr") for name in ("frame", "picture"))
        # An earlier run's frames count only once the program goes on with them.
        if not self.run.began and self.resumed and status is None:
            return None
        if os.path.isfile(layers) and not os.path.isfile(picture):
            try:
                take_colours(layers, picture)
            except Damaged as reason:
                raise Refused(str(reason)) from None
            if not self.is_recorded(layers):
                os.remove(layers)
                with contextlib.suppress(FileNotFoundError):
                    os.remove(os.path.join(self.frames, f"frame_{number:04d}.motion"))
        if os.path.isfile(picture):
            return picture
        if status == 0 and self.run.status() == 0:
            raise Refused(f"{picture} was lost: remove {self.work} to begin the film anew")
        return None

    def number_of(self, scene):
        steps = (scene.frame_current - scene.frame_start) // max(scene.frame_step, 1)
        return frame_of_film(self.place, scene, steps)

    def finish(self):
        """After the run: what was needed to resume it goes."""
        self.check(self.run.status())
        shutil.rmtree(self.work, ignore_errors=True)

    def stop(self):
        """Leaves what a later run goes on with, if there is something."""
        if self.run is not None:
            self.run.stop()
            self.run.wait()
        if not os.path.isdir(self.output + ".partial"):
            shutil.rmtree(self.work, ignore_errors=True)
