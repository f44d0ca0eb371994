#include "app/farm/job_files.h"

#include <fmt/format.h>

#include <cctype>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <system_error>

#include "app/files/file_io.h"
#include "app/options/options.h"
#include "core/error.h"
#include "core/module.h"
#include "core/text.h"

namespace render2mpeg::app {
namespace {

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

/// A name as a string of JSON, and of Python.
std::string in_json(const std::string& name) {
    return nlohmann::json(name).dump();
}

/// This program by its full name; packed films run the one that PATH has.
std::string program_of(const FarmPlan& plan) {
    std::error_code error;
    const std::filesystem::path own = std::filesystem::read_symlink("/proc/self/exe", error);
    return error || plan.packed ? "render2mpeg" : own.string();
}

/// Characters that a scheduler replaces by values of its own wherever a folder's name comes to it, and that cannot be
/// quoted there: in logs' names (Slurm, SGE), in the words of all commands (Flamenco), in a mount's path (Kubernetes).
std::string_view replaced_by(const std::string& scheduler) {
    return scheduler == "slurm"        ? "%\\"
           : scheduler == "sge"        ? "$"
           : scheduler == "flamenco"   ? "{"
           : scheduler == "kubernetes" ? ":"
                                       : "";
}

/// Refuses what cannot be one word of sh and one string of JSON: other bytes than UTF-8, and control characters, which
/// also end the comments that schedulers read.
void refuse_unquotable(const std::string& name, const std::string& scheduler) {
    if (core::printable(name) != name)
        throw core::Error("writing job files for", name,
                          "a name in job files is one line of UTF-8 without control characters; rename it");
    if (const std::size_t at = name.find_first_of(replaced_by(scheduler)); at != name.npos)
        throw core::Error("writing job files for", name,
                          fmt::format("{} would replace what follows {}; rename it", scheduler, name[at]));
}

/// Values of the names between @. Only `places`, for sh, and strings of JSON hold names of files; schedulers' own
/// comments and replacements see none.
std::map<std::string, std::string> values_of(const FarmPlan& plan) {
    const std::string program = program_of(plan), folder = plan.folder.string();
    std::string object = job_name(plan.output_name.substr(0, 40), "", '-') + "-x";  // [RFC 1123]
    for (char& c : object) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return {{"name", job_name(plan.output_name.substr(0, 100), ".-", '_')},
            {"object", object},
            {"parts", std::to_string(plan.parts.size())},
            {"places", fmt::format("program=${{RENDER2MPEG:-{}}}\nplan={}\n", quoted(program),
                                   plan.packed ? "$PWD" : quoted(folder))},
            {"program", in_json(program)},
            {"plan", in_json(folder)},
            {"parent", in_json(plan.folder.parent_path().string())}};
}

/// The text with the values of the names between @; an @ before anything else stays.
std::string filled(std::string text, const std::map<std::string, std::string>& values) {
    for (std::size_t at = text.find('@'), end = 0; at != text.npos; at = text.find('@', at)) {
        if ((end = text.find('@', at + 1)) == text.npos) break;
        const auto value = values.find(text.substr(at + 1, end - at - 1));
        if (value != values.end()) text.replace(at, end + 1 - at, value->second);
        at += value != values.end() ? value->second.size() : 1;
    }
    return text;
}

/// Text of each file by its name. Throws core::Error where a scheduler has none.
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

}  // namespace

void check_job_files(const FarmPlan& plan) {
    for (const std::string& name : {plan.folder.string(), program_of(plan)}) refuse_unquotable(name, plan.scheduler);
    job_templates(plan.scheduler);
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

}  // namespace render2mpeg::app
