# SPDX-License-Identifier: Apache-2.0 OR GPL-3.0-or-later
"""PYTHON bpy_program.py [FILE.blend] [--python SCRIPT] [-- WORDS]: Blender's command line for a Python whose module bpy is Blender.

Of Blender's other words those that this module always follows are taken and change nothing: it runs in the background, with factory
settings, and executes nothing that a .blend holds. An error of a script ends it with status 1. It leaves without the module's own
end, which after renders may wait for ever.
"""
import os
import runpy
import sys
import traceback

FOLLOWED = {"-b", "--background", "--factory-startup", "--disable-autoexec", "-noaudio"}


def main(words):
    try:
        import bpy
    except Exception as failure:  # a broken module fails in many ways
        return f"{sys.executable}: Blender's module bpy does not start: {' '.join(str(failure).split())}"
    bpy.app.binary_path = sys.executable  # starts others of its kind, as RENDER2MPEG_BLENDER
    bpy.ops.wm.read_factory_settings()
    given = iter(words[:words.index("--")] if "--" in words else words)
    for word in given:
        if word in ("-P", "--python"):
            script = next(given)
            sys.argv = ["blender", *words]
            sys.path.insert(0, os.path.dirname(os.path.abspath(script)))
            runpy.run_path(script, run_name="__main__")
        elif word == "--python-exit-code":
            next(given)
        elif not word.startswith("-"):
            bpy.ops.wm.open_mainfile(filepath=os.path.abspath(word), use_scripts=False)
        elif word not in FOLLOWED:
            return f"bpy_program.py: {word} is none of the words that it knows"
    return 0


try:
    status = main(sys.argv[1:])
except SystemExit as end:
    status = end.code
except Exception:
    traceback.print_exc()
    status = 1
if isinstance(status, str):
    print(status, file=sys.stderr)
    status = 1
sys.stdout.flush()
sys.stderr.flush()
os._exit(status or 0)
