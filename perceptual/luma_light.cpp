#include "perceptual/luma_light.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include "core/color.h"
#include "core/error.h"
#include "core/numeric.h"
#include "perceptual/signal_curve.h"

namespace render2mpeg::perceptual {
namespace {

constexpr float black = 16.0f, range = 219.0f;

/// chosen: 16 per code value keeps the table within 1 % of the curve from a quarter of a code value above black on
/// (4..64 tried).
constexpr float entries_per_code = 16.0f;
constexpr auto entries = static_cast<std::size_t>(range * entries_per_code) + 1;

/// Less than this above black counts as this: the logarithm of black is nothing to calculate with.
constexpr float darkest = 0.25f;

/// Colours whose channels all lie at the ends of the curve have no slope; no other colour is beyond these limits by
/// more than it would be at them. chosen: what 10^6 random colours stay in (0.05..20 tried).
constexpr float least_exponent = 0.2f, largest_exponent = 5.0f;

/// 2^x for |x| < 120 by its exponent and a polynomial for the rest, right to 3e-7: std::exp2 in a loop is not
/// vectorised. chosen: the polynomial that meets (2^t - 1) / t in five Chebyshev points of [0, 1].
float power_of_two(float x) {
    const float clamped = std::clamp(x, -120.0f, 120.0f);
    const auto whole = static_cast<std::int32_t>(clamped + 128.0f) - 128;
    const float t = clamped - static_cast<float>(whole);
    const float p =
        1.0f + t * (0.69314757f + t * (0.24020719f + t * (0.055657054f + t * (0.0091993876f + t * 0.0017883687f))));
    return p * std::bit_cast<float>((whole + 127) << 23);
}

}  // namespace

LumaLight::LumaLight(const Display& display)
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
}

float LumaLight::at(const std::vector<float>& table, float above_black) {
    const float place = above_black * entries_per_code;
    const auto i = static_cast<std::uint32_t>(place);
    const float t = place - static_cast<float>(i);
    return table[i] + t * (table[i + 1] - table[i]);
}

PixelLight LumaLight::light_of(const core::Picture& picture, const core::Radiance& radiance) const {
    EXPECTS(picture.luma.width() == radiance.combined.width() && picture.luma.height() == radiance.combined.height());
    const SignalCurve& curve = SignalCurve::instance();
    PixelLight light;
    light.luma = picture.luma;
    light.luminance = light.exponent = core::Plane<float>(picture.luma.width(), picture.luma.height(), 0.0f);
    for (std::size_t i = 0; i < light.luma.size(); ++i) {
        const glm::vec3 c = radiance.combined.values()[i];
        light.luminance.values()[i] = std::max(core::luminance(c), 0.0f);
        light.exponent.values()[i] = 1.0f;
        if (!(light.luma.values()[i] - black > darkest)) continue;  // taken for grey
        const float above = std::clamp(light.luma.values()[i] - black, darkest, range);
        const float own = weights_.x * curve.point(c.x * gain_).log_slope +
                          weights_.y * curve.point(c.y * gain_).log_slope +
                          weights_.z * curve.point(c.z * gain_).log_slope;
        const float grey = at(grey_slope_, above);
        light.exponent.values()[i] = std::clamp(core::divide_or(grey, own, 1.0f), least_exponent, largest_exponent);
    }
    return light;
}

float LumaLight::difference(float luma, float luminance, float exponent, float distance) const {
    // The curve from luma to light is bent upwards: downward is nearer, where it is not cut off by black.
    const float from = std::clamp(luma - black, darkest, range);
    const float to = from - distance < darkest ? from + distance : from - distance;
    const float here = at(log_light_, from);
    // What is black has no light to multiply, and is taken for grey.
    const float least = from > darkest ? 0.0f : power_of_two(here) / gain_;
    const float ratio = power_of_two(exponent * (at(log_light_, std::min(to, range)) - here));
    return std::max(luminance, least) * std::abs(ratio - 1.0f);
}

float LumaLight::darkest_step() const {
    return 0.5f / (range * 4.5f * gain_);
}

}  // namespace render2mpeg::perceptual
