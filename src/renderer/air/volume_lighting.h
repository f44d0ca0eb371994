#pragma once
// Finds the light within volumes: of lamps, of all else, and what they scatter more than once.
#include <cstdint>
#include <vector>

#include "renderer/air/airlight.h"
#include "renderer/base/volume_light.h"

namespace render2mpeg::renderer {

/// Light within each volume of the instant's air. What they scatter and send lights all of them. Adds the shadow rays
/// to `rays`. The same for any number of threads.
std::vector<VolumeLight> light_within_volumes(const AirInstant& instant, std::uint64_t& rays);

}  // namespace render2mpeg::renderer
