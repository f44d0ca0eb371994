#include "scene/model/projection.h"

#include <cmath>
#include <cstdio>
#include <limits>

namespace render2mpeg::scene {
namespace {

constexpr double turn = 2 * std::numbers::pi;

}  // namespace

std::string text_of(const SphereWindow& window) {
    char text[64];
    const glm::dvec2 angles = glm::degrees(glm::dvec2(window.east - window.west, window.north - window.south));
    std::snprintf(text, sizeof text, "%.4g by %.4g degrees", angles.x, angles.y);
    return text;
}

FilmRay Projection::ray(glm::dvec2 place) const {
    if (is_sphere()) {
        const double longitude = window_.west + (place.x + 1) * half_extent_.x, up = latitude(place.y);
        return {glm::dvec3(0), {std::cos(up) * std::sin(longitude), std::sin(up), -std::cos(up) * std::cos(longitude)}};
    }
    const glm::dvec2 at = place * half_extent_;
    if (!has_eye()) return {{at, 0}, {0, 0, -1}};
    return {glm::dvec3(0), {at, -1}};
}

glm::dvec2 Projection::on_plane(glm::dvec3 seen, double scale) const {
    return {seen.x / (scale * half_extent_.x), seen.y / (scale * half_extent_.y)};
}

glm::dvec2 Projection::on_sphere(glm::dvec3 seen) const {
    // On the pole any longitude will do.
    const double middle = 0.5 * (window_.west + window_.east);
    double longitude = std::atan2(seen.x, -seen.z);
    longitude -= turn * std::round((longitude - middle) / turn);
    const double up = std::atan2(seen.y, std::hypot(seen.x, seen.z));
    return {(longitude - window_.west) / half_extent_.x - 1, (up - window_.south) / half_extent_.y - 1};
}

std::optional<FilmPoint> Projection::point(glm::dvec3 seen) const {
    if (is_sphere()) {
        const double distance = glm::length(seen);
        if (!(distance > 0)) return std::nullopt;
        return FilmPoint{on_sphere(seen), distance};
    }
    const double depth = -seen.z;
    if (!(depth > 0)) return std::nullopt;
    return FilmPoint{on_plane(seen, has_eye() ? depth : 1), depth};
}

std::optional<FilmPoint> Projection::direction(glm::dvec3 seen) const {
    constexpr double far = std::numeric_limits<double>::infinity();
    if (is_sphere()) return FilmPoint{on_sphere(seen), far};
    if (!has_eye() || !(-seen.z > 0)) return std::nullopt;
    return FilmPoint{on_plane(seen, -seen.z), far};
}

double Projection::solid_angle_at(double height) const {
    return is_sphere() ? std::cos(latitude(height)) : 1;
}

double Projection::even_height(double number) const {
    if (!is_sphere()) return 1 - 2 * number;
    const double north = std::sin(window_.north), south = std::sin(window_.south);
    return (std::asin(north + number * (south - north)) - window_.south) / half_extent_.y - 1;
}

}  // namespace render2mpeg::scene
