# lay_out_film NAME SCENES_FOLDER WORK_FOLDER: the film of bench/real_scenes called NAME (sponza, sibenik or bathroom) as
# WORK_FOLDER/NAME, with copies of the files it needs; 1 where SCENES_FOLDER has not got them. To be sourced.
lay_out_film() {
    local name=$1 source=$2/$1 to=$3/$1
    if [[ $name == sponza* ]]; then source=$2/sponza_dabrovic; fi
    [ -d "$source" ] || return 1
    mkdir -p "$to"
    cp -r "$source/." "$to/"
    chmod -R u+w "$to"
    cp "$(dirname "${BASH_SOURCE[0]}")/$name.json" "$to/film.json"
}
