#!/usr/bin/env python3
"""bench/fits/error_scale_tail.py NEEDS [SCALE]

How well a few pixels tell what a share of 0.005 of all exceeds (docs/measurements.md#error-scale, "Few pixels"). NEEDS is what
fit_error_calibration writes beside its table: what each pixel needs, by scene and tolerance; SCALE those lit with it, 0.5. From each
row samples are drawn, and the error_scale that they ask for is held against the whole row."""
import bisect
import math
import random
import sys

AIMED, PROMISED, TAIL, LEAST_TAIL, MARGIN, DRAWS = 0.005, 0.01, 0.05, 12, 64, 300


def place(falling, share):
    """The ceil((n + 1)(1 - share))-th smallest."""
    n = len(falling)
    return falling[n - min(n, math.ceil((n + 1) * (1 - share)))]


def tail(falling):
    """What AIMED exceeds, if the largest are the tail of an exponential."""
    n = len(falling)
    m = max(LEAST_TAIL, int(TAIL * n))
    excess = sum(r - falling[m] for r in falling[:m]) / m
    return falling[m] + excess * math.log(m / (AIMED * n))


def learnt(falling):
    """As error_scale.cpp has it."""
    return max(tail(falling) * (1 + MARGIN / len(falling)), place(falling, PROMISED))


def twice(falling):
    """Every pixel counted twice, as when both rounds lit the same ones."""
    doubled = sorted(falling + falling, reverse=True)
    return place(doubled, AIMED) * (1 + MARGIN / len(doubled))


def main():
    error_scale = float(sys.argv[2]) if len(sys.argv) > 2 else 0.5
    rows = []
    for line in open(sys.argv[1]):
        words = line.split(",")
        if float(words[2]) == error_scale:
            rows.append(sorted(float(w) for w in words[3:]))
    dice = random.Random(1)
    print("| pixels | rule | scatter of c | c over the least that keeps 0.5 % | beyond, mean; worst row | samples with over 1 %, mean; worst row |")
    print("|---|---|---|---|---|---|")
    rules = [("place", lambda s: place(s, AIMED)), ("place, twice, 64/2n", twice), ("tail", tail), ("tail, 64/n", learnt)]
    for n in (128, 256, 512, 1024):
        drawn = [[sorted(dice.sample(row, n), reverse=True) for _ in range(DRAWS)] for row in rows]
        for name, rule in rules:
            scatter, ratio, beyond, broken = [], [], [], []
            for row, samples in zip(rows, drawn):
                least = row[min(len(row) - 1, int((1 - AIMED) * len(row)))]
                logs = [math.log(rule(s) / least) for s in samples]
                mean = sum(logs) / DRAWS
                over = [1 - bisect.bisect_right(row, least * math.exp(x)) / len(row) for x in logs]
                scatter.append(math.sqrt(sum((x - mean) ** 2 for x in logs) / DRAWS))
                ratio.append(mean)
                beyond.append(sum(over) / DRAWS)
                broken.append(sum(x > PROMISED for x in over) / DRAWS)
            k = len(rows)
            print(f"| {n} | {name} | {100 * sum(scatter) / k:.1f} % | {math.exp(sum(ratio) / k):.2f} | "
                  f"{100 * sum(beyond) / k:.2f} %; {100 * max(beyond):.2f} % | {100 * sum(broken) / k:.1f} %; {100 * max(broken):.1f} % |")


if __name__ == "__main__":
    main()
