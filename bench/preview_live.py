#!/usr/bin/env python3
"""How soon a draft is there, and how soon it is right.

preview_live.py PROGRAM FILM OUT_FOLDER [--size WxH] [--frames N]

Prints a row. First picture: seconds on the clock, and CPU seconds, from the start of `render --preview -o - --as m2v` until bytes have
arrived that ffmpeg decodes a picture of. Where nothing moves or changes in the film, the PSNR of luma of its 1st, 4th, 8th, 16th and last
draft, uncoded, against a frame lit with as many anchors at a tolerance of 2 %. Needs ffmpeg and python3-numpy."""
import argparse, json, os, pathlib, subprocess, time
import numpy as np

parser = argparse.ArgumentParser()
parser.add_argument("program")
parser.add_argument("film")
parser.add_argument("out", type=pathlib.Path)
parser.add_argument("--size", default="640x360")
parser.add_argument("--frames", type=int, default=33)
given = parser.parse_args()
given.out.mkdir(parents=True, exist_ok=True)
width, height = map(int, given.size.split("x"))
draft = [given.program, "render", given.film, "--preview", "--size", given.size, "--quiet"]


def shown(coded):
    told = subprocess.run(["ffmpeg", "-v", "quiet", "-f", "mpegvideo", "-i", "-", "-f", "rawvideo", "-pix_fmt", "yuv420p", "-"], input=coded, stdout=subprocess.PIPE)
    return len(told.stdout) // (width * height * 3 // 2)


def first_picture():
    began = time.monotonic()
    child = subprocess.Popen([*draft, "-o", "-", "--as", "m2v"], stdout=subprocess.PIPE)
    ticks, coded = os.sysconf("SC_CLK_TCK"), b""
    while piece := os.read(child.stdout.fileno(), 1 << 20):
        clock = time.monotonic() - began
        fields = open(f"/proc/{child.pid}/stat").read().rpartition(")")[2].split()
        coded += piece
        if shown(coded) > 0:
            child.kill()
            child.wait()
            return clock, (int(fields[11]) + int(fields[12])) / ticks
    raise SystemExit("no picture came")


def luma(path):
    raw = subprocess.run(["ffmpeg", "-v", "error", "-i", path, "-f", "rawvideo", "-pix_fmt", "gray", "-"], stdout=subprocess.PIPE, check=True).stdout
    return np.frombuffer(raw, np.uint8).reshape(-1, height, width).astype(float)


clock, cpu = first_picture()
row = f"| {pathlib.Path(given.film).name} | {clock:.2f} s, {cpu:.2f} CPU s |"
film = (pathlib.Path(given.film) / "film.json").read_text() if pathlib.Path(given.film).is_dir() else '"keys"'
if '"keys"' not in film:
    stats = given.out / "still.json"
    frames = ["--frames", f"0:{given.frames - 1}"]
    subprocess.run([*draft, "-o", given.out / "still.y4m", "-y", "--stats", stats, *frames], check=True)
    exposure = str(json.loads(stats.read_text())["exposure"])
    subprocess.run([given.program, "render", given.film, "-o", given.out / "light.y4m", "--size", given.size, "--frames", "0:0", "--vpls", "2048", "--samples", "1",
                    "--edge-samples", "4", "--cache", "off", "--tolerance", "fixed=2%", "--exposure", exposure, "-y", "--quiet"], check=True)
    light, drafts = luma(given.out / "light.y4m")[0], luma(given.out / "still.y4m")
    psnr = lambda a: 10 * np.log10(255**2 / np.mean((a - light) ** 2))
    row += " " + ", ".join(f"{n}: {psnr(drafts[n - 1]):.2f}" for n in (1, 4, 8, 16, given.frames)) + " dB |"
print(row, flush=True)
