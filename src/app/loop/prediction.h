#pragma once
// The prediction of a picture's macroblocks, as the visibility model needs it.
#include <cstdint>

#include "core/plane.h"
#include "encoder/types.h"

namespace render2mpeg::app {

/// What the macroblocks of a P picture were predicted from: luma of `reference` (the decoded picture that it refers to)
/// displaced by their vectors [H262, 7.6.4]. Intra macroblocks are 0. Beyond the reference's sides its edges are
/// repeated.
core::Plane<std::uint8_t> prediction_of(const encoder::CodedPicture& coded, const core::Plane<std::uint8_t>& reference);

}  // namespace render2mpeg::app
