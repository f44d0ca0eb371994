#!/bin/bash
# Options go to snakemake: submit.sh --profile slurm
set -eu
here=$(cd "$(dirname "$0")" && pwd)
exec snakemake --snakefile "$here/Snakefile" --directory "$here" --cores all "$@"
