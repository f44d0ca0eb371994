#include "app/commands/render.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <new>
#include <nlohmann/json.hpp>
#include <optional>

#include "app/files/consent.h"
#include "app/files/publish.h"
#include "app/files/text_file.h"
#include "app/loop/estimate.h"
#include "app/loop/film_identity.h"
#include "app/loop/memory_need.h"
#include "app/loop/pipeline.h"
#include "app/loop/resume.h"
#include "app/loop/sink.h"
#include "app/options/option_text.h"
#include "app/options/unused_options.h"
#include "app/report/heatmap_film.h"
#include "app/report/plan_table.h"
#include "app/report/report.h"
#include "app/report/sample_frame.h"
#include "app/report/statistics.h"
#include "app/report/summary.h"
#include "app/system/error_collector.h"
#include "app/system/interrupt.h"
#include "app/system/memory_limit.h"
#include "app/system/probes.h"
#include "app/system/progress.h"
#include "app/system/terminal.h"
#include "core/error.h"
#include "core/text.h"
#include "parallel/loops.h"

namespace render2mpeg::app {
namespace {

/// Prints what the scene lacks, and which options do nothing.
void print_notes(const RenderJob& film, const RenderOptions& options) {
    if (options.quiet) return;
    std::vector<std::string> notes = film.animation->notes;
    for (const std::string& line : unused_options(options, film.kind, film.tolerance)) notes.push_back(line);
    notes.push_back(film.kind == OutputKind::film ? unused_keyframes(film.keyframes, film.frames) : "");
    notes.push_back(film.kind == OutputKind::film ? keyframes_without_chapter(film.film()) : "");
    for (const std::string& note : notes)
        if (!note.empty()) print_line(note);
}

/// As prepare(), within the memory that the options allow. Not done where an interrupt was requested meanwhile.
RenderJob prepare_within_memory(const RenderOptions& options) {
    if (!options.memory) return prepare(options);
    const std::uint64_t limit = memory_from(*options.memory);
    hold_to(limit, parallel::thread_count());
    RenderJob film = prepare(options);
    if (!probe_images(*film.animation, image_probes(true))) return film;
    // Their headers may be read now.
    film.images_in_turn = !may_decode_at_once(film, memory_need(film), limit, parallel::thread_count());
    return film;
}

int interrupted_before_frames(const RenderOptions& options) {
    if (!options.quiet) print_line("interrupted before the first frame: nothing was written");
    return InterruptGuard::status();
}

/// What the film will take, as far as the options leave time to find it out, and what runs. The film is settled by it.
std::string plan_text(RenderJob& film, const RenderOptions& options, const std::filesystem::path& statistics = {}) {
    const double within = within_from(options.within);
    const auto estimate = within > 0 ? estimate_film(film, options.output, within, options.quiet) : std::nullopt;
    return film_text(film) + "\n" + (estimate ? text_of(film, *estimate) : "") + "\n" +
           plan_table(film, statistics, estimate ? std::optional(estimate->kept_records) : std::nullopt,
                      estimate ? &estimate->sample : nullptr);
}

std::string dry_run_text(RenderJob& film, const RenderOptions& options) {
    const auto chunks = chunks_of(film.frames, film.coding.gop);
    return fmt::format("{}: would render frames {} to {} ({:.2f} s at {} Hz) of {} at {}x{}, in {} chunk{}\n",
                       core::printable(options.output.string()), film.frames.first, film.frames.last,
                       static_cast<double>(film.frame_count()) / film.rate.hertz.value(), film.rate.name,
                       core::printable(film.animation->source), film.format.width, film.format.height, chunks.size(),
                       chunks.size() == 1 ? "" : "s") +
           plan_text(film, options);
}

/// What is done with chunks that an earlier run of this film left; empty where there are none.
std::string left_text(const RenderJob& film, const RenderOptions& options, const nlohmann::json& identity) {
    const std::vector<Chunk> chunks = chunks_of(film.frames, film.coding.gop);
    const std::size_t left = WorkFolder::left(options.output, identity, chunks);
    if (left == 0) return {};
    const std::int64_t done = chunks[left - 1].last + 1 - film.frames.first;
    return fmt::format("{}: {} of {} frames are left of an earlier run, {}", options.output.string(), done,
                       film.frame_count(),
                       options.resume ? "which goes on" : "and given up, since --resume is not given");
}

/// Whether the output is one file, which is made in a work folder.
bool is_one_file(const RenderJob& film) {
    return film.kind == OutputKind::film || film.kind == OutputKind::y4m;
}

WorkFolder::Earlier earlier_of(const RenderOptions& options) {
    return options.resume ? WorkFolder::Earlier::resumed : WorkFolder::Earlier::removed;
}

/// Refuses outputs that would take the place of other files, or show what there is none of. Writes nothing.
void check_outputs(const RenderJob& film, const RenderOptions& options) {
    std::vector<Files> outputs{is_one_file(film) ? Files(options.output) : Files(options.output, film.frames),
                               options.stats.value_or("")};
    for (const auto& [subject, file] : options.heatmaps) outputs.emplace_back(file);
    if (options.report) {
        outputs.emplace_back(*options.report);
        outputs.emplace_back(report_json_of(*options.report));
    }
    if (options.layers) outputs.emplace_back(layers_in(*options.layers), film.frames);
    check_apart(inputs_of(film, options), outputs);
    for (const Files& output : outputs)
        if (!output.name.empty()) check_reachable(output.name);
    if (options.report) check_report(*options.report);
    check_heatmaps(options, film);
    WorkFolder::check(options.output);
}

/// What is written, for those who are asked.
Wishes written_by(const RenderJob& film, const RenderOptions& options) {
    Wishes wishes;
    wishes.films.push_back(is_one_file(film) ? Files(options.output) : Files(options.output, film.frames));
    for (const auto& [subject, file] : options.heatmaps) wishes.films.emplace_back(file);
    for (const auto& file : {options.stats, options.report}) wishes.beside.push_back(file.value_or(""));
    // This folder is made, but not those that it is in.
    const std::filesystem::path layers = options.layers.value_or("");
    wishes.beside.push_back(layers.has_filename() ? layers : layers.parent_path());
    return wishes;
}

/// Whether nobody needs to be asked: what an interrupted run of this film began goes on, or its images are made again.
bool is_agreed(const RenderJob& film, const RenderOptions& options, const nlohmann::json& identity) {
    return options.overwrite || ((options.resume || !is_one_file(film)) && WorkFolder::is_of(options.output, identity));
}

/// Sees that all outputs can be written before hours go into them; from now on no other run has the film.
std::unique_ptr<WorkFolder> open_outputs(const RenderOptions& options, const nlohmann::json& identity) {
    check_writable(options.output);
    if (options.layers) check_writable(layers_in(*options.layers));
    if (options.stats) check_writable(*options.stats);
    if (options.report) check_writable(*options.report);
    if (options.report) check_writable(report_json_of(*options.report));
    for (const auto& [subject, file] : options.heatmaps) check_writable(file);
    return std::make_unique<WorkFolder>(options.output, identity, earlier_of(options));
}

/// The statistics with what the renderer has done since it was made.
RunStatistics totals_of(const RunStatistics& statistics, const renderer::Renderer& renderer) {
    RunStatistics sum = statistics;
    sum.rendering = sum_of(statistics.rendering, renderer.statistics());
    for (std::size_t i = 0; i < sum.pass_seconds.size(); ++i)
        sum.pass_seconds[i] += renderer.seconds(static_cast<renderer::Pass>(i));
    sum.pass_seconds[static_cast<std::size_t>(renderer::Pass::develop)] = sum.stage_seconds(Stage::develop);
    sum.pass_seconds[static_cast<std::size_t>(renderer::Pass::encode)] = sum.stage_seconds(Stage::encode);
    return sum;
}

/// Seconds on the clock of this run, and of those that it goes on from.
class WallClock {
  public:
    double seconds(const RunStatistics& statistics) const {
        return statistics.earlier_wall +
               std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    }

  private:
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// A render whose film is settled and whose outputs are open.
struct OpenRender {
    const RenderJob& film;
    const RenderOptions& options;
    const nlohmann::json& identity;
    const WallClock& clock;
    WorkFolder& work;
    HeatmapFilms& heatmaps;
    const SampleFrameObserver& sample_frame;
    RunStatistics& statistics;
    std::vector<ChunkFile>& files;  ///< of the chunks that were begun
};

/// What a chunk came to, for --verbose.
std::string chunk_text(const Chunk& chunk, const RunStatistics& statistics) {
    double seconds = 0, bytes = 0, quantiser = 0;
    for (const FrameEntry& entry : statistics.frames) {
        if (entry.frame < chunk.first || entry.frame > chunk.last) continue;
        seconds += entry.seconds;
        bytes += static_cast<double>(entry.bytes);
        quantiser += entry.mean_quantiser / static_cast<double>(chunk.frames());
    }
    return fmt::format("frames {} to {}: {:.2f} s of CPU, {:.0f} bytes, quantiser {:.1f}", chunk.first, chunk.last,
                       seconds, bytes, quantiser);
}

/// Renders the chunks that have no file yet, the last of them incompletely after an interruption. Returns whether the
/// film is whole.
bool render_chunks(const OpenRender& open, LoopObserver& observer) {
    const RenderJob& film = open.film;
    const RenderOptions& options = open.options;
    RunStatistics& statistics = open.statistics;
    std::vector<ChunkFile>& files = open.files;
    const std::vector<Chunk> chunks = chunks_of(film.frames, film.coding.gop);
    if (files.size() == chunks.size()) return true;
    renderer::Renderer renderer = renderer_of(film);
    Progress progress(film.frame_count(), options.quiet, "frame", Counted::frames, open.clock.seconds(statistics),
                      chunks.front().frames());
    if (!files.empty()) progress.advance_to(static_cast<std::int64_t>(statistics.frames.size()), film.frame_count());
    std::optional<LayersWriter> layers;
    if (options.layers) layers.emplace(*options.layers, film, statistics);
    bool whole = true;
    while (files.size() < chunks.size()) {
        const Chunk& chunk = chunks[files.size()];
        files.push_back(open.work.open(chunk));
        const std::unique_ptr<Sink> sink = make_sink(film, frames_of(film, options, open.work, chunk));
        ChunkWriter coded(files.back());
        LoopObservers products;
        if (film.kind == OutputKind::film) products.add(coded);
        if (sink) products.add(*sink);
        if (layers) products.add(*layers);
        products.add(observer);
        whole = render_chunk(film, renderer, chunk, products, statistics, [&] {
            progress.advance();
            return !InterruptGuard::requested();
        });
        if (sink) sink->finish();
        if (!whole) {
            files.back().abandon();
            break;
        }
        RunStatistics so_far = totals_of(statistics, renderer);
        so_far.earlier_wall = open.clock.seconds(statistics);
        so_far.earlier_cpu += cpu_seconds();
        files.back().finish(chunk_record_of(film, options, open.work, chunk, so_far));
        if (options.verbose) print_line(chunk_text(chunk, so_far));
        if (InterruptGuard::requested()) break;
    }
    statistics = totals_of(statistics, renderer);
    return whole && files.size() == chunks.size();
}

/// Gives the film its name, or what there is of it another.
Published publish_frames(const OpenRender& open, bool complete) {
    const RenderJob& film = open.film;
    const RenderOptions& options = open.options;
    if (film.kind == OutputKind::film) return publish(open.files, film.film(), open.work, options.output, complete);
    if (film.kind == OutputKind::y4m) {
        std::vector<std::filesystem::path> parts;
        for (const ChunkFile& chunk : open.files) parts.push_back(frames_of(film, options, open.work, chunk.chunk()));
        const std::filesystem::path file = open.work.begin("film.y4m");
        join_y4m(film, parts, file);
        return give_name(file, open.work, options.output, complete);
    }
    // Images have their names already.
    return {options.output, 0};
}

/// How many of the chunks are whole.
std::size_t whole_of(const std::vector<ChunkFile>& chunks) {
    return static_cast<std::size_t>(std::count_if(chunks.begin(), chunks.end(), [](const ChunkFile& chunk) {
        std::error_code error;
        return std::filesystem::exists(ChunkFile::record_of(chunk.file()), error);
    }));
}

/// As render_chunks(); the message of a failure ends with what is not lost by it.
bool render_or_explain(const OpenRender& open, LoopObserver& observer) {
    try {
        return render_chunks(open, observer);
    } catch (const core::Error& error) {
        const std::size_t whole = whole_of(open.files);
        if (whole == 0) throw;
        throw core::Error(std::string(error.what()) + "; " + resuming_text(open.film, whole));
    }
}

/// Writes the statistics and the report where they are asked for. Returns whether all was written.
bool write_about(const OpenRender& open, const RunFacts& facts, ErrorCollector& errors) {
    const RenderOptions& options = open.options;
    bool stats = !options.stats, report = !options.report;
    if (!stats)
        errors.attempt([&] {
            write_statistics(*options.stats, open.film, open.statistics, facts);
            stats = true;
        });
    if (!report)
        errors.attempt([&] {
            write_report(*options.report, open.film, open.statistics, facts, open.sample_frame.figures());
            report = true;
        });
    return stats && report;
}

/// Marks what is whole, and removes what it was made of: to be called when nothing of that is needed any more.
void clear_away(const OpenRender& open) {
    Products products = products_of(open.film, open.options);
    // A heatmap that failed while it was made can only be made anew.
    for (const std::filesystem::path& lost : open.heatmaps.lost()) std::erase(products.beside, lost);
    mark_as_whole(products, open.identity);
    open.heatmaps.clear_away();
    open.work.clear_away();  // last, since it knows of the others
}

/// Publishes what is whole; leaves what is not beside the target. `facts` get what came of it. `again`: the command
/// that goes on after an interruption. Whatever fails costs no more than itself; throws the first failure at the end.
void publish_all(const OpenRender& open, bool complete, RunFacts& facts, const std::string& again) {
    const bool quiet = open.options.quiet;
    ErrorCollector errors;
    bool published = false;
    errors.attempt([&] {
        const Published film_file = publish_frames(open, complete);
        facts.bytes = film_file.bytes;
        facts.output = film_file.name.string();
        facts.complete = complete;
        published = true;
    });
    bool all_written = complete && open.heatmaps.finish() && published;
    errors.attempt([&] { open.heatmaps.rethrow(); });
    open.statistics.wall = open.clock.seconds(open.statistics);
    all_written = write_about(open, facts, errors) && all_written;
    if (all_written) clear_away(open);
    if (complete && !all_written && !quiet) print_line(resuming_text(open.film, open.files.size()));
    if (!quiet && published) errors.attempt([&] { print(summary(open.film, open.statistics, facts)); });
    if (!complete && !quiet)
        print_line(fmt::format("interrupted after {} of {} frames; {}", open.statistics.frames.size(),
                               open.film.frame_count(), resuming_text(open.film, whole_of(open.files), again)));
    errors.rethrow();
}

}  // namespace

int render(const RenderOptions& options, const std::string& command, Rendered* rendered) try {
    const WallClock clock;
    const parallel::ThreadLimit threads(options.threads);
    const InterruptGuard guard(options.quiet);

    // Read and settle everything before anything is written.
    RunStatistics statistics;
    RenderJob film = timed(statistics, Stage::load, [&] { return prepare_within_memory(options); });
    if (InterruptGuard::requested()) return interrupted_before_frames(options);
    print_notes(film, options);
    check_outputs(film, options);
    const nlohmann::json identity = timed(statistics, Stage::load, [&] { return identity_of(film, options); });
    // `tune` looks at what it renders, and so renders.
    if (rendered == nullptr && is_done_already(film, options, identity)) return 0;
    if (options.resume) WorkFolder::check(options.output, identity);
    const std::string left = left_text(film, options, identity);
    if (options.dry_run) {
        if (!options.quiet) print((left.empty() ? "" : core::printable(left) + "\n") + dry_run_text(film, options));
        if (!options.quiet && !is_agreed(film, options, identity))
            for (const std::string& line : questions_about(written_by(film, options))) print_line(line);
        return 0;
    }
    ask_consent(written_by(film, options), is_agreed(film, options, identity));
    if (!options.memory)
        timed(statistics, Stage::load, [&] { return probe_images(*film.animation, image_probes(false)); });
    if (InterruptGuard::requested()) return interrupted_before_frames(options);
    if (!options.quiet && !options.resume && !left.empty()) print_line(left);
    const std::unique_ptr<WorkFolder> work = open_outputs(options, identity);
    HeatmapFilms heatmaps(options, film, identity, *work);
    std::vector<ChunkFile> files = take_up(
        film, options, *work, [&](std::size_t kept) { heatmaps.take_up(kept); }, statistics);
    settle(film, options, *work, statistics);
    if (InterruptGuard::requested()) return interrupted_before_frames(options);

    if (options.verbose) print(film_text(film) + "\n" + plan_table(film, {}));
    SampleFrameObserver sample_frame(film);
    LoopObservers observers;
    if (!heatmaps.empty()) observers.add(heatmaps);
    if (options.report) observers.add(sample_frame);
    const OpenRender open{film, options, identity, clock, *work, heatmaps, sample_frame, statistics, files};
    const bool complete = render_or_explain(open, observers);

    RunFacts facts{command, options.input.string(), options.output.string(), 0, false};
    publish_all(open, complete, facts, rendered != nullptr ? "the command above" : "the same command");
    if (rendered != nullptr) *rendered = {statistics, facts.output, facts.bytes};
    return complete ? 0 : InterruptGuard::status();
} catch (const std::bad_alloc&) {
    if (!options.memory) throw;
    throw core::Error("rendering", options.input.string(),
                      "it takes more memory than --memory " + *options.memory + " allows");
}

int plan(const PlanOptions& options) {
    const parallel::ThreadLimit threads(options.render.threads);
    const InterruptGuard guard(options.render.quiet);
    RenderJob film = prepare(options.render);
    print_notes(film, options.render);
    print(plan_text(film, options.render, options.statistics.value_or("")));
    return InterruptGuard::requested() ? InterruptGuard::status() : 0;
}

}  // namespace render2mpeg::app
