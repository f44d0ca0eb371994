#pragma once
// What a coded picture loses by the noise of its light.
#include <cmath>
#include <cstdint>

#include "core/dct.h"
#include "core/plane.h"
#include "perceptual/distortion.h"
#include "perceptual/inverse_luma.h"

namespace render2mpeg::perceptual {

/// Variances of the coefficients of a block's luma by noise, squared code values.
using BlockNoise = core::Block8x8;

/// Variance of pixels by noise: squared code values, of one pixel and of the mean of its block. Counts light, by that
/// of one code value in its place.
struct PixelNoise {
    float alone = 0, of_block = 0;
};

/// Noise of pixels whose luminance has these standard errors, and the means of their blocks those (core::Radiance).
core::Plane<PixelNoise> noise_of(const PixelLight& light, const InverseLuma& display, const core::Plane<float>& error,
                                 const core::Plane<float>& shared_error);

/// Noise of blocks, of pixels with this luma, as a display shows it (docs/model/tolerance.md#the-price).
core::Plane<BlockNoise> noise_of_blocks(const core::Plane<PixelNoise>& pixels, const core::Plane<float>& luma);

/// Blocks of a picture as they are coded: of its luma, or of what a prediction leaves of it.
struct CodedBlocks {
    core::Plane<core::Block8x8> coefficients;
    core::Plane<std::uint8_t> predicted;  ///< 1: by prediction; empty: none is

    /// Blocks of a picture whose luma has these coefficients. Predicted are those of which all pixels are: luma > 0
    /// from other pictures, or less where nothing shows the same; empty: none.
    CodedBlocks(const core::Plane<core::Block8x8>& picture, const core::Plane<float>& luma,
                const core::Plane<float>& prediction);
};

/// Luma as it is decoded: blocks of a picture of this luma, coded by these steps, on top of the prediction that they
/// were told by (empty: none).
core::Plane<std::uint8_t> decode(const CodedBlocks& blocks, const core::Plane<float>& luma,
                                 const core::Plane<float>& prediction, const Quantisation& quantisation, float scale);

/// What is left of a picture for the next one to code, if nothing moves: what these intra steps lost.
CodedBlocks left_by_intra(const core::Plane<core::Block8x8>& picture, const Quantisation& quantisation, float scale);

/// Coding of a picture's luma with noise in its light.
struct NoisyPicture {
    CodedBlocks blocks;
    core::Plane<BlockNoise> noise;
    Quantisation quantisation;
    float scale = 1;  ///< BlockCoding::scale

    /// dB of PSNR-Y that coding loses by so many times this noise more, in the mean of a sample of blocks; >= 0.
    double loss(double times) const;
};

/// The number in [least, most], both > 0, at which a loss that grows with it is so large; an end where it never is.
template <class Loss>
double number_of_loss(double wanted, double least, double most, Loss loss) {
    // chosen: 12 halvings find it to 0.1 % of a range of 100.
    for (int i = 0; i < 12; ++i) {
        const double middle = std::sqrt(least * most);
        (loss(middle) < wanted ? least : most) = middle;
    }
    return std::sqrt(least * most);
}

}  // namespace render2mpeg::perceptual
