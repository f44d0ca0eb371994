#pragma once
// Searches whole-pixel vectors by sums of absolute differences, sparsely.
#include <cstdint>

#include "core/smallest.h"
#include "encoder/mpeg2/bitstream/vector.h"
#include "encoder/mpeg2/kernels/frame.h"

namespace render2mpeg::encoder::mpeg2 {

/// Where and how a macroblock is searched.
struct SearchArea {
    int column, row;      ///< the macroblock
    VectorRange allowed;  ///< half pixels
    Vector centre;        ///< of the area; need not be whole pixels
    int reach;            ///< pixels to each side of the centre, a multiple of 4, 4..24
    Vector prediction;    ///< of the vector in the stream, as far as known
    float cost_per_bit;   ///< absolute differences
};

struct SearchResult {
    static constexpr int most = 3;
    core::Smallest<Vector, most> vectors;  ///< whole pixels; by sum of absolute differences and price of the bits
    int evaluations = 0;                   ///< sums computed
};

/// The best whole-pixel vectors on a grid of 4 pixels in the area, refined by steps of 2 and 1 pixels about the best
/// three. Sums of absolute differences are an eighth of Hadamard sums of noise.
SearchResult search_whole_pixels(const Frame& picture, const Frame& reference, const SearchArea& area);

}  // namespace render2mpeg::encoder::mpeg2
