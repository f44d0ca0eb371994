# SPDX-License-Identifier: Apache-2.0 OR GPL-3.0-or-later
"""blender -b --factory-startup -noaudio --python-exit-code 1 FILE.blend -P use_operators.py -- REPOSITORY FOLDER

Installs the add-on as a user does and makes a film and a folder with it, at two fifths of the size. The program is
$RENDER2MPEG_PROGRAM.
"""
import os
import sys

import bpy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
sys.dont_write_bytecode = True
from install_extension import install  # noqa: E402

repository, folder = sys.argv[sys.argv.index("--") + 1:]
package = install(repository)

settings = bpy.context.scene.render2mpeg
settings.output, settings.quantiser = os.path.join(folder, "film.mpg"), 20
bpy.context.scene.render.resolution_percentage = 40
settings.folder = os.path.join(folder, "elsewhere")
bpy.context.scene.render.use_border = True  # which is told
bpy.ops.wm.save_mainfile()
assert bpy.ops.render2mpeg.film() == {"FINISHED"}
assert os.path.getsize(settings.output) > 1000
assert os.path.isfile(os.path.join(folder, "film.html"))
# The frame lit last is shown where Blender shows images.
assert package.operators.show_last_frame(0) > 0
assert bpy.data.images["render2mpeg"].size[0] > 0
said = bpy.data.texts["render2mpeg"].as_string()
assert "not kept: Scene: render region" in said, said
# A .blend of strangers names its film so; the folder's script takes it for a name.
settings.output = os.path.join(folder, "-it's; touch PWNED; $(touch PWNED).mpg")
assert bpy.ops.render2mpeg.folder() == {"FINISHED"}
for name in ("film.json", "scene.glb", "render.sh"):
    assert os.path.isfile(os.path.join(settings.folder, name)), name

# A film that cannot be made is told in a line.
settings.output = os.path.join(folder, "film.doc")
try:
    bpy.ops.render2mpeg.film()
    raise AssertionError("it was not refused")
except RuntimeError as error:
    assert "film.doc" in str(error), error

# A run can be watched and stopped.
settings.output, bpy.context.scene.render.resolution_percentage = os.path.join(folder, "stopped.mpg"), 400
bpy.ops.wm.save_mainfile()
run = package.program.Run(package.operators.film_words(bpy.context.scene, bpy.data.filepath))
run.stop()
assert run.wait() != 0
bpy.ops.preferences.addon_disable(module=package.__name__)
print("ADDON WORKS")
