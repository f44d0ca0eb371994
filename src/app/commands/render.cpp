#include "app/commands/commands.h"

#include <fmt/format.h>

#include <memory>
#include <new>
#include <nlohmann/json.hpp>
#include <optional>

#include "app/commands/render_stream.h"
#include "app/estimate/forecast.h"
#include "app/estimate/hire.h"
#include "app/files/file_io.h"
#include "app/files/publish.h"
#include "app/loop/kept_frames.h"
#include "app/production/production.h"
#include "app/production/resume.h"
#include "app/report/frame_view.h"
#include "app/report/side_film.h"
#include "app/report/statistics.h"
#include "app/report/summary.h"
#include "app/system/image_reader.h"
#include "app/system/interrupt.h"
#include "app/system/terminal.h"
#include "core/error.h"
#include "core/text.h"
#include "parallel/loops.h"

namespace render2mpeg::app {
namespace {

int interrupted_before_frames(const RenderOptions& options) {
    if (!options.quiet) print_line("interrupted before the first frame: nothing was written");
    return InterruptGuard::status();
}

/// Forecast (as far as --within allows) and plan. Settles the film.
std::string plan_text(RenderJob& film, const RenderOptions& options) {
    const double within = options.within;
    const auto found = within > 0 ? forecast(film, options.output, within, options.quiet) : std::nullopt;
    const bool is_lit = found && !found->is_least;
    return film_text(film) + "\n" + (found ? text_of(*found) : "") +
           (is_lit ? hire_text(film, *found, options.hire, options.quiet) : "") +
           text_of(chunks_at_once(film, options)) + "\n\n" + plan_table(film, is_lit ? &found->sample : nullptr);
}

std::string dry_run_text(RenderJob& film, const RenderOptions& options) {
    const auto chunks = film.chunks();
    return fmt::format("{}: would render frames {} to {} ({:.2f} s at {} Hz) of {} at {}x{}, in {}\n",
                       core::printable(options.output.string()), film.frames.first, film.frames.last,
                       static_cast<double>(film.frame_count()) / film.rate.hertz.value(), film.rate.name,
                       core::printable(film.animation->source), film.format.width, film.format.height,
                       core::counted(chunks.size(), "chunk")) +
           plan_text(film, options);
}

/// Fate of chunks that an earlier run of this film left; empty where there are none.
std::string left_text(const RenderJob& film, const RenderOptions& options, const nlohmann::json& identity) {
    const std::vector<Chunk> chunks = film.chunks();
    std::int64_t done = 0;
    for (const Chunk& chunk : WorkFolder::left(options.output, identity, chunks)) done += chunk.frames();
    if (WorkFolder::is_of(options.output, identity)) done += lit_frames_in(options.output, chunks);
    if (done == 0) return {};
    return fmt::format("{}: {} of {} frames are left of an earlier run, {}", options.output.string(), done,
                       film.frame_count(),
                       options.resume ? "which goes on" : "and given up, since --resume is not given");
}

/// Whether an interrupted run of this film goes on, or its images are made again: no consent is needed.
bool is_agreed(const RenderJob& film, const RenderOptions& options, const nlohmann::json& identity) {
    return options.overwrite ||
           ((options.resume || !is_one_file(film.kind)) && WorkFolder::is_of(options.output, identity));
}

}  // namespace

int render(const RenderOptions& options, const std::string& command, Rendered* rendered) try {
    if (options.as) return render_stream(options, command);
    const WallClock clock;
    const parallel::ThreadLimit threads(options.threads);
    const InterruptGuard guard(options.quiet);

    check_before_reading(options);
    RunStatistics statistics;
    RenderJob film = timed(statistics, Stage::load, [&] { return prepare_within_memory(options); });
    if (InterruptGuard::requested()) return interrupted_before_frames(options);
    print_notes(film, options);
    check_outputs(film, options);
    const nlohmann::json identity = timed(statistics, Stage::load, [&] { return identity_of(film, options); });
    // `tune` needs the statistics of a render.
    if (rendered == nullptr && is_done_already(film, options, identity)) return 0;
    if (options.resume) WorkFolder::check(options.output, identity);
    const std::string left = left_text(film, options, identity);
    if (options.dry_run) {
        if (!options.quiet) print((left.empty() ? "" : core::printable(left) + "\n") + dry_run_text(film, options));
        if (!options.quiet && !is_agreed(film, options, identity))
            for (const std::string& line : doubts_about(written_by(film, options))) print_line(line);
        return 0;
    }
    require_consent(written_by(film, options), is_agreed(film, options, identity));
    if (!options.memory) timed(statistics, Stage::load, [&] { return film.images->read_ahead(image_probes(false)); });
    if (InterruptGuard::requested()) return interrupted_before_frames(options);
    if (!options.quiet && !options.resume && !left.empty()) print_line(left);
    const std::unique_ptr<WorkFolder> work = open_outputs(film, options, identity);
    SideFilms side_films(options, film, *work);
    std::vector<ChunkFile> files = take_up(
        film, options, *work, [&](const std::vector<ChunkFile>& kept) { side_films.take_up(kept); }, statistics);
    settle(film, options, *work, statistics);
    if (InterruptGuard::requested()) return interrupted_before_frames(options);

    if (options.verbose)
        print(film_text(film) + "\n" + text_of(chunks_at_once(film, options)) + "\n" + plan_table(film));
    SampleFrameObserver sample_frame(film);
    if (options.report) take_up(sample_frame, files);
    const OpenRender open{film, options, identity, clock, *work, side_films, sample_frame, statistics, files};
    const bool complete = render_chunks(open);

    RunFacts facts{command, options.input.string(), options.output.string(), 0, false};
    publish_all(open, complete, facts, rendered != nullptr ? "the command above" : "the same command");
    if (rendered != nullptr) *rendered = {statistics, facts.output, facts.bytes};
    return complete ? 0 : InterruptGuard::status();
} catch (const std::bad_alloc&) {
    if (!options.memory) throw;
    throw core::Error("rendering", options.input.string(),
                      "it takes more memory than " + options.as_said("--memory") + " allows");
}

int plan(const RenderOptions& options) {
    const parallel::ThreadLimit threads(options.threads);
    const InterruptGuard guard(options.quiet);
    RenderJob film = prepare_within_memory(options);
    print_notes(film, options);
    print(plan_text(film, options));
    return InterruptGuard::requested() ? InterruptGuard::status() : 0;
}

}  // namespace render2mpeg::app
