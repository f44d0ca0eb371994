"""blender -b --factory-startup -noaudio --python-exit-code 1 -P views.py

Fits the constants of perceptual/view_transform.cpp to what Blender shows: of Filmic prints each look's sigmoid, how bright
colours fade to white, and the largest errors in code values of 255; of AgX, which Blender 4 has, its sigmoid and how channels
mix before and after it (docs/measurements.md#views).
"""
import os
import tempfile

import bpy
import numpy as np

DARK, STOPS = -12.473931188, 16.5
LOOKS = ["None", "Very High Contrast", "High Contrast", "Medium High Contrast", "Medium Low Contrast", "Low Contrast", "Very Low Contrast"]


def shown(colors, view, look="None"):
    """Signals of scene-linear colours (n, 3), through a PNG of 16 bits."""
    width = 256
    height = -(-len(colors) // width)
    pixels = np.ones((height * width, 4), np.float32)
    pixels[:len(colors), :3] = colors
    image = bpy.data.images.new("colours", width, height, float_buffer=True)
    image.colorspace_settings.name = "Linear" if bpy.app.version < (4, 0, 0) else "Linear Rec.709"
    image.pixels.foreach_set(pixels.ravel())
    scene = bpy.context.scene
    scene.view_settings.view_transform, scene.view_settings.look = view, look
    settings = scene.render.image_settings
    settings.file_format, settings.color_depth, settings.color_mode = "PNG", "16", "RGB"
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "colours.png")
        image.save_render(path, scene=scene)
        back = bpy.data.images.load(path)
        back.colorspace_settings.name = "Non-Color"
        out = np.array(back.pixels[:]).reshape(-1, 4)[:len(colors), :3]
    bpy.data.images.remove(image)
    bpy.data.images.remove(back)
    return out


def least(error, start, steps=4000):
    """Nelder and Mead's simplex."""
    points = [np.array(start, float)]
    points += [points[0] + 0.1 * max(abs(start[k]), 0.1) * np.eye(len(start))[k] for k in range(len(start))]
    values = [error(p) for p in points]
    for _ in range(steps):
        order = np.argsort(values)
        points, values = [points[k] for k in order], [values[k] for k in order]
        middle = np.mean(points[:-1], 0)
        away = [middle + t * (middle - points[-1]) for t in (1, 2, -0.5)]
        new = [error(p) for p in away]
        best = 1 if new[0] < values[0] and new[1] < new[0] else 0 if new[0] < values[-2] else 2
        if new[best] < values[-1]:
            points[-1], values[-1] = away[best], new[best]
        else:
            points = [(points[0] + p) / 2 for p in points]
            values = [error(p) for p in points]
    return points[0], values[0]


def arm(x, width, height, slope, power):
    scale = ((slope * width) ** -power * ((slope * width / height) ** power - 1)) ** (-1 / power)
    u = slope * x / scale
    return scale * u * (1 + u ** power) ** (-1 / power)


def sigmoid(t, s):
    x, y, slope, toe, shoulder = s
    return np.where(t < x, y - arm(np.maximum(x - t, 0), x, y, slope, toe), y + arm(np.maximum(t - x, 0), 1 - x, 1 - y, slope, shoulder))


def place(light):
    return np.clip((np.log2(np.maximum(light, 1e-9)) - DARK) / STOPS, 0, 1)


def fit_look(look, light):
    truth = shown(np.repeat(light[:, None], 3, 1), "Filmic", look)[:, 1]

    def error(s):
        if min(s) <= 0 or max(s[0], s[1]) > 0.9 or s[2] * s[0] <= s[1] or s[2] * (1 - s[0]) <= 1 - s[1]:
            return 9.0
        return np.abs(sigmoid(place(light), s) - truth).max()

    return min((least(error, (0.606, 0.5, slope, toe, shoulder)) for slope in (1.8, 2.6) for toe in (1.2, 3) for shoulder in (1.2, 3)),
               key=lambda found: found[1])


def faded(colors, fading):
    largest = colors.max(1)
    share = np.clip(fading[0] * largest ** fading[1] - fading[2], 0, 1)[:, None]
    return colors + share * (largest[:, None] - colors)


def fit_fading(filmic):
    bright = 2.0 ** np.linspace(3, 13, 321)
    colors = np.concatenate([np.stack([bright, np.full_like(bright, other), np.full_like(bright, other)], 1) for other in (0, 0.5, 4)])
    truth = shown(colors, "Filmic")[:, 1]

    def error(fading):
        return 9.0 if min(fading) < 0 else np.abs(sigmoid(place(faded(colors, fading)[:, 1]), filmic) - truth).max()

    return min((least(error, (6e-5, power, offset)) for power in (1.1, 1.2) for offset in (0.001, 0.0005)), key=lambda found: found[1])


def mixing(six):
    """A matrix by what is off its diagonal; rows sum to 1."""
    m = np.zeros((3, 3))
    m[~np.eye(3, dtype=bool)] = six
    return m + np.diag(1 - m.sum(1))


def agx(constants, colors):
    mixed = sigmoid(place(colors @ mixing(constants[5:11]).T), constants[:5]) ** 2.4 @ mixing(constants[11:]).T
    cut = np.clip(mixed, 0, 1)
    return np.where(cut <= 0.0031308, 12.92 * cut, 1.055 * cut ** (1 / 2.4) - 0.055)


def fit_agx():
    """Least squares by Levenberg and Marquardt's method, over colours whose channels are 0 or 2^-7 to 2^5."""
    stops = np.concatenate([[-99], np.arange(-7, 6)])
    colors = 2.0 ** np.stack(np.meshgrid(stops, stops, stops, indexing="ij"), -1).reshape(-1, 3)[1:]
    truth = shown(colors, "AgX")
    found, damping = np.array([0.606, 0.46, 2.1, 3, 3.25] + [0.1] * 6 + [-0.1] * 6), 1e-2
    error = (agx(found, colors) - truth).ravel()
    for _ in range(100):
        slopes = np.stack([((agx(found + 1e-5 * unit, colors) - truth).ravel() - error) / 1e-5 for unit in np.eye(17)], 1)
        square = slopes.T @ slopes
        tried = found - np.linalg.solve(square + damping * np.diag(np.diag(square)), slopes.T @ error)
        with np.errstate(all="ignore"):
            new = (agx(tried, colors) - truth).ravel()
        if np.isfinite(new).all() and new @ new < error @ error:
            found, error, damping = tried, new, damping / 3
        else:
            damping *= 4
    errors = 255 * np.abs(error.reshape(-1, 3))
    greys = 255 * np.abs(agx(found, 2.0 ** np.arange(-12, 6, 0.25)[:, None].repeat(3, 1))
                         - shown(2.0 ** np.arange(-12, 6, 0.25)[:, None].repeat(3, 1), "AgX"))
    print(f"AgX: {np.round(found[:5], 4)}\n{np.round(mixing(found[5:11]), 5)}\n{np.round(mixing(found[11:]), 5)}")
    print(f"{len(colors)} colours: mean error {errors.mean():.2f}, of 99 of 100 {np.percentile(errors.max(1), 99):.2f}, "
          f"largest {errors.max():.2f}; greys {greys.max():.2f}")
    for color in ((-6, -6, -6), (-2.5, -2.5, -2.5), (1, 1, 1), (0, -3, -5), (-4, -1, -2), (-5, -4, 2), (4, 1, -1), (-1, -2, 3)):
        print(color, np.round(shown(2.0 ** np.array([color]), "AgX")[0], 4))


def main():
    if bpy.app.version >= (4, 0, 0):
        fit_agx()
    light = 2.0 ** np.linspace(DARK, DARK + STOPS, 1056)
    filmic = None
    for look in LOOKS:
        found, error = fit_look(look, light)
        filmic = found if filmic is None else filmic
        print(f"{look}: {np.round(found, 4)}, largest error {255 * error:.2f}")
    fading, error = fit_fading(filmic)
    print(f"fading: {fading}, largest error {255 * error:.2f}")
    stops = np.concatenate([[-14], np.arange(-12, 14)])
    grid = 2.0 ** np.stack(np.meshgrid(stops, stops, stops, indexing="ij"), -1).reshape(-1, 3)
    errors = 255 * np.abs(sigmoid(place(faded(grid, fading)), filmic) - shown(grid, "Filmic"))
    print(f"{len(grid)} colours: mean error {errors.mean():.2f}, largest {errors.max():.2f}")


main()
