#!/usr/bin/env bash
# bench/beside_cycles.sh OUT_FOLDER [-m SCENES_FOLDER] [-s CYCLES_SAMPLES] [-v VPLS] [-t TOLERANCE] [-d WxH] [NAME...]
# Light held against Blender's Cycles: renders each scene of beside_cycles/scenes.py (or those named) with both, prints a row
# per scene and writes OUT_FOLDER/NAME.png: ours, Cycles, eight times their difference. What columns mean: compare.py. Scenes
# check_* are rows of their own: both renderers over a closed form. SCENES_FOLDER holds sponza_dabrovic/, sibenik/, bathroom/,
# cornell/ and godot_gi/; without it only own scenes are rendered. Needs Blender 3.4 with Cycles. OUT_FOLDER lies outside of
# the tree; what is there already is rendered anew.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
program=${RENDER2MPEG:-$here/../build/release/render2mpeg}
out=$1
shift
models=() samples=256 vpls=16384 tolerance=reference size=192x128
while getopts m:s:v:t:d: option; do
    case $option in
    m) models=(--models "$OPTARG") ;;
    s) samples=$OPTARG ;;
    v) vpls=$OPTARG ;;
    t) tolerance=$OPTARG ;;
    d) size=$OPTARG ;;
    *) exit 1 ;;
    esac
done
shift $((OPTIND - 1))
blender() { (cd "$out" && command blender -b -noaudio --factory-startup --python-exit-code 1 -P "$@"); }

mkdir -p "$out"
out=$(cd "$out" && pwd)
for name in $(python3 "$here/beside_cycles/scenes.py" "${models[@]}" "$out" "$@"); do
    folder=$out/$name
    pixels=$size
    [[ $name != check_* ]] || pixels=16x16
    # What the program refuses is a row too.
    if ! { TIMEFORMAT=%U && time "$program" render -y --hold "$folder" -o "$folder/ours%04d.exr" --tolerance "$tolerance" --vpls "$vpls" \
        --samples 64 --cache off --size "$pixels" --frames 0:0 --exposure 0 --quiet 2> "$folder/ours.log"; } 2> "$folder/ours_seconds"; then
        echo "| $name | refused: $(head -1 "$folder/ours.log") |"
        continue
    fi
    mv "$folder/ours0000.exr" "$folder/ours.exr"
    blender "$here/beside_cycles/cycles.py" -- "$folder" "$samples" ${pixels/x/ } > "$folder/cycles.log" 2>&1
    blender "$here/beside_cycles/compare.py" -- "$folder" "$out/$name.png" | sed -n 's/^ROW //p'
done
