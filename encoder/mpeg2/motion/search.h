#pragma once

#include "encoder/mpeg2/bitstream/vector.h"
#include "encoder/mpeg2/kernels/frame.h"

/// What exact motion makes needless, to be measured against: a full search. Not part of the product: only
/// tests/bench/encoder_rd asks for it, and this header is not installed.
namespace render2mpeg::encoder::mpeg2 {

/// Given to an Encoder instead of nothing, it makes it search.
struct Search {
    int range = 0;  ///< whole pixels to each side of the best predictor; 0: none
};

/// The best of a search, by sum of absolute differences and the price of the distance from the centre.
struct SearchResult {
    static constexpr int most = 3;
    Vector vector[most];
    int count = 0;
    int evaluations = 0;  ///< 16x16 differences computed
};

/// Compares the macroblock with every whole-pixel place within `range` of `centre` and within `allowed`.
/// `cost_per_bit` is in sums of absolute differences.
SearchResult search(const Frame& picture, const Frame& reference, int column, int row, const VectorRange& allowed,
                    Vector centre, float cost_per_bit, int range);

}  // namespace render2mpeg::encoder::mpeg2
