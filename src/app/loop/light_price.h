#pragma once
// The price of light: the share of what coding hides that light may err by, so that a film loses as much as is asked.
#include "core/radiance.h"
#include "perceptual/visibility_model.h"

namespace render2mpeg::app {

/// Share for a picture that nothing depends on, before it is lit: from a rough look at it, and the noise of the light
/// by which it was seen, whose price was `tolerance` of its luminance. `loss`: dB > 0.
float expected_share(const perceptual::VisibilityModel& model, const perceptual::TemporalState& rough,
                     const core::Radiance& light, float tolerance, double loss);

/// What an intra picture loses by the noise of its light, and the share by which the next ones lose what is asked.
struct LightLoss {
    double of_picture = 0;  ///< dB
    float share = 0;
};

/// `share`: that `picture` was lit by, and `of_it`: the part of it that was left to this picture, in (0, 1].
LightLoss measure_loss(const perceptual::Observation& picture, const core::Radiance& light,
                       const perceptual::InverseLuma& display, const perceptual::CodingPlan& coding, double loss,
                       float share, float of_it);

}  // namespace render2mpeg::app
