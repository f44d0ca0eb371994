#include "app/loop/coupling.h"

#include <utility>

#include "app/loop/prediction.h"
#include "core/error.h"
#include "encoder/mpeg2/kernels/quantiser.h"
#include "encoder/mpeg2/macroblock/weighting_matrices.h"
#include "perceptual/tolerance_fraction.h"

namespace render2mpeg::app {
namespace {

/// quantiser_scale_code q with q_scale_type 0 is quantiser_scale 2 q; steps are sixteenths of matrix x quantiser_scale.
/// [H262, 7.4.2]
float scale_of(int quantiser) {
    return static_cast<float>(quantiser) / 8.0f;
}

perceptual::Quantisation matrices_for(encoder::Tune tune) {
    const encoder::mpeg2::Matrices matrices = encoder::mpeg2::matrices_for(tune);
    perceptual::Quantisation quantisation;
    for (std::size_t i = 0; i < 64; ++i) {
        quantisation.intra[i] = static_cast<float>(matrices.intra[i]);
        quantisation.inter[i] = static_cast<float>(matrices.non_intra[i]);
    }
    return quantisation;
}

}  // namespace

Coupling::Coupling(const perceptual::Display& display, const CouplingSettings& settings, encoder::Tune tune)
    : model_(display, settings.visibility), settings_(settings), matrices_(matrices_for(tune)) {}

perceptual::CodingPlan Coupling::eye_plan(encoder::PictureType type, int quantiser) const {
    perceptual::CodingPlan eye;
    eye.intra = type == encoder::PictureType::intra || settings_.always_intra;
    eye.scale = scale_of(quantiser);
    eye.quantisation = matrices_;
    // 8, 4 or 2 for 8, 9 or 10 bits. [H262, 7.4.1]
    eye.quantisation.dc_step = static_cast<float>(8 >> (encoder::mpeg2::dc_bits_for(quantiser) - 8));
    return eye;
}

perceptual::CodedFacts Coupling::facts_of(const encoder::CodedPicture& coded) const {
    perceptual::CodedFacts facts;
    facts.number = coded.plan.number;
    facts.plan = eye_plan(coded.plan.type, coded.quantiser);
    facts.lit_for = eye_plan(coded.plan.type, coded.plan.quantiser);
    facts.intra = core::Plane<std::uint8_t>(coded.macroblocks.width(), coded.macroblocks.height());
    facts.scale = core::Plane<float>(coded.macroblocks.width(), coded.macroblocks.height());
    for (std::size_t i = 0; i < coded.macroblocks.size(); ++i) {
        const encoder::MacroblockRecord& record = coded.macroblocks.values()[i];
        facts.intra.values()[i] = record.intra || settings_.always_intra ? 1 : 0;
        facts.scale.values()[i] = scale_of(record.quantiser);
    }
    facts.reconstruction = coded.reconstruction.y;
    return facts;
}

bool Coupling::counts(encoder::PictureType type) const {
    return type == encoder::PictureType::intra ||
           (type == encoder::PictureType::predicted && settings_.maps == ErrorMaps::references);
}

void Coupling::forget() {
    state_.reset();
    requantised_.reset();
    warped_ = {};
    kept_.clear();
}

void Coupling::imagine(const core::Picture& picture, const core::Radiance& radiance, const core::Visible& visible,
                       const encoder::PicturePlan& plan) {
    state_ = model_.assume_coded(model_.observe(picture, radiance, std::make_shared<const core::Visible>(visible)),
                                 eye_plan(plan.type, plan.quantiser));
    requantised_.reset();
}

float Coupling::share_for(const encoder::PicturePlan& plan) const {
    const float share = settings_.share.value_or(perceptual::default_tolerance_fraction);
    if (settings_.alike) return share;
    return share * perceptual::propagation_factor(plan.type == encoder::PictureType::intra,
                                                  plan.horizon.value_or(plan.number) - plan.number);
}

core::ToleranceMap Coupling::tolerate(const core::Visible& visible, const encoder::PicturePlan& plan,
                                      const core::MotionField* motion) {
    EXPECTS(state_.has_value());
    const float share = share_for(plan);
    const perceptual::CodingPlan eye = eye_plan(plan.type, plan.quantiser);
    if (!requantised_ || !(requantised_->plan == eye)) requantised_ = model_.requantise(*state_, eye);
    perceptual::Tolerated tolerated = model_.tolerate(visible, *requantised_, *state_, motion, share);
    // What stands in for a picture before is no picture: there is nothing to blend with.
    warped_ = state_->number == plan.number ? perceptual::MaskedErrors() : std::move(tolerated.warped);
    return std::move(tolerated.map);
}

void Coupling::keep(const core::Picture& picture, const core::Radiance& radiance, const core::Visible& visible,
                    const encoder::PicturePlan& plan) {
    if (!counts(plan.type)) return;
    kept_.insert_or_assign(
        picture.number,
        model_.observe(picture, radiance, std::make_shared<const core::Visible>(visible), std::exchange(warped_, {})));
}

void Coupling::judge(const encoder::CodedPicture& coded) {
    if (coded.plan.type == encoder::PictureType::bidirectional) return;
    const core::Plane<std::uint8_t> reference = std::exchange(decoded_, coded.reconstruction.y);
    const auto kept = kept_.find(coded.plan.number);
    if (kept == kept_.end()) return;
    perceptual::CodedFacts facts = facts_of(coded);
    if (coded.plan.type == encoder::PictureType::predicted) facts.prediction = prediction_of(coded, reference);
    state_ = model_.judge(std::move(kept->second), facts);
    requantised_.reset();
    kept_.erase(kept);
}

}  // namespace render2mpeg::app
