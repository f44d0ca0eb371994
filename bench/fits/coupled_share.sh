#!/usr/bin/env bash
# bench/fits/coupled_share.sh [SIZE [FRAMES]]
# Fits k (perceptual/tolerance_fraction.h): the share of what coding hides that lighting may use and still lose no more than 0.1 dB. Renders two films of
# animations/ by bench_coupled at several shares and quantisers, each with two draws of representatives; writes bench/fits/coupled-share-by-type.jsonl with all
# films, and prints the fit and its cross-validation (docs/measurements.md#tolerance-fraction). Default: 160x160 pixels, 12 frames each, some 4 minutes on one core.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
root=$here/../..
bench=${BENCH_COUPLED:-$root/build/dev/bench_coupled}
size=${1:-160x160}
frames=${2:-12}
data=${COUPLED_SHARE_DATA:-$root/bench/fits/coupled-share-by-type.jsonl}
: > "$data"
for film in cornell:20 many_lamps:5; do
    IFS=: read -r name first <<< "$film"
    "$bench" --pairs 6 --draws 2 --quantisers 2,8,31 --shares 0.2,0.3,0.45,0.7 --name "$name" --keep-references "${TMPDIR:-/tmp}/render2mpeg_bench" \
        "$root/animations/$name" --size "$size" --samples 1 --vpls 1000 --cache off --frames "$first:$((first + frames - 1))" --threads 1 >> "$data"
done
python3 "$here/coupled_share.py" "$data"
