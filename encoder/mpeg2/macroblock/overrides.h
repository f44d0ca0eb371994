#pragma once
// Quantiser factors and forced modes that a caller asks of single macroblocks.
#include "core/plane.h"
#include "encoder/types.h"

/// What callers and the macroblock tree ask of single macroblocks.
namespace render2mpeg::encoder::mpeg2 {

/// What is asked of single macroblocks, `columns` x `rows`; planes are empty where nothing is.
struct MacroblockOverrides {
    core::Plane<float> quantiser_factors;
    core::Plane<Force> forced;
};

/// Takes what follows from onward motion (macroblock_tree.h) together with what the caller wants. Rows and columns that
/// only pad the picture are treated like the last one. `quantiser`: MPEG-2's, of the picture.
MacroblockOverrides overrides_from(const Hints& hints, int columns, int rows, double quantiser);

}  // namespace render2mpeg::encoder::mpeg2
