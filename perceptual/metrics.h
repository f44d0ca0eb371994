#pragma once

#include <cstdint>

#include "core/plane.h"

namespace render2mpeg::perceptual {

/// Mean squared difference of two planes of the same size, in code values squared.
double mean_squared_error(const core::Plane<std::uint8_t>& a, const core::Plane<std::uint8_t>& b);

/// Peak signal-to-noise ratio in dB for 8-bit planes (peak 255); +infinity for equal ones. Films are averaged by their mean
/// squared error, as ffmpeg's `psnr` filter does.
double psnr(double mean_squared_error);

/// Structural similarity in [-1, 1] [Wang2004] with the block sums of ffmpeg's `ssim` filter: 8x8 windows every 4 pixels.
/// Films are averaged arithmetically. 1 for planes too small for one window that are equal.
double ssim(const core::Plane<std::uint8_t>& a, const core::Plane<std::uint8_t>& b);

}  // namespace render2mpeg::perceptual
