#pragma once
// Hold-out validation of the cache within a frame.
#include "renderer/cache/cache_validation.h"
#include "renderer/cache/frame_state.h"

namespace render2mpeg::renderer {

enum class HoldOut { early, late };  ///< before a first frame's last lattice; after it

/// Hold-out validation: gathers some of the points that records serve, three times as finely, learns from what the
/// cache's answers were off by, and takes the error scale that this asks for.
void hold_out(FrameState& frame, CacheValidation& validation, HoldOut when);

/// Opens points that records served, in this frame or in the last, and would not serve with today's error scale.
void reopen_doubtful(FrameState& frame);

}  // namespace render2mpeg::renderer
