#include "renderer/lights/photon_source.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/box.h"
#include "core/color.h"
#include "core/error.h"
#include "core/numeric.h"
#include "core/sampling.h"

namespace render2mpeg::renderer {
namespace {

constexpr double pi = std::numbers::pi;

/// Share of the photons that all lights have alike, whatever their power: a defensive mixture [Hesterberg1995].
/// chosen: 0.1 of 0.03..0.3; no photon weighs more than 1 / 0.9 of what it would without.
constexpr double alike = 0.1;

/// The rectangle across a direction that holds the box's shadow.
struct Shadow {
    glm::vec3 tangent, bitangent;
    glm::vec2 low{std::numeric_limits<float>::max()}, high{-std::numeric_limits<float>::max()};
    float start = std::numeric_limits<float>::max();  ///< of the box along the direction

    Shadow(glm::vec3 direction, const core::Box& box) {
        core::make_frame(direction, tangent, bitangent);
        for (int c = 0; c < 8; ++c) {
            const glm::vec3 p = box.corner(c);
            const glm::vec2 q{glm::dot(p, tangent), glm::dot(p, bitangent)};
            low = glm::min(low, q);
            high = glm::max(high, q);
            start = std::min(start, glm::dot(p, direction));
        }
    }
    float area() const { return (high.x - low.x) * (high.y - low.y); }
};

}  // namespace

PhotonSource::PhotonSource(std::span<const LightPoint> lights, const core::Box& box,
                           std::span<const LightPoint> planned)
    : lights_(lights), box_(box) {
    EXPECTS(planned.empty() || planned.size() == lights.size());
    std::vector<double> plan;
    std::size_t shining = 0;
    double total = 0;
    for (std::size_t i = 0; i < lights.size(); ++i) {
        power_.push_back(power_of(lights[i]));
        const auto luminance = core::luminance(planned.empty() ? lights[i].intensity : planned[i].intensity);
        plan.push_back(power_.back() * static_cast<double>(luminance));
        total += plan.back();
        shining += plan.back() > 0.0 ? 1 : 0;
    }
    for (const double power : plan)
        choice_.add(power > 0.0 ? (1.0 - alike) * (power / total) + alike / static_cast<double>(shining) : 0.0);
}

double PhotonSource::power_of(const LightPoint& light) const {
    if (light.is_of_surface()) return pi;
    if (light.is_far()) return Shadow(light.normal, box_).area();
    // The cone at full strength: photons carry the falloff.
    return 2.0 * pi * (1.0 - light.spot.outer_cosine());
}

Photon PhotonSource::emit(glm::vec3 numbers) const {
    const glm::vec2 direction(numbers.y, numbers.z), &place = direction;
    Photon photon;
    if (empty()) return photon;
    const std::size_t index = choice_.pick(static_cast<double>(numbers.x));
    const LightPoint& light = lights_[index];
    // Power over probability, in the colour of the light.
    const double probability = choice_.chance(index);
    photon.flux = light.intensity * static_cast<float>(core::divide_or(power_[index], probability, 0.0));
    photon.origin = light.position;
    photon.range = light.range;
    switch (light.type) {
        case LightType::oriented:
            photon.direction = core::sample_cosine_hemisphere(light.normal, direction);
            break;
        case LightType::punctual:
            photon.direction = core::sample_cone(light.normal, 1.0f - light.spot.outer_cosine(), direction);
            photon.flux *= light.spot.falloff(glm::dot(photon.direction, light.normal));
            break;
        case LightType::directional: {
            const Shadow shadow(light.normal, box_);
            const glm::vec2 q = shadow.low + place * (shadow.high - shadow.low);
            const float before = 0.01f * (shadow.high.x - shadow.low.x + shadow.high.y - shadow.low.y);
            photon.origin = q.x * shadow.tangent + q.y * shadow.bitangent + (shadow.start - before) * light.normal;
            photon.direction = light.normal;
            photon.from_far = true;
            break;
        }
    }
    return photon;
}

}  // namespace render2mpeg::renderer
