# SPDX-License-Identifier: Apache-2.0 OR GPL-3.0-or-later
"""Files that a scene names. Those that are no plain files are never opened: a device may never end, a pipe never begin."""
import itertools
import os
import re
import stat

import bpy

KINDS = ((stat.S_ISCHR, "a device"), (stat.S_ISBLK, "a device"), (stat.S_ISFIFO, "a pipe"), (stat.S_ISSOCK, "a socket"))
# Things whose file is none where it is a folder.
OF_FILES = ("images", "sounds", "volumes", "cache_files", "movieclips", "fonts")


def kind_of(path):
    """What is no plain file and no folder, in words; None of others, and of what is not there."""
    try:
        mode = os.stat(path).st_mode
    except (OSError, ValueError):
        return None
    return next((words for test, words in KINDS if test(mode)), None)


def siblings(path):
    """The files of a sequence, or of tiles: those that differ in digits alone."""
    folder, name = os.path.split(path)
    shape = re.compile(re.sub(r"<UDIM>|\d+", lambda _: r"(\d+|<UDIM>)", re.escape(name)))
    try:
        return [os.path.join(folder, other) for other in os.listdir(folder) if shape.fullmatch(other)]
    except OSError:
        return []


def domains():
    """Objects with a fluid domain, and its modifier."""
    for thing in bpy.data.objects:
        for modifier in thing.modifiers:
            if modifier.type == "FLUID" and modifier.fluid_type == "DOMAIN":
                yield thing, modifier


def cached(thing, modifier):
    """The files of a fluid's bake, of which ten thousand are looked at."""
    folder = bpy.path.abspath(modifier.domain_settings.cache_directory, library=thing.library)
    below = (os.path.join(at, name) for at, _, names in os.walk(folder) for name in names)
    return itertools.islice(below, 10000)


def unreadable():
    """(path, kind) of the first thing that is no plain file, after which nothing of the scene reads it; None without one."""
    named = bpy.utils.blend_paths(absolute=True, packed=False, local=False)
    moving = [image for image in bpy.data.images if image.source in {"SEQUENCE", "TILED"}]
    moving += [volume for volume in bpy.data.volumes if volume.is_sequence]
    for thing in moving:
        named += siblings(bpy.path.abspath(thing.filepath, library=thing.library))
    found = next(((path, kind) for path in named if (kind := kind_of(path))), None)
    for thing in bpy.data.objects:
        for modifier in thing.modifiers:
            if modifier.type == "MESH_CACHE" and kind_of(bpy.path.abspath(modifier.filepath, library=thing.library)):
                modifier.show_viewport = modifier.show_render = False
    for volume in bpy.data.volumes:
        path = bpy.path.abspath(volume.filepath, library=volume.library)
        if any(map(kind_of, [path] + (siblings(path) if volume.is_sequence else []))):
            volume.filepath = ""
    for thing, modifier in domains():
        bad = next(((path, kind) for path in cached(thing, modifier) if (kind := kind_of(path))), None)
        if bad:
            modifier.show_viewport = modifier.show_render = False
            found = found or bad
    return found


def is_there(thing, path):
    """Whether a thing's file, or one of its sequence or tiles, is; or none is asked for."""
    moves = getattr(thing, "source", "") in {"SEQUENCE", "TILED"} or getattr(thing, "is_sequence", False)
    return os.path.exists(path) or moves and bool(siblings(path))


def tell_missing(lost):
    """Files that are not there, and folders in their places."""
    for kind in ("libraries", *OF_FILES):
        for thing in getattr(bpy.data, kind):
            named = thing.filepath if getattr(thing, "source", "FILE") not in {"GENERATED", "VIEWER"} else ""
            path = bpy.path.abspath(named, library=thing.library) if named and named != "<builtin>" else ""
            if not path or not thing.users and kind != "libraries" or getattr(thing, "packed_file", None) or getattr(thing, "packed_files", None):
                continue
            if os.path.isdir(path):
                lost.add(thing, f"{path} is a folder, not a file")
            elif not is_there(thing, path):
                lost.add(thing, f"{path} is missing" + ("; pink, as Cycles shows it" if kind == "images" else ""))
