#include "app/commands/commands.h"

#include <fmt/format.h>
#include <unistd.h>

#include <functional>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include "app/commands/encode_job.h"
#include "app/commands/encode_passes.h"
#include "app/commands/render_stream.h"
#include "app/files/file_io.h"
#include "app/files/output_stream.h"
#include "app/files/publish.h"
#include "app/job/render_job.h"
#include "app/job/scene_settings.h"
#include "app/loop/frame_source.h"
#include "app/loop/grain_cost.h"
#include "app/loop/motion_source.h"
#include "app/loop/statistics_recorder.h"
#include "app/options/mistakes.h"
#include "app/options/output_kind.h"
#include "app/options/usage_error.h"
#include "app/production/resume.h"
#include "app/report/statistics.h"
#include "app/report/summary.h"
#include "app/system/error_collector.h"
#include "app/system/interrupt.h"
#include "app/system/progress.h"
#include "app/system/terminal.h"
#include "core/error.h"
#include "core/text.h"
#include "encoder/av/av.h"
#include "encoder/av/coders.h"
#include "encoder/codec.h"
#include "parallel/loops.h"

namespace render2mpeg::app {
namespace {

std::string input_name(const EncodeOptions& options) {
    return options.input == "-" ? "standard input" : options.input.string();
}

/// Shape of the pictures by command line and frames.
ShapeWishes wishes_of(const EncodeOptions& options, const FrameSource& frames) {
    ShapeWishes wishes = shape_wishes(options.coding);
    wishes.source = input_name(options);
    wishes.finished = true;
    wishes.source_size = frames.size();
    if (options.rate) wishes.rate = *options.rate;
    if (const auto rate = frames.rate(); rate && !wishes.rate)
        wishes.source_rate = core::frame_rate_from(fmt::format("{}/{}", rate->num, rate->den));
    if (const auto pixel = frames.pixel_aspect())
        wishes.source_display_aspect = core::product(*pixel, {frames.size().width, frames.size().height});
    return wishes;
}

/// Refuses outputs that would replace an input or each other. Writes nothing.
void check_outputs(const EncodeOptions& options, const FrameRange& frames) {
    const auto files = [&](const std::filesystem::path& name) {
        return is_numbered(name) ? Files(name, frames) : Files(name);
    };
    check_apart(
        {files(options.input), files(options.motion.value_or("")), Files(options.coding.keyframes.value_or(""))},
        {Files(options.output), Files(options.stats.value_or(""))});
}

std::unique_ptr<MotionSource> motion_files(const EncodeOptions& options, const FrameSource& frames,
                                           const std::shared_ptr<SharedChannels>& shared) {
    const Size size = frames.size();
    if (!is_numbered(*options.motion))
        throw core::Error("motion " + options.motion->string() +
                          ": expected numbered files, e.g. layers/frame_%04d.motion or .exr, or a motion stream: fd:3, "
                          "or a pipe whose name ends in .motion");
    const auto convention = options.motion_convention == "nuke" ? MotionConvention::nuke : MotionConvention::blender;
    auto files = std::make_unique<VectorLayers>(*options.motion, convention, size.width, size.height, shared);
    // The first frame refers to none.
    if (!frames.is_open_ended()) files->check(frames.frames().first + 1, frames.frames().last);
    return files;
}

EncodeJob prepare(const EncodeOptions& options) {
    if (kind_of(options.output) != OutputKind::film)
        throw core::Error("writing", options.output.string(),
                          "a film is coded: .mpg, .vob, .ts, .m2v, .mkv, .webm, .gif, .mp4 or .mov");
    if (!options.as) check_apart({Files(options.input)}, {Files(options.output), Files(options.stats.value_or(""))});
    EncodeJob job;
    // Frames and their motion are often the same files.
    const auto shared =
        options.motion && *options.motion == options.input ? std::make_shared<SharedChannels>() : nullptr;
    const core::View view = view_of(options, {});
    check_peak(options, view);
    if (options.view && (options.input == "-" || core::ending_of(options.input) == ".y4m"))
        throw core::Error("view: the frames of " + options.input.string() + " are a film's signals already");
    const bool has_pipe = options.motion && MotionPipe::is_one(*options.motion);
    if (options.input == "-" || has_pipe) {
        const std::string once = (options.input == "-" ? "standard input" : options.motion->string()) + " is read once";
        if (options.coding.passes == 2)
            throw UsageError("--passes 2: " + once + "; choose --passes 1, or encode a file");
        if (options.coding.bitrate && codec_of(options.coding, options.output) != encoder::Codec::mpeg2)
            throw UsageError("--bitrate: " + once + ", but this codec needs two passes; encode a file");
    }
    if (options.input == "-" && options.as && options.coding.audio && *options.coding.audio != "none")
        throw UsageError("--audio: between two pipes nobody knows where sound ends; add it when the film is there");
    // The writer of both may open this one first.
    std::unique_ptr<MotionPipe> motion_pipe;
    if (has_pipe) motion_pipe = std::make_unique<MotionPipe>(*options.motion);
    const encoder::Codec codec = codec_of(options.coding, options.output);
    const bool alpha = encoder::facts_of(codec).has_alpha() && options.transparent != "off";
    const bool even_sides = encoder::facts_of(codec).even_sides() && !options.motion && !options.stereo;
    const FilmSignals signals{{}, view, encoder::facts_of(codec).exact_chroma(), alpha, even_sides};
    job.frames = open_frames(options.input, options.exposure, options.frames, signals, shared);
    encoder::Settings& coding = job.film.coding;
    const Preset* preset = options.coding.preset;
    if (preset != nullptr) preset->check_output(options.output);
    job.film.frames = job.frames->frames();
    coding = coding_settings(options.coding, settle_shape(wishes_of(options, *job.frames), preset),
                             job.film.frames.first, options.output, view);
    describe_view(options, coding);
    coding.alpha = job.frames->has_alpha();
    if (options.grain) coding.grain = *options.grain;
    job.film.keyframes = keyframes_of(options.coding);
    job.film.disc = preset != nullptr && preset->disc;
    check_settings(coding);
    job.film.source = input_name(options);
    if (!options.as && options.input != "-") check_outputs(options, job.film.frames);
    // Finished frames are a film from their first one on, whatever their numbers.
    const FrameRange whole{0, job.film.frame_count() - 1};
    job.film.sound = sound_of(options.coding, std::nullopt, options.output, whole, coding.rate);
    av::check_film(options.output, coding.codec, job.film.sound);
    if (motion_pipe) {
        motion_pipe->start(job.frames->size().width, job.frames->size().height);
        job.motion = std::move(motion_pipe);
    } else if (options.motion) {
        job.motion = motion_files(options, *job.frames, shared);
    }
    return job;
}

/// Codes the film and sets its last frame. Returns whether it is whole.
bool encode_chunks(EncodeJob& job, const EncodeOptions& options, LoopObserver& sink, RunStatistics& statistics) {
    const bool open_ended = job.frames->is_open_ended();
    // The source alone knows how many frames will come.
    Progress progress(job.film.frame_count(), options.quiet || open_ended);
    const bool by_chunk = job.film.coding.rate_control.bit_rate > 0 && job.allocations.empty() && job.is_there();
    bool whole = true;
    for (auto chunk = chunk_after(job.film, {}); chunk && whole; chunk = chunk_after(job.film, chunk)) {
        StatisticsRecorder recorder(statistics, true);
        GrainCost grain(job.film, *chunk);
        LoopObservers all;
        all.add(recorder);
        all.add(grain);
        all.add(sink);
        const std::size_t before = statistics.frames.size();
        whole = (!by_chunk || look_through(job, *chunk, options.quiet, statistics)) &&
                encode_chunk(job, job.film, *chunk, job.allocations, all, statistics, progress);
        if (whole) grain.measure(statistics);
        if (open_ended && whole && statistics.frames.size() < before + static_cast<std::size_t>(chunk->frames())) break;
        whole = whole && (chunk->last == job.film.frames.last || !InterruptGuard::requested());
    }
    if (open_ended) job.film.frames.last = job.film.frames.first + std::ssize(statistics.frames) - 1;
    return whole;
}

/// Chunks in the work folder, each begun by its first frame.
class ChunkFiles : public LoopObserver {
  public:
    explicit ChunkFiles(WorkFolder& work) : work_(work) {}
    void begins(const Chunk& chunk) override { chunk_ = chunk; }
    void read(const core::Picture& picture, const core::MotionField*) override {
        if (picture.number != chunk_.first) return;
        files_.push_back(work_.open(chunk_));
        open_ = true;
    }
    void coded(const encoder::CodedPicture& picture) override { files_.back().append(picture); }
    void ends(const Chunk&) override {
        if (std::exchange(open_, false)) files_.back().finish({});
    }
    /// Closes what was interrupted.
    const std::vector<ChunkFile>& close() {
        if (std::exchange(open_, false)) files_.back().abandon();
        return files_;
    }

  private:
    WorkFolder& work_;
    Chunk chunk_;
    std::vector<ChunkFile> files_;
    bool open_ = false;  ///< the last one
};

void print_notes(const EncodeJob& job, const EncodeOptions& options) {
    std::vector<std::string> notes = unused_options(options);
    notes.push_back(job.frames->note());
    notes.push_back(unused_keyframes(job.film.keyframes, job.film.frames));
    if (!job.frames->is_open_ended()) notes.push_back(keyframes_without_chapter(job.film));
    if (!job.motion) notes.emplace_back("no --motion: vectors are searched for");
    for (const std::string& note : notes)
        if (!note.empty()) print_line(note);
}

/// Prints and writes the results; a failure of one stops no other.
void tell(const EncodeJob& job, const EncodeOptions& options, RunStatistics& statistics, const RunFacts& facts) {
    statistics.rendering.non_finite = job.frames->non_finite();
    ErrorCollector errors;
    if (options.stats)
        errors.attempt(
            [&] { write_encode_statistics(*options.stats, job.film, job.motion != nullptr, statistics, facts); });
    if (!options.quiet)
        errors.attempt([&] {
            const std::string text = encode_summary(job.film, statistics, facts);
            options.as ? print_lines(text) : print(text);
        });
    if (!facts.complete && !options.quiet)
        print_line(job.frames->is_open_ended() ? fmt::format("interrupted after {} frames", statistics.frames.size())
                                               : fmt::format("interrupted after {} of {} frames",
                                                             statistics.frames.size(), job.film.frame_count()));
    errors.rethrow();
}

/// Pictures to be passed on when it is known that they count.
class HeldBack : public LoopObserver {
  public:
    void coded(const encoder::CodedPicture& picture) override {
        encoder::CodedPicture& kept = pictures_.emplace_back();
        kept.plan = picture.plan;
        kept.bytes = picture.bytes;
    }
    void pass_on(LoopObserver& to) const { to.all(pictures_); }

  private:
    std::vector<encoder::CodedPicture> pictures_;
};

bool reaches_rate_by_tries(const EncodeJob& job, const EncodeOptions& options) {
    return two_passes(options.coding) && job.is_there() && job.film.coding.codec != encoder::Codec::mpeg2;
}

/// Codes the film, in as many passes as it wants. `begin` makes where it goes anew for each try. Sets its last frame.
/// Returns whether it is whole.
bool encode_film(EncodeJob& job, const EncodeOptions& options, const std::function<LoopObserver&()>& begin,
                 RunStatistics& statistics) {
    if (reaches_rate_by_tries(job, options)) {
        std::optional<RunStatistics> tried;
        const auto all_of = [](const StageSeconds& stages) {
            return std::accumulate(stages.begin(), stages.end(), 0.0);
        };
        const auto code = [&]() -> std::optional<double> {
            if (tried) statistics.of(Stage::first_pass) += all_of(tried->seconds) - all_of(statistics.seconds);
            tried = statistics;
            if (!encode_chunks(job, options, begin(), *tried)) return {};
            double bits = 0;
            for (const FrameEntry& frame : tried->frames) bits += 8.0 * static_cast<double>(frame.bytes);
            return bits;
        };
        const bool whole = code_at_rate(job, code, options.quiet, statistics);
        if (tried) statistics = std::move(*tried);
        return whole;
    }
    if (two_passes(options.coding) && job.is_there()) {
        const StageTimer timer(statistics, Stage::first_pass);
        job.allocations = first_pass(job, chunks_of(job.film.frames, job.film.coding.gop), options.quiet);
        if (job.allocations.empty()) return false;
    }
    return encode_chunks(job, options, begin(), statistics);
}

RunFacts encode_to_file(EncodeJob& job, const EncodeOptions& options, const std::string& command,
                        RunStatistics& statistics) {
    WorkFolder work(options.output, identity_of(job.film, command));
    std::optional<ChunkFiles> chunks;
    const auto begin = [&]() -> LoopObserver& { return chunks.emplace(work); };
    const bool complete = encode_film(job, options, begin, statistics);
    if (!chunks) return {};
    const std::vector<ChunkFile>& files = chunks->close();
    if (files.empty()) throw core::Error("reading", input_name(options), "it holds no pictures");

    job.film.coding.light = statistics.light;
    const Published published = publish(files, job.film, work, options.output, complete);
    if (complete) work.remove();
    return {command, input_name(options), published.name.string(), published.bytes, complete, published.loudness};
}

RunFacts encode_to_stream(EncodeJob& job, const EncodeOptions& options, const std::string& command,
                          RunStatistics& statistics) {
    check_pipe(STDOUT_FILENO);
    OutputStream out(STDOUT_FILENO, stream_name);
    CodedStream stream(out, options.output, job.film);
    std::optional<HeldBack> held;
    bool begun = false;
    const auto begin = [&]() -> LoopObserver& {
        begun = true;
        if (!reaches_rate_by_tries(job, options)) return stream;
        return held.emplace();
    };
    const bool complete = encode_film(job, options, begin, statistics);
    if (!begun) return {};
    if (held) held->pass_on(stream);
    if (statistics.frames.empty()) throw core::Error("reading", input_name(options), "it holds no pictures");
    stream.finish();
    out.finish();
    return {command, input_name(options), stream_name, out.bytes(), complete};
}

}  // namespace

int encode(const EncodeOptions& options, const std::string& command) {
    const double start = clock_seconds();
    const parallel::ThreadLimit threads(options.threads);
    const InterruptGuard guard(options.quiet);

    RunStatistics statistics;
    EncodeJob job = timed(statistics, Stage::load, [&] { return prepare(options); });
    if (!options.quiet) print_notes(job, options);
    std::vector<Files> films;
    if (!options.as) films.emplace_back(options.output);
    if (options.stats) films.emplace_back(*options.stats);
    require_consent({films, {}}, options.overwrite);
    if (!options.as) check_writable(options.output);
    if (options.stats) check_writable(*options.stats);

    const RunFacts facts = options.as ? encode_to_stream(job, options, command, statistics)
                                      : encode_to_file(job, options, command, statistics);
    if (facts.output.empty()) {
        if (!options.quiet) print_line("interrupted before the first frame: nothing was written");
        return InterruptGuard::status();
    }
    statistics.wall = clock_seconds() - start;
    tell(job, options, statistics, facts);
    return facts.complete ? 0 : InterruptGuard::status();
}

}  // namespace render2mpeg::app
