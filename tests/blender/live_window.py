# SPDX-License-Identifier: Apache-2.0 OR GPL-3.0-or-later
"""xvfb-run -a -s "-screen 0 1024x640x24" blender --factory-startup -noaudio --window-geometry 0 0 1000 600 FILE.blend -P live_window.py -- FOLDER

Shows the viewport in a real window by LiveView, moves the view, then an object, and ends. The program is $RENDER2MPEG_PROGRAM.
Writes screenshots and live.json to FOLDER: {"error"} or seconds from each change to the first picture of it.
"""
import json
import os
import sys
import time
import traceback
from types import SimpleNamespace

import bpy
import gpu
from mathutils import Matrix, Quaternion

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "blender", "render2mpeg"))
sys.dont_write_bytecode = True
import live_view  # noqa: E402

folder = sys.argv[sys.argv.index("--") + 1]
sessions = []


class Engine(live_view.LiveView, bpy.types.RenderEngine):
    bl_idname, bl_label = "RENDER2MPEG_TEST", "render2mpeg"
    bl_use_eevee_viewport = False

    def live_program(self):
        return os.environ["RENDER2MPEG_PROGRAM"]

    def view_update(self, context, depsgraph):
        super().view_update(context, depsgraph)
        if self.live_session not in sessions:
            sessions.append(self.live_session)


def viewport():
    return next(area for area in bpy.context.window_manager.windows[0].screen.areas if area.type == "VIEW_3D")


def shot(name):
    window = bpy.context.window_manager.windows[0]
    with bpy.context.temp_override(window=window, area=viewport()):
        bpy.ops.screen.screenshot(filepath=os.path.join(folder, name + ".png"))


def wait(what, reached, most=90):
    """Steps of a story wait so: `reached` is asked for, again and again."""
    end = time.monotonic() + most
    while not reached():
        if time.monotonic() > end or sessions and sessions[-1].error:
            raise AssertionError(f"{what} did not come: {sessions[-1].status() if sessions else 'no session'}")
        yield 0.01


def says():
    picture = sessions[-1].picture if sessions else None
    return picture[0] if picture else {"picture": 0, "line": -1, "level": "", "pass": 0}


def story(told):
    bpy.context.scene.render.engine = Engine.bl_idname
    space = viewport().spaces.active
    space.overlay.show_overlays = False
    space.show_gizmo = False
    space.region_3d.view_perspective = "CAMERA"
    space.shading.type = "RENDERED"
    start = time.monotonic()
    yield from wait("a first picture", lambda: says()["picture"] > 0)
    told["first"] = time.monotonic() - start
    yield 0.5
    shot("first")
    yield from wait("drafts", lambda: says()["level"] == "draft" and says()["pass"] >= 4)
    yield 0.5
    shot("drafts")
    told["views"] = []
    space.region_3d.view_perspective = "PERSP"
    viewport().tag_redraw()
    yield 0.5
    for k in range(4):
        before, sent = says()["line"], sessions[-1].program
        space.region_3d.view_rotation = Quaternion((0, 0, 1), 0.1) @ space.region_3d.view_rotation
        start = time.monotonic()

        def is_there():
            viewport().tag_redraw()  # as the mouse would, again and again
            return says()["line"] > before
        yield from wait("a picture of another view", is_there)
        told["views"].append({"clock": time.monotonic() - start, "program": says()["seconds"], "cpu": says()["cpu"], "size": says()["size"]})
        assert sessions[-1].program is sent
        yield 0.3
        shot(f"view{k}")
        yield from wait("a draft", lambda: says()["level"] == "draft")
    thing = next(t for t in bpy.context.scene.objects if t.type == "MESH" and max(t.dimensions) < 3)
    exports = sessions[-1].exports
    thing.location.z += 1
    start = time.monotonic()
    yield from wait("an export", lambda: sessions[-1].exports > exports and not sessions[-1].exporting)
    told["export"], told["save"] = time.monotonic() - start, sessions[-1].save_seconds
    number = says()["picture"]
    yield from wait("a picture of the changed scene", lambda: says()["picture"] != number)
    told["moved"] = time.monotonic() - start
    yield from wait("drafts", lambda: says()["level"] == "draft" and says()["pass"] >= 2)
    yield 0.5
    shot("moved")
    yield from see_grey(told, space)
    # One that crashes is started again.
    process, number = sessions[-1].program, says()["picture"]
    process.process.kill()
    yield from wait("another program", lambda: sessions[-1].program not in (None, process) and says()["picture"] not in (0, number))
    told["exports"] = sessions[-1].exports
    told["pids"] = [sessions[-1].program.process.pid, sessions[-1].exporter.process.pid]
    told["folder"] = sessions[-1].folder
    # Without the viewport, no process stays.
    space.shading.type = "SOLID"
    yield from wait("the end", lambda: sessions[-1].closed, 20)


class Drawn(live_view.LiveView):
    """What draws without a window: the rest of a render engine is Blender's."""

    def __init__(self, session):
        self.live_session = session

    def update_stats(self, _name, text):
        self.told = text

    def bind_display_space_shader(self, _scene):
        pass

    def unbind_display_space_shader(self):
        pass

    def __del__(self):
        """The session is the window's."""


def drawn_offscreen(space, width, height):
    """The middle of a picture that view_draw makes in a buffer, scene-linear."""
    buffer = gpu.types.GPUOffScreen(width, height)
    engine = Drawn(sessions[-1])
    context = SimpleNamespace(region=SimpleNamespace(width=width, height=height), region_data=space.region_3d)
    with buffer.bind(), gpu.matrix.push_pop(), gpu.matrix.push_pop_projection():
        gpu.matrix.load_matrix(Matrix.Identity(4))
        gpu.matrix.load_projection_matrix(Matrix(((2 / width, 0, 0, -1), (0, 2 / height, 0, -1), (0, 0, 1, 0), (0, 0, 0, 1))))
        engine.view_draw(context, bpy.context.evaluated_depsgraph_get())
        pixel = gpu.state.active_framebuffer_get().read_color(width // 2, height // 2, 1, 1, 4, 0, "FLOAT").to_list()
    assert engine.told
    return pixel[0][0][0]


def see_grey(told, space):
    """A sky of 0.18: as light in an offscreen buffer, and as the window's code value."""
    scene, exports = bpy.context.scene, sessions[-1].exports
    for thing in scene.objects:
        thing.hide_render = True
    scene.world.use_nodes = False
    scene.world.color = 0.18, 0.18, 0.18
    scene.view_settings.view_transform, scene.view_settings.exposure = "Standard", 0
    yield from wait("a grey sky", lambda: sessions[-1].exports > exports and not sessions[-1].exporting)
    number = says()["picture"]
    yield from wait("a picture of it", lambda: says()["picture"] > number + 2)
    yield 0.5
    shot("grey")
    told["light"] = drawn_offscreen(space, 480, 270)
    region = next(r for r in viewport().regions if r.type == "WINDOW")
    image = bpy.data.images.load(os.path.join(folder, "grey.png"))
    x, y = region.x + region.width // 2, region.y + region.height // 2
    told["grey"] = 255 * image.pixels[4 * (y * image.size[0] + x)]


def step():
    try:
        return next(play)
    except StopIteration:
        pass
    except Exception:
        told["error"] = traceback.format_exc()
    with open(os.path.join(folder, "live.json"), "w") as file:
        json.dump(told, file, indent=1)
    bpy.ops.wm.quit_blender()
    return None


told = {}
play = story(told)
bpy.utils.register_class(Engine)
bpy.app.timers.register(step, first_interval=1)
