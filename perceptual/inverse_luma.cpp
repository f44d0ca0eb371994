#include "perceptual/inverse_luma.h"

#include <algorithm>
#include <cmath>

#include "core/color.h"
#include "core/error.h"
#include "core/numeric.h"
#include "perceptual/signal_curve.h"

namespace render2mpeg::perceptual {
namespace {

/// Colours whose channels all lie at the ends of the curve have no slope. chosen: of 200000 colours of every saturation
/// 99 of 100 come within 31 % of with_luma; with limits of 1/5 and 5 within a factor of 2.6, with 1/2 and 2 of 6.
constexpr float least_exponent = 0.05f, largest_exponent = 20.0f;
constexpr float least_slope = 1e-30f;

}  // namespace

InverseLuma::InverseLuma(const Display& display)
    : weights_(luma_weights(display.matrix())),
      gain_(std::exp2(display.exposure())),
      log_light_(entries + 1),
      grey_slope_(entries + 1) {
    const SignalCurve& curve = SignalCurve::instance();
    for (std::size_t i = 0; i < entries; ++i) {
        const double above = std::max(static_cast<double>(i) / static_cast<double>(entries_per_code), 1e-3);
        const double linear = inverse_opto_electronic(std::min(above / static_cast<double>(range), 1.0));
        const double light = linear < 1.0 ? inverse_tone_curve(linear) : 1e30;
        const float exposed = static_cast<float>(std::min(light, static_cast<double>(SignalCurve::brightest)));
        log_light_[i] = std::log2(exposed);
        grey_slope_[i] = curve.point(exposed).log_slope;
    }
    log_light_[entries] = log_light_[entries - 1];
    grey_slope_[entries] = grey_slope_[entries - 1];
    darkest_light_ = power_of_two(at(log_light_, darkest)) / gain_;
}

RENDER2MPEG_CLONES
void InverseLuma::weigh(const glm::vec3* colors, const float* luma, float* luminance, float* exponent,
                        int count) const {
    const SignalCurve& curve = SignalCurve::instance();
    const float* const slopes = grey_slope_.data();
    const float red = weights_.x, green = weights_.y, blue = weights_.z, gain = gain_;
    const float red_light = core::luminance_weights.x, green_light = core::luminance_weights.y,
                blue_light = core::luminance_weights.z;
    for (int i = 0; i < count; ++i) {
        const float r = colors[i].x, g = colors[i].y, b = colors[i].z;
        luminance[i] = core::inlined::max(red_light * r + green_light * g + blue_light * b, 0.0f);
        const float own =
            red * curve.log_slope(r * gain) + green * curve.log_slope(g * gain) + blue * curve.log_slope(b * gain);
        const float above = luma[i] - black;
        const float grey = at(slopes, core::inlined::min(core::inlined::max(above, darkest), range));
        const float ratio = grey / core::inlined::max(own, least_slope);
        const float bounded = core::inlined::min(core::inlined::max(ratio, least_exponent), largest_exponent);
        // What is that dark, or has no slope at all, is taken for grey.
        const int has_colour = static_cast<int>(above > darkest) & static_cast<int>(own > 0.0f);
        exponent[i] = has_colour != 0 ? bounded : 1.0f;
    }
}

PixelLight InverseLuma::light_of(const core::Picture& picture, const core::Radiance& radiance) const {
    EXPECTS(picture.luma.width() == radiance.combined.width() && picture.luma.height() == radiance.combined.height());
    PixelLight light;
    light.luma = picture.luma;
    light.luminance = light.exponent = core::Plane<float>(picture.luma.width(), picture.luma.height());
    for (int y = 0; y < light.height(); ++y)
        weigh(radiance.combined.row(y), light.luma.row(y), light.luminance.row(y), light.exponent.row(y),
              light.width());
    return light;
}

RENDER2MPEG_CLONES
void InverseLuma::differences(const float* luma, const float* luminance, const float* exponent, float least,
                              float* distance, int count) const {
    // Most pixels are farther from black than their distance: go down for all of them, in steps that the compiler makes
    // vector code of; reading tables is the only one that it does not.
    constexpr int block = 64;
    const float* const table = log_light_.data();
    float from[block], away[block], change[block];
    for (int first = 0; first < count; first += block) {
        const int size = count - first < block ? count - first : block;
        for (int i = 0; i < size; ++i) {
            from[i] = core::inlined::min(core::inlined::max(luma[first + i] - black, darkest), range);
            away[i] = from[i] - distance[first + i];
        }
        for (int i = 0; i < size; ++i) change[i] = at(table, core::inlined::max(away[i], darkest)) - at(table, from[i]);
        for (int i = 0; i < size; ++i)
            change[i] = luminance[first + i] * (1.0f - power_of_two(exponent[first + i] * change[i]));
        // Then see to those next to black.
        for (int i = 0; i < size; ++i)
            if (away[i] < darkest)
                change[i] = difference(luma[first + i], luminance[first + i], exponent[first + i], distance[first + i]);
        for (int i = 0; i < size; ++i)
            distance[first + i] = core::inlined::max(least * luminance[first + i], change[i]);
    }
}

float InverseLuma::darkest_step() const {
    return 0.5f / (range * 4.5f * gain_);
}

}  // namespace render2mpeg::perceptual
