#include "app/loop/coding_terms.h"

#include <algorithm>
#include <utility>

#include "core/error.h"
#include "encoder/step_sizes.h"

namespace render2mpeg::app {
namespace {

constexpr int side = 16;

/// Samples at half pixels are rounded means of two or four. [H262, 7.6.4]
void predict(const core::Plane<std::uint8_t>& reference, const encoder::MacroblockRecord& record, int left, int top,
             core::Plane<std::uint8_t>& out) {
    const int x_whole = record.motion_x >> 1, y_whole = record.motion_y >> 1;
    const int x_half = record.motion_x & 1, y_half = record.motion_y & 1;
    const int last_x = reference.width() - 1, last_y = reference.height() - 1;
    for (int y = top; y < std::min(top + side, out.height()); ++y) {
        const std::uint8_t* upper = reference.row(std::clamp(y + y_whole, 0, last_y));
        const std::uint8_t* lower = reference.row(std::clamp(y + y_whole + y_half, 0, last_y));
        for (int x = left; x < std::min(left + side, out.width()); ++x) {
            const int a = std::clamp(x + x_whole, 0, last_x), b = std::clamp(x + x_whole + x_half, 0, last_x);
            // Full-pixel samples are counted two or four times, which keeps their rounded mean.
            out.at(x, y) = static_cast<std::uint8_t>((upper[a] + upper[b] + lower[a] + lower[b] + 2) >> 2);
        }
    }
}

PictureRole role_of(encoder::PictureType type) {
    if (type == encoder::PictureType::intra) return PictureRole::intra;
    return type == encoder::PictureType::predicted ? PictureRole::predicted : PictureRole::disposable;
}

}  // namespace

core::Plane<std::uint8_t> prediction_of(const encoder::CodedPicture& coded,
                                        const core::Plane<std::uint8_t>& reference) {
    const core::Plane<std::uint8_t>& decoded = coded.reconstruction.y;
    EXPECTS(reference.width() == decoded.width() && reference.height() == decoded.height());
    core::Plane<std::uint8_t> prediction(decoded.width(), decoded.height(), 0);
    for (int row = 0; row < coded.macroblocks.height(); ++row)
        for (int column = 0; column < coded.macroblocks.width(); ++column) {
            const encoder::MacroblockRecord& record = coded.macroblocks.at(column, row);
            if (!record.intra) predict(reference, record, side * column, side * row, prediction);
        }
    return prediction;
}

perceptual::CodingPlan CodingTerms::steps_of(encoder::PictureType type, int quantiser) const {
    const encoder::StepSizes steps = encoder::step_sizes(coding_, quantiser);
    return {type == encoder::PictureType::intra,
            steps.scale,
            {steps.intra, steps.inter, steps.intra_dc, steps.intra_dead_zone, steps.inter_dead_zone}};
}

PlannedPicture CodingTerms::planned(const encoder::PicturePlan& plan) const {
    return {plan.number, role_of(plan.type), plan.horizon.value_or(plan.number) - plan.number,
            steps_of(plan.type, plan.quantiser), encoder::step_sizes(coding_, plan.quantiser).hidden};
}

std::optional<JudgedPicture> CodingTerms::coded(const encoder::CodedPicture& coded) {
    if (coded.plan.type == encoder::PictureType::bidirectional) return std::nullopt;
    const core::Plane<std::uint8_t> reference = std::exchange(reference_, coded.reconstruction.y);
    perceptual::CodedFacts facts;
    facts.number = coded.plan.number;
    facts.plan = steps_of(coded.plan.type, coded.quantiser);
    facts.lit_for = steps_of(coded.plan.type, coded.plan.quantiser);
    facts.intra = core::Plane<std::uint8_t>(coded.macroblocks.width(), coded.macroblocks.height());
    facts.scale = core::Plane<float>(coded.macroblocks.width(), coded.macroblocks.height());
    for (std::size_t i = 0; i < coded.macroblocks.size(); ++i) {
        const encoder::MacroblockRecord& record = coded.macroblocks.values()[i];
        facts.intra.values()[i] = record.intra ? 1 : 0;
        facts.scale.values()[i] = encoder::step_scale(coding_.codec, record.quantiser);
    }
    facts.reconstruction = coded.reconstruction.y;
    if (coded.plan.type == encoder::PictureType::predicted && coded.tells_vectors)
        facts.prediction = prediction_of(coded, reference);
    return JudgedPicture{role_of(coded.plan.type), std::move(facts)};
}

}  // namespace render2mpeg::app
