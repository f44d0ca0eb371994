#pragma once
// Parameters of the film grain that AV1's decoders add.
#include <array>
#include <cstdint>
#include <vector>

#include "core/plane.h"

namespace render2mpeg::av {

/// What a frame's film_grain_params() say but for its seed [AV1, 5.9.30]: white noise through an autoregressive filter,
/// scaled by luma.
struct GrainTable {
    struct Point {
        int luma = 0;     ///< code values of 8 bits, rising
        int scaling = 0;  ///< 0..255, straight between points, the end's beyond them

        bool operator==(const Point&) const = default;
    };
    static constexpr int filter_shift = 7;
    static constexpr double unfiltered = 32;  ///< deviation of the noise, code values of 8 bits [AV1, 7.18.3.3]

    std::vector<Point> points;     ///< 14 at most; none: no grain
    int scaling_shift = 11;        ///< 8..11: noise is multiplied by scaling / 2^scaling_shift,
    int noise_shift = 0;           ///< 0..3: and divided by 2^noise_shift
    int lag = 0;                   ///< reach of the filter, 0..3; 0: none
    std::array<int, 24> filter{};  ///< in 128ths: of `lag` rows above and as many places to the left, row by row

    int weights() const { return 2 * lag * (lag + 1); }
    bool operator==(const GrainTable&) const = default;
};

/// As core::FilmGrain has it.
GrainTable film_grain_table(int iso, int height);

/// Dither of smooth gradients. A display of 8 bits shows their steps, which AV1's 10 bits do not have: noise with the
/// variance of that rounding hides them, and decoders add it behind their references.
class GradientDither {
  public:
    /// A decoded picture, rounded to 8 bits.
    void add(const core::Plane<std::uint8_t>& luma);
    /// Noise where the luma of the pictures is mostly of steps; none where they have few.
    GrainTable table() const;

  private:
    std::array<std::int64_t, 256> steps_{}, others_{};  ///< pixels by luma, in blocks of steps and in those of more
    std::int64_t pixels_ = 0;
};

}  // namespace render2mpeg::av
