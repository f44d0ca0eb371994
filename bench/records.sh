#!/usr/bin/env bash
# bench/records.sh SCENES_FOLDER [-d SIZE] [-f FRAMES] [-o FRAMES_OFF] [-c FILM]... [-t TOLERANCE]... [render options...]
# What records are worth where the camera walks, runs, a lamp moves, a box moves, a body deforms: CPU seconds of light of the first
# frame (choice of light points included) and of a later one, and of a chunk of 48, --cache off over on; million shadow rays of a later
# frame; the share of audited pixels beyond their tolerance. Coupled at quantiser 8 and at 2 %, or TOLERANCEs alone; all films, or
# FILMs alone; 9,000 light points, 4,096 for films of animations/. Both runs of a pair go at once, one thread each, so that a busy
# machine slows both: ratios are what to read. FRAMES (6; 2 at least) with records, FRAMES_OFF (as many) without. Further options go
# to every render, e.g. --audit 200. SCENES_FOLDER as for real_scenes.sh.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
. "$here/real_scenes/lay_out_film.sh"
program=${RENDER2MPEG:-$here/../build/release/render2mpeg}
scenes=$1
shift
size=160x160 frames=6 frames_off='' films=() tolerances=()
while [[ ${1:-} == -[dfoct] ]]; do
    case $1 in
        -d) size=$2 ;;
        -f) frames=$2 ;;
        -o) frames_off=$2 ;;
        -c) films+=("$2") ;;
        -t) tolerances+=("$2") ;;
    esac
    shift 2
done
[ ${#films[@]} -gt 0 ] || films=(sponza sibenik bathroom sponza_pan sponza_lamp sponza_box character cornell)
[ ${#tolerances[@]} -gt 0 ] || tolerances=(coupled fixed=2%)
work=$(mktemp -d)
other=''
trap '[ -z "$other" ] || kill "$other" 2>/dev/null || true; rm -rf "$work"' EXIT

render() { # CACHE FRAMES INPUT VPLS TOLERANCE [render options...]
    exec "$program" render -y --hold "$3" -o "$work/$1.m2v" --size "$size" --frames "0:$(($2 - 1))" --samples 1 --vpls "$4" --exposure 0 --threads 1 \
        --tolerance "$5" --quantiser 8 --cache "$1" --quiet --stats "$work/$1.json" "${@:6}"
}

echo '| film | tolerance | first frame off, on | later off, on | chunk, off over on | later, off over on | million rays of a later frame | beyond |'
echo '|---|---|---|---|---|---|---|---|'
for film in "${films[@]}"; do
    input=$work/$film vpls=9000
    if [ -d "$here/../animations/$film" ]; then
        input=$here/../animations/$film vpls=4096
    else
        lay_out_film "$film" "$scenes" "$work" || { echo "records.sh: no scene for $film in $scenes" >&2 && exit 1; }
    fi
    for tolerance in "${tolerances[@]}"; do
        render off "${frames_off:-$frames}" "$input" "$vpls" "$tolerance" "$@" &
        other=$!
        (render on "$frames" "$input" "$vpls" "$tolerance" "$@")
        wait "$other"
        other=''
        row=$(python3 "$here/records.py" "$work/off.json" "$work/on.json")
        echo "| $film | $tolerance | $row"
    done
done
