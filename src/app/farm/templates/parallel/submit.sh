#!/bin/bash
# Makes all parts, as many at once as there are cores, and joins them. Options go to GNU parallel: submit.sh --jobs 2 -S node1,node2
set -eu
CDPATH= cd -- "$(dirname -- "$0")"
@places@
# By variables: a name within a command would be searched for replacements such as {}.
export program plan
parallel --env program --env plan --joblog log/parts.joblog --resume-failed --retries 3 --line-buffer --tagstring 'part {}' "$@" \
    '"$program" part "$plan"' '{}' --threads "${RENDER2MPEG_THREADS:-1}" ::: $(seq 1 @parts@)
exec "$program" join "$plan"
