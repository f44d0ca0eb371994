#pragma once
// Light that fog scatters towards the eye, for all pixels of a frame.
#include <cstdint>
#include <span>
#include <vector>

#include "core/tolerance_map.h"
#include "renderer/air/air_lamp.h"
#include "renderer/gather/final_gather.h"
#include "renderer/surface/frame.h"
#include "renderer/surface/posed_scene.h"
#include "renderer/surface/ungathered_light.h"

namespace render2mpeg::renderer {

/// An instant that air is lit at.
struct AirInstant {
    const PosedScene& posed_scene;  ///< it has air
    std::vector<LightPoint> points;
    const LightTrees& light_trees;
    FinalGather* gather = nullptr;  ///< sees bounced light and the sky; null: light trees hold them
    std::int64_t lit_frame = 0;     ///< stands for its light
    bool bounces = true;            ///< surfaces bounce light
};

/// Direct light points of the instant that gather rays do not see.
std::vector<LightPoint> points_beyond_rays(const AirInstant& instant);

/// Adds the light of the air that each pixel shows. It is found along a lattice of rays, finer where it changes, and
/// interpolated between them at each pixel's own distances. The air is lit. `tolerance`: the frame's; null: for a
/// rough look. Returns the shadow rays. The same for any number of threads.
std::uint64_t add_airlight(const AirInstant& instant, const core::ToleranceMap* tolerance, const Frame& seen,
                           UngatheredLight& light);

}  // namespace render2mpeg::renderer
