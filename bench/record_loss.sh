#!/usr/bin/env bash
# bench/record_loss.sh SCENES_FOLDER [-d SIDE] [-f FRAMES] [FILM...]
# What light that is kept in records costs of quality where the camera walks: PSNR-Y, flicker and bytes of films with --cache on
# against --cache off, by 2 % and coupled, at quantisers 4, 8 and 16, held against pixels of nine samples each, which are lit each for itself
# ("nine"), and against light at the pixels' middles ("middle"); four samples a pixel. SCENES_FOLDER as for real_scenes.sh; films sponza,
# sibenik. Needs ffmpeg.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
. "$here/real_scenes/lay_out_film.sh"
program=${RENDER2MPEG:-$here/../build/release/render2mpeg}
scenes=$1
shift
side=160 frames=9
while [[ ${1:-} == -[df] ]]; do
    if [ "$1" = -d ]; then side=$2; else frames=$2; fi
    shift 2
done
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

render() { # FILM OUTPUT SIDE SAMPLES [render options...]
    "$program" render -y --hold "$work/$1" -o "$2" --size "$3x$3" --samples "$4" --vpls 9000 --exposure 0 --frames "0:$((frames - 1))" --quiet "${@:5}"
}

echo '| film | tolerance | quantiser | loss, nine | loss, middle | flicker, nine | flicker, middle | bytes |'
echo '|---|---|---|---|---|---|---|---|'
[ $# -gt 0 ] || set -- sponza sibenik
for film in "$@"; do
    lay_out_film "$film" "$scenes" "$work"
    mkdir "$work/$film.nine" "$work/$film.middle"
    render "$film" "$work/$film.nine/f.%04d.exr" $((3 * side)) 1 --tolerance fixed=1% --cache off
    render "$film" "$work/$film.middle/f.%04d.exr" "$side" 4 --tolerance fixed=1% --cache off
    for cache in off on; do
        render "$film" "$work/$cache.y4m" "$side" 4 --tolerance fixed=2% --cache "$cache"
        for q in 4 8 16; do
            "$program" encode -y "$work/$cache.y4m" -o "$work/$film.fixed.$q.$cache.m2v" --quantiser "$q" --quiet
            render "$film" "$work/$film.coupled.$q.$cache.m2v" "$side" 4 --tolerance coupled --quantiser "$q" --cache "$cache"
        done
    done
    python3 "$here/record_loss.py" "$work" "$film" "$side"
done
