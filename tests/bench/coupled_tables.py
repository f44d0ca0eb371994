"""The tables of tests/bench/coupled.sh from the lines of bench_coupled."""
import json, sys

films = {}
for name in sys.argv[1:]:
    for line in open(name):
        d = json.loads(line)
        films.setdefault((d["scene"], d["q"]), {})[d["tolerance"]] = d

print("\nThe default, and k = 1 (gathering: after photons and trees; all: with them and first looks; flicker and pumping: beside the fixed film's):\n")
print("| film | q | k | gathering | all | rays | cut / light points | loss, PSNR-Y dB | SSIM | PSNR-HVS-M dB | chroma dB | bytes | over tolerance | flicker | pumping | eye, ms | first looks |")
print("|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|")
for (scene, q), rows in films.items():
    for k in ("default", "1"):
        if k not in rows:
            continue
        d = rows[k]
        print(f"| {scene} | {q} | {k} | x{d['speedup']:.2f} | x{d['all_speedup']:.2f} | x{d['ray_ratio']:.2f} | {100 * d['cut']:.1f} % | {d['loss_db']:.3f} | {d['ssim_loss']:.4f} "
              f"| {d['hvsm_loss']:.3f} | {d['chroma_loss']:.3f} | x{d['bytes_ratio']:.3f} | {100 * d['over']:.2f} % | {d['flicker']:.3f} ({d['fixed_flicker']:.3f}) "
              f"| {d['pumping']:.3f} ({d['fixed_pumping']:.3f}) | {d['tolerate_ms']:.1f} | {100 * d['preview_share']:.1f} % |")

losses = (0.05, 0.1, 0.2, 0.5, 1.0)
print("\nGathering, and rays, at a loss of PSNR-Y, interpolated between the shares; '> ' where no share lost as much, at the largest:\n")
print("| film | q | " + " | ".join(f"{l} dB" for l in losses) + " |\n|---|---|" + "---|" * len(losses))
for (scene, q), rows in films.items():
    shares = sorted((0.25 if k == "default" else float(k), d) for k, d in rows.items() if k != "fixed")
    points, worst = [(0.0, 1.0, 1.0)], 0.0
    for _, d in shares:
        worst = max(worst, d["loss_db"])
        points.append((worst, max(points[-1][1], d["speedup"]), max(points[-1][2], d["ray_ratio"])))
    cells = []
    for loss in losses:
        cell = f"> x{points[-1][1]:.1f}, x{points[-1][2]:.1f}"
        for (l0, s0, r0), (l1, s1, r1) in zip(points, points[1:]):
            if l0 <= loss <= l1 and l1 > l0:
                t = (loss - l0) / (l1 - l0)
                cell = f"x{s0 + t * (s1 - s0):.2f}, x{r0 + t * (r1 - r0):.2f}"
                break
        cells.append(cell)
    print(f"| {scene} | {q} | " + " | ".join(cells) + " |")
