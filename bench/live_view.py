#!/usr/bin/env python3
"""How soon `watch --live` shows another view.

live_view.py PROGRAM SCENE --eye X,Y,Z --at X,Y,Z [--fov DEGREES] [--size WxH] [--views N]

Asks on two threads for N views, each a tenth of a radian further about the point that is looked at, and waits for the first draft in
full size of each. Prints a row: CPU seconds of loading; of the very first picture with its light; then, medians over the views, of the
first picture, with the sizes it had, and of the first draft in full size, and the seconds on the clock until the first picture. Half
of the CPU seconds are seconds on two free cores, about."""
import argparse, json, math, pathlib, statistics, subprocess

parser = argparse.ArgumentParser()
parser.add_argument("program")
parser.add_argument("scene")
parser.add_argument("--eye", required=True)
parser.add_argument("--at", required=True)
parser.add_argument("--fov", type=float, default=50)
parser.add_argument("--size", default="480x270")
parser.add_argument("--views", type=int, default=9)
given = parser.parse_args()
eye, at = ([float(v) for v in text.split(",")] for text in (given.eye, given.at))


def unit(v):
    length = math.sqrt(sum(x * x for x in v))
    return [x / length for x in v]


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def camera(turn):
    """From a place turned about the aim."""
    x, y, z = (e - a for e, a in zip(eye, at))
    away = [x * math.cos(turn) + z * math.sin(turn), y, z * math.cos(turn) - x * math.sin(turn)]
    back = unit(away)
    right = unit(cross([0, 1, 0], back))
    up = cross(back, right)
    rows = [[right[k], up[k], back[k], at[k] + away[k]] for k in range(3)]
    return {"camera": {"matrix": [v for row in rows for v in row] + [0, 0, 0, 1], "fov": given.fov}}


child = subprocess.Popen([given.program, "watch", given.scene, "--live", "--quiet", "--threads", "2", "--size", given.size],
                         stdin=subprocess.PIPE, stdout=subprocess.PIPE)


def answers():
    for line in child.stdout:
        says = json.loads(line)
        if "error" in says:
            raise SystemExit(says["error"])
        child.stdout.read(says.get("bytes", 0))
        yield says


told = answers()
load = next(told)["cpu"]
light = next(told)["cpu"]
first, full = [], []
for n in range(given.views):
    child.stdin.write(json.dumps(camera(0.1 * (n + 1) * (-1) ** n)).encode() + b"\n")
    child.stdin.flush()
    says = next(a for a in told if a.get("line") == n + 1)
    first.append(says)
    while "x".join(map(str, says["size"])) != given.size:
        says = next(told)
    full.append(says["cpu"])
child.stdin.close()
for _ in told:
    pass
median = lambda key: statistics.median(a[key] for a in first)
widths = sorted({a["size"][0] for a in first})
print(f"| {pathlib.Path(given.scene).name} | load {load:.2f} | light {light:.2f} | first {median('cpu'):.3f} CPU s, {' or '.join(map(str, widths))} wide, "
      f"{median('seconds'):.2f} s on the clock | full size {statistics.median(full):.3f} CPU s |")
