#include "renderer/lights/photon_source.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

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

/// Cosine of the half angle in which a spot shines.
float outer_cosine(const LightPoint& l) {
    return std::clamp(core::divide_or(-l.spot_offset, l.spot_scale, -1.0f), -1.0f, 1.0f);
}

/// The rectangle across a direction that holds the box's shadow.
struct Shadow {
    glm::vec3 tangent, bitangent;
    glm::vec2 low{std::numeric_limits<float>::max()}, high{-std::numeric_limits<float>::max()};
    float start = std::numeric_limits<float>::max();  ///< of the box along the direction

    Shadow(glm::vec3 direction, const WorldBox& box) {
        core::make_frame(direction, tangent, bitangent);
        for (int c = 0; c < 8; ++c) {
            const glm::vec3 p{(c & 1) != 0 ? box.high.x : box.low.x, (c & 2) != 0 ? box.high.y : box.low.y,
                              (c & 4) != 0 ? box.high.z : box.low.z};
            const glm::vec2 q{glm::dot(p, tangent), glm::dot(p, bitangent)};
            low = glm::min(low, q);
            high = glm::max(high, q);
            start = std::min(start, glm::dot(p, direction));
        }
    }
    float area() const { return (high.x - low.x) * (high.y - low.y); }
};

}  // namespace

PhotonSource::PhotonSource(std::span<const LightPoint> lights, const WorldBox& box, std::span<const LightPoint> planned)
    : lights_(lights), box_(box) {
    EXPECTS(planned.empty() || planned.size() == lights.size());
    std::vector<double> plan;
    std::size_t shining = 0;
    for (std::size_t i = 0; i < lights.size(); ++i) {
        power_.push_back(power_of(lights[i]));
        const auto luminance = core::luminance(planned.empty() ? lights[i].intensity : planned[i].intensity);
        plan.push_back(power_.back() * static_cast<double>(luminance));
        total_ += plan.back();
        shining += plan.back() > 0.0 ? 1 : 0;
    }
    double sum = 0;
    running_.reserve(lights.size());
    for (const double power : plan) {
        if (power > 0.0) sum += (1.0 - alike) * (power / total_) + alike / static_cast<double>(shining);
        running_.push_back(sum);
    }
}

double PhotonSource::power_of(const LightPoint& light) const {
    switch (light.kind) {
        case LightPointKind::oriented:
            return pi;
        case LightPointKind::omni:
            return 4.0 * pi;
        // The cone at full strength: photons carry the falloff.
        case LightPointKind::spot:
            return 2.0 * pi * (1.0 - outer_cosine(light));
        case LightPointKind::directional:
            return Shadow(light.normal, box_).area();
    }
    return 0.0;
}

Photon PhotonSource::emit(glm::vec3 numbers) const {
    const glm::vec2 direction(numbers.y, numbers.z), &place = direction;
    Photon photon;
    if (empty()) return photon;
    const auto found =
        std::upper_bound(running_.begin(), running_.end(), static_cast<double>(numbers.x) * running_.back());
    const auto index = std::min<std::size_t>(static_cast<std::size_t>(found - running_.begin()), lights_.size() - 1);
    const LightPoint& light = lights_[index];
    // Power over probability, in the colour of the light.
    const double probability = (running_[index] - (index > 0 ? running_[index - 1] : 0.0)) / running_.back();
    photon.flux = light.intensity * static_cast<float>(core::divide_or(power_[index], probability, 0.0));
    photon.origin = light.position;
    photon.range = light.range;
    switch (light.kind) {
        case LightPointKind::oriented:
            photon.direction = core::sample_cosine_hemisphere(light.normal, direction);
            break;
        case LightPointKind::omni:
            photon.direction = core::sample_sphere(direction);
            break;
        case LightPointKind::spot: {
            const float cosine = 1.0f - direction.x * (1.0f - outer_cosine(light));
            const float sine = core::sqrt_or_zero(1.0f - cosine * cosine);
            const float phi = 2.0f * static_cast<float>(pi) * direction.y;
            glm::vec3 t, b;
            core::make_frame(light.normal, t, b);
            photon.direction = sine * std::cos(phi) * t + sine * std::sin(phi) * b + cosine * light.normal;
            photon.flux *= spot_falloff(cosine, light.spot_scale, light.spot_offset, light.spot_smooth);
            break;
        }
        case LightPointKind::directional: {
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
