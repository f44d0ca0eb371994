#!/usr/bin/env python3
"""farm_scaling.py MEASURED.json [CURVE.svg]: how long a farm of n nodes takes, by simulation from measured times.

MEASURED.json, all in seconds of one node: `plan`, `start` (a part before its first frame), `first` and `later` (a chunk's first frame, and
each other), `join_fixed` and `join_frame`; `spread`: times of equally long parts of a measured film, whose relation to their mean every chunk
draws in turn; `frames`, `chunk`, `pass` (of a first pass, for each frame; 0: one pass) and `dispatch` (of a scheduler, for each part).
Parts go to the first node that is free. Prints a table, for parts of one, two and four chunks; writes a curve of the speed-up.
"""
import heapq
import json
import math
import sys

NODES = [1, 2, 4, 8, 16, 32, 64, 128, 250, 500, 1000]


def part_times(m, chunks_each):
    chunks = [min(m["chunk"], m["frames"] - at) for at in range(0, m["frames"], m["chunk"])]
    mean = sum(m["spread"]) / len(m["spread"])
    times = [(m["first"] + (n - 1) * m["later"]) * m["spread"][i % len(m["spread"])] / mean for i, n in enumerate(chunks)]
    return [m["start"] + sum(times[i:i + chunks_each]) for i in range(0, len(times), chunks_each)]


def makespan(m, nodes, chunks_each):
    free = [0.0] * nodes
    heapq.heapify(free)
    for time in part_times(m, chunks_each):
        heapq.heappush(free, heapq.heappop(free) + m["dispatch"] + time)
    serial = m["plan"] + m["pass"] * m["frames"] + m["join_fixed"] + m["join_frame"] * m["frames"]
    return max(free) + serial


def one_run(m):
    return m["plan"] + m["pass"] * m["frames"] + sum(part_times(m, 10**9)) + m["join_frame"] * m["frames"]


def curve(m, rows, path):
    width, height, left, top, right, bottom = 720, 360, 60, 34, 150, 44
    x = lambda n: left + math.log10(n) / 3 * (width - left - right)
    y = lambda s: height - bottom - math.log10(max(s, 1)) / 3 * (height - top - bottom)
    label = lambda px, py, words, anchor="middle": f'<text x="{px:.0f}" y="{py:.0f}" text-anchor="{anchor}">{words}</text>'
    body = [label(12, 20, "How many times faster a farm is than one node", "start")]
    for value in (1, 10, 100, 1000):
        body += [f'<line x1="{left}" x2="{width - right}" y1="{y(value):.1f}" y2="{y(value):.1f}" stroke="#d8dde3"/>',
                 label(left - 8, y(value) + 4, f"x{value}", "end"), label(x(value), height - bottom + 16, value)]
    body.append(label((left + width - right) / 2, height - 8, "nodes"))
    body.append(f'<path d="M{x(1):.1f} {y(1):.1f}L{x(1000):.1f} {y(1000):.1f}" stroke="#8a939c" stroke-dasharray="4 4"/>')
    for column, colour, name in ((0, "#2f6fb0", "parts of 1 chunk"), (1, "#e09f3e", "2 chunks"), (2, "#9e2a2b", "4 chunks")):
        points = [(x(n), y(one_run(m) / row[column])) for n, row in zip(NODES, rows)]
        body.append('<path d="M' + "L".join(f"{px:.1f} {py:.1f}" for px, py in points) + f'" stroke="{colour}" stroke-width="2" fill="none"/>')
        body.append(f'<text x="{points[-1][0] + 8:.0f}" y="{points[-1][1] + 4:.0f}" fill="{colour}">{name}</text>')
    with open(path, "w") as out:
        out.write(f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" height="{height}" '
                  'font-family="sans-serif" font-size="12" fill="#1b1f24">\n'
                  f'<rect width="{width}" height="{height}" fill="#ffffff"/>\n' + "\n".join(body) + "\n</svg>\n")


def main():
    m = json.load(open(sys.argv[1]))
    rows = [[makespan(m, n, each) for each in (1, 2, 4)] for n in NODES]
    print(f"one run: {one_run(m) / 3600:.2f} h")
    print("| nodes | hours | times as fast | parts of 2 chunks | of 4 |\n|---|---|---|---|---|")
    for n, row in zip(NODES, rows):
        print(f"| {n} | {row[0] / 3600:.2f} | {one_run(m) / row[0]:.1f} | {one_run(m) / row[1]:.1f} | {one_run(m) / row[2]:.1f} |")
    if len(sys.argv) > 2:
        curve(m, rows, sys.argv[2])


main()
