#include "app/encode.h"

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <optional>
#include <vector>

#include "app/bookkeeper.h"
#include "app/frame_source.h"
#include "app/interrupt.h"
#include "app/output_kind.h"
#include "app/progress.h"
#include "app/publish.h"
#include "app/statistics.h"
#include "app/vector_layers.h"
#include "core/error.h"
#include "parallel/loops.h"

namespace render2mpeg::app {
namespace {

/// Frames, motion, and the film that they become.
struct Job {
    std::unique_ptr<FrameSource> frames;
    std::optional<VectorLayers> motion;  ///< none: not given
    Film film;
};

core::FrameRate rate_of(const EncodeOptions& options, const FrameSource& frames) {
    if (options.rate) return core::frame_rate_from(*options.rate);
    if (!frames.rate()) return core::frame_rate_from("25");
    return core::frame_rate_from(fmt::format("{}/{}", frames.rate()->num, frames.rate()->den));
}

/// aspect_ratio_information [H262, table 6-3]: square pixels, or the shape of the whole picture.
int aspect_ratio_code(const FrameSource& frames, const std::string& name) {
    const core::Rational pixel = frames.pixel_aspect().value_or(core::Rational{1, 1});
    if (pixel.num == pixel.den) return 1;
    const Size size = frames.size();
    const double shape = pixel.value() * size.width / size.height;
    // chosen: pixel shapes in use give 4:3 or 16:9 for the 702, 704 or 720 columns of a line: up to 2.6 % away; the
    // three shapes lie 25 % apart.
    for (const auto& [code, value] : {std::pair{2, 4.0 / 3.0}, {3, 16.0 / 9.0}, {4, 2.21}})
        if (std::abs(shape / value - 1) < 0.03) return code;
    throw core::Error("reading", name,
                      fmt::format("its pixels are {}:{}: MPEG-2 has square ones, and pictures of 4:3, 16:9 and 2.21:1",
                                  pixel.num, pixel.den));
}

Job prepare(const EncodeOptions& options) {
    if (kind_of(options.output) != OutputKind::film)
        throw core::Error("writing", options.output.string(), "a film is coded: .mpg, .vob, .ts, .m2v, .mkv or .mp4");
    std::error_code ignored;
    if (std::filesystem::equivalent(options.input, options.output, ignored))
        throw core::Error("writing", options.output.string(), "it is the input");

    Job job;
    const auto wanted = options.frames ? std::optional(frames_from(*options.frames)) : std::nullopt;
    job.frames = open_frames(options.input, options.exposure, wanted);
    const Size size = job.frames->size();
    encoder::Settings& coding = job.film.coding;
    coding = coding_settings(options.coding, size, rate_of(options, *job.frames));
    // Without motion, predictors cannot bridge the way over B pictures: at 720p that cost 50 to 80 % more bits.
    if (!options.motion) coding.b_pictures = 0;
    coding.aspect_ratio_code = aspect_ratio_code(*job.frames, options.input.string());
    encoder::check(coding);
    job.film.source = options.input.string();
    job.film.frames = job.frames->frames();

    if (options.motion) {
        if (!is_numbered(*options.motion))
            throw core::Error("motion " + options.motion->string() +
                              ": expected numbered OpenEXR files, e.g. layers/frame_%04d.exr");
        const auto convention =
            options.motion_convention == "nuke" ? MotionConvention::nuke : MotionConvention::blender;
        job.motion.emplace(*options.motion, convention, size.width, size.height);
        // The first frame refers to none.
        job.motion->check(job.film.frames.first + 1, job.film.frames.last);
    }
    return job;
}

/// Codes one chunk. The last pictures of a chunk that ends early are coded too. Returns whether it is whole.
bool encode_chunk(Job& job, const Chunk& chunk, ChunkFile& file, Ledger& ledger, Progress& progress) {
    encoder::Encoder encoder(job.film.coding);
    Bookkeeper books(ledger);
    const auto write = [&](const std::vector<encoder::CodedPicture>& pictures) {
        for (const encoder::CodedPicture& coded : pictures) {
            books.coded(coded);
            file.append(coded);
        }
    };

    bool whole = true;
    for (std::int64_t n = chunk.first; n <= chunk.last && whole; ++n) {
        const double start = cpu_seconds();
        const core::Picture picture = timed(ledger, Stage::develop, [&] { return job.frames->read(n); });
        const encoder::PicturePlan coding = encoder.plan(n, {false, chunk.last - n}, n == chunk.first);
        std::vector<core::MotionField> motion;
        if (job.motion)
            for (const std::int64_t reference : coding.references)
                motion.push_back(timed(ledger, Stage::develop, [&] { return job.motion->between(n, reference); }));
        books.opened(n);
        books.keep(picture);
        write(timed(ledger, Stage::encode, [&] { return encoder.push(picture, coding, motion); }));
        books.took(cpu_seconds() - start);
        progress.advance();
        whole = !InterruptGuard::requested() || n == chunk.last;
    }
    write(timed(ledger, Stage::encode, [&] { return encoder.flush(); }));
    return whole;
}

std::vector<ChunkFile> encode_chunks(Job& job, const EncodeOptions& options, WorkFolder& work, Ledger& ledger) {
    Progress progress(job.film.frame_count(), 0, options.quiet);
    std::vector<ChunkFile> files;
    for (const Chunk& chunk : chunks_of(job.film.frames, job.film.coding.gop)) {
        files.push_back(work.open(chunk));
        const std::size_t first = ledger.frames.size();
        const bool whole = encode_chunk(job, chunk, files.back(), ledger, progress);
        if (whole)
            files.back().finish({ledger.frames.begin() + static_cast<std::ptrdiff_t>(first), ledger.frames.end()});
        else
            files.back().abandon();
        if (!whole || InterruptGuard::requested()) break;
    }
    return files;
}

}  // namespace

int encode(const EncodeOptions& options, const std::string& command) {
    const auto start = std::chrono::steady_clock::now();
    const parallel::ThreadLimit threads(options.threads);
    const InterruptGuard guard;

    // Read and settle everything before anything is written.
    Ledger ledger;
    Job job = timed(ledger, Stage::load, [&] { return prepare(options); });
    if (!job.motion && !options.quiet)
        std::fputs("no --motion: vectors will be poor, since they are guessed from neighbours and never searched\n",
                   stderr);
    check_writable(options.output);
    if (options.stats) check_writable(*options.stats);

    // Encode; publish what is whole, leave what is not beside the target.
    WorkFolder work(options.output, job.film, command);
    const std::vector<ChunkFile> chunks = encode_chunks(job, options, work, ledger);
    const bool complete = static_cast<std::int64_t>(ledger.frames.size()) == job.film.frame_count();
    const std::filesystem::path target = complete ? options.output : partial_film_of(options.output);
    RunFacts facts{command, options.input.string(), target.string(), 0, complete};
    facts.bytes = publish(chunks, job.film, work, target);
    if (complete) work.remove();
    ledger.wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    ledger.rendering.non_finite = job.frames->non_finite();

    if (options.stats) write_encode_statistics(*options.stats, job.film, job.motion.has_value(), ledger, facts);
    if (!options.quiet) std::fputs(encode_summary(job.film, ledger, facts).c_str(), stdout);
    if (!complete && !options.quiet)
        std::fputs(
            fmt::format("interrupted after {} of {} frames\n", ledger.frames.size(), job.film.frame_count()).c_str(),
            stderr);
    return complete ? 0 : 130;
}

}  // namespace render2mpeg::app
