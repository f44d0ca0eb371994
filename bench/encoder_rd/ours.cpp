#include <algorithm>
#include <cmath>
#include <ctime>
#include <memory>
#include <optional>

#include "core/numeric.h"
#include "encoder/encoder.h"
#include "encoder/look_ahead.h"
#include "encoder/motion_nonuniformity.h"
#include "encoder_rd/codecs.h"
#include "encoder_rd/full_search.h"
#include "perceptual/hvs.h"
#include "perceptual/metrics.h"

namespace render2mpeg::bench {
namespace {

/// One encoder at work.
struct Run {
    OwnCodec codec;
    bool told = true;  ///< the clip knows its motion, and the encoder may
    std::unique_ptr<encoder::Encoder> encoder;
    Measured measured;
    Quality quality;
    std::unique_ptr<encoder::LookAhead> ahead;  ///< where motion is not told
    std::int64_t looked = 0, gop_start = 0;
    std::uint64_t evaluations = 0, macroblocks = 0, intra = 0, skipped = 0;

    /// What `encode` does with frames whose motion it is not told.
    void look_ahead(const Clip& clip, std::int64_t n, encoder::PictureFacts& facts) {
        const auto count = static_cast<std::int64_t>(clip.pictures.size());
        for (; looked < std::min(count, n + 1 + encoder::LookAhead::depth); ++looked)
            ahead->add(clip.pictures[static_cast<std::size_t>(looked)]);
        if (looked == count) ahead->end();
        facts.cut_before = ahead->cut_before(n);
        facts.frames_left = ahead->frames_left(n).value_or(count - 1 - n);
        if (facts.cut_before || n >= gop_start + codec.gop) gop_start = n;
        const std::int64_t last = std::min(n + facts.frames_left, gop_start + codec.gop - 1);
        if (n > gop_start) facts.b_pictures = ahead->b_pictures(n - 1, last);
        ahead->forget_before(n - 4);
    }

    void take(const Clip& clip, const std::vector<encoder::CodedPicture>& pictures) {
        for (const encoder::CodedPicture& coded : pictures) {
            const double bits = 8.0 * static_cast<double>(coded.bytes.size());
            TypeShare& type = measured.types[static_cast<std::size_t>(coded.plan.type) - 1];
            ++type.pictures;
            type.bits += bits;
            type.error += quality.add(coded.reconstruction, clip.pictures[static_cast<std::size_t>(coded.plan.number)]);
            measured.bits += bits;
            if (coded.plan.type == encoder::PictureType::intra) continue;
            evaluations += coded.block_evaluations;
            for (const encoder::MacroblockRecord& record : coded.macroblocks.values()) {
                ++macroblocks;
                intra += record.intra;
                skipped += record.skipped;
            }
        }
    }

    void finish(std::size_t pictures) {
        const auto share = [&](std::uint64_t n) {
            return core::divide_or(static_cast<double>(n), static_cast<double>(macroblocks), 0.0);
        };
        measured.pictures = static_cast<std::int64_t>(pictures);
        measured.bits += 8.0 * static_cast<double>(encoder::sequence_end().size());
        measured.evaluations = share(evaluations);
        measured.intra = share(intra);
        measured.skipped = share(skipped);
        quality.write(measured);
    }
};

Run start(const Clip& clip, const OwnCodec& codec, int quantiser) {
    encoder::Settings s;
    s.width = clip.pictures[0].width();
    s.height = clip.pictures[0].height();
    s.rate = core::frame_rate_from("30");
    s.quantiser = quantiser;
    s.gop = codec.gop;
    s.effort = codec.effort;
    s.tune = codec.tune;
    Run run;
    run.codec = codec;
    run.told = codec.told && clip.motion;
    if (!run.told && codec.search == 0)
        run.ahead = std::make_unique<encoder::LookAhead>(s.width, s.height, s.b_pictures);
    run.encoder = std::make_unique<encoder::Encoder>(s);
    run.measured.quantiser = quantiser;
    return run;
}

/// What `work` returns; its CPU time is added to `seconds`.
template <class Work>
auto timed(double& seconds, Work work) {
    const std::clock_t begin = std::clock();
    auto result = work();
    seconds += static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
    return result;
}

}  // namespace

double Quality::add(const core::Picture& decoded, const core::Picture& original) {
    const double error = perceptual::mean_squared_error(decoded.y, original.y);
    ++pictures_;
    error_ += error;
    similarity_ += perceptual::ssim(decoded.y, original.y);
    seen_error_ += perceptual::masked_error(decoded.y, original.y);
    return error;
}

void Quality::write(Measured& to) const {
    to.psnr_y = perceptual::psnr(error_ / pictures_);
    to.ssim_y = similarity_ / pictures_;
    to.psnr_hvs_m = perceptual::psnr(seen_error_ / pictures_);
}

double in_db(double ssim) {
    return -10 * std::log10(1 - ssim);
}

std::vector<OwnCodec> own_codecs() {
    using encoder::Effort;
    return {{"quality", 15, Effort::quality, true},
            {"fast", 15, Effort::fast, true},
            {"eye", 15, Effort::quality, true, 0, encoder::Tune::perceptual},
            {"free", 60, Effort::quality, true},
            {"unaided", 15, Effort::quality, false},
            {"unaided-fast", 15, Effort::fast, false},
            {"search", 15, Effort::quality, true, 16}};
}

std::vector<std::vector<Measured>> code_with_ours(const Clip& clip, const std::vector<OwnCodec>& codecs,
                                                  const std::vector<int>& quantisers) {
    std::vector<Run> runs;
    for (const OwnCodec& codec : codecs)
        for (const int quantiser : quantisers) runs.push_back(start(clip, codec, quantiser));

    const auto count = static_cast<std::int64_t>(clip.pictures.size());
    for (std::int64_t n = 0; n < count; ++n) {
        const std::optional<double> unevenness =
            n > 0 && clip.motion ? std::optional(encoder::motion_nonuniformity(clip.motion(n, n - 1))) : std::nullopt;
        for (Run& run : runs) {
            const core::Picture& picture = clip.pictures[static_cast<std::size_t>(n)];
            encoder::PictureFacts facts;
            facts.frames_left = count - 1 - n;
            if (run.told) facts.motion_nonuniformity = unevenness;
            if (run.ahead) timed(run.measured.seconds, [&] { return run.look_ahead(clip, n, facts), 0; });
            const encoder::PicturePlan plan = run.encoder->plan(n, facts, n == 0);
            std::vector<core::MotionField> motion;
            for (const std::int64_t reference : plan.references) {
                if (run.codec.search > 0)
                    motion.push_back(timed(run.measured.seconds, [&] {
                        return full_search(picture, clip.pictures[static_cast<std::size_t>(reference)],
                                           run.measured.quantiser, run.codec.search, run.evaluations);
                    }));
                else if (run.told)
                    motion.push_back(clip.motion(n, reference));
                else if (run.ahead)
                    motion.push_back(timed(run.measured.seconds, [&] { return run.ahead->motion(n, reference); }));
            }
            encoder::Hints hints;
            if (plan.horizon && run.told) hints.onward = &clip.motion(n, *plan.horizon);
            run.take(clip,
                     timed(run.measured.seconds, [&] { return run.encoder->push(picture, plan, motion, hints); }));
        }
    }

    std::vector<std::vector<Measured>> results(codecs.size());
    for (std::size_t i = 0; i < runs.size(); ++i) {
        Run& run = runs[i];
        run.take(clip, timed(run.measured.seconds, [&] { return run.encoder->flush(); }));
        run.finish(clip.pictures.size());
        results[i / quantisers.size()].push_back(run.measured);
    }
    return results;
}

}  // namespace render2mpeg::bench
