#include "app/farm/job_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <system_error>

#include "app/files/file_io.h"
#include "app/system/program.h"
#include "core/error.h"
#include "core/module.h"

namespace render2mpeg::app {
namespace {

/// The program of each scheduler's that a submission calls.
std::string needed_by(const std::string& scheduler) {
    if (scheduler == "slurm") return "sbatch";
    if (scheduler == "sge") return "qsub";
    if (scheduler == "kubernetes") return "kubectl";
    if (scheduler == "flamenco") return "curl";
    return scheduler;  // parallel, openjd, snakemake
}

/// Removes the notes of earlier jobs: outputs noted as done may have been deleted since, and parts find their remaining
/// work themselves.
void forget_notes(const std::filesystem::path& log) {
    std::error_code ignored;
    for (const auto& entry : std::filesystem::directory_iterator(log, ignored))
        if (entry.path().extension() == ".done" || entry.path().extension() == ".joblog")
            std::filesystem::remove(entry.path(), ignored);
}

/// A job's name from the film's: letters and digits, other characters only where `others` has them.
std::string job_name(std::string_view film, std::string_view others, char instead) {
    std::string name = "r2m-";
    for (const char c : film)
        name +=
            std::isalnum(static_cast<unsigned char>(c)) != 0 || others.find(c) != std::string_view::npos ? c : instead;
    return name;
}

/// As JSON has it, and Python.
std::string in_json(const std::string& text) {
    return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

/// Values of the names between @.
std::map<std::string, std::string> values_of(const FarmPlan& plan) {
    std::error_code error;
    const std::filesystem::path own = std::filesystem::read_symlink("/proc/self/exe", error);
    // Else as PATH has it.
    const bool shared = !error && !plan.packed;
    const std::string program = shared ? own.string() : "render2mpeg", folder = plan.folder.string();
    std::string object = job_name(plan.output_name.substr(0, 40), "", '-') + "-x";  // [RFC 1123]
    for (char& c : object) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    std::int64_t most = 0;
    for (const FilmPart& part : plan.parts) most = std::max(most, part.frames.last + 1 - part.frames.first);
    return {{"name", job_name(plan.output_name, ".-", '_')},
            {"object", object},
            {"parts", std::to_string(plan.parts.size())},
            {"most", std::to_string(most)},
            {"frames", fmt::format("{}-{}", plan.parts.front().frames.first, plan.parts.back().frames.last)},
            {"log", (plan.folder / "log").string()},
            {"places", fmt::format("program=${{RENDER2MPEG:-{}}}\nplan={}\n", shared ? quoted(program) : program,
                                   plan.packed ? "$(cd \"$(dirname \"$0\")\" && pwd)" : quoted(folder))},
            {"program", in_json(program)},
            {"plan", in_json(folder)},
            {"parent", in_json(plan.folder.parent_path().string())},
            {"film", in_json(plan.output_name)},
            {"short_film", in_json(plan.output_name.substr(0, 100))},
            {"part_command", in_json("exec render2mpeg part " + quoted(folder) + " $((JOB_COMPLETION_INDEX + 1))")}};
}

/// The text with the values of the names between @; an @ before anything else stays.
std::string filled(std::string_view text, const std::map<std::string, std::string>& values) {
    std::string result;
    while (!text.empty()) {
        const std::size_t at = text.find('@'), end = text.find('@', at == text.npos ? at : at + 1);
        const auto value =
            end == text.npos ? values.end() : values.find(std::string(text.substr(at + 1, end - at - 1)));
        const bool known = value != values.end();
        result += text.substr(0, known ? at : std::min(at, text.size() - 1) + 1);
        if (known) result += value->second;
        text.remove_prefix(known ? end + 1 : std::min(at, text.size() - 1) + 1);
    }
    return result;
}

}  // namespace

std::map<std::filesystem::path, std::string> job_templates(const std::string& scheduler) {
    const std::filesystem::path folder = core::installed_file("farm/" + scheduler);
    std::map<std::filesystem::path, std::string> templates;
    std::error_code error;
    for (const auto& job : std::filesystem::directory_iterator(folder, error))
        if (job.is_regular_file(error) && !job.path().string().ends_with('~'))
            templates[job.path().filename()] = file_text(job.path());
    if (!templates.contains("submit.sh"))
        throw core::Error("reading", folder.string(), "there is no submit.sh for " + scheduler);
    return templates;
}

std::filesystem::path write_job_files(const FarmPlan& plan) {
    std::error_code error;
    std::filesystem::create_directories(plan.folder / "log", error);
    forget_notes(plan.folder / "log");
    const std::map<std::string, std::string> values = values_of(plan);
    for (const auto& [name, text] : job_templates(plan.scheduler)) {
        const std::filesystem::path file = plan.folder / name;
        write_whole(file, filled(text, values));
        if (text.starts_with("#!"))
            std::filesystem::permissions(file, std::filesystem::perms::owner_exec | std::filesystem::perms::group_exec,
                                         std::filesystem::perm_options::add, error);
    }
    return plan.folder / "submit.sh";
}

int submit(const FarmPlan& plan, const std::filesystem::path& script) {
    const std::string needed = needed_by(plan.scheduler);
    if (!is_installed(needed))
        throw core::Error("submitting", plan.folder.string(),
                          fmt::format("there is no {} here; run {} where there is", needed, script.string()));
    if (run_program({script.string()}, Output::passed_on).status != 0)
        throw core::Error("submitting", plan.folder.string(), script.string() + " failed");
    return 0;
}

}  // namespace render2mpeg::app
