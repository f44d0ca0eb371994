#pragma once

#include <vector>

#include "core/picture.h"
#include "core/plane.h"
#include "core/radiance.h"
#include "perceptual/display.h"

namespace render2mpeg::perceptual {

/// What a frame's pixels send, and how their luma would follow if they sent more or less of the same colour.
struct PixelLight {
    core::Plane<float> luma;       ///< unrounded, code values 16..235
    core::Plane<float> luminance;  ///< scene-linear, >= 0
    /// How much more light, in logarithms, this colour needs than grey for the same small step of luma: 1 for grey,
    /// below 1 where channels are further down the curve.
    core::Plane<float> exponent;

    int width() const { return luma.width(); }
    int height() const { return luma.height(); }
};

/// Distances in luma as distances in light: the inverse of the display for a pixel's own chromaticity
/// [Render2MPEG, eq. 7.4]. Display::with_luma is exact and slow; this is a table for grey, with its exponent corrected
/// to the colour's first order: exact for grey, for colours within 1 % of with_luma in the median and 25 % for 99 of
/// 100 at distances of 1 to 20 code values (test). Immutable.
class LumaLight {
  public:
    explicit LumaLight(const Display& display);

    /// Planes of one size; `picture` was developed from `radiance`, and has its unrounded luma.
    PixelLight light_of(const core::Picture& picture, const core::Radiance& radiance) const;

    /// |Y^ - Y| for a pixel's luma, luminance and exponent, and Y^ of a luma that is `distance` > 0 code values away,
    /// on the side where that is the lesser change: a tolerance is used for both signs, and next to white the other
    /// side holds any light at all. Where that side ends in black before, the distance is taken inward. > 0 and finite.
    float difference(float luma, float luminance, float exponent, float distance) const;

    /// Luminance of a grey pixel half a code value above black: below this no film shows anything.
    float darkest_step() const;

  private:
    /// Reads one of the tables below.
    static float at(const std::vector<float>& table, float above_black);

    glm::vec3 weights_;
    float gain_;
    std::vector<float> log_light_;   ///< by luma above black, entries_per_code of them per code value
    std::vector<float> grey_slope_;  ///< of the signal by the logarithm of light, likewise
};

}  // namespace render2mpeg::perceptual
