#include "app/loop/coding_terms.h"

#include <utility>

#include "app/loop/prediction.h"
#include "encoder/step_sizes.h"

namespace render2mpeg::app {
namespace {

PictureRole role_of(encoder::PictureType type) {
    if (type == encoder::PictureType::intra) return PictureRole::intra;
    return type == encoder::PictureType::predicted ? PictureRole::predicted : PictureRole::disposable;
}

}  // namespace

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
