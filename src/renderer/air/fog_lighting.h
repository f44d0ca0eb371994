#pragma once
// Finds the light within fog.
#include <cstdint>

#include "renderer/air/airlight.h"

namespace render2mpeg::renderer {

/// Lights the fog of the instant's scene: by lamps first, which gather rays see from then on, then by all that shining
/// surfaces and the sky send; and where the fog has bounced light, by what surfaces bounce and the fog scatters again
/// and again. Adds the rays to `rays`. The same for any number of threads.
void light_fog(const AirInstant& instant, PosedScene& posed_scene, std::uint64_t& rays);

}  // namespace render2mpeg::renderer
