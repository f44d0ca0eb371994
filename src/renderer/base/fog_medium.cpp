#include "renderer/base/fog_medium.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/numeric.h"

namespace render2mpeg::renderer {
namespace {

constexpr float without_end = std::numeric_limits<float>::infinity();

/// Fog far below its height is so many times as dense at most. chosen: 2^20, in which nothing is seen of anything.
constexpr float most_density = 0x1p20f;

/// (1 - e^-k) / k for k >= 0.
float mean_falloff(float k) {
    return k < 1e-6f ? 1.0f : -std::expm1(-k) / k;
}

/// How far a ray goes in a box.
float way_in_box(glm::vec3 from, glm::vec3 direction, glm::vec3 low, glm::vec3 high) {
    float near = 0, far = without_end;
    for (int c = 0; c < 3; ++c) {
        if (direction[c] == 0.0f) {
            if (from[c] < low[c] || from[c] > high[c]) return 0;
            continue;
        }
        const float a = (low[c] - from[c]) / direction[c], b = (high[c] - from[c]) / direction[c];
        near = std::max(near, std::min(a, b));
        far = std::min(far, std::max(a, b));
    }
    return std::max(far - near, 0.0f);
}

}  // namespace

FogMedium::FogMedium(const core::Fog& fog, glm::vec3 low, glm::vec3 high) : fog_(fog), low_(low), high_(high) {
    const glm::vec3 sides = high - low;
    const glm::vec3 more = glm::max(std::max({sides.x, sides.y, sides.z}) / 16.0f - sides, glm::vec3(0)) * 0.5f;
    if (core::is_finite(more)) {
        low_ -= more;
        high_ += more;
    }
    // Contrast falls with the transmittance [Koschmieder1924], to 5 % = e^-3.
    extinction_ = 3.0f / std::max(fog.visibility, core::least_visibility);
}

float FogMedium::density(float y) const {
    return std::min(std::exp((fog_.height - y) / fog_.falloff), most_density);
}

float FogMedium::extinction(float y) const {
    return fog_.falloff > 0.0f ? extinction_ * density(y) : extinction_;
}

float FogMedium::optical_depth(glm::vec3 from, glm::vec3 direction, float distance) const {
    if (!(distance > 0.0f)) return 0.0f;
    if (!(fog_.falloff > 0.0f)) return extinction_ * distance;
    // From the lower end up, so that nothing overflows.
    const float rise = std::abs(direction.y);
    if (std::isinf(distance)) {
        if (direction.y > 0.0f) return extinction_ * density(from.y) * (fog_.falloff / rise);
        return direction.y < 0.0f || density(from.y) > 0.0f ? without_end : 0.0f;
    }
    const float lowest = std::min(from.y, from.y + distance * direction.y);
    return extinction_ * density(lowest) * distance * mean_falloff(distance * rise / fog_.falloff);
}

float FogMedium::depth_to_sky(glm::vec3 from, glm::vec3 direction) const {
    if (fog_.falloff > 0.0f && direction.y > 0.0f) return optical_depth(from, direction, without_end);
    const float way = way_in_box(from, direction, low_, high_);
    return optical_depth(from, direction, std::min(way, std::numeric_limits<float>::max()));
}

float FogMedium::distance_at(glm::vec3 from, glm::vec3 direction, float depth) const {
    if (!(depth > 0.0f)) return 0.0f;
    if (!(fog_.falloff > 0.0f)) return depth / extinction_;
    const float here = extinction_ * density(from.y), k = direction.y / fog_.falloff;
    if (!(here > 0.0f) && !(direction.y < 0.0f)) return without_end;
    // depth = here (1 - e^(-k s)) / k
    const float x = here > 0.0f ? k * depth / here : -without_end;
    if (std::abs(x) < 1e-6f) return depth / here;
    if (x >= 1.0f) return without_end;
    if (x > -1e30f) return -std::log1p(-x) / k;
    // Far above: only what is near the height counts, whence log(1 - x) = log(-x).
    return -(std::log(-direction.y * depth / (fog_.falloff * extinction_)) + (from.y - fog_.height) / fog_.falloff) / k;
}

float phase(float g, float cosine) {
    const float base = std::max(1.0f + g * g - 2.0f * g * cosine, 1e-6f);
    return (1.0f - g * g) / (4.0f * std::numbers::pi_v<float> * base * std::sqrt(base));
}

}  // namespace render2mpeg::renderer
