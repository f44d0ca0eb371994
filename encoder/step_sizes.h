#pragma once

#include "core/dct.h"
#include "encoder/types.h"

namespace render2mpeg::encoder {

/// The quantiser of luma: the distance between two levels of each coefficient of the orthonormal 8x8 DCT, in code
/// values, [v * 8 + u] with u the horizontal frequency, is the matrix times `scale`.
struct StepSizes {
    core::Block8x8 intra{};  ///< matrix of intra macroblocks; [0] is not looked at
    core::Block8x8 inter{};  ///< matrix of all others
    float scale = 0;         ///< > 0
    float intra_dc = 0;      ///< step of the mean coefficient of intra blocks, whatever the scale
    /// Smallest coefficient that does not vanish, as a fraction of a step.
    float intra_dead_zone = 0.5f, inter_dead_zone = 1.0f;
};

/// The steps of a film's pictures with this quantiser. Codecs that transform 4x4 as well as 8x8 have the same step in
/// both. `ratio`: PicturePlan::step_ratio. [H262, 7.4.1 and 7.4.2], [H264, 8.5.9]
StepSizes step_sizes(const Settings& settings, int quantiser, float ratio = 1);

/// Their scale alone, also where a macroblock has another quantiser than its picture.
float step_scale(Codec codec, int quantiser);

}  // namespace render2mpeg::encoder
