#!/bin/bash
# Makes all parts, as many at once as there are cores, and joins them. Options go to GNU parallel: submit.sh --jobs 2 -S node1,node2
set -eu
@places@
part=$(printf '%q ' "$program" part "$plan")
parallel --joblog "$plan/log/parts.joblog" --resume-failed --retries 3 --line-buffer --tagstring 'part {}' "$@" \
    "$part" '{}' --threads "${RENDER2MPEG_THREADS:-1}" ::: $(seq 1 @parts@)
exec "$program" join "$plan"
