#!/usr/bin/env bash
# tests/bench/records.sh SCENES_FOLDER [-d SIZE] [-f FRAMES] [render options...]
# What records are worth where the camera walks, runs, a lamp moves, a box moves, a body deforms: CPU seconds of shading and shadow
# rays of later frames, --cache off and on in turn, coupled at quantiser 8 and at 2 %, and the share of audited pixels beyond their
# tolerance. Further options go to every render, e.g. --audit 200. SCENES_FOLDER as for real_scenes.sh.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
. "$here/real_scenes/lay_out_film.sh"
program=${RENDER2MPEG:-$here/../../build/release/render2mpeg}
scenes=$1
shift
size=160x160 frames=6
while [[ ${1:-} == -[df] ]]; do
    if [ "$1" = -d ]; then size=$2; else frames=$2; fi
    shift 2
done
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

render() { # OUT INPUT [render options...]
    "$program" render "$2" -o "$work/film.m2v" --size "$size" --frames "0:$((frames - 1))" --samples 1 --vpls 9000 --exposure 0 --threads 1 --quiet --stats "$work/$1.json" "${@:3}"
}

rows() { # NAME INPUT
    local tolerance
    for tolerance in coupled fixed=2%; do
        render off "$2" --tolerance "$tolerance" --quantiser 8 --cache off "${@:3}"
        render on "$2" --tolerance "$tolerance" --quantiser 8 --cache on "${@:3}"
        python3 - "$1" "$tolerance" "$work" <<'PY'
import json, sys
name, tolerance, work = sys.argv[1:]
off, on = (json.load(open(f'{work}/{c}.json')) for c in ('off', 'on'))
later = lambda s: sum(f['shadow_rays'] for f in s['per_frame'][1:]) / 1e6
beyond = lambda s: f"{100 * s['audit']['over_tolerance']:.2f} %" if s.get('audit') else '-'
print(f"| {name} | {tolerance} | {off['seconds']['shade']:.2f}, {on['seconds']['shade']:.2f} | {off['seconds']['shade'] / on['seconds']['shade']:.2f} "
      f"| {later(off):.2f}, {later(on):.2f} | {later(off) / max(later(on), 1e-6):.2f} | {beyond(off)}, {beyond(on)} |")
PY
    done
}

echo '| film | tolerance | shade off, on | ratio | million rays of later frames | ratio | beyond |'
echo '|---|---|---|---|---|---|---|'
for name in sponza sibenik sponza_pan sponza_lamp sponza_box bathroom; do
    lay_out_film "$name" "$scenes" "$work" || continue
    rows "$name" "$work/$name" "$@"
done
for name in character cornell; do rows "$name" "$here/../../animations/$name" "$@"; done
