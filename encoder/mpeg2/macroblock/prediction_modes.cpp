#include "encoder/mpeg2/macroblock/prediction_modes.h"

#include <algorithm>
#include <array>
#include <limits>
#include <optional>

#include "encoder/mpeg2/bitstream/tuning.h"
#include "encoder/mpeg2/motion/motion_compensation.h"

namespace render2mpeg::encoder::mpeg2 {
namespace {

/// Bits of the vectors and of a macroblock_type with coefficients.
float bits_of(const PictureCoding& picture, const SliceState& state, const PredictionMode& mode) {
    const MacroblockType type{false, mode.uses[0], true, false, mode.uses[1]};
    return static_cast<float>(vector_bits(picture, state, mode) + macroblock_type_code(picture.type, type).length);
}

/// How both vectors of a mean are moved at once, half pixels.
struct Step {
    Vector first, second;
};
using Steps = std::array<Step, 8>;

/// The neighbours of one vector; of both, to one side or to opposite ones.
constexpr Steps first_steps{{{{-1, -1}, {}},
                             {{0, -1}, {}},
                             {{1, -1}, {}},
                             {{-1, 0}, {}},
                             {{1, 0}, {}},
                             {{-1, 1}, {}},
                             {{0, 1}, {}},
                             {{1, 1}, {}}}};
constexpr Steps second_steps{{{{}, {-1, -1}},
                              {{}, {0, -1}},
                              {{}, {1, -1}},
                              {{}, {-1, 0}},
                              {{}, {1, 0}},
                              {{}, {-1, 1}},
                              {{}, {0, 1}},
                              {{}, {1, 1}}}};
constexpr Steps joint_steps{{{{0, -1}, {0, 1}},
                             {{-1, 0}, {1, 0}},
                             {{1, 0}, {-1, 0}},
                             {{0, 1}, {0, -1}},
                             {{0, -1}, {0, -1}},
                             {{-1, 0}, {-1, 0}},
                             {{1, 0}, {1, 0}},
                             {{0, 1}, {0, 1}}}};

Vector moved(Vector v, Vector by) {
    return {static_cast<std::int16_t>(v.x + by.x), static_cast<std::int16_t>(v.y + by.y)};
}

/// Means of two predictions, none of them computed twice.
class Means {
  public:
    Means(const PictureCoding& picture, int column, int row) : picture_(picture), column_(column), row_(row) {}

    /// Hadamard sum; none where it was computed before.
    std::optional<std::uint32_t> difference(const PredictionMode& mean) {
        const auto end = tried_.begin() + count_;
        if (std::find(tried_.begin(), end, mean) != end) return std::nullopt;
        *end = mean;
        ++count_;
        alignas(32) std::uint8_t samples[256];
        return satd_of_mean(picture_.source, *picture_.reference[0], *picture_.reference[1], column_, row_, mean.vector,
                            samples);
    }
    int evaluations() const { return count_; }

  private:
    const PictureCoding& picture_;
    int column_, row_, count_ = 0;
    std::array<PredictionMode, evaluation_limit_of_means> tried_;
};

}  // namespace

ModeChoice choose_prediction_modes(const PictureCoding& picture, int column, int row, const SliceState& state,
                                   const BestVectors& forward, const BestVectors& backward, float cost_per_bit) {
    ModeChoice choice;
    const auto cost_of = [&](const PredictionMode& mode, std::uint32_t difference) {
        const float bits =
            bits_of(picture, state, mode) + cost_to_go(picture, state, mode, {&forward.to_go, &backward.to_go});
        return static_cast<float>(difference) + cost_per_bit * bits;
    };
    for (int d = 0; d < 2; ++d) {
        const BestVectors& vectors = d == 0 ? forward : backward;
        for (int i = 0; i < vectors.count; ++i) {
            PredictionMode one{{}, {d == 0, d == 1}};
            one.vector[d] = vectors.vector[i];
            choice.modes.add(one, cost_of(one, vectors.difference[i]));
        }
    }

    // Means of the best two of each direction, and the mode of the macroblock before.
    Means means(picture, column, row);
    float least = std::numeric_limits<float>::infinity();
    PredictionMode best;
    const auto add_mean = [&](Vector first, Vector second) {
        const PredictionMode mean{{first, second}, {true, true}};
        const std::optional<std::uint32_t> difference = means.difference(mean);
        if (!difference) return;
        const float cost = cost_of(mean, *difference);
        choice.modes.add(mean, cost);
        if (cost >= least) return;
        least = cost;
        best = mean;
    };
    add_mean(forward.vector[0], backward.vector[0]);
    const PredictionMode* before = skip_mode(picture, column, row, state);
    if (before && before->uses[0] && before->uses[1]) add_mean(before->vector[0], before->vector[1]);
    if (forward.count > 1) add_mean(forward.vector[1], backward.vector[0]);
    if (backward.count > 1) add_mean(forward.vector[0], backward.vector[1]);

    // Where a mean is among the best, half-pel neighbours of each of its vectors, the other held fast, then of both.
    const VectorRange allowed[2] = {vector_range(column, row, picture.source.columns(), picture.source.rows(),
                                                 picture.f_code[0][0], picture.f_code[0][1]),
                                    vector_range(column, row, picture.source.columns(), picture.source.rows(),
                                                 picture.f_code[1][0], picture.f_code[1][1])};
    for (const auto& steps : {first_steps, second_steps, joint_steps}) {
        if (least > shortlist_reach * choice.modes.key(0)) break;
        const Vector middle[2] = {best.vector[0], best.vector[1]};
        for (const Step& step : steps) {
            const Vector v[2] = {moved(middle[0], step.first), moved(middle[1], step.second)};
            if (allowed[0].contains(v[0]) && allowed[1].contains(v[1])) add_mean(v[0], v[1]);
        }
    }
    choice.evaluations = means.evaluations();
    choice.modes.drop_above(shortlist_reach * choice.modes.key(0));
    return choice;
}

}  // namespace render2mpeg::encoder::mpeg2
