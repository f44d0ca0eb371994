#include "encoder/mpeg2/macroblock/prediction_modes.h"

#include <algorithm>

#include "encoder/mpeg2/bitstream/tuning.h"

namespace render2mpeg::encoder::mpeg2 {
namespace {

/// Keeps the cheapest modes in order.
class Shortlist {
  public:
    void add(const PredictionMode& mode, float cost) {
        int place = choice_.count;
        while (place > 0 && cost < costs_[place - 1]) --place;
        if (place == ModeChoice::most) return;
        choice_.count = std::min(choice_.count + 1, ModeChoice::most);
        for (int i = choice_.count - 1; i > place; --i) {
            costs_[i] = costs_[i - 1];
            choice_.mode[i] = choice_.mode[i - 1];
        }
        costs_[place] = cost;
        choice_.mode[place] = mode;
    }
    /// Those within reach of the best.
    ModeChoice take(int evaluations) {
        while (choice_.count > 1 && costs_[choice_.count - 1] > shortlist_reach * costs_[0]) --choice_.count;
        choice_.evaluations = evaluations;
        return choice_;
    }

  private:
    ModeChoice choice_;
    float costs_[ModeChoice::most] = {};
};

/// Bits of the vectors and of a macroblock_type with coefficients.
float bits_of(const PictureCoding& picture, const SliceState& state, const PredictionMode& mode) {
    const MacroblockType type{false, mode.uses[0], true, false, mode.uses[1]};
    return static_cast<float>(vector_bits(picture, state, mode) + macroblock_type_code(picture.type, type).length);
}

std::uint32_t difference_of(const PictureCoding& picture, int column, int row, const PredictionMode& mode) {
    alignas(32) std::uint8_t mean[256];
    alignas(32) std::uint8_t later[256];
    predict_luma(*picture.reference[0], column, row, mode.vector[0], mean);
    predict_luma(*picture.reference[1], column, row, mode.vector[1], later);
    kernels().average(mean, later, 256);
    const core::Plane<std::uint8_t>& y = picture.source.y;
    return kernels().satd_16x16(y.row(row * 16) + column * 16, y.width(), mean, 16);
}

}  // namespace

ModeChoice choose_prediction_modes(const PictureCoding& picture, int column, int row, const SliceState& state,
                                   const BestVectors& forward, const BestVectors& backward, float cost_per_bit) {
    Shortlist shortlist;
    for (int d = 0; d < 2; ++d) {
        const BestVectors& vectors = d == 0 ? forward : backward;
        for (int i = 0; i < vectors.count; ++i) {
            PredictionMode one{{}, {d == 0, d == 1}};
            one.vector[d] = vectors.vector[i];
            shortlist.add(one, static_cast<float>(vectors.difference[i]) + cost_per_bit * bits_of(picture, state, one));
        }
    }

    // Means of the best two of each direction, and what the macroblock before used.
    PredictionMode means[evaluation_limit_of_means];
    int count = 0;
    const auto add = [&](Vector first, Vector second) {
        const PredictionMode mean{{first, second}, {true, true}};
        if (std::find(means, means + count, mean) == means + count) means[count++] = mean;
    };
    add(forward.vector[0], backward.vector[0]);
    const PredictionMode* before = skip_mode(picture, column, row, state);
    if (before && before->uses[0] && before->uses[1]) add(before->vector[0], before->vector[1]);
    if (forward.count > 1) add(forward.vector[1], backward.vector[0]);
    if (backward.count > 1) add(forward.vector[0], backward.vector[1]);
    for (int i = 0; i < count; ++i)
        shortlist.add(means[i], static_cast<float>(difference_of(picture, column, row, means[i])) +
                                    cost_per_bit * bits_of(picture, state, means[i]));
    return shortlist.take(count);
}

}  // namespace render2mpeg::encoder::mpeg2
