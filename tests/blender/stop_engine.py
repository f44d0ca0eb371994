# SPDX-License-Identifier: Apache-2.0 OR GPL-3.0-or-later
"""blender -b --factory-startup -noaudio --python-exit-code 1 FILE.blend -P stop_engine.py -- REPOSITORY FOLDER FRAME FRAMES EFFORT

Makes a film of FRAMES frames with the render engine; stops it as Ctrl-C does once FRAME is written, or not if that is 0.
"""
import os
import signal
import sys

import bpy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
sys.dont_write_bytecode = True
from install_extension import install  # noqa: E402

repository, folder, last, frames, effort = sys.argv[sys.argv.index("--") + 1:]
install(repository)
scene = bpy.context.scene
render, settings = scene.render, scene.render2mpeg
render.engine = "RENDER2MPEG"
render.resolution_x, render.resolution_y, render.resolution_percentage = 32, 32, 100
scene.frame_start, scene.frame_end = 1, int(frames)
settings.output, settings.effort = os.path.join(folder, "film.mpg"), effort
render.filepath = os.path.join(folder, "frames", "f")


def stop(scene, *_):
    if scene.frame_current == int(last):
        os.kill(os.getpid(), signal.SIGINT)


bpy.app.handlers.render_write.append(stop)
bpy.ops.render.render(animation=True)
if int(last):
    assert os.path.isdir(settings.output + ".partial") and not os.path.exists(settings.output)
else:
    print(bpy.data.texts["render2mpeg"].as_string())
    assert not os.path.exists(settings.output + ".blender")
print("ENGINE STOPPED" if int(last) else "ENGINE WENT ON")
