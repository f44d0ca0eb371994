#pragma once

#include <glm/glm.hpp>

#include "core/tolerance_map.h"
#include "renderer/geometry/ray_tracer.h"
#include "renderer/surface/gather_point.h"
#include "renderer/tree/light_trees.h"

namespace render2mpeg::renderer {

/// What a frame is lit by: its light, what hides it, what is seen, and how well it must be lit.
struct LightingContext {
    const LightTrees& light_trees;
    const RayTracer& tracer;
    const Seen& seen;
    glm::vec3 eye{0};  ///< world: where groups of points are judged from
    const core::ToleranceMap& tolerance;
};

}  // namespace render2mpeg::renderer
