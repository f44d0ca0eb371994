#pragma once

#include <cstdint>

#include "core/motion_field.h"
#include "core/picture.h"

namespace render2mpeg::bench {

/// What exact motion makes needless, to be measured against: for each macroblock the whole-pixel vector, within `range`
/// pixels to each side of the left neighbour's, with the least sum of absolute differences of source luma and price of
/// the vector's length. `evaluations` grows by the 16x16 differences computed.
core::MotionField full_search(const core::Picture& picture, const core::Picture& reference, int quantiser, int range,
                              std::uint64_t& evaluations);

}  // namespace render2mpeg::bench
