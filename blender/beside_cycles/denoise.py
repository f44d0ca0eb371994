# SPDX-License-Identifier: Apache-2.0 OR GPL-3.0-or-later
"""A denoiser of pictures of paths, by what surfaces look like: a stand-in where Blender has none of its own.

First-order regression after Bitterli et al., "Nonlinearly Weighted First-Order Regression for Denoising Monte Carlo Renderings" (2016):
around each pixel the light is fitted by a plane over albedo, normal and depth; a neighbour weighs as much as its patch in the *other*
half of the samples is like the pixel's, given the noise (non-local means: Rousselle et al. 2012). One bandwidth, one pass.
"""
import numpy as np

WINDOW, PATCH = 7, 3  # half widths, pixels
BANDWIDTH = 0.7  # of distances in standard deviations
RIDGE = 1e-3  # of the features' mean square in a window
SHARED = 1e-9  # variance that nothing is below, of the picture's mean squared


def box(values, half):
    """Means over squares of 2 half + 1 pixels, which end at the picture's edge. (rows, columns, channels)."""
    for axis in (0, 1):
        count = values.shape[axis]
        sums = np.concatenate([np.zeros_like(values.take([0], axis)), np.cumsum(values, axis, dtype=np.float64)], axis)
        low, high = np.maximum(np.arange(count) - half, 0), np.minimum(np.arange(count) + half + 1, count)
        shape = [1] * values.ndim
        shape[axis] = count
        values = (sums.take(high, axis) - sums.take(low, axis)) / (high - low).reshape(shape)
    return values


def shifted(values, dy, dx):
    """Slices of the pixels whose neighbour at (dy, dx) lies in the picture, and of those neighbours."""
    rows, columns = values.shape[:2]
    here = slice(max(-dy, 0), rows - max(dy, 0)), slice(max(-dx, 0), columns - max(dx, 0))
    there = slice(max(dy, 0), rows - max(-dy, 0)), slice(max(dx, 0), columns - max(-dx, 0))
    return here, there


def weights_of(half, variance, dy, dx):
    """How like each pixel's patch is to its neighbour's, 0 to 1; 0 where the neighbour is outside. (rows, columns)."""
    here, there = shifted(half, dy, dx)
    a, b, va, vb = half[here], half[there], variance[here], variance[there]
    distance = ((a - b) ** 2 - (va + np.minimum(va, vb))) / (BANDWIDTH**2 * (va + vb))
    weights = np.zeros(half.shape[:2])
    weights[here] = np.exp(-np.maximum(box(distance.mean(-1, keepdims=True), PATCH)[..., 0], 0))
    return weights, here, there


def scaled(features):
    """Each channel with a mean square of 1 about its mean."""
    centred = features - features.mean((0, 1))
    return centred / np.sqrt(np.maximum(np.mean(centred**2, (0, 1)), 1e-12))


def denoised(halves, features):
    """The picture of two halves of the samples (rows, columns, 3), by features (rows, columns, any) that are seen in them."""
    halves = [np.asarray(h, np.float64) for h in halves]
    floor = SHARED * np.mean((halves[0] + halves[1]) ** 2) + 1e-30
    variance = box((halves[0] - halves[1]) ** 2 / 2, PATCH) + floor
    features = scaled(np.asarray(features, np.float64))
    count = features.shape[-1] + 1
    normal = [np.zeros(halves[0].shape[:2] + (count, count)) for _ in halves]
    moments = [np.zeros(halves[0].shape[:2] + (count, 3)) for _ in halves]
    for dy in range(-WINDOW, WINDOW + 1):
        for dx in range(-WINDOW, WINDOW + 1):
            for k, other in ((0, 1), (1, 0)):
                weights, here, there = weights_of(halves[other], variance, dy, dx)
                row = np.concatenate([np.ones(weights[here].shape + (1,)), features[there] - features[here]], -1)
                weighted = row * weights[here][..., None]
                normal[k][here] += weighted[..., :, None] * row[..., None, :]
                moments[k][here] += weighted[..., :, None] * halves[k][there][..., None, :]
    found = []
    for k in (0, 1):
        ridge = RIDGE * normal[k][..., 0, 0, None, None] * np.eye(count)
        ridge[..., 0, 0] = 0
        found.append(np.linalg.solve(normal[k] + ridge, moments[k])[..., 0, :])
    return np.maximum((found[0] + found[1]) / 2, 0)
