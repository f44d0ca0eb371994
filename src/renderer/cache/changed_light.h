#pragma once
// Records follow light that changes (docs/model/irradiance-cache.md).
#include <cstdint>
#include <span>

#include "renderer/cache/frame_state.h"

namespace render2mpeg::renderer {

/// Takes records over to an instant whose light is another, or whose things lie elsewhere, before its frame is lit:
/// the first rays of records are traced again, as control variates of their light [Rousselle2016]. A record's light
/// becomes that of before, times a factor, plus the local regression of the neighbours' light beyond that; its
/// `ray_count` becomes that of independent rays that would err as much. Records of surfaces that are gone, and those
/// beyond the picture, are dropped.
void update_by_control_variates(FrameState& frame);

/// Traces the pilots of these records at the posed instant, by their receivers.
void retrace_pilots(FrameState& frame, std::span<const std::uint32_t> which,
                    std::span<const GatherPoint* const> receivers);

}  // namespace render2mpeg::renderer
