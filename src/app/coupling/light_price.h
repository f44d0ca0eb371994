#pragma once
// The price of light: the share of what coding hides that light may err by, so that a film loses as much as is asked.
#include "core/radiance.h"
#include "perceptual/light_loss.h"
#include "perceptual/visibility_model.h"

namespace render2mpeg::app {

/// Share for a chunk's first picture, before it is lit: from a rough look at it, and the noise of the light
/// by which it was seen, which the first rays of points found. `loss`: dB > 0.
float expected_share(const perceptual::VisibilityModel& model, const perceptual::TemporalState& rough,
                     const core::Radiance& light, double loss);

/// What a picture loses by the noise of its light, and the share by which the next of its kind lose what is asked.
struct LightLoss {
    double of_picture = 0;  ///< dB
    float share = 0;
};

/// `blocks`: as the picture is coded; `share`: that it was lit by.
LightLoss measure_loss(perceptual::CodedBlocks blocks, const perceptual::PixelLight& seen, const core::Radiance& light,
                       const perceptual::InverseLuma& display, const perceptual::CodingPlan& coding, double loss,
                       float share);

}  // namespace render2mpeg::app
