#!/usr/bin/env bash
# bench/record_crops.sh SCENES_FOLDER OUT.png (docs/pictures/records-crops.png)
# Where keeping light in records might fail: contact shadows and thin mouldings, enlarged. Frame 11 of the walks through Sponza and Sibenik at
# 256x256; columns: every light point, coupled at quantiser 8 with --cache off, the same with --cache on from frame 0 on. Needs oiiotool.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
. "$here/real_scenes/lay_out_film.sh"
program=${RENDER2MPEG:-$here/../build/release/render2mpeg}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

render() { # FILM OUTPUT FRAMES [render options...]
    "$program" render -y --hold "$work/$1" -o "$2" --frames "$3" --size 256x256 --samples 1 --vpls 9000 --exposure 0 --threads 1 --quiet "${@:4}"
}

rows=()
crops() { # FILM BRIGHTER +X+Y...
    local film=$1 brighter=$2 place way
    render "$film" "$work/$film.every.%04d.exr" 11:11 --tolerance reference
    render "$film" "$work/film.m2v" 11:11 --tolerance coupled --quantiser 8 --cache off --aov "$work/$film.off"
    render "$film" "$work/film.m2v" 0:11 --tolerance coupled --quantiser 8 --cache on --aov "$work/$film.on"
    for way in off on; do
        oiiotool "$work/$film.$way/frame_0011.exr" --ch ViewLayer.Combined.R,ViewLayer.Combined.G,ViewLayer.Combined.B --chnames R,G,B -o "$work/$film.$way.exr"
    done
    oiiotool "$work/$film.every.0011.exr" --ch R,G,B -o "$work/$film.every.exr"
    for place in "${@:3}"; do
        for way in every off on; do
            oiiotool "$work/$film.$way.exr" --cut "48x48$place" --origin +0+0 --fullpixels --mulc "$brighter" --clamp:min=0:max=1 --powc 0.4545 \
                --resize:filter=box 288x288 -d uint8 -o "$work/$way.png"
        done
        oiiotool "$work/every.png" "$work/off.png" "$work/on.png" --mosaic:pad=4 3x1 -o "$work/row${#rows[@]}.png"
        rows+=("$work/row${#rows[@]}.png")
    done
}

lay_out_film sponza "$1" "$work"
lay_out_film sibenik "$1" "$work"
crops sponza 3 +40+165 +130+20
crops sibenik 2 +0+83 +150+20
oiiotool "${rows[@]}" --mosaic:pad=4 "1x${#rows[@]}" -o "$2"
