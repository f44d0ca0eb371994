#pragma once

#include "core/dct.h"
#include "encoder/types.h"

namespace render2mpeg::encoder {

/// The quantiser of luma: the distance between two levels of each coefficient of the orthonormal 8x8 DCT, in code
/// values, [v * 8 + u] with u the horizontal frequency, is the matrix times `scale`.
struct StepSizes {
    core::Block8x8 intra{};  ///< matrix of intra macroblocks; [0] is not looked at
    core::Block8x8 inter{};  ///< matrix of all others, whose levels keep clear of a dead zone of one step
    float scale = 0;         ///< > 0
    float intra_dc = 0;      ///< step of the mean coefficient of intra blocks, whatever the scale
};

/// The steps of pictures with this quantiser, 1..31. [H262, 7.4.1 and 7.4.2]
StepSizes step_sizes(Tune tune, int quantiser);

/// Their scale alone, also where a macroblock has another quantiser than its picture.
float step_scale(int quantiser);

}  // namespace render2mpeg::encoder
