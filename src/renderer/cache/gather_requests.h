#pragma once
// Gathers points that the cache cannot serve, and keeps what was found as records.
#include <cstdint>
#include <span>
#include <vector>

#include "renderer/cache/frame_state.h"

namespace render2mpeg::renderer {

/// Results of some requests, in the order of gathering.
struct GatheredRequests {
    std::vector<PointRef> points;
    std::vector<PointLight> light;  ///< of light trees
    std::vector<GlossyRecord> lobes;
    std::vector<std::uint8_t> sets;    ///< of representatives
    std::vector<std::uint32_t> pools;  ///< GatherRequest::pool, within the area
    std::vector<RayLight> rays;        ///< of records the first; of other points all
};

/// Requests by area, so that those of neighbouring tiles share cuts.
std::vector<std::vector<PointRef>> by_area(const FrameState& frame, const std::vector<std::vector<PointRef>>& of_tile);

/// Gathers requests, given by tile, in the areas that have at least so many; returns one entry for each area. Points
/// that use the cache are gathered as receivers of their records.
std::vector<GatheredRequests> gather(FrameState& frame, const std::vector<std::vector<PointRef>>& of_tile,
                                     std::size_t least);

/// Gathers light of trees again for all records, by their plain receivers; they lie on the frame's grid.
void gather_trees_again(FrameState& frame, std::span<const GatherPoint> receivers);

/// Takes what was found of them as their points' light, and as records of those points that use the cache.
void keep(FrameState& frame, const std::vector<GatheredRequests>& found);

}  // namespace render2mpeg::renderer
