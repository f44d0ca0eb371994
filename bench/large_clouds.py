#!/usr/bin/python3
"""large_clouds.py SIDE FRAMES FOLDER

Writes a film of a cloud that turns into another: FRAMES grids of SIDE^3 voxels, a quarter of them dense, in a box 2 wide. What rendering
them takes is in docs/model/volumes.md. Needs Debian's python3-openvdb and python3-numpy.
"""
import json
import pathlib
import sys

import numpy as np
import pyopenvdb as vdb


def noise(side, seed):
    """Four octaves of random values, linear in between."""
    dice, total = np.random.default_rng(seed), 0
    for octave in range(4):
        cells = 4 * 2**octave
        values = dice.standard_normal((cells + 1,) * 3).astype(np.float32)
        at = np.linspace(0, cells, side, endpoint=False)
        low, t = at.astype(int), (at % 1).astype(np.float32)
        for axis in range(3):
            part = t.reshape([-1 if k == axis else 1 for k in range(3)])
            values = np.take(values, low, axis) * (1 - part) + np.take(values, low + 1, axis) * part
        total = total + 0.5**octave * values
    return total


def write(density, path):
    grid, voxel = vdb.FloatGrid(), 2 / len(density)
    grid.copyFromArray(density)
    grid.pruneInactive()
    grid.name, grid.gridClass, grid.saveFloatAsHalf = "density", vdb.GridClass.FOG_VOLUME, True
    grid.transform = vdb.createLinearTransform([[voxel, 0, 0, 0], [0, voxel, 0, 0], [0, 0, voxel, 0], [-1, -1, 0, 1]])
    vdb.write(str(path), grids=[grid])


if __name__ == "__main__":
    if len(sys.argv) != 4: sys.exit(__doc__)
    side, frames, folder = int(sys.argv[1]), int(sys.argv[2]), pathlib.Path(sys.argv[3])
    folder.mkdir(parents=True, exist_ok=True)
    first, last = noise(side, 1), noise(side, 2)
    for frame in range(frames):
        turn = frame / max(frames - 1, 1) * np.pi / 2
        density = np.cos(turn) * first + np.sin(turn) * last
        density -= np.quantile(density, 0.75)
        write(np.where(density > 0, np.minimum(density + 0.05, 2), 0).astype(np.float32), folder / f"cloud_{frame:04d}.vdb")
    (folder / "film.json").write_text(json.dumps({
        "size": [160, 90], "frame_rate": 24, "frames": frames, "sky": {"zenith": [0.25, 0.45, 0.9], "horizon": [0.7, 0.8, 0.95]},
        "camera": {"fov": 40, "position": [0.6, 1.25, 4.6], "look_at": [0, 1, 0]},
        "lights": [{"kind": "sun", "elevation": 35, "azimuth": -72, "angle": 0.53, "intensity": 5}],
        "volumes": [{"file": "cloud_%04d.vdb", "frames": [0, frames - 1], "density": 6, "color": 0.9, "rotate": [-90, 0, 0], "position": [0, 0.1, 0]}],
        "objects": [{"shape": "plane", "size": [7, 7]}]}))
