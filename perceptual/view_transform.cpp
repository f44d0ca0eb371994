// Filmic and AgX share one form: light on a logarithmic scale of 16.5 stops, and on it a sigmoid of two arms that meet
// at a pivot [AgX]. Their constants are fitted to Blender's output (docs/measurements.md#views).
#include "perceptual/view_transform.h"

#include <algorithm>
#include <cmath>

#include "core/color.h"
#include "core/error.h"
#include "perceptual/signal_curve.h"

namespace render2mpeg::perceptual {
namespace {

/// log2 of the light that is black and white on the logarithmic scale: 10 stops below 0.18, and 6.5 above. [AgX]
constexpr double darkest_stop = -12.473931188, brightest_stop = 4.026068812;

/// Parameters of a sigmoid over [0, 1]: where both arms meet, the slope there, and how sharply each bends.
struct Sigmoid {
    double x, y, slope, toe, shoulder;
};

// fit: docs/measurements.md#views
constexpr Sigmoid filmic{0.6156, 0.5215, 2.1672, 2.5374, 3.0992};
constexpr Sigmoid very_high_contrast{0.6082, 0.5074, 3.2860, 2.9248, 2.7394};
constexpr Sigmoid high_contrast{0.6069, 0.5032, 2.8101, 2.7511, 3.0446};
constexpr Sigmoid medium_high_contrast{0.6103, 0.5128, 2.4956, 2.6492, 2.7113};
constexpr Sigmoid medium_low_contrast{0.6361, 0.5582, 1.9468, 2.5861, 2.6867};
constexpr Sigmoid low_contrast{0.6270, 0.5356, 1.7293, 2.2527, 3.0726};
constexpr Sigmoid very_low_contrast{0.5943, 0.4807, 1.5492, 1.7150, 4.4011};
constexpr Sigmoid agx{0.6219, 0.5192, 2.3359, 1.6253, 1.3400};

/// AgX's sigmoid is that of a display of this power, as in Blender's own configuration.
constexpr double agx_power = 2.4;

const Sigmoid& sigmoid_of(core::ViewName name) {
    switch (name) {
        case core::ViewName::filmic_very_high_contrast:
            return very_high_contrast;
        case core::ViewName::filmic_high_contrast:
            return high_contrast;
        case core::ViewName::filmic_medium_high_contrast:
            return medium_high_contrast;
        case core::ViewName::filmic_medium_low_contrast:
            return medium_low_contrast;
        case core::ViewName::filmic_low_contrast:
            return low_contrast;
        case core::ViewName::filmic_very_low_contrast:
            return very_low_contrast;
        case core::ViewName::agx:
            return agx;
        default:
            return filmic;
    }
}

/// One arm, away from the pivot: through 0 with `slope`, and through (width, height). y = scale u / (1 + u^p)^(1 / p)
/// with u = slope x / scale.
struct Arm {
    double slope, power, scale;

    Arm(double width, double height, double slope_at_pivot, double bend) : slope(slope_at_pivot), power(bend) {
        scale = std::pow(std::pow(slope * width, -power) * (std::pow(slope * width / height, power) - 1), -1 / power);
    }
    double at(double x) const {
        const double u = slope * x / scale;
        return scale * u * std::pow(1 + std::pow(u, power), -1 / power);
    }
    double inverse(double y) const {
        const double v = y / scale;
        return scale / slope * v * std::pow(1 - std::pow(v, power), -1 / power);
    }
};

/// A sigmoid and its inverse, each from [0, 1] to [0, 1].
double raised(const Sigmoid& s, double x) {
    return x < s.x ? std::max(0.0, s.y - Arm(s.x, s.y, s.slope, s.toe).at(s.x - x))
                   : s.y + Arm(1 - s.x, 1 - s.y, s.slope, s.shoulder).at(x - s.x);
}
double lowered(const Sigmoid& s, double y) {
    return y < s.y ? s.x - Arm(s.x, s.y, s.slope, s.toe).inverse(s.y - y)
                   : s.x + Arm(1 - s.x, 1 - s.y, s.slope, s.shoulder).inverse(y - s.y);
}

/// Light that the curves of high dynamic range take for infinite: their tables end there. chosen: 12 stops above
/// white, 0.04 % below the display's.
constexpr double hdr_brightest = 4096;

/// What exposed light of 1 is shown as: the reference white of [BT2408, table 1], in cd/m^2 and as HLG's scene light.
constexpr double pq_white = core::least_peak, hlg_white = 0.264963;

/// [BT2100, table 4]: signal of a display's light, 1 being 10,000 cd/m^2, and back.
constexpr double pq_m1 = 2610.0 / 16384, pq_m2 = 2523.0 / 32, pq_c1 = 107.0 / 128, pq_c2 = 2413.0 / 128,
                 pq_c3 = 2392.0 / 128, pq_brightest = 10000;
double pq(double light) {
    const double y = std::pow(light, pq_m1);
    return std::pow((pq_c1 + pq_c2 * y) / (1 + pq_c3 * y), pq_m2);
}
double inverse_pq(double signal) {
    const double v = std::pow(signal, 1 / pq_m2);
    return std::pow(std::max(v - pq_c1, 0.0) / (pq_c2 - pq_c3 * v), 1 / pq_m1);
}

/// [BT2100, table 5]: signal of a scene's light, and back.
constexpr double hlg_a = 0.17883277, hlg_b = 0.28466892, hlg_c = 0.55991073;
double hlg(double light) {
    return light <= 1.0 / 12 ? std::sqrt(3 * light) : hlg_a * std::log(12 * light - hlg_b) + hlg_c;
}
double inverse_hlg(double signal) {
    return signal <= 0.5 ? signal * signal / 3 : (std::exp((signal - hlg_c) / hlg_a) + hlg_b) / 12;
}

/// The curve of one channel; AgX's gives a display's light, which is still to mix.
double curve(const core::View& view, double light) {
    const core::ViewName name = view.name;
    if (name == core::ViewName::standard) return core::linear_to_srgb(std::min(light, 1.0));
    if (name == core::ViewName::pq) return pq(tone_curve(light * pq_white / view.peak) * view.peak / pq_brightest);
    if (name == core::ViewName::hlg) return hlg(tone_curve(light * hlg_white));
    const double place = (std::log2(light) - darkest_stop) / (brightest_stop - darkest_stop);
    const double shown = raised(sigmoid_of(name), std::clamp(place, 0.0, 1.0));
    return name == core::ViewName::agx ? std::pow(shown, agx_power) : shown;
}
double inverse_curve(const core::View& view, double signal) {
    const core::ViewName name = view.name;
    if (name == core::ViewName::standard) return core::srgb_to_linear(signal);
    if (view.is_hdr()) {
        const bool is_pq = name == core::ViewName::pq;
        const double shown = is_pq ? inverse_pq(signal) * pq_brightest / view.peak : inverse_hlg(signal);
        const double white = is_pq ? pq_white / view.peak : hlg_white;
        return shown < 1 ? std::min(inverse_tone_curve(shown) / white, hdr_brightest) : hdr_brightest;
    }
    if (name == core::ViewName::agx) signal = std::pow(core::srgb_to_linear(signal), 1 / agx_power);
    return std::exp2(darkest_stop + (brightest_stop - darkest_stop) * lowered(sigmoid_of(name), signal));
}

/// BT.709's primaries in those of [BT2020]: [BT2087, table 4].
const glm::mat3 bt2020_of_bt709{
    {0.627404f, 0.069097f, 0.016391f}, {0.329283f, 0.919540f, 0.088013f}, {0.043313f, 0.011362f, 0.895595f}};

// Filmic moves channels towards the largest one where that is next to white: by the share a M^p - b of their distance.
// fit: docs/measurements.md#views
constexpr float desaturation = 5.7231e-5f, desaturation_power = 1.13548f, desaturation_offset = 9.9007e-4f;

/// Where that begins, and where all is white.
constexpr float desaturated_from = 12.32f;

/// How AgX's channels mix before its curve and after it. Rows sum to 1, so that grey stays grey.
// fit: docs/measurements.md#views
const glm::mat3 agx_inset{
    {0.58678f, 0.12191f, 0.09952f}, {0.31511f, 0.75954f, 0.20582f}, {0.09811f, 0.11855f, 0.69466f}};
const glm::mat3 agx_outset{
    {1.81007f, -0.22760f, -0.20082f}, {-0.63384f, 1.28860f, -0.33440f}, {-0.17623f, -0.06100f, 1.53522f}};

/// Of the line below the table, which ends at 2^-24.
float slope_at_black(const core::View& view) {
    if (view.name == core::ViewName::standard) return core::srgb_slope_at_black;
    return view.is_hdr() ? static_cast<float>(std::exp2(24) * curve(view, std::exp2(-24))) : 0.0f;
}

/// Signal of one channel of a display's light.
struct Signal {
    float value;
    float slope;  ///< derivative by the light
};
Signal signal_of(float light) {
    constexpr float end_of_line = 0.0031308f;
    if (light <= end_of_line) return {12.92f * std::max(light, 0.0f), 12.92f};
    const float power = std::pow(std::min(light, 1.0f), 1.0f / 2.4f);
    return {1.055f * power - 0.055f, 1.055f / 2.4f * power / std::min(light, 1.0f)};
}

float cut(float light) {
    return light > 0.0f ? std::min(light, SignalCurve::brightest) : 0.0f;
}

}  // namespace

ViewTransform::ViewTransform(const core::View& view)
    : view_(view),
      white_(view.is_hdr()                           ? hdr_brightest
             : view.name == core::ViewName::standard ? 1.0
                                                     : std::exp2(brightest_stop)),
      table_([&](double light) { return curve(view, light); }, slope_at_black(view)) {
    EXPECTS(view.name != core::ViewName::neutral && view.gamma >= core::least_gamma &&
            view.gamma <= core::largest_gamma && view.peak >= core::least_peak && view.peak <= core::largest_peak);
    end_slope_ = table_.point(static_cast<float>(white_ * 0.99)).log_slope;
}

ShownLight ViewTransform::mix(glm::vec3 exposed) const {
    const glm::vec3 light{cut(exposed.x), cut(exposed.y), cut(exposed.z)};
    if (view_.name == core::ViewName::standard) return {light, glm::vec3(1)};
    if (view_.is_hdr()) return {bt2020_of_bt709 * light, glm::vec3(1)};
    if (view_.name == core::ViewName::agx) return {agx_inset * light, glm::vec3(1)};
    const float largest = std::max({light.x, light.y, light.z});
    if (largest <= desaturated_from) return {light, glm::vec3(1)};
    const float power = desaturation * std::pow(largest, desaturation_power);
    const float share = std::clamp(power - desaturation_offset, 0.0f, 1.0f);
    const glm::vec3 rest = glm::vec3(largest) - light, mixed = light + share * rest;
    // share < 1 as long as a channel is below white: 1 is reached at 5500.
    return {mixed, glm::vec3(1) + desaturation_power * power * rest / mixed};
}

/// The slope of the curve by the logarithm of its light; beyond white it falls to 0 within a factor of 2. sRGB's slope
/// rises up to white: there a fall of the light by half at most never lowers the signal by more than slope times
/// logarithm. The others are flat at white.
float ViewTransform::falls(float mixed) const {
    const float beyond = mixed / static_cast<float>(white_);
    // The table's last piece before white may be bent by the pieces behind it.
    if (beyond < 0.99f) return table_.point(mixed).log_slope;
    return end_slope_ * std::clamp(1.0f - std::log2(beyond), 0.0f, 1.0f);
}

glm::vec3 ViewTransform::signals(glm::vec3 exposed) const {
    const glm::vec3 light = mix(exposed).signal;
    glm::vec3 signal{table_.signal(light.x), table_.signal(light.y), table_.signal(light.z)};
    if (view_.name == core::ViewName::agx) {
        signal = agx_outset * signal;
        for (int c = 0; c < 3; ++c) signal[c] = signal_of(signal[c]).value;
    }
    signal = glm::clamp(signal, 0.0f, 1.0f);
    return view_.gamma == 1.0f ? signal : glm::pow(signal, glm::vec3(1.0f / view_.gamma));
}

ShownLight ViewTransform::show(glm::vec3 exposed) const {
    const ShownLight mixed = mix(exposed);
    ShownLight shown;
    for (int c = 0; c < 3; ++c) {
        shown.signal[c] = table_.signal(mixed.signal[c]);
        shown.log_slope[c] = falls(mixed.signal[c]) * mixed.log_slope[c];
    }
    if (view_.name == core::ViewName::agx) {
        shown.signal = agx_outset * shown.signal;
        shown.log_slope = agx_outset * shown.log_slope;
        for (int c = 0; c < 3; ++c) {
            const Signal channel = signal_of(shown.signal[c]);
            shown.signal[c] = channel.value;
            shown.log_slope[c] *= channel.slope;
        }
    }
    for (int c = 0; c < 3; ++c) {
        // A signal clipped at black has slope 0.
        if (shown.signal[c] <= 0.0f) shown.log_slope[c] = 0.0f;
        shown.signal[c] = std::clamp(shown.signal[c], 0.0f, 1.0f);
        if (view_.gamma == 1.0f || shown.signal[c] <= 0.0f) continue;
        const float raised_signal = std::pow(shown.signal[c], 1.0f / view_.gamma);
        shown.log_slope[c] *= raised_signal / (view_.gamma * shown.signal[c]);
        shown.signal[c] = raised_signal;
    }
    return shown;
}

double ViewTransform::grey_light(double signal) const {
    return inverse_curve(view_, std::pow(std::clamp(signal, 0.0, 1.0), static_cast<double>(view_.gamma)));
}

glm::vec3 ViewTransform::luminances(glm::vec3 exposed) const {
    EXPECTS(view_.name == core::ViewName::pq);
    const glm::vec3 light = mix(exposed).signal;
    glm::vec3 shown;
    for (int c = 0; c < 3; ++c)
        shown[c] = static_cast<float>(tone_curve(static_cast<double>(light[c]) * pq_white / view_.peak) * view_.peak);
    return shown;
}

glm::vec3 ViewTransform::shown_light(glm::vec3 signals) const {
    EXPECTS(view_.is_hdr());
    static const glm::mat3 bt709_of_bt2020 = glm::inverse(bt2020_of_bt709);
    const bool is_pq = view_.name == core::ViewName::pq;
    glm::vec3 light;
    for (int c = 0; c < 3; ++c) {
        const auto signal = static_cast<double>(signals[c]);
        light[c] =
            static_cast<float>(is_pq ? inverse_pq(signal) * pq_brightest / pq_white : inverse_hlg(signal) / hlg_white);
    }
    return bt709_of_bt2020 * light;
}

}  // namespace render2mpeg::perceptual
