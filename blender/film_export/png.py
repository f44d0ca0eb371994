# SPDX-License-Identifier: Apache-2.0 OR GPL-3.0-or-later
"""Writes PNG images, and turns linear values into what they hold."""
import struct
import zlib

import numpy as np


def srgb(linear):
    linear = np.clip(linear, 0, 1)
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * np.power(np.maximum(linear, 1e-9), 1 / 2.4) - 0.055)


def write(path, pixels):
    """`pixels`: rows from the bottom up, 0..1, three or four channels of code values."""
    codes = np.clip(np.asarray(pixels) * 255 + 0.5, 0, 255).astype(np.uint8)[::-1]
    height, width, channels = codes.shape
    raw = np.zeros((height, 1 + width * channels), dtype=np.uint8)
    raw[:, 1:] = codes.reshape(height, -1)

    def chunk(name, data):
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))
    with open(path, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, {3: 2, 4: 6}[channels], 0, 0, 0)) +
                   chunk(b"IDAT", zlib.compress(raw.tobytes(), 6)) + chunk(b"IEND", b""))
