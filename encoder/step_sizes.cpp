#include "encoder/step_sizes.h"

#include "encoder/codec.h"
#include "encoder/mpeg2/kernels/quantiser.h"
#include "encoder/mpeg2/macroblock/weighting_matrices.h"

namespace render2mpeg::encoder {
namespace {

/// A matrix entry that changes no step. [H262, 7.4.2.3], [H264, 8.5.9]
constexpr float flat = 16;

StepSizes mpeg2_steps(Tune tune, int quantiser) {
    const mpeg2::Matrices matrices = mpeg2::matrices_for(tune);
    StepSizes steps;
    for (std::size_t i = 0; i < 64; ++i) {
        steps.intra[i] = static_cast<float>(matrices.intra[i]);
        steps.inter[i] = static_cast<float>(matrices.non_intra[i]);
    }
    // 8, 4 or 2 for 8, 9 or 10 bits. [H262, 7.4.1]
    steps.intra_dc = static_cast<float>(8 >> (mpeg2::dc_bits_for(quantiser) - 8));
    return steps;
}

StepSizes flat_steps(Codec codec, int quantiser) {
    StepSizes steps;
    steps.intra.fill(flat);
    steps.inter.fill(flat);
    steps.intra_dc = static_cast<float>(step_of(codec, quantiser));
    // x264's rounding offsets, as other coders of this family have them: a third and a sixth of a step.
    steps.intra_dead_zone = 2.0f / 3;
    steps.inter_dead_zone = 5.0f / 6;
    return steps;
}

}  // namespace

float step_scale(Codec codec, int quantiser) {
    return static_cast<float>(step_of(codec, quantiser)) / flat;
}

StepSizes step_sizes(const Settings& settings, int quantiser, float ratio) {
    StepSizes steps =
        settings.codec == Codec::mpeg2 ? mpeg2_steps(settings.tune, quantiser) : flat_steps(settings.codec, quantiser);
    steps.scale = ratio * step_scale(settings.codec, quantiser);
    steps.intra_dc *= ratio;
    return steps;
}

}  // namespace render2mpeg::encoder
