#pragma once
// The fast effort's motion search: vectors are chosen only when a macroblock needs them.
#include <array>
#include <cstdint>
#include <limits>
#include <optional>

#include "core/plane.h"
#include "encoder/mpeg2/bitstream/vector.h"
#include "encoder/mpeg2/motion/motion_estimation.h"

namespace render2mpeg::encoder::mpeg2 {

/// Effort::fast: the prediction mode of a picture's macroblocks, each chosen when its turn comes, so that one that is
/// skipped costs nothing.
class FastMotionSearch {
  public:
    /// One source per reference, null where there is none.
    FastMotionSearch(const MotionSources* earlier, const MotionSources* later);

    /// f_code of a direction, which bounds all vectors ever chosen.
    const int (&f_code(int direction) const)[2] { return side_[static_cast<std::size_t>(direction)].f_code; }

    struct Result {
        PredictionMode mode;
        bool luma_is_predicted = false;  ///< `luma` holds the prediction
        int evaluations = 0;             ///< 16x16 Hadamard differences computed
        int searches = 0;                ///< 16x16 sums of absolute differences computed
    };
    /// The mode with the least Hadamard sum and bits of vectors; these count from `predictors`, one per direction.
    /// `luma` may get 16x16 samples of prediction.
    Result best_mode(int column, int row, const Vector (&predictors)[2], std::uint8_t* luma) const;

  private:
    struct Side {
        const MotionSources* sources = nullptr;
        int f_code[2] = {1, 1};
        std::optional<VectorBits> bits;
    };
    /// The cheapest vector of one direction so far.
    struct Found {
        Vector vector;
        std::uint32_t difference = 0;                    ///< Hadamard sum of luma
        float cost = std::numeric_limits<float>::max();  ///< with the vector's bits
        int evaluations = 0;                             ///< 16x16 differences computed
        std::array<Vector, 16> tried;                    ///< the first `evaluations`
        int searches = 0;                                ///< sums of absolute differences computed
    };

    /// The cheapest of the exact vectors; where there are none, of zero and `predictor`.
    Found begin(int direction, int column, int row, Vector predictor) const;
    /// Tries zero, `predictor` and the vector of the picture before too, then what a search about the best finds, then
    /// the half pixels around the best; each only where more than next to nothing is left to code.
    void refine(Found& found, int direction, int column, int row, Vector predictor) const;
    void consider(Found& found, const Side& side, int column, int row, Vector v, Vector predictor) const;
    VectorRange range(const Side& side, int column, int row) const;
    /// Whether a difference leaves next to nothing to code.
    bool is_enough(std::uint32_t difference) const { return difference <= enough_; }

    Side side_[2];
    float cost_per_bit_ = 0;
    std::uint32_t enough_ = 0;
};

}  // namespace render2mpeg::encoder::mpeg2
