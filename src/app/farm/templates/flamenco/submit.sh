#!/bin/bash
# Sends the job to a Flamenco manager that has render2mpeg-film.js among its scripts: FLAMENCO=http://manager:8080 submit.sh
set -eu
CDPATH= cd -- "$(dirname -- "$0")"
exec curl --fail --silent --show-error -X POST -H 'Content-Type: application/json' --data @job.json "$@" \
    "${FLAMENCO:-http://localhost:8080}/api/v3/jobs"
