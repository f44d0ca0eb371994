"""bench/record_loss.py WORK FILM SIDE: the rows of record_loss.sh, from what that has rendered into WORK."""
import array
import math
import os
import subprocess
import sys


def transfer(light):
    """BT.709's, as docs/model/determinism.md has it."""
    return 4.5 * light if light < 0.018053968510807 else 1.09929682680944 * light**0.45 - 0.09929682680944


def luma(r, g, b):
    """BT.601's, as of pictures of fewer than 720 lines."""
    return 16 + 219 * (0.299 * r + 0.587 * g + 0.114 * b)


def raw(*arguments):
    return subprocess.run(["ffmpeg", "-v", "error", *arguments, "-f", "rawvideo", "-"], capture_output=True, check=True).stdout


def light_of(folder, side, factor):
    """Luma of frames of `factor` times the side, whose pixels are averaged in linear light."""
    values = array.array("f")
    values.frombytes(raw("-i", f"{folder}/f.%04d.exr", "-pix_fmt", "gbrpf32le"))
    wide, frames = side * factor, []
    plane = wide * wide
    for first in range(0, len(values), 3 * plane):
        frame = []
        for y in range(side):
            for x in range(side):
                g, b, r = (
                    sum(sum(values[at : at + factor]) for at in (first + p * plane + (y * factor + j) * wide + x * factor for j in range(factor)))
                    for p in range(3)
                )
                frame.append(luma(*(transfer(min(max(c / factor**2, 0.0), 1.0)) for c in (r, g, b))))
        frames.append(frame)
    return frames


def decoded(path, side):
    data = raw("-i", path, "-vf", "format=yuv420p,extractplanes=y", "-pix_fmt", "gray")
    return [data[at : at + side * side] for at in range(0, len(data), side * side)]


def mean_square(rows):
    total = count = 0
    for row in rows:
        for value in row:
            total += value * value
            count += 1
    return total / count


def compare(film, truth):
    """PSNR-Y, and the root of the mean square of what errors change by from frame to frame."""
    errors = [[a - b for a, b in zip(*pair)] for pair in zip(film, truth)]
    changes = ([b - a for a, b in zip(*pair)] for pair in zip(errors, errors[1:]))
    return 10 * math.log10(255 * 255 / mean_square(errors)), math.sqrt(mean_square(changes))


def main():
    work, name, side = sys.argv[1], sys.argv[2], int(sys.argv[3])
    truths = [light_of(f"{work}/{name}.nine", side, 3), light_of(f"{work}/{name}.middle", side, 1)]
    for tolerance in ("fixed", "coupled"):
        for quantiser in (4, 8, 16):
            off, on = (f"{work}/{name}.{tolerance}.{quantiser}.{cache}.m2v" for cache in ("off", "on"))
            films = [decoded(path, side) for path in (off, on)]
            pairs = [[compare(film, truth) for film in films] for truth in truths]
            loss = " | ".join(f"{before[0] - after[0]:.3f} dB" for before, after in pairs)
            flicker = " | ".join(f"{after[1] / before[1]:.4f}" for before, after in pairs)
            print(f"| {name} | {tolerance} | {quantiser} | {loss} | {flicker} | {os.path.getsize(on) / os.path.getsize(off):.3f} |", flush=True)


main()
