#!/bin/bash
# Runs all parts, waits for them, and joins them. Options go to kubectl: submit.sh --namespace render
set -eu
here=$(cd "$(dirname "$0")" && pwd)
kubectl "$@" apply -f "$here/parts.json"
kubectl "$@" wait --for=condition=complete --timeout=-1s job/@object@-parts &
done=$!
kubectl "$@" wait --for=condition=failed --timeout=-1s job/@object@-parts && kill "$done" &
failed=$!
wait "$done" || { echo "parts failed; see kubectl describe job/@object@-parts" >&2; exit 1; }
kill "$failed"
kubectl "$@" apply -f "$here/join.json"
kubectl "$@" wait --for=condition=complete --timeout=-1s job/@object@-join
