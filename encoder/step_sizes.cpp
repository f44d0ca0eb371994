#include "encoder/step_sizes.h"

#include "encoder/mpeg2/kernels/quantiser.h"
#include "encoder/mpeg2/macroblock/weighting_matrices.h"

namespace render2mpeg::encoder {

float step_scale(int quantiser) {
    // quantiser_scale_code q with q_scale_type 0 is quantiser_scale 2 q; steps are sixteenths of matrix x
    // quantiser_scale. [H262, 7.4.2]
    return static_cast<float>(quantiser) / 8.0f;
}

StepSizes step_sizes(Tune tune, int quantiser) {
    const mpeg2::Matrices matrices = mpeg2::matrices_for(tune);
    StepSizes steps;
    for (std::size_t i = 0; i < 64; ++i) {
        steps.intra[i] = static_cast<float>(matrices.intra[i]);
        steps.inter[i] = static_cast<float>(matrices.non_intra[i]);
    }
    steps.scale = step_scale(quantiser);
    // 8, 4 or 2 for 8, 9 or 10 bits. [H262, 7.4.1]
    steps.intra_dc = static_cast<float>(8 >> (mpeg2::dc_bits_for(quantiser) - 8));
    return steps;
}

}  // namespace render2mpeg::encoder
