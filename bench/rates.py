#!/usr/bin/env python3
"""How near `encode` comes to a bit rate, and what that costs against one quantiser.

  bench/rates.py PROGRAM FILM.y4m... [-- OPTION...]

Codes each film with seven quantisers, and at the rates that three of them come to in one pass and in two. Prints for
each the error of the rate and the PSNR-Y beside the quantisers' at as many bytes, and their means and worst.
"""
import json
import math
import subprocess
import sys
import tempfile
from pathlib import Path

QUANTISERS = (2, 3, 4, 6, 9, 13, 19)
RATES = (3, 6, 13)  # those of these quantisers


def encode(program, film, folder, *options):
    """Bytes, PSNR-Y and seconds of a film."""
    stats = folder / "stats.json"
    subprocess.run([program, "encode", film, "--gop", "15", "--quiet", "-y", "-o", folder / "film.m2v",
                    "--stats", stats, *options], check=True)
    s = json.loads(stats.read_text())
    return s["bytes"], s["psnr_y"], s["frames"] / s["fps"]


def psnr_at(curve, size):
    """PSNR-Y of constant quantisers at a size, straight over its logarithm."""
    for (small, low, _), (large, high, _) in zip(curve[1:], curve):
        if size >= small or (small, low, _) == curve[-1]:
            return low + (high - low) * math.log(size / small) / math.log(large / small)
    raise ValueError("no curve")


def main():
    words = sys.argv[1:]
    if len(words) < 2:
        sys.exit(__doc__)
    cut = words.index("--") if "--" in words else len(words)
    program, films, more = words[0], words[1:cut], words[cut + 1:]
    errors, losses = {1: [], 2: []}, []
    print("| film | rate of quantiser | error, 1 pass | 2 passes | PSNR-Y, 1 pass | 2 passes |\n|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for film in films:
            curve = [encode(program, film, folder, "--quantiser", str(q), *more) for q in QUANTISERS]
            for q in RATES:
                size, _, seconds = curve[QUANTISERS.index(q)]
                error, gain = {}, {}
                for passes in (1, 2):
                    got, psnr, _ = encode(program, film, folder, "--bitrate", str(int(8 * size / seconds)),
                                          "--passes", str(passes), *more)
                    error[passes] = 100 * (got / size - 1)
                    gain[passes] = psnr - psnr_at(curve, got)
                    errors[passes].append(abs(error[passes]))
                losses.append(gain[1] - gain[2])
                print(f"| {Path(film).stem if Path(film).stem != 'frames' else Path(film).parent.name} | {q} "
                      f"| {error[1]:+.2f} % | {error[2]:+.2f} % | {gain[1]:+.2f} dB | {gain[2]:+.2f} dB |", flush=True)
    for passes, all_of in errors.items():
        print(f"{passes} pass: errs by {sum(all_of) / len(all_of):.2f} % in the mean, {max(all_of):.2f} % at most")
    print(f"1 pass against 2: {sum(losses) / len(losses):+.2f} dB in the mean, {min(losses):+.2f} dB at worst")


main()
