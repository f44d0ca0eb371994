#pragma once
// Quantiser factors and forced modes that a caller asks of single macroblocks.
#include "core/plane.h"
#include "encoder/types.h"

/// Requests of callers and of the macroblock tree for single macroblocks.
namespace render2mpeg::encoder::mpeg2 {

/// Overrides by macroblock, `columns` x `rows`; planes are empty where nothing is requested.
struct MacroblockOverrides {
    core::Plane<float> quantiser_factors;
    core::Plane<Force> forced;
};

/// Combines the overrides from onward motion (macroblock_tree.h) and hidden errors with the caller's. Rows and columns
/// that only pad the picture are treated like the last one. `quantiser`: MPEG-2's, of the picture.
MacroblockOverrides overrides_from(const Hints& hints, int columns, int rows, double quantiser);

}  // namespace render2mpeg::encoder::mpeg2
