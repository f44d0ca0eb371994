#pragma once
// Gather rays of new records, as many as their neighbours leave necessary.
#include "renderer/cache/frame_state.h"

namespace render2mpeg::renderer {

/// Rays that would meet a point's tolerance, by its share of its pixel alone: 64 of one that fills it.
double needs_by_share(const PointTolerance& tolerance);

/// Traces more rays for the frame's new records from the `first` on, in rounds, as far as the error of the regression
/// about each (local_regression.h) is worth them: adaptive sampling and reconstruction [Moon2014].
void refine_rays(FrameState& frame, std::size_t first);

/// Gives the points of all new records the light that the regression about them finds.
void reconstruct(FrameState& frame);

}  // namespace render2mpeg::renderer
