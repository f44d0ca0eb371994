#pragma once
// What a coded picture was predicted by.
#include <cstdint>

#include "core/plane.h"
#include "encoder/types.h"

namespace render2mpeg::encoder {

/// Prediction of a P picture's macroblocks: luma of its decoded `reference` displaced by their vectors [H262, 7.6.4],
/// edges repeated. Intra macroblocks are 0.
core::Plane<std::uint8_t> prediction_of(const CodedPicture& coded, const core::Plane<std::uint8_t>& reference);

}  // namespace render2mpeg::encoder
