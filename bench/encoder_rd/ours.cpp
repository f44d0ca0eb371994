#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

#include "app/loop/frame_source.h"
#include "app/loop/picture_coder.h"
#include "core/numeric.h"
#include "encoder/encoder.h"
#include "encoder_rd/codecs.h"
#include "encoder_rd/full_search.h"
#include "perceptual/metrics.h"

namespace render2mpeg::bench {
namespace {

/// The clip's exact motion from one picture; none where it is not told.
class ToldMotion : public app::Motion {
  public:
    ToldMotion(const Clip& clip, bool told, std::int64_t picture) : clip_(clip), told_(told), picture_(picture) {}

  private:
    std::optional<core::MotionField> find(std::int64_t reference) override {
        return told_ ? std::optional(clip_.motion(picture_, reference)) : std::nullopt;
    }

    const Clip& clip_;
    bool told_;
    std::int64_t picture_;
};

/// A full search's motion to references; onward the exact one.
class SearchedMotion : public app::Motion {
  public:
    SearchedMotion(const Clip& clip, const core::Picture& picture, int quantiser, int range, std::uint64_t& evaluations)
        : clip_(clip), picture_(picture), quantiser_(quantiser), range_(range), evaluations_(evaluations) {}

    const core::MotionField* onward(std::int64_t horizon) override { return &clip_.motion(picture_.number, horizon); }

  private:
    std::optional<core::MotionField> find(std::int64_t reference) override {
        return full_search(picture_, clip_.pictures[static_cast<std::size_t>(reference)], quantiser_, range_,
                           evaluations_);
    }

    const Clip& clip_;
    const core::Picture& picture_;
    int quantiser_, range_;
    std::uint64_t& evaluations_;
};

/// One encoder at work.
struct Run {
    OwnCodec codec;
    bool told = true;  ///< the clip knows its motion, and the encoder may
    app::RunStatistics statistics;
    std::unique_ptr<encoder::LookAhead> ahead;  ///< null: as a renderer codes, which has no pictures to come
    std::unique_ptr<app::PictureCoder> coder;
    Measured measured;
    Quality quality;
    std::int64_t looked = 0;
    std::uint64_t evaluations = 0, macroblocks = 0, intra = 0, skipped = 0;

    /// Codes the clip's next picture.
    void code(const Clip& clip, const core::Picture& picture) {
        const std::int64_t n = picture.number;
        ToldMotion motion(clip, told, n);
        if (n > 0) motion.to(n - 1);
        const bool cut = ahead && look(clip, n);
        std::vector<const core::Picture*> pictures;
        for (std::int64_t i = n; ahead && i < std::min(looked, n + 1 + encoder::LookAhead::depth); ++i)
            pictures.push_back(&clip.pictures[static_cast<std::size_t>(i)]);
        const encoder::PicturePlan plan = coder->plan(n, cut, motion, pictures);
        if (codec.search > 0) {
            SearchedMotion searched(clip, picture, measured.quantiser, codec.search, evaluations);
            return take(clip, coder->code(picture, plan, searched));
        }
        for (const std::int64_t reference : plan.references) motion.to(reference);
        if (plan.horizon) motion.onward(*plan.horizon);
        take(clip, coder->code(picture, plan, motion));
    }

    /// Looks at the pictures to come; whether there is a cut before this one.
    bool look(const Clip& clip, std::int64_t n) {
        const app::StageTimer timer(statistics, app::Stage::encode);
        const auto count = static_cast<std::int64_t>(clip.pictures.size());
        for (; looked < std::min(count, n + 1 + encoder::LookAhead::depth); ++looked)
            ahead->add(clip.pictures[static_cast<std::size_t>(looked)]);
        if (looked == count) ahead->end();
        ahead->forget_before(n - 4);
        return ahead->cut_before(n);
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

    void finish(const Clip& clip) {
        take(clip, coder->flush());
        const auto share = [&](std::uint64_t n) {
            return core::divide_or(static_cast<double>(n), static_cast<double>(macroblocks), 0.0);
        };
        measured.pictures = static_cast<std::int64_t>(clip.pictures.size());
        measured.bits += 8.0 * static_cast<double>(encoder::sequence_end().size());
        measured.seconds = statistics.of(app::Stage::encode);
        measured.evaluations = share(evaluations);
        measured.intra = share(intra);
        measured.skipped = share(skipped);
        quality.write(measured);
    }
};

std::unique_ptr<Run> start(const Clip& clip, const OwnCodec& codec, int quantiser) {
    auto run = std::make_unique<Run>();
    app::Film film;
    film.frames = {0, static_cast<std::int64_t>(clip.pictures.size()) - 1};
    encoder::Settings& s = film.coding;
    s.width = clip.pictures[0].width();
    s.height = clip.pictures[0].height();
    s.rate = core::frame_rate_from("30");
    s.quantiser = quantiser;
    s.gop = codec.gop;
    s.effort = codec.effort;
    s.tune = codec.tune;
    if (codec.constant_quality) {
        s.rate_control.mode = encoder::RateMode::constant_quality;
        s.rate_control.quality = 100 - 20 * std::log2(quantiser);
    }
    run->codec = codec;
    run->told = codec.told && clip.motion;
    if (codec.ahead) run->ahead = std::make_unique<encoder::LookAhead>(s.width, s.height, s.b_pictures);
    run->coder = std::make_unique<app::PictureCoder>(
        film, app::Chunk{0, film.frames.first, film.frames.last}, std::span<const encoder::BitAllocation>(),
        std::vector<std::int64_t>(), run->statistics, clip.lights_change && !codec.ahead, run->ahead.get());
    run->measured.quantiser = quantiser;
    return run;
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
            {"lit", 15, Effort::quality, true, 0, encoder::Tune::psnr, false, false},
            {"constant", 15, Effort::quality, true, 0, encoder::Tune::psnr, true},
            {"constant-lit", 15, Effort::quality, true, 0, encoder::Tune::psnr, true, false},
            {"fast", 15, Effort::fast, true},
            {"eye", 15, Effort::quality, true, 0, encoder::Tune::perceptual},
            {"free", 60, Effort::quality, true},
            {"unaided", 15, Effort::quality, false},
            {"unaided-fast", 15, Effort::fast, false},
            {"search", 15, Effort::quality, true, 16}};
}

std::vector<std::vector<Measured>> code_with_ours(const Clip& clip, const std::vector<OwnCodec>& codecs,
                                                  const std::vector<int>& quantisers) {
    std::vector<std::unique_ptr<Run>> runs;
    for (const OwnCodec& codec : codecs)
        for (const int quantiser : quantisers) runs.push_back(start(clip, codec, quantiser));
    for (const core::Picture& picture : clip.pictures)
        for (const auto& run : runs) run->code(clip, picture);

    std::vector<std::vector<Measured>> results(codecs.size());
    for (std::size_t i = 0; i < runs.size(); ++i) {
        runs[i]->finish(clip);
        results[i / quantisers.size()].push_back(runs[i]->measured);
    }
    return results;
}

}  // namespace render2mpeg::bench
