#include "app/farm/farm.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "app/farm/farm_plan.h"
#include "app/farm/pieces.h"
#include "app/files/file_io.h"
#include "app/files/publish.h"
#include "app/files/work_folder.h"
#include "app/loop/run_statistics.h"
#include "app/options/options.h"
#include "app/options/output_kind.h"
#include "app/production/production.h"
#include "app/production/resume.h"
#include "app/report/frame_view.h"
#include "app/report/side_film.h"
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
    for (SideFilmRequest& beside : moved.side_films) beside.file = folder / beside.file.filename();
    return moved;
}

/// What there is of a part, with its results.
struct MadePart {
    std::vector<ChunkFile> chunks;
    RunStatistics statistics;
};

/// Reads the results of a part: its whole chunks, verified by their checksums.
MadePart made_part(const FarmPlan& plan, const FilmPart& part, const RenderJob& job, const RenderOptions& options,
                   SideFilms& side_films) {
    const json& identity = plan.facts->at("identity");
    MadePart made;
    RenderOptions own = part_options(plan, part, options);
    own.quiet = true;
    if (!WorkFolder::is_of(own.output, identity)) return made;
    WorkFolder work(own.output, identity, WorkFolder::Earlier::resumed, Locking::where_possible);
    SideFilms shown(own, job, work);
    made.chunks = take_up(
        job, own, work, [](const std::vector<ChunkFile>&) {}, made.statistics);
    shown.take_up(made.chunks);
    side_films.append(shown);
    return made;
}

/// The chunks that are missing, by the part and frames: "part 2 (frames 60-179)".
class Missing {
  public:
    void look(const FilmPart& part, const std::vector<Chunk>& chunks, const std::vector<ChunkFile>& made) {
        std::string frames;
        std::optional<FrameRange> gap;
        const auto end_gap = [&] {
            if (gap) frames += fmt::format("{}{}-{}", frames.empty() ? "" : ", ", gap->first, gap->last);
            gap.reset();
        };
        for (const Chunk& chunk : chunks) {
            const bool there = std::ranges::find(made, chunk.index, index_of) != made.end();
            if (there)
                end_gap();
            else
                gap = {gap ? gap->first : chunk.first, chunk.last};
        }
        end_gap();
        if (frames.empty()) return;
        parts_.push_back(part.number);
        // chosen: a line that can be read.
        if (parts_.size() <= 8)
            text_ += fmt::format("{}part {} (frames {})", text_.empty() ? "" : ", ", part.number, frames);
    }
    /// Throws core::Error where there are some.
    void refuse(const FarmPlan& plan) const {
        if (parts_.empty()) return;
        throw core::Error(
            "joining", plan.folder.string(),
            fmt::format(
                "{} of {} parts are not whole: {}; there is no {}; `render2mpeg part {} {}` goes on with the first",
                parts_.size(), plan.parts.size(), part_list(parts_), text_ + (parts_.size() > 8 ? " and more" : ""),
                quoted(plan.folder.string()), parts_.front()));
    }

  private:
    std::vector<int> parts_;
    std::string text_;
};

void place_images(const RenderJob& film, const RenderOptions& from, const RenderOptions& to, const FrameRange& frames) {
    const std::vector<std::filesystem::path> made = images_of(film, from, frames), named = images_of(film, to, frames);
    for (std::size_t i = 0; i < made.size(); ++i) place(made[i], named[i]);
}

/// All parts of the film, proved and placed: its chunks, what was counted, and its films beside. Throws core::Error,
/// naming the parts that are not whole.
std::vector<ChunkFile> gather(const FarmPlan& plan, const RenderJob& film, const RenderOptions& options,
                              SideFilms& side_films, RunStatistics& statistics) {
    std::vector<ChunkFile> chunks;
    Missing missing;
    for (const FilmPart& part : plan.parts) {
        RenderJob job = film;
        job.part = part.chunks;
        MadePart made = made_part(plan, part, job, options, side_films);
        missing.look(part, job.chunks(), made.chunks);
        statistics = sum_of(statistics, made.statistics);
        for (ChunkFile& chunk : made.chunks) chunks.push_back(std::move(chunk));
    }
    missing.refuse(plan);
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

/// Throws core::Error where a joined plan is asked for another film, or for one that is gone.
void refuse_second_film(const FarmPlan& plan, const std::filesystem::path& wanted) {
    std::string joined = file_text(plan.joined_mark());
    joined.erase(joined.find_last_not_of('\n') + 1);
    const bool is_gone = is_one_file(kind_of(wanted)) && !is_file(joined);
    if (!is_gone && canonical_of(wanted) == canonical_of(joined)) return;
    throw core::Error("joining", plan.folder.string(),
                      "it was joined already, as " + joined + (is_gone ? ", which is gone" : "") +
                          ", and the parts went with that; " + (is_gone ? "" : "copy that film, or ") +
                          "make a new plan with `render2mpeg farm`");
}

}  // namespace

int join(const PartOptions& wish) {
    const WallClock clock;
    const parallel::ThreadLimit threads(wish.threads);
    const FarmPlan plan = read_plan(wish.plan);
    if (wish.pieces && !plan.is_joined())
        for (const std::string& line : take_pieces(plan, plan.parts, *wish.pieces)) print_line(line);
    std::error_code error;
    const std::filesystem::path into = wish.folder ? std::filesystem::absolute(*wish.folder, error) : "";
    if (!plan.is_joined()) refuse_other_machine(plan);
    RenderOptions options = options_of(plan);
    const std::string command = line_of(plan.words);
    if (wish.folder) options = moved_into(into, options);
    if (plan.is_joined()) {
        refuse_second_film(plan, options.output);
        if (!wish.quiet) print_line(plan.folder.string() + ": the film is joined already: nothing is to be done");
        return 0;
    }
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
    SideFilms side_films(options, film, *work);
    std::vector<ChunkFile> files = gather(plan, film, options, side_films, statistics);
    SampleFrameObserver sample_frame(film);
    if (options.report) take_up(sample_frame, files);
    const OpenRender open{film, options, identity, clock, *work, side_films, sample_frame, statistics, files};
    RunFacts facts{command, options.input.string(), options.output.string(), 0, false};
    if (publish_all(open, true, facts, "the same command")) remove_parts(plan, options.output);
    return 0;
}

}  // namespace render2mpeg::app
