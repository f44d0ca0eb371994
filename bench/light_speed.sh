#!/usr/bin/env bash
# bench/light_speed.sh SCENES_FOLDER [render options...]
# What the light of one frame costs, as the table in the README: CPU seconds of one thread by tolerance, for each
# film of bench/real_scenes and animations/cornell. Further options go to every render.
# SCENES_FOLDER holds sponza_dabrovic/, sibenik/ and bathroom/ (see README, "Speed").
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
. "$here/real_scenes/lay_out_film.sh"
program=${RENDER2MPEG:-$here/../build/release/render2mpeg}
scenes=$1
shift
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

rows() { # NAME INPUT
    local tolerance
    for tolerance in 2% 13%; do
        "$program" render -y --hold "$2" -o "$work/film.y4m" --frames 0:0 --size 512x512 --samples 1 --vpls 9000 --exposure 0 --threads 1 \
            --tolerance "fixed=$tolerance" --quiet --stats "$work/stats.json" "${@:3}"
        python3 - "$1" "$tolerance" "$work/stats.json" <<'PY'
import json, sys
name, tolerance, file = sys.argv[1:]
s = json.load(open(file))
p, points = s["passes"], max(1, s["counts"]["gather_points"])
error_scale = s["counts"]["calibration_seconds"]
cut = sum(s["mean_cut"].values())
print(f'| {name} | {tolerance[:-1]} % | {cut:.0f}, {s["counts"]["shadow_rays"] / points:.0f} '
      f'| {p.get("direct light tree", 0) + p.get("indirect light tree", 0) - error_scale:.2f} | {error_scale:.2f} | {p.get("photons", 0):.2f} |')
PY
    done
}

echo '| scene | tolerance | mean cut, rays per point | light | error_scale | photons |'
echo '|---|---|---|---|---|---|'
for name in sponza sibenik bathroom; do
    lay_out_film "$name" "$scenes" "$work"
    rows "$name" "$work/$name" "$@"
done
rows "animations/cornell" "$here/../animations/cornell" "$@"
