# SPDX-License-Identifier: Apache-2.0 OR GPL-3.0-or-later
"""blender -b --factory-startup --disable-autoexec -noaudio -P export_film.py -- SCENE FOLDER TEXTURE_SIZE LINES LAST_FRAME

Writes what render2mpeg can show of a .blend, or of what Blender imports (USD, Alembic), to FOLDER: film.json (an animation
file), scene.glb and images beside it, and export.json: {"error": "..."} or {"blender", "lost": [...],
"uses": [[path, size, mtime in ns], ...]}, where `uses` names the other files that the scene was made of. Executes nothing
that a .blend holds.
"""
import itertools
import json
import math
import os
import re
import sys
import traceback

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
sys.dont_write_bytecode = True

import bpy  # noqa: E402

RATES = {"23.976": 24000 / 1001, "24": 24.0, "25": 25.0, "29.97": 30000 / 1001, "30": 30.0, "50": 50.0, "59.94": 60000 / 1001, "60": 60.0}

MOST_PIXELS = 16384  # along a side of a film's pictures


class Refused(Exception):
    """A scene that cannot be a film: the reason in one line."""


# Importers by endings: the format's name, Blender's library of it, which some builds (Debian's) lack, and the operator.
ALEMBIC, USD = ("Alembic", "alembic", "alembic_import"), ("USD", "usd", "usd_import")
IMPORTERS = {".abc": ALEMBIC, ".usd": USD, ".usda": USD, ".usdc": USD, ".usdz": USD}


def tell_step(folder, words):
    """The export's step, for who waits for it."""
    with open(os.path.join(folder, "step"), "w") as file:
        file.write(words + "\n")


def saved_by(path):
    """(major, minor) of the Blender that saved a .blend, by its first bytes, which compression mostly leaves as they are; else (0, 0)."""
    with open(path, "rb") as file:
        found = re.search(rb"BLENDER(?:[-_][vV](\d)|\d\d-\d\dv(\d\d))(\d\d)", file.read(64))
    return (int(found[1] or found[2]), int(found[3])) if found else (0, 0)


def is_newer(version):
    return tuple(version[:2]) > bpy.app.version[:2]


def too_new(version):
    return (f"it is of Blender {version[0]}.{version[1]}, which this Blender {bpy.app.version_string} cannot read: "
            "name a newer one in RENDER2MPEG_BLENDER")


def no_plain_file(path, kind):
    return f"it uses {path}, which is {kind}; plain files alone are read"


def open_blend(path):
    from film_export import files, libraries
    found = [libraries.unreadable(path)]
    if found[0]:
        raise Refused(no_plain_file(*found[0]))

    @bpy.app.handlers.persistent
    def look(*_):
        found.append(files.unreadable())
    # Blender evaluates the scene, and so reads its caches, after these handlers.
    bpy.app.handlers.load_post.append(look)
    try:
        bpy.ops.wm.open_mainfile(filepath=path, load_ui=False, use_scripts=False)
    except RuntimeError:
        version = saved_by(path)
        if not is_newer(version):
            raise
        raise Refused(too_new(version)) from None
    finally:
        bpy.app.handlers.load_post.remove(look)
    bad = next(filter(None, found), None)
    if bad:
        raise Refused(no_plain_file(*bad))
    if os.path.realpath(bpy.data.filepath) != os.path.realpath(path):
        raise Refused("Blender cannot read it")


def import_scene(path, name, library, operator):
    """Fills an empty file. The range of frames is the scene's own; a camera is active, if there is any."""
    if not getattr(bpy.app.build_options, library, False):
        raise Refused(f"{bpy.app.binary_path} ({bpy.app.version_string}) was built without {name}: "
                      "name another Blender in RENDER2MPEG_BLENDER (those of blender.org have it)")
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    done = getattr(bpy.ops.wm, operator)(filepath=path, set_frame_range=True)
    if "FINISHED" not in done or not bpy.data.objects:
        raise Refused("Blender found nothing in it")
    scene = bpy.context.scene
    if not scene.camera:
        scene.camera = next((thing for thing in scene.objects if thing.type == "CAMERA"), None)


def open_scene(path):
    importer = IMPORTERS.get(os.path.splitext(path)[1].lower())
    try:
        import_scene(path, *importer) if importer else open_blend(path)
    except RuntimeError as error:
        text = " ".join(str(error).split())
        raise Refused("Blender cannot read it: " + text.rsplit(": ", 1)[-1]) from None


def rate_of(scene, lost):
    """Frames per second of the .blend, and the film's rate by name."""
    own = scene.render.fps / scene.render.fps_base

    def distance(name):
        """To a multiple, where no frame of the .blend is left out, or to the rate itself."""
        rate = RATES[name]
        multiple = max(1, round(rate / own))
        return abs(math.log(rate / (own * multiple))) + 1e-3 * (multiple - 1)
    name = min(RATES, key=distance)
    if distance(name) > 1e-4:
        lost.add(scene, f"{own:g} frames per second; the film has {name}, at the same speed")
    return own, name


def format_of(scene, film, lost):
    render = scene.render
    width = max(1, render.resolution_x * render.resolution_percentage // 100)
    height = max(1, render.resolution_y * render.resolution_percentage // 100)
    if max(width, height) > MOST_PIXELS:
        lost.add(scene, f"pictures of {width}x{height} pixels; those of films have at most {MOST_PIXELS} along a side")
    shrink = min(1, MOST_PIXELS / max(width, height))
    film["size"] = [max(1, round(width * shrink)), max(1, round(height * shrink))]
    pixel = render.pixel_aspect_x / render.pixel_aspect_y
    if abs(pixel - 1) > 1e-4:
        shape = width / height * pixel
        shapes = {"4:3": 4 / 3, "16:9": 16 / 9, "2.21:1": 2.21}
        near = min(shapes, key=lambda name: abs(math.log(shapes[name] / shape)))
        film["display_aspect"] = near
        if abs(math.log(shapes[near] / shape)) > 0.03:
            lost.add(scene, f"a picture of {shape:.3f}:1 by pixels that are not square; MPEG-2's nearest shape is {near}")


def add_shutter(scene, film, lost):
    """How long frames are exposed, and when."""
    render, engine = scene.render, scene.cycles if scene.render.engine == "CYCLES" else scene.eevee
    # In the film's frames, which may be more than the .blend's.
    frames = render.motion_blur_shutter / max(1, scene.frame_step) * float(film["frame_rate"]) * render.fps_base / render.fps
    place = getattr(render, "motion_blur_position", None) or getattr(engine, "motion_blur_position", "CENTER")
    film["shutter"] = round(360 * min(frames, 1), 6)
    if frames > 1:
        lost.add(scene, f"a shutter of {frames:g} frames; it is open for one")
    if place != "CENTER":
        film["shutter_phase"] = round((0.5 if place == "START" else -0.5) * min(frames, 1), 6)
    if getattr(engine, "rolling_shutter_type", "NONE") != "NONE":
        # Each row is open for a share of the whole, from the first row's opening to the last one's closing.
        share = max(engine.rolling_shutter_duration, 0.01)
        film["shutter"] = round(share * film["shutter"], 6)
        film["rolling_shutter"] = round((1 - share) * min(frames, 1), 6)
    if render.engine == "CYCLES" and len(render.motion_blur_shutter_curve.curves) and any(
            abs(p.location[1] - 1) > 1e-3 for p in render.motion_blur_shutter_curve.curves[0].points):
        lost.add(scene, "curve of the shutter; it opens and closes at once")


def strips_of(editor):
    """All strips of the sequencer, by Blender 4.4's name or the older one."""
    return editor.strips_all if hasattr(editor, "strips_all") else editor.sequences_all


def look_of_film(scene, film, lost):
    """Exposure and view, and what of the film's look is not kept."""
    from film_export.view import view_of
    view, render = scene.view_settings, scene.render
    exposure = view.exposure
    film_exposure = getattr(getattr(scene, "cycles", None), "film_exposure", 1.0)
    if not render.engine.startswith(("BLENDER_EEVEE", "BLENDER_WORKBENCH")):
        exposure += math.log2(max(film_exposure, 1e-6))
    elif abs(film_exposure - 1) > 1e-4:
        lost.add(scene, f"film exposure {film_exposure:g} of Cycles, which its own renderer, {render.engine}, has not; not used")
    film["exposure"] = round(min(max(exposure, -50), 50), 6)
    name, gamma = view_of(scene, lambda text: lost.add(scene, text))
    film["view"] = {"name": name, "gamma": round(gamma, 6)} if abs(gamma - 1) > 1e-4 else name
    if render.use_motion_blur:
        add_shutter(scene, film, lost)
    for is_on, what in ((render.use_freestyle, "lines of Freestyle"), (render.use_stamp, "metadata burnt into pictures")):
        if is_on:
            lost.add(scene, what)
    if render.use_border:
        lost.add(scene, "render region; the whole picture is rendered")
    if render.film_transparent:
        film["transparent"] = True
    if render.use_sequencer and scene.sequence_editor and any(s.type != "SOUND" for s in strips_of(scene.sequence_editor)):
        lost.add(scene, "strips of the video sequencer")
    # A group of its own from Blender 5 on, which always uses nodes.
    compositing = scene.compositing_node_group if hasattr(scene, "compositing_node_group") else scene.use_nodes and scene.node_tree
    if render.use_compositing and compositing and len(compositing.nodes) > 2:
        lost.add(scene, "compositing nodes")


def scripts_in(lost):
    """Drivers whose Python was not run."""
    things = list(bpy.data.objects) + list(bpy.data.materials) + list(bpy.data.lights) + list(bpy.data.cameras)
    things += [k for k in bpy.data.shape_keys] + [m.node_tree for m in bpy.data.materials if m.node_tree]
    for thing in things:
        animation = getattr(thing, "animation_data", None)
        for driver in animation.drivers if animation else ():
            if driver.driver.type == "SCRIPTED" and not driver.driver.is_simple_expression:
                lost.add(thing, f"driver of {driver.data_path}: its Python expression is not executed")
    for image in bpy.data.images:
        if image.source in {"MOVIE", "SEQUENCE"} and image.users:
            lost.add(image, "moving image; as on the first frame")
    for text in bpy.data.texts:
        if text.use_module:
            lost.add(text, "text that registers itself: not executed")


def mix_sound(scene, film, folder, lost):
    """The sequencer's and the speakers' sound as one file."""
    editor = scene.sequence_editor
    heard = bool(editor) and any(s.type == "SOUND" and not s.mute for s in strips_of(editor))
    heard = heard or any(thing.type == "SPEAKER" and thing.data.sound and not thing.data.muted for thing in scene.objects)
    if not heard:
        return
    try:
        bpy.ops.sound.mixdown(filepath=os.path.join(folder, "sound.wav"), check_existing=False, container="WAV", codec="PCM", format="S16")
        film["sound"] = "sound.wav"
    except RuntimeError as error:
        lost.add(scene, f"sound ({' '.join(str(error).split())})")


def other_things(scene, lost):
    for thing in scene.objects:
        if thing.hide_render:
            continue
        for system in thing.particle_systems:
            settings = system.settings
            if system.settings.count == 0:
                continue
            if settings.render_type in {"HALO", "LINE", "PATH"} and settings.type == "EMITTER":
                lost.add(thing, f"particles {system.name} shown as {settings.render_type.lower()}")
        if thing.type not in {"MESH", "CURVE", "SURFACE", "FONT", "META"}:
            continue
        if thing.is_shadow_catcher:
            lost.add(thing, "shadow catcher")


def holes_in(scene):
    """Names of objects that are holes in the picture, by themselves or by their collection."""
    names = {thing.name_full for thing in scene.objects if thing.is_holdout}
    pending = [(scene.view_layers[0].layer_collection, False)]
    while pending:
        layer, hole = pending.pop()
        hole = hole or layer.holdout
        names.update(thing.name_full for thing in layer.collection.objects if hole)
        pending += [(child, hole) for child in layer.children]
    return names


def write_nodes(glb, walk, materials, volumes, times, film, lost):
    """Every object and instance as a node of its own below one that turns Blender's z up to the film's y. Returns the
    names of the nodes that have objects' shapes."""
    import numpy as np
    from mathutils import Matrix
    from film_export.cameras import TO_FILM
    from film_export.hair import Strands, add_strands
    from film_export.keys import json_number, thinned
    from film_export.shapes import add_mesh
    from film_export.visibility import Visibility

    visibility = Visibility(walk.scene, lost)
    meshes, names, numbers, change, shaped, holes = {}, set(), {}, {}, {}, holes_in(walk.scene)
    for key, thing in walk.things.items():
        if thing.kind == "LIGHT":
            continue
        over = walk.shapes.get(thing.shape)
        filled = thing.kind == "VOLUME" or volumes.is_volume_alone(over)
        if not filled and thing.shape not in meshes:
            offsets, weights = over.bending.result() if over.bending else ([], None)
            closed = over.shape.is_closed()

            def slot(number, over=over, closed=closed):
                material = over.materials[min(number, len(over.materials) - 1)] if over.materials else None
                index, layers = materials.index(material, over.mesh_name, over.object_name, closed, over.shape)
                return index, [over.shape.main_uv if layer is None else layer for layer in layers]
            add = add_strands if isinstance(over.shape, Strands) else add_mesh
            meshes[thing.shape] = (add(glb, over.object_name, over.shape, offsets, slot), weights)
        mesh, weights = (None, None) if filled else meshes[thing.shape]
        if mesh is None and not filled:
            continue
        name, number = thing.name, numbers.get(thing.name, 1)
        while name in names:
            number += 1
            name = f"{thing.name} {number}"
        numbers[thing.name] = number
        names.add(name)
        node = glb.node({"name": name} if filled else {"name": name, "mesh": mesh})
        if weights is not None and weights.shape[1]:
            needed = thinned(times, weights, 1e-4)
            glb.document["nodes"][node]["weights"] = [float(w) for w in weights[needed[0]]]
            if len(needed) > 1:
                glb.channel(node, "weights", [times[k] for k in needed], weights[needed].ravel())
        place_node(glb, node, thing, times, Matrix, TO_FILM, np, thinned, lost)
        if filled:
            volumes.add(glb.document["nodes"][-1]["name"], thing, over)
            continue
        if key[0] == "object":
            shaped[key[1]] = name if "mesh" in glb.document["nodes"][node] else name + " (shape)"
        shown = [m is not None for m in thing.matrices]
        if not all(shown):
            keys = [{"at": json_number(times[k]), "visible": shown[k]} for k in range(len(shown)) if k == 0 or shown[k] != shown[k - 1]]
            change[name] = {"keys": keys}
        if key[-1 if key[0] == "object" else 2] in holes:
            change.setdefault(name, {})["material"] = {"holdout": True}
        visibility.write(key, change.setdefault(name, {}))
    change = {name: says for name, says in change.items() if says}
    if change:
        film["change"] = change
    return shaped


def place_node(glb, node, thing, times, Matrix, TO_FILM, np, thinned, lost):
    present = [k for k, m in enumerate(thing.matrices) if m is not None]
    rests = all(thing.matrices[k] is thing.matrices[present[0]] for k in present)
    matrices = np.array([TO_FILM @ thing.matrices[k] for k in (present[:1] if rests else present)])
    says = glb.document["nodes"][node]
    if np.max(np.ptp(matrices, axis=0)) < 1e-6:
        says["matrix"] = [float(v) for v in matrices[0].T.ravel()]
        return
    parts = [Matrix(m.tolist()).decompose() for m in matrices]
    for m, (place, turn, scale) in zip(matrices, parts):
        if np.max(np.abs(np.array(Matrix.LocRotScale(place, turn, scale)) - m)) > 1e-4 * (1 + np.max(np.abs(m[:3, :3]))):
            place_sheared(glb, node, [times[k] for k in present], matrices, Matrix, np)
            return
    at = [times[k] for k in present]
    turns = np.array([[q.x, q.y, q.z, q.w] for _, q, _ in parts])
    for k in range(1, len(turns)):
        if turns[k] @ turns[k - 1] < 0:
            turns[k] = -turns[k]
    rows = {"translation": np.array([list(p) for p, _, _ in parts]), "rotation": turns, "scale": np.array([list(s) for _, _, s in parts])}
    for path, values in rows.items():
        needed = thinned(at, values, 2e-6 * max(1.0, float(np.max(np.abs(values)))))
        says[path] = [float(v) for v in values[needed[0]]]
        if len(needed) > 1:
            glb.channel(node, path, [at[k] for k in needed], values[needed])


def place_sheared(glb, node, at, matrices, Matrix, np):
    """What its parents shear while it moves: a turn and a scale above another turn, right on every frame, with steps
    between them."""
    says = glb.document["nodes"][node]
    child = glb.node({"name": says["name"] + " (shape)"}, parent=node)
    if "mesh" in says:
        glb.document["nodes"][child]["mesh"] = says.pop("mesh")
    if "weights" in says:
        glb.document["nodes"][child]["weights"] = says.pop("weights")
    for channel in glb.channels:
        if channel["target"]["node"] == node:
            channel["target"]["node"] = child
    rows = {"translation": [], "rotation": [], "scale": []}, {"rotation": []}
    for m in matrices:
        outer, scale, inner = np.linalg.svd(m[:3, :3])
        if np.linalg.det(inner) < 0:
            inner, scale = -inner, -scale
        if np.linalg.det(outer) < 0:
            outer, scale = -outer, -scale
        rows[0]["translation"].append(m[:3, 3])
        rows[0]["scale"].append(scale)
        for turn, into in ((outer, rows[0]), (inner, rows[1])):
            q = Matrix(turn.tolist()).to_quaternion()
            into["rotation"].append([q.x, q.y, q.z, q.w])
    for target, quantities in zip((node, child), rows):
        for path, values in quantities.items():
            glb.channel(target, path, at, values, "STEP")


class Strengths:
    """How the strength of emissions changes."""

    def __init__(self, materials):
        self.materials, self.rows = materials, []

    def watch(self, number, depsgraph):
        row = {}
        for look_name, (look, _) in self.materials.looks.items():
            material = bpy.data.materials.get(look_name)
            if not look.animated or material is None or material.node_tree is None or material.node_tree.animation_data is None:
                continue
            tree = material.evaluated_get(depsgraph).node_tree
            node = tree.nodes.get(look.animated[0])
            if node is not None and look.animated[1] in node.inputs:
                row[look_name] = float(node.inputs[look.animated[1]].default_value)
        self.rows.append(row)

    def write(self, film, times):
        from film_export.keys import json_number, thinned
        for name, (material, _, _, first) in self.materials.strengths.items():
            values = [row.get(material.name_full) for row in self.rows]
            if None in values:
                continue
            needed = thinned(times, [[v] for v in values], 1e-5 * max(max(values), 1e-9))
            if len(needed) > 1:
                keys = [{"at": json_number(times[k]), "power": json_number(max(values[k], 0) / first)} for k in needed]
                film.setdefault("materials", {})[name] = {"keys": keys, "interpolation": "linear"}


def export(path, folder, texture_size, lines, last=-1, still=False):
    """Textures of a texel a pixel in pictures of this height, 0: the scene's own. `last`: frame of the film after which nothing is
    wanted, or -1. `still`: the frame that it was saved at alone."""
    open_scene(path)
    from film_export import lamps, limits, world
    from film_export.bakes import Bakes
    from film_export.baking import Baker
    from film_export.cameras import Cameras, chapters
    from film_export.fields import Voxels
    from film_export.files import tell_missing
    from film_export.glb import Glb
    from film_export.lost import Lost
    from film_export.materials import Materials
    from film_export.reflections import Reflections
    from film_export.volumes import Volumes
    from film_export.walk import Walk

    scene, lost, glb = bpy.context.scene, Lost(), Glb()
    if still:
        scene.frame_start = scene.frame_end = scene.frame_current
    own_rate, rate = rate_of(scene, lost)
    frames = list(range(scene.frame_start, scene.frame_end + 1, max(1, scene.frame_step)))
    times = [k / own_rate for k in range(len(frames))]
    # Blender bends light at every glass; open meshes are thin.
    film = {"title": os.path.basename(path), "scene": "scene.glb", "closed_glass_is_solid": True, "frame_rate": rate,
            "frames": max(1, round(len(frames) / own_rate * RATES[rate]))}
    if last >= 0:  # a frame more, for what moves while it is exposed
        frames = frames[:math.ceil(last / RATES[rate] * own_rate - 1e-6) + 2]
        times = times[:len(frames)]
    marks = chapters(scene, frames, times)
    if marks:
        film["chapters"] = marks
    format_of(scene, film, lost)
    look_of_film(scene, film, lost)
    if is_newer(bpy.data.version):
        lost.add(os.path.basename(path), f"what Blender {bpy.data.version[0]}.{bpy.data.version[1]}, which saved it, has and this one, {bpy.app.version_string}, has not")
    scripts_in(lost)
    other_things(scene, lost)
    tell_missing(lost)

    mix_sound(scene, film, folder, lost)
    scene.frame_set(frames[0])
    baker = Baker(texture_size)
    materials = Materials(glb, folder, baker, lost)
    lines = lines or scene.render.resolution_y * scene.render.resolution_percentage / 100
    bakes = Bakes(materials, baker, lines, lost)
    for thing in list(bpy.data.objects):
        if thing.type == "MESH" and (scene in thing.users_scene or not thing.users_scene):
            bakes.prepare(thing)
    tell_step(folder, "light of the world")
    world.write(scene, film, folder, lost)
    far = world.hides_what_is_far(scene, film)
    window = bpy.context.window_manager.windows[0]
    window.scene = scene

    cameras, strengths, reflections = Cameras(scene, frames, times, lost), Strengths(materials), Reflections(scene, times, lost)
    voxels = Voxels(baker, cameras, lines, lambda words: tell_step(folder, words))
    volumes = Volumes(scene, frames, own_rate, RATES[film["frame_rate"]], film, folder, materials, voxels, lost)

    def watch(number, depsgraph):
        tell_step(folder, f"frame {number + 1} of {len(frames)}")
        cameras.watch(number, depsgraph)
        strengths.watch(number, depsgraph)
        reflections.watch(number, depsgraph)
        volumes.watch(number, depsgraph)
    walk = Walk(scene, frames, watch, lost)
    walk.run()
    bakes.run(walk, cameras, lambda words: tell_step(folder, words))
    window.scene = scene
    reflections.write(film, write_nodes(glb, walk, materials, volumes, times, film, lost))
    cameras.write(film)
    lights = [lamps.described(thing, times, lost) for thing in walk.things.values()
              if thing.kind == "LIGHT" and not (far and thing.light.type == "SUN")]
    if any(lights):
        film["lights"] = film.get("lights", []) + [light for light in lights if light]
    limits.tell(scene, walk, materials, film, lost)
    strengths.write(film, times)
    for name in materials.holes:
        film.setdefault("materials", {}).setdefault(name, {})["holdout"] = True
    materials.write_more(film)
    glb.save(os.path.join(folder, "scene.glb"))
    with open(os.path.join(folder, "film.json"), "w") as file:
        json.dump(film, file, indent=1)
    return {"blender": bpy.app.version_string, "lost": lost.lines, "uses": used_files(path, volumes.uses)}


def used_files(path, more):
    """Other files that decided the export, as they are now. Of USD's layers all that could be are, among ten
    thousand files beside it and below."""
    names, out = set(bpy.utils.blend_paths(absolute=True, packed=False, local=False)) | set(more), []
    if IMPORTERS.get(os.path.splitext(path)[1].lower()) is USD:
        below = (os.path.join(folder, name) for folder, _, files in os.walk(os.path.dirname(path)) for name in files)
        names |= {name for name in itertools.islice(below, 10000) if IMPORTERS.get(os.path.splitext(name)[1].lower()) is USD}
    for name in sorted(names):
        if os.path.realpath(name) != os.path.realpath(path) and os.path.isfile(name):
            state = os.stat(name)
            out.append([os.path.abspath(name), state.st_size, state.st_mtime_ns])
    return out


def told(path, folder, texture_size, lines=0, last=-1, still=False):
    """The export's outcome, or what went wrong in one line."""
    try:
        result = export(path, folder, texture_size, lines, last, still)
    except Refused as reason:
        result = {"error": str(reason)}
    except ModuleNotFoundError as missing:
        result = {"error": f"Blender's Python lacks {missing.name}: install it (Debian's package is python3-{missing.name})"}
    except Exception as trouble:  # one line for the user, the rest for whoever mends this script
        traceback.print_exc()
        last = traceback.extract_tb(trouble.__traceback__)[-1]
        result = {"error": f"its export failed ({type(trouble).__name__}: {' '.join(str(trouble).split())}, "
                           f"{os.path.basename(last.filename)}:{last.lineno})"}
    return result


def main():
    path, folder, texture_size, lines, last = sys.argv[sys.argv.index("--") + 1:]
    def write(result):
        with open(os.path.join(folder, "export.json"), "w") as file:
            json.dump(result, file, indent=1)
    version = saved_by(path)
    if is_newer(version):
        write({"error": too_new(version)})  # which stays where Blender crashes on it
    write(told(path, folder, int(texture_size), int(lines), int(last)))


if __name__ == "__main__":
    main()
