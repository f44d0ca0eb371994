#pragma once

#include <cstdint>

#include "encoder/mpeg2/macroblock/macroblock.h"
#include "encoder/mpeg2/motion/motion.h"

namespace render2mpeg::encoder::mpeg2 {

/// The movements of a B picture's macroblock that deserve to be tried in full, cheapest first by Hadamard sum and bits.
struct MovementChoice {
    static constexpr int most = 4;
    Movement movement[most];
    int count = 0;
    int evaluations = 0;  ///< 16x16 differences computed
};

/// Chooses among each direction's vectors alone and means of their best, and of those of the macroblock before.
/// `cost_per_bit` is in Hadamard sums.
MovementChoice choose_movements(const PictureCoding& picture, int column, int row, const SliceState& state,
                                const VectorChoice& forward, const VectorChoice& backward, float cost_per_bit);

}  // namespace render2mpeg::encoder::mpeg2
