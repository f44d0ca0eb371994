#include "renderer/subsurface/profile.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace render2mpeg::renderer {
namespace {

constexpr float pi = std::numbers::pi_v<float>;

/// Beyond so many shaping lengths of the longest channel nothing is looked for. chosen: 16, beyond which 0.4 % of its
/// light leaves; what is lost there is given to the rest.
constexpr float reach_lengths = 16.0f;

/// Channels that reach less than this share of the farthest have so much: their light leaves where it enters, within a
/// pixel of the others' blur.
constexpr float least_share = 0.01f;

/// Share of a channel within `r`.
float within(float r, float d) {
    return 1.0f - 0.25f * std::exp(-r / d) - 0.75f * std::exp(-r / (3.0f * d));
}

}  // namespace

/// [Christensen2015, eq. 6]: shaping lengths of light that enters from all sides, as Cycles has them.
SubsurfaceProfile::SubsurfaceProfile(glm::vec3 albedo, glm::vec3 free_path) {
    float longest = 0.0f;
    for (int c = 0; c < 3; ++c) {
        const float a = std::clamp(albedo[c], 0.0f, 1.0f) - 0.8f;
        d_[static_cast<std::size_t>(c)] = std::max(free_path[c], 0.0f) / (1.1f - a + 3.5f * a * a);
        longest = std::max(longest, d_[static_cast<std::size_t>(c)]);
    }
    for (float& d : d_) d = std::max(d, least_share * longest);
    reach_ = reach_lengths * longest;
}

glm::vec3 SubsurfaceProfile::at(float distance) const {
    glm::vec3 result;
    for (int c = 0; c < 3; ++c) {
        const float d = d_[static_cast<std::size_t>(c)], r = std::max(distance, 1e-4f * d);
        result[c] = (std::exp(-r / d) + std::exp(-r / (3.0f * d))) / (8.0f * pi * d * r * within(reach_, d));
    }
    return distance <= reach_ ? result : glm::vec3(0);
}

float SubsurfaceProfile::sample(float number, float u) const {
    const float choice = 3.0f * number;
    const auto channel = std::min(static_cast<std::size_t>(choice), std::size_t{2});
    const float d = d_[channel];
    // A quarter goes by the short exponential; both end at the reach.
    const float length = choice - static_cast<float>(channel) < 0.25f ? d : 3.0f * d;
    return -length * std::log1p(-u * -std::expm1(-reach_ / length));
}

float SubsurfaceProfile::density(float distance) const {
    if (distance > reach_) return 0.0f;
    float sum = 0.0f;
    for (const float d : d_) {
        const float r = std::max(distance, 1e-4f * d);
        const float near = std::exp(-distance / d) / -std::expm1(-reach_ / d),
                    far = std::exp(-distance / (3.0f * d)) / -std::expm1(-reach_ / (3.0f * d));
        sum += (near + far) / (8.0f * pi * d * r);
    }
    return sum / 3.0f;
}

}  // namespace render2mpeg::renderer
