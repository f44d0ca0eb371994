#pragma once
// The few vectors that exact motion offers for a macroblock.
#include <array>

#include "core/motion_field.h"
#include "encoder/mpeg2/bitstream/vector.h"

namespace render2mpeg::encoder::mpeg2 {

/// Vectors that the renderer's exact motion offers for a macroblock, without repeats.
struct Candidates {
    static constexpr int most = 3;
    std::array<Vector, most> vector;
    int count = 0;

    void add(Vector v) {
        for (int i = 0; i < count; ++i)
            if (vector[static_cast<std::size_t>(i)] == v) return;
        vector[static_cast<std::size_t>(count++)] = v;
    }
};

/// Mean, or the two modes where the macroblock holds a silhouette, and the centre pixel, rounded to half pixels and
/// moved into `range`. Pixels of class `none` and vectors that are no numbers or lead out of any picture are left out;
/// none left: no candidates. The macroblock may hang over the field's right and lower side.
Candidates exact_candidates(const core::MotionField& motion, int column, int row, const VectorRange& range);

/// The same for every macroblock of a picture of `columns` x `rows`: all that has to be kept of a field while its
/// picture waits for its later reference.
core::Plane<Candidates> exact_candidates(const core::MotionField& motion, int columns, int rows,
                                         int horizontal_f_code_limit);

}  // namespace render2mpeg::encoder::mpeg2
