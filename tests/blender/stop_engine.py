# SPDX-License-Identifier: Apache-2.0 OR GPL-3.0-or-later
"""blender -b --factory-startup -noaudio --python-exit-code 1 FILE.blend -P stop_engine.py -- REPOSITORY FOLDER FRAME FRAMES EFFORT HOW

Makes a film of FRAMES frames with the render engine; stops it once FRAME is written, or not if that is 0. HOW: `signal`, as Ctrl-C does,
which ends Blender itself from 4 on, so that there, as with `run`, the program alone is stopped.
"""
import os
import signal
import sys
import time

import bpy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
sys.dont_write_bytecode = True
from install_extension import install  # noqa: E402

repository, folder, last, frames, effort, how = sys.argv[sys.argv.index("--") + 1:]
package = install(repository)
scene = bpy.context.scene
render, settings = scene.render, scene.render2mpeg
render.engine = "RENDER2MPEG"
render.resolution_x, render.resolution_y, render.resolution_percentage = 32, 32, 100
scene.frame_start, scene.frame_end = 1, int(frames)
settings.output, settings.effort = os.path.join(folder, "film.mpg"), effort
render.filepath = os.path.join(folder, "frames", "f")


def stop(scene, *_):
    if scene.frame_current == int(last):
        # Of a film of many chunks the first is there.
        while int(frames) > 60 and not os.path.exists(settings.output + ".partial/chunk_00000.json"):
            time.sleep(0.05)
        if how == "signal" and bpy.app.version < (4, 0, 0):
            os.kill(os.getpid(), signal.SIGINT)
        else:
            package.engine.Given.film.run.stop()


bpy.app.handlers.render_write.append(stop)
try:
    bpy.ops.render.render(animation=True)
except RuntimeError as error:
    assert int(last) and "goes on where it was" in str(error), error
    print(error)
if int(last):
    assert os.path.isdir(settings.output + ".partial") and not os.path.exists(settings.output)
    print("ENGINE STOPPED")
else:
    print(bpy.data.texts["render2mpeg"].as_string())
    assert not os.path.exists(settings.output + ".blender")
    print("ENGINE WENT ON")
