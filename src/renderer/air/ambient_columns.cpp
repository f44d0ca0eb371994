#include "renderer/air/ambient_columns.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/numeric.h"
#include "parallel/loops.h"

namespace render2mpeg::renderer {
namespace {

/// Distances along a column, each so many times the one before. chosen: 1.4; not tuned.
constexpr float step_ratio = 1.4f;

/// Behind air of this optical depth, and beyond so many sizes of the scene, light counts as even.
constexpr float deep_enough = 6.0f, scenes_away = 4.0f;

/// The nearest step over the scene's size. chosen: 1/64.
constexpr float nearest_step = 1.0f / 64;

float extent_of(const scene::Animation& film) {
    return glm::length(film.bounds_max - film.bounds_min);
}

/// Air of the sharp picture and of blurred pixels.
std::vector<const SeenAir*> all_air(const Frame& seen) {
    std::vector<const SeenAir*> all;
    for (const SeenAir& tile : seen.air) all.push_back(&tile);
    if (seen.exposure)
        for (const SeenAir& tile : seen.exposure->air) all.push_back(&tile);
    return all;
}

}  // namespace

AmbientColumns::AmbientColumns(const PosedScene& posed_scene, const Frame& seen)
    : all_air_(*posed_scene.air()),
      air_(*all_air_.fog()),
      least_distance_(nearest_step * std::max(extent_of(posed_scene.animation()), 1e-6f)),
      across_(seen.tiles_across() + 1) {
    const scene::Camera& camera = posed_scene.posed().camera;
    const int down = (seen.visible.height() + tile_size - 1) / tile_size + 1;
    for (int y = 0; y < down; ++y)
        for (int x = 0; x < across_; ++x) {
            const scene::Ray eye = camera.ray_through(glm::vec2(tile_size * x, tile_size * y));
            const float near = core::divide_or(std::max(camera.lens().near, 0.0f),
                                               glm::dot(eye.direction, camera.depth_axis(eye.direction)), 0.0f);
            columns_.push_back({eye.origin + near * eye.direction, eye.direction, {}});
        }
    // As far as is looked anywhere, or light changes.
    const scene::Animation& film = posed_scene.animation();
    float farthest = least_distance_;
    const std::vector<const SeenAir*> all = all_air(seen);
    for (const SeenAir* tile : all)
        for (const AirSpan& span : tile->straight) farthest = std::max(farthest, span.distance);
    const float away = glm::length(camera.position() - 0.5f * (film.bounds_min + film.bounds_max));
    farthest = std::min(farthest, std::max(scenes_away * extent_of(film) + away, least_distance_));
    while (distance_of(steps_ - 1) < farthest && steps_ < 200) ++steps_;

    const auto useful = [&](const Column& c, int step) {
        return step == 0 || air_.optical_depth(c.origin, c.direction, distance_of(step - 1)) < deep_enough;
    };
    parallel::for_each(columns_.size(), [&](std::size_t i) {
        Column& c = columns_[i];
        c.light.assign(static_cast<std::size_t>(steps_) + 1, glm::vec3(0));
        glm::vec3 sum(0), before(0);
        float lost_before = 0;
        for (int s = 0; s < steps_; ++s) {
            const glm::vec3 here = useful(c, s) ? fluence(c, s) : before;
            const float lost_here = lost(c, distance_of(s));
            sum += (lost_here - lost_before) * (s == 0 ? here : 0.5f * (before + here));
            c.light[static_cast<std::size_t>(s)] = sum;
            before = here;
            lost_before = lost_here;
        }
        c.light.back() = sum + (lost(c, std::numeric_limits<float>::infinity()) - lost_before) * before;
    });
}

float AmbientColumns::distance_of(int step) const {
    return least_distance_ * std::pow(step_ratio, static_cast<float>(step));
}

float AmbientColumns::lost(const Column& column, float distance) const {
    return -std::expm1(-air_.optical_depth(column.origin, column.direction, distance));
}

glm::vec3 AmbientColumns::fluence(const Column& column, int step) const {
    const float distance = distance_of(step);
    return all_air_.lit_fog().rest_at(column.origin + distance * column.direction) *
           glm::exp(-all_air_.depth_of_volumes(column.origin, column.direction, distance));
}

glm::vec3 AmbientColumns::at(const Column& column, float distance) const {
    const float above = std::log(std::max(distance / least_distance_, 1e-30f)) / std::log(step_ratio);
    const int below = static_cast<int>(std::clamp(std::floor(above), -1.0f, static_cast<float>(steps_ - 1)));
    const bool last = below == steps_ - 1;
    const float from = below < 0 ? 0.0f : lost(column, distance_of(below));
    const float to = lost(column, last ? std::numeric_limits<float>::infinity() : distance_of(below + 1));
    const glm::vec3 a = below < 0 ? glm::vec3(0) : column.light[static_cast<std::size_t>(below)];
    const glm::vec3 b = column.light[static_cast<std::size_t>(below + 1)];
    return a + std::clamp(core::divide_or(lost(column, distance) - from, to - from, 1.0f), 0.0f, 1.0f) * (b - a);
}

glm::vec3 AmbientColumns::light(glm::ivec2 pixel, float distance) const {
    const int x = pixel.x / tile_size, y = pixel.y / tile_size;
    const glm::vec2 t = (glm::vec2(pixel - tile_size * glm::ivec2(x, y)) + 0.5f) / static_cast<float>(tile_size);
    const auto corner = [&](int dx, int dy) {
        return at(columns_[static_cast<std::size_t>((y + dy) * across_ + x + dx)], distance);
    };
    return air_.albedo() *
           glm::mix(glm::mix(corner(0, 0), corner(1, 0), t.x), glm::mix(corner(0, 1), corner(1, 1), t.x), t.y);
}

glm::vec3 AmbientColumns::along(const AirPath& path) const {
    // Lit as where it begins.
    const float lost = -std::expm1(-air_.optical_depth(path.origin, path.direction, path.distance));
    return lost * air_.albedo() * all_air_.lit_fog().rest_at(path.origin);
}

}  // namespace render2mpeg::renderer
