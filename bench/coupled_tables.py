"""The table bench/tables/coupled_benchmark.csv from lines of bench_coupled: coupled_tables.py FILE..."""
import json, sys

ORDER = ("cornell", "character", "colonnade", "sponza", "sibenik")
films = {}
for name in sys.argv[1:]:
    for line in open(name):
        d = json.loads(line)
        films.setdefault((d["scene"], d["q"]), {})[d["tolerance"]] = d
films = dict(sorted(films.items(), key=lambda f: (ORDER.index(f[0][0]) if f[0][0] in ORDER else len(ORDER), f[0])))


def number(value, error, digits):
    """With its standard error where there is one to see; a single draw has none."""
    return f"{value:.{digits}f}" + (f" ± {error:.{digits}f}" if error >= 0.5 * 10**-digits else "")


print("\nAll films (gathering: after photons and trees; all: with them and first looks; flicker and pumping: beside the fixed film's):\n")
print("| film | quantiser | k | gathering | all | rays | cut / light points | PSNR-Y | SSIM | PSNR-HVS-M | chroma | bytes | over | flicker | pumping |")
print("|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|")
for (scene, q), rows in films.items():
    for k, d in rows.items():
        if k == "fixed":
            continue
        print(f"| {scene} | {q} | {k} | x{d['speedup']:.2f} | x{d['all_speedup']:.2f} | x{d['ray_ratio']:.2f} | {100 * d['cut']:.1f} % | {number(d['loss_db'], d['loss_error'], 3)} | {d['ssim_loss']:.4f} "
              f"| {number(d['hvsm_loss'], d['hvsm_error'], 3)} | {d['chroma_loss']:.3f} | x{number(d['bytes_ratio'], d['bytes_error'], 3)} | {100 * d['over']:.2f} % "
              f"| {number(d['flicker'], d['flicker_error'], 3)} ({d['fixed_flicker']:.3f}) | {number(d['pumping'], d['pumping_error'], 3)} ({d['fixed_pumping']:.3f}) |")

print("\nThe default, over all films and quantisers: mean, and the worst of which film.\n")
print("| measure | mean | worst |")
print("|---|---|---|")
measures = (("PSNR-Y", "loss_db", 3), ("SSIM", "ssim_loss", 4), ("PSNR-HVS-M", "hvsm_loss", 3), ("bytes", "bytes_ratio", 4), ("over, %", "over", 2))
defaults = [rows["default"] for rows in films.values() if "default" in rows]
for d in defaults:
    d["flicker_above"] = d["flicker"] - d["fixed_flicker"]
    d["pumping_above"] = d["pumping"] - d["fixed_pumping"]
for label, key, digits in measures + (("flicker above the fixed film's", "flicker_above", 3), ("pumping above the fixed film's", "pumping_above", 3)):
    scale = 100 if key == "over" else 1
    worst = max(defaults, key=lambda d: d[key])
    print(f"| {label} | {scale * sum(d[key] for d in defaults) / len(defaults):.{digits}f} | {scale * worst[key]:.{digits}f} ({worst['scene']} at {worst['q']}) |")

losses = (0.05, 0.1, 0.2, 0.5, 1.0)
print("\nGathering, and rays, at a loss of PSNR-Y, interpolated between the shares; `>`: no share lost as much, at the largest:\n")
print("| film | quantiser | " + " | ".join(f"{l} dB" for l in losses) + " |\n|---|---|" + "---|" * len(losses))
for (scene, q), rows in films.items():
    shares = sorted((0.25 if k == "default" else float(k), d) for k, d in rows.items() if k != "fixed")
    points, worst = [(0.0, 1.0, 1.0)], 0.0
    for _, d in shares:
        worst = max(worst, d["loss_db"])
        points.append((worst, max(points[-1][1], d["speedup"]), max(points[-1][2], d["ray_ratio"])))
    cells = []
    for loss in losses:
        cell = f"> x{points[-1][1]:.2f}, x{points[-1][2]:.2f}"
        for (l0, s0, r0), (l1, s1, r1) in zip(points, points[1:]):
            if l0 <= loss <= l1 and l1 > l0:
                t = (loss - l0) / (l1 - l0)
                cell = f"x{s0 + t * (s1 - s0):.2f}, x{r0 + t * (r1 - r0):.2f}"
                break
        cells.append(cell)
    print(f"| {scene} | {q} | " + " | ".join(cells) + " |")
