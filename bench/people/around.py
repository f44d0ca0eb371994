"""`blender FILM.blend --python around.py -- OUT.blend`: a film of this folder all around and for both eyes, from where its camera goes,
which then looks straight ahead. Pictures of eyes are twice as wide as high, the left one's above."""
import math
import os
import sys

import bpy

scene = bpy.context.scene
camera = scene.camera
scene.frame_set(scene.frame_start)
ahead = camera.matrix_world.to_euler().z
camera.constraints.clear()
camera.rotation_euler = math.pi / 2, 0, ahead
data = camera.data
data.dof.use_dof = False
data.type = "PANO"
seen = data if hasattr(data, "panorama_type") else data.cycles  # Blender 5's, and before
seen.panorama_type = "EQUIRECTANGULAR"
seen.longitude_min, seen.longitude_max, seen.latitude_min, seen.latitude_max = -math.pi, math.pi, -math.pi / 2, math.pi / 2
data.stereo.use_spherical_stereo = data.stereo.use_pole_merge = True
render = scene.render
render.resolution_x, render.resolution_y = 1024, 512
render.use_multiview, render.views_format = True, "STEREO_3D"
render.image_settings.views_format = "STEREO_3D"
render.image_settings.stereo_3d_format.display_mode = "TOPBOTTOM"
bpy.ops.wm.save_as_mainfile(filepath=os.path.abspath(sys.argv[sys.argv.index("--") + 1]))
