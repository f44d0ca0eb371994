# SPDX-License-Identifier: Apache-2.0 OR GPL-3.0-or-later
"""Curves over time: as few keys as straight lines between them allow."""
import math

import numpy as np


def thinned(times, values, tolerance):
    """Indices of the keys that are needed for `values` (a row per time) to stay within `tolerance` on straight lines
    between them [Douglas1973]. One index where nothing changes."""
    values = np.asarray(values, dtype=float).reshape(len(times), -1)
    if len(times) == 1 or np.all(np.ptp(values, axis=0) <= tolerance):
        return [0]
    times = np.asarray(times, dtype=float)
    needed, pending = {0, len(times) - 1}, [(0, len(times) - 1)]
    while pending:
        first, last = pending.pop()
        if last - first < 2:
            continue
        between = slice(first + 1, last)
        share = (times[between] - times[first]) / (times[last] - times[first])
        straight = values[first] + share[:, None] * (values[last] - values[first])
        error = np.max(np.abs(values[between] - straight) / tolerance, axis=1)
        worst = int(np.argmax(error))
        if error[worst] > 1:
            middle = first + 1 + worst
            needed.add(middle)
            pending += [(first, middle), (middle, last)]
    return sorted(needed)


def turns(rotation):
    """Degrees about x, y and z of a 3x3 rotation, as animation files count them: z is done first, y last."""
    x, y, z = (math.degrees(a) for a in rotation.to_euler("ZXY"))
    return [x, y, z]


def unwound(angles):
    """The same turns, each a turn of whole circles or of the other way about (x + 180, 180 - y) nearest to the one
    before, so that what lies between is short."""
    out = [list(angles[0])]
    for x, y, z in angles[1:]:
        best = None
        for candidate in ((x, y, z), (180 - x, y + 180, z + 180)):
            near = [a + 360 * round((b - a) / 360) for a, b in zip(candidate, out[-1])]
            distance = sum(abs(a - b) for a, b in zip(near, out[-1]))
            if best is None or distance < best[0]:
                best = (distance, near)
        out.append(best[1])
    return out


def json_number(value):
    """A float's shortest text that reads back the same in single precision and more."""
    return float(f"{float(value):.9g}")
