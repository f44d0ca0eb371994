#include "app/commands/render_stream.h"

#include <fmt/format.h>
#include <unistd.h>

#include <chrono>

#include "app/loop/pipeline.h"
#include "app/loop/resume.h"
#include "app/loop/sink.h"
#include "app/options/output_kind.h"
#include "app/options/usage_error.h"
#include "app/production/production.h"
#include "app/report/frame_view.h"
#include "app/report/report.h"
#include "app/report/statistics.h"
#include "app/report/summary.h"
#include "app/system/error_collector.h"
#include "app/system/image_reader.h"
#include "app/system/interrupt.h"
#include "app/system/progress.h"
#include "app/system/terminal.h"
#include "encoder/av/y4m.h"
#include "parallel/loops.h"

namespace render2mpeg::app {
namespace {

class Y4mStream : public Sink {
  public:
    Y4mStream(OutputStream& out, const RenderJob& film) : out_(out) {
        const std::string header = av::y4m_header(film.format.width, film.format.height, film.rate, film.pixel_aspect);
        put({reinterpret_cast<const std::uint8_t*>(header.data()), header.size()});
    }
    void lit(const LitFrame& frame) override {
        av::put_y4m_frame(frame.picture, [&](std::span<const std::uint8_t> bytes) { return put(bytes); });
    }

  private:
    bool put(std::span<const std::uint8_t> bytes) {
        const bool taken = out_.put(bytes);
        out_.check();
        return taken;
    }

    OutputStream& out_;
};

void check_stream(const RenderOptions& options) {
    const auto refuse = [](const std::string& option, const std::string& why) {
        throw UsageError(option + ": with -o - " + why);
    };
    if (options.resume) refuse("--resume", "nothing is left that a later run could go on with");
    if (options.light_cache) refuse("--light-cache", "no light is kept; render to a file");
    if (options.layers) refuse("--aov", "only the film is written; render to a file for layers");
    if (!options.heatmaps.empty()) refuse("--heatmap", "only the film is written; render to a file for heatmaps");
    if (!options.dry_run) check_pipe(STDOUT_FILENO);
}

void write_about_stream(const RenderJob& film, const RenderOptions& options, const RunStatistics& statistics,
                        const RunFacts& facts, const SampleFrameObserver& sample) {
    ErrorCollector errors;
    if (options.stats) errors.attempt([&] { write_statistics(*options.stats, film, statistics, facts); });
    if (options.report)
        errors.attempt([&] { write_report(*options.report, film, statistics, facts, sample.figures()); });
    if (!options.quiet) errors.attempt([&] { print_lines(summary(film, statistics, facts)); });
    errors.rethrow();
}

}  // namespace

std::unique_ptr<Sink> stream_into(OutputStream& out, const std::filesystem::path& name, const RenderJob& film) {
    if (film.kind == OutputKind::y4m) return std::make_unique<Y4mStream>(out, film);
    return std::make_unique<CodedStream>(out, name, film.film());
}

int render_stream(const RenderOptions& options, const std::string& command) {
    const auto start = std::chrono::steady_clock::now();
    const parallel::ThreadLimit threads(options.threads);
    const InterruptGuard guard(options.quiet);
    check_stream(options);

    RunStatistics statistics;
    RenderJob film = timed(statistics, Stage::load, [&] { return prepare_within_memory(options); });
    if (!options.quiet) print_notes(film, options);
    open_writers(film, options);
    if (options.dry_run) return 0;
    if (!options.memory) timed(statistics, Stage::load, [&] { return film.images->read_ahead(image_probes(false)); });
    if (InterruptGuard::requested()) return InterruptGuard::status();
    OutputStream out(STDOUT_FILENO, stream_name);
    settle(film, options, nullptr, statistics);
    if (InterruptGuard::requested()) return InterruptGuard::status();

    const std::unique_ptr<Sink> stream = stream_into(out, options.output, film);
    SampleFrameObserver sample(film);
    LoopObservers observers;
    observers.add(*stream);
    if (options.report) observers.add(sample);
    std::optional<LastFrameWriter> last_frame;
    if (options.last_frame) observers.add(last_frame.emplace(*options.last_frame, film));
    bool complete = false;
    {
        Progress progress(film.frame_count(), options.quiet);
        complete = render_through(film, observers, statistics, [&] {
            progress.advance();
            out.check();
            return !InterruptGuard::requested();
        });
    }
    stream->finish();
    out.finish();

    const RunFacts facts{command, options.input.string(), stream_name, out.bytes(), complete};
    statistics.wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    write_about_stream(film, options, statistics, facts, sample);
    if (!complete && !options.quiet)
        print_line(fmt::format("interrupted after {} of {} frames", statistics.frames.size(), film.frame_count()));
    return complete ? 0 : InterruptGuard::status();
}

}  // namespace render2mpeg::app
