#pragma once
// Finer eye samples where an edge would show.
#include "core/tolerance_map.h"
#include "renderer/view/see.h"

namespace render2mpeg::renderer {

/// Root mean square error of the share of a pixel that lies on one side of a straight edge, by `samples` of
/// `sample_pattern` (test).
float edge_error(int samples);

/// The frame, looked at again through pixels about which what is expected to be seen (Tolerance::background) differs so
/// much that the place of an edge among their samples could show by more than their tolerance: with 64 samples, or 256
/// where 64 would not be enough, but `most_samples` at most. Nothing is known of edges in pixels without a background.
/// Pixels of strands get those of these counts that they are worth. Gather points keep all their places
/// (GatherPoint::more_places). Adds to `counts`; does not depend on the number of threads.
Frame refine_edges(const PosedScene& posed_scene, const SeeSettings& settings, const Plan& plan,
                   const core::ToleranceMap& tolerance, const Strands& strands, int most_samples, Frame seen,
                   SeeCounts& counts);

}  // namespace render2mpeg::renderer
