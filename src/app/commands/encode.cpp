#include "app/commands/commands.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "app/commands/render_stream.h"
#include "app/estimate/first_pass.h"
#include "app/files/file_io.h"
#include "app/files/output_stream.h"
#include "app/files/publish.h"
#include "app/job/render_job.h"
#include "app/job/scene_settings.h"
#include "app/loop/frame_source.h"
#include "app/loop/grain_cost.h"
#include "app/loop/motion.h"
#include "app/loop/motion_source.h"
#include "app/loop/picture_coder.h"
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
#include "encoder/bit_allocation.h"
#include "encoder/codec.h"
#include "encoder/rate_search.h"
#include "parallel/loops.h"

namespace render2mpeg::app {
namespace {

struct Job {
    std::unique_ptr<FrameSource> frames;
    std::unique_ptr<MotionSource> motion;  ///< null: not given
    Film film;
    std::vector<encoder::BitAllocation> allocations;  ///< one per frame, where there is a first pass

    /// Whether its frames and their motion can be read again.
    bool is_there() const { return !frames->is_open_ended() && (motion == nullptr || !motion->is_read_once()); }
};

/// The first chunk, or the one after `before`; none behind the last. An open-ended film has chunks of usual length.
std::optional<Chunk> chunk_after(const Film& film, const std::optional<Chunk>& before) {
    // chosen: longer than any chunk is.
    const std::int64_t far = film.frames.first + 100'000;
    const Chunk first = chunks_of({film.frames.first, std::min(film.frames.last, far)}, film.coding.gop).front();
    if (!before) return first;
    if (before->last >= film.frames.last) return {};
    return Chunk{before->index + 1, before->last + 1, std::min(before->last + first.frames(), film.frames.last)};
}

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

Job prepare(const EncodeOptions& options) {
    if (kind_of(options.output) != OutputKind::film)
        throw core::Error("writing", options.output.string(),
                          "a film is coded: .mpg, .vob, .ts, .m2v, .mkv, .webm, .gif, .mp4 or .mov");
    if (!options.as) check_apart({Files(options.input)}, {Files(options.output), Files(options.stats.value_or(""))});
    Job job;
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

/// Motion of one frame by files; none where none are given. Its time counts as reading.
class FileMotion : public Motion {
  public:
    FileMotion(Job& job, std::int64_t frame, RunStatistics& statistics)
        : job_(job), frame_(frame), statistics_(statistics) {}

    /// Beyond the source's reach a point is taken to rest (going on as before needs up to 1.4 % more bits).
    const core::MotionField* onward(std::int64_t horizon) override {
        const std::int64_t reached = std::min(horizon, frame_ + MotionSource::reach_onward);
        const core::MotionField* field = to(reached);
        if (field == nullptr || reached == horizon) return field;
        onward_ = *field;
        onward_.reference = horizon;
        return &onward_;
    }

  private:
    std::optional<core::MotionField> find(std::int64_t reference) override {
        if (!job_.motion) return std::nullopt;
        const StageTimer timer(statistics_, Stage::develop);
        return job_.motion->between(frame_, reference);
    }

    Job& job_;
    std::int64_t frame_;
    RunStatistics& statistics_;
    core::MotionField onward_;
};

/// A rough coding of the chunk's first pictures: those that are read ahead anyway.
std::vector<encoder::FirstPassPicture> try_first(Job& job, const Film& film, const Chunk& chunk, FramesAhead& ahead,
                                                 RunStatistics& statistics) {
    const std::deque<core::Picture>& pictures = ahead.waiting(statistics);
    if (pictures.empty()) return {};
    Film fast = film;
    fast.coding = rough(film.coding, usual_quantiser(film.coding));
    PictureCoder coder(fast, {chunk.index, chunk.first, pictures.back().number}, {}, {}, statistics, false,
                       &ahead.look());
    FirstPassCollector trial(fast.coding);
    for (const core::Picture& picture : pictures) {
        FileMotion motion(job, picture.number, statistics);
        const encoder::PicturePlan plan = coder.plan(picture.number, ahead.look().cut_before(picture.number), motion);
        trial.all(coder.code(picture, plan, motion));
    }
    trial.all(coder.flush());
    return trial.film();
}

/// Codes one chunk, also where it ends early. `allocations`: of the film's frames; empty: there are none. Returns
/// whether it is whole.
bool encode_chunk(Job& job, const Film& film, const Chunk& chunk, std::span<const encoder::BitAllocation> allocations,
                  LoopObserver& observer, RunStatistics& statistics, Progress& progress) {
    observer.begins(chunk);
    FramesAhead ahead(*job.frames, chunk, film.coding);
    PictureCoder coder(film, chunk, allocations, {}, statistics, false, &ahead.look());
    if (film.coding.rate_control.bit_rate > 0 && allocations.empty())
        coder.expect(try_first(job, film, chunk, ahead, statistics));

    bool whole = true;
    for (std::int64_t n = chunk.first; n <= chunk.last && whole; ++n) {
        {
            const FrameTimer timer(statistics);
            const std::optional<core::Picture> picture = ahead.next(statistics);
            if (!picture) break;  // an open-ended source has ended
            FileMotion motion(job, n, statistics);
            std::vector<const core::Picture*> pictures{&*picture};
            for (const core::Picture& later : ahead.later()) pictures.push_back(&later);
            const encoder::PicturePlan coding = coder.plan(n, ahead.look().cut_before(n), motion, pictures);
            observer.read(*picture, n > chunk.first ? motion.to(n - 1) : nullptr);
            observer.all(coder.code(*picture, coding, motion));
        }
        progress.advance();
        whole = !InterruptGuard::requested() || n == chunk.last;
    }
    observer.all(coder.flush());
    if (whole) observer.ends(chunk);
    return whole;
}

/// Codes chunks with one quantiser to learn their sizes. Empty after an interruption.
std::vector<encoder::FirstPassPicture> code_roughly(Job& job, std::span<const Chunk> chunks, double quantiser,
                                                    bool quiet) {
    Film fast = job.film;
    fast.coding = rough(fast.coding, quantiser);
    Progress progress(chunks.back().last - chunks.front().first + 1, quiet, "first pass", Counted::frames_of_step);
    FirstPassCollector collector(fast.coding);
    RunStatistics statistics;
    for (const Chunk& chunk : chunks)
        if (!encode_chunk(job, fast, chunk, {}, collector, statistics, progress) || InterruptGuard::requested())
            return {};
    return collector.film();
}

/// Geometric mean of the planned quantisers over those of the first pass.
double change_of(std::span<const encoder::BitAllocation> allocations, std::span<const encoder::FirstPassPicture> film) {
    double logarithms = 0;
    for (const encoder::BitAllocation& allocation : allocations) logarithms += std::log(allocation.quantiser);
    for (const encoder::FirstPassPicture& picture : film) logarithms -= std::log(picture.quantiser);
    return std::exp(logarithms / static_cast<double>(std::max<std::size_t>(1, film.size())));
}

/// What the film comes to with one quantiser (MPEG-2's like) and an effort, which stays allocated. None after an
/// interruption.
std::optional<double> rehearsed_bits(Job& job, double quantiser, encoder::Effort effort, bool quiet) {
    job.allocations.assign(static_cast<std::size_t>(job.film.frame_count()), {.quantiser = quantiser});
    Film film = job.film;
    film.coding.effort = effort;
    Progress progress(film.frame_count(), quiet, "first pass", Counted::frames_of_step);
    FirstPassCollector counter(film.coding);
    RunStatistics statistics;
    for (const Chunk& chunk : chunks_of(film.frames, film.coding.gop))
        if (!encode_chunk(job, film, chunk, job.allocations, counter, statistics, progress) ||
            InterruptGuard::requested())
            return {};
    double bits = 0;
    for (const encoder::FirstPassPicture& picture : counter.film()) bits += picture.bits;
    return bits;
}

/// Allocates to another codec than MPEG-2 the one quantiser that reaches the film's rate: the fast effort tells how
/// bits follow quantisers, a pass or more of the film's own effort what it makes of them.
void reach_rate(Job& job, bool quiet) {
    const encoder::Settings& coding = job.film.coding;
    const double wanted = static_cast<double>(coding.rate_control.bit_rate) *
                          static_cast<double>(job.film.frame_count()) / coding.rate.hertz.value();
    const double usual = usual_quantiser(coding);
    double best = usual;
    // False after an interruption.
    const auto searched = [&](encoder::RateSearch& search, encoder::Effort effort) {
        while (search.goes_on()) {
            const double quantiser = usual * search.factor();
            const std::optional<double> bits = rehearsed_bits(job, quantiser, effort, quiet);
            if (!bits) return false;
            if (search.try_ratio(*bits / wanted)) best = quantiser;
        }
        return true;
    };
    // chosen: within 5 %, five at most: efforts differ by more. Then within 1 %: most films by the second try.
    encoder::RateSearch roughly(0.05, 5);
    if (!searched(roughly, encoder::Effort::fast)) return;
    encoder::RateSearch search = roughly.onwards(0.01, 8);
    if (!searched(search, coding.effort)) return;
    for (encoder::BitAllocation& allocation : job.allocations) allocation.quantiser = best;
}

/// Allocates the bits of chunks by a first pass, which is repeated where its quantiser was far off.
std::vector<encoder::BitAllocation> first_pass(Job& job, std::span<const Chunk> chunks, bool quiet) {
    // chosen: again beyond a factor of 1.5, and no more than twice (1.2..3): noise for which 2 was guessed and 18 is
    // right was 28 % over its rate.
    constexpr double far = 1.5;
    double quantiser = usual_quantiser(job.film.coding);
    for (int again = 2;; --again) {
        const std::vector<encoder::FirstPassPicture> film = code_roughly(job, chunks, quantiser, quiet);
        if (film.empty()) return {};
        std::vector<encoder::BitAllocation> allocations =
            encoder::allocate_bits(job.film.coding, film, 1.0, chunks.back().last == job.film.frames.last);
        const double change = change_of(allocations, film);
        if (again == 0 || (change < far && change > 1 / far)) return allocations;
        const double nearer = std::clamp(std::round(quantiser * change), 1.0, 31.0);
        if (nearer == quantiser) return allocations;
        quantiser = nearer;
    }
}

/// Makes the first pass where one is wanted. Returns whether nobody interrupted.
bool allocate(Job& job, const EncodeOptions& options, RunStatistics& statistics) {
    if (two_passes(options.coding) && job.is_there()) {
        const StageTimer timer(statistics, Stage::first_pass);
        if (job.film.coding.codec == encoder::Codec::mpeg2)
            job.allocations = first_pass(job, chunks_of(job.film.frames, job.film.coding.gop), options.quiet);
        else
            reach_rate(job, options.quiet);
    }
    return !InterruptGuard::requested();
}

/// Allocates the bits of one pass from a chunk on: some chunks are there to be looked through before they are coded,
/// and share their bits. False after an interruption.
bool look_through(Job& job, const Chunk& first, bool quiet, RunStatistics& statistics) {
    // chosen: four, some 240 pictures: cuts come more often than that. By single chunks, half of the loss beside two
    // passes is left.
    constexpr std::int64_t together = 4;
    if (first.index % together != 0) return true;
    std::vector<Chunk> chunks{first};
    while (std::ssize(chunks) < together && chunks.back().last < job.film.frames.last)
        chunks.push_back(*chunk_after(job.film, chunks.back()));
    const std::vector<encoder::BitAllocation> allocated =
        timed(statistics, Stage::first_pass, [&] { return first_pass(job, chunks, quiet); });
    if (allocated.empty()) return false;
    job.allocations.resize(static_cast<std::size_t>(job.film.frame_count()));
    std::copy(allocated.begin(), allocated.end(), job.allocations.begin() + (first.first - job.film.frames.first));
    return true;
}

/// Codes the film and sets its last frame. Returns whether it is whole.
bool encode_chunks(Job& job, const EncodeOptions& options, LoopObserver& sink, RunStatistics& statistics) {
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

void print_notes(const Job& job, const EncodeOptions& options) {
    std::vector<std::string> notes = unused_options(options);
    notes.push_back(job.frames->note());
    notes.push_back(unused_keyframes(job.film.keyframes, job.film.frames));
    if (!job.frames->is_open_ended()) notes.push_back(keyframes_without_chapter(job.film));
    if (!job.motion) notes.emplace_back("no --motion: vectors are searched for");
    for (const std::string& note : notes)
        if (!note.empty()) print_line(note);
}

/// Prints and writes the results; a failure of one stops no other.
void tell(const Job& job, const EncodeOptions& options, RunStatistics& statistics, const RunFacts& facts) {
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

RunFacts encode_to_file(Job& job, const EncodeOptions& options, const std::string& command, RunStatistics& statistics) {
    WorkFolder work(options.output, identity_of(job.film, command));
    if (!allocate(job, options, statistics)) return {};
    ChunkFiles chunks(work);
    const bool complete = encode_chunks(job, options, chunks, statistics);
    const std::vector<ChunkFile>& files = chunks.close();
    if (files.empty()) throw core::Error("reading", input_name(options), "it holds no pictures");

    job.film.coding.light = statistics.light;
    const Published published = publish(files, job.film, work, options.output, complete);
    if (complete) work.remove();
    return {command, input_name(options), published.name.string(), published.bytes, complete, published.loudness};
}

RunFacts encode_to_stream(Job& job, const EncodeOptions& options, const std::string& command,
                          RunStatistics& statistics) {
    check_pipe(STDOUT_FILENO);
    OutputStream out(STDOUT_FILENO, stream_name);
    if (!allocate(job, options, statistics)) return {};
    CodedStream stream(out, options.output, job.film);
    const bool complete = encode_chunks(job, options, stream, statistics);
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
    Job job = timed(statistics, Stage::load, [&] { return prepare(options); });
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
