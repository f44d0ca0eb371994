#!/bin/bash
# Runs the template on this machine; a scheduler that reads OpenJD takes template.json, or this folder as a job bundle.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
exec openjd run "$here/template.json" --step Join --run-dependencies "$@"
