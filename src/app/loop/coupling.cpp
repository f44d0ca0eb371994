#include "app/loop/coupling.h"

#include <memory>
#include <utility>

#include "core/error.h"
#include "perceptual/tolerance.h"

namespace render2mpeg::app {

void Coupling::forget() {
    state_.reset();
    requantised_.reset();
    warped_ = {};
    kept_.clear();
}

void Coupling::take_rough_look(const core::Picture& picture, const core::Radiance& radiance,
                               const core::Visible& visible, const PlannedPicture& plan) {
    state_ = model_.assume_coded(model_.observe(picture, radiance, std::make_shared<const core::Visible>(visible)),
                                 plan.steps);
    requantised_.reset();
}

float Coupling::fraction_for(const PlannedPicture& plan) const {
    return settings_.fraction.value_or(perceptual::default_tolerance_fraction * plan.hidden) *
           perceptual::propagation_factor(plan.role == PictureRole::intra, plan.followers);
}

core::ToleranceMap Coupling::tolerate(const core::Visible& visible, const PlannedPicture& plan,
                                      const core::MotionField* motion) {
    EXPECTS(state_.has_value());
    if (!requantised_ || !(requantised_->plan == plan.steps)) requantised_ = model_.requantise(*state_, plan.steps);
    perceptual::Tolerated tolerated = model_.tolerate(visible, *requantised_, *state_, motion, fraction_for(plan));
    // A rough look has nothing to blend with.
    warped_ = state_->number == plan.number ? perceptual::MaskedErrors() : std::move(tolerated.warped);
    return std::move(tolerated.map);
}

void Coupling::keep(const core::Picture& picture, const core::Radiance& radiance, const core::Visible& visible,
                    const PlannedPicture& plan) {
    if (plan.role == PictureRole::disposable) return;
    kept_.insert_or_assign(
        picture.number,
        model_.observe(picture, radiance, std::make_shared<const core::Visible>(visible), std::exchange(warped_, {})));
}

void Coupling::judge(const JudgedPicture& picture) {
    const auto kept = kept_.find(picture.facts.number);
    if (kept == kept_.end()) return;
    state_ = model_.judge(std::move(kept->second), picture.facts);
    requantised_.reset();
    kept_.erase(kept);
}

}  // namespace render2mpeg::app
