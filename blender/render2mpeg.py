"""Blender add-on: renders the scene's film with render2mpeg, straight to MPEG-2.

Install it under Edit > Preferences > Add-ons > Install. Render > Render Film (render2mpeg) and the panel "render2mpeg" of the
render properties then make films with the program, which must be on the PATH or be named in the add-on's preferences.
"""
import os
import re
import shlex
import shutil
import signal
import subprocess
import tempfile
import threading
import time

import bpy
from bpy_extras import view3d_utils
from mathutils import Matrix, Vector

bl_info = {
    "name": "render2mpeg",
    "author": "render2mpeg",
    "version": (0, 1, 0),
    "blender": (3, 4, 0),
    "location": "Render menu; render properties",
    "description": "Films with global illumination, rendered straight to MPEG",
    "category": "Render",
}


def program():
    """The render2mpeg that is used; None where there is none."""
    addon = bpy.context.preferences.addons.get(__name__)
    named = bpy.path.abspath(addon.preferences.program) if addon and addon.preferences.program else os.environ.get("RENDER2MPEG_PROGRAM")
    if named:
        return named if os.path.isfile(named) else None
    return shutil.which("render2mpeg")


def saved_copy():
    """A .blend that holds what Blender shows: the file itself, or a copy where it was changed since it was saved."""
    if bpy.data.filepath and not bpy.data.is_dirty:
        return bpy.data.filepath
    name = os.path.basename(bpy.data.filepath) or "untitled.blend"
    folder = os.path.join(tempfile.gettempdir(), f"render2mpeg-{os.getuid()}-{os.getpid()}")
    os.makedirs(folder, mode=0o700, exist_ok=True)
    path = os.path.join(folder, name)
    bpy.ops.wm.save_as_mainfile(filepath=path, copy=True, check_existing=False)
    return path


def size_words(scene):
    settings = scene.render2mpeg
    if settings.percentage == 100:
        return []
    render = scene.render
    width = max(16, render.resolution_x * render.resolution_percentage * settings.percentage // 10000)
    height = max(16, render.resolution_y * render.resolution_percentage * settings.percentage // 10000)
    return ["--size", f"{width - width % 2}x{height - height % 2}"]


def last_frame_file():
    folder = os.path.join(tempfile.gettempdir(), f"render2mpeg-{os.getuid()}-{os.getpid()}")
    os.makedirs(folder, mode=0o700, exist_ok=True)
    return os.path.join(folder, "last_frame.png")


def show_last_frame(seen):
    """Shows the frame lit last in Blender's image editors, where it is newer than `seen`; returns how new it is."""
    file = last_frame_file()
    if not os.path.isfile(file) or os.stat(file).st_mtime_ns <= seen:
        return seen
    image = bpy.data.images.get("render2mpeg")
    if image is None:
        image = bpy.data.images.load(file)
        image.name = "render2mpeg"
    image.reload()
    for window in bpy.context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "IMAGE_EDITOR":
                area.spaces.active.image = image
                area.tag_redraw()
    return os.stat(file).st_mtime_ns


def film_words(scene, blend):
    """What makes the film."""
    settings = scene.render2mpeg
    output = bpy.path.abspath(settings.output)
    words = [blend, "-o", output] + size_words(scene)
    if settings.codec != "ENDING":
        words += ["--codec", settings.codec]
    if settings.control == "QUANTISER":
        words = ["render"] + words + ["--quantiser", str(settings.quantiser), "--resume", "--overwrite",
                                      "--last-frame", last_frame_file()]
    elif settings.control == "SIZE":
        words = ["tune"] + words + ["--overwrite", "--max-size", f"{settings.megabytes:g}M"]
    else:
        words = ["tune"] + words + ["--overwrite", "--target-psnr", f"{settings.decibels:g}"]
    if settings.report and settings.control == "QUANTISER":
        words += ["--report", os.path.splitext(output)[0] + ".html"]
    return words


class Run:
    """One run of the program. Its messages are read while it works, as at a terminal."""

    def __init__(self, words):
        self.lines, self.done, self.total, self.rest = [], 0, 0, ""
        self.words = [program()] + words
        master, slave = os.openpty()
        environment = dict(os.environ, TERM="xterm", COLUMNS="120", RENDER2MPEG_BLENDER=bpy.app.binary_path)
        self.process = subprocess.Popen(self.words, stdin=subprocess.DEVNULL, stdout=slave, stderr=slave, env=environment,
                                        start_new_session=True)
        os.close(slave)
        self.reader = threading.Thread(target=self.read, args=(master,), daemon=True)
        self.reader.start()

    def read(self, master):
        try:
            while True:
                self.take(os.read(master, 4096).decode(errors="replace"))
        except OSError:  # the other end is closed
            pass
        os.close(master)

    def take(self, text):
        parts = re.split(r"[\r\n]+", self.rest + text)
        self.rest = parts.pop()
        for part in parts + [self.rest]:
            counted = re.search(r"frame (\d+)/(\d+)", part)
            if counted:
                self.done, self.total = int(counted[1]), int(counted[2])
        self.lines += [clean for clean in (re.sub(r"\x1b\[[0-9;]*[A-Za-z]", "", p).strip() for p in parts) if clean]

    def status(self):
        """None while it works; then the exit status."""
        code = self.process.poll()
        if code is not None:
            self.reader.join(2)
        return code

    def wait(self):
        self.process.wait()
        return self.status()

    def stop(self):
        """As Ctrl-C does: what there is can be resumed."""
        if self.process.poll() is None:
            os.killpg(self.process.pid, signal.SIGINT)

    def message(self):
        """What went wrong, or the last that was said."""
        told = [line for line in self.lines if line.startswith("render2mpeg:")]
        return (told or self.lines or ["render2mpeg said nothing"])[-1]


def keep_text(name, lines):
    """What the program said, to be read in Blender's text editor."""
    text = bpy.data.texts.get(name) or bpy.data.texts.new(name)
    text.clear()
    text.write("\n".join(lines) + "\n")


class Working:
    """An operator that runs the program: waits for it in the background, else lets Blender live on and shows how far it is."""

    running = None
    timer = None
    seen = 0

    def words(self, context):
        raise NotImplementedError

    def finish(self, context):
        """Called when the program ended well."""

    def begin(self, context):
        if program() is None:
            self.report({"ERROR"}, "The program render2mpeg is missing: name it in the add-on's preferences")
            return False
        self.running = Run(self.words(context))
        self.seen = time.time_ns()
        return True

    def end(self, context, status):
        keep_text("render2mpeg", self.running.lines)
        if status == 130 or status == -signal.SIGINT:
            self.report({"WARNING"}, "Stopped; the same film goes on where it was")
            return {"CANCELLED"}
        if status != 0:
            self.report({"ERROR"}, self.running.message())
            return {"CANCELLED"}
        self.finish(context)
        return {"FINISHED"}

    def execute(self, context):
        return self.end(context, self.running.wait()) if self.begin(context) else {"CANCELLED"}

    def invoke(self, context, _event):
        if not self.begin(context):
            return {"CANCELLED"}
        manager = context.window_manager
        manager.progress_begin(0, 100)
        self.timer = manager.event_timer_add(0.2, window=context.window)
        manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        run = self.running
        if event.type == "ESC":
            run.stop()
        status = run.status()
        if status is None:
            self.seen = show_last_frame(self.seen)
            share = 100 * run.done // run.total if run.total else 0
            context.window_manager.progress_update(share)
            context.workspace.status_text_set(f"render2mpeg: frame {run.done} of {run.total}   (Esc stops)" if run.total
                                              else "render2mpeg: exporting   (Esc stops)")
            return {"RUNNING_MODAL"} if event.type in {"TIMER", "ESC"} else {"PASS_THROUGH"}
        context.window_manager.event_timer_remove(self.timer)
        context.window_manager.progress_end()
        context.workspace.status_text_set(None)
        return self.end(context, status)


class RENDER2MPEG_OT_film(Working, bpy.types.Operator):
    bl_idname, bl_label = "render2mpeg.film", "Render Film (render2mpeg)"
    bl_description = "Render the scene's frames with global illumination straight to an MPEG-2 film"

    def words(self, context):
        return film_words(context.scene, saved_copy())

    def finish(self, context):
        settings = context.scene.render2mpeg
        output = bpy.path.abspath(settings.output)
        lost = [line for line in self.running.lines if line.startswith("not kept: ")]
        self.report({"INFO"}, f"{output}" + (f"; {len(lost)} things are not kept, see the text render2mpeg" if lost else ""))
        if settings.open_film and not bpy.app.background:
            bpy.ops.wm.path_open(filepath=output)


class RENDER2MPEG_OT_cost(Working, bpy.types.Operator):
    bl_idname, bl_label = "render2mpeg.cost", "Cost"
    bl_description = "What accuracy costs in time, on a few frames of the film"

    def words(self, context):
        return ["cost", saved_copy()] + size_words(context.scene)

    def finish(self, context):
        self.report({"INFO"}, "See the text render2mpeg")


class RENDER2MPEG_OT_folder(Working, bpy.types.Operator):
    bl_idname, bl_label = "render2mpeg.folder", "Write Folder"
    bl_description = "Write the film's scene to a folder that is rendered elsewhere, without Blender"
    blend = ""

    def words(self, context):
        self.blend = saved_copy()
        return ["plan", self.blend, "--within", "0"]

    def finish(self, context):
        made = self.blend + ".export"
        newest = max((os.path.join(made, n) for n in os.listdir(made)), key=lambda f: os.path.getmtime(os.path.join(f, "export.json")))
        target = bpy.path.abspath(context.scene.render2mpeg.folder)
        shutil.copytree(newest, target, dirs_exist_ok=True, ignore=shutil.ignore_patterns("blender.log"))
        words = film_words(context.scene, ".")
        if "--last-frame" in words:
            at = words.index("--last-frame")
            del words[at:at + 2]
        for option in {"-o", "--report"}.intersection(words):
            words[words.index(option) + 1] = os.path.join(".", os.path.basename(words[words.index(option) + 1]))
        with open(os.path.join(target, "render.sh"), "w") as file:
            file.write("#!/bin/sh\n# Makes the film where render2mpeg is installed.\ncd -- \"$(dirname -- \"$0\")\" && render2mpeg "
                       + shlex.join(w for w in words if w != "--resume") + "\n")
        os.chmod(os.path.join(target, "render.sh"), 0o755)
        self.report({"INFO"}, target)


def aims_of(mirror):
    """Empties that tell it what to show."""
    return [thing for thing in mirror.children if thing.type == "EMPTY" and "aim_radius" in thing.keys()]


def view_under(context, event):
    """The view's region and the place in it under the mouse; None elsewhere."""
    for area in context.window.screen.areas:
        region = next((r for r in area.regions if r.type == "WINDOW"), None)
        if area.type == "VIEW_3D" and region:
            place = Vector((event.mouse_x - region.x, event.mouse_y - region.y))
            if 0 <= place.x < region.width and 0 <= place.y < region.height:
                return region, area.spaces.active.region_3d, place
    return None


def thing_under(context, view):
    """What is seen at a place of a view, and where: by its surface, else by its origin within 30 pixels."""
    origin, direction = view3d_utils.region_2d_to_origin_3d(*view), view3d_utils.region_2d_to_vector_3d(*view)
    met, place, _, _, thing, _ = context.scene.ray_cast(context.evaluated_depsgraph_get(), origin, direction)
    if met:
        return thing.original, place
    region, region_3d, mouse = view
    near = []
    for other in context.visible_objects:
        at = view3d_utils.location_3d_to_region_2d(region, region_3d, other.matrix_world.translation)
        if at is not None and (at - mouse).length < 30:
            near.append(((at - mouse).length, other.name, other))
    return (min(near)[2], None) if near else (None, None)


class RENDER2MPEG_OT_aim(bpy.types.Operator):
    bl_idname, bl_label = "render2mpeg.aim", "Aim Reflection"
    bl_description = "Have the active object mirror something at a point: click the point on it, then what is to be seen there"
    bl_options = {"REGISTER", "UNDO"}
    point: bpy.props.FloatVectorProperty(name="Point", subtype="XYZ", description="On the mirror, in the world")
    target: bpy.props.StringProperty(name="Target", description="Name of the object to be seen there")
    picked = False

    @classmethod
    def poll(cls, context):
        return context.object is not None and context.object.type in {"MESH", "CURVE", "SURFACE", "FONT", "META"}

    def execute(self, context):
        mirror, target = context.object, bpy.data.objects.get(self.target)
        if target is None or target == mirror:
            self.report({"ERROR"}, f'"{self.target}" cannot be seen in {mirror.name}')
            return {"CANCELLED"}
        aim = bpy.data.objects.new(f"Aim {target.name}", None)
        mirror.users_collection[0].objects.link(aim)
        aim.parent, aim.matrix_parent_inverse = mirror, Matrix()
        aim.location = mirror.matrix_world.inverted_safe() @ Vector(self.point)
        aim.empty_display_type = "SPHERE"
        sizes = [max(c) - min(c) for c in zip(*mirror.bound_box)]
        aim["aim_target"] = target
        for name, says in (("aim_radius", "So far about the point the reflection is moved as a whole"),
                           ("aim_border", "So wide at least is the ring about it in which it fades")):
            aim[name] = 0.1 * max(sizes)
            aim.id_properties_ui(name).update(min=1e-4, soft_max=max(sizes), description=says)
        aim.empty_display_size = aim["aim_radius"]
        return {"FINISHED"}

    def invoke(self, context, _event):
        self.picked = False
        context.workspace.status_text_set(f"Click the point on {context.object.name}   (Esc ends)")
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        if event.type in {"ESC", "RIGHTMOUSE"}:
            context.workspace.status_text_set(None)
            return {"CANCELLED"}
        view = view_under(context, event)
        if event.type != "LEFTMOUSE" or event.value != "PRESS" or view is None:
            return {"PASS_THROUGH"}
        thing, place = thing_under(context, view)
        if not self.picked and thing == context.object and place is not None:
            self.picked, self.point = True, place
            context.workspace.status_text_set("Click what is to be seen there   (Esc ends)")
        elif self.picked and thing is not None and thing != context.object:
            context.workspace.status_text_set(None)
            self.target = thing.name
            return self.execute(context)
        return {"RUNNING_MODAL"}


class RENDER2MPEG_OT_forget_aim(bpy.types.Operator):
    bl_idname, bl_label = "render2mpeg.forget_aim", "Remove"
    bl_description = "Let this point mirror what it does by itself"
    bl_options = {"REGISTER", "UNDO"}
    aim: bpy.props.StringProperty()

    def execute(self, _context):
        aim = bpy.data.objects.get(self.aim)
        if aim is None or "aim_radius" not in aim.keys():
            return {"CANCELLED"}
        bpy.data.objects.remove(aim)
        return {"FINISHED"}


class Render2mpegSettings(bpy.types.PropertyGroup):
    output: bpy.props.StringProperty(name="Film", subtype="FILE_PATH", default="//film.mpg",
                                     description="The ending chooses the kind: .mp4, .mov and .mkv H.264; .mpg, .vob, .ts, .m2v MPEG-2")
    codec: bpy.props.EnumProperty(name="Codec", items=[
        ("ENDING", "By the Ending", "H.264 in .mp4, .mov and .mkv, else MPEG-2"),
        ("mpeg2", "MPEG-2", "DVDs and broadcasts"), ("h264", "H.264", "Plays everywhere"),
        ("hevc", "HEVC", "10 bits"), ("av1", "AV1", "10 bits, smallest")])
    control: bpy.props.EnumProperty(name="Rate", items=[
        ("QUANTISER", "Quantiser", "The same fineness throughout"),
        ("SIZE", "Size", "The finest film that is not larger"),
        ("QUALITY", "Quality", "The coarsest film of this quality")])
    quantiser: bpy.props.IntProperty(name="Quantiser", default=4, min=1, max=31, description="1: fine and large; 31: coarse and small")
    megabytes: bpy.props.FloatProperty(name="Megabytes", default=100, min=0.1)
    decibels: bpy.props.FloatProperty(name="PSNR", default=40, min=20, max=60, description="Of luma, in dB")
    percentage: bpy.props.IntProperty(name="Picture Size", default=100, min=5, max=400, subtype="PERCENTAGE",
                                      description="Of the scene's resolution")
    report: bpy.props.BoolProperty(name="Report", default=True, description="Write a page about the film beside it")
    open_film: bpy.props.BoolProperty(name="Open When Done", default=True)
    folder: bpy.props.StringProperty(name="Folder", subtype="DIR_PATH", default="//film-scene",
                                     description="For rendering elsewhere")


class Render2mpegPreferences(bpy.types.AddonPreferences):
    bl_idname = __name__
    program: bpy.props.StringProperty(name="Program", subtype="FILE_PATH", description="render2mpeg; empty: the one on the PATH")

    def draw(self, _context):
        self.layout.prop(self, "program")


class RENDER2MPEG_PT_panel(bpy.types.Panel):
    bl_label, bl_idname = "render2mpeg", "RENDER2MPEG_PT_panel"
    bl_space_type, bl_region_type, bl_context = "PROPERTIES", "WINDOW", "render"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        settings, layout = context.scene.render2mpeg, self.layout
        layout.use_property_split = True
        if program() is None:
            layout.label(text="render2mpeg is not installed", icon="ERROR")
        layout.prop(settings, "output")
        layout.prop(settings, "codec")
        layout.prop(settings, "control")
        layout.prop(settings, {"QUANTISER": "quantiser", "SIZE": "megabytes", "QUALITY": "decibels"}[settings.control])
        layout.prop(settings, "percentage")
        layout.prop(settings, "report")
        layout.prop(settings, "open_film")
        row = layout.row(align=True)
        row.operator("render2mpeg.film", text="Render Film", icon="RENDER_ANIMATION")
        row.operator("render2mpeg.cost")
        layout.prop(settings, "folder")
        layout.operator("render2mpeg.folder")


class RENDER2MPEG_PT_aims(bpy.types.Panel):
    bl_label, bl_idname = "Aimed Reflections (render2mpeg)", "RENDER2MPEG_PT_aims"
    bl_space_type, bl_region_type, bl_context = "PROPERTIES", "WINDOW", "object"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context):
        return RENDER2MPEG_OT_aim.poll(context)

    def draw(self, context):
        self.layout.operator("render2mpeg.aim", icon="EMPTY_SINGLE_ARROW")
        for aim in aims_of(context.object):
            box = self.layout.box()
            row = box.row()
            row.label(text=getattr(aim.get("aim_target"), "name", "no target"))
            row.operator("render2mpeg.forget_aim", text="", icon="X").aim = aim.name
            box.prop(aim, '["aim_radius"]', text="Radius")
            box.prop(aim, '["aim_border"]', text="Border")


def draw_aim(self, _context):
    self.layout.operator_context = "INVOKE_DEFAULT"
    self.layout.operator("render2mpeg.aim")


def draw_menu(self, _context):
    self.layout.operator("render2mpeg.film", icon="RENDER_ANIMATION")


CLASSES = (Render2mpegSettings, Render2mpegPreferences, RENDER2MPEG_OT_film, RENDER2MPEG_OT_cost, RENDER2MPEG_OT_folder,
           RENDER2MPEG_PT_panel, RENDER2MPEG_OT_aim, RENDER2MPEG_OT_forget_aim, RENDER2MPEG_PT_aims)


def register():
    for cls in CLASSES:
        bpy.utils.register_class(cls)
    bpy.types.Scene.render2mpeg = bpy.props.PointerProperty(type=Render2mpegSettings)
    bpy.types.TOPBAR_MT_render.append(draw_menu)
    bpy.types.VIEW3D_MT_object.append(draw_aim)


def unregister():
    bpy.types.VIEW3D_MT_object.remove(draw_aim)
    bpy.types.TOPBAR_MT_render.remove(draw_menu)
    del bpy.types.Scene.render2mpeg
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)


if __name__ == "__main__":
    register()
