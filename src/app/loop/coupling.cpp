#include "app/loop/coupling.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "core/error.h"
#include "perceptual/tolerance_fraction.h"

namespace render2mpeg::app {

perceptual::CodingPlan Coupling::seen_as(perceptual::CodingPlan steps) const {
    steps.intra = steps.intra || settings_.always_intra;
    return steps;
}

bool Coupling::counts(PictureRole role) const {
    return role == PictureRole::intra || (role == PictureRole::predicted && settings_.maps == ErrorMaps::references);
}

void Coupling::forget() {
    state_.reset();
    requantised_.reset();
    warped_ = {};
    kept_.clear();
}

void Coupling::imagine(const core::Picture& picture, const core::Radiance& radiance, const core::Visible& visible,
                       const PlannedPicture& plan) {
    state_ = model_.assume_coded(model_.observe(picture, radiance, std::make_shared<const core::Visible>(visible)),
                                 seen_as(plan.steps));
    requantised_.reset();
}

float Coupling::fraction_for(const PlannedPicture& plan) const {
    const float fraction = settings_.fraction.value_or(perceptual::default_tolerance_fraction);
    if (settings_.alike) return fraction;
    return fraction * perceptual::propagation_factor(plan.role == PictureRole::intra, plan.followers);
}

core::ToleranceMap Coupling::tolerate(const core::Visible& visible, const PlannedPicture& plan,
                                      const core::MotionField* motion) {
    EXPECTS(state_.has_value());
    const perceptual::CodingPlan steps = seen_as(plan.steps);
    if (!requantised_ || !(requantised_->plan == steps)) requantised_ = model_.requantise(*state_, steps);
    perceptual::Tolerated tolerated = model_.tolerate(visible, *requantised_, *state_, motion, fraction_for(plan));
    // What stands in for a picture before is no picture: there is nothing to blend with.
    warped_ = state_->number == plan.number ? perceptual::MaskedErrors() : std::move(tolerated.warped);
    return std::move(tolerated.map);
}

void Coupling::keep(const core::Picture& picture, const core::Radiance& radiance, const core::Visible& visible,
                    const PlannedPicture& plan) {
    if (!counts(plan.role)) return;
    kept_.insert_or_assign(
        picture.number,
        model_.observe(picture, radiance, std::make_shared<const core::Visible>(visible), std::exchange(warped_, {})));
}

void Coupling::judge(JudgedPicture picture) {
    const auto kept = kept_.find(picture.facts.number);
    if (kept == kept_.end()) return;
    perceptual::CodedFacts& facts = picture.facts;
    facts.plan = seen_as(facts.plan);
    if (facts.lit_for) facts.lit_for = seen_as(*facts.lit_for);
    if (settings_.always_intra) std::fill(facts.intra.values().begin(), facts.intra.values().end(), std::uint8_t{1});
    state_ = model_.judge(std::move(kept->second), facts);
    requantised_.reset();
    kept_.erase(kept);
}

}  // namespace render2mpeg::app
