#pragma once
// Templates of every scheduler's job files: names between @ stand for values of the plan (job_files.cpp).
#include <string_view>

namespace render2mpeg::app {

struct JobTemplate {
    std::string_view scheduler, file, text;
};

inline constexpr JobTemplate job_templates[] = {
    {"slurm", "part.sbatch", R"sh(#!/bin/bash
#SBATCH --job-name=@name@
#SBATCH --array=1-@parts@
#SBATCH --output=@log@/part_%a.txt
#SBATCH --open-mode=append
#SBATCH --requeue
# One part of a film. SBATCH_PARTITION, SBATCH_TIMELIMIT and the like choose where it runs, and how long; --cpus-per-task how wide.
@places@
"$program" part "$plan" "$SLURM_ARRAY_TASK_ID" --threads "${SLURM_CPUS_ON_NODE:-0}"
status=$?
# 2 and 3: another try would fail alike. Else the part goes on where it was ended, three times at most.
case $status in 0 | 2 | 3) exit $status ;; esac
if [ "${SLURM_RESTART_COUNT:-0}" -lt 3 ]; then
    scontrol requeue "${SLURM_ARRAY_JOB_ID}_$SLURM_ARRAY_TASK_ID" && sleep 60
fi
exit $status
)sh"},
    {"slurm", "join.sbatch", R"sh(#!/bin/bash
#SBATCH --job-name=@name@-join
#SBATCH --output=@log@/join.txt
#SBATCH --open-mode=append
#SBATCH --requeue
@places@
exec "$program" join "$plan" --threads "${SLURM_CPUS_ON_NODE:-0}"
)sh"},
    {"slurm", "submit.sh", R"sh(#!/bin/bash
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
)sh"},
    {"sge", "part.sge", R"sh(#!/bin/bash
#$ -N @name@
#$ -t 1-@parts@
#$ -o @log@ -j y
#$ -r y
#$ -S /bin/bash
@places@
"$program" part "$plan" "$SGE_TASK_ID" --threads "${NSLOTS:-1}"
status=$?
# 99: run it again; 100: leave it in the state of error, with what waits for it.
case $status in 0) exit 0 ;; 2 | 3) exit 100 ;; *) exit 99 ;; esac
)sh"},
    {"sge", "join.sge", R"sh(#!/bin/bash
#$ -N @name@-join
#$ -o @log@ -j y
#$ -r y
#$ -S /bin/bash
@places@
exec "$program" join "$plan" --threads "${NSLOTS:-1}"
)sh"},
    {"sge", "submit.sh", R"sh(#!/bin/bash
# Submits all parts as an array, and the join behind them; what is made already ends at once. Options go to both: submit.sh -q render.q
set -eu
@places@
job=$(qsub -terse "$@" "$plan/part.sge")
join=$(qsub -terse -hold_jid "${job%%.*}" "$@" "$plan/join.sge")
echo "parts: job ${job%%.*}; join: job ${join%%.*}"
)sh"},
    {"parallel", "submit.sh", R"sh(#!/bin/bash
# Makes all parts, as many at once as there are cores, and joins them. Options go to GNU parallel: submit.sh --jobs 2 -S node1,node2
set -eu
@places@
part=$(printf '%q ' "$program" part "$plan")
parallel --joblog "$plan/log/parts.joblog" --resume-failed --retries 3 --line-buffer --tagstring 'part {}' "$@" \
    "$part" '{}' --threads "${RENDER2MPEG_THREADS:-1}" ::: $(seq 1 @parts@)
exec "$program" join "$plan"
)sh"},
    {"kubernetes", "parts.json", R"js({
  "apiVersion": "batch/v1",
  "kind": "Job",
  "metadata": {"name": "@object@-parts"},
  "spec": {
    "completions": @parts@,
    "parallelism": @parts@,
    "completionMode": "Indexed",
    "backoffLimitPerIndex": 3,
    "podFailurePolicy": {"rules": [
      {"action": "FailIndex", "onExitCodes": {"containerName": "render2mpeg", "operator": "In", "values": [2, 3]}},
      {"action": "Ignore", "onPodConditions": [{"type": "DisruptionTarget", "status": "True"}]}]},
    "template": {"spec": {
      "restartPolicy": "Never",
      "containers": [{
        "name": "render2mpeg",
        "image": "render2mpeg:latest",
        "command": ["sh", "-c", @part_command@],
        "resources": {"requests": {"cpu": "4", "memory": "8Gi"}},
        "volumeMounts": [{"name": "films", "mountPath": @parent@}]}],
      "volumes": [{"name": "films", "persistentVolumeClaim": {"claimName": "films"}}]}}
  }
}
)js"},
    {"kubernetes", "join.json", R"js({
  "apiVersion": "batch/v1",
  "kind": "Job",
  "metadata": {"name": "@object@-join"},
  "spec": {
    "backoffLimit": 3,
    "template": {"spec": {
      "restartPolicy": "Never",
      "containers": [{
        "name": "render2mpeg",
        "image": "render2mpeg:latest",
        "command": ["render2mpeg", "join", @plan@],
        "resources": {"requests": {"cpu": "4", "memory": "8Gi"}},
        "volumeMounts": [{"name": "films", "mountPath": @parent@}]}],
      "volumes": [{"name": "films", "persistentVolumeClaim": {"claimName": "films"}}]}}
  }
}
)js"},
    {"kubernetes", "submit.sh", R"sh(#!/bin/bash
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
)sh"},
    // A job template [OpenJD]. A chunk of frames is a part where the scheduler keeps to defaultTaskCount; whatever
    // chunks it makes, `part --frames` makes each part once.
    {"openjd", "template.json", R"js({
  "specificationVersion": "jobtemplate-2023-09",
  "extensions": ["TASK_CHUNKING"],
  "name": @short_film@,
  "parameterDefinitions": [
    {"name": "Program", "type": "STRING", "default": @program@},
    {"name": "Plan", "type": "PATH", "objectType": "DIRECTORY", "dataFlow": "INOUT", "default": @plan@}],
  "steps": [
    {"name": "Parts",
     "parameterSpace": {"taskParameterDefinitions": [
       {"name": "Frames", "type": "CHUNK[INT]", "range": "@frames@",
        "chunks": {"defaultTaskCount": @most@, "rangeConstraint": "CONTIGUOUS"}}]},
     "script": {"actions": {"onRun": {
       "command": "{{Param.Program}}",
       "args": ["part", "{{Param.Plan}}", "--frames", "{{Task.Param.Frames}}", "--progress", "openjd"]}}}},
    {"name": "Join",
     "dependencies": [{"dependsOn": "Parts"}],
     "script": {"actions": {"onRun": {"command": "{{Param.Program}}", "args": ["join", "{{Param.Plan}}"]}}}}]
}
)js"},
    {"openjd", "submit.sh", R"sh(#!/bin/bash
# Runs the template on this machine; a scheduler that reads OpenJD takes template.json, or this folder as a job bundle.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
exec openjd run "$here/template.json" --step Join --run-dependencies "$@"
)sh"},
    {"snakemake", "Snakefile",
     R"sh(# Parts of a film, and the join behind them. `snakemake --profile ...` chooses where they run.
PARTS = range(1, @parts@ + 1)

rule film:
    input: "log/film.done"

rule part:
    output: touch("log/part_{part}.done")
    threads: 4
    retries: 3
    params: program=@program@, plan=@plan@
    shell: "{params.program:q} part {params.plan:q} {wildcards.part} --threads {threads}"

rule join:
    input: expand("log/part_{part}.done", part=PARTS)
    output: touch("log/film.done")
    params: program=@program@, plan=@plan@
    shell: "{params.program:q} join {params.plan:q}"
)sh"},
    {"snakemake", "submit.sh", R"sh(#!/bin/bash
# Options go to snakemake: submit.sh --profile slurm
set -eu
here=$(cd "$(dirname "$0")" && pwd)
exec snakemake --snakefile "$here/Snakefile" --directory "$here" --cores all "$@"
)sh"},
    // A job type of Flamenco 3: goes into the `scripts` folder of the manager once.
    {"flamenco", "render2mpeg-film.js", R"js(const JOB_TYPE = {
    label: "render2mpeg film",
    description: "Parts of a film that `render2mpeg farm` has planned, and the join behind them",
    settings: [
        { key: "program", type: "string", default: "render2mpeg", required: true },
        { key: "plan", type: "string", subtype: "dir_path", required: true },
        { key: "parts", type: "int32", default: 1, required: true },
    ],
};

function compileJob(job) {
    const settings = job.settings;
    const join = author.Task("join", "misc");
    join.addCommand(author.Command("exec", { exe: settings.program, args: ["join", settings.plan] }));
    for (let part = 1; part <= settings.parts; part++) {
        const task = author.Task("part-" + part, "misc");
        task.addCommand(author.Command("exec", { exe: settings.program, args: ["part", settings.plan, String(part)] }));
        join.addDependency(task);
        job.addTask(task);
    }
    job.addTask(join);
}
)js"},
    {"flamenco", "job.json", R"js({
  "name": @film@,
  "type": "render2mpeg-film",
  "priority": 50,
  "submitter_platform": "linux",
  "settings": {"program": @program@, "plan": @plan@, "parts": @parts@},
  "metadata": {"film": @film@}
}
)js"},
    {"flamenco", "submit.sh", R"sh(#!/bin/bash
# Sends the job to a Flamenco manager that has render2mpeg-film.js among its scripts: FLAMENCO=http://manager:8080 submit.sh
set -eu
here=$(cd "$(dirname "$0")" && pwd)
exec curl --fail --silent --show-error -X POST -H 'Content-Type: application/json' --data "@$here/job.json" "$@" \
    "${FLAMENCO:-http://localhost:8080}/api/v3/jobs"
)sh"},
};

}  // namespace render2mpeg::app
