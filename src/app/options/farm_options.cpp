#include "app/options/farm_options.h"

#include <regex>
#include <string>
#include <vector>

#include "app/options/options.h"
#include "app/options/usage_error.h"
#include "app/system/memory_limit.h"

namespace render2mpeg::app {
namespace {

constexpr const char* farm_group = "Farm";
constexpr const char* farm_run_group = "Run";

void add_plan_argument(CLI::App& command, std::filesystem::path& plan) {
    command.add_option("PLAN", plan, "The folder that `farm` wrote, e.g. film.mpg.farm, or its plan.json")->required();
}

void add_threads_option(CLI::App& command, int& threads) {
    add_option(command, farm_run_group, "-j,--threads", threads,
               "Threads; 0: one per core. The film's bytes do not depend on it", range(0, 1024), shown);
}

}  // namespace

void add_spreading_options(CLI::App& command, FarmOptions& options) {
    add_option(command, farm_group, "--to", options.scheduler,
               "Who spreads the parts: job files for it are written beside the plan (docs/machines.md)",
               one_of(std::vector<std::string>(scheduler_names.begin(), scheduler_names.end())))
        ->required();
    CLI::Option* parts =
        add_option(command, farm_group, "--parts", options.parts,
                   "Parts to make, at most (default: one per chunk of some 60 frames, the least that a part has)", "N",
                   range(1, 1'000'000));
    add_option(command, farm_group, "--frames-per-part", options.frames_per_part,
               "Instead: frames of a part, to the nearest chunk", "N", range(1, 1'000'000'000))
        ->excludes(parts);
    add_flag(command, farm_group, "--pack", options.pack,
             "Copy all inputs into the folder, and the folder into one file, OUT.farm.tar: for machines that do "
             "not see this one's files");
    add_flag(command, farm_group, "--submit", options.submit,
             "Hand the parts that are not made yet to the scheduler, and the join behind them");
}

CLI::App* add_part_command(CLI::App& app, PartOptions& options) {
    CLI::App* command = app.add_subcommand("part", "Make one part of a film that `farm` has planned");
    command->footer(
        "Goes on where a try before was ended, and waits while another one makes the same part. Exit status: 0 the "
        "part is whole; 1 it failed, and another try may do better; 3 this machine, this version or the inputs are "
        "not those of the plan: another try here fails alike.\n"
        "Example: render2mpeg part film.mpg.farm 3");
    add_plan_argument(*command, options.plan);
    CLI::Option* number =
        command->add_option("I", options.number, "Which part, from 1")->check(range(1, 1'000'000).check);
    add_option(*command, farm_run_group, "--frames", options.frames,
               "Instead: all parts that begin with one of these frames", "A-B", contiguous_from)
        ->excludes(number);
    add_threads_option(*command, options.threads);
    add_option(*command, farm_run_group, "--memory", options.memory,
               "Most memory to take, e.g. 8G: refuse what would need more (default: as `farm` was told)", "SIZE",
               memory_from);
    add_flag(*command, farm_run_group, "--quiet", options.quiet, "Print nothing but errors");
    return command;
}

CLI::App* add_join_command(CLI::App& app, JoinOptions& options) {
    CLI::App* command = app.add_subcommand("join", "Put the parts of a film together");
    command->footer(
        "Proves that all parts are whole and of one film, puts them together, decodes the film to see that it holds "
        "what was made, and writes all that one run would have written beside it.\n"
        "Example: render2mpeg join film.mpg.farm");
    add_plan_argument(*command, options.plan);
    add_option(*command, farm_run_group, "--into", options.folder,
               "Write film, heatmaps, statistics, report and images into this folder (default: where `farm` was "
               "told)",
               "DIR");
    add_threads_option(*command, options.threads);
    add_flag(*command, farm_run_group, "--quiet", options.quiet, "Print nothing but errors");
    return command;
}

CLI::App* add_farm_status_command(CLI::App& app, FarmStatusOptions& options) {
    CLI::App* command = app.add_subcommand("farm-status", "Show how far the parts of a film are");
    command->footer("Example: render2mpeg farm-status film.mpg.farm");
    add_plan_argument(*command, options.plan);
    add_flag(*command, farm_run_group, "--left", options.left,
             "Print nothing but the numbers of parts that are not whole, as 1,3-5: for scripts");
    return command;
}

std::vector<std::string> render_words(const std::vector<std::string>& farm) {
    const std::vector<std::string> flags{"--submit", "--pack", "--quiet", "-v", "--verbose"};
    std::vector<std::string> without{"--to", "--parts", "--frames-per-part", "-j", "--threads", "--progress"};
    without.insert(without.end(), flags.begin(), flags.end());
    return changed_command(farm, "render", without, flags, {});
}

FrameRange contiguous_from(const std::string& text) {
    static const std::regex form("([0-9]{1,15})-([0-9]{1,15})");
    std::smatch found;
    FrameRange frames;
    if (std::regex_match(text, found, form)) frames = {std::stoll(found.str(1)), std::stoll(found.str(2))};
    if (found.empty() || frames.first > frames.last)
        throw UsageError(text + ": expected two frames with a dash between, as in 60-119");
    return frames;
}

}  // namespace render2mpeg::app
