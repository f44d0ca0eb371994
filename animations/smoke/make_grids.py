#!/usr/bin/python3
"""Writes smoke_0000.vdb to smoke_0047.vdb beside it: density in 32^3 voxels of a column of puffs that rise, swirl and grow. Needs Debian's
python3-openvdb and python3-numpy."""
import os

import numpy as np
import pyopenvdb as vdb

FRAMES, RATE, SIDE, VOXEL = 48, 24, 32, 1 / 16  # the box is 2 units wide and high
PUFFS_A_SECOND, LIFE = 9, 3.2                    # seconds
FOLDER = os.path.dirname(os.path.abspath(__file__))


def puffs(time):
    """(middle, radius, amount) of each that is alive; the first began before the film."""
    first, last = int(np.ceil((time - LIFE) * PUFFS_A_SECOND)), int(np.floor(time * PUFFS_A_SECOND))
    for number in range(first, last + 1):
        age = time - number / PUFFS_A_SECOND
        random = np.random.default_rng(1000 + number)
        turn, speed = 2 * np.pi * random.random(), random.uniform(0.52, 0.66)
        height = 0.08 + speed * age
        swirl = 0.05 + 0.12 * age
        x = swirl * np.cos(turn + 1.7 * age) + 0.10 * np.sin(2.1 * height + 0.9 * time)
        y = swirl * np.sin(turn + 1.7 * age) + 0.08 * np.cos(1.7 * height)
        yield np.array([x, y, height]), 0.07 + 0.075 * age, min(6 * age, 1) * max(1 - age / LIFE, 0) ** 1.5


def density(time):
    """Blender's axes: z is up, index order x, y, z."""
    out = np.zeros((SIDE, SIDE, SIDE))
    along = (np.arange(SIDE) + 0.5) * VOXEL
    axes = along - 1, along - 1, along
    for middle, radius, amount in puffs(time):
        falls = [np.maximum(1 - ((axis - m) / (2 * radius)) ** 2, 0) ** 4 for axis, m in zip(axes, middle)]
        out += amount * falls[0][:, None, None] * falls[1][None, :, None] * falls[2][None, None, :]
    # Steps of 1/128 are not seen, and pack well.
    return np.round(out * 128).astype(np.float32) / 128


for frame in range(FRAMES):
    grid = vdb.FloatGrid()
    grid.copyFromArray(density(frame / RATE))
    grid.pruneInactive()
    grid.name, grid.gridClass, grid.saveFloatAsHalf = "density", vdb.GridClass.FOG_VOLUME, True
    grid.transform = vdb.createLinearTransform([[VOXEL, 0, 0, 0], [0, VOXEL, 0, 0], [0, 0, VOXEL, 0], [VOXEL / 2 - 1, VOXEL / 2 - 1, VOXEL / 2, 1]])
    vdb.write(os.path.join(FOLDER, f"smoke_{frame:04d}.vdb"), grids=[grid])
