#include "encoder/mpeg2/macroblock/prediction_modes.h"

#include <algorithm>

#include "encoder/mpeg2/bitstream/tuning.h"
#include "encoder/mpeg2/motion/motion_compensation.h"

namespace render2mpeg::encoder::mpeg2 {
namespace {

/// Bits of the vectors and of a macroblock_type with coefficients.
float bits_of(const PictureCoding& picture, const SliceState& state, const PredictionMode& mode) {
    const MacroblockType type{false, mode.uses[0], true, false, mode.uses[1]};
    return static_cast<float>(vector_bits(picture, state, mode) + macroblock_type_code(picture.type, type).length);
}

}  // namespace

ModeChoice choose_prediction_modes(const PictureCoding& picture, int column, int row, const SliceState& state,
                                   const BestVectors& forward, const BestVectors& backward, float cost_per_bit) {
    ModeChoice choice;
    const auto add = [&](const PredictionMode& mode, std::uint32_t difference) {
        choice.modes.add(mode, static_cast<float>(difference) + cost_per_bit * bits_of(picture, state, mode));
    };
    for (int d = 0; d < 2; ++d) {
        const BestVectors& vectors = d == 0 ? forward : backward;
        for (int i = 0; i < vectors.count; ++i) {
            PredictionMode one{{}, {d == 0, d == 1}};
            one.vector[d] = vectors.vector[i];
            add(one, vectors.difference[i]);
        }
    }

    // Means of the best two of each direction, and what the macroblock before used.
    PredictionMode means[evaluation_limit_of_means];
    const auto add_mean = [&](Vector first, Vector second) {
        const PredictionMode mean{{first, second}, {true, true}};
        if (std::find(means, means + choice.evaluations, mean) != means + choice.evaluations) return;
        means[choice.evaluations++] = mean;
        alignas(32) std::uint8_t samples[256];
        add(mean, satd_of_mean(picture.source, *picture.reference[0], *picture.reference[1], column, row, mean.vector,
                               samples));
    };
    add_mean(forward.vector[0], backward.vector[0]);
    const PredictionMode* before = skip_mode(picture, column, row, state);
    if (before && before->uses[0] && before->uses[1]) add_mean(before->vector[0], before->vector[1]);
    if (forward.count > 1) add_mean(forward.vector[1], backward.vector[0]);
    if (backward.count > 1) add_mean(forward.vector[0], backward.vector[1]);
    choice.modes.drop_above(shortlist_reach * choice.modes.key(0));
    return choice;
}

}  // namespace render2mpeg::encoder::mpeg2
