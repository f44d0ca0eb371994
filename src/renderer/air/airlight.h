#pragma once
// Light that fog scatters towards the eye, for all pixels of a frame.
#include <cstdint>
#include <span>
#include <vector>

#include "core/tolerance_map.h"
#include "renderer/air/air_lamp.h"
#include "renderer/air/ambient_air.h"
#include "renderer/surface/gather_point.h"
#include "renderer/surface/posed_scene.h"

namespace render2mpeg::renderer {

/// An instant that air is lit at.
struct AirInstant {
    const PosedScene& posed_scene;  ///< it has air
    const std::vector<LightPoint>& points;
    const LightTrees& light_trees;
    FinalGather* gather = nullptr;  ///< sees bounced light and the sky; null: light trees hold them
    std::int64_t lit_frame = 0;     ///< stands for its light
};

/// Adds the light of the air that each pixel shows to what needs no gathering. It is found along a lattice of rays,
/// finer where it changes, and interpolated between them at each pixel's own distances. `ambient` learns. `tolerance`:
/// the frame's; null: for a rough look. Returns the shadow rays. The same for any number of threads.
std::uint64_t add_airlight(const AirInstant& instant, AmbientAir& ambient, const core::ToleranceMap* tolerance,
                           Seen& seen);

/// What of a pixel's `emitted` it was; 0 without air.
inline glm::vec3 airlight_at(const Seen& seen, glm::ivec2 pixel) {
    return seen.airlight.empty() ? glm::vec3(0) : seen.airlight.at(pixel.x, pixel.y);
}

}  // namespace render2mpeg::renderer
