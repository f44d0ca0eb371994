#!/usr/bin/env python3
"""docs/pictures/charts.py: draws the chart of docs/measurements.md from its table, as an SVG file beside this script.

A table with a chart has the line `<!-- chart: NAME -->` above it. Needs nothing but Python.
"""
import pathlib
import re

HERE = pathlib.Path(__file__).parent
COLOURS = ["#2f6fb0", "#e09f3e", "#9e2a2b", "#4a8f5a", "#7a5ea8"]
WIDTH, HEIGHT = 720, 300
LEFT, RIGHT, TOP, BOTTOM = 60, 130, 34, 40


def table_of(name):
    """The rows of a chart's table, its head first, as cells of text without emphasis."""
    text = (HERE.parent / "measurements.md").read_text()
    block = text.split(f"<!-- chart: {name} -->\n")[1].split("\n\n")[0]
    rows = [[cell.strip().strip("*`") for cell in line.strip("|").split("|")] for line in block.splitlines()]
    return [rows[0]] + rows[2:]


def number(cell):
    """The first number of a cell; None where there is none."""
    match = re.search(r"[-+]?\d+(\.\d+)?", cell)
    return float(match.group()) if match else None


def text(x, y, words, anchor="start", extra=""):
    return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}" {extra}>{words}</text>'


def written(name, title, body):
    (HERE / f"{name}.svg").write_text(
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" width="{WIDTH}" height="{HEIGHT}" '
        'font-family="sans-serif" font-size="12" fill="#1b1f24">\n'
        f'<rect width="{WIDTH}" height="{HEIGHT}" fill="#ffffff"/>\n'
        + text(12, 20, title, extra='font-weight="bold" font-size="14"') + "\n" + "\n".join(body) + "\n</svg>\n")


def grid(low, high, step, mark=lambda v: f"{v:g}"):
    """Lines across the plot at multiples of a step, and the function from a value to its height."""
    at = lambda value: HEIGHT - BOTTOM - (value - low) / (high - low) * (HEIGHT - TOP - BOTTOM)
    body, value = [], low
    while value <= high + 1e-9:
        line = "#8a939c" if abs(value) < 1e-9 else "#d8dde3"
        body.append(f'<line x1="{LEFT}" x2="{WIDTH - RIGHT}" y1="{at(value):.1f}" y2="{at(value):.1f}" stroke="{line}"/>')
        body.append(text(LEFT - 8, at(value) + 4, mark(value), "end"))
        value += step
    return body, at


def bars(name, title, columns, names, low, high, step, mark, shorten=lambda row: row[0]):
    """For each row a bar of each of some columns."""
    _, *rows = table_of(name)
    body, at = grid(low, high, step, mark)
    slot = (WIDTH - LEFT - RIGHT) / len(rows)
    for i, row in enumerate(rows):
        wide = slot * 0.7 / len(columns)
        for j, column in enumerate(columns):
            value = number(row[column])
            x = LEFT + i * slot + slot * 0.15 + j * wide
            y, tall = min(at(value), at(0)), abs(at(value) - at(0))
            body.append(f'<rect x="{x:.1f}" y="{y:.1f}" width="{wide - 2:.1f}" height="{tall:.1f}" fill="{COLOURS[j]}"/>')
        for k, words in enumerate(shorten(row).split("\n")):
            body.append(text(LEFT + (i + 0.5) * slot, HEIGHT - BOTTOM + 15 + 13 * k, words, "middle", 'font-size="10.5"'))
    for j, words in enumerate(names):
        y = TOP + 10 + 18 * j
        body.append(f'<rect x="{WIDTH - RIGHT + 10}" y="{y - 9}" width="10" height="10" fill="{COLOURS[j]}"/>')
        body.append(text(WIDTH - RIGHT + 26, y, words))
    written(name, title, body)


bars("encoder-bits", "Bits beside ffmpeg's at equal PSNR-Y", [1, 2], ["against A", "against B"], -40, 10, 10,
     lambda v: f"{v:g} %")
