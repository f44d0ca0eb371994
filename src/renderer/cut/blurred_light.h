#pragma once
// Light of points in the pixels that the shutter or the lens spreads it over.
#include "core/radiance.h"
#include "core/tolerance_map.h"
#include "renderer/cut/shade.h"

namespace render2mpeg::renderer {

/// What the pixels of a frame's sharp middle may be off by, so that no pixel that gets light of their points is off by
/// more than `tolerance` allows it: the least of theirs. Errors add up at worst: a pixel's contributions have weights
/// that sum up to 1 at most.
core::ToleranceMap tolerance_of_points(const Frame& seen, const core::ToleranceMap& tolerance);

/// Replaces the pixels that are exposed (Frame::exposure) in a frame whose points have this light. `layers`: all planes
/// of Radiance. Counts what is not finite.
void spread_light(const Frame& seen, const UngatheredLight& ungathered, const FrameLight& light, bool layers,
                  core::Radiance& radiance, ShadeCounts& counts);

}  // namespace render2mpeg::renderer
