#!/bin/bash
# Runs all parts, waits for them, and joins them. Options go to kubectl: submit.sh --namespace render
set -eu
CDPATH= cd -- "$(dirname -- "$0")"
kubectl "$@" apply -f parts.json
kubectl "$@" wait --for=condition=complete --timeout=-1s job/@object@-parts &
done=$!
kubectl "$@" wait --for=condition=failed --timeout=-1s job/@object@-parts && kill "$done" &
failed=$!
wait "$done" || { echo "parts failed; see kubectl describe job/@object@-parts" >&2; exit 1; }
kill "$failed" 2>/dev/null || true
kubectl "$@" apply -f join.json
kubectl "$@" wait --for=condition=complete --timeout=-1s job/@object@-join
