#include "perceptual/masking.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"

// Thresholds of DCT coefficients after Watson's model of luminance and contrast masking [Watson1993], in the form that
// the film's idea was published with [Render2MPEG, eq. 7.1 and 7.2]: the default intra matrix stands for the eye's
// contrast sensitivity. What we changed: luminance counts from the display's black, not from code value 0, with a
// floor; the mean over blocks leaves padding out.

namespace render2mpeg::perceptual {
namespace {

/// The default intra matrix [H262, 6.3.11].
constexpr core::Block8x8 sensitivity{
    8,  16, 19, 22, 26, 27, 29, 34,  //
    16, 16, 22, 24, 27, 29, 34, 37,  //
    19, 22, 26, 27, 29, 34, 34, 38,  //
    22, 22, 26, 27, 29, 34, 37, 40,  //
    22, 26, 27, 29, 32, 35, 40, 48,  //
    26, 27, 29, 32, 35, 40, 48, 58,  //
    26, 27, 29, 34, 38, 46, 56, 69,  //
    27, 29, 35, 38, 46, 56, 69, 83,
};

/// Exponents of luminance masking, for the luminance of a display of this gamma, and of contrast masking.
/// [Render2MPEG, eq. 7.1 and 7.2] with gamma 2.2 for its 2.0: chosen: what displays have had since [BT709] (2.0..2.4).
constexpr float luminance_exponent = 2.2f * 0.649f;
constexpr float contrast_exponent = 0.7f;

/// DC coefficients: 8 times the mean. Black is code value 16; a block counts as at least one code value above it.
/// chosen: the smallest step the film can show; with less, the thresholds of black blocks go to 0 and ask for exactness
/// where nothing is seen (0..4 code values tried).
constexpr float black = 8.0f * 16.0f, darkest = 8.0f * 1.0f;

/// Luma of block (column, row); samples outside repeat the edge.
core::Block8x8 samples_of(const core::Picture& picture, int column, int row) {
    core::Block8x8 block;
    const bool unrounded = !picture.luma.empty();
    for (int j = 0; j < 8; ++j) {
        const int y = std::min(8 * row + j, picture.height() - 1);
        for (int i = 0; i < 8; ++i) {
            const int x = std::min(8 * column + i, picture.width() - 1);
            block[static_cast<std::size_t>(8 * j + i)] =
                unrounded ? picture.luma.at(x, y) : static_cast<float>(picture.y.at(x, y));
        }
    }
    return block;
}

float above_black(const core::Block8x8& coefficients) {
    return std::max(coefficients[0] - black, darkest);
}

/// Turns a block's coefficients into its thresholds. `brightness`: [Render2MPEG, eq. 7.1]'s factor of q_ij.
void apply_masking(core::Block8x8& block, float brightness, const core::Block8x8& sensitivity_rest) {
    const float rest = std::pow(brightness, 1.0f - contrast_exponent);
    block[0] = sensitivity[0] * brightness;
    for (std::size_t i = 1; i < 64; ++i) {
        // [Render2MPEG, eq. 7.2]: t max(1, |c / t|^0.7) = max(t, |c|^0.7 t^0.3).
        const float t = sensitivity[i] * brightness, c = std::abs(block[i]);
        block[i] = std::max(t, std::pow(c, contrast_exponent) * (sensitivity_rest[i] * rest));
    }
}

/// Thresholds on a flat block of the mean luminance, as shares of the intra matrix.
/// chosen: the steps of MPEG-2's finest quantiser. Contrast below them is not seen, and hides nothing.
constexpr float least_seen = 1.0f / 8;

/// Octaves by which a block's contrast raises its thresholds, mean over AC coefficients.
double octaves_hidden(const core::Block8x8& coefficients) {
    double product = 1.0;  // [Render2MPEG, eq. 7.2] is a power of each factor; 63 of them are below 2^700
    for (std::size_t i = 1; i < 64; ++i)
        product *= static_cast<double>(std::max(1.0f, std::abs(coefficients[i]) / (least_seen * sensitivity[i])));
    return static_cast<double>(contrast_exponent) * std::log2(product) / 63.0;
}

}  // namespace

const core::Block8x8& masking_sensitivity() {
    return sensitivity;
}

core::Plane<core::Block8x8> transform(const core::Picture& picture) {
    EXPECTS(picture.luma.empty() || picture.luma.size() == picture.y.size());
    core::Plane<core::Block8x8> blocks((picture.width() + 7) / 8, (picture.height() + 7) / 8);
    for (int row = 0; row < blocks.height(); ++row)
        for (int column = 0; column < blocks.width(); ++column)
            blocks.at(column, row) = core::forward_dct(samples_of(picture, column, row));
    return blocks;
}

ThresholdMap mask(const core::Plane<core::Block8x8>& coefficients, std::int64_t number) {
    ThresholdMap map;
    map.picture = number;
    map.blocks = coefficients;
    if (map.blocks.empty()) return map;

    // Take the mean of the blocks' values above black.
    double sum = 0.0;
    for (const core::Block8x8& block : map.blocks.values()) {
        EXPECTS(std::isfinite(block[0]));
        sum += static_cast<double>(above_black(block));
    }
    const float mean = static_cast<float>(sum / static_cast<double>(map.blocks.size()));

    // Replace coefficients by thresholds. A picture that is black all over has the mean `darkest`: there t = q.
    core::Block8x8 sensitivity_rest;
    for (std::size_t i = 0; i < 64; ++i) sensitivity_rest[i] = std::pow(sensitivity[i], 1.0f - contrast_exponent);
    for (core::Block8x8& block : map.blocks.values())
        apply_masking(block, std::pow(above_black(block) / mean, luminance_exponent), sensitivity_rest);
    return map;
}

ThresholdMap mask(const core::Picture& picture) {
    return mask(transform(picture), picture.number);
}

core::Plane<float> hidden(const core::Picture& picture) {
    const core::Plane<core::Block8x8> blocks = transform(picture);
    core::Plane<float> octaves((picture.width() + 15) / 16, (picture.height() + 15) / 16);
    for (int row = 0; row < octaves.height(); ++row)
        for (int column = 0; column < octaves.width(); ++column) {
            double sum = 0.0;
            int count = 0;
            for (int y = 2 * row; y < std::min(2 * row + 2, blocks.height()); ++y)
                for (int x = 2 * column; x < std::min(2 * column + 2, blocks.width()); ++x, ++count)
                    sum += octaves_hidden(blocks.at(x, y));
            octaves.at(column, row) = static_cast<float>(sum / count);
        }
    return octaves;
}

}  // namespace render2mpeg::perceptual
