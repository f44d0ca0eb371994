#pragma once
// Finds a frame's interpolation cells.
#include "renderer/cache/frame_state.h"

namespace render2mpeg::renderer {

/// Finds the interpolation cells of this side whose corners records serve, where no larger one is known.
void find_cells(FrameState& frame, int side);

}  // namespace render2mpeg::renderer
