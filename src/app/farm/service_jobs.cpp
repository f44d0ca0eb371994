// Job files for Kubernetes, OpenJD, Snakemake and Flamenco: descriptions of the parts and what depends on them.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <nlohmann/json.hpp>
#include <string>
#include <system_error>

#include "app/farm/job_files.h"
#include "app/files/text_file.h"

namespace render2mpeg::app {
namespace {

using nlohmann::json;

/// Where the program is on machines that see this one's files; else as PATH has it.
std::string program_of(const FarmPlan& plan) {
    std::error_code error;
    const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", error);
    return error || plan.packed ? "render2mpeg" : program.string();
}

/// Small letters, digits and dashes, as names of Kubernetes' objects have.
std::string object_name(const FarmPlan& plan) {
    std::string name = "r2m-";
    for (const char c : plan.output_name.substr(0, 40))
        name += std::isalnum(static_cast<unsigned char>(c)) != 0
                    ? static_cast<char>(std::tolower(static_cast<unsigned char>(c)))
                    : '-';
    return name + "-x";
}

/// A pod that runs a command, with the claim in which the plan's folder lies.
json pod_of(const FarmPlan& plan, const json& command) {
    const json container{
        {"name", "render2mpeg"},
        {"image", "render2mpeg:latest"},
        {"command", command},
        {"resources", {{"requests", {{"cpu", "4"}, {"memory", "8Gi"}}}}},
        {"volumeMounts", json::array({json{{"name", "films"}, {"mountPath", plan.folder.parent_path().string()}}})}};
    return {{"restartPolicy", "Never"},
            {"containers", json::array({container})},
            {"volumes", json::array({json{{"name", "films"}, {"persistentVolumeClaim", {{"claimName", "films"}}}}})}};
}

/// An indexed job: a part of its own tries each, and none where another try would fail alike.
json kubernetes_parts(const FarmPlan& plan) {
    const std::string command =
        fmt::format("exec render2mpeg part {} $((JOB_COMPLETION_INDEX + 1))", quoted(plan.folder.string()));
    return {{"apiVersion", "batch/v1"},
            {"kind", "Job"},
            {"metadata", {{"name", object_name(plan) + "-parts"}}},
            {"spec",
             {{"completions", plan.parts.size()},
              {"parallelism", plan.parts.size()},
              {"completionMode", "Indexed"},
              {"backoffLimitPerIndex", 3},
              {"podFailurePolicy",
               {{"rules",
                 {{{"action", "FailIndex"},
                   {"onExitCodes", {{"containerName", "render2mpeg"}, {"operator", "In"}, {"values", {2, 3}}}}},
                  {{"action", "Ignore"},
                   {"onPodConditions", json::array({json{{"type", "DisruptionTarget"}, {"status", "True"}}})}}}}}},
              {"template", {{"spec", pod_of(plan, {"sh", "-c", command})}}}}}};
}

json kubernetes_join(const FarmPlan& plan) {
    return {
        {"apiVersion", "batch/v1"},
        {"kind", "Job"},
        {"metadata", {{"name", object_name(plan) + "-join"}}},
        {"spec",
         {{"backoffLimit", 3}, {"template", {{"spec", pod_of(plan, {"render2mpeg", "join", plan.folder.string()})}}}}}};
}

constexpr const char* kubernetes_submit = R"sh(#!/bin/bash
# Runs all parts, waits for them, and joins them. Options go to kubectl: submit.sh --namespace render
set -eu
here=$(cd "$(dirname "$0")" && pwd)
kubectl "$@" apply -f "$here/parts.json"
kubectl "$@" wait --for=condition=complete --timeout=-1s job/{name}-parts &
done=$!
kubectl "$@" wait --for=condition=failed --timeout=-1s job/{name}-parts && kill "$done" &
failed=$!
wait "$done" || {{ echo "parts failed; see kubectl describe job/{name}-parts" >&2; exit 1; }}
kill "$failed"
kubectl "$@" apply -f "$here/join.json"
kubectl "$@" wait --for=condition=complete --timeout=-1s job/{name}-join
)sh";

/// A job template [OpenJD]. A chunk of frames is a part where the scheduler keeps to defaultTaskCount; whatever chunks
/// it makes, `part --frames` makes each part once.
json openjd_template(const FarmPlan& plan) {
    const FilmPart &first = plan.parts.front(), &last = plan.parts.back();
    std::int64_t most = 0;
    for (const FilmPart& part : plan.parts) most = std::max(most, part.frames.last + 1 - part.frames.first);
    const auto action = [&](const json& arguments) {
        return json{{"actions", {{"onRun", {{"command", "{{Param.Program}}"}, {"args", arguments}}}}}};
    };
    const json frames{{"name", "Frames"},
                      {"type", "CHUNK[INT]"},
                      {"range", fmt::format("{}-{}", first.frames.first, last.frames.last)},
                      {"chunks", {{"defaultTaskCount", most}, {"rangeConstraint", "CONTIGUOUS"}}}};
    const json parts{
        {"name", "Parts"},
        {"parameterSpace", {{"taskParameterDefinitions", json::array({frames})}}},
        {"script", action({"part", "{{Param.Plan}}", "--frames", "{{Task.Param.Frames}}", "--progress", "openjd"})}};
    const json join{{"name", "Join"},
                    {"dependencies", json::array({json{{"dependsOn", "Parts"}}})},
                    {"script", action({"join", "{{Param.Plan}}"})}};
    return {{"specificationVersion", "jobtemplate-2023-09"},
            {"extensions", json::array({"TASK_CHUNKING"})},
            {"name", plan.output_name.substr(0, 100)},
            {"parameterDefinitions",
             {{{"name", "Program"}, {"type", "STRING"}, {"default", program_of(plan)}},
              {{"name", "Plan"},
               {"type", "PATH"},
               {"objectType", "DIRECTORY"},
               {"dataFlow", "INOUT"},
               {"default", plan.folder.string()}}}},
            {"steps", {parts, join}}};
}

constexpr const char* openjd_submit = R"sh(#!/bin/bash
# Runs the template on this machine; a scheduler that reads OpenJD takes template.json, or this folder as a job bundle.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
exec openjd run "$here/template.json" --step Join --run-dependencies "$@"
)sh";

constexpr const char* snakefile =
    R"sh(# Parts of a film, and the join behind them. `snakemake --profile ...` chooses where they run.
PARTS = range(1, {parts} + 1)

rule film:
    input: "log/film.done"

rule part:
    output: touch("log/part_{{part}}.done")
    threads: 4
    retries: 3
    params: program={program}, plan={plan}
    shell: "{{params.program:q}} part {{params.plan:q}} {{wildcards.part}} --threads {{threads}}"

rule join:
    input: expand("log/part_{{part}}.done", part=PARTS)
    output: touch("log/film.done")
    params: program={program}, plan={plan}
    shell: "{{params.program:q}} join {{params.plan:q}}"
)sh";

constexpr const char* snakemake_submit = R"sh(#!/bin/bash
# Options go to snakemake: submit.sh --profile slurm
set -eu
here=$(cd "$(dirname "$0")" && pwd)
exec snakemake --snakefile "$here/Snakefile" --directory "$here" --cores all "$@"
)sh";

/// A job type of Flamenco 3: goes into the `scripts` folder of the manager once.
constexpr const char* flamenco_type = R"sh(const JOB_TYPE = {
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
)sh";

constexpr const char* flamenco_submit = R"sh(#!/bin/bash
# Sends the job to a Flamenco manager that has render2mpeg-film.js among its scripts: FLAMENCO=http://manager:8080 submit.sh
set -eu
here=$(cd "$(dirname "$0")" && pwd)
exec curl --fail --silent --show-error -X POST -H 'Content-Type: application/json' --data "@$here/job.json" "$@" \
    "${FLAMENCO:-http://localhost:8080}/api/v3/jobs"
)sh";

json flamenco_job(const FarmPlan& plan) {
    return {{"name", plan.output_name},
            {"type", "render2mpeg-film"},
            {"priority", 50},
            {"submitter_platform", "linux"},
            {"settings", {{"program", program_of(plan)}, {"plan", plan.folder.string()}, {"parts", plan.parts.size()}}},
            {"metadata", {{"film", plan.output_name}}}};
}

}  // namespace

std::vector<JobFile> service_job_files(const FarmPlan& plan) {
    if (plan.scheduler == "kubernetes")
        return {{"parts.json", json_text(kubernetes_parts(plan))},
                {"join.json", json_text(kubernetes_join(plan))},
                {"submit.sh", fmt::format(fmt::runtime(kubernetes_submit), fmt::arg("name", object_name(plan))), true}};
    if (plan.scheduler == "openjd")
        return {{"template.json", json_text(openjd_template(plan))}, {"submit.sh", openjd_submit, true}};
    if (plan.scheduler == "snakemake")
        return {{"Snakefile", fmt::format(fmt::runtime(snakefile), fmt::arg("parts", plan.parts.size()),
                                          fmt::arg("program", json(program_of(plan)).dump()),
                                          fmt::arg("plan", json(plan.folder.string()).dump()))},
                {"submit.sh", snakemake_submit, true}};
    return {{"render2mpeg-film.js", flamenco_type},
            {"job.json", json_text(flamenco_job(plan))},
            {"submit.sh", flamenco_submit, true}};
}

}  // namespace render2mpeg::app
