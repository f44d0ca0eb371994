#pragma once
// Lights the fibres that a frame shows.
#include "core/tolerance_map.h"
#include "renderer/base/plan.h"
#include "renderer/hair/hair_counts.h"
#include "renderer/surface/gather_point.h"
#include "renderer/surface/posed_scene.h"

namespace render2mpeg::renderer {

/// Adds the light of all fibres that were seen to `seen.emitted`, `hair` and `hair_of_exposed`, and forgets them. Every
/// sample of the eye sends a path (LightPaths) or more, until the standard error of its pixel is below its tolerance,
/// as far as the tile's pixels together tell it. `tolerance`: null for a rough look. A function of the posed instant
/// and of `seen`, for any number of threads.
void add_hair_light(const PosedScene& posed_scene, const Plan& plan, const core::ToleranceMap* tolerance, Seen& seen,
                    HairCounts& counts);

}  // namespace render2mpeg::renderer
