#include "app/farm/farm.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <new>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <system_error>
#include <thread>
#include <vector>

#include "app/farm/farm_plan.h"
#include "app/farm/part_news.h"
#include "app/farm/pieces.h"
#include "app/files/file_io.h"
#include "app/files/work_folder.h"
#include "app/loop/kept_frames.h"
#include "app/options/usage_error.h"
#include "app/production/production.h"
#include "app/production/resume.h"
#include "app/report/frame_view.h"
#include "app/report/side_film.h"
#include "app/system/interrupt.h"
#include "app/system/progress.h"
#include "app/system/terminal.h"
#include "core/text.h"
#include "parallel/loops.h"

namespace render2mpeg::app {
namespace {

const FilmPart& wanted_of(const FarmPlan& plan, const PartOptions& options) {
    const auto wanted = std::ranges::find(plan.parts, options.number, &FilmPart::number);
    if (wanted == plan.parts.end())
        throw UsageError(fmt::format("part {}: the plan has parts 1 to {}", options.number, plan.parts.size()));
    return *wanted;
}

/// The part's work folder, with what earlier tries, here or elsewhere, left as pieces; waits while another process
/// makes the same part. None after an interruption.
std::unique_ptr<WorkFolder> open_part(const FarmPlan& plan, const FilmPart& part, const RenderOptions& options,
                                      const PartOptions& wish) {
    for (bool told = options.quiet; !InterruptGuard::requested(); told = true) {
        try {
            // One that is refused is made again.
            if (wish.pieces && is_there(*wish.pieces)) take_pieces(plan, {&part, 1}, *wish.pieces);
            return std::make_unique<WorkFolder>(options.output, plan.facts->at("identity"),
                                                WorkFolder::Earlier::resumed,
                                                wish.pieces ? Locking::where_possible : Locking::needed);
        } catch (const OutputInUse& in_use) {
            if (!told) print_line(std::string(in_use.what()) + "; waiting for it");
        }
        // chosen: a part takes minutes.
        std::this_thread::sleep_for(std::chrono::seconds(1));
    }
    return nullptr;
}

/// Stores the values settled for the whole film, where the part's folder does not have them yet.
void keep_settled(const FarmPlan& plan, WorkFolder& work) {
    for (const auto& [name, value] : plan.facts->at("settled").items())
        if (work.kept(name).is_null()) work.keep(name, value);
}

/// The plan's forecast of each frame of the film.
std::vector<double> prices_in(const FarmPlan& plan, const RenderJob& film) {
    std::vector<double> prices;
    for (const Chunk& chunk : chunks_of(film.frames, film.coding.gop)) {
        const double share = plan.shares[static_cast<std::size_t>(chunk.index)];
        prices.insert(prices.end(), static_cast<std::size_t>(chunk.frames()),
                      share / static_cast<double>(chunk.frames()));
    }
    return prices;
}

int render_part(const FarmPlan& plan, const FilmPart& part, const PartOptions& wish, PartReporter& reporter) {
    const WallClock clock;
    const parallel::ThreadLimit threads(wish.threads);
    const InterruptGuard guard(wish.quiet);
    RenderOptions whole = options_of(plan);
    whole.quiet = whole.quiet || wish.quiet;
    if (wish.memory) whole.memory = wish.memory;
    const RenderOptions options = part_options(plan, part, whole);
    const std::unique_ptr<WorkFolder> work = open_part(plan, part, options, wish);
    if (work == nullptr) return InterruptGuard::status();
    if (options.layers) std::filesystem::create_directories(*options.layers);

    RunStatistics statistics;
    RenderJob film = timed(statistics, Stage::load, [&] { return prepare_within_memory(options); });
    timed(statistics, Stage::load, [&] { refuse_other_film(plan, film, whole); });
    open_writers(film, options);
    if (!options.memory) timed(statistics, Stage::load, [&] { return film.images->read_ahead(image_probes(false)); });
    if (InterruptGuard::requested()) return InterruptGuard::status();
    film.part = part.chunks;
    keep_settled(plan, *work);

    SideFilms side_films(options, film, *work);
    RenderOptions silent = options;
    silent.quiet = true;
    std::vector<ChunkFile> files = take_up(
        film, silent, *work, [&](const std::vector<ChunkFile>& kept) { side_films.take_up(kept); }, statistics);
    settle(film, silent, *work, statistics);
    const std::int64_t there =
        static_cast<std::int64_t>(statistics.frames.size()) + lit_frames_in(options.output, film.chunks());
    if (!options.quiet)
        print_line(fmt::format("part {}: frames {} to {}{}", part.number, part.frames.first, part.frames.last,
                               there == 0 ? "" : fmt::format(", {} are there", there)));
    reporter.advance_to(static_cast<std::int64_t>(statistics.frames.size()));
    std::optional<PieceSender> sender;
    if (wish.pieces) sender.emplace(plan, part, film, options, wish).begin(files);
    SampleFrameObserver sample_frame(film);
    const OpenRender open{film,
                          options,
                          plan.facts->at("identity"),
                          clock,
                          *work,
                          side_films,
                          sample_frame,
                          statistics,
                          files,
                          [&](std::int64_t done) { reporter.advance_to(done); },
                          [&](const ChunkFile& chunk) {
                              if (sender) sender->send(chunk);
                          },
                          prices_in(plan, film)};
    const bool complete = render_chunks(open);
    try {
        side_films.rethrow();
    } catch (...) {
        // Nothing goes on from a film beside that broke off.
        work->remove();
        throw;
    }
    return complete && (!sender || sender->finish()) ? 0 : InterruptGuard::status();
}

int make_part(const FarmPlan& plan, const FilmPart& part, const PartOptions& options) {
    std::error_code error;
    std::filesystem::create_directories(plan.folder_of(part), error);
    PartReporter reporter(plan.folder_of(part), part.frames.count());
    try {
        refuse_other_machine(plan);
        const int status = render_part(plan, part, options, reporter);
        reporter.end(status == 0 ? PartState::done : PartState::interrupted);
        return status;
    } catch (const std::bad_alloc&) {
        reporter.end(PartState::failed, "out of memory");
        throw;
    } catch (const Interrupted&) {
        reporter.end(PartState::interrupted);
        throw;
    } catch (const std::exception& failure) {
        reporter.end(PartState::failed, failure.what());
        throw;
    }
}

}  // namespace

int make_part(const PartOptions& wish) {
    PartOptions options = wish;
    // The plan's words change the current folder.
    std::error_code error;
    options.from = std::filesystem::current_path(error);
    if (wish.pieces) options.pieces = std::filesystem::absolute(*wish.pieces, error).lexically_normal();
    const FarmPlan plan = read_plan(options.plan);
    const FilmPart& part = wanted_of(plan, options);
    if (plan.is_joined()) {
        if (!options.quiet) print_line(plan.folder.string() + ": the film is joined already: nothing is to be done");
        return 0;
    }
    return make_part(plan, part, options);
}

}  // namespace render2mpeg::app
