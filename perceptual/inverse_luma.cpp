#include "perceptual/inverse_luma.h"

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

/// The grey light, exposed, that has this signal.
double neutral_grey(double signal) {
    const double linear = inverse_opto_electronic(signal);
    const double light = linear < 1.0 ? inverse_tone_curve(linear) : 1e30;
    return std::min(light, static_cast<double>(SignalCurve::brightest));
}

}  // namespace

InverseLuma::InverseLuma(const Display& display)
    : weights_(luma_weights(display.matrix())),
      gain_(std::exp2(display.exposure())),
      view_(display.view()),
      log_light_(entries + 1),
      grey_slope_(entries + 1) {
    const SignalCurve& curve = SignalCurve::instance();
    for (std::size_t i = 0; i < entries; ++i) {
        const double above = std::max(static_cast<double>(i) / static_cast<double>(entries_per_code), 1e-3);
        const double signal = std::min(above / static_cast<double>(range), 1.0);
        const auto exposed = static_cast<float>(view_ ? view_->grey_light(signal) : neutral_grey(signal));
        log_light_[i] = std::log2(exposed);
        grey_slope_[i] =
            view_ ? glm::dot(weights_, view_->show(glm::vec3(exposed)).log_slope) : curve.point(exposed).log_slope;
    }
    log_light_[entries] = log_light_[entries - 1];
    grey_slope_[entries] = grey_slope_[entries - 1];
    darkest_light_ = power_of_two(at(log_light_, darkest)) / gain_;
    darkest_step_ = view_ ? power_of_two(at(log_light_, 0.5f)) / gain_ : 0.5f / (range * 4.5f * gain_);
}

RENDER2MPEG_CLONES
void InverseLuma::neutral_slopes_of(const glm::vec3* colors, float* slopes, int count) const {
    const SignalCurve& curve = SignalCurve::instance();
    const float red = weights_.x, green = weights_.y, blue = weights_.z, gain = gain_;
    for (int i = 0; i < count; ++i) {
        const float r = colors[i].x, g = colors[i].y, b = colors[i].z;
        slopes[i] =
            red * curve.log_slope(r * gain) + green * curve.log_slope(g * gain) + blue * curve.log_slope(b * gain);
    }
}

void InverseLuma::slopes_of(const glm::vec3* colors, float* slopes, int count) const {
    if (!view_) return neutral_slopes_of(colors, slopes, count);
    for (int i = 0; i < count; ++i) {
        const ShownLight shown = view_->show(colors[i] * gain_);
        // White has no slope: it is taken for the grey that just is white, which may fall least.
        const bool white = std::min({shown.signal.x, shown.signal.y, shown.signal.z}) >= 1.0f;
        slopes[i] = white ? 0.0f : glm::dot(weights_, shown.log_slope);
    }
}

RENDER2MPEG_CLONES
void InverseLuma::weigh(const glm::vec3* colors, const float* luma, const float* slopes, float* luminance,
                        float* exponent, int count) const {
    const float* const grey_slopes = grey_slope_.data();
    const float red_light = core::luminance_weights.x, green_light = core::luminance_weights.y,
                blue_light = core::luminance_weights.z;
    for (int i = 0; i < count; ++i) {
        const float r = colors[i].x, g = colors[i].y, b = colors[i].z;
        luminance[i] = core::inlined::max(red_light * r + green_light * g + blue_light * b, 0.0f);
        const float own = slopes[i];
        const float above = luma[i] - black;
        const float grey = at(grey_slopes, core::inlined::min(core::inlined::max(above, darkest), range));
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
    std::vector<float> slopes(static_cast<std::size_t>(light.width()));
    for (int y = 0; y < light.height(); ++y) {
        slopes_of(radiance.combined.row(y), slopes.data(), light.width());
        weigh(radiance.combined.row(y), light.luma.row(y), slopes.data(), light.luminance.row(y), light.exponent.row(y),
              light.width());
    }
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

}  // namespace render2mpeg::perceptual
