#include "renderer/base/area_lamp.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace render2mpeg::renderer {
namespace {

/// Evenly by solid angle: 1 - cos grows as the disc's squared radius.
RENDER2MPEG_CLONES
void choose_in_cone(const LampView& __restrict view, const SampleNumbers& __restrict disc,
                    LampSamples& __restrict samples) {
    for (int i = 0; i < lane_count; ++i) {
        const float most = view.lowered[i], lowered = most * (disc.x[i] * disc.x[i] + disc.y[i] * disc.y[i]);
        const float scale = inlined::sqrt(inlined::max(most * (2.0f - lowered), 0.0f));
        const float along = 1.0f - lowered, x = scale * disc.x[i], y = scale * disc.y[i];
        samples.direction.x[i] =
            along * view.cone.axis.x[i] + x * view.cone.tangent.x[i] + y * view.cone.bitangent.x[i];
        samples.direction.y[i] =
            along * view.cone.axis.y[i] + x * view.cone.tangent.y[i] + y * view.cone.bitangent.y[i];
        samples.direction.z[i] =
            along * view.cone.axis.z[i] + x * view.cone.tangent.z[i] + y * view.cone.bitangent.z[i];
        samples.inverse_density[i] = 2.0f * std::numbers::pi_v<float> * most;
    }
}

/// By the chord, since cosines of narrow cones have no digits.
RENDER2MPEG_CLONES
void meet_cone(const LampView& __restrict view, LampSamples& __restrict samples) {
    for (int i = 0; i < lane_count; ++i) {
        const Vec3Lanes& d = samples.direction;
        const float x = d.x[i] - view.cone.axis.x[i], y = d.y[i] - view.cone.axis.y[i],
                    z = d.z[i] - view.cone.axis.z[i];
        const bool meets = x * x + y * y + z * z <= 2.0f * view.lowered[i];
        samples.inverse_density[i] = meets ? 2.0f * std::numbers::pi_v<float> * view.lowered[i] : 0.0f;
    }
}

}  // namespace

void AreaLamp::choose(const LampView& view, const SampleNumbers& disc, LampSamples& samples) const {
    choose_in_cone(view, disc, samples);
}

void AreaLamp::meet(const LampView& view, LampSamples& samples) const {
    meet_cone(view, samples);
}

void AreaLamp::span(LampView& view, int lane, glm::vec3 axis, float sine) {
    put_frame(view.cone, lane, axis);
    view.lowered[lane] = sine * sine / (1 + core::sqrt_or_zero(1 - sine * sine));
}

double cone_irradiance(double cosine, double sine_squared) {
    if (!(sine_squared > 0)) return 0;
    sine_squared = std::min(sine_squared, 1.0);
    if (cosine * cosine >= sine_squared) return std::numbers::pi * sine_squared * std::max(cosine, 0.0);
    const double sine = std::sqrt(std::max(1 - cosine * cosine, 0.0));
    const double x = std::sqrt(1 / sine_squared - 1), y = std::clamp(-x * cosine / sine, -1.0, 1.0);
    const double across = sine * std::sqrt(1 - y * y);
    return std::max((cosine * std::acos(y) - x * across) * sine_squared + std::atan2(across, x), 0.0);
}

}  // namespace render2mpeg::renderer
