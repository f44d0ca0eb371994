# SPDX-License-Identifier: Apache-2.0 OR GPL-3.0-or-later
"""blender -b --factory-startup -noaudio --python-exit-code 1 FILE.blend -P use_engine.py -- REPOSITORY FOLDER

Makes stills, a film and mistakes with the render engine, and holds its pixels against the program's own images of the same frames.
The program is $RENDER2MPEG_PROGRAM.
"""
import os
import subprocess
import sys

import bpy
import numpy as np

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
sys.dont_write_bytecode = True
from install_extension import install  # noqa: E402

repository, folder = sys.argv[sys.argv.index("--") + 1:]
package = install(repository)
sys.path.insert(0, os.path.dirname(package.__file__))
from exr import read_colours, take_colours  # noqa: E402

scene = bpy.context.scene
render, settings = scene.render, scene.render2mpeg
render.engine = "RENDER2MPEG"
render.resolution_x, render.resolution_y, render.resolution_percentage = 64, 48, 50
render.image_settings.file_format, render.image_settings.color_depth = "OPEN_EXR", "32"
render.use_compositing = False
settings.output, settings.quantiser = os.path.join(folder, "film.mpg"), 20


def pixels(path):
    image = bpy.data.images.load(path)
    values = np.array(image.pixels[:]).reshape(image.size[1], image.size[0], -1)[:, :, :3]
    bpy.data.images.remove(image)
    return values


def save(name):
    path = os.path.join(folder, name)
    bpy.ops.wm.save_as_mainfile(filepath=path, copy=True)
    return path


def own(blend, *words):
    image = os.path.join(folder, "own.%04d.exr")
    subprocess.run([os.environ["RENDER2MPEG_PROGRAM"], "render", blend, "-o", image, "--quiet", "-y", *words], check=True,
                   env=dict(os.environ, RENDER2MPEG_BLENDER=bpy.app.binary_path))
    return image


def still(name):
    render.filepath = os.path.join(folder, name)
    assert bpy.ops.render.render(write_still=True) == {"FINISHED"}
    return pixels(render.filepath)


def refused(because, **words):
    try:
        bpy.ops.render.render(**words)
    except RuntimeError as error:
        assert because in str(error), error
        return
    raise AssertionError("it was not refused")


# F12: the frame, as the program has it in a film of this frame alone; the scene's frames stay.
begin, end = scene.frame_start, scene.frame_end
scene.frame_set(begin + 2)
whole = still("still.exr")
assert (scene.frame_start, scene.frame_end) == (begin, end)
scene.frame_start = scene.frame_end = begin + 2
expected = pixels(own(save("one.blend"), "--frames", "0:0") % 0)
scene.frame_start, scene.frame_end = begin, end
assert whole.shape == (24, 32, 3) and whole.max() > 0.05, whole.shape
assert (whole == expected).all(), abs(whole - expected).max()

# The border's part of it.
render.use_border, render.use_crop_to_border = True, True
render.border_min_x, render.border_max_x, render.border_min_y, render.border_max_y = 0.25, 0.75, 0.5, 1
part = still("part.exr")
assert part.shape == (12, 16, 3) and (part == whole[12:24, 8:24]).all(), part.shape
render.use_border = False

# Both eyes.
render.use_multiview, render.views_format, render.image_settings.views_format = True, "STEREO_3D", "INDIVIDUAL"
scene.frame_start = scene.frame_end = begin + 2
both = own(save("eyes.blend"), "--frames", "0:0") % 0
scene.frame_start, scene.frame_end = begin, end
render.filepath = os.path.join(folder, "eyes.exr")
assert bpy.ops.render.render(write_still=True) == {"FINISHED"}
render.use_multiview = False
both = pixels(both)
# Blender has no pixels of files that name their view.
left, right = (read_colours(os.path.join(folder, f"eyes_{side}.exr"))[::-1, :0:-1].transpose(0, 2, 1) for side in "LR")
assert both.shape == (24, 64, 3) and (both[:, :32] == left).all() and (both[:, 32:] == right).all(), both.shape
assert (left != right).any()

# A still of moving things is blurred by what they do before and after it, and only then.
thing = next(thing for thing in scene.objects if thing.type == "MESH" and thing.animation_data is None)
for frame, place in ((begin, -1), (begin + 4, 1)):
    thing.location.x = place
    thing.keyframe_insert("location", frame=frame)
sharp = still("sharp.exr")
render.use_motion_blur = True
assert (still("blurred.exr") != sharp).any()
render.use_motion_blur = False
assert (still("sharp.exr") == sharp).all()

# Settings reach the program.
settings.effort = "DRAFT"
assert (still("draft.exr") != sharp).any()
settings.effort = "DEFAULT"

# Render Animation: the film, and each frame's picture.
scene.frame_start, scene.frame_end = begin, begin + 2
render.filepath = os.path.join(folder, "frames", "f")
assert bpy.ops.render.render(animation=True) == {"FINISHED"}
assert os.path.getsize(settings.output) > 1000
assert os.path.isfile(os.path.join(folder, "film.html"))
assert not os.path.exists(settings.output + ".blender") and not os.path.exists(settings.output + ".partial")
three = save("three.blend")
layers = os.path.join(folder, "layers")
subprocess.run([os.environ["RENDER2MPEG_PROGRAM"], "render", three, "-o", os.path.join(folder, "same.mpg"), "--quantiser", "20", "-y",
                "--quiet", "--aov", layers], check=True, env=dict(os.environ, RENDER2MPEG_BLENDER=bpy.app.binary_path))
with open(settings.output, "rb") as ours, open(os.path.join(folder, "same.mpg"), "rb") as same:
    assert ours.read() == same.read(), "another film"
seen = [pixels(f"{render.filepath}{frame:04d}.exr") for frame in range(begin, begin + 3)]
assert (seen[0] != seen[2]).any()
for number, frame in enumerate(seen):
    take_colours(os.path.join(layers, f"frame_{number:04d}.exr"), os.path.join(folder, "colours.exr"))
    assert (frame == pixels(os.path.join(folder, "colours.exr"))).all()

# The forecast is shown.
assert bpy.ops.render2mpeg.forecast() == {"FINISHED"}
assert bpy.context.window_manager.render2mpeg_forecast.startswith("Takes "), bpy.context.window_manager.render2mpeg_forecast

# Mistakes end in Blender's reports, in the program's words, and leave frames made before alone.
before = os.stat(f"{render.filepath}{begin:04d}.exr").st_mtime_ns
settings.output = os.path.join(folder, "film.doc")
refused("film.doc: the ending chooses", animation=True)
assert os.stat(f"{render.filepath}{begin:04d}.exr").st_mtime_ns == before
assert not os.path.exists(settings.output + ".blender")
settings.control = "SIZE"
refused("Render Film", animation=True)
settings.control, settings.effort = "QUANTISER", "DRAFT"
refused("Drafts have no layers", animation=True)
settings.effort, ours = "DEFAULT", os.environ["RENDER2MPEG_PROGRAM"]
os.environ["RENDER2MPEG_PROGRAM"] = "/nowhere/render2mpeg"
refused("render2mpeg is missing")

# After a mistake all is as before. (Blender's exit status is that of its last render, too.)
os.environ["RENDER2MPEG_PROGRAM"] = ours
scene.frame_set(begin + 2)
assert (still("sharp.exr") == sharp).all()
print("ENGINE WORKS")
