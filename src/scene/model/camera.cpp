#include "scene/model/camera.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.h"
#include "core/numeric.h"

// Double precision, rounded once, so that inverse functions agree (docs/model/scene.md).
namespace render2mpeg::scene {
namespace {

glm::dvec3 axis(const glm::mat4& to_world, int column) {
    return glm::dvec3(glm::vec3(to_world[column]));
}

}  // namespace

Camera::Camera(const CameraLens& lens, const glm::mat4& to_world, int width, int height, float aspect)
    : lens_(lens), to_world_(to_world), width_(width), height_(height) {
    EXPECTS(width > 0 && height > 0 && aspect > 0 && std::isfinite(aspect));
    EXPECTS(core::is_finite(to_world));
    half_extent_.y = lens.perspective ? static_cast<float>(std::tan(0.5 * static_cast<double>(lens.vertical_fov)))
                                      : lens.y_magnification;
    half_extent_.x = half_extent_.y * aspect;
    shift_ = 2.0f * lens.shift / glm::vec2(aspect, 1);
    EXPECTS(core::is_finite(shift_));
    EXPECTS(half_extent_.y > 0 && core::is_finite(half_extent_));
    EXPECTS(lens.aperture_radius == 0 || (lens.aperture_radius > 0 && lens.focus_distance > 0));
}

Camera Camera::moved(const glm::mat4& to_world, float vertical_fov) const {
    CameraLens lens = lens_;
    lens.vertical_fov = std::clamp(vertical_fov, 1e-6f, 3.1415f);
    return Camera(lens, to_world, width_, height_, half_extent_.x / half_extent_.y);
}

Ray Camera::ray_through(glm::vec2 position) const {
    const glm::dvec2 shift(shift_), half(half_extent_);
    const double x = (2.0 * static_cast<double>(position.x) / width_ - 1.0 + shift.x) * half.x;
    const double y = (1.0 - 2.0 * static_cast<double>(position.y) / height_ + shift.y) * half.y;
    const glm::dvec3 right = axis(to_world_, 0), up = axis(to_world_, 1), back = axis(to_world_, 2);
    if (!lens_.perspective)
        return {glm::vec3(axis(to_world_, 3) + x * right + y * up), glm::vec3(glm::normalize(-back))};
    return {glm::vec3(to_world_[3]), glm::vec3(glm::normalize(x * right + y * up - back))};
}

Ray Camera::ray_through(glm::vec2 position, glm::vec2 lens) const {
    const Ray middle = ray_through(position);
    if (!has_aperture()) return middle;
    // In units of depth, so that no far points are subtracted.
    const double radius = static_cast<double>(lens_.aperture_radius);
    const glm::dvec3 across =
        radius * (static_cast<double>(lens.x) * axis(to_world_, 0) + static_cast<double>(lens.y) * axis(to_world_, 1));
    const glm::dvec3 direction(middle.direction);
    const double cosine = -glm::dot(direction, axis(to_world_, 2));
    const glm::dvec3 per_depth = direction / cosine - across / static_cast<double>(lens_.focus_distance);
    return {glm::vec3(glm::dvec3(middle.origin) + across), glm::vec3(glm::normalize(per_depth))};
}

float Camera::circle_of_confusion(float depth) const {
    if (!has_aperture()) return 0;
    const float per_depth = std::abs(1 / lens_.focus_distance - 1 / depth);
    const float apart = 2 * lens_.aperture_radius * per_depth * (lens_.perspective ? 1 : depth);
    return apart / pixel_size();
}

std::optional<ScreenPoint> Camera::project_exact(glm::dvec3 world) const {
    const glm::dvec3 v = world - axis(to_world_, 3);
    const double depth = -glm::dot(v, axis(to_world_, 2));
    if (!(depth > 0)) return std::nullopt;
    return on_picture(glm::dot(v, axis(to_world_, 0)), glm::dot(v, axis(to_world_, 1)), depth, depth);
}

std::optional<ScreenPoint> Camera::project(glm::vec3 world) const {
    return project_exact(glm::dvec3(world));
}

std::optional<ScreenPoint> Camera::project_direction(glm::vec3 world_direction) const {
    // An orthographic camera sees one direction alone, everywhere.
    if (!lens_.perspective) return std::nullopt;
    const glm::dvec3 v(world_direction);
    const double along = -glm::dot(v, axis(to_world_, 2));
    if (!(along > 0)) return std::nullopt;
    return on_picture(glm::dot(v, axis(to_world_, 0)), glm::dot(v, axis(to_world_, 1)), along,
                      std::numeric_limits<double>::infinity());
}

std::optional<ScreenPoint> Camera::on_picture(double right, double up, double scale, double depth) const {
    if (!lens_.perspective) scale = 1;
    const double x = right / (scale * static_cast<double>(half_extent_.x)) - static_cast<double>(shift_.x);
    const double y = up / (scale * static_cast<double>(half_extent_.y)) - static_cast<double>(shift_.y);
    const glm::vec2 position(0.5 * (1.0 + x) * width_, 0.5 * (1.0 - y) * height_);
    // Points near the eye's plane have no finite position.
    if (!core::is_finite(position)) return std::nullopt;
    return ScreenPoint{position, static_cast<float>(depth)};
}

glm::mat4 Camera::world_to_camera() const {
    glm::dmat4 turned(to_world_);
    turned[2] = -turned[2];
    return glm::mat4(glm::inverse(turned));
}

glm::mat4 Camera::world_to_ndc() const {
    const auto x = 0.5 / static_cast<double>(half_extent_.x), y = -0.5 / static_cast<double>(half_extent_.y);
    const auto near = static_cast<double>(lens_.near);
    const double u = 0.5 * (1 - static_cast<double>(shift_.x)), v = 0.5 * (1 + static_cast<double>(shift_.y));
    // By columns: what right, up, depth and 1 are taken by.
    const glm::dmat4 of_camera = lens_.perspective
                                     ? glm::dmat4({x, 0, 0, 0}, {0, y, 0, 0}, {u, v, 1, 1}, {0, 0, -near, 0})
                                     : glm::dmat4({x, 0, 0, 0}, {0, y, 0, 0}, {0, 0, 1, 0}, {u, v, -near, 1});
    return glm::mat4(of_camera * glm::dmat4(world_to_camera()));
}

float Camera::pixel_size() const {
    return 2 * half_extent_.y / static_cast<float>(height_);
}

}  // namespace render2mpeg::scene
