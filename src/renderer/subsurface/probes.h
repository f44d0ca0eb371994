#pragma once
// Where light enters that leaves at a point.
#include <cstdint>
#include <vector>

#include "renderer/surface/posed_scene.h"

namespace render2mpeg::renderer {

/// Probes of one sample of the eye. chosen: 4, with 4 to 16 samples 16 to 64 of a pixel; not tuned.
inline constexpr int probes_of_sample = 4;

/// Places of the same object whose light leaves at `point` [King2013]: along rays through a disc across the normal or a
/// tangent, as far as the material's light reaches, all that they meet. Each is a point of its own whose diffuse
/// reflectance has its share of what leaves; in the mean over `number` they are all of it. `number`: other from sample
/// to sample. Appends to `places`.
void probe(const PosedScene& posed_scene, const SurfacePoint& point, std::uint64_t number, float time,
           std::vector<SurfacePoint>& places);

}  // namespace render2mpeg::renderer
