# SPDX-License-Identifier: Apache-2.0 OR GPL-3.0-or-later
"""blender -b --factory-startup --disable-autoexec -noaudio -P live_export.py

Exports one .blend after the other while Blender stays, for the view in Blender's viewport. Each line of standard input is
{"blend": FILE, "folder": FOLDER}; FOLDER gets the frame that it was saved at, as by export_film.py, with small baked textures and sky.
The answer is a line on standard output: "render2mpeg ", then {"folder", "lost"} or {"folder", "error"}. Ends with its input.
"""
import json
import os
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
sys.dont_write_bytecode = True

import export_film  # noqa: E402
from film_export import world  # noqa: E402

# What is looked at while one works comes soon rather than sharp: texels along a side of baked textures, and the sky's image.
TEXTURE_SIZE = 128
world.WIDTH, world.HEIGHT, world.SAMPLES = 512, 256, 4


def main():
    for line in sys.stdin:
        asked = json.loads(line)
        result = export_film.told(asked["blend"], asked["folder"], TEXTURE_SIZE, still=True)
        print("render2mpeg " + json.dumps({"folder": asked["folder"], **result}), flush=True)


main()
