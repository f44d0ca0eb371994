#pragma once
// The light that a group of points receives.
#include <cstdint>

#include "renderer/tree/gather_lanes.h"

namespace render2mpeg::renderer {

/// Light that reaches each lane. The lobe's radiance is f0 x `f0` + `schlick`.
struct GatheredLight {
    RgbLanes direct;       ///< irradiance
    RgbLanes indirect;     ///< irradiance
    RgbLanes f0, schlick;  ///< of the GGX lobe, per unit of its two parts; unset where the group has none
    Lanes clamped;         ///< luminance that the clamp of near lights removed
    Lanes error;           ///< standard errors, luminance, as the stopping rule estimates; 0 without a cut
    int direct_clusters = 0, indirect_clusters = 0;
    std::uint32_t capped = 0;  ///< lanes whose tolerance was not reached within the largest cut
    std::uint64_t shadow_rays = 0;

    /// Sets what is counted, and `error`, to 0.
    void clear_counts();
};

}  // namespace render2mpeg::renderer
