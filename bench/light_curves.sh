#!/usr/bin/env bash
# bench/light_curves.sh SCENE OUT.svg [name=value...]
# Time of light against the number of light points (VPLS, at 256x256) and against resolution (SIZES, at 9,000), and memory per light
# point, one process per point, one thread: a table on the standard output, and the curves as a picture. What follows goes to
# bench_light_curves, e.g. tolerance=8 every=4. To try it: VPLS="1000 10000" SIZES="128x128 256x256".
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
program=${BENCH_LIGHT_CURVES:-$here/../build/release/bench_light_curves}
scene=$1 picture=$2
shift 2
points=$(mktemp)
trap 'rm -f "$points"' EXIT
for vpls in ${VPLS:-1000 10000 100000 1000000}; do
    echo "vpls $("$program" "$scene" "vpls=$vpls" width=256 height=256 "$@")" >>"$points"
done
for size in ${SIZES:-256x256 512x512 1024x1024 1920x1080}; do
    echo "size $("$program" "$scene" vpls=9000 "width=${size%x*}" "height=${size#*x}" "$@")" >>"$points"
done
python3 "$here/light_curves.py" "$points" "$picture"
