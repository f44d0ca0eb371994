#!/usr/bin/env bash
# bench/coupled.sh [-s SCENES_FOLDER] [-d SIZE] [-f FRAMES] [-q QUANTISERS] [-k SHARES] [-p PAIRS] [-r REFERENCES] [-- OPTIONS]
# What the coupled loop saves and costs against --tolerance fixed=2% at the same quantiser and stopping rule: films of animations/ and, where
# SCENES_FOLDER has them, the walks through Sponza and Sibenik of bench/real_scenes. One line of JSON per film, then the tables.
# OPTIONS go to bench_coupled: --draws N makes every film with so many draws of representatives.
# In full: bench/coupled.sh -s SCENES -d 512x512 -f 48 -q 1,2,4,8,16,24,31 -p 6   (a day on one core; frames without clustering are kept in the folder REFERENCES)
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
. "$here/real_scenes/lay_out_film.sh"
bench=${BENCH_COUPLED:-$here/../build/dev/bench_coupled}
scenes= size=160x160 frames=18 quantisers=2,8,16,24 shares=default,0.65,1 pairs=3 references=${TMPDIR:-/tmp}/render2mpeg_bench
while getopts s:d:f:q:k:p:r: option; do
    case $option in
        s) scenes=$OPTARG ;; d) size=$OPTARG ;; f) frames=$OPTARG ;; q) quantisers=$OPTARG ;;
        k) shares=$OPTARG ;; p) pairs=$OPTARG ;; r) references=$OPTARG ;;
        *) exit 1 ;;
    esac
done
shift $((OPTIND - 1))
options=("$@")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

film() { # NAME INPUT FIRST_FRAME VPLS
    "$bench" --name "$1" --pairs "$pairs" --quantisers "$quantisers" --shares "$shares" --keep-references "$references" "${options[@]}" "$2" --size "$size" --samples 1 \
        --vpls "$4" --cache off --frames "$3:$(($3 + frames - 1))" --threads 1 | tee -a "$work/films.jsonl"
}

film cornell "$here/../animations/cornell" 0 2000
film character "$here/../animations/character" 0 4096
film colonnade "$here/../animations/colonnade" 0 4096
for walk in sponza sibenik; do
    [ -n "$scenes" ] && lay_out_film "$walk" "$scenes" "$work" || continue
    film "$walk" "$work/$walk" 0 9000
done
python3 "$here/coupled_tables.py" "$work/films.jsonl"
