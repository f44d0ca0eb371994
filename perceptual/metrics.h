#pragma once
// PSNR and SSIM of pictures and films.
#include <cstdint>
#include <span>
#include <vector>

#include "core/picture.h"
#include "core/plane.h"

namespace render2mpeg::perceptual {

/// Mean squared difference of two planes of the same size, in code values squared. `rows`: weights of their rows, above
/// 0; empty: all count alike. By solid angle its psnr() is WS-PSNR [Sun2017].
double mean_squared_error(const core::Plane<std::uint8_t>& a, const core::Plane<std::uint8_t>& b,
                          std::span<const float> rows = {});

/// PSNR in dB for 8-bit planes; +infinity for equal ones. Films are averaged by their mean squared error, as in
/// ffmpeg's `psnr`.
double psnr(double mean_squared_error);

/// SSIM in [-1, 1] [Wang2004] with the block sums of ffmpeg's `ssim`: 8x8 windows every 4 pixels. Films are averaged
/// arithmetically. 1 for equal planes without a window.
double ssim(const core::Plane<std::uint8_t>& a, const core::Plane<std::uint8_t>& b);

/// Luma quality of a film, averaged as by ffmpeg's `psnr` and `ssim` (docs/model/metrics.md).
class FilmQuality {
  public:
    /// Both pictures have the same size. `rows`: as of mean_squared_error.
    void add(const core::Picture& picture, const core::Picture& reference, std::span<const float> rows = {});
    /// A picture by its mean squared error and SSIM.
    void add(double error, double similarity);

    /// Of luma, dB; +infinity while every picture equals its reference. ffmpeg: `y` of psnr.
    double psnr_y() const;
    /// Of luma. ffmpeg: `Y` of ssim. 1 before the first picture.
    double ssim_y() const;
    /// The same of the worst tenth of the pictures by each, at least of one.
    FilmQuality worst_tenth() const;

    std::int64_t pictures() const { return static_cast<std::int64_t>(errors_.size()); }

  private:
    std::vector<double> errors_, similarities_;  ///< of the pictures
};

/// Mean squared error of two planes of the same size as the eye sees it: differences of DCT coefficients are weighted
/// by contrast sensitivity, after what the block's own contrast hides was taken off (docs/model/metrics.md). In
/// code values squared, to be averaged over a film and then given to psnr(). 0 for equal planes, and where the eye sees
/// no difference. Like the original it looks at whole 8x8 blocks only; a plane too small for one is filled up to one by
/// repeating its edges. Symmetric.
double masked_error(const core::Plane<std::uint8_t>& a, const core::Plane<std::uint8_t>& b);

}  // namespace render2mpeg::perceptual
