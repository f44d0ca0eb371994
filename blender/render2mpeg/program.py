# SPDX-FileCopyrightText: The render2mpeg authors
# SPDX-License-Identifier: Apache-2.0 OR GPL-3.0-or-later
"""The program render2mpeg: where it is, and a run of it that tells how far it is and can be stopped."""
import atexit
import json
import os
import shutil
import signal
import subprocess
import threading

import bpy

INTERRUPTED = (130, -signal.SIGINT)
running = set()


class Refused(Exception):
    """What cannot be done: the reason in one line."""


def program():
    """The render2mpeg that is used; None where there is none."""
    addon = bpy.context.preferences.addons.get(__package__)
    named = bpy.path.abspath(addon.preferences.program) if addon and addon.preferences.program else os.environ.get("RENDER2MPEG_PROGRAM")
    if named:
        return named if os.path.isfile(named) else None
    return shutil.which("render2mpeg")


def check_program():
    if program() is None:
        raise Refused("The program render2mpeg is missing: name it in the add-on's preferences")


class Run:
    """One run of the program. Its messages are read while it works."""

    def __init__(self, words):
        self.lines, self.done, self.total, self.activity, self.share, self.began = [], 0, 0, "", 0.0, False
        self.words = [program()] + words + ["--progress", "json"]
        environment = dict(os.environ, COLUMNS="120", RENDER2MPEG_BLENDER=bpy.app.binary_path)
        self.process = subprocess.Popen(self.words, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                                        env=environment, start_new_session=True)
        running.add(self)
        self.reader = threading.Thread(target=self.read, daemon=True)
        self.reader.start()

    def read(self):
        for line in self.process.stdout:
            self.take(line.decode(errors="replace").rstrip())
        self.process.stdout.close()

    def take(self, line):
        try:
            told = json.loads(line) if line.startswith("{") else None
        except ValueError:
            told = None
        if told is None:
            self.lines += [line] if line else []
            return
        self.done, self.total, self.activity = told["done"], told["total"], told["activity"]
        # A single frame has no frames to count, but a time.
        counted = self.done / self.total if self.total > 1 else told["seconds"] / told["whole"] if told["whole"] else 0
        self.share, self.began = min(max(counted, 0.0), 1.0), True

    def status(self):
        """None while it works; then the exit status."""
        code = self.process.poll()
        if code is not None:
            self.reader.join(2)
            running.discard(self)
        return code

    def wait(self):
        self.process.wait()
        return self.status()

    def stop(self):
        """As Ctrl-C does: what there is can be resumed."""
        if self.process.poll() is None:
            os.killpg(self.process.pid, signal.SIGINT)

    def message(self):
        """What went wrong, or the last that was said."""
        told = [line for line in self.lines if line.startswith("render2mpeg:")]
        return (told or self.lines or ["render2mpeg said nothing"])[-1]

    def lost(self):
        """What of the scene the film does not show, a line each."""
        return [line for line in self.lines if line.startswith("not kept: ")]


def keep_text(name, lines):
    """What the program said, to be read in Blender's text editor."""
    text = bpy.data.texts.get(name) or bpy.data.texts.new(name)
    text.clear()
    text.write("\n".join(lines) + "\n")


def stop_all():
    """Nothing is left running without Blender."""
    for run in list(running):
        run.stop()


atexit.register(stop_all)
