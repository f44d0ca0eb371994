#include "scene/model/projection.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

namespace render2mpeg::scene {
namespace {

constexpr double turn = 2 * std::numbers::pi;

/// How a point is seen from a circle about the upright axis.
struct Way {
    double latitude;  ///< of the ray's direction about the middle
    double aside;     ///< angle from that direction's longitude to the point's
};

/// `level` and `up`: the point's distance from the axis and its height. None for points within the circle.
std::optional<Way> way_to(double level, double up, double radius, double convergence_distance) {
    double side = radius;
    if (std::isfinite(convergence_distance)) {
        // A ray goes by s from its origin to where it meets the other eye's: the distance gives s by a square equation.
        const double r2 = radius * radius, c2 = convergence_distance * convergence_distance,
                     root = r2 * r2 - (r2 + c2) * (r2 - level * level - up * up);
        if (!(root >= 0)) return std::nullopt;
        const double s = (r2 + std::sqrt(root)) / (r2 + c2);
        if (!(s > 0)) return std::nullopt;
        side = radius * (1 - s);
    }
    const double forward2 = level * level - side * side;
    if (!(forward2 >= 0)) return std::nullopt;
    const double forward = std::sqrt(forward2);
    return Way{std::atan2(up, forward), std::atan2(side, forward)};
}

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
        const glm::dvec3 direction(std::cos(up) * std::sin(longitude), std::sin(up),
                                   -std::cos(up) * std::cos(longitude));
        if (circle_.aside == 0) return {glm::dvec3(0), direction};
        const glm::dvec3 origin = circle_.at(up) * glm::dvec3(std::cos(longitude), 0, std::sin(longitude));
        if (std::isinf(circle_.convergence_distance)) return {origin, direction};
        return {origin, circle_.convergence_distance * direction - origin};
    }
    const glm::dvec2 at = place * half_extent_;
    if (!has_eye()) return {{at, 0}, {0, 0, -1}};
    return {glm::dvec3(0), {at, -1}};
}

std::optional<glm::dvec3> Projection::way_from_circle(glm::dvec3 seen) const {
    if (circle_.aside == 0) return seen;
    const double level = std::hypot(seen.x, seen.z), height = std::abs(seen.y);
    const auto way_at = [&](double latitude) {
        return way_to(level, height, circle_.at(latitude), circle_.convergence_distance);
    };
    std::optional<Way> way = way_at(0);
    if (circle_.merge_to > 0 && !(way && way->latitude <= circle_.merge_from)) {
        // The circle shrinks with the latitude that it decides. The higher a ray goes, the higher it passes the point.
        double low = circle_.merge_from, high = circle_.merge_to;
        for (int i = 0; i < 60 && low < high; ++i) {
            const double middle = 0.5 * (low + high);
            const std::optional<Way> there = way_at(middle);
            (!there || there->latitude > middle ? low : high) = middle;
        }
        way = way_at(high);
    }
    if (!way) return std::nullopt;
    const double longitude = std::atan2(seen.x, -seen.z) - way->aside, up = std::copysign(way->latitude, seen.y);
    return glm::dvec3(std::cos(up) * std::sin(longitude), std::sin(up), -std::cos(up) * std::cos(longitude));
}

glm::dvec3 Projection::eye_of(glm::dvec3 seen) const {
    if (!is_sphere() || circle_.aside == 0) return glm::dvec3(0);
    const std::optional<glm::dvec3> way = way_from_circle(seen);
    return way ? ray(on_sphere(*way)).origin : glm::dvec3(0);
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
        const std::optional<glm::dvec3> way = way_from_circle(seen);
        return way ? std::optional(FilmPoint{on_sphere(*way), distance}) : std::nullopt;
    }
    const double depth = -seen.z;
    if (!(depth > 0)) return std::nullopt;
    return FilmPoint{on_plane(seen, has_eye() ? depth : 1), depth};
}

std::optional<FilmPoint> Projection::direction(glm::dvec3 seen) const {
    constexpr double far = std::numeric_limits<double>::infinity();
    if (is_sphere() && circle_.aside == 0) return FilmPoint{on_sphere(seen), far};
    if (is_sphere()) {
        const bool meets = std::isfinite(circle_.convergence_distance);
        // chosen: 1e9 times as far as anything of the eyes: beside it the circle is a point.
        const double away = 1e9 * std::max(std::abs(circle_.aside), meets ? circle_.convergence_distance : 0.0);
        const std::optional<glm::dvec3> way = way_from_circle(away * glm::normalize(seen));
        return way ? std::optional(FilmPoint{on_sphere(*way), far}) : std::nullopt;
    }
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
