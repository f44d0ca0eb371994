#pragma once

#include "renderer/gather_lanes.h"
#include "renderer/light_tree.h"

/// One light or one node against sixteen points at once: the renderer's innermost loops.
namespace render2mpeg::renderer {

/// The clamp of near light points (docs/model.md, "Clamping"): one counts as a disc of squared radius disc2 / `scale`.
/// G is at most 1 over that, and GGX lobes are widened by what the disc spans, so that sharp ones do not show single
/// points.
struct GeometryClamp {
    float scale = 0.02f;
    /// No clamp at all: beyond any G that occurs, yet finite, so that 0 times it is 0.
    static GeometryClamp none() { return {1e30f}; }
};

/// What unit intensity of `light` sends to the lanes, without visibility.
void evaluate_light(const GatherLanes& lanes, LightFamily family, const TreeLight& light, GeometryClamp clamp,
                    LightLanes& out);

/// An upper bound, for each lane, of the luminance that the lights below `node` can add to its pixel, all of them
/// visible.
void bound_node(const GatherLanes& lanes, LightFamily family, const LightNode& node, GeometryClamp clamp, Lanes& out);

/// Luminance that a light or cluster of this intensity adds to each lane's pixel, given what unit intensity sends.
void add_luminance(const GatherLanes& lanes, const LightLanes& unit, glm::vec3 intensity, Lanes& luminance);

}  // namespace render2mpeg::renderer
