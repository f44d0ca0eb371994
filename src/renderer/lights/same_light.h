#pragma once
// Whether light is the same at two instants, and seen from the same place.
#include <cstdint>
#include <glm/glm.hpp>

#include "core/plane.h"
#include "core/tolerance_map.h"
#include "scene/pose/snapshot.h"

namespace render2mpeg::renderer {

/// All that decides which pixels a frame shows, how they are lit and how well. `lit_frame` stands for its light.
struct Sight {
    glm::mat4 camera;
    float fov, magnification;
    std::int64_t lit_frame;
    core::Plane<core::Tolerance> tolerance;

    bool operator==(const Sight&) const = default;
};

Sight sight_of(const scene::Snapshot& snapshot, std::int64_t lit_frame, const core::ToleranceMap& tolerance);

/// Whether two instants have the same light: everything but the camera.
bool same_light(const scene::Snapshot& a, const scene::Snapshot& b);

}  // namespace render2mpeg::renderer
