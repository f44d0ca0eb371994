#include "perceptual/motion_sensitivity.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "core/numeric.h"

namespace render2mpeg::perceptual {
namespace {

/// A picture's height as seen from three times as far, in degrees.
const double picture_degrees = 2 * std::atan(1.0 / 6.0) * 180.0 / 3.14159265358979323846;

/// Degrees per second on the retina for a target's degrees per second. [Daly1998, eq. 15]
double retinal(double speed) {
    constexpr double drift = 0.15, gain = 0.82, fastest = 80;
    return std::max(drift, speed - std::min(gain * speed + drift, fastest));
}

/// The cut-off of contrast sensitivity falls as 1 / (speed + 2). [Daly1998, eq. 11: rho_max]
double sensitivity_at(double speed) {
    constexpr double still = 0.15 + 2;
    return still / (retinal(speed) + 2);
}

}  // namespace

double motion_sensitivity(const core::MotionField& field, double hertz) {
    const auto frames = static_cast<double>(std::max<std::int64_t>(1, std::llabs(field.reference - field.picture)));
    const double degrees = picture_degrees / std::max(1, field.vector.height()) * hertz / frames;
    double sum = 0;
    for (std::size_t i = 0; i < field.vector.size(); ++i) {
        const glm::vec2 v = field.vector.values()[i];
        const double pixels = std::hypot(static_cast<double>(v.x), static_cast<double>(v.y));
        const bool known = field.kind.values()[i] != core::PixelClass::none && std::isfinite(pixels);
        sum += sensitivity_at(known ? pixels * degrees : 0.0);
    }
    return core::divide_or(sum, static_cast<double>(field.vector.size()), 1.0);
}

}  // namespace render2mpeg::perceptual
