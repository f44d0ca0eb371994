#!/bin/bash
# Runs the template on this machine; a scheduler that reads OpenJD takes template.json, or this folder as a job bundle.
set -eu
CDPATH= cd -- "$(dirname -- "$0")"
exec openjd run ./template.json --step Join --run-dependencies "$@"
