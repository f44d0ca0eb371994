#include "app/coupling/coupling.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "app/coupling/light_price.h"
#include "core/error.h"
#include "encoder/latitude.h"
#include "encoder/prediction.h"
#include "encoder/step_sizes.h"
#include "perceptual/warp.h"

namespace render2mpeg::app {
void Coupling::forget() {
    state_.reset();
    requantised_.reset();
    warped_ = {};
    kept_.clear();
}

perceptual::CodingPlan Coupling::steps_of(const encoder::PicturePlan& plan, int quantiser) const {
    const encoder::StepSizes steps = encoder::step_sizes(coding_, quantiser, plan.step_ratio);
    return {plan.type == encoder::PictureType::intra,
            steps.scale,
            {steps.intra, steps.inter, steps.intra_dc, steps.intra_dead_zone, steps.inter_dead_zone}};
}

void Coupling::take_rough_look(const core::Picture& picture, const core::Radiance& light, const core::Radiance& shown,
                               const core::Visible& visible, const encoder::PicturePlan& plan) {
    state_ = model_.assume_coded(model_.observe(picture, shown, std::make_shared<const core::Visible>(visible)),
                                 steps_of(plan, plan.quantiser));
    is_judged_ = false;
    if (!settings_.fraction) {
        share_ = expected_share(model_, *state_, light, settings_.loss);
        share_of_predicted_ = 0;
    }
    requantised_.reset();
}

float Coupling::share_of(const encoder::PicturePlan& plan) const {
    return plan.type != encoder::PictureType::intra && share_of_predicted_ > 0 ? share_of_predicted_ : share_;
}

core::ToleranceMap Coupling::tolerate(const core::Visible& visible, const encoder::PicturePlan& plan,
                                      const core::MotionField* motion) {
    EXPECTS(state_.has_value());
    const perceptual::CodingPlan steps = steps_of(plan, plan.quantiser);
    if (!requantised_ || !(requantised_->plan == steps)) requantised_ = model_.requantise(*state_, steps);
    perceptual::Tolerated tolerated = model_.tolerate(visible, *requantised_, *state_, motion, share_of(plan));
    // A rough look has nothing to blend with, nor is anything predicted from it.
    const bool is_rough = state_->number == plan.number;
    warped_ = is_rough ? perceptual::MaskedErrors() : std::move(tolerated.warped);
    prediction_ = {};
    if (plan.type == encoder::PictureType::predicted && !is_rough && reference_number_ == state_->number &&
        !reference_.empty()) {
        core::Plane<float> luma(reference_.width(), reference_.height());
        std::copy(reference_.values().begin(), reference_.values().end(), luma.values().begin());
        prediction_ = perceptual::warp(luma, *state_->visible, visible, motion);
    }
    return std::move(tolerated.map);
}

std::optional<double> Coupling::keep(const core::Picture& picture, const core::Radiance& light,
                                     const core::Radiance& shown, const core::Visible& visible,
                                     const encoder::PicturePlan& plan) {
    if (plan.type == encoder::PictureType::bidirectional) return {};
    Kept& kept = kept_[picture.number];
    kept = {model_.observe(picture, shown, std::make_shared<const core::Visible>(visible), std::exchange(warped_, {})),
            std::exchange(prediction_, {}), steps_of(plan, plan.quantiser)};
    const auto& [seen, prediction, steps] = kept;
    const bool is_intra = plan.type == encoder::PictureType::intra;
    if (!is_intra && prediction.empty()) return {};
    const auto measured = [&, &observed = seen, &coding = steps](perceptual::CodedBlocks blocks) {
        return measure_loss(std::move(blocks), observed.light, light, model_.light(), coding, settings_.loss,
                            share_of(plan));
    };
    const LightLoss found = measured({seen.coefficients, seen.light.luma, prediction});
    if (settings_.fraction) return found.of_picture;
    if (is_intra && share_of_predicted_ == 0)
        share_of_predicted_ =
            measured(perceptual::left_by_intra(seen.coefficients, steps.quantisation, steps.scale)).share;
    (is_intra ? share_ : share_of_predicted_) = found.share;
    return found.of_picture;
}

perceptual::CodedFacts Coupling::facts_of(const encoder::CodedPicture& coded) const {
    perceptual::CodedFacts facts;
    facts.number = coded.plan.number;
    facts.plan = steps_of(coded.plan, coded.quantiser);
    facts.lit_for = steps_of(coded.plan, coded.plan.quantiser);
    facts.intra = core::Plane<std::uint8_t>(coded.macroblocks.width(), coded.macroblocks.height());
    facts.scale = core::Plane<float>(coded.macroblocks.width(), coded.macroblocks.height());
    for (std::size_t i = 0; i < coded.macroblocks.size(); ++i) {
        const encoder::MacroblockRecord& record = coded.macroblocks.values()[i];
        facts.intra.values()[i] = record.intra ? 1 : 0;
        facts.scale.values()[i] = coded.plan.step_ratio * encoder::step_scale(coding_.codec, record.quantiser);
    }
    facts.reconstruction = coded.reconstruction.y;
    if (coded.plan.type == encoder::PictureType::predicted && coded.tells_vectors)
        facts.prediction = encoder::prediction_of(coded, reference_);
    return facts;
}

void Coupling::judge(const encoder::CodedPicture& coded) {
    if (coded.plan.type == encoder::PictureType::bidirectional) return;
    if (const auto kept = kept_.extract(coded.plan.number)) {
        state_ = model_.judge(std::move(kept.mapped().seen), facts_of(coded));
        is_judged_ = true;
        requantised_.reset();
    }
    // A newer one that was taken for coded stays.
    if (coded.plan.number < reference_number_) return;
    reference_ = coded.reconstruction.y;
    reference_number_ = coded.plan.number;
}

void Coupling::assume_coded() {
    if (kept_.empty() || kept_.rbegin()->first < state_->number) return;
    auto& [number, kept] = *kept_.rbegin();
    auto& [seen, prediction, steps] = kept;
    const perceptual::CodedBlocks blocks(seen.coefficients, seen.light.luma, prediction);
    perceptual::CodedFacts facts;
    facts.number = number;
    facts.plan = steps;
    facts.reconstruction = perceptual::decode(blocks, seen.light.luma, prediction, steps.quantisation, steps.scale);
    facts.intra =
        core::Plane<std::uint8_t>((seen.light.width() + 15) / 16, (seen.light.height() + 15) / 16, steps.intra ? 1 : 0);
    facts.scale = core::Plane<float>(facts.intra.width(), facts.intra.height(), steps.scale);
    if (!prediction.empty()) {
        facts.prediction = core::Plane<std::uint8_t>(prediction.width(), prediction.height());
        for (std::size_t i = 0; i < prediction.size(); ++i)
            facts.prediction.values()[i] =
                static_cast<std::uint8_t>(std::lround(std::clamp(prediction.values()[i], 0.0f, 255.0f)));
        for (int y = 0; y < blocks.predicted.height(); ++y)
            for (int x = 0; x < blocks.predicted.width(); ++x)
                if (blocks.predicted.at(x, y) == 0) facts.intra.at(x / 2, y / 2) = 1;
    }
    reference_ = facts.reconstruction;
    reference_number_ = number;
    state_ = model_.judge(std::move(seen), facts);
    is_judged_ = false;
    requantised_.reset();
    kept_.clear();
}

void widen_poles(const scene::Camera& camera, core::ToleranceMap& tolerance) {
    if (camera.is_flat() || tolerance.is_reference()) return;
    for (int y = 0; y < tolerance.pixels.height(); ++y) {
        const float wider = encoder::latitude_factor(camera.weight_of_row(y));
        core::Tolerance* row = tolerance.pixels.row(y);
        for (int x = 0; x < tolerance.pixels.width(); ++x) {
            row[x].absolute *= wider;
            row[x].relative *= wider;
        }
    }
}

}  // namespace render2mpeg::app
