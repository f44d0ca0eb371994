#!/bin/bash
# Submits all parts as an array, and the join behind them; what is made already ends at once. Options go to both: submit.sh -q render.q
set -eu
CDPATH= cd -- "$(dirname -- "$0")"
job=$(qsub -terse "$@" part.sge)
join=$(qsub -terse -hold_jid "${job%%.*}" "$@" join.sge)
echo "parts: job ${job%%.*}; join: job ${join%%.*}"
