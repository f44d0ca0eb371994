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

/// A rectangle is seen from a point if it is farther off than this share of its own size; else photons go all around.
constexpr float least_distance = 0.1f;

}  // namespace

SeenBox seen_from(const LightPoint& light, const BoxCorners& corners) {
    SeenBox seen;
    for (const glm::vec3& corner : corners) seen.middle += corner / 8.0f;
    const bool far = light.is_far();
    seen.towards = far ? light.normal : core::normalize_or(seen.middle - light.position, glm::vec3{0, 0, 1});
    // Lay the rectangle along the box's longest edge, as it is seen.
    glm::vec3 longest{0.0f};
    for (const std::size_t axis : {1u, 2u, 4u}) {
        const glm::vec3 edge = corners[axis] - corners[0];
        const glm::vec3 across = edge - glm::dot(edge, seen.towards) * seen.towards;
        if (glm::dot(across, across) > glm::dot(longest, longest)) longest = across;
    }
    glm::vec3 right, up;
    core::make_frame(seen.towards, right, up);
    seen.right = core::normalize_or(longest, right);
    seen.up = glm::cross(seen.towards, seen.right);
    glm::vec2 low(std::numeric_limits<float>::max()), high(std::numeric_limits<float>::lowest());
    const float distance = far ? 1.0f : glm::distance(seen.middle, light.position);
    float size = 0;
    for (const glm::vec3& corner : corners) size = std::max(size, glm::distance(corner, seen.middle));
    for (const glm::vec3& corner : corners) {
        glm::vec3 at = corner - seen.middle;
        if (!far) {
            const float ahead = glm::dot(corner - light.position, seen.towards);
            if (!(ahead > least_distance * size)) seen.all_around = true;
            // As seen in the plane through the middle.
            at = (corner - light.position) * (distance / std::max(ahead, least_distance * size)) -
                 distance * seen.towards;
        }
        const glm::vec2 q(glm::dot(at, seen.right), glm::dot(at, seen.up));
        low = glm::min(low, q);
        high = glm::max(high, q);
    }
    const glm::vec2 centre = 0.5f * (low + high);
    seen.middle += centre.x * seen.right + centre.y * seen.up;
    // Things without thickness are still met.
    seen.half = glm::max(0.5f * (high - low), glm::vec2(1e-6f * size));
    return seen;
}

PhotonSource::PhotonSource(std::span<const LightPoint> lights, const core::Box& box,
                           std::span<const LightPoint> planned)
    : lights_(lights), reach_(glm::length(box.size())) {
    for (std::size_t c = 0; c < box_.size(); ++c) box_[c] = box.corner(static_cast<int>(c));
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
    if (light.is_far()) return seen_from(light, box_).area();
    // The cone at full strength: photons carry the falloff.
    return 2.0 * pi * (1.0 - light.spot.outer_cosine());
}

Photon PhotonSource::emit(glm::vec3 numbers) const {
    const glm::vec2 direction(numbers.y, numbers.z);
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
        case LightType::directional:
            photon.origin = seen_from(light, box_).at(direction) - reach_ * light.normal;
            photon.direction = light.normal;
            photon.from_far = true;
            break;
    }
    return photon;
}

}  // namespace render2mpeg::renderer
