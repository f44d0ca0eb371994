#include "app/render.h"

#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <memory>

#include "app/attempts.h"
#include "app/first_pass.h"
#include "app/frame_portrait.h"
#include "app/heatmap_film.h"
#include "app/interrupt.h"
#include "app/pipeline.h"
#include "app/progress.h"
#include "app/publish.h"
#include "app/report.h"
#include "app/statistics.h"
#include "app/text_file.h"
#include "app/unused_options.h"
#include "core/error.h"
#include "parallel/loops.h"

namespace render2mpeg::app {
namespace {

/// What the scene lacks, and which options do nothing.
void say_notes(const Production& film, const RenderOptions& options) {
    if (options.quiet) return;
    std::vector<std::string> notes = film.animation->notes;
    for (const std::string& line : unused_options(options, film.kind, film.tolerance)) notes.push_back(line);
    notes.push_back(film.kind == OutputKind::film ? unused_keyframes(film.keyframes, film.frames) : "");
    notes.push_back(film.kind == OutputKind::film ? keyframes_without_chapter(film.film()) : "");
    if (film.end && film.frames.last > *film.end)
        notes.push_back(fmt::format("--frames goes beyond the scene's own film, which ends with frame {}", *film.end));
    for (const std::string& note : notes)
        if (!note.empty()) std::fputs((note + "\n").c_str(), stderr);
}

std::string dry_run_text(const Production& film, const RenderOptions& options) {
    const auto chunks = chunks_of(film.frames, film.coding.gop);
    return fmt::format("{}: would render frames {} to {} ({:.2f} s at {} Hz) of {} at {}x{}, in {} chunk{}\n",
                       options.output.string(), film.frames.first, film.frames.last,
                       static_cast<double>(film.frame_count()) / film.rate.hertz.value(), film.rate.name,
                       film.animation->source, film.format.width, film.format.height, chunks.size(),
                       chunks.size() == 1 ? "" : "s") +
           plan_table(film, {});
}

/// Whether the output is one file, which is made in a work folder.
bool is_one_file(const Production& film) {
    return film.kind == OutputKind::film || film.kind == OutputKind::y4m;
}

/// Refuses outputs that would take the place of other files, or show what there is none of. Writes nothing.
void check_outputs(const Production& film, const RenderOptions& options) {
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
    if (is_one_file(film)) WorkFolder::check(options.output);
}

/// Sees that all outputs can be written before hours go into them; from now on no other run has the film.
std::unique_ptr<WorkFolder> open_outputs(const Production& film, const RenderOptions& options,
                                         const std::string& command) {
    check_writable(options.output);
    if (options.layers) check_writable(layers_in(*options.layers));
    if (options.stats) check_writable(*options.stats);
    if (options.report) check_writable(*options.report);
    if (options.report) check_writable(report_json_of(*options.report));
    for (const auto& [subject, file] : options.heatmaps) check_writable(file);
    if (!is_one_file(film)) return nullptr;
    return std::make_unique<WorkFolder>(options.output, film.film(), command);
}

/// Renders all chunks to their destinations. Returns the chunks' files, the last of them incomplete after an
/// interruption.
std::vector<ChunkFile> render_chunks(const Production& film, const RenderOptions& options, WorkFolder* work, Sink* sink,
                                     Watcher* watcher, Ledger& ledger) {
    renderer::Renderer renderer(*film.animation, film.rendering, film.plan);
    Progress progress(film.frame_count(), options.quiet);
    std::vector<ChunkFile> files;
    for (const Chunk& chunk : chunks_of(film.frames, film.coding.gop)) {
        if (work != nullptr) files.push_back(work->open(chunk));
        const Destination destination{work != nullptr ? &files.back() : nullptr, sink,
                                      options.layers ? &*options.layers : nullptr, watcher};
        const std::size_t first = ledger.frames.size();
        const bool whole = render_chunk(film, renderer, chunk, destination, ledger, [&] {
            progress.advance();
            return !InterruptGuard::requested();
        });
        if (work != nullptr && whole)
            files.back().finish({ledger.frames.begin() + static_cast<std::ptrdiff_t>(first), ledger.frames.end()});
        else if (work != nullptr)
            files.back().abandon();
        if (!whole || InterruptGuard::requested()) break;
    }
    ledger.rendering = renderer.statistics();
    for (std::size_t i = 0; i < ledger.pass_seconds.size(); ++i)
        ledger.pass_seconds[i] += renderer.seconds(static_cast<renderer::Pass>(i));
    ledger.pass_seconds[static_cast<std::size_t>(renderer::Pass::develop)] = ledger.stage_seconds(Stage::develop);
    ledger.pass_seconds[static_cast<std::size_t>(renderer::Pass::encode)] = ledger.stage_seconds(Stage::encode);
    return files;
}

}  // namespace

std::vector<Files> inputs_of(const Production& film, const RenderOptions& options) {
    std::vector<Files> inputs{Files(options.input), Files(options.coding.keyframes.value_or(""))};
    std::error_code error;
    if (std::filesystem::is_directory(options.input, error)) inputs.emplace_back(options.input / "film.json");
    for (const scene::ImageSource& image : film.animation->images) inputs.emplace_back(image.path);
    return inputs;
}

int render(const RenderOptions& options, const std::string& command, Rendered* rendered) {
    const auto start = std::chrono::steady_clock::now();
    const parallel::ThreadLimit threads(options.threads);
    const InterruptGuard guard(options.quiet);

    // Read and settle everything before anything is written.
    Ledger ledger;
    Production film = timed(ledger, Stage::load, [&] { return prepare(options); });
    say_notes(film, options);
    check_outputs(film, options);
    if (options.dry_run) {
        if (!options.quiet) print(dry_run_text(film, options));
        return 0;
    }
    const std::unique_ptr<WorkFolder> work = open_outputs(film, options, command);
    HeatmapFilms heatmaps(options, film, command);
    if (!film.exposure) film.exposure = timed(ledger, Stage::load, [&] { return measure_exposure(film); });

    // Find out what the film's pictures need, where a rate is to be shared out among them.
    if (film.two_passes)
        film.allotments = timed(ledger, Stage::first_pass, [&] { return first_pass(film, options.quiet); });
    if (InterruptGuard::requested()) {
        if (!options.quiet) std::fputs("interrupted before the first frame: nothing was written\n", stderr);
        return InterruptGuard::status();
    }

    // Render.
    const std::unique_ptr<Sink> sink =
        make_sink(film, film.kind == OutputKind::y4m ? work->begin("film.y4m") : options.output);
    FramePortrait portrait(film);
    Watchers watchers;
    if (!heatmaps.empty()) watchers.add(heatmaps);
    if (options.report) watchers.add(portrait);
    const std::vector<ChunkFile> chunks =
        render_chunks(film, options, film.kind == OutputKind::film ? work.get() : nullptr, sink.get(),
                      watchers.empty() ? nullptr : &watchers, ledger);

    // Publish what is whole; leave what is not beside the target.
    const bool complete = static_cast<std::int64_t>(ledger.frames.size()) == film.frame_count();
    RunFacts facts{command, options.input.string(), options.output.string(), 0, complete};
    if (sink) sink->finish();
    if (work) {
        const Published published = film.kind == OutputKind::y4m
                                        ? give_name(work->begin("film.y4m"), *work, options.output, complete)
                                        : publish(chunks, film.film(), *work, options.output, complete);
        facts.bytes = published.bytes;
        facts.output = published.name.string();
    }

    // The film is there: what fails of the rest costs no more than itself.
    Attempts attempts;
    if (complete) attempts.attempt([&] { heatmaps.finish(); });
    ledger.wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    if (options.stats) attempts.attempt([&] { write_statistics(*options.stats, film, ledger, facts); });
    if (options.report)
        attempts.attempt([&] { write_report(*options.report, film, ledger, facts, portrait.figures()); });
    if (!options.quiet) attempts.attempt([&] { print(summary(film, ledger, facts)); });
    if (!complete && !options.quiet)
        std::fputs(fmt::format("interrupted after {} of {} frames\n", ledger.frames.size(), film.frame_count()).c_str(),
                   stderr);
    attempts.rethrow();
    if (rendered != nullptr) *rendered = {ledger, facts.output, facts.bytes};
    return complete ? 0 : InterruptGuard::status();
}

int plan(const PlanOptions& options) {
    const Production film = prepare(options.render);
    say_notes(film, options.render);
    print(plan_table(film, options.statistics.value_or("")));
    return 0;
}

}  // namespace render2mpeg::app
