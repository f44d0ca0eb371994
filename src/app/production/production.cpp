#include "app/production/production.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <system_error>

#include "app/files/publish.h"
#include "app/files/text_file.h"
#include "app/loop/counters.h"
#include "app/loop/pipeline.h"
#include "app/loop/resume.h"
#include "app/loop/sink.h"
#include "app/report/report.h"
#include "app/report/summary.h"
#include "app/system/error_collector.h"
#include "app/system/interrupt.h"
#include "app/system/progress.h"
#include "app/system/terminal.h"
#include "core/error.h"

namespace render2mpeg::app {
namespace {

/// In a chunk's record: figures for the report of the frame that it shows.
constexpr const char* sample_frame_name = "sample_frame";

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
bool render_whole_chunks(const OpenRender& open) {
    const RenderJob& film = open.film;
    const RenderOptions& options = open.options;
    RunStatistics& statistics = open.statistics;
    std::vector<ChunkFile>& files = open.files;
    const std::vector<Chunk> chunks = film.chunks();
    if (files.size() == chunks.size()) return true;
    const std::int64_t frames = chunks.back().last + 1 - chunks.front().first;
    tell_activity("building");
    const bool takes_turns = film.kind == OutputKind::film && film.coding.b_pictures > 0;
    Progress progress(frames, options.quiet, "frame", Counted::frames, open.clock.seconds(statistics),
                      chunks.front().frames(), takes_turns);
    if (!files.empty()) progress.advance_to(static_cast<std::int64_t>(statistics.frames.size()), frames);
    renderer::Renderer renderer = renderer_of(film);
    std::optional<LayersWriter> layers;
    if (options.layers) layers.emplace(*options.layers, film, statistics);
    std::optional<LastFrameWriter> last_frame;
    if (options.last_frame) last_frame.emplace(*options.last_frame, film);
    bool whole = true;
    while (files.size() < chunks.size()) {
        const Chunk& chunk = chunks[files.size()];
        const std::size_t before = statistics.frames.size();
        files.push_back(open.work.open(chunk));
        const std::unique_ptr<Sink> sink = make_sink(film, frames_of(film, options, open.work, chunk));
        ChunkWriter coded(files.back());
        LoopObservers products;
        if (film.kind == OutputKind::film) products.add(coded);
        if (sink) products.add(*sink);
        if (layers) products.add(*layers);
        if (last_frame) products.add(*last_frame);
        if (!open.heatmaps.empty()) products.add(open.heatmaps);
        if (options.report) products.add(open.sample_frame);
        whole = render_chunk(film, renderer, chunk, products, statistics, [&] {
            progress.advance();
            if (open.frames_done) open.frames_done(static_cast<std::int64_t>(statistics.frames.size()));
            return !InterruptGuard::requested();
        });
        if (sink) sink->finish();
        if (!whole) {
            files.back().abandon();
            // What was stopped before its first frame is nothing.
            if (statistics.frames.size() == before) files.pop_back();
            break;
        }
        RunStatistics so_far = totals_of(statistics, renderer);
        so_far.earlier_wall = open.clock.seconds(statistics);
        so_far.earlier_cpu += cpu_seconds();
        nlohmann::json record = chunk_record_of(film, options, open.work, chunk, so_far);
        if (open.sample_frame.is_in(chunk)) record[sample_frame_name] = open.sample_frame.figures();
        files.back().finish(record);
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
        for (const ChunkFile& chunk : open.files)
            parts.push_back(std::filesystem::path(chunk.file()).replace_extension(".y4m"));
        const std::filesystem::path file = open.work.begin("film.y4m");
        join_y4m(film, parts, file);
        return give_name(file, open.work, options.output, complete);
    }
    // Images have their names already.
    return {options.output, 0};
}

}  // namespace

void take_up(SampleFrameObserver& sample_frame, const std::vector<ChunkFile>& chunks) {
    for (const ChunkFile& chunk : chunks)
        if (sample_frame.is_in(chunk.chunk())) sample_frame.take_up(chunk.facts().value(sample_frame_name, ""));
}

std::size_t whole_of(const std::vector<ChunkFile>& chunks) {
    return static_cast<std::size_t>(std::count_if(chunks.begin(), chunks.end(), [](const ChunkFile& chunk) {
        std::error_code error;
        return std::filesystem::exists(ChunkFile::record_of(chunk.file()), error);
    }));
}

bool render_chunks(const OpenRender& open) {
    try {
        return render_whole_chunks(open);
    } catch (const core::Error& error) {
        const std::size_t whole = whole_of(open.files);
        if (whole == 0) throw;
        throw core::Error(std::string(error.what()) + "; " + resuming_text(open.film, whole));
    }
}

namespace {

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
    if (!open.heatmaps.has_lost()) mark_as_whole(open.film, open.options, open.identity);
    open.heatmaps.clear_away();
    open.work.clear_away();  // last, since it knows of the others
}

}  // namespace

bool publish_all(const OpenRender& open, bool complete, RunFacts& facts, const std::string& again) {
    const bool quiet = open.options.quiet;
    ErrorCollector errors;
    bool published = false;
    if (!open.files.empty())
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
    return all_written;
}

}  // namespace render2mpeg::app
