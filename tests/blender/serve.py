# SPDX-License-Identifier: Apache-2.0 OR GPL-3.0-or-later
"""blender -b --factory-startup --disable-autoexec -noaudio -P serve.py -- SOCKET [WITHIN]

One Blender for all tests: answers what `tests/blender/served` is asked for as a Blender of its own would, one call after the other. Each
call begins with the factory's file, with its own words, environment, folder and outputs; modules of this tree and of the call's user that
it read are forgotten behind it, and its user's settings and add-ons. Calls that a call makes meanwhile are for the Blender behind WITHIN.
Ends when it is asked to, or after ten minutes without a call; its last line says how many calls it answered in how many CPU seconds.
"""
import array
import io
import json
import os
import resource
import runpy
import socket
import sys
import traceback

import bpy

TREE = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
IDLE_SECONDS = 600


def receive(connection):
    """The words of a call, and the two files that it writes to."""
    files = array.array("i")
    data, ancillary, _, _ = connection.recvmsg(1 << 20, socket.CMSG_LEN(2 * files.itemsize))
    for level, kind, content in ancillary:
        if (level, kind) == (socket.SOL_SOCKET, socket.SCM_RIGHTS):
            files.frombytes(content[:len(content) - len(content) % files.itemsize])
    while not data.endswith(b"\n"):
        more = connection.recv(1 << 20)
        if not more:
            break
        data += more
    return json.loads(data), list(files)


def perform(words):
    """What Blender does with these words, in their order; the exit status."""
    status_of_mistakes = 0
    bpy.ops.wm.read_homefile(use_factory_startup=True)
    rest = iter(words)
    try:
        for word in rest:
            if word == "--":
                break
            if word == "--python-exit-code":
                status_of_mistakes = int(next(rest))
            elif word == "--version":
                print(f"Blender {bpy.app.version_string}")
            elif word in {"-P", "--python"}:
                runpy.run_path(next(rest), run_name="__main__")
            elif word == "--python-expr":
                exec(compile(next(rest), "--python-expr", "exec"), {"__name__": "__main__"})
            elif not word.startswith("-"):
                bpy.ops.wm.open_mainfile(filepath=os.path.abspath(word), load_ui=False, use_scripts=False)
    except SystemExit as end:
        return end.code if isinstance(end.code, int) else int(end.code is not None)
    except BaseException:
        traceback.print_exc()
        return status_of_mistakes
    finally:
        for name in [name for name, module in sys.modules.items() if module is None]:
            del sys.modules[name]  # Cycles, which a test takes away, begins again with the settings
        if "BLENDER_USER_SCRIPTS" in os.environ:
            bpy.ops.wm.read_factory_settings()  # where the user's add-ons still lie
    return 0


def used():
    """CPU seconds of this Blender and of what it started."""
    return sum(sum(resource.getrusage(who)[:2]) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))


def count_for(environment, seconds):
    """Adds CPU seconds to those of the test that calls (tests/support/cpu_seconds.cpp)."""
    if "RENDER2MPEG_TEST" in environment and "RENDER2MPEG_TEST_TIMES" in environment:
        with open(environment["RENDER2MPEG_TEST_TIMES"], "a") as file:
            file.write(f"{environment['RENDER2MPEG_TEST']} {seconds:.2f} 0 0\n")


def answer(call, files, within):
    """Does it in the caller's place, and puts all back."""
    kept = dict(os.environ), os.getcwd(), sys.argv, list(sys.path), dict(sys.modules), os.dup(1), os.dup(2), os.sched_getaffinity(0)
    environment, folder, argv, path, modules, out, err, cores = kept
    try:
        for file, place in zip(files, (1, 2)):
            os.dup2(file, place)
        os.chdir(call["folder"])
        os.environ.clear()
        os.environ.update(call["environment"])
        os.environ.pop("RENDER2MPEG_TEST_BLENDER", None)  # this one would wait for the call's end
        os.environ.update({"RENDER2MPEG_TEST_BLENDER": place for place in within})
        sys.argv = ["blender", *call["words"]]
        return perform(call["words"])
    finally:
        for stream in (sys.stdout, sys.stderr):
            if isinstance(stream, io.TextIOBase):
                stream.flush()
        os.dup2(out, 1)
        os.dup2(err, 2)
        for file in (out, err, *files):
            os.close(file)
        os.environ.clear()
        os.environ.update(environment)
        os.chdir(folder)
        os.sched_setaffinity(0, cores)
        sys.argv, sys.path[:] = argv, path
        own = TREE, call["environment"].get("BLENDER_USER_SCRIPTS", TREE)
        for name in set(sys.modules) - set(modules):
            if sys.modules[name] is None or (getattr(sys.modules[name], "__file__", None) or "").startswith(own):
                del sys.modules[name]
        sys.modules.update(modules)


def main():
    place, *within = sys.argv[sys.argv.index("--") + 1:]
    server = socket.socket(socket.AF_UNIX)
    server.bind(os.path.relpath(place) + ".new")  # from the folder that `served` starts it in: a socket's name has at most 107 bytes
    server.listen(64)
    os.rename(place + ".new", place)
    server.settimeout(IDLE_SECONDS)
    calls = 0
    try:
        while True:
            connection, _ = server.accept()
            with connection:
                connection.settimeout(None)
                try:
                    call, files = receive(connection)
                except ValueError:
                    continue  # the caller was gone before it had asked
                if call["words"] == ["--stop"]:
                    break
                calls, before = calls + 1, used()
                status = answer(call, files, within)
                count_for(call["environment"], used() - before)
                try:
                    connection.sendall(json.dumps({"status": status}).encode())
                except OSError:
                    pass  # the caller is gone
    except socket.timeout:
        pass
    finally:
        os.unlink(place)
    print(f"BLENDER ANSWERED {calls} {used():.1f}", flush=True)


main()
