#pragma once
// Chooses vectors among exact motion, neighbours and zero.
#include <algorithm>
#include <cstdint>
#include <limits>

#include "core/plane.h"
#include "core/smallest.h"
#include "encoder/mpeg2/bitstream/vector.h"
#include "encoder/mpeg2/kernels/frame.h"
#include "encoder/mpeg2/motion/candidates.h"
#include "encoder/types.h"

/// Effort::quality: shortlists each macroblock's vectors in one direction.
namespace render2mpeg::encoder::mpeg2 {

/// Where the vectors of a picture come from.
struct MotionSources {
    const Frame& picture;
    const Frame& reference;                ///< reconstruction
    const core::Plane<Candidates>* exact;  ///< null: predictors and zero only
    const core::Plane<Vector>* previous;   ///< vectors of another picture, a predictor; null: none
    int horizontal_f_code_limit;
    float cost_per_bit;             ///< Hadamard sum
    bool zero_is_implicit;          ///< a zero vector costs next to nothing: P pictures
    std::uint32_t enough = 0;       ///< FastMotionSearch: Hadamard sum at which no more vectors are tried
    int evaluation_limit = 32;      ///< most 16x16 Hadamard differences computed for one macroblock, 9..32
    int search_reach = 16;          ///< pixels to each side that are searched (motion_search.h)
    std::uint32_t good_enough = 0;  ///< estimate_motion(): Hadamard sum at which nothing is searched
};

/// Bits of macroblock_type and vector of a P picture's macroblock, or of one direction of a B picture's.
class VectorBits {
  public:
    VectorBits(int horizontal_f_code, int vertical_f_code, bool zero_is_implicit)
        : x_(horizontal_f_code), y_(vertical_f_code), zero_is_implicit_(zero_is_implicit) {}
    /// A zero vector needs no bits in P pictures, but a macroblock type one bit longer.
    int operator()(Vector v, Vector prediction) const {
        if (zero_is_implicit_ && v.is_zero()) return 2;
        return 1 + x_(v.x - prediction.x) + y_(v.y - prediction.y);
    }

  private:
    ComponentBits x_, y_;
    bool zero_is_implicit_;
};

/// The cost of a row's macroblocks behind one, by the vector that predicts theirs: the cost-to-go of dynamic
/// programming from the row's end [Chen1998]. In bits; Hadamard sums count as the bits that they are worth.
class CostToGo {
  public:
    static constexpr int most = 4;  ///< chosen: 4; vectors beyond are hardly ever taken

    /// Adds a vector that the next macroblock may have. `bits`: all that it costs but for its own bits.
    void add(Vector v, float bits) { next_.add(v, bits); }
    /// Least cost, less what is common to all predictions; 0 at the row's end.
    float operator()(Vector prediction, const VectorBits& bits) const {
        if (next_.size() == 0) return 0.0f;
        float least = std::numeric_limits<float>::max();
        for (int i = 0; i < next_.size(); ++i)
            least = std::min(least, next_.key(i) + static_cast<float>(bits(next_[i], prediction)));
        return least - next_.key(0);
    }

  private:
    core::Smallest<Vector, most> next_;
};

/// The best vectors of a macroblock, best first.
struct BestVectors {
    static constexpr int most = 3;
    Vector vector[most];
    std::uint32_t difference[most] = {};  ///< Hadamard sum
    int count = 1;
    CostToGo to_go;  ///< behind the macroblock, in this direction
};

struct MotionEstimate {
    core::Plane<BestVectors> vectors;
    MotionWork work;
};

/// Most 16x16 Hadamard differences computed for one macroblock: in all; to choose a vector in a P picture, and in each
/// direction of a B picture; of means of both there; to see what skipping leaves, and whether intra coding may win.
inline constexpr int evaluation_limit = 78, evaluation_limit_of_vectors = 32, evaluation_limit_per_direction = 24,
                     evaluation_limit_of_means = 28, evaluation_limit_of_modes = 2;
static_assert(evaluation_limit_of_vectors + evaluation_limit_of_modes <= evaluation_limit);
static_assert(2 * evaluation_limit_per_direction + evaluation_limit_of_means + evaluation_limit_of_modes <=
              evaluation_limit);

/// Chooses a vector for every macroblock by Hadamard difference plus the price of the vector's bits: among the
/// renderer's exact vectors, predictors (left, above, above right, their median, the picture before) and zero; where
/// none of the exact vectors, zero, left and the picture before is good enough, among those of a sparse search about
/// the best of them; then among half-pel neighbours of the best, in at most two rounds. At last vectors of a row are
/// chosen together: their price counts what they cost the macroblocks behind.
MotionEstimate estimate_motion(const MotionSources& sources);

}  // namespace render2mpeg::encoder::mpeg2
