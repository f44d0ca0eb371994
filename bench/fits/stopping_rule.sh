#!/usr/bin/env bash
# bench/fits/stopping_rule.sh [SCENES_FOLDER] > tables.md
# The fit of the stopping rule (docs/measurements.md#stopping-rule): measures our animations and, where SCENES_FOLDER (as for
# bench/real_scenes.sh) is given, real scenes; writes bench/fits/stopping-rule.csv and prints the tables. Build first:
# cmake --preset release -DRENDER2MPEG_BENCH=ON && cmake --build build/release --target fit_stopping_rule
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
root=$here/../..
. "$root/bench/real_scenes/lay_out_film.sh"
program=${FIT_STOPPING_RULE:-$root/build/release/fit_stopping_rule}
subjects=()
for name in cornell colonnade still_room; do subjects+=("$name=$root/animations/$name"); done
if [ $# -ge 1 ]; then
    work=$(mktemp -d)
    trap 'rm -rf "$work"' EXIT
    for name in sponza sibenik bathroom; do
        lay_out_film "$name" "$1" "$work"
        apart=
        [ "$name" = bathroom ] && apart=:apart
        subjects+=("$name=$work/$name$apart")
    done
    subjects+=("cornell_box=$1/cornell/gltf/CornellBox.glb:apart")
fi
for name in many_lamps character mirror_and_glass flash_cut; do subjects+=("$name=$root/animations/$name:apart"); done
"$program" "$root/bench/fits/stopping-rule.csv" "${subjects[@]}"
