# SPDX-License-Identifier: Apache-2.0 OR GPL-3.0-or-later
"""blender -b --disable-autoexec FILE.blend -P cycles_frames.py -- FOLDER [--frames A:B] [--samples N]

Renders the film's frames with Cycles to FOLDER/frame.NNNN.exr: linear light, and the Vector pass that tells how every pixel
moves. Frames count from 0. Prints the command that makes a film of them.
"""
import argparse
import os
import sys

import bpy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from film_export.view import view_of  # noqa: E402


def main():
    parser = argparse.ArgumentParser(prog="cycles_frames.py")
    parser.add_argument("folder")
    parser.add_argument("--frames")
    parser.add_argument("--samples", type=int)
    said = parser.parse_args(sys.argv[sys.argv.index("--") + 1:])
    scene = bpy.context.scene
    render = scene.render
    render.engine, render.use_motion_blur = "CYCLES", False  # the Vector pass needs sharp frames
    render.use_compositing = render.use_sequencer = False
    render.image_settings.file_format, render.image_settings.color_depth = "OPEN_EXR_MULTILAYER", "16"
    render.image_settings.exr_codec = "ZIP"
    if said.samples:
        scene.cycles.samples = said.samples
    for layer in scene.view_layers:
        layer.use_pass_vector = True
    first, last = (int(n) for n in said.frames.split(":")) if said.frames else (0, (scene.frame_end - scene.frame_start) // scene.frame_step)
    cuts = sorted(m.frame for m in scene.timeline_markers if m.camera)
    keyframes = [(frame - scene.frame_start) // scene.frame_step for frame in cuts]
    folder = os.path.abspath(said.folder)
    for number in range(first, last + 1):
        scene.frame_set(scene.frame_start + number * scene.frame_step)
        render.filepath = os.path.join(folder, f"frame.{number:04d}.exr")
        bpy.ops.render.render(write_still=True)
    pattern = os.path.join(folder, "frame.%04d.exr")
    inside = [str(k) for k in keyframes if first < k <= last]
    view, gamma = view_of(scene, lambda text: print("not kept:", text))
    if abs(gamma - 1) > 1e-4:
        print(f"not kept: gamma {gamma:g} of the view")
    print(f"render2mpeg encode '{pattern}' --motion '{pattern}' --fps {render.fps / render.fps_base:g} --exposure {scene.view_settings.exposure:g}"
          + f" --view {view}"
          + (" --keyframes " + ",".join(inside) if inside else "") + " -o film.mpg")


main()
