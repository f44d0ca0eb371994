#include "app/farm/job_files.h"

#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <sstream>
#include <system_error>

#include "app/files/text_file.h"
#include "core/error.h"

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

bool is_at_hand(const std::string& program) {
    const char* path = std::getenv("PATH");
    std::istringstream folders(path == nullptr ? "" : path);
    for (std::string folder; std::getline(folders, folder, ':');)
        if (access((std::filesystem::path(folder) / program).c_str(), X_OK) == 0) return true;
    return false;
}

/// What earlier jobs noted as done may have been removed since; parts know themselves what is left to be done.
void forget_notes(const std::filesystem::path& log) {
    std::error_code ignored;
    for (const auto& entry : std::filesystem::directory_iterator(log, ignored))
        if (entry.path().extension() == ".done" || entry.path().extension() == ".joblog")
            std::filesystem::remove(entry.path(), ignored);
}

}  // namespace

std::string places_text(const FarmPlan& plan) {
    std::error_code error;
    const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", error);
    return fmt::format("program=${{RENDER2MPEG:-{}}}\nplan={}\n",
                       error || plan.packed ? "render2mpeg" : quoted(program.string()),
                       plan.packed ? "$(cd \"$(dirname \"$0\")\" && pwd)" : quoted(plan.folder.string()));
}

JobFiles write_job_files(const FarmPlan& plan) {
    std::error_code error;
    std::filesystem::create_directories(plan.folder / "log", error);
    forget_notes(plan.folder / "log");
    const bool batch = plan.scheduler == "slurm" || plan.scheduler == "sge" || plan.scheduler == "parallel";
    for (const JobFile& file : batch ? batch_job_files(plan) : service_job_files(plan)) {
        write_whole(plan.folder / file.name, file.text);
        if (file.runs)
            std::filesystem::permissions(plan.folder / file.name,
                                         std::filesystem::perms::owner_exec | std::filesystem::perms::group_exec,
                                         std::filesystem::perm_options::add, error);
    }
    const std::filesystem::path script = plan.folder / "submit.sh";
    return {script, needed_by(plan.scheduler), script.string() + " submits them"};
}

int submit(const FarmPlan& plan, const JobFiles& files) {
    if (!is_at_hand(files.needs))
        throw core::Error(
            "submitting", plan.folder.string(),
            fmt::format("there is no {} here; run {} where there is", files.needs, files.script.string()));
    const pid_t child = fork();
    if (child == 0) {
        execl(files.script.c_str(), files.script.c_str(), static_cast<char*>(nullptr));
        _exit(127);
    }
    int status = 0;
    while (child > 0 && waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
    if (child < 0) throw core::Error("submitting", plan.folder.string(), "no process to be had");
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 0)
        throw core::Error("submitting", plan.folder.string(), files.script.string() + " failed");
    return 0;
}

}  // namespace render2mpeg::app
