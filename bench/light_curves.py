"""Table and picture of bench/light_curves.sh: light_curves.py POINTS OUT.svg."""
import math, sys

names = ("lights", "width", "height", "counting", "photons", "trees", "gathering", "clusters", "rays", "before", "peak")
rows = {"vpls": [], "size": []}
for line in open(sys.argv[1]):
    kind, *values = line.split()
    rows[kind].append(dict(zip(names, map(float, values))))

print("| light points | size | counting, s | photons, s | trees, s | gathering, s | clusters, rays per point | peak, MiB | bytes per light point |")
print("|---|---|---|---|---|---|---|---|---|")
for kind in ("vpls", "size"):
    for d in rows[kind]:
        each = (d["peak"] - d["before"]) * 2**20 / d["lights"]
        print(f"| {d['lights']:,.0f} | {d['width']:.0f}x{d['height']:.0f} | {d['counting']:.2f} | {d['photons']:.2f} | {d['trees']:.2f} | {d['gathering']:.2f} "
              f"| {d['clusters']:.0f}, {d['rays']:.0f} | {d['peak']:.0f} | {each:.0f} |")
many = [d for d in rows["vpls"] if d["lights"] > 5e5]
some = [d for d in rows["vpls"] if 5e3 < d["lights"] < 5e4]
if many and some:
    print(f"\nGathering with {many[-1]['lights']:,.0f} light points takes {many[-1]['gathering'] / some[0]['gathering']:.2f} times as long as with {some[0]['lights']:,.0f}.")


def panel(left, title, xs, curves):
    """One pair of logarithmic axes, 400 wide."""
    wide, high, top = 330, 270, 40
    values = [v for _, _, ys in curves for v in ys if v > 0]
    low_x, high_x = math.log10(min(xs)), math.log10(max(xs))
    low_y, high_y = math.floor(math.log10(min(values))), math.ceil(math.log10(max(values)) + 1e-9)
    x_of = lambda x: left + wide * (math.log10(x) - low_x) / max(high_x - low_x, 1e-9)
    y_of = lambda y: top + high * (high_y - math.log10(y)) / max(high_y - low_y, 1e-9)
    out = [f'<text x="{left}" y="20" font-weight="bold">{title}</text>']
    for e in range(low_y, high_y + 1):
        out.append(f'<path d="M{left} {y_of(10**e):.1f}h{wide}" stroke="#ccc"/><text x="{left - 6}" y="{y_of(10**e) + 4:.1f}" text-anchor="end">{10.0**e:g}</text>')
    for x in xs:
        out.append(f'<text x="{x_of(x):.1f}" y="{top + high + 18}" text-anchor="middle">{x:,.0f}</text>')
    for i, (name, color, ys) in enumerate(curves):
        shown = [(x_of(x), y_of(y)) for x, y in zip(xs, ys) if y > 0]
        path = " ".join(f"{'ML'[k > 0]}{x:.1f} {y:.1f}" for k, (x, y) in enumerate(shown))
        out.append(f'<path d="{path}" fill="none" stroke="{color}" stroke-width="2"/>')
        out += [f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3" fill="{color}"/>' for x, y in shown]
        out.append(f'<text x="{left + 8 + 92 * (i % 4)}" y="{top + high + 40}" fill="{color}">{name}</text>')
    return out


parts = []
colors = {"gathering": "#0b62a4", "photons": "#c0392b", "counting": "#7f8c8d", "trees": "#1e8449"}
for index, (kind, title, x_of) in enumerate((("vpls", "CPU seconds over light points, 256x256", lambda d: d["lights"]),
                                              ("size", "CPU seconds over pixels, 9,000 light points", lambda d: d["width"] * d["height"]))):
    if len(rows[kind]) > 1:
        xs = [x_of(d) for d in rows[kind]]
        parts += panel(60 + 420 * index, title, xs, [(n, c, [d[n] for d in rows[kind]]) for n, c in colors.items()])
with open(sys.argv[2], "w") as svg:
    svg.write('<svg xmlns="http://www.w3.org/2000/svg" width="860" height="360" font-family="sans-serif" font-size="12">'
              '<rect width="860" height="360" fill="white"/>' + "\n".join(parts) + "</svg>\n")
