#include "app/production/production.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <span>
#include <thread>
#include <utility>

#include "app/estimate/forecast.h"
#include "app/estimate/hire.h"
#include "app/files/file_io.h"
#include "app/loop/sink.h"
#include "app/options/mistakes.h"
#include "app/options/output_kind.h"
#include "app/production/resume.h"
#include "app/report/report.h"
#include "app/report/summary.h"
#include "app/system/image_reader.h"
#include "app/system/interrupt.h"
#include "app/system/memory_limit.h"
#include "app/system/terminal.h"
#include "core/error.h"
#include "core/scene_formats.h"
#include "core/text.h"
#include "encoder/av/av.h"
#include "image/image.h"
#include "parallel/loops.h"

namespace render2mpeg::app {
namespace {

/// Why chunks follow each other, or nothing.
std::string why_in_order(const RenderJob& film, const RenderOptions& options) {
    if (film.chunks().size() < 2) return "the film has no other";
    if (options.as) return "standard output takes pictures in order";
    if (!options.side_films.empty()) return "films beside it (--also, --heatmap) are made in order";
    if (light_file_of(film, options)) return "--light-cache grows from chunk to chunk";
    return {};
}

/// The first chunk needs all; others share what never moves.
int allowed_by_memory(const RenderJob& film, std::uint64_t limit) {
    const MemoryNeed need = memory_need(film);
    if (need.total() >= limit) return 1;
    return 1 + static_cast<int>(std::min<std::uint64_t>((limit - need.total()) / need.of_chunk(), 1023));
}

}  // namespace

ChunksAtOnce chunks_at_once(const RenderJob& film, const RenderOptions& options) {
    if (std::string why = why_in_order(film, options); !why.empty()) return {1, std::move(why)};
    const int threads = parallel::thread_count();
    ChunksAtOnce chosen;
    if (options.chunks_at_once)
        chosen = {*options.chunks_at_once, fmt::format("--chunks-at-once {}", *options.chunks_at_once)};
    else
        chosen = {std::max(1, (threads + threads_of_chunk / 2) / threads_of_chunk),
                  fmt::format("{} thread{}, {} to a chunk", threads, threads == 1 ? "" : "s", threads_of_chunk)};
    if (const std::size_t chunks = film.chunks().size(); static_cast<std::size_t>(chosen.count) > chunks) {
        chosen.count = static_cast<int>(chunks);
        chosen.reason += fmt::format("; the film has {}", chunks);
    }
    if (chosen.count > 1 && (options.memory || !options.chunks_at_once)) {
        const int allowed = allowed_by_memory(film, options.memory.value_or(machine_memory() / 2));
        chosen.count = std::min(chosen.count, allowed);
        chosen.reason += fmt::format("; memory allows {}", allowed);
    }
    return chosen;
}

std::string text_of(const ChunksAtOnce& chosen) {
    return fmt::format("{} chunk{} at once: {}", chosen.count, chosen.count == 1 ? "" : "s", chosen.reason);
}

namespace {

std::span<const ChunkFile> leading_of(const OpenRender& open) {
    return leading_of(open.files, open.film.chunks().front().index);
}

/// Publishes the film under its name, or an incomplete one under another.
Published publish_frames(const OpenRender& open, bool complete) {
    const RenderJob& film = open.film;
    const RenderOptions& options = open.options;
    const std::span<const ChunkFile> files = leading_of(open);
    if (film.kind == OutputKind::film) {
        Film coded = film.film();
        coded.coding.light = open.statistics.light;
        return publish(files, coded, open.work, options.output, complete);
    }
    if (film.kind == OutputKind::y4m) {
        std::vector<std::filesystem::path> parts;
        for (const ChunkFile& chunk : files)
            parts.push_back(std::filesystem::path(chunk.file()).replace_extension(".y4m"));
        const std::filesystem::path file = open.work.begin("film.y4m");
        join_y4m(film, parts, file);
        return complete ? give_name(file, options.output) : published_at(file);
    }
    // Images have their names already.
    return {options.output, 0};
}

}  // namespace

RenderJob prepare_within_memory(const RenderOptions& options) {
    if (!options.memory) return prepare(options);
    const std::uint64_t limit = *options.memory;
    hold_to(limit, std::max(parallel::thread_count(), options.chunks_at_once.value_or(1)));
    RenderJob film = prepare(options);
    MemoryNeed need = memory_need(film);
    if (need.total() > limit && need.least() <= limit) {
        film.images_in_turn = true;
        need = sampled(film, need);
    }
    film.images_in_turn = !may_decode_at_once(film, need, limit, parallel::thread_count());
    if (!film.images_in_turn) film.images->read_ahead(image_probes(true));
    return film;
}

void print_notes(const RenderJob& film, const RenderOptions& options) {
    if (options.quiet) return;
    std::vector<std::string> notes = film.animation->notes;
    for (const std::string& line : unused_options(options, film.kind, film.tolerance, film.preview))
        notes.push_back(line);
    if (options.is_given("--frames") && options.said.at("--frames").find(':') == std::string::npos)
        notes.push_back(film.frames.first > 1 ? fmt::format("--frames {0} is one frame, number {0} from 0; the first "
                                                            "{0} are --frames 0:{1}",
                                                            film.frames.first, film.frames.first - 1)
                                              : "");
    notes.push_back(film.kind == OutputKind::film ? unused_keyframes(film.keyframes, film.frames) : "");
    if (const std::string why = why_no_light_file(film); options.light_cache && !why.empty())
        notes.push_back("--light-cache has no effect: " + why);
    notes.push_back(film.kind == OutputKind::film ? keyframes_without_chapter(film.film()) : "");
    const unsigned cores = std::thread::hardware_concurrency();
    if (cores > 0 && options.threads > static_cast<int>(cores))
        notes.push_back(
            fmt::format("--threads {}: this machine has {} core{}, and more threads than those gain nothing",
                        options.threads, cores, cores == 1 ? "" : "s"));
    for (const std::string& note : notes)
        if (!note.empty()) print_line(note);
}

void check_before_reading(const RenderOptions& options) {
    const OutputKind kind = kind_of(options.output);
    Wishes wishes;
    if (is_one_file(kind)) wishes.dear.emplace_back(options.output);
    for (const SideFilmRequest& beside : options.side_films) wishes.dear.emplace_back(beside.file);
    for (const Files& film : wishes.dear) check_reachable(film.name);
    for (const auto& file : {options.stats, options.report, options.last_frame, options.light_cache})
        if (file) check_reachable(*file);
    if (options.report) check_report(*options.report);
    if (options.last_frame && core::ending_of(*options.last_frame) != ".png")
        throw core::Error("--last-frame " + options.last_frame->string() + ": it is a .png");
    // Where reading is quick, it is first seen whether an output is an input, too.
    const bool is_slow = core::scene_reader_of(options.input) == core::SceneReader::blender;
    if (is_slow && !options.dry_run && !options.resume) require_consent(wishes, options.overwrite);
}

namespace {

Files film_files(const RenderJob& film, const RenderOptions& options) {
    return is_one_file(film.kind) ? Files(options.output) : Files(options.output, film.frames);
}

/// All files of a render; empty names are passed over.
std::vector<Files> outputs_of(const RenderJob& film, const RenderOptions& options) {
    std::vector<Files> outputs{film_files(film, options), options.stats.value_or(""), options.last_frame.value_or(""),
                               options.light_cache.value_or("")};
    for (const SideFilmRequest& beside : options.side_films) outputs.emplace_back(beside.file);
    if (options.report) {
        outputs.emplace_back(*options.report);
        outputs.emplace_back(report_json_of(*options.report));
    }
    if (options.layers)
        for (const auto& pattern : {layers_in(*options.layers), motion_in(*options.layers)})
            outputs.emplace_back(pattern, film.frames);
    return outputs;
}

}  // namespace

void open_writers(const RenderJob& film, const RenderOptions& options) {
    if (film.kind == OutputKind::film)
        av::check_film(options.output, film.coding.codec, film.sound,
                       film.disc ? av::ProgramStream::dvd : av::ProgramStream::plain);
    for (const auto& [subject, file, view] : options.side_films)
        av::check_film(file, view ? view->codec_in(file) : codec_of({}, file));
    if (film.kind == OutputKind::png || options.last_frame || options.report) image::open_writer(".png");
    if (film.kind == OutputKind::exr || options.layers) image::open_writer(".exr");
}

void check_outputs(const RenderJob& film, const RenderOptions& options) {
    const std::vector<Files> outputs = outputs_of(film, options);
    check_apart(inputs_of(film, options), outputs);
    for (const Files& output : outputs)
        if (!output.name.empty()) check_reachable(output.name);
    if (const auto light = light_file_of(film, options)) static_cast<void>(light->extent());
    if (options.report) check_report(*options.report);
    check_side_films(options, film);
    open_writers(film, options);
    WorkFolder::check(options.output);
}

Wishes written_by(const RenderJob& film, const RenderOptions& options) {
    Wishes wishes;
    wishes.dear.push_back(film_files(film, options));
    for (const SideFilmRequest& beside : options.side_films) wishes.dear.emplace_back(beside.file);
    if (options.stats) wishes.dear.emplace_back(*options.stats);
    wishes.beside.push_back(options.report.value_or(""));
    // This folder is made, but not those that it is in.
    const std::filesystem::path layers = options.layers.value_or("");
    wishes.beside.push_back(layers.has_filename() ? layers : layers.parent_path());
    return wishes;
}

std::unique_ptr<WorkFolder> open_outputs(const RenderJob& film, const RenderOptions& options,
                                         const nlohmann::json& identity) {
    for (const Files& output : outputs_of(film, options))
        if (!output.name.empty()) check_writable(output.name);
    const auto earlier = options.resume ? WorkFolder::Earlier::resumed : WorkFolder::Earlier::removed;
    return std::make_unique<WorkFolder>(options.output, identity, earlier);
}

void take_up(SampleFrameObserver& sample_frame, const std::vector<ChunkFile>& chunks) {
    for (const ChunkFile& chunk : chunks)
        if (sample_frame.is_in(chunk.chunk()))
            sample_frame.take_up(chunk.facts().value(sample_frame_name, nlohmann::json()));
}

bool render_chunks(const OpenRender& open) {
    try {
        return make_chunks(open, static_cast<std::size_t>(chunks_at_once(open.film, open.options).count));
    } catch (const core::Error& error) {
        const bool keeps = is_of_use(open.files);
        // Images have their names already: nothing is left to go on from.
        if (!keeps && !is_one_file(open.film.kind)) open.work.remove();
        if (!keeps) throw;
        throw core::Error(std::string(error.what()) + "; " + resuming_text(open.film, open.files));
    }
}

bool write_about(const RenderJob& film, const RenderOptions& options, const RunStatistics& statistics,
                 const RunFacts& facts, const SampleFrameObserver& sample, ErrorCollector& errors) {
    const bool stats =
        !options.stats || errors.attempt([&] { write_statistics(*options.stats, film, statistics, facts); });
    const bool report = !options.report || errors.attempt([&] {
        write_report(*options.report, film, statistics, facts, sample.figures());
    });
    return stats && report;
}

bool publish_all(const OpenRender& open, bool complete, RunFacts& facts, const std::string& again) {
    const bool quiet = open.options.quiet;
    ErrorCollector errors;
    const bool published = !leading_of(open).empty() && errors.attempt([&] {
        const Published film_file = publish_frames(open, complete);
        facts.bytes = film_file.bytes;
        facts.output = film_file.name.string();
        facts.complete = complete;
        facts.loudness = film_file.loudness;
    });
    bool all_written = complete && open.side_films.finish() && published;
    errors.attempt([&] { open.side_films.rethrow(); });
    open.statistics.wall = open.clock.seconds(open.statistics);
    all_written =
        write_about(open.film, open.options, open.statistics, facts, open.sample_frame, errors) && all_written;
    if (all_written && !open.side_films.has_lost()) mark_as_whole(open.film, open.options, open.identity);
    if (all_written) open.work.remove();
    if (complete && !all_written && !quiet) print_line(resuming_text(open.film, open.files));
    if (!quiet && published) errors.attempt([&] { print(summary(open.film, open.statistics, facts)); });
    if (!complete && !quiet)
        print_line(fmt::format("interrupted after {} of {} frames; {}", open.statistics.frames.size(),
                               open.film.frame_count(), resuming_text(open.film, open.files, again)));
    errors.rethrow();
    return all_written;
}

}  // namespace render2mpeg::app
