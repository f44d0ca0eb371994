#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "core/plane.h"
#include "encoder/mpeg2/bitstream/vector.h"
#include "encoder/mpeg2/kernels/frame.h"
#include "encoder/mpeg2/motion/candidates.h"
#include "encoder/mpeg2/motion/motion_estimation.h"

namespace render2mpeg::encoder::mpeg2 {

/// Effort::fast: the vectors of a picture, each chosen when its macroblock's turn comes, so that one that is skipped
/// costs none of it.
class FastMotionSearch {
  public:
    /// One source per reference, null where there is none.
    FastMotionSearch(const MotionSources* earlier, const MotionSources* later);

    /// What all vectors fit that are ever chosen.
    const int (&f_code(int direction) const)[2] { return side_[static_cast<std::size_t>(direction)].f_code; }

    /// The cheapest vector so far.
    struct Found {
        Vector vector;
        std::uint32_t difference = 0;                    ///< Hadamard sum of luma
        float cost = std::numeric_limits<float>::max();  ///< with the price of the vector's bits
        int evaluations = 0;                             ///< 16x16 differences computed
        std::array<Vector, 12> tried;                    ///< the first `evaluations`
    };
    /// The cheapest of the exact vectors; where there are none, of zero and `prediction`, which its bits count from.
    Found begin(int direction, int column, int row, Vector prediction) const;
    /// Tries zero, `prediction` and the vector of the picture before too, then the four half pixels around the best;
    /// nothing of it where next to nothing is left to code.
    void refine(Found& found, int direction, int column, int row, Vector prediction) const;
    /// Whether a difference leaves next to nothing to code.
    bool is_enough(std::uint32_t difference) const { return difference <= enough_; }

    /// The difference that the mean of two found vectors leaves; `mean` gets its 16x16 samples of luma.
    std::uint32_t difference_of_mean(int column, int row, Vector earlier, Vector later, std::uint8_t* mean) const;

  private:
    struct Side {
        const MotionSources* sources = nullptr;
        int f_code[2] = {1, 1};
        std::vector<ComponentBits> price;  ///< of x and y
    };
    std::uint32_t difference(const Side& side, int column, int row, Vector v) const;
    void consider(Found& found, const Side& side, int column, int row, Vector v, Vector prediction) const;
    VectorRange range(const Side& side, int column, int row) const;

    Side side_[2];
    float cost_per_bit_ = 0;
    std::uint32_t enough_ = 0;
};

}  // namespace render2mpeg::encoder::mpeg2
