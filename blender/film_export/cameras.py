# SPDX-License-Identifier: Apache-2.0 OR GPL-3.0-or-later
"""Cameras with all that moves them, and the cuts between them."""
import math

import bpy
import numpy as np

from .keys import json_number, thinned, turns, unwound

# Blender's z is up, the film's y.
TO_FILM = np.array([[1, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1]], dtype=float)


def rotation_of(matrix):
    """The turn in a matrix of rows, without its scales."""
    from mathutils import Matrix
    return Matrix(matrix.tolist()).to_quaternion().to_matrix()


def cuts(scene, frames):
    """(number of the frame, camera) from where on it is shown; markers that hold cameras cut."""
    marks = sorted(((m.frame, m.camera) for m in scene.timeline_markers if m.camera), key=lambda m: m[0])
    out = []
    for number, frame in enumerate(frames):
        before = [camera for at, camera in marks if at <= frame]
        camera = before[-1] if before else marks[0][1] if marks else scene.camera
        if not out or out[-1][1] != camera:
            out.append((number, camera))
    return out


def chapters(scene, frames, times):
    """The animation file's, of markers that hold no camera; one before the film counts from its beginning."""
    named = {}
    for mark in sorted((m for m in scene.timeline_markers if not m.camera), key=lambda m: m.frame):
        number = next((k for k, frame in enumerate(frames) if frame >= mark.frame), None)
        if number is not None:
            named[number] = mark.name
    return [{"at": json_number(times[number]), "title": name} for number, name in named.items()]


def panorama_of(data):
    """What Cycles knows of a panoramic camera."""
    return data if hasattr(data, "panorama_type") else data.cycles  # Blender 5 | before


def is_panorama(camera):
    """Whether it has a panorama that the film can have."""
    if camera.data.type != "PANO" or panorama_of(camera.data).panorama_type != "EQUIRECTANGULAR":
        return False
    return all(low < high for low, high in window_of(camera))


def window_of(camera):
    """Longitudes and latitudes that a panorama shows, in degrees."""
    seen = panorama_of(camera.data)
    return [[round(math.degrees(getattr(seen, f"{name}_{end}")), 4) for end in ("min", "max")] for name in ("longitude", "latitude")]


PACKINGS = {"SIDEBYSIDE": "side-by-side", "TOPBOTTOM": "top-bottom"}


def packing_of(scene, lost):
    """How pictures hold both eyes'; None: they are for one eye."""
    render = scene.render
    if not render.use_multiview:
        return None
    if render.views_format != "STEREO_3D":
        lost.add(scene, "views by other cameras; the camera's own is rendered")
        return None
    if not all(render.views[name].use for name in ("left", "right") if name in render.views):
        lost.add(scene, "a view that is switched off; both eyes' are rendered")
    settings = render.image_settings
    if settings.views_format != "STEREO_3D":
        return "side-by-side"  # Blender would write two files
    kind = settings.stereo_3d_format
    if kind.display_mode not in PACKINGS:
        lost.add(scene, f"both eyes' pictures as {kind.display_mode.lower()}; they lie side by side")
    if kind.use_squeezed_frame and kind.display_mode in PACKINGS:
        lost.add(scene, "squeezed pictures of eyes; they have their whole size")
    if kind.use_sidebyside_crosseyed and kind.display_mode == "SIDEBYSIDE":
        lost.add(scene, "eyes that are crossed; the left one's picture comes first")
    return PACKINGS.get(kind.display_mode, "side-by-side")


def eyes_of(data):
    """Where a camera's eyes are, as the film says it."""
    stereo = data.stereo
    merges = stereo.use_pole_merge and stereo.pole_merge_angle_to > 0
    low, high = sorted(math.degrees(a) for a in (stereo.pole_merge_angle_from, stereo.pole_merge_angle_to))
    return {"interocular_distance": json_number(stereo.interocular_distance),
            "convergence_distance": json_number(stereo.convergence_distance),
            "convergence": {"OFFAXIS": "off-axis", "PARALLEL": "parallel", "TOE": "toe-in"}[stereo.convergence_mode],
            "pivot": stereo.pivot.lower(), "spherical": stereo.use_spherical_stereo,
            "pole_merge": [json_number(low), json_number(max(high, 0.01))] if merges else "off"}


class Cameras:
    def __init__(self, scene, frames, times, lost):
        self.scene, self.times, self.lost = scene, times, lost
        self.packing = packing_of(scene, lost)
        self.cuts = cuts(scene, frames)
        self.shown = []
        for _, camera in self.cuts:
            if camera is not None and camera not in self.shown:
                self.shown.append(camera)
        self.poses = {camera.name_full: [] for camera in self.shown}

    def watch(self, number, depsgraph):
        render = self.scene.render
        for camera in self.shown:
            now = camera.evaluated_get(depsgraph)
            matrix = TO_FILM @ np.array(now.matrix_world, dtype=float)
            lens = np.array(now.calc_matrix_camera(depsgraph, x=render.resolution_x, y=render.resolution_y,
                                                   scale_x=render.pixel_aspect_x, scale_y=render.pixel_aspect_y))
            if is_panorama(now):  # as large as a pixel is in its middle
                lens[[0, 1], [0, 1]] = [2 / math.radians(high - low) for low, high in window_of(now)]
            data = now.data
            focus = data.dof
            distance = focus.focus_distance
            if focus.focus_object:
                there = focus.focus_object.evaluated_get(depsgraph).matrix_world.translation
                away = there - now.matrix_world.translation
                distance = abs(away.dot(now.matrix_world.to_3x3().col[2].normalized()))
            self.poses[camera.name_full].append({
                "position": matrix[:3, 3], "eye": np.array(now.matrix_world.translation, dtype=float), "rotate": turns(rotation_of(matrix)), "lens": lens, "clip": (data.clip_start, data.clip_end), "window": window_of(now) if is_panorama(now) else None,
                "eyes": eyes_of(data) if self.packing else None,
                "f": focus.aperture_fstop if focus.use_dof else None, "focus": distance})

    def tell_losses(self, camera, poses):
        data = camera.data
        if data.type == "PANO" and not is_panorama(camera):
            kind = panorama_of(data).panorama_type.lower().replace("_", " ")
            self.lost.add(camera, f"panoramic lens ({kind}), which films do not have; shown as a perspective one")
        first = poses[0]
        if is_panorama(camera) and any(p["window"] != first["window"] for p in poses):
            self.lost.add(camera, "animated angles of a panorama; as on the first frame")
        if any(p["eyes"] != first["eyes"] for p in poses):
            self.lost.add(camera, "animated stereoscopy; as on the first frame")
        if self.packing and data.type == "ORTHO":
            self.lost.add(self.scene, "stereoscopy of a parallel projection, which has no depth; the camera's own view is rendered")
            self.packing = None
        if self.packing and data.type != "PANO" and data.stereo.use_spherical_stereo:
            self.lost.add(camera, "spherical stereo of a flat picture; its eyes look from their two places")
        if np.max(np.ptp([self.shift_of(camera, p) for p in poses], axis=0)) > 1e-4:
            self.lost.add(camera, "animated lens shift; as on the first frame")
        if any(pose["clip"] != first["clip"] for pose in poses):
            self.lost.add(camera, "animated clip start or end; as on the first frame")
        if first["f"] is not None and not self.opens_wide(camera, first):
            self.lost.add(camera, f"depth of field (f/{first['f']:.3g}, focus at {first['focus']:.3g} m)")
        if data.type == "ORTHO" and any(abs(p["lens"][1, 1] / first["lens"][1, 1] - 1) > 1e-4 for p in poses):
            self.lost.add(camera, "animated scale of a parallel projection; as on the first frame")

    @staticmethod
    def opens_wide(camera, pose):
        """Whether its lens is one that the film can have."""
        return camera.data.type != "PANO" and 0.01 <= pose["f"] <= 1000 and pose["focus"] > 1e-6

    def add_aperture(self, camera, first, says):
        """What is out of focus. The film's focal length is that of a sensor as high as the picture."""
        dof = camera.data.dof
        size = 1000 if camera.data.type == "ORTHO" else 2 * camera.data.lens / first["lens"][1, 1]
        says["sensor_height"] = json_number(min(max(size, 0.1), 1000))
        if dof.aperture_blades >= 3:
            says["blades"] = dof.aperture_blades
            says["blade_rotation"] = json_number(math.degrees(dof.aperture_rotation))
        if abs(dof.aperture_ratio - 1) > 1e-4:
            says["squeeze"] = json_number(min(max(dof.aperture_ratio, 0.1), 10))

    def shift_of(self, camera, pose):
        """How far the picture is moved to the right and up, in its heights. The projection's matrix says it in halves of
        the picture's sides."""
        lens = pose["lens"]
        right, up = lens[:2, 2] if camera.data.type != "ORTHO" else -lens[:2, 3]
        return right * lens[1, 1] / lens[0, 0] / 2, up / 2

    def described(self, camera):
        poses = self.poses[camera.name_full]
        self.tell_losses(camera, poses)
        says = {"interpolation": "linear"}
        near, far = poses[0]["clip"]
        if near > 0:
            says["near"] = json_number(near)
        if far > near:
            says["far"] = json_number(far)
        shift = np.zeros(2) if is_panorama(camera) else self.shift_of(camera, poses[0])
        if np.max(np.abs(shift)) > 1e-6:
            says["shift"] = [json_number(s) for s in shift]
        quantities = {"position": ([p["position"] for p in poses], 1e-5), "rotate": (unwound([p["rotate"] for p in poses]), 1e-3)}
        if self.packing:
            says["stereo"] = poses[0]["eyes"]
        if is_panorama(camera):
            says["projection"], (says["longitudes"], says["latitudes"]) = "equirectangular", poses[0]["window"]
        elif camera.data.type == "ORTHO":
            says["height"] = json_number(2 / poses[0]["lens"][1, 1])
        else:
            fov = [[math.degrees(2 * math.atan(1 / p["lens"][1, 1]))] for p in poses]
            quantities["fov"] = (fov, 1e-4)
        if poses[0]["f"] is not None and self.opens_wide(camera, poses[0]):
            self.add_aperture(camera, poses[0], says)
            stops = [min(max(p["f"] or 1000, 0.01), 1000) for p in poses]
            distances = [min(max(p["focus"], 1e-6), 1e9) for p in poses]
            quantities["f_stop"] = ([[s] for s in stops], 1e-3)
            quantities["focus"] = ([[d] for d in distances], 1e-4)
        keys = {}
        for name, (values, tolerance) in quantities.items():
            needed = thinned(self.times, values, tolerance)
            for k in needed:
                value = [json_number(v) for v in values[k]]
                value = value[0] if name in ("fov", "f_stop", "focus") else value
                if len(needed) == 1:
                    says[name] = value
                else:
                    keys.setdefault(k, {"at": json_number(self.times[k])})[name] = value
        if keys:
            says["keys"] = [keys[k] for k in sorted(keys)]
        return says

    def write(self, film):
        """Their part of the animation file."""
        if not self.shown:
            self.lost.add(self.scene, "has no camera; the film gets one that shows all of it")
            return
        names = {camera.name_full: camera.name if camera.library is None else camera.name_full for camera in self.shown}
        film["cameras"] = {names[c.name_full]: self.described(c) for c in self.shown}
        if self.packing:
            film["stereo"] = self.packing
        shots = [(number, camera) for number, camera in self.cuts if camera is not None]
        if len(shots) > 1:
            film["shots"] = [{"at": json_number(self.times[n]), "camera": names[c.name_full]} for n, c in shots]
