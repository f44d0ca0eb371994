#!/bin/bash
# Launches the parts that are not made yet and the join behind them, by OpenCue's PyOutline. OPENCUE_SHOW and OPENCUE_SHOT say for what,
# OPENCUE_CORES how wide. CUEBOT_HOSTS says where.
set -eu
CDPATH= cd -- "$(dirname -- "$0")"
@places@
left=$("$program" farm-status "$plan" --left)
# A wrapper of python3 may have variables of its own.
export R2M_PROGRAM="$program" R2M_PLAN="$plan" R2M_LEFT="$left"
exec python3 submit.py
