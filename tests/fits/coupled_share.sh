#!/usr/bin/env bash
# tests/fits/coupled_share.sh [SIZE [FRAMES]]
# Fits k (perceptual/share.cpp): the share of what coding hides that lighting may use and still lose no more than 0.1 dB. Renders two films of
# animations/ by bench_coupled at several shares and quantisers, and two others for validation; writes docs/fits/coupled-share.jsonl with all films and
# docs/fits/coupled-share.md with the fit. Default: 128x128 pixels, 9 frames each, about half an hour on one core.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
root=$here/../..
bench=${BENCH_COUPLED:-$root/build/dev/bench_coupled}
size=${1:-128x128}
frames=${2:-9}
data=$root/docs/fits/coupled-share.jsonl
: > "$data"
for film in character:10 many_lamps:5 cornell:20 colonnade:10; do
    name=${film%%:*}
    first=${film##*:}
    "$bench" --pairs 3 --quantisers 2,8,24 --shares 0.6,0.3,0.15,0.08 --name "$name" --cache "${TMPDIR:-/tmp}/render2mpeg_bench" \
        "$root/animations/$name" --size "$size" --samples 1 --vpls 1000 --frames "$first:$((first + frames - 1))" --threads 1 >> "$data"
done
python3 "$here/coupled_share.py" "$data" > "$root/docs/fits/coupled-share.md"
cat "$root/docs/fits/coupled-share.md"
