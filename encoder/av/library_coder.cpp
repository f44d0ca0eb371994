// Plans films for libavcodec's encoders: types, and quantisers known before pictures are made.
#include <algorithm>
#include <cmath>
#include <deque>
#include <string>
#include <utility>

#include "core/error.h"
#include "encoder/av/access_unit.h"
#include "encoder/av/backend.h"
#include "encoder/av/coders.h"
#include "encoder/av/levels.h"
#include "encoder/codec.h"
#include "encoder/encoder.h"
#include "encoder/mpeg2/kernels/frame.h"
#include "encoder/mpeg2/macroblock/macroblock_tree.h"
#include "encoder/mpeg2/macroblock/overrides.h"
#include "encoder/mpeg2/motion/picture_order.h"

namespace render2mpeg::av {
namespace {

using encoder::CodedPicture;
using encoder::PicturePlan;
using encoder::PictureType;

/// Quantisers of these codecs are logarithms: a step is twice as large after so many.
double quantisers_for_doubling(encoder::Codec codec) {
    return codec == encoder::Codec::av1 ? 9.6 : 6.0;  // of AV1 where qindex is above 95 (encoder/codec.cpp)
}

/// Whether one quantiser is told to an encoder for all its pictures: each group then has its own encoder.
bool has_one_quantiser(encoder::Codec codec) {
    return codec == encoder::Codec::av1;
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

/// Bit budget of a chunk: the remaining bits decide the quantisers of the remaining pictures.
class Budget {
  public:
    Budget() = default;
    explicit Budget(double bits) : bits_(bits) {}

    void spend(double expected, double real) {
        expected_ += expected;
        real_ += real;
    }
    /// MPEG-2's quantiser for a future picture, by its allocation.
    double quantiser(const encoder::BitAllocation& allocated) const {
        if (expected_ <= 0 || bits_ <= 0) return allocated.quantiser;
        // chosen: what was expected counts as much as an eighth of the chunk (1/16..1/4): first pictures tell little.
        const double prior = bits_ / 8, excess = (real_ + prior) / (expected_ + prior);
        const double left = std::max(bits_ - real_, 0.1 * bits_), rest = excess * std::max(bits_ - expected_, 0.0);
        // chosen: bits fall with the quantiser's power 0.9 (encoder/mpeg2/rate/rate_model.h: 0.7 to 0.95); a factor of
        // 2 at most.
        return allocated.quantiser * std::clamp(std::pow(rest / left, 1 / 0.9), 0.5, 2.0);
    }

  private:
    double bits_ = 0, expected_ = 0, real_ = 0;
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
          rows_((settings.height + 15) / 16) {}

    PicturePlan plan(std::int64_t number, const encoder::PictureFacts& told, bool first_of_chunk) override {
        // chosen: runs as long as may be; what shortens them in MPEG-2 (uneven motion, light that changes) does not pay
        // where vectors are of quarter pixels and predictions are weighted (docs/measurements.md#codecs).
        encoder::PictureFacts facts = told;
        facts.motion_nonuniformity.reset();
        facts.light_change.reset();
        first_of_chunk = first_of_chunk || !order_.last();
        const bool starts_gop = first_of_chunk || order_.gop_is_over(number) || facts.cut_before || facts.keyframe;
        PicturePlan plan = order_.plan(number, facts, starts_gop, false);
        if (first_of_chunk) {
            rounding_ = 0;
            ++chunk_;
            budget_ = facts.allocation ? Budget(facts.allocation->bits_left) : Budget();
        }
        plan.quantiser = limited(base_of(number, facts, starts_gop) + offset_of(settings_.codec, plan));
        plan.references.clear();  // these encoders look for vectors by themselves
        planned_.push_back({plan, first_of_chunk, chunk_, facts.allocation ? facts.allocation->bits : 0, group_base_});
        return plan;
    }

    std::vector<CodedPicture> push(const core::Picture& picture, const PicturePlan& plan,
                                   std::span<const core::MotionField>, const encoder::Hints& hints) override {
        EXPECTS(!planned_.empty() && plan == planned_.front().plan);
        std::vector<CodedPicture> complete;
        if (planned_.front().first_of_chunk || (plan.starts_gop && has_one_quantiser(settings_.codec))) {
            complete = close();
            encoder::Settings opened = settings_;
            if (has_one_quantiser(settings_.codec)) opened.quantiser = limited(planned_.front().group_base);
            library_ = backend().open_encoder(opened);
        }
        const Planned planned = std::move(planned_.front());
        planned_.pop_front();
        LibraryOrder order{plan.type, plan.starts_gop, quantisers_of(plan, hints)};
        library_->send(picture, order);
        sent_.push_back({plan, planned.chunk, planned.bits, std::move(order.quantisers)});
        // Threads of other libraries decide when their pictures come, and light must not depend on that.
        if (settings_.codec == encoder::Codec::h264 || facts_.master) collect(complete);
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
        bool first_of_chunk;
        int chunk;
        double bits;        ///< allocated
        double group_base;  ///< where a group has one quantiser
    };
    struct Sent {
        PicturePlan plan;
        int chunk;
        double bits;
        core::Plane<std::uint8_t> quantisers;
    };

    /// The quantiser of P pictures that nothing refers to, not rounded.
    double wanted(const encoder::PictureFacts& facts) const {
        const encoder::RateControl& rate = settings_.rate_control;
        if (facts.allocation) return encoder::quantiser_like(settings_.codec, budget_.quantiser(*facts.allocation));
        if (rate.mode == encoder::RateMode::constant_quantiser) return settings_.quantiser;
        return encoder::quantiser_like(settings_.codec,
                                       std::exp2((100 - rate.quality) / 20) * facts.quality_factor.value_or(1.0));
    }

    /// The same as a whole number, such that pictures come to it on average; where a group has one quantiser, groups
    /// do.
    double base_of(std::int64_t number, const encoder::PictureFacts& facts, bool starts_gop) {
        if (!has_one_quantiser(settings_.codec)) {
            const double exact = wanted(facts) + rounding_, base = std::round(exact);
            rounding_ = exact - base;
            return base;
        }
        if (starts_gop) {
            // The golden ratio's multiples fall evenly between whole numbers, wherever one begins.
            const double group = std::floor(static_cast<double>(number) / settings_.gop),
                         phase = 0.618034 * group + 0.5;
            group_base_ = std::floor(wanted(facts) + phase - std::floor(phase));
        }
        return group_base_;
    }

    int limited(double quantiser) const {
        return std::clamp(static_cast<int>(std::lround(quantiser)), facts_.finest, facts_.coarsest);
    }

    /// By macroblock: what later pictures are predicted from is finer. In steps of two, since x264 gives a macroblock
    /// whose quantiser differs by one from its neighbour's that one's.
    core::Plane<std::uint8_t> quantisers_of(const PicturePlan& plan, const encoder::Hints& hints) {
        const auto nominal = static_cast<std::uint8_t>(plan.quantiser);
        if (has_one_quantiser(settings_.codec)) return {1, 1, nominal};
        core::Plane<std::uint8_t> quantisers(columns_, rows_, nominal);
        const core::Plane<float> factors =
            encoder::mpeg2::overrides_from(hints, columns_, rows_,
                                           encoder::mpeg2_quantiser_like(settings_.codec, plan.quantiser))
                .quantiser_factors;
        for (std::size_t i = 0; i < factors.size(); ++i) {
            const double offset = quantisers_for_doubling(settings_.codec) * std::log2(factors.values()[i]);
            quantisers.values()[i] =
                static_cast<std::uint8_t>(limited(plan.quantiser + 2.0 * std::round(0.5 * offset)));
        }
        return quantisers;
    }

    std::vector<CodedPicture> close() {
        std::vector<CodedPicture> complete;
        if (!library_) return complete;
        library_->end();
        collect(complete);
        EXPECTS(sent_.empty());
        library_.reset();
        return complete;
    }

    void collect(std::vector<CodedPicture>& complete) {
        for (LibraryPicture& picture : library_->take()) complete.push_back(told(std::move(picture)));
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
        coded.quantiser = coded.plan.quantiser;
        coded.coding_order = coding_order_++;
        // SVT-AV1's own header within the stream differs from the one that it tells beforehand.
        if (facts_.master) {
            coded.bytes = put_together(library_->headers(), picture.bytes);
        } else {
            AccessUnit unit = taken_apart(settings_.codec, picture.bytes);
            if (coded.plan.starts_gop) coded.bytes = unit.headers.empty() ? library_->headers() : unit.headers;
            coded.bytes.insert(coded.bytes.end(), unit.pictures.begin(), unit.pictures.end());
        }
        coded.reconstruction = std::move(picture.reconstruction);
        coded.macroblocks = records_of(sent->quantisers, picture);
        coded.tells_vectors = false;
        // Plans run ahead of pushes: a budget may be the next chunk's already.
        if (sent->chunk == chunk_) budget_.spend(sent->bits, 8.0 * static_cast<double>(coded.bytes.size()));
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
    int chunk_ = 0;                            ///< of the picture planned last
    std::int64_t coding_order_ = 0;
    int columns_, rows_;     ///< of macroblocks
    double rounding_ = 0;    ///< of the bases of pictures so far
    double group_base_ = 0;  ///< of the pictures of a group
    Budget budget_;
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
    const int least = settings.codec == encoder::Codec::av1 ? 64 : 16;
    if (std::min(settings.width, settings.height) < least || std::max(settings.width, settings.height) > most)
        throw core::Error("coding", name,
                          "pictures have " + std::to_string(least) + " to 8192 pixels on a side, these are " +
                              std::to_string(settings.width) + "x" + std::to_string(settings.height));
    if (settings.width % 2 != 0 || settings.height % 2 != 0)
        throw core::Error("coding", name,
                          "width and height must be even, but the pictures are " + std::to_string(settings.width) +
                              "x" + std::to_string(settings.height));
}

}  // namespace

void check(const encoder::Settings& settings) {
    if (settings.codec == encoder::Codec::mpeg2) return encoder::check(settings);
    check_modes(settings);
    backend().check_encoder(settings);
}

std::unique_ptr<encoder::Coder> make_coder(const encoder::Settings& settings) {
    av::check(settings);
    if (settings.codec == encoder::Codec::mpeg2) return std::make_unique<encoder::Encoder>(settings);
    return std::make_unique<LibraryCoder>(settings);
}

}  // namespace render2mpeg::av
