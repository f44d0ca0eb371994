# SPDX-License-Identifier: Apache-2.0 OR GPL-3.0-or-later
"""blender -b --factory-startup --disable-autoexec -P frames.py -- FILE.blend FOLDER SETTINGS FRAME...

Frames of a .blend, counted from 0 as films count them, by Cycles to FOLDER/NNNN.exr: linear light, a box as pixel filter, without
compositing; both eyes' in one, as films hold them. SETTINGS is JSON: `size`; `threads`, 0: all; `samples`, or below 1 the noise threshold of adaptive sampling; `seed`, and
whether it changes `by_frame`; `guiding` of paths; `kind`. truth: with all that the scene says but for what would make it another
light: no clamp, caustics, enough bounces. own: as the scene has it, with the layers that denoisers want. denoised: as own, by the
denoiser of this Blender. FOLDER/seconds.json: CPU seconds of each frame.
"""
import json
import os
import sys

import bpy
import numpy as np

sys.dont_write_bytecode = True
sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import exr  # noqa: E402

MOST_SAMPLES = 4096  # of adaptive sampling: Blender's default

blend, folder, said, *frames = sys.argv[sys.argv.index("--") + 1:]
said = json.loads(said)
try:
    bpy.ops.wm.open_mainfile(filepath=blend, use_scripts=False)
except RuntimeError as failure:
    raise SystemExit(f"{blend}: {' '.join(str(failure).split())}") from None
scene = bpy.context.scene
render, cycles = scene.render, scene.cycles
render.engine, cycles.device = "CYCLES", "CPU"
render.use_persistent_data = True
render.use_compositing = render.use_sequencer = render.use_border = False
render.resolution_x, render.resolution_y = said["size"]
render.resolution_percentage, render.dither_intensity = 100, 0
if said["threads"]:
    render.threads_mode, render.threads = "FIXED", said["threads"]
kind, adaptive = said["kind"], said["samples"] < 1
cycles.use_adaptive_sampling, cycles.adaptive_min_samples = adaptive, 0
cycles.samples = MOST_SAMPLES if adaptive else said["samples"]
if adaptive:
    cycles.adaptive_threshold = said["samples"]
cycles.seed, cycles.use_animated_seed, cycles.use_denoising = said["seed"], said["by_frame"], kind == "denoised"
if hasattr(cycles, "use_light_tree"):
    cycles.use_light_tree = True  # as new files have it; Blender turns it off in those of before 3.5
if said["guiding"]:
    cycles.use_guiding = True
if kind == "truth":
    cycles.caustics_reflective = cycles.caustics_refractive = True
    cycles.blur_glossy = cycles.sample_clamp_direct = cycles.sample_clamp_indirect = cycles.light_sampling_threshold = 0
    cycles.max_bounces = cycles.diffuse_bounces = cycles.glossy_bounces = cycles.transmission_bounces = cycles.transparent_max_bounces = cycles.volume_bounces = 24
if kind == "denoised":
    cycles.denoiser, cycles.denoising_input_passes, cycles.denoising_prefilter = "OPENIMAGEDENOISE", "RGB_ALBEDO_NORMAL", "ACCURATE"
bpy.context.view_layer.cycles.denoising_store_passes = kind == "own"
cycles.pixel_filter_type, cycles.filter_width = "BOX", 1.0
settings = render.image_settings
below = settings.views_format == "STEREO_3D" and settings.stereo_3d_format.display_mode == "TOPBOTTOM"  # which some formats forget
settings.file_format, settings.color_depth = "OPEN_EXR_MULTILAYER" if kind == "own" else "OPEN_EXR", "32"
settings.color_mode, settings.exr_codec = "RGB", "NONE"
eyes = []
if render.use_multiview and render.views_format == "STEREO_3D":
    settings.views_format = "INDIVIDUAL"
    eyes = [render.views[name] for name in ("left", "right")]
    for eye in eyes:
        eye.use = True
else:
    render.use_multiview = False


def pack(path):
    """Both eyes' files as one, without compression."""
    files = [path.replace(".exr", f"{eye.file_suffix}.exr") for eye in eyes]
    left, right = map(exr.read, files)
    # Layers' names end in the view's.
    plain = lambda layers, eye: {name.replace(f".{eye.name}", ""): plane for name, plane in layers.items()}  # noqa: E731
    left, right = plain(left, eyes[0]), plain(right, eyes[1])
    exr.write(path, {name: np.concatenate([left[name], right[name]], 0 if below else 1) for name in left})
    for file in files:
        os.remove(file)


taken = []
for frame in map(int, frames):
    scene.frame_set(scene.frame_start + frame * scene.frame_step)
    render.filepath = os.path.join(folder, f"{frame:04d}.exr")
    before = os.times()
    bpy.ops.render.render(write_still=True)
    after = os.times()
    taken.append(after.user + after.system - before.user - before.system)
    if eyes:
        pack(render.filepath)
with open(os.path.join(folder, "seconds.json"), "w") as file:
    json.dump(taken, file)
