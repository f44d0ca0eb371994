#!/bin/bash
# Submits the parts that are not made yet as an array, and the join behind them. Options go to both: submit.sh --partition=render
set -eu
@places@
left=$("$program" farm-status "$plan" --left)
behind=()
if [ -n "$left" ]; then
    job=$(sbatch --parsable --array="$left" "$@" "$plan/part.sbatch")
    behind=(--dependency="afterok:${job%%;*}" --kill-on-invalid-dep=yes)
    echo "parts $left: job ${job%%;*}"
fi
join=$(sbatch --parsable "${behind[@]}" "$@" "$plan/join.sbatch")
echo "join: job ${join%%;*}"
