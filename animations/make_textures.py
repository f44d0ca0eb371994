#!/usr/bin/env python3
"""Makes the textures of the films beside it; needs nothing but Python. They repeat without a seam, and hold no detail finer than
three texels, so that they do not shimmer. Run it in this folder: ./make_textures.py"""
import math
import os
import random
import struct
import zlib

SIZE = 256


def write_png(path, pixel, size=SIZE):
    """`pixel(u, v)` with u, v in [0, 1), v down, gives sRGB in 0..1."""
    rows = b""
    for y in range(size):
        row = bytearray()
        for x in range(size):
            color = pixel((x + 0.5) / size, (y + 0.5) / size)
            row += bytes(max(0, min(255, round(255 * c))) for c in color)
        rows += b"\0" + bytes(row)

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    header = struct.pack(">IIBBBBB", size, size, 8, 2, 0, 0, 0)
    os.makedirs(os.path.dirname(path), exist_ok=True)
    with open(path, "wb") as out:
        out.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows, 9)) + chunk(b"IEND", b""))
    print(path, os.path.getsize(path), "bytes")


class Noise:
    """Smooth noise in -1..1 that repeats after 1 in both directions; `cells` bumps lie across."""

    def __init__(self, seed, cells_u, cells_v=None):
        self.nu, self.nv = cells_u, cells_v or cells_u
        rng = random.Random(seed)
        self.values = [[rng.uniform(-1, 1) for _ in range(self.nu)] for _ in range(self.nv)]

    def __call__(self, u, v):
        x, y = (u % 1) * self.nu, (v % 1) * self.nv
        i, j = int(x), int(y)
        fx, fy = x - i, y - j
        fx, fy = fx * fx * (3 - 2 * fx), fy * fy * (3 - 2 * fy)
        at = lambda a, b: self.values[b % self.nv][a % self.nu]
        top = at(i, j) + fx * (at(i + 1, j) - at(i, j))
        low = at(i, j + 1) + fx * (at(i + 1, j + 1) - at(i, j + 1))
        return top + fy * (low - top)


class Clouds:
    """Noise in octaves, each half as strong as the one before."""

    def __init__(self, seed, cells, octaves):
        self.layers = [(Noise(seed + k, cells << k), 0.5**k) for k in range(octaves)]

    def __call__(self, u, v):
        return sum(w * n(u, v) for n, w in self.layers)


def mix(a, b, t):
    t = max(0.0, min(1.0, t))
    return tuple(x + (y - x) * t for x, y in zip(a, b))


def scaled(color, f):
    return tuple(c * f for c in color)


def joint(x, period, width):
    """1 in the middle of a joint that comes every `period`, 0 beyond `width`."""
    d = abs((x + period / 2) % period - period / 2)
    return max(0.0, 1 - d / width)


def planks(seed, light, dark):
    grain, broad = Noise(seed, 4, 48), Clouds(seed + 9, 4, 3)
    rng = random.Random(seed)
    tones = [[rng.uniform(0.82, 1.1) for _ in range(8)] for _ in range(8)]

    def pixel(u, v):
        row = int(v * 6)
        shift = (row * 0.37) % 1
        board = int(((u + shift) % 1) * 2)
        tone = tones[row % 8][board]
        line = 0.5 + 0.5 * grain(u * 1.0 + row * 0.31, v + board * 0.17)
        color = scaled(mix(light, dark, 0.65 * line + 0.15 * broad(u, v)), tone)
        gap = max(joint(v, 1 / 6, 0.008), joint(u + shift, 0.5, 0.006))
        return mix(color, scaled(dark, 0.35), gap)

    return pixel


def tiles(seed, count, stone, vein, grout):
    clouds, veins = Clouds(seed, 3, 4), Clouds(seed + 5, 2, 4)
    rng = random.Random(seed)
    tones = [[rng.uniform(0.9, 1.06) for _ in range(count)] for _ in range(count)]

    def pixel(u, v):
        i, j = int(u * count), int(v * count)
        # Every tile is cut from another place of the block.
        su, sv = u + 0.37 * i + 0.11 * j, v + 0.53 * j + 0.29 * i
        streak = 1 - min(1.0, abs(veins(su, sv)) * 6)
        color = mix(stone, vein, 0.25 + 0.25 * clouds(su, sv) + 0.5 * streak * streak)
        gap = max(joint(u, 1 / count, 0.009), joint(v, 1 / count, 0.009))
        return mix(scaled(color, tones[j][i]), grout, gap)

    return pixel


def plaster(seed, color, amount):
    clouds, spots = Clouds(seed, 4, 4), Noise(seed + 7, 40)
    return lambda u, v: scaled(color, 1 + amount * (0.6 * clouds(u, v) + 0.4 * spots(u, v)))


def blocks(seed, stone, dark, mortar):
    """Cut stone in courses."""
    clouds, fine = Clouds(seed, 4, 4), Noise(seed + 3, 56)
    rng = random.Random(seed)
    tones = [[rng.uniform(0.86, 1.08) for _ in range(4)] for _ in range(6)]

    def pixel(u, v):
        row = int(v * 6)
        shift = 0.5 / 3 if row % 2 else 0.0
        i = int(((u + shift) % 1) * 3)
        color = mix(stone, dark, 0.35 + 0.4 * clouds(u, v) + 0.15 * fine(u, v))
        gap = max(joint(v, 1 / 6, 0.011), joint(u + shift, 1 / 3, 0.011))
        return mix(scaled(color, tones[row][i]), mortar, gap)

    return pixel


def wallpaper(ground, figure, seed):
    clouds = Clouds(seed, 4, 3)

    def pixel(u, v):
        # Lozenges with a disc in each, the rows offset by half a step.
        x, y = u * 4, v * 4
        if int(y) % 2:
            x += 0.5
        dx, dy = (x % 1) - 0.5, (y % 1) - 0.5
        lozenge = abs(dx) + abs(dy)
        disc = math.hypot(dx, dy)
        t = max(1 - abs(lozenge - 0.46) / 0.05, 1 - max(0.0, disc - 0.10) / 0.04)
        return scaled(mix(ground, figure, t), 1 + 0.04 * clouds(u, v))

    return pixel


def carpet(ground, figure, edge, seed):
    weave = Noise(seed, 64)

    def pixel(u, v):
        border = min(u, v, 1 - u, 1 - v)
        dx, dy = u - 0.5, v - 0.5
        star = math.hypot(dx, dy) * (1 + 0.22 * math.cos(8 * math.atan2(dy, dx)))
        rings = 0.5 + 0.5 * math.cos(star * 46)
        color = mix(ground, figure, (rings - 0.35) * 4) if border > 0.12 else edge
        if 0.05 < border < 0.075 or 0.095 < border < 0.12:
            color = figure
        return scaled(color, 1 + 0.10 * weave(u, v))

    return pixel


def painting(seed):
    """A landscape in broad strokes: sky, hills, a lake, a sun."""
    clouds, strokes = Clouds(seed, 3, 4), Noise(seed + 2, 12, 60)
    hills = [Clouds(seed + 10 + k, 3, 3) for k in range(3)]

    def pixel(u, v):
        color = mix((0.25, 0.45, 0.75), (0.98, 0.78, 0.55), v * 1.7)
        color = mix(color, (1.0, 0.95, 0.85), 0.5 * max(0.0, clouds(u, v * 1.5)))
        if math.hypot(u - 0.68, v - 0.36) < 0.075:
            color = (1.0, 0.86, 0.5)
        for k, ridge in enumerate(hills):
            height = 0.50 + 0.11 * k + 0.07 * ridge(u, 0.3)
            if v > height:
                color = mix((0.38, 0.46, 0.62), (0.13, 0.26, 0.14), k / 2)
        if v > 0.80:
            color = mix((0.22, 0.38, 0.55), (0.85, 0.70, 0.50), 0.5 + 0.5 * math.sin(60 * v + 4 * clouds(u, v)))
        return scaled(color, 1 + 0.07 * strokes(u, v))

    return pixel


def cloth(a, b, c, seed):
    """Horizontal stripes with a woven grain, for clothes; v runs along the body."""
    weave = Noise(seed, 60)

    def pixel(u, v):
        band = (v * 8) % 1
        color = a if band < 0.45 else (b if band < 0.8 else c)
        check = 0.5 + 0.5 * math.sin(2 * math.pi * 8 * u)
        return scaled(mix(color, scaled(color, 0.72), 0.6 * (check > 0.6)), 1 + 0.08 * weave(u, v))

    return pixel


if __name__ == "__main__":
    write_png("cornell/floor.png", planks(1, (0.80, 0.62, 0.42), (0.48, 0.31, 0.18)))
    write_png("cornell/wallpaper.png", wallpaper((0.84, 0.81, 0.74), (0.55, 0.60, 0.68), 2))
    write_png("cornell/crate.png", blocks(3, (0.90, 0.85, 0.76), (0.70, 0.60, 0.48), (0.42, 0.36, 0.30)))
    write_png("colonnade/paving.png", tiles(4, 4, (0.82, 0.79, 0.73), (0.58, 0.53, 0.47), (0.46, 0.43, 0.39)))
    write_png("colonnade/ashlar.png", blocks(5, (0.88, 0.82, 0.71), (0.72, 0.63, 0.51), (0.60, 0.54, 0.46)))
    write_png("colonnade/shaft.png", plaster(6, (0.88, 0.84, 0.77), 0.10))
    write_png("many_lamps/cobbles.png", tiles(7, 8, (0.60, 0.58, 0.56), (0.42, 0.41, 0.42), (0.25, 0.24, 0.24)))
    write_png("many_lamps/brick.png", blocks(8, (0.72, 0.44, 0.34), (0.55, 0.30, 0.23), (0.66, 0.62, 0.57)))
    write_png("mirror_and_glass/marble.png", tiles(9, 2, (0.90, 0.90, 0.88), (0.62, 0.64, 0.68), (0.50, 0.50, 0.50)))
    write_png("mirror_and_glass/wallpaper.png", wallpaper((0.30, 0.42, 0.44), (0.78, 0.68, 0.45), 10))
    write_png("mirror_and_glass/painting.png", painting(11))
    write_png("character/cloth.png", cloth((0.78, 0.22, 0.18), (0.93, 0.88, 0.78), (0.20, 0.27, 0.45), 12))
    write_png("character/ground.png", tiles(13, 4, (0.76, 0.73, 0.66), (0.57, 0.55, 0.50), (0.44, 0.42, 0.40)))
    write_png("still_room/floor.png", planks(14, (0.70, 0.50, 0.32), (0.38, 0.23, 0.13)))
    write_png("still_room/carpet.png", carpet((0.55, 0.16, 0.15), (0.86, 0.74, 0.52), (0.16, 0.20, 0.34), 15))
    write_png("still_room/painting.png", painting(16))
    write_png("still_room/plaster.png", plaster(17, (0.88, 0.86, 0.80), 0.05))
    write_png("flash_cut/floor.png", tiles(18, 4, (0.55, 0.50, 0.46), (0.40, 0.36, 0.34), (0.28, 0.26, 0.25)))
    write_png("flash_cut/wall.png", blocks(19, (0.70, 0.66, 0.62), (0.52, 0.48, 0.45), (0.40, 0.38, 0.36)))
