#pragma once
// Estimates the true radiance of a whole frame.
#include <cstdint>

#include "core/radiance.h"
#include "renderer/truth/pixel_truth.h"

namespace render2mpeg::renderer {

/// A frame by paths alone. Of its radiance `combined`, `half`, `error` (the standard error of luminance) and `capped`
/// (1: its paths came to TruthSettings::most_paths) are filled.
struct TrueFrame {
    core::Radiance radiance;
    std::uint64_t paths = 0;   ///< those of pilots included
    std::uint64_t capped = 0;  ///< pixels
};

/// The truth of all pixels of the posed instant, plus what is `known` of light that paths do not
/// find (docs/model/truth.md).
/// Unbiased, a function of the arguments, for any number of threads; finite.
TrueFrame true_frame(const PosedScene& posed_scene, const SeeSettings& see, const Plan& plan,
                     const core::Plane<glm::vec3>& known, const TruthSettings& settings);

}  // namespace render2mpeg::renderer
