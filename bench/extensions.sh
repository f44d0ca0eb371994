#!/usr/bin/env bash
# bench/extensions.sh OUT_FOLDER [THREE_FOLDER]
# A ball for each of glTF's materials that are read, beside three.js and Blender's Cycles, in one sky: prints a row each and
# writes OUT_FOLDER/sheet.png. THREE_FOLDER: node_modules/three, as `npm install three` leaves it; without it Cycles stands
# alone. Needs Chromium and Blender 3.4. OUT_FOLDER lies outside of the tree; what is there already is rendered anew.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)/extensions
program=${RENDER2MPEG:-$here/../build/release/render2mpeg}
size=${SIZE:-120}
mkdir -p "$1"
out=$(cd "$1" && pwd)
blender() { (cd "$out" && command blender -b -noaudio --factory-startup --python-exit-code 1 -P "$@"); }

names=($(python3 "$here/models.py" "$out"))
for name in "${names[@]}"; do
    "$program" render -y "$out/$name.gltf" --sky "$out/sky.hdr" -o "$out/${name}_ours%04d.exr" --size "${size}x$size" --frames 0:0 \
        --exposure 0 --samples 32 --tolerance reference --vpls 2048 --cache off --quiet 2> "$out/$name.log" || cat "$out/$name.log"
    mv "$out/${name}_ours0000.exr" "$out/${name}_ours.exr"
done
blender "$here/cycles.py" -- "$out" "${SAMPLES:-256}" "$size" > "$out/cycles.log"

if [[ -n ${2:-} ]]; then
    three=$(cd "$2" && pwd)
    rm -rf "$out/served"
    mkdir "$out/served"
    ln -s "$three" "$out/served/three"
    ln -s "$out" "$out/served/models"
    cp "$here/three.html" "$out/served"
    python3 -m http.server -d "$out/served" -b 127.0.0.1 8625 > "$out/server.log" 2>&1 &
    server=$!
    trap 'kill $server' EXIT
    sleep 1
    all=$(IFS=,; echo "${names[*]}")
    chromium --headless --no-sandbox --use-angle=swiftshader --enable-unsafe-swiftshader --timeout=300000 \
        --virtual-time-budget=300000 --dump-dom "http://127.0.0.1:8625/three.html?size=$size&names=$all" \
        > "$out/three.txt" 2> "$out/chromium.log"
    grep -o '^error.*' "$out/three.txt" || true
    sed 's/.*<pre id="out">//' "$out/three.txt" | while read -r name data; do
        [[ " ${names[*]} " != *" $name "* ]] || base64 -d <<< "$data" > "$out/${name}_three.png"
    done
fi
blender "$here/sheet.py" -- "$out" "$out/sheet.png" "${names[@]}" | sed -n 's/^ROW //p'
