#!/usr/bin/env bash
# bench/real_scenes.sh SCENES_FOLDER [render options...]
# Seconds per frame for real scenes, as the table in the README: each film of bench/real_scenes and each scene with a camera
# of its own, its first four frames, one row each. Further options go to every render, e.g. --tolerance fixed=8%.
# SCENES_FOLDER holds sponza_dabrovic/, sibenik/, bathroom/ and cornell/ (see README, "Speed").
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
. "$here/real_scenes/lay_out_film.sh"
program=${RENDER2MPEG:-$here/../build/release/render2mpeg}
scenes=$1
shift
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

[[ " $* " == *" --tolerance"* ]] || set -- "$@" --tolerance fixed=2%
[[ " $* " == *" --cache"* ]] || set -- "$@" --cache off

row() { # NAME INPUT
    "$program" render -y --hold "$2" -o "$work/film.mpg" --frames 0:3 --size 512x512 --samples 1 --vpls 9000 --exposure 0 --quiet --stats "$work/stats.json" "${@:3}"
    python3 - "$1" "$work/stats.json" <<'PY'
import json, sys
name, file = sys.argv[1:]
s = json.load(open(file))
n, t = s["frames"], s["seconds"]
per = lambda key: t[key] / n
print(f'| {name} | {s["counts"]["direct_points"]} + {s["counts"]["indirect_points"]} | {s["mean_cut"]["direct"]:.0f} + {s["mean_cut"]["indirect"]:.0f} '
      f'| {per("see"):.2f} | {per("shade"):.2f} | {per("develop") + per("encode"):.3f} | {100 * s["counts"]["capped_points"] / max(1, s["counts"]["gather_points"]):.1f} % |')
PY
}

echo '| scene | light points, direct + indirect | mean cut | see | shade | develop, encode | capped |'
echo '|---|---|---|---|---|---|---|'
for name in sponza sibenik bathroom; do
    lay_out_film "$name" "$scenes" "$work"
    row "$name" "$work/$name" "$@"
done
row "Cornell box" "$scenes/cornell/gltf/CornellBox.glb" "$@"
row "animations/cornell" "$here/../animations/cornell" "$@"
