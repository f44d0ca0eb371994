#!/bin/bash
# Options go to snakemake: submit.sh --profile slurm
set -eu
CDPATH= cd -- "$(dirname -- "$0")"
exec snakemake --snakefile Snakefile --directory . --cores all "$@"
