// Plans films for libavcodec's encoders: types, and quantisers known before pictures are made.
#include <algorithm>
#include <cmath>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "core/error.h"
#include "encoder/av/access_unit.h"
#include "encoder/av/av1_grain.h"
#include "encoder/av/backend.h"
#include "encoder/av/coders.h"
#include "encoder/av/gif_coder.h"
#include "encoder/av/levels.h"
#include "encoder/av/svt_layers.h"
#include "encoder/codec.h"
#include "encoder/encoder.h"
#include "encoder/mpeg2/kernels/frame.h"
#include "encoder/mpeg2/macroblock/macroblock_tree.h"
#include "encoder/mpeg2/macroblock/overrides.h"
#include "encoder/mpeg2/motion/picture_order.h"
#include "encoder/rate_search.h"

namespace render2mpeg::av {
namespace {

using encoder::CodedPicture;
using encoder::PicturePlan;
using encoder::PictureType;

/// Whether one quantiser is told to an encoder for all its pictures: each group then has its own encoder.
bool has_one_quantiser(encoder::Codec codec) {
    const encoder::CodecFacts& facts = encoder::facts_of(codec);
    return !facts.takes_blocks && !facts.master;
}

/// Settings::color_primaries of films whose displays have 10 bits.
constexpr int of_high_dynamic_range = 9;

/// Steps of a quantiser that the encoder can be told.
double steps_of(encoder::Codec codec) {
    return codec == encoder::Codec::av1 ? steps_of_quantiser : 1;
}

/// Quantisers of these codecs are logarithms: a step is twice as large after so many.
double quantisers_for_doubling(encoder::Codec codec) {
    return has_one_quantiser(codec) ? 9.6 : 6.0;  // of AV1 and VP9 where qindex is above 95 (encoder/codec.cpp)
}

/// The quantiser of a picture less that of a P picture that nothing refers to.
/// chosen: docs/measurements.md#codecs
double offset_of(encoder::Codec codec, const PicturePlan& plan) {
    if (has_one_quantiser(codec)) return 0;
    const encoder::LibraryOffsets offsets = encoder::facts_of(codec).offsets;
    if (plan.type == PictureType::bidirectional) {
        const std::int64_t earlier = plan.references.front(), later = plan.references.back();
        const bool middle = encoder::is_middle(plan.number - earlier - 1, later - earlier - 1);
        return middle ? offsets.middle : offsets.bidirectional;
    }
    const std::int64_t followers = plan.horizon.value_or(plan.number) - plan.number;
    constexpr std::int64_t most_followers = 24;
    const double strength = 0.9;  // chosen: of 0.3 to 1.4
    return -strength * std::log2(1.0 + static_cast<double>(std::min(followers, most_followers)));
}

/// Quantisers that are coded, whole ones or AV1's sixteenths, whose mean is that of wanted ones.
class Rounding {
  public:
    /// Of the P pictures that nothing refers to; `number` and `gop` tell groups apart where those have one quantiser.
    double operator()(double exact, std::int64_t number, bool starts_gop, const encoder::Settings& settings) {
        if (!has_one_quantiser(settings.codec)) {
            exact += left_;
            const double base = std::round(exact);
            left_ = exact - base;
            return base;
        }
        if (starts_gop) {
            // The golden ratio's multiples fall evenly between whole numbers, wherever one begins.
            const double group = std::floor(static_cast<double>(number) / settings.gop), phase = 0.618034 * group + 0.5;
            const double steps = steps_of(settings.codec);
            group_ = std::floor(steps * exact + phase - std::floor(phase)) / steps;
        }
        return group_;
    }

  private:
    double left_ = 0, group_ = 0;
};

encoder::Settings with_level(encoder::Settings settings) {
    settings.references = references_for(settings);
    // Only x264 is told what was not asked for: the others find the lowest by themselves.
    if (settings.codec == encoder::Codec::h264) settings.level = level_for(settings);
    return settings;
}

class LibraryCoder final : public encoder::Coder {
  public:
    explicit LibraryCoder(const encoder::Settings& settings)
        : settings_(with_level(settings)),
          facts_(encoder::facts_of(settings.codec)),
          order_(facts_.master ? 1 : settings.gop, settings.b_pictures),
          columns_((settings.width + 15) / 16),
          rows_((settings.height + 15) / 16) {
        if (!facts_.adds_grain) return;
        grain_.emplace();
        if (settings.grain > 0) grain_->set_table(film_grain_table(settings.grain, settings.height));
    }

    PicturePlan plan(std::int64_t number, const encoder::PictureFacts& told, bool first_of_chunk) override {
        // chosen: runs as long as may be; what shortens them in MPEG-2 (uneven motion, light that changes) does not pay
        // where vectors are of quarter pixels and predictions are weighted (docs/measurements.md#codecs).
        encoder::PictureFacts facts = told;
        facts.motion_nonuniformity.reset();
        facts.light_change.reset();
        first_of_chunk = first_of_chunk || !order_.last();
        const bool starts_gop = first_of_chunk || order_.gop_is_over(number) || facts.cut_before || facts.keyframe;
        PicturePlan plan = order_.plan(number, facts, starts_gop, false);
        if (first_of_chunk) rounding_ = {};
        Planned planned;
        planned.opens = first_of_chunk || (starts_gop && has_one_quantiser(settings_.codec));
        planned.offset = offset_of(settings_.codec, plan);
        if (facts.allocation) planned.allocated = facts.allocation->quantiser;
        if (facts.allocation && first_of_chunk)
            planned.chunk_bits = facts.allocation->affordable * facts.allocation->bits_left;
        planned.quantiser = limited(rounding_(wanted(facts), number, starts_gop, settings_) + planned.offset);
        plan.quantiser = static_cast<int>(std::lround(planned.quantiser));
        if (starts_gop) group_start_ = number;
        if (settings_.codec == encoder::Codec::av1)
            plan.step_ratio =
                svt_step_ratio(number - group_start_,
                               std::min(number + facts.frames_left, group_start_ + settings_.gop - 1) - group_start_) *
                static_cast<float>(encoder::step_of(settings_.codec, planned.quantiser) /
                                   encoder::step_of(settings_.codec, plan.quantiser));
        plan.references.clear();  // these encoders look for vectors by themselves
        planned.plan = plan;
        planned.first_of_chunk = first_of_chunk;
        planned_.push_back(std::move(planned));
        return plan;
    }

    std::vector<CodedPicture> push(const core::Picture& picture, const PicturePlan& plan,
                                   std::span<const core::MotionField>, const encoder::Hints& hints) override {
        EXPECTS(!planned_.empty() && plan == planned_.front().plan);
        std::vector<CodedPicture> complete;
        Planned planned = std::move(planned_.front());
        planned_.pop_front();
        if (planned.first_of_chunk) {
            complete = close();
            chunk_bits_ = planned.chunk_bits;
        }
        planned.factors = factors_of(plan, hints);
        if (chunk_bits_ > 0) {
            // Its bits are known when the chunk is.
            kept_.push_back({std::move(planned), picture});
            if (!facts_.has_more_than_8_bits()) kept_.back().picture.luma = {};
            return complete;
        }
        send(picture, planned, planned.quantiser, complete);
        // Threads of other libraries decide when their pictures come, and light must not depend on that.
        if (settings_.codec != encoder::Codec::hevc && settings_.codec != encoder::Codec::av1) collect(complete);
        return complete;
    }

    std::vector<CodedPicture> flush() override {
        order_.cut_short();
        planned_.clear();
        return close();
    }

  private:
    struct Planned {
        PicturePlan plan;
        bool first_of_chunk = false;
        bool opens = false;            ///< an encoder of its own
        double quantiser = 0;          ///< of AV1 to a sixteenth, whose whole one the plan has
        double offset = 0;             ///< of it, by type
        double allocated = 0;          ///< MPEG-2's quantiser; 0: no bits are allocated
        double chunk_bits = 0;         ///< first of a chunk: to be reached; 0: whatever it comes to
        core::Plane<float> factors{};  ///< on quantisers of macroblocks; empty: 1
    };
    struct Kept {
        Planned planned;
        core::Picture picture;
    };
    struct Sent {
        PicturePlan plan;
        int quantiser;
        core::Plane<std::uint8_t> quantisers;
    };

    /// The quantiser of P pictures that nothing refers to, not rounded.
    double wanted(const encoder::PictureFacts& facts) const {
        const encoder::RateControl& rate = settings_.rate_control;
        if (facts.allocation) return encoder::quantiser_like(settings_.codec, facts.allocation->quantiser);
        if (rate.mode == encoder::RateMode::constant_quantiser) return settings_.quantiser;
        return encoder::quantiser_like(settings_.codec,
                                       std::exp2((100 - rate.quality) / 20) * facts.quality_factor.value_or(1.0));
    }

    double limited(double quantiser) const {
        const double steps = steps_of(settings_.codec);
        return std::clamp(std::round(steps * quantiser) / steps, static_cast<double>(facts_.finest),
                          static_cast<double>(facts_.coarsest));
    }

    core::Plane<float> factors_of(const PicturePlan& plan, const encoder::Hints& hints) const {
        if (has_one_quantiser(settings_.codec)) return {};
        return encoder::mpeg2::overrides_from(hints, columns_, rows_,
                                              encoder::mpeg2_quantiser_like(settings_.codec, plan.quantiser))
            .quantiser_factors;
    }

    /// By macroblock: what later pictures are predicted from is finer. In steps of two, since x264 gives a macroblock
    /// whose quantiser differs by one from its neighbour's that one's.
    core::Plane<std::uint8_t> quantisers_of(const core::Plane<float>& factors, int quantiser) const {
        const auto nominal = static_cast<std::uint8_t>(quantiser);
        if (has_one_quantiser(settings_.codec)) return {1, 1, nominal};
        core::Plane<std::uint8_t> quantisers(columns_, rows_, nominal);
        for (std::size_t i = 0; i < factors.size(); ++i) {
            const double offset = quantisers_for_doubling(settings_.codec) * std::log2(factors.values()[i]);
            quantisers.values()[i] = static_cast<std::uint8_t>(limited(quantiser + 2.0 * std::round(0.5 * offset)));
        }
        return quantisers;
    }

    void send(const core::Picture& picture, const Planned& planned, double quantiser,
              std::vector<CodedPicture>& complete) {
        const int whole = static_cast<int>(std::lround(quantiser));
        if (planned.opens) {
            finish(complete);
            encoder::Settings opened = settings_;
            // Offsets are from this one in x264 and x265; far from it they cost up to 6 dB at equal bits.
            opened.quantiser = settings_.codec == encoder::Codec::av1
                                   ? svt_quantiser(quantiser)
                                   : static_cast<int>(std::lround(limited(quantiser - planned.offset)));
            library_ = backend().open_encoder(opened, svt_index_offsets(quantiser));
        }
        LibraryOrder order{planned.plan.type, planned.plan.starts_gop, quantisers_of(planned.factors, whole)};
        library_->send(picture, order);
        sent_.push_back({planned.plan, whole, std::move(order.quantisers)});
    }

    /// Pictures that the library still has.
    void finish(std::vector<CodedPicture>& complete) {
        if (!library_) return;
        library_->end();
        collect(complete);
        EXPECTS(sent_.empty());
        library_.reset();
    }

    /// Quantisers of the chunk that is kept, with a factor on those allocated.
    std::vector<double> quantisers_with(double factor) const {
        std::vector<double> quantisers;
        Rounding rounding;
        for (const Kept& kept : kept_) {
            const PicturePlan& plan = kept.planned.plan;
            const double least = encoder::mpeg2_quantiser_like(settings_.codec, facts_.finest),
                         most = encoder::mpeg2_quantiser_like(settings_.codec, facts_.coarsest),
                         exact = encoder::quantiser_like(settings_.codec,
                                                         std::clamp(kept.planned.allocated, least, most) * factor);
            quantisers.push_back(
                limited(rounding(exact, plan.number, plan.starts_gop, settings_) + kept.planned.offset));
        }
        return quantisers;
    }

    std::vector<CodedPicture> code_kept(const std::vector<double>& quantisers) {
        std::vector<CodedPicture> complete;
        for (std::size_t i = 0; i < kept_.size(); ++i)
            send(kept_[i].picture, kept_[i].planned, quantisers[i], complete);
        finish(complete);
        return complete;
    }

    /// The rest of a chunk. One that has its bits allocated is coded until it comes to them.
    std::vector<CodedPicture> close() {
        std::vector<CodedPicture> complete;
        finish(complete);
        if (kept_.empty()) return complete;
        const std::int64_t first = coding_order_;
        std::map<std::vector<double>, double> bits_of;
        std::vector<double> best, last;
        for (encoder::RateSearch search; search.goes_on();) {
            const std::vector<double> quantisers = quantisers_with(search.factor());
            const auto [tried, is_new] = bits_of.try_emplace(quantisers, 0);
            if (is_new) {
                coding_order_ = first;
                complete = code_kept(last = quantisers);
                for (const CodedPicture& coded : complete)
                    tried->second += 8.0 * static_cast<double>(coded.bytes.size());
            }
            if (search.try_ratio(tried->second / chunk_bits_)) best = quantisers;
        }
        if (best != last) {
            coding_order_ = first;
            complete = code_kept(best);
        }
        kept_.clear();
        return complete;
    }

    void collect(std::vector<CodedPicture>& complete) {
        std::vector<LibraryPicture> pictures = library_->take();
        // These are a whole group.
        if (grain_ && settings_.grain == 0 && settings_.color_primaries != of_high_dynamic_range) {
            GradientDither dither;
            for (const LibraryPicture& picture : pictures) dither.add(picture.reconstruction.y);
            grain_->set_table(dither.table());
        }
        for (LibraryPicture& picture : pictures) complete.push_back(told(std::move(picture)));
    }

    CodedPicture told(LibraryPicture picture) {
        const auto sent =
            std::find_if(sent_.begin(), sent_.end(), [&](const Sent& s) { return s.plan.number == picture.number; });
        EXPECTS(sent != sent_.end());
        CodedPicture coded;
        coded.plan = std::move(sent->plan);
        // Where a film ends early, the last picture refers to none behind it.
        if (coded.plan.type == PictureType::bidirectional && picture.type == PictureType::predicted)
            coded.plan.type = PictureType::predicted;
        coded.quantiser = sent->quantiser;
        coded.coding_order = coding_order_++;
        // SVT-AV1's own header within the stream differs from the one that it tells beforehand.
        if (!has_byte_stream(settings_.codec)) {
            coded.bytes = put_together(facts_.master ? library_->headers() : picture.alpha, picture.bytes);
        } else {
            AccessUnit unit = taken_apart(settings_.codec, picture.bytes);
            if (coded.plan.starts_gop) coded.bytes = unit.headers.empty() ? library_->headers() : unit.headers;
            coded.bytes.insert(coded.bytes.end(), unit.pictures.begin(), unit.pictures.end());
            if (grain_) coded.bytes = grain_->with_grain(coded.bytes, coded.plan.number);
        }
        coded.reconstruction = std::move(picture.reconstruction);
        coded.macroblocks = records_of(sent->quantisers, picture);
        coded.tells_vectors = false;
        sent_.erase(sent);
        return coded;
    }

    /// Macroblocks as the decoder tells them. One without coded coefficients has the quantiser of the one before it,
    /// whatever was asked for, and uses none: it keeps what was planned.
    core::Plane<encoder::MacroblockRecord> records_of(const core::Plane<std::uint8_t>& planned,
                                                      const LibraryPicture& picture) const {
        core::Plane<encoder::MacroblockRecord> records(columns_, rows_);
        std::uint8_t before = 0;
        for (std::size_t i = 0; i < records.size(); ++i) {
            encoder::MacroblockRecord& record = records.values()[i];
            const std::uint8_t asked = planned.values()[planned.size() == 1 ? 0 : i];
            record.intra = picture.type == PictureType::intra;
            record.quantiser = asked;
            if (picture.macroblocks.empty()) continue;
            const encoder::MacroblockRecord& decoded = picture.macroblocks.values()[i];
            record = decoded;
            if (i > 0 && decoded.quantiser == before) record.quantiser = asked;
            before = decoded.quantiser;
        }
        return records;
    }

    const encoder::Settings settings_;
    const encoder::CodecFacts facts_;
    encoder::mpeg2::PictureOrder order_;
    std::deque<Planned> planned_;
    std::deque<Sent> sent_;                    ///< to the library and not come back
    std::unique_ptr<LibraryEncoder> library_;  ///< of a chunk
    std::vector<Kept> kept_;                   ///< a chunk's pictures, where its bits are to be reached
    double chunk_bits_ = 0;                    ///< that chunk's
    std::int64_t coding_order_ = 0;
    std::int64_t group_start_ = 0;
    int columns_, rows_;  ///< of macroblocks
    Rounding rounding_;   ///< of plans
    std::optional<Av1Grain> grain_;
};

/// Refuses modes that only our own encoder supports.
void check_modes(const encoder::Settings& settings) {
    const std::string name(encoder::facts_of(settings.codec).name);
    const auto refuse = [&](const char* what) {
        throw core::Error("coding", name, std::string(what) + " is MPEG-2's; choose --codec mpeg2");
    };
    if (settings.cadence != encoder::Cadence::frames) refuse("showing pictures as fields");
    const encoder::RateControl& rate = settings.rate_control;
    if (rate.mode == encoder::RateMode::constant) refuse("--cbr");
    if (rate.mode == encoder::RateMode::variable && rate.bit_rate < 400)
        throw core::Error("bit rate " + std::to_string(rate.bit_rate) + ": must be at least 400 bits per second");
    if (rate.max_rate > 0) refuse("--maxrate");
    if (rate.buffer_bits > 0) refuse("--vbv");
    if (encoder::facts_of(settings.codec).master && (settings.level > 0 || rate.bit_rate > 0))
        throw core::Error("coding", name, "a master has its own rate and level; leave --bitrate and --level out");
    if (settings.codec == encoder::Codec::dnxhr && settings.matrix_coefficients != 1)
        throw core::Error("coding", name,
                          "it has the matrix of pictures of 720 lines and more alone, these have " +
                              std::to_string(settings.height) + "; choose --codec prores");
    level_for(settings);
    // chosen: what all of these libraries take.
    constexpr int most = 8192;
    const encoder::CodecFacts& facts = encoder::facts_of(settings.codec);
    const auto size = [](int width, int height) { return std::to_string(width) + "x" + std::to_string(height); };
    if (settings.width < facts.least_width || settings.height < facts.least_height ||
        std::max(settings.width, settings.height) > most)
        throw core::Error("coding", name,
                          "pictures have " + size(facts.least_width, facts.least_height) + " to " + size(most, most) +
                              " pixels, these have " + size(settings.width, settings.height));
    if (facts.even_sides() && (settings.width % 2 != 0 || settings.height % 2 != 0))
        throw core::Error("coding", name,
                          "width and height must be even, but the pictures are " + std::to_string(settings.width) +
                              "x" + std::to_string(settings.height));
}

}  // namespace

void check(const encoder::Settings& settings) {
    if (settings.codec == encoder::Codec::mpeg2) return encoder::check(settings);
    check_modes(settings);
    if (settings.codec == encoder::Codec::gif) return check_gif(settings);
    backend().check_encoder(settings);
}

std::unique_ptr<encoder::Coder> make_coder(const encoder::Settings& settings) {
    av::check(settings);
    if (settings.codec == encoder::Codec::mpeg2) return std::make_unique<encoder::Encoder>(settings);
    if (settings.codec == encoder::Codec::gif) return std::make_unique<GifCoder>(settings);
    return std::make_unique<LibraryCoder>(settings);
}

}  // namespace render2mpeg::av
