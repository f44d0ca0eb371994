#pragma once
// Chooses light points on emissive surfaces.
#include <cstdint>
#include <vector>

#include "renderer/lights/light_points.h"

namespace render2mpeg::renderer {

/// Chooses about `count` places on the emissive surfaces of the posed instant, in proportion to power (area x mean
/// luminance, texture included), stratified along the surfaces; at least one for every object that emits at all. `seed`
/// shifts the strata.
std::vector<EmitterPoint> place_emitters(const PosedScene& posed_scene, const scene::Snapshot& snapshot, int count,
                                         std::uint64_t seed);

}  // namespace render2mpeg::renderer
