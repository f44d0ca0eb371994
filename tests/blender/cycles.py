# SPDX-License-Identifier: Apache-2.0 OR GPL-3.0-or-later
"""blender -b --factory-startup --disable-autoexec -noaudio --python-exit-code 1 FILE.blend -P cycles.py [-P compare.py] -- FOLDER FRAME... --samples N
    [--half] [--shown] [compare.py's]

Renders frames of a .blend, counted from 0 as films count them, with its own settings to FOLDER/cyclesNNNN.exr: linear light.
With --half at half the size. With --shown to FOLDER/cyclesNNNN.png, as its view shows them.
"""
import os
import sys

import bpy

words = sys.argv[sys.argv.index("--") + 1:]
samples = words[words.index("--samples") + 1]
folder, *rest = words
frames = [word for i, word in enumerate(rest, 1) if word.isdigit() and words[i - 1] != "--samples"]
ending = "png" if "--shown" in words else "exr"
scene = bpy.context.scene
scene.cycles.samples = int(samples)
if "--half" in words:
    scene.render.resolution_percentage //= 2
scene.render.threads_mode, scene.render.threads = "FIXED", 1
settings = scene.render.image_settings
settings.file_format, settings.color_depth = ("PNG", "16") if ending == "png" else ("OPEN_EXR", "32")
for frame in frames:
    scene.frame_set(scene.frame_start + int(frame))
    scene.render.filepath = os.path.join(folder, f"cycles{int(frame):04d}.{ending}")
    bpy.ops.render.render(write_still=True)
