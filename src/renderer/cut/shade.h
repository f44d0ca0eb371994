#pragma once
// Gathers light for all points of a frame, tile by tile.
#include <cstdint>
#include <string>

#include "core/radiance.h"
#include "core/tolerance_map.h"
#include "renderer/base/tolerance_bands.h"
#include "renderer/cut/gatherer.h"
#include "renderer/cut/point_light.h"
#include "renderer/geometry/ray_tracer.h"
#include "renderer/surface/frame.h"
#include "renderer/tree/light_trees.h"

namespace render2mpeg::renderer {

/// Counts of one frame's gathering.
struct ShadeCounts {
    std::uint64_t gather_points = 0, capped_points = 0, groups = 0;
    std::uint64_t direct_clusters = 0, indirect_clusters = 0;  ///< summed over gather points
    std::uint64_t shadow_rays = 0;
    std::uint64_t non_finite = 0;
    std::int64_t first_non_finite = -1;  ///< y * width + x of the first in raster order of tiles; -1: none
    double gathered = 0, clamped = 0;    ///< luminance summed over pixels: what arrived, what the clamp took
    ToleranceBands bands;

    /// Adds the costs of gathering a group of so many points; its findings count where they are added to pixels.
    void add(const GatheredLight& gathered, std::size_t points);
    void add(const ShadeCounts& more);
};

/// Light that light trees send to every gather point of a frame (docs/model/lightcut.md). The same bytes for any number
/// of threads.
FrameLight gather_light(const LightingContext& context, const CutLimits& limits, ShadeCounts& counts);

/// Multiplies the light of all points by their textures and adds it up in pixels. `layers`: fills all planes of
/// Radiance, not only `combined`. The same bytes for any number of threads.
core::Radiance shade(const LightingContext& context, const FrameLight& light, bool layers, ShadeCounts& counts);

}  // namespace render2mpeg::renderer
