"""The tables of tests/bench/coupled.sh from the lines of bench_coupled."""
import json, math, sys

films = {}
for line in open(sys.argv[1]):
    d = json.loads(line)
    films.setdefault((d["scene"], d["q"]), {})[d["tolerance"]] = d

print("\nThe default, and k = 1:\n")
print("| film | q | k | speed-up | cut / light points | loss, PSNR-Y dB | SSIM | PSNR-HVS-M dB | bytes | over tolerance | flicker (fixed) | eye, ms | first looks |")
print("|---|---|---|---|---|---|---|---|---|---|---|---|---|")
for (scene, q), rows in films.items():
    for k in ("default", "1"):
        if k not in rows:
            continue
        d = rows[k]
        print(f"| {scene} | {q} | {k} | x{d['speedup']:.2f} | {100 * d['cut']:.1f} % | {d['loss_db']:.3f} | {d['ssim_loss']:.4f} | {d['hvsm_loss']:.3f} "
              f"| x{d['bytes_ratio']:.3f} | {100 * d['over']:.2f} % | {d['flicker']:.3f} ({d['fixed_flicker']:.3f}) | {d['tolerate_ms']:.1f} | {100 * d['preview_share']:.1f} % |")

losses = (0.05, 0.1, 0.2, 0.5, 1.0)
print("\nSpeed-up of gathering at a loss of PSNR-Y, interpolated between the shares; '-' where no share lost as much:\n")
print("| film | q | " + " | ".join(f"{l} dB" for l in losses) + " |\n|---|---|" + "---|" * len(losses))
for (scene, q), rows in films.items():
    shares = sorted((float(k), d) for k, d in rows.items() if k not in ("fixed", "default"))
    points, worst = [(0.0, 1.0)], 0.0
    for _, d in shares:
        worst = max(worst, d["loss_db"])
        points.append((worst, max(points[-1][1], d["speedup"])))
    cells = []
    for loss in losses:
        cell = "-"
        for (l0, s0), (l1, s1) in zip(points, points[1:]):
            if l0 <= loss <= l1 and l1 > l0:
                cell = f"x{s0 + (loss - l0) / (l1 - l0) * (s1 - s0):.2f}"
        cells.append(cell)
    print(f"| {scene} | {q} | " + " | ".join(cells) + " |")
