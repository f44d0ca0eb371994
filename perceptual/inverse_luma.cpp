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

/// The grey light, exposed, that has this signal.
double neutral_grey(double signal) {
    const double linear = core::srgb_to_linear(signal);
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
    darkest_light_ = std::exp2(at(log_light_, darkest)) / gain_;
    darkest_step_ =
        view_ ? std::exp2(at(log_light_, 0.5f)) / gain_ : 0.5f / (range * core::srgb_slope_at_black * gain_);
}

float InverseLuma::slope_of(glm::vec3 color) const {
    if (!view_) {
        const SignalCurve& curve = SignalCurve::instance();
        return weights_.x * curve.point(color.x * gain_).log_slope +
               weights_.y * curve.point(color.y * gain_).log_slope +
               weights_.z * curve.point(color.z * gain_).log_slope;
    }
    const ShownLight shown = view_->show(color * gain_);
    // White has no slope: it is taken for the grey that just is white, which may fall least.
    const bool white = std::min({shown.signal.x, shown.signal.y, shown.signal.z}) >= 1.0f;
    return white ? 0.0f : glm::dot(weights_, shown.log_slope);
}

PixelLight InverseLuma::light_of(const core::Picture& picture, const core::Radiance& radiance) const {
    EXPECTS(picture.luma.width() == radiance.combined.width() && picture.luma.height() == radiance.combined.height());
    PixelLight light;
    light.luma = picture.luma;
    light.luminance = core::Plane<float>(picture.luma.width(), picture.luma.height());
    light.exponent = core::Plane<float>(picture.luma.width(), picture.luma.height(), 1.0f);
    for (std::size_t i = 0; i < light.luma.size(); ++i) {
        const glm::vec3 color = radiance.combined.values()[i];
        light.luminance.values()[i] = std::max(core::luminance(color), 0.0f);
        const float slope = slope_of(color), above = light.luma.values()[i] - black;
        // Very dark colours, and those without a slope, are taken for grey.
        if (above > darkest && slope > 0.0f)
            light.exponent.values()[i] =
                std::clamp(at(grey_slope_, std::min(above, range)) / slope, least_exponent, largest_exponent);
    }
    return light;
}

}  // namespace render2mpeg::perceptual
