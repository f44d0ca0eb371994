#include "app/farm/farm.h"

#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "app/farm/farm_plan.h"
#include "app/files/file_io.h"
#include "app/files/publish.h"
#include "app/files/work_folder.h"
#include "app/loop/resume.h"
#include "app/loop/run_statistics.h"
#include "app/options/options.h"
#include "app/options/output_kind.h"
#include "app/production/production.h"
#include "app/report/frame_view.h"
#include "app/report/heatmap_film.h"
#include "app/system/interrupt.h"
#include "app/system/terminal.h"
#include "core/error.h"
#include "parallel/loops.h"

namespace render2mpeg::app {
namespace {

using nlohmann::json;

/// Where everything goes by its own name.
RenderOptions moved_into(const std::filesystem::path& folder, const RenderOptions& options) {
    RenderOptions moved = options;
    moved.output = folder / options.output.filename();
    if (options.stats) moved.stats = folder / options.stats->filename();
    if (options.report) moved.report = folder / options.report->filename();
    if (options.layers) moved.layers = folder / options.layers->lexically_normal().filename();
    for (auto& [subject, name] : moved.heatmaps) name = (folder / std::filesystem::path(name).filename()).string();
    return moved;
}

/// A finished part, with its results.
struct MadePart {
    RenderOptions options;  ///< that it was made by
    std::vector<ChunkFile> chunks;
    RunStatistics statistics;
};

/// Reads the results of a part: all of its chunks, verified by their checksums. None where it is not whole.
std::optional<MadePart> made_part(const FarmPlan& plan, const FilmPart& part, const RenderJob& film,
                                  const RenderOptions& options, HeatmapFilms& heatmaps) {
    const json& identity = plan.facts->at("identity");
    MadePart made{part_options(plan, part, options), {}, {}};
    made.options.quiet = true;
    if (!WorkFolder::is_of(made.options.output, identity)) return {};
    RenderJob job = film;
    job.part = part.chunks;
    WorkFolder work(made.options.output, identity, WorkFolder::Earlier::resumed);
    HeatmapFilms shown(made.options, job, work);
    made.chunks = take_up(
        job, made.options, work, [](const std::vector<ChunkFile>&) {}, made.statistics);
    if (made.chunks.size() < part.chunks.count()) return {};
    shown.take_up(made.chunks);
    heatmaps.append(shown);
    return made;
}

void place_images(const RenderJob& film, const RenderOptions& from, const RenderOptions& to, const FrameRange& frames) {
    const bool images = film.kind == OutputKind::exr || film.kind == OutputKind::png;
    for (std::int64_t n = frames.first; n <= frames.last; ++n) {
        if (images) place(numbered(from.output, n), numbered(to.output, n));
        if (!to.layers) continue;
        place(numbered(layers_in(*from.layers), n), numbered(layers_in(*to.layers), n));
        place(numbered(motion_in(*from.layers), n), numbered(motion_in(*to.layers), n));
    }
}

/// All parts of the film, proved and placed: its chunks, what was counted, and its heatmaps. Throws core::Error, naming
/// the parts that are not whole.
std::vector<ChunkFile> gather(const FarmPlan& plan, const RenderJob& film, const RenderOptions& options,
                              HeatmapFilms& heatmaps, RunStatistics& statistics) {
    std::vector<ChunkFile> chunks;
    std::vector<int> missing;
    for (const FilmPart& part : plan.parts) {
        std::optional<MadePart> made = made_part(plan, part, film, options, heatmaps);
        if (!made) {
            missing.push_back(part.number);
            continue;
        }
        statistics = sum_of(statistics, made->statistics);
        for (ChunkFile& chunk : made->chunks) chunks.push_back(std::move(chunk));
    }
    if (!missing.empty())
        throw core::Error(
            "joining", plan.folder.string(),
            fmt::format("{} of {} parts are not whole: {}; `render2mpeg part {} {}` goes on with the first",
                        missing.size(), plan.parts.size(), part_list(missing), quoted(plan.folder.string()),
                        missing.front()));
    for (const FilmPart& part : plan.parts) place_images(film, part_options(plan, part, options), options, part.frames);
    return chunks;
}

RunStatistics cost_of(const FarmPlan& plan) {
    RunStatistics statistics;
    const json& cost = plan.facts->at("cost");
    cost.at("seconds").get_to(statistics.seconds);
    statistics.earlier_wall = cost.at("wall").get<double>();
    statistics.earlier_cpu = cost.at("cpu").get<double>();
    return statistics;
}

/// Removes the intermediate files of the parts, once the film exists.
void remove_parts(const FarmPlan& plan, const std::filesystem::path& film) {
    std::error_code ignored;
    write_whole(plan.joined_mark(), film.string() + "\n");
    for (const FilmPart& part : plan.parts) std::filesystem::remove_all(plan.folder_of(part), ignored);
}

}  // namespace

int join(const PartOptions& wish) {
    const WallClock clock;
    const parallel::ThreadLimit threads(wish.threads);
    const FarmPlan plan = read_plan(wish.plan);
    if (plan.is_joined()) {
        if (!wish.quiet) print_line(plan.folder.string() + ": the film is joined already: nothing is to be done");
        return 0;
    }
    std::error_code error;
    const std::filesystem::path into = wish.folder ? std::filesystem::absolute(*wish.folder, error) : "";
    refuse_other_machine(plan);
    RenderOptions options = options_of(plan);
    const std::string command = line_of(plan.words);
    if (wish.folder) options = moved_into(into, options);
    options.quiet = options.quiet || wish.quiet;
    const InterruptGuard guard(options.quiet);

    RunStatistics statistics = cost_of(plan);
    RenderJob film = timed(statistics, Stage::load, [&] { return prepare_within_memory(options); });
    timed(statistics, Stage::load, [&] { refuse_other_film(plan, film, options_of(plan)); });
    const json identity = identity_of(film, options);
    check_outputs(film, options);
    const std::unique_ptr<WorkFolder> work = open_outputs(film, options, identity);
    for (const auto& [name, value] : plan.facts->at("settled").items()) work->keep(name, value);
    settle(film, options, *work, statistics);
    HeatmapFilms heatmaps(options, film, *work);
    std::vector<ChunkFile> files = gather(plan, film, options, heatmaps, statistics);
    SampleFrameObserver sample_frame(film);
    if (options.report) take_up(sample_frame, files);
    const OpenRender open{film, options, identity, clock, *work, heatmaps, sample_frame, statistics, files};
    RunFacts facts{command, options.input.string(), options.output.string(), 0, false};
    if (publish_all(open, true, facts, "the same command")) remove_parts(plan, options.output);
    return 0;
}

}  // namespace render2mpeg::app
