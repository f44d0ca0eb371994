"""Fits the default share k to the lines of bench_coupled: where a film loses what the eye or a metric would miss.

For each film and quantiser it is only known between which two of the shares rendered the first limit is crossed, or that it lies beyond them. So
log k is fitted to intervals, open ones included, by greatest likelihood under a normal scatter (interval regression, as a tobit).

    coupled_share.py DATA.jsonl

prints what it finds (docs/measurements.md#tolerance-fraction).
"""
import io, json, math, sys

LIMITS = {"loss_db": 0.1, "hvsm_loss": 0.1, "ssim_loss": 0.002}
NAMES = {"loss_db": "PSNR-Y", "hvsm_loss": "PSNR-HVS-M", "ssim_loss": "SSIM"}

films, fixed = {}, {}
for line in open(sys.argv[1]):
    d = json.loads(line)
    if d["tolerance"] == "fixed":
        fixed[d["scene"], d["q"]] = d
    elif d["tolerance"] != "default":
        films.setdefault(d["scene"], {}).setdefault(d["q"], []).append(d)
for by_q in films.values():
    for rows in by_q.values():
        rows.sort(key=lambda d: float(d["tolerance"]))


def isotonic(values):
    """The rising sequence nearest to the values: single losses scatter by some hundredths of a dB."""
    blocks = []
    for v in values:
        blocks.append([v, 1])
        while len(blocks) > 1 and blocks[-2][0] > blocks[-1][0]:
            v2, n2 = blocks.pop()
            v1, n1 = blocks.pop()
            blocks.append([(v1 * n1 + v2 * n2) / (n1 + n2), n1 + n2])
    return [v for v, n in blocks for _ in range(n)]


def crossing(rows, limits):
    """Between which shares the first limit is crossed, and about where; (None, k) and (k, None) beyond the ends."""
    shares = [float(d["tolerance"]) for d in rows]
    best = None
    for key, limit in limits.items():
        losses = isotonic([d[key] for d in rows])
        if losses[0] >= limit:
            found = (None, shares[0], shares[0])
        elif losses[-1] < limit:
            found = (shares[-1], None, shares[-1])
        else:
            i = next(i for i in range(len(losses)) if losses[i] >= limit)
            t = (limit - losses[i - 1]) / (losses[i] - losses[i - 1])
            found = (shares[i - 1], shares[i], math.exp(math.log(shares[i - 1]) + t * math.log(shares[i] / shares[i - 1])))
        if best is None or found[2] < best[2]:
            best = found
    return best


def at(rows, k, key):
    """A figure of the films rendered, linear over the logarithm of the share, beyond the first down to 0 at share 0."""
    shares = [float(d["tolerance"]) for d in rows]
    i = max(0, min(len(rows) - 2, sum(s <= k for s in shares) - 1))
    t = min(1.0, max(0.0, math.log(k / shares[i]) / math.log(shares[i + 1] / shares[i])))
    return rows[i][key] + t * (rows[i + 1][key] - rows[i][key])


def phi(x):
    return 0.5 * math.erfc(-x / math.sqrt(2))


def likelihood(points, coefficients, sigma):
    total = 0.0
    for lo, hi, xs in points:
        mean = sum(c * x for c, x in zip(coefficients, xs))
        upper = 1.0 if hi is None else phi((math.log(hi) - mean) / sigma)
        lower = 0.0 if lo is None else phi((math.log(lo) - mean) / sigma)
        total += math.log(max(upper - lower, 1e-12))
    return total


def fit(points):
    """Coefficients and scatter of greatest likelihood, by a search that halves its steps."""
    size = len(points[0][2])
    best = [math.log(0.5)] + [0.0] * (size - 1) + [math.log(0.3)]
    value = lambda p: likelihood(points, p[:size], max(math.exp(p[size]), 0.05))
    top, step = value(best), 0.5
    while step > 1e-4:
        moved = False
        for i in range(size + 1):
            for sign in (1, -1):
                p = list(best)
                p[i] += sign * step
                v = value(p)
                if v > top + 1e-12:
                    best, top, moved = p, v, True
        if not moved:
            step /= 2
    return best[:size], max(math.exp(best[size]), 0.05), top


def points_of(names, limits, variables):
    out = []
    for n in names:
        for q, rows in films[n].items():
            lo, hi, _ = crossing(rows, limits)
            out.append((lo, hi, [1.0] + [v(n, q) for v in variables]))
    return out


coding_rms = lambda n, q: 255 / 10 ** (fixed[n, q]["psnr_y"] / 20)
log_scale = lambda n, q: math.log(q / 8)
VARIABLES = {
    "nothing": [],
    "log q": [log_scale],
    "log q, log of the coding error over q": [log_scale, lambda n, q: math.log(coding_rms(n, q) / q)],
    "log q, log of what is tolerated at k = 1 over q": [log_scale, lambda n, q: math.log(at(films[n][q], 1.0, "tol_luma") / q)],
    "log q, log of the coding error over what is tolerated": [log_scale, lambda n, q: math.log(coding_rms(n, q) / at(films[n][q], 1.0, "tol_luma"))],
    "log q, log of the error scale": [log_scale, lambda n, q: math.log(fixed[n, q]["error_scale"])],
    "log q, log of bytes": [log_scale, lambda n, q: math.log(fixed[n, q]["kbytes"])],
}
names = list(films)


def table(limits):
    quantisers = sorted({q for f in films.values() for q in f})
    say("| film | " + " | ".join(f"q = {q}" for q in quantisers) + " |\n|---|" + "---|" * len(quantisers))
    for n, by_q in films.items():
        cells = []
        for q in quantisers:
            if q not in by_q:
                cells.append("-")
                continue
            lo, hi, k = crossing(by_q[q], limits)
            mark = "<= " if lo is None else ">= " if hi is None else ""
            cells.append(f"{mark}{k:.2f} (x{at(by_q[q], k, 'speedup'):.1f}, x{at(by_q[q], k, 'ray_ratio'):.1f})")
        say(f"| {n} | " + " | ".join(cells) + " |")


def smoothed(rows, k, key):
    """A loss at share k by the rising sequence nearest to what was measured, from 0 at share 0."""
    shares = [0.0] + [float(d["tolerance"]) for d in rows]
    losses = [0.0] + [max(0.0, loss) for loss in isotonic([d[key] for d in rows])]
    i = max(0, min(len(rows) - 1, sum(s <= k for s in shares) - 1))
    return losses[i] + min(1.0, (k - shares[i]) / (shares[i + 1] - shares[i])) * (losses[i + 1] - losses[i])


def largest_share(of):
    """The largest share, in hundredths, at which none of these films loses more than the limits at any quantiser."""
    k = 0.0
    while k < 0.7 and all(smoothed(rows, k + 0.01, key) <= limit for n in of for rows in films[n].values() for key, limit in LIMITS.items()):
        k += 0.01
    return round(k, 2)


out = io.StringIO()


def say(text=""):
    print(text, file=out)


say("$k$ at which a film first loses 0.1 dB of PSNR-Y, 0.1 dB of PSNR-HVS-M or 0.002 of SSIM (factor of CPU time of\ngathering, of rays):\n")
table(LIMITS)
alone = [crossing(rows, {"loss_db": 0.1}) for f in films.values() for rows in f.values()]
say(f"\nPSNR-Y alone would allow {min(k for _, _, k in alone):.2f} and more. By losses smoothed to rise with $k$, no film loses more than these limits up\n"
    f"to $k = {largest_share(names):.2f}$.\n")

say("A fraction that falls with the quantiser gains nothing ($s = q / 8$; means over all films; *within*: films and\nquantisers within 0.1 dB of PSNR-HVS-M):\n")
say("| k | PSNR-Y, dB | PSNR-HVS-M: mean, largest, within | rays |\n|---|---|---|---|")
every = [(q, rows) for f in films.values() for q, rows in f.items()]
for a, b in ((0.2, 0.0), (0.25, 0.0), (0.3, 0.0), (0.36, 0.0), (0.25, -0.18), (0.3, -0.18)):
    of = lambda key: [at(rows, a * (q / 8) ** b, key) for q, rows in every]
    hvs, rays = of("hvsm_loss"), of("ray_ratio")
    say(f"| {a:.2f}" + (f" s^{b}" if b else "") + f" | {sum(of('loss_db')) / len(every):.3f} | {sum(hvs) / len(hvs):.3f}, {max(hvs):.2f}, {sum(h <= 0.1 for h in hvs)} of {len(hvs)} "
        f"| x{math.exp(sum(map(math.log, rays)) / len(rays)):.2f} |")

say("\nWhat explains $k$ (scatter of $\\log k$; log likelihood; that of films left out):\n")
say("| by | scatter | likelihood | left out |\n|---|---|---|---|")
for label, variables in VARIABLES.items():
    _, sigma, top = fit(points_of(names, LIMITS, variables))
    apart = 0.0
    for n in names:
        c, s, _ = fit(points_of([m for m in names if m != n], LIMITS, variables))
        apart += likelihood(points_of([n], LIMITS, variables), c, s)
    say(f"| {label} | {sigma:.2f} | {top:.1f} | {apart:.1f} |")

say("\nWhat the largest $k$ of all *other* films comes to (losses with the larger of their standard errors):\n")
say("| film | q | k | PSNR-Y, dB | PSNR-HVS-M, dB | SSIM | rays | beyond tolerance | flicker |\n|---|---|---|---|---|---|---|---|---|")
sums = {key: [] for key in LIMITS}
for n, by_q in films.items():
    k = largest_share([m for m in names if m != n])
    for q, rows in by_q.items():
        v = lambda key: at(rows, k, key)
        near = sorted(rows, key=lambda d: abs(math.log(float(d["tolerance"]) / k)))[:2]
        error = lambda key: max(d[key] for d in near)
        for key in LIMITS:
            sums[key].append(v(key))
        say(f"| {n} | {q} | {k:.2f} | {v('loss_db'):.3f} ± {error('loss_error'):.3f} | {v('hvsm_loss'):.3f} ± {error('hvsm_error'):.3f} | {v('ssim_loss'):.4f} "
            f"| x{v('ray_ratio'):.2f} | {100 * v('over'):.2f} % | {v('flicker') - v('fixed_flicker'):+.3f} |")
say("\nMean, and how many are within their limit: " +
    "; ".join(f"{NAMES[key]} {sum(x) / len(x):.4f}, {sum(y <= LIMITS[key] for y in x)} of {len(x)}" for key, x in sums.items()) + ".")

print(out.getvalue())
