"""Fits k = a * scale^b to the lines of bench_coupled: the largest share at which no film of the fit loses what the eye or a metric would miss."""
import json, math, sys

FIT = ["character", "many_lamps"]
LIMITS = {"loss_db": 0.1, "hvsm_loss": 0.1, "ssim_loss": 0.002}

films = {}
for line in open(sys.argv[1]):
    d = json.loads(line)
    if d["tolerance"] not in ("fixed", "default"):
        films.setdefault(d["scene"], {}).setdefault(d["q"], []).append(d)


def monotone(points, key):
    """Points by rising share; losses made to rise with it, since single figures scatter by some hundredths of a dB."""
    points = sorted(points, key=lambda d: float(d["tolerance"]))
    worst, out = -1e9, []
    for d in points:
        worst = max(worst, d[key])
        out.append((float(d["tolerance"]), worst, d["speedup"]))
    return out


def share_at(points, limits):
    """Share and speed-up where the first limit is reached, interpolated over the logarithm of the share; an end of the range where none is."""
    best = None
    for key, limit in limits.items():
        p = monotone(points, key)
        found = p[-1][0], p[-1][2]
        if p[0][1] >= limit:
            found = p[0][0], p[0][2]
        else:
            for (k0, l0, s0), (k1, l1, s1) in zip(p, p[1:]):
                if l1 >= limit:
                    t = (limit - l0) / (l1 - l0)
                    found = math.exp(math.log(k0) + t * math.log(k1 / k0)), s0 + t * (s1 - s0)
                    break
        if best is None or found[0] < best[0]:
            best = found
    return best


def table(limits):
    quantisers = sorted({q for f in films.values() for q in f})
    print("| film | " + " | ".join(f"q = {q}" for q in quantisers) + " | |\n|---|" + "---|" * (len(quantisers) + 1))
    for name, by_q in films.items():
        cells = []
        for q in quantisers:
            cells.append("{:.2f} (x{:.1f})".format(*share_at(by_q[q], limits)) if q in by_q else "-")
        print(f"| {name} | " + " | ".join(cells) + (" | fit |" if name in FIT else " | validation |"))


print("# The share of what coding hides\n")
print("`tests/fits/coupled_share.sh`; every film rendered is a line of [coupled-share.jsonl](coupled-share.jsonl).\n")
print("All against a fixed tolerance of 2 % at the same quantiser and stopping rule, both decoded and held against light without clustering. Share k, and speed-up of gathering there.\n")
print("Where 0.1 dB of PSNR-Y are lost:\n")
table({"loss_db": 0.1})
print("\nWhere 0.1 dB of PSNR-Y, 0.1 dB of PSNR-HVS-M or 0.002 of SSIM are lost, whichever comes first:\n")
table(LIMITS)

# The least of the films at each quantiser, and a power of the scale through them by least squares of logarithms.
points = []
for q in sorted({q for f in films.values() for q in f}):
    shares = [share_at(films[n][q], LIMITS)[0] for n in FIT if n in films and q in films[n]]
    if shares:
        points.append((math.log(q / 8.0), math.log(min(shares))))
n = len(points)
mx, my = sum(p[0] for p in points) / n, sum(p[1] for p in points) / n
b = sum((x - mx) * (y - my) for x, y in points) / sum((x - mx) ** 2 for x, _ in points)
a = math.exp(my - b * mx)
print(f"\nLeast of the films of the fit, by least squares: k = {a:.3f} * s^{b:.3f}, s = q / 8.\n")

print("What this k comes to, interpolated between the shares rendered (loss of PSNR-Y and PSNR-HVS-M in dB, of SSIM, speed-up of gathering):\n")
print("| film | q | k | loss | HVS-M | SSIM | speed-up |\n|---|---|---|---|---|---|---|")
for name, by_q in films.items():
    for q, rows in by_q.items():
        k = a * (q / 8.0) ** b
        rows = sorted(rows, key=lambda d: float(d["tolerance"]))
        ks = [float(d["tolerance"]) for d in rows]
        i = max(0, min(len(ks) - 2, sum(x <= k for x in ks) - 1))
        t = min(1.0, max(0.0, (math.log(k) - math.log(ks[i])) / (math.log(ks[i + 1]) - math.log(ks[i]))))
        at = lambda key: rows[i][key] + t * (rows[i + 1][key] - rows[i][key])
        print(f"| {name} | {q} | {k:.2f} | {at('loss_db'):.3f} | {at('hvsm_loss'):.3f} | {at('ssim_loss'):.4f} | x{at('speedup'):.2f} |")
