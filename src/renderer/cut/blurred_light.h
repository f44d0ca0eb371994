#pragma once
// Light of points in the pixels that the shutter or the lens spreads it over.
#include "core/radiance.h"
#include "core/tolerance_map.h"
#include "renderer/cut/shade.h"

namespace render2mpeg::renderer {

/// Tolerances of the pixels of a frame's sharp middle: the least of all pixels that get light of their points, which
/// keeps each of these within `tolerance`. Errors add up at worst: a pixel's contributions have weights that sum up to
/// 1 at most.
core::ToleranceMap tolerance_of_points(const Frame& seen, const core::ToleranceMap& tolerance);

/// Replaces the pixels that are exposed (Frame::exposure) in a frame whose points have this light. `layers`: all planes
/// of Radiance. Counts what is not finite.
void spread_light(const Frame& seen, const UngatheredLight& ungathered, const FrameLight& light, bool layers,
                  core::Radiance& radiance, ShadeCounts& counts);

}  // namespace render2mpeg::renderer
