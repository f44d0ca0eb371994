#!/bin/bash
# Submits the parts that are not made yet as an array, and the join behind them. Options go to both: submit.sh --partition=render
set -eu
CDPATH= cd -- "$(dirname -- "$0")"
@places@
left=$("$program" farm-status "$plan" --left)
behind=()
if [ -n "$left" ]; then
    job=$(sbatch --parsable --array="$left" "$@" part.sbatch)
    behind=(--dependency="afterok:${job%%;*}" --kill-on-invalid-dep=yes)
    echo "parts $left: job ${job%%;*}"
fi
join=$(sbatch --parsable "${behind[@]}" "$@" join.sbatch)
echo "join: job ${join%%;*}"
