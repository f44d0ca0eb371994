#pragma once
// What a coded picture loses by the noise of its light.
#include <cmath>

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

/// Coding of a picture's luma by itself, with noise in its light.
struct NoisyPicture {
    const core::Plane<core::Block8x8>& coefficients;  ///< must outlive it
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
