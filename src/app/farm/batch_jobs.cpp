// Job files for Slurm, Grid Engine and GNU parallel: scripts that name parts by number.
#include <fmt/format.h>

#include "app/farm/job_files.h"

namespace render2mpeg::app {
namespace {

/// A job's name: what schedulers take, from the film's.
std::string job_name(const FarmPlan& plan) {
    std::string name;
    for (const char c : plan.output_name)
        name += std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '.' || c == '-' ? c : '_';
    return "r2m-" + name;
}

/// What a part's script does when it ends: `again` where another try may do better.
constexpr const char* slurm_part = R"sh(#!/bin/bash
#SBATCH --job-name={name}
#SBATCH --array=1-{parts}
#SBATCH --output={log}/part_%a.txt
#SBATCH --open-mode=append
#SBATCH --requeue
# One part of a film. SBATCH_PARTITION, SBATCH_TIMELIMIT and the like choose where it runs, and how long; --cpus-per-task how wide.
{places}
"$program" part "$plan" "$SLURM_ARRAY_TASK_ID" --threads "${{SLURM_CPUS_ON_NODE:-0}}"
status=$?
# 2 and 3: another try would fail alike. Else the part goes on where it was ended, three times at most.
case $status in 0 | 2 | 3) exit $status ;; esac
if [ "${{SLURM_RESTART_COUNT:-0}}" -lt 3 ]; then
    scontrol requeue "${{SLURM_ARRAY_JOB_ID}}_$SLURM_ARRAY_TASK_ID" && sleep 60
fi
exit $status
)sh";

constexpr const char* slurm_join = R"sh(#!/bin/bash
#SBATCH --job-name={name}-join
#SBATCH --output={log}/join.txt
#SBATCH --open-mode=append
#SBATCH --requeue
{places}
exec "$program" join "$plan" --threads "${{SLURM_CPUS_ON_NODE:-0}}"
)sh";

constexpr const char* slurm_submit = R"sh(#!/bin/bash
# Submits the parts that are not made yet as an array, and the join behind them. Options go to both: submit.sh --partition=render
set -eu
{places}
left=$("$program" farm-status "$plan" --left)
behind=()
if [ -n "$left" ]; then
    job=$(sbatch --parsable --array="$left" "$@" "$plan/part.sbatch")
    behind=(--dependency="afterok:${{job%%;*}}" --kill-on-invalid-dep=yes)
    echo "parts $left: job ${{job%%;*}}"
fi
join=$(sbatch --parsable "${{behind[@]}}" "$@" "$plan/join.sbatch")
echo "join: job ${{join%%;*}}"
)sh";

constexpr const char* sge_part = R"sh(#!/bin/bash
#$ -N {name}
#$ -t 1-{parts}
#$ -o {log} -j y
#$ -r y
#$ -S /bin/bash
{places}
"$program" part "$plan" "$SGE_TASK_ID" --threads "${{NSLOTS:-1}}"
status=$?
# 99: run it again; 100: leave it in the state of error, with what waits for it.
case $status in 0) exit 0 ;; 2 | 3) exit 100 ;; *) exit 99 ;; esac
)sh";

constexpr const char* sge_join = R"sh(#!/bin/bash
#$ -N {name}-join
#$ -o {log} -j y
#$ -r y
#$ -S /bin/bash
{places}
exec "$program" join "$plan" --threads "${{NSLOTS:-1}}"
)sh";

constexpr const char* sge_submit = R"sh(#!/bin/bash
# Submits all parts as an array, and the join behind them; what is made already ends at once. Options go to both: submit.sh -q render.q
set -eu
{places}
job=$(qsub -terse "$@" "$plan/part.sge")
join=$(qsub -terse -hold_jid "${{job%%.*}}" "$@" "$plan/join.sge")
echo "parts: job ${{job%%.*}}; join: job ${{join%%.*}}"
)sh";

constexpr const char* parallel_submit = R"sh(#!/bin/bash
# Makes all parts, as many at once as there are cores, and joins them. Options go to GNU parallel: submit.sh --jobs 2 -S node1,node2
set -eu
{places}
part=$(printf '%q ' "$program" part "$plan")
parallel --joblog "$plan/log/parts.joblog" --resume-failed --retries 3 --line-buffer --tagstring 'part {{}}' "$@" \
    "$part" '{{}}' --threads "${{RENDER2MPEG_THREADS:-1}}" ::: $(seq 1 {parts})
exec "$program" join "$plan"
)sh";

JobFile filled(const FarmPlan& plan, const char* name, const char* text) {
    return {name,
            fmt::format(fmt::runtime(text), fmt::arg("name", job_name(plan)), fmt::arg("parts", plan.parts.size()),
                        fmt::arg("log", (plan.folder / "log").string()), fmt::arg("places", places_text(plan))),
            true};
}

}  // namespace

std::vector<JobFile> batch_job_files(const FarmPlan& plan) {
    if (plan.scheduler == "slurm")
        return {filled(plan, "part.sbatch", slurm_part), filled(plan, "join.sbatch", slurm_join),
                filled(plan, "submit.sh", slurm_submit)};
    if (plan.scheduler == "sge")
        return {filled(plan, "part.sge", sge_part), filled(plan, "join.sge", sge_join),
                filled(plan, "submit.sh", sge_submit)};
    return {filled(plan, "submit.sh", parallel_submit)};
}

}  // namespace render2mpeg::app
