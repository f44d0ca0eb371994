#include "encoder/mpeg2/macroblock/weighting_matrices.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "encoder/mpeg2/bitstream/tuning.h"

// Visibility of an error falls with its frequency. Both matrices and the weights of distortion are powers of perceptual
// tables: MPEG-2's intra matrix and JPEG's luminance steps. docs/measurements.md#encoder describes the choice of the
// powers.

namespace render2mpeg::encoder::mpeg2 {
namespace {

/// JPEG's luminance quantisation table, raster order. [T81, table K.1]
constexpr std::array<float, 64> luminance_steps = {
    16, 11, 10, 16, 24,  40,  51,  61,   //
    12, 12, 14, 19, 26,  58,  60,  55,   //
    14, 13, 16, 24, 40,  57,  69,  56,   //
    14, 17, 22, 29, 51,  87,  80,  62,   //
    18, 22, 37, 56, 68,  109, 103, 77,   //
    24, 35, 55, 64, 81,  104, 113, 92,   //
    49, 64, 78, 87, 103, 121, 120, 101,  //
    72, 92, 95, 98, 112, 100, 103, 99,
};
constexpr float coarse_detail = 12.0f;  ///< that table's steps where the eye is keenest

/// chosen: 1.2 of 1 to 1.4.
constexpr float intra_power = 1.2f;

/// chosen: 0.7 of 0.35 to 1.1, times 16 of 14 to 18: the flat 16 at low frequencies.
constexpr float non_intra_power = 0.7f, non_intra_scale = 16.0f;

/// chosen: 1.2 of 1 to 2, times 1.3 of 1 to 1.5.
constexpr float weight_power = 1.2f, weight_scale = 1.3f;

std::uint8_t to_entry(float value) {
    return static_cast<std::uint8_t>(std::clamp(std::lround(value), 1l, 255l));
}

Matrices make_perceptual() {
    Matrices matrices;
    for (std::size_t i = 0; i < 64; ++i) {
        const auto flat = static_cast<float>(default_non_intra_matrix[i]);
        const auto intra = static_cast<float>(default_intra_matrix[i]);
        if (i > 0) matrices.intra[i] = to_entry(flat * std::pow(intra / flat, intra_power));
        matrices.non_intra[i] =
            to_entry(non_intra_scale * std::pow(luminance_steps[i] / coarse_detail, non_intra_power));
    }
    return matrices;
}

Weights make_weights() {
    Weights weights;
    for (std::size_t v = 0; v < 8; ++v)
        for (std::size_t u = 0; u < 8; ++u)
            weights.of[u * 8 + v] = weight_scale * std::pow(coarse_detail / luminance_steps[v * 8 + u], weight_power);
    return weights;
}

Weights even_weights() {
    Weights weights;
    std::fill_n(weights.of, 64, 1.0f);
    return weights;
}

Weights with_mean(const Weights& weights) {
    Weights changed = weights;
    changed.of[0] *= mean_weight;
    return changed;
}

}  // namespace

Matrices matrices_for(Tune tune) {
    static const Matrices perceptual = make_perceptual();
    return tune == Tune::perceptual ? perceptual : Matrices{};
}

const Weights* weights_for(Tune tune, PictureType type) {
    static const Weights perceptual = make_weights();
    static const Weights perceptual_predicted = with_mean(perceptual), predicted = with_mean(even_weights());
    if (type == PictureType::intra) return tune == Tune::perceptual ? &perceptual : nullptr;
    return tune == Tune::perceptual ? &perceptual_predicted : &predicted;
}

}  // namespace render2mpeg::encoder::mpeg2
