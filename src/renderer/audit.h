#pragma once

#include <vector>

#include "core/radiance.h"
#include "core/tolerance_map.h"
#include "renderer/audited_pixel.h"
#include "renderer/gather_point.h"
#include "renderer/light_forest.h"
#include "renderer/ray_tracer.h"

namespace render2mpeg::renderer {

/// Audits `count` pixels of a frame (all, where it has fewer) that have anything to gather, chosen by dice that only
/// the frame's number and what it shows decide. `radiance` was lit by `tolerance`. The same for any number of threads.
std::vector<AuditedPixel> audit(const LightForest& forest, const RayTracer& tracer, const Seen& seen,
                                const core::ToleranceMap& tolerance, const core::Radiance& radiance, int count);

}  // namespace render2mpeg::renderer
