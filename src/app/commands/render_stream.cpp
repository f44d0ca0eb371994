#include "app/commands/render_stream.h"

#include <fmt/format.h>
#include <unistd.h>

#include "app/loop/pipeline.h"
#include "app/options/output_kind.h"
#include "app/options/usage_error.h"
#include "app/production/production.h"
#include "app/production/resume.h"
#include "app/report/frame_view.h"
#include "app/report/summary.h"
#include "app/system/error_collector.h"
#include "app/system/image_reader.h"
#include "app/system/interrupt.h"
#include "app/system/progress.h"
#include "app/system/terminal.h"
#include "core/error.h"
#include "encoder/av/y4m.h"
#include "encoder/codec.h"
#include "parallel/loops.h"

namespace render2mpeg::app {
namespace {

void check_stream(const RenderOptions& options) {
    const auto refuse = [](const std::string& option, const std::string& why) {
        throw UsageError(option + ": with -o - " + why);
    };
    if (options.resume) refuse("--resume", "nothing is left that a later run could go on with");
    if (options.light_cache) refuse("--light-cache", "no light is kept; render to a file");
    if (options.layers) refuse("--aov", "only the film is written; render to a file for layers");
    if (!options.side_films.empty())
        refuse(options.is_given("--also") ? "--also" : "--heatmap",
               "only the film is written; render to a file for others");
    if (!options.dry_run) check_pipe(STDOUT_FILENO);
}

}  // namespace

CodedStream::CodedStream(OutputStream& out, const std::filesystem::path& name, const Film& film)
    : out_(out),
      codec_(film.coding.codec),
      first_frame_(film.frames.first),
      muxer_([&out](std::span<const std::uint8_t> bytes) { return out.put(bytes); }, name, film.coding,
             film.sound_beside(film.frame_count())) {}

void CodedStream::pass_on() {
    if (!waiting_) return;
    try {
        muxer_.write(waiting_->bytes, waiting_->number - first_frame_, passed_on_++, waiting_->starts_gop);
    } catch (const core::Error&) {
        out_.check();  // who reads, and why no more, is a better reason
        throw;
    }
    waiting_.reset();
    out_.check();
}

void CodedStream::coded(const encoder::CodedPicture& picture) {
    pass_on();
    waiting_ = {picture.bytes, picture.plan.number, picture.plan.starts_gop};
}

void CodedStream::finish() {
    if (!waiting_) return;
    for (const std::uint8_t byte : encoder::end_of_stream(codec_)) waiting_->bytes.push_back(byte);
    pass_on();
    muxer_.finish();
}

std::unique_ptr<Sink> stream_into(OutputStream& out, const std::filesystem::path& name, const RenderJob& film) {
    if (film.kind == OutputKind::y4m) {
        const auto put = [&out](std::span<const std::uint8_t> bytes) {
            const bool taken = out.put(bytes);
            out.check();
            return taken;
        };
        const std::string header = av::y4m_header(film.format.width, film.format.height, film.rate, film.pixel_aspect);
        put({reinterpret_cast<const std::uint8_t*>(header.data()), header.size()});
        return std::make_unique<FrameSink>([put](const LitFrame& frame) { av::put_y4m_frame(frame.picture, put); });
    }
    return std::make_unique<CodedStream>(out, name, film.film());
}

int render_stream(const RenderOptions& options, const std::string& command) {
    const double start = clock_seconds();
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
    statistics.wall = clock_seconds() - start;
    ErrorCollector errors;
    write_about(film, options, statistics, facts, sample, errors);
    if (!options.quiet) errors.attempt([&] { print_lines(summary(film, statistics, facts)); });
    errors.rethrow();
    if (!complete && !options.quiet)
        print_line(fmt::format("interrupted after {} of {} frames", statistics.frames.size(), film.frame_count()));
    return complete ? 0 : InterruptGuard::status();
}

}  // namespace render2mpeg::app
