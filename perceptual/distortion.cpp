#include "perceptual/distortion.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "perceptual/masking.h"

// The block that differs most from another and still codes alike [Render2MPEG, eq. 7.3]. What we changed:
//
// Case 1, coefficients that vanish: the paper tests c without its absolute value and *replaces* c by sign(c) qs min(q)
// / 2. Where c is nearly large enough to stay, that is an error of up to qs (q - min q) / 2 with the sign against c,
// several times what the case is there to limit. We *add* it, so that no error exceeds qs min(q) / 2, nor, since min(q)
// <= q, what the quantiser itself can do.
//
// The paper has intra pictures only. Macroblocks that are predicted quantise the residual, with their own matrix and
// dead zone: what vanishes is decided by the residual.
//
// DC of intra blocks has a step of its own; inter DC errors are capped at the intra one, or the mean of a block could
// wander in predicted pictures and jump back in the next intra one.

namespace render2mpeg::perceptual {
namespace {

float least_ac(const core::Block8x8& matrix) {
    return *std::min_element(matrix.begin() + 1, matrix.end());
}

}  // namespace

core::Block8x8 worst_errors(const core::Block8x8& c, const core::Block8x8& m, const Quantisation& quantisation,
                            const BlockCoding& coding) {
    EXPECTS_DEBUG(coding.scale > 0.0f);
    const core::Block8x8& matrix = coding.intra ? quantisation.intra : quantisation.inter;
    const core::Block8x8& sensitivity = masking_sensitivity();
    const float half = 0.5f * coding.scale, vanished = half * least_ac(matrix),
                mean_error = 0.5f * quantisation.dc_step;
    core::Block8x8 errors;
    if (!coding.intra && coding.residual == nullptr) {
        for (std::size_t i = 0; i < 64; ++i) errors[i] = std::copysign(vanished, c[i] + 0.0f);
    } else {
        const core::Block8x8& quantised = coding.intra ? c : *coding.residual;
        const float least = coding.scale * (coding.intra ? quantisation.intra_dead_zone : quantisation.inter_dead_zone);
        for (std::size_t i = 0; i < 64; ++i) {
            // m / q is the block's masking: of m alone the eye's own matrix would be in the step twice.
            const float kept = half * matrix[i] * (m[i] / sensitivity[i]);
            const float error = std::abs(quantised[i]) < least * matrix[i] ? vanished : kept;
            errors[i] = std::copysign(error, c[i] + 0.0f);
        }
    }
    errors[0] = coding.intra ? mean_error : std::min(std::abs(errors[0]), mean_error);
    errors[0] = std::copysign(errors[0], c[0] + 0.0f);
    return errors;
}

float share_of_mean(const Quantisation& quantisation, const BlockCoding& coding) {
    const core::Block8x8 errors = worst_errors({}, masking_sensitivity(), quantisation, coding);
    return std::min(errors[0] / root_mean_square(errors), 1.0f);
}

float root_mean_square(const core::Block8x8& errors) {
    float sums[8] = {};
    for (std::size_t i = 0; i < 64; ++i) sums[i % 8] += errors[i] * errors[i];
    float sum = 0.0f;
    for (const float s : sums) sum += s;
    return std::sqrt(sum) * 0.125f;
}

}  // namespace render2mpeg::perceptual
