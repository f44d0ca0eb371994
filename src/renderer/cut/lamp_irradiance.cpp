#include "renderer/cut/lamp_irradiance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/error.h"

namespace render2mpeg::renderer {
namespace {

/// Clipping a convex polygon by a plane adds one corner at most.
constexpr std::size_t most_corners = 16;

/// Below this share of the product of its ends' lengths, an edge spans no angle that double precision could tell.
constexpr double no_angle = 1e-12;

}  // namespace

double polygon_irradiance(std::span<const glm::vec3> corners, glm::vec3 place, glm::vec3 normal) {
    EXPECTS_DEBUG(corners.size() + 1 < most_corners);
    const glm::dvec3 x(place), n(normal);
    // Keep what is above the horizon.
    std::array<glm::dvec3, most_corners> above;
    std::size_t count = 0;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const glm::dvec3 a = glm::dvec3(corners[i]) - x, b = glm::dvec3(corners[(i + 1) % corners.size()]) - x;
        const double height_a = glm::dot(n, a), height_b = glm::dot(n, b);
        if (height_a > 0) above[count++] = a;
        if ((height_a > 0) != (height_b > 0)) above[count++] = a + (b - a) * (height_a / (height_a - height_b));
    }
    double sum = 0;
    for (std::size_t i = 0; count >= 3 && i < count; ++i) {
        const glm::dvec3 a = above[i], b = above[(i + 1) % count], across = glm::cross(a, b);
        const double sine = glm::length(across);
        if (sine <= no_angle * glm::length(a) * glm::length(b)) continue;
        sum += std::atan2(sine, glm::dot(a, b)) / sine * glm::dot(across, n);
    }
    return std::min(0.5 * std::abs(sum), std::numbers::pi);
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

float unoccluded_irradiance(const AreaLamp& lamp, glm::vec3 place, glm::vec3 normal) {
    if (lamp.kind == AreaLamp::Kind::sun)
        return static_cast<float>(cone_irradiance(glm::dot(glm::dvec3(lamp.position), glm::dvec3(normal)),
                                                  double{lamp.radius} * lamp.radius));
    if (lamp.kind == AreaLamp::Kind::polygon) {
        const bool in_front =
            glm::dot(glm::dvec3(place) - glm::dvec3(lamp.corners.front()), glm::dvec3(lamp.normal)) > 0;
        return in_front || lamp.two_sided ? static_cast<float>(polygon_irradiance(lamp.corners, place, normal)) : 0.0f;
    }
    const glm::dvec3 to_lamp = glm::dvec3(lamp.position) - glm::dvec3(place);
    const double distance = glm::length(to_lamp);
    if (!(distance > lamp.radius)) return 0;
    const double sine = lamp.radius / distance;
    return static_cast<float>(cone_irradiance(glm::dot(to_lamp, glm::dvec3(normal)) / distance, sine * sine));
}

}  // namespace render2mpeg::renderer
