"""blender -b --factory-startup --disable-autoexec -noaudio --python-exit-code 1 FILE.blend -P cycles.py -- FOLDER SAMPLES FRAME...

Renders frames of a .blend, counted from 0 as films count them, with its own settings to FOLDER/cyclesNNNN.exr: linear light.
"""
import os
import sys

import bpy

folder, samples, *frames = sys.argv[sys.argv.index("--") + 1:]
scene = bpy.context.scene
scene.cycles.samples = int(samples)
scene.render.threads_mode, scene.render.threads = "FIXED", 1
scene.render.image_settings.file_format, scene.render.image_settings.color_depth = "OPEN_EXR", "32"
for frame in frames:
    scene.frame_set(scene.frame_start + int(frame))
    scene.render.filepath = os.path.join(folder, f"cycles{int(frame):04d}.exr")
    bpy.ops.render.render(write_still=True)
