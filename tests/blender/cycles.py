"""blender -b --factory-startup --disable-autoexec -noaudio --python-exit-code 1 FILE.blend -P cycles.py -- FOLDER SAMPLES FRAME... [--shown]

Renders frames of a .blend, counted from 0 as films count them, with its own settings to FOLDER/cyclesNNNN.exr: linear light.
With --shown to FOLDER/cyclesNNNN.png, as its view shows them.
"""
import os
import sys

import bpy

folder, samples, *frames = (word for word in sys.argv[sys.argv.index("--") + 1:] if word != "--shown")
ending = "png" if "--shown" in sys.argv else "exr"
scene = bpy.context.scene
scene.cycles.samples = int(samples)
scene.render.threads_mode, scene.render.threads = "FIXED", 1
settings = scene.render.image_settings
settings.file_format, settings.color_depth = ("PNG", "16") if ending == "png" else ("OPEN_EXR", "32")
for frame in frames:
    scene.frame_set(scene.frame_start + int(frame))
    scene.render.filepath = os.path.join(folder, f"cycles{int(frame):04d}.{ending}")
    bpy.ops.render.render(write_still=True)
