#pragma once
// Records follow light that changes (docs/model/irradiance-cache.md).
#include "renderer/cache/frame_state.h"

namespace render2mpeg::renderer {

/// Takes records over to an instant whose light is another, or whose things lie elsewhere, before its frame is lit:
/// the first rays of records are traced again, as control variates of their light [Rousselle2016]. A record's light
/// becomes that of before, times a factor, plus the local regression of the neighbours' light beyond that; its
/// `ray_count` becomes that of independent rays that would err as much. Records of surfaces that are gone, and those
/// beyond the picture, are dropped.
void follow_light(FrameState& frame);

}  // namespace render2mpeg::renderer
