#pragma once
// Inputs of gathering a frame.
#include <glm/glm.hpp>

#include "core/tolerance_map.h"
#include "renderer/geometry/ray_tracer.h"
#include "renderer/surface/frame.h"
#include "renderer/surface/ungathered_light.h"
#include "renderer/tree/light_trees.h"

namespace render2mpeg::renderer {

/// A frame to be lit: its lights, what hides them, what is seen, and how well it must be lit.
struct LightingContext {
    const LightTrees& light_trees;
    const RayTracer& tracer;
    const Frame& seen;
    const UngatheredLight& ungathered;  ///< of `seen`
    glm::vec3 eye{0};                   ///< world: where groups of points are judged from
    const core::ToleranceMap& tolerance;
};

}  // namespace render2mpeg::renderer
