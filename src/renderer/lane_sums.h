#pragma once

#include "renderer/gather_lanes.h"
#include "renderer/isa_clones.h"

/// What sixteen lanes come to, in an order of halves, so that wide registers keep it as it is.
namespace render2mpeg::renderer {

RENDER2MPEG_ALWAYS_INLINED float sum_of(Lanes& values) {
    for (int i = 0; i < 8; ++i) values[i] += values[i + 8];
    for (int i = 0; i < 4; ++i) values[i] += values[i + 4];
    return (values[0] + values[2]) + (values[1] + values[3]);
}

/// None of them NaN.
RENDER2MPEG_ALWAYS_INLINED float largest_of(Lanes& values) {
    for (int i = 0; i < 8; ++i) values[i] = values[i] < values[i + 8] ? values[i + 8] : values[i];
    for (int i = 0; i < 4; ++i) values[i] = values[i] < values[i + 4] ? values[i + 4] : values[i];
    const float even = values[0] < values[2] ? values[2] : values[0];
    const float odd = values[1] < values[3] ? values[3] : values[1];
    return even < odd ? odd : even;
}

}  // namespace render2mpeg::renderer
