#pragma once
// The display's inverse: how far a pixel's light may move for a given change of luma.
#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "core/picture.h"
#include "core/plane.h"
#include "core/radiance.h"
#include "perceptual/display.h"

/// Inverts the display: distances of luma become distances of luminance [Render2MPEG, eq. 7.4].
namespace render2mpeg::perceptual {

/// Light of a frame's pixels, and the response of their luma to more or less light of the same colour.
struct PixelLight {
    core::Plane<float> luma;       ///< unrounded, code values 16..235
    core::Plane<float> luminance;  ///< scene-linear, >= 0
    /// How much more light, in logarithms, this colour needs than grey for the same small step of luma: 1 for grey,
    /// below 1 where channels are further down the curve.
    core::Plane<float> exponent;

    int width() const { return luma.width(); }
    int height() const { return luma.height(); }
};

template <class A>
void archive(A& a, PixelLight& light) {
    auto& [luma, luminance, exponent] = light;
    a(luma, luminance, exponent);
}

/// Distances in luma as distances in light: the inverse of the display for a pixel's own chromaticity
/// [Render2MPEG, eq. 7.4]. Display::with_luma is exact and slow; this is a table for grey, with its exponent corrected
/// to the colour's first order: exact for grey, for colours within 1 % of with_luma in the median and 31 % for 99 of
/// 100 at distances of 1 to 20 code values (test; Blender's views: docs/model/display.md). Immutable.
class InverseLuma {
  public:
    explicit InverseLuma(const Display& display);

    /// Planes of one size; `picture` was developed from `radiance`, and has its unrounded luma.
    PixelLight light_of(const core::Picture& picture, const core::Radiance& radiance) const;

    /// |Y^ - Y| for a pixel's luma, luminance and exponent, and Y^ of a luma that is `distance` > 0 code values below:
    /// a tolerance is used for both signs, and the curve from luma to light is bent upwards, so that this is the lesser
    /// change; next to white the other side holds any light at all. A pixel nearer to black than `distance` may change
    /// by as much as its own colour has at that distance from black, which is no more than `distance` code values
    /// either way, and joins what is farther from black without a step. Colours whose luma ends early (blue: 31.8) are
    /// allowed no more there than grey, or their own light. > 0 and finite.
    float difference(float luma, float luminance, float exponent, float distance) const {
        const float from = std::clamp(luma - black, darkest, range);
        const float here = at(log_light_, from);
        if (from - distance >= darkest)
            return luminance * (1.0f - std::exp2(exponent * (at(log_light_, from - distance) - here)));
        const float to = std::min(distance + darkest, range);
        const float upper = at(log_light_, to), lower = at(log_light_, darkest);
        // A black pixel has no light to multiply, and is taken for grey.
        const float light = from > darkest ? luminance : std::max(luminance, darkest_light_);
        const float change = light * (std::exp2(exponent * (upper - here)) - std::exp2(exponent * (lower - here)));
        if (from <= darkest) return change;
        return std::min(change, std::max(luminance, (std::exp2(upper) - std::exp2(lower)) / gain_));
    }

    /// Luminance of a grey pixel half a code value above black: below this no film shows anything.
    float darkest_step() const { return darkest_step_; }

  private:
    static constexpr float black = 16.0f, range = 219.0f;

    /// Less than this above black counts as this: the logarithm of black is nothing to calculate with.
    static constexpr float darkest = 0.25f;

    /// chosen: 16 per code value keeps the table within 2 % of the curve from half a code value above black on (test);
    /// 4 do not, 64 gain nothing.
    static constexpr float entries_per_code = 16.0f;
    static constexpr auto entries = static_cast<std::size_t>(range * entries_per_code) + 1;

    /// Reads one of the tables below.
    static float at(const std::vector<float>& table, float above_black) {
        const float place = above_black * entries_per_code;
        const auto i = static_cast<std::size_t>(place);
        return table[i] + (place - static_cast<float>(i)) * (table[i + 1] - table[i]);
    }
    /// Of luma by the logarithm of a pixel's light, from 0 to 1.
    float slope_of(glm::vec3 color) const;

    glm::vec3 weights_;
    float gain_;
    std::shared_ptr<const ViewTransform> view_;  ///< null: neutral
    float darkest_step_;
    float darkest_light_;            ///< luminance of grey that is `darkest` above black
    std::vector<float> log_light_;   ///< by luma above black, entries_per_code of them per code value
    std::vector<float> grey_slope_;  ///< of the signal by the logarithm of light, likewise
};

}  // namespace render2mpeg::perceptual
