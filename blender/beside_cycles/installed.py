# SPDX-License-Identifier: Apache-2.0 OR GPL-3.0-or-later
"""Metrics of other programs, where those are installed: XPSNR of ffmpeg 7.1 or newer, SSIMULACRA2 of libjxl's program."""
import functools
import pathlib
import re
import shutil
import subprocess
import tempfile

import numpy as np


def output_of(*words, folder=None):
    return subprocess.run([str(w) for w in words], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=True, cwd=folder).stdout


@functools.lru_cache
def has_xpsnr():
    return "Filter xpsnr" in output_of("ffmpeg", "-hide_banner", "-h", "filter=xpsnr")


@functools.lru_cache
def has_ssimulacra2():
    return shutil.which("ssimulacra2") is not None


LEAST_PIXELS = 2025  # in smaller pictures XPSNR's blocks have no size, on which ffmpeg 7.1 ends


def xpsnr(film, truth, pixels):
    """dB of luma of each picture of so many pixels, infinite where nothing differs; empty: not known."""
    if not has_xpsnr() or pixels < LEAST_PIXELS:
        return []
    with tempfile.TemporaryDirectory() as folder:
        output_of("ffmpeg", "-v", "error", "-nostdin", "-i", truth, "-i", film, "-lavfi",
                  "[0]format=yuv420p[a];[1]format=yuv420p[b];[a][b]xpsnr=stats_file=xpsnr.txt", "-f", "null", "-", folder=folder)
        told = (pathlib.Path(folder) / "xpsnr.txt").read_text()
    return [float(value) for value in re.findall(r"^n:.*?XPSNR y: *(\S+)", told, re.MULTILINE)]


def ssimulacra2(film, truth):
    """Of each picture, 100 where nothing differs; empty: the program is missing."""
    if not has_ssimulacra2():
        return []
    with tempfile.TemporaryDirectory() as folder:
        for name, path in (("truth", truth), ("film", film)):
            output_of("ffmpeg", "-v", "error", "-nostdin", "-i", path, "-pix_fmt", "rgb24", f"{name}%04d.png", folder=folder)
        count = len(list(pathlib.Path(folder).glob("film*.png")))
        return [float(output_of("ssimulacra2", f"truth{n:04d}.png", f"film{n:04d}.png", folder=folder).splitlines()[-1]) for n in range(1, count + 1)]


def mean_and_low(values):
    """Their mean and that of the lowest twentieth, at least of one; None of none."""
    values = sorted(values)
    return (float(np.mean(values)), float(np.mean(values[:max(1, len(values) // 20)]))) if values else (None, None)
