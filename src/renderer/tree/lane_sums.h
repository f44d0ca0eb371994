#pragma once
// Sums over sixteen lanes, in a fixed order.
#include <cstdint>
#include <cstring>

#include "renderer/base/isa_clones.h"
#include "renderer/tree/gather_lanes.h"

/// Reductions over sixteen lanes, in an order of halves that wide registers keep as it is.
namespace render2mpeg::renderer {

RENDER2MPEG_ALWAYS_INLINED float sum_of(Lanes& values) {
    for (int i = 0; i < 8; ++i) values[i] += values[i + 8];
    for (int i = 0; i < 4; ++i) values[i] += values[i + 4];
    return (values[0] + values[2]) + (values[1] + values[3]);
}

/// Whether any of them is not 0.
RENDER2MPEG_ALWAYS_INLINED bool any_of(const std::uint32_t (&flags)[lane_count]) {
    std::uint64_t pairs[lane_count / 2];
    static_assert(sizeof(pairs) == sizeof(flags));
    std::memcpy(pairs, flags, sizeof(pairs));
    return ((pairs[0] | pairs[1] | pairs[2] | pairs[3]) | (pairs[4] | pairs[5] | pairs[6] | pairs[7])) != 0;
}

}  // namespace render2mpeg::renderer
