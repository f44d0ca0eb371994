#include "scene/model/camera.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/numeric.h"

// Double precision, rounded once, so that inverse functions agree (docs/model/scene.md).
namespace render2mpeg::scene {
namespace {

glm::dvec3 axis(const glm::mat4& to_world, int column) {
    return glm::dvec3(glm::vec3(to_world[column]));
}

Projection projection_of(const CameraLens& lens, float aspect) {
    if (lens.is_panorama() && lens.eye != Eye::single && lens.stereo.spherical)
        return Projection(lens.window, circle_of(lens.stereo, lens.eye));
    if (lens.is_panorama()) return Projection(lens.window);
    const float up = lens.projection == ProjectionKind::perspective
                         ? static_cast<float>(std::tan(0.5 * static_cast<double>(lens.vertical_fov)))
                         : lens.y_magnification;
    return {lens.projection, glm::dvec2(glm::vec2(up * aspect, up))};
}

}  // namespace

void make_panorama(CameraLens& lens, const SphereWindow& window) {
    lens.projection = ProjectionKind::equirectangular;
    lens.window = window;
    lens.vertical_fov = static_cast<float>(window.north - window.south);
    lens.aspect = static_cast<float>(window.aspect());
    lens.shift = {0, 0};
    lens.f_stop = lens.aperture_radius = 0;
}

Camera::Camera(const CameraLens& lens, const glm::mat4& to_world, int width, int height, float aspect)
    : lens_(lens), head_to_world_(to_world), to_world_(to_world), width_(width), height_(height) {
    EXPECTS(width > 0 && height > 0 && aspect > 0 && std::isfinite(aspect));
    EXPECTS(core::is_finite(to_world));
    EXPECTS(lens.aperture_radius == 0 || (lens.aperture_radius > 0 && lens.focus_distance > 0));
    projection_ = projection_of(lens, aspect);
    shift_ = 2.0f * lens.shift / glm::vec2(aspect, 1);
    EXPECTS(core::is_finite(shift_));
    const glm::vec2 half_extent(projection_.half_extent());
    EXPECTS(half_extent.y > 0 && core::is_finite(half_extent));
    if (lens.eye == Eye::single || (lens.is_panorama() && lens.stereo.spherical)) return;
    // The eye, and its picture so far aside that both eyes' cover the same of the plane of convergence.
    const glm::dmat4 eye = place_of(lens.stereo, lens.eye);
    to_world_ = glm::mat4(glm::dmat4(to_world) * eye);
    if (lens.stereo.convergence == Convergence::off_axis && lens.projection == ProjectionKind::perspective)
        shift_.x -= static_cast<float>(eye[3].x / (lens.stereo.convergence_distance * projection_.half_extent().x));
}

glm::vec3 Camera::eye_of(glm::vec3 world) const {
    const glm::dvec3 seen = along_axes(glm::dvec3(world) - axis(to_world_, 3)), eye = projection_.eye_of(seen);
    return glm::vec3(axis(to_world_, 3) + eye.x * axis(to_world_, 0) + eye.y * axis(to_world_, 1) +
                     eye.z * axis(to_world_, 2));
}

Camera Camera::moved(const glm::mat4& to_world, float vertical_fov) const {
    CameraLens lens = lens_;
    if (!lens.is_panorama()) lens.vertical_fov = std::clamp(vertical_fov, 1e-6f, 3.1415f);
    const glm::vec2 half_extent(projection_.half_extent());
    return Camera(lens, to_world, width_, height_, half_extent.x / half_extent.y);
}

glm::dvec2 Camera::film_place(glm::vec2 position) const {
    const glm::dvec2 shift(shift_);
    return {2.0 * static_cast<double>(position.x) / width_ - 1.0 + shift.x,
            1.0 - 2.0 * static_cast<double>(position.y) / height_ + shift.y};
}

Ray Camera::ray_through(glm::vec2 position) const {
    const FilmRay ray = projection_.ray(film_place(position));
    const glm::dvec3 right = axis(to_world_, 0), up = axis(to_world_, 1), back = axis(to_world_, 2);
    const glm::dvec3 direction = ray.direction.x * right + ray.direction.y * up + ray.direction.z * back;
    return {glm::vec3(axis(to_world_, 3) + ray.origin.x * right + ray.origin.y * up + ray.origin.z * back),
            glm::vec3(glm::normalize(direction))};
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
    const float apart = 2 * lens_.aperture_radius * per_depth * (has_eye() ? 1 : depth);
    return apart / pixel_size();
}

glm::dvec3 Camera::along_axes(glm::dvec3 way) const {
    return {glm::dot(way, axis(to_world_, 0)), glm::dot(way, axis(to_world_, 1)), glm::dot(way, axis(to_world_, 2))};
}

std::optional<ScreenPoint> Camera::project_exact(glm::dvec3 world) const {
    return on_picture(projection_.point(along_axes(world - axis(to_world_, 3))));
}

std::optional<ScreenPoint> Camera::project(glm::vec3 world) const {
    return project_exact(glm::dvec3(world));
}

std::optional<ScreenPoint> Camera::project_direction(glm::vec3 world_direction) const {
    return on_picture(projection_.direction(along_axes(glm::dvec3(world_direction))));
}

std::optional<ScreenPoint> Camera::on_picture(const std::optional<FilmPoint>& film) const {
    if (!film) return std::nullopt;
    const double x = film->place.x - static_cast<double>(shift_.x), y = film->place.y - static_cast<double>(shift_.y);
    glm::vec2 position(0.5 * (1.0 + x) * width_, 0.5 * (1.0 - y) * height_);
    // Points near the eye's plane have no finite position.
    if (!core::is_finite(position)) return std::nullopt;
    const auto right = static_cast<float>(width_);
    if (wraps() && position.x >= right) position.x -= right;
    return ScreenPoint{position, static_cast<float>(film->depth)};
}

glm::vec2 Camera::nearest_turn(glm::vec2 position, glm::vec2 to) const {
    if (!wraps()) return position;
    const auto turn = static_cast<float>(width_);
    return {position.x - turn * std::round((position.x - to.x) / turn), position.y};
}

std::optional<std::pair<glm::vec2, glm::vec2>> Camera::cover_of_ball(glm::vec3 middle, float radius) const {
    if (is_flat()) return std::nullopt;
    const glm::vec2 all = size();
    const std::optional<ScreenPoint> at = project(middle);
    // From within it is all around.
    if (!at || !(at->depth > radius)) return std::pair(glm::vec2(0), all);
    const double angle = std::asin(static_cast<double>(radius) / static_cast<double>(at->depth));
    const glm::dvec2 per_radian = glm::dvec2(all) / (2.0 * projection_.half_extent());
    const double rows = angle * per_radian.y;
    const glm::dvec3 way = along_axes(glm::dvec3(middle - position()));
    const double level = std::hypot(way.x, way.z) / glm::length(way);  // cosine of its latitude
    // A ball with a pole in it has all longitudes.
    const double columns =
        std::sin(angle) < level ? std::asin(std::sin(angle) / level) * per_radian.x : static_cast<double>(all.x);
    return std::pair(glm::vec2(glm::dvec2(at->position) - glm::dvec2(columns, rows)),
                     glm::vec2(glm::dvec2(at->position) + glm::dvec2(columns, rows)));
}

float Camera::weight_of_row(int row) const {
    return static_cast<float>(projection_.solid_angle_at(film_place({0, static_cast<float>(row) + 0.5f}).y));
}

glm::vec2 Camera::even_position(glm::vec2 numbers) const {
    if (is_flat()) return numbers * size();
    const double height = projection_.even_height(static_cast<double>(numbers.y));
    return {numbers.x * size().x, static_cast<float>(0.5 * (1.0 - height) * height_)};
}

float Camera::depth_of(glm::vec3 world) const {
    const glm::vec3 from_eye = world - position();
    return is_flat() ? glm::dot(from_eye, forward()) : glm::length(from_eye);
}

glm::mat4 Camera::world_to_camera() const {
    glm::dmat4 turned(to_world_);
    turned[2] = -turned[2];
    return glm::mat4(glm::inverse(turned));
}

glm::mat4 Camera::world_to_ndc() const {
    const glm::dvec2 half_extent = projection_.half_extent();
    const auto x = 0.5 / half_extent.x, y = -0.5 / half_extent.y;
    const auto near = static_cast<double>(lens_.near);
    const double u = 0.5 * (1 - static_cast<double>(shift_.x)), v = 0.5 * (1 + static_cast<double>(shift_.y));
    // By columns: what right, up, depth and 1 are taken by.
    const glm::dmat4 of_camera = has_eye() ? glm::dmat4({x, 0, 0, 0}, {0, y, 0, 0}, {u, v, 1, 1}, {0, 0, -near, 0})
                                           : glm::dmat4({x, 0, 0, 0}, {0, y, 0, 0}, {0, 0, 1, 0}, {u, v, -near, 1});
    return glm::mat4(of_camera * glm::dmat4(world_to_camera()));
}

float Camera::pixel_size() const {
    return 2 * static_cast<float>(projection_.half_extent().y) / static_cast<float>(height_);
}

}  // namespace render2mpeg::scene
