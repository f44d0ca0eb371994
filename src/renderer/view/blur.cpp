#include "renderer/view/blur.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <tuple>

#include "core/box.h"
#include "parallel/loops.h"
#include "renderer/view/exposure_pattern.h"
#include "renderer/view/tile_visibility.h"

namespace render2mpeg::renderer {
namespace {

/// Of a rectangle of the picture, both ends included.
void mark(std::vector<float>& tiles, int across, glm::vec2 low, glm::vec2 high, float blur) {
    const int down = static_cast<int>(tiles.size()) / across;
    const glm::ivec2 first = glm::clamp(glm::ivec2(glm::floor(low / static_cast<float>(tile_size))), glm::ivec2(0),
                                        glm::ivec2(across, down)),
                     last = glm::clamp(glm::ivec2(glm::floor(high / static_cast<float>(tile_size))), glm::ivec2(-1),
                                       glm::ivec2(across - 1, down - 1));
    for (int y = first.y; y <= last.y; ++y)
        for (int x = first.x; x <= last.x; ++x) {
            float& tile = tiles[static_cast<std::size_t>(y * across + x)];
            tile = std::max(tile, blur);
        }
}

/// The same where the picture may wrap.
void mark(std::vector<float>& tiles, int across, const scene::Camera& camera, glm::vec2 low, glm::vec2 high,
          float blur) {
    mark(tiles, across, low, high, blur);
    if (!camera.wraps()) return;
    const glm::vec2 turn(camera.size().x, 0);
    mark(tiles, across, low - turn, high - turn, blur);
    mark(tiles, across, low + turn, high + turn, blur);
}

/// Cover of an object on the picture while the shutter is open, about its boxes at all knots.
struct Cover {
    glm::vec2 low{1e30f}, high{-1e30f};  ///< on the picture of the middle, pixels
    float blur = 0;

    /// `corner`: of a box at one knot.
    void add(glm::vec3 corner, const Blur& still, const scene::Camera& camera, glm::vec2 size) {
        const auto place = camera.project(corner);
        const glm::vec2 p = place ? glm::clamp(place->position, -size, 2.0f * size) : glm::vec2(0);
        low = glm::min(low, p);
        high = glm::max(high, place ? p : size);
        blur = std::max(blur, place ? still.of_place(corner) : glm::length(size));
    }
};

Cover cover_of(const Blur& blur, const scene::Snapshot& snapshot, std::uint32_t object) {
    const scene::Animation& film = *snapshot.animation;
    const glm::vec2 size = snapshot.camera.size();
    Cover cover;
    core::Box all;
    const auto own = core::Box::about(film.meshes[static_cast<std::size_t>(film.objects[object].mesh)].positions);
    glm::vec2 ways_low[8], ways_high[8];
    std::optional<glm::vec2> begins[8];
    std::fill(std::begin(ways_low), std::end(ways_low), glm::vec2(1e30f));
    std::fill(std::begin(ways_high), std::end(ways_high), glm::vec2(-1e30f));
    const auto add = [&](const auto& posed) {
        const scene::ObjectState& state = posed.objects[object];
        const core::Box box = state.deformed >= 0
                                  ? core::Box::about(posed.deformed[static_cast<std::size_t>(state.deformed)].positions)
                                  : own;
        for (int c = 0; c < 8; ++c) {
            const glm::vec3 corner = glm::vec3(state.to_world * glm::vec4(box.corner(c), 1));
            cover.add(corner, blur, snapshot.camera, size);
            const auto place = snapshot.camera.project(corner);
            glm::vec2 p = glm::clamp(place ? place->position : glm::vec2(0), -size, 2.0f * size);
            if (!begins[c]) begins[c] = p;
            p = snapshot.camera.nearest_turn(p, *begins[c]);
            ways_low[c] = glm::min(ways_low[c], p);
            ways_high[c] = glm::max(ways_high[c], p);
            all.hold(corner);
        }
    };
    add(snapshot);
    if (snapshot.sweep && snapshot.sweep->object_moves(object))
        for (const scene::SweepKnot& knot : snapshot.sweep->knots) add(knot);
    // In a panorama what lies between corners leaves the rectangle about them.
    if (const auto ball = snapshot.camera.cover_of_ball(all.middle(), 0.5f * glm::length(all.high - all.low)))
        std::tie(cover.low, cover.high) = *ball;
    for (int c = 0; c < 8; ++c) cover.blur = std::max(cover.blur, glm::length(ways_high[c] - ways_low[c]));
    return cover;
}

/// Marks moving and shining objects: lamps too small for samples show when they are blurred.
void mark_objects(const Blur& blur, const scene::Snapshot& snapshot, int across, std::vector<float>& tiles) {
    const scene::Animation& film = *snapshot.animation;
    for (std::uint32_t o = 0; o < film.objects.size(); ++o) {
        if (!snapshot.objects[o].present) continue;
        const scene::Material& material = film.materials[static_cast<std::size_t>(film.objects[o].material)];
        const bool moves = snapshot.sweep && snapshot.sweep->object_moves(o);
        if (!moves && !material.emits() && !material.unlit) continue;
        const Cover cover = cover_of(blur, snapshot, o);
        if (cover.blur >= least_blur) mark(tiles, across, snapshot.camera, cover.low, cover.high, cover.blur);
    }
}

}  // namespace

Blur::Blur(const scene::Snapshot& snapshot)
    : snapshot_(snapshot),
      moves_(snapshot.sweep != nullptr),
      opening_(snapshot.camera),
      closing_(snapshot.camera),
      diagonal_(glm::length(snapshot.camera.size())) {
    if (!moves_ || !snapshot.sweep->camera_moves) return;
    // chosen: 64 parts, whose outer two are within 1 % of the ends.
    const std::vector<scene::Camera> cameras = scene::cameras_over(snapshot, 64);
    opening_ = cameras.front();
    closing_ = cameras.back();
}

float Blur::of_lens(float depth) const {
    const scene::Camera& camera = snapshot_.camera;
    return std::min(camera.circle_of_confusion(depth) * std::max(1.0f, 1.0f / camera.lens().squeeze), diagonal_);
}

glm::vec2 Blur::way(const scene::ScreenPoint& from, const scene::ScreenPoint& to) const {
    return snapshot_.camera.nearest_turn(to.position, from.position) - from.position;
}

float Blur::of_place(glm::vec3 world) const {
    const std::optional<scene::ScreenPoint> place = snapshot_.camera.project(world);
    float blur = 0;
    if (snapshot_.camera.has_aperture()) blur = place ? of_lens(place->depth) : diagonal_;
    if (!moves_ || !snapshot_.sweep->camera_moves) return blur;
    const auto a = opening_.project(world), b = closing_.project(world);
    return a && b ? std::max(blur, std::min(glm::length(way(*a, *b)), diagonal_)) : diagonal_;
}

float Blur::of_distance(float distance) const {
    return snapshot_.camera.has_aperture() ? of_lens(distance) : 0.0f;
}

float Blur::of(const core::SurfaceAddress& address) const {
    if (!address.is_surface()) return 0;
    const bool goes = moves_ && (snapshot_.sweep->camera_moves || snapshot_.sweep->object_moves(address.object));
    if (!goes && !snapshot_.camera.has_aperture()) return 0;
    const std::optional<glm::vec3> middle = scene::carry(address, snapshot_);
    if (!middle) return 0;
    const std::optional<scene::ScreenPoint> place = snapshot_.camera.project(*middle);
    float blur = 0;
    if (snapshot_.camera.has_aperture()) blur = place ? of_lens(place->depth) : diagonal_;
    if (!goes) return blur;
    const auto a = opening_.project(*scene::swept_position(address, snapshot_, false)),
               b = closing_.project(*scene::swept_position(address, snapshot_, true));
    if (!a || !b || !place) return diagonal_;
    const float moved = glm::length(way(*a, *place)) + glm::length(way(*place, *b));
    return std::max(blur, std::min(moved, diagonal_));
}

float Blur::of_sky(glm::vec2 position) const {
    float blur = of_distance(std::numeric_limits<float>::infinity());
    if (!moves_ || !snapshot_.sweep->camera_moves) return blur;
    const glm::vec3 direction = snapshot_.camera.ray_through(position).direction;
    const auto a = opening_.project_direction(direction), b = closing_.project_direction(direction);
    if (!a || !b) return snapshot_.camera.has_eye() ? diagonal_ : blur;
    return std::max(blur, std::min(glm::length(way(*a, *b)), diagonal_));
}

float Blur::of_pixel(const core::Visible& visible, int x, int y) const {
    switch (visible.kind.at(x, y)) {
        case core::PixelClass::none:
            return 0;
        case core::PixelClass::sky:
            return of_sky({static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f});
        default:
            return of(visible.address.at(x, y));
    }
}

glm::vec2 Blur::motion_of_pixel(const core::Visible& visible, int x, int y) const {
    const core::SurfaceAddress& address = visible.address.at(x, y);
    if (!moves_ || visible.kind.at(x, y) != core::PixelClass::surface || !address.is_surface()) return glm::vec2(0);
    if (!snapshot_.sweep->camera_moves && !snapshot_.sweep->object_moves(address.object)) return glm::vec2(0);
    const auto a = opening_.project(*scene::swept_position(address, snapshot_, false)),
               b = closing_.project(*scene::swept_position(address, snapshot_, true));
    return a && b ? way(*a, *b) : glm::vec2(0);
}

core::Plane<glm::vec2> Blur::motions(const core::Visible& visible) const {
    core::Plane<glm::vec2> motions(visible.width(), visible.height(), glm::vec2(0));
    parallel::for_each(static_cast<std::size_t>(visible.height()), [&](std::size_t row) {
        const int y = static_cast<int>(row);
        for (int x = 0; x < visible.width(); ++x) motions.at(x, y) = motion_of_pixel(visible, x, y);
    });
    return motions;
}

void blur_shadows(const scene::Snapshot& snapshot, Frame& seen) {
    if (!snapshot.sweep || snapshot.sweep->knots.empty()) return;
    const scene::Animation& film = *snapshot.animation;
    for (std::uint32_t o = 0; o < film.objects.size(); ++o)
        if (snapshot.sweep->object_moves(o) &&
            film.materials[static_cast<std::size_t>(film.objects[o].material)].emits())
            return;
    parallel::for_each(seen.tiles.size(), [&](std::size_t t) {
        for (GatherPoint& p : seen.tiles[t])
            if (!snapshot.sweep->object_moves(p.point.address.object))
                p.shadow_part = static_cast<std::uint8_t>(1 + dither_class(p.pixel % tile_size, p.pixel / tile_size));
    });
}

std::vector<float> blur_of_tiles(const Blur& blur, const scene::Snapshot& snapshot, const Frame& seen,
                                 const std::vector<float>& found) {
    const int across = seen.tiles_across();
    std::vector<float> tiles = found;
    parallel::for_each(tiles.size(), [&](std::size_t t) {
        const TileArea area = area_of(seen, t);
        for (int y = area.first.y; y < area.end.y; ++y)
            for (int x = area.first.x; x < area.end.x; ++x)
                tiles[t] = std::max(tiles[t], blur.of_pixel(seen.visible, x, y));
        for (const GatherPoint& p : seen.tiles[t]) tiles[t] = std::max(tiles[t], blur.of(p.point.address));
    });
    mark_objects(blur, snapshot, across, tiles);

    // Blurred objects reach into tiles around.
    std::vector<float> reached = tiles;
    for (std::size_t t = 0; t < tiles.size(); ++t) {
        if (tiles[t] < least_blur) continue;
        const TileArea area = area_of(seen, t);
        mark(reached, across, snapshot.camera, glm::vec2(area.first) - tiles[t], glm::vec2(area.end - 1) + tiles[t],
             tiles[t]);
    }
    for (float& tile : reached)
        if (tile < least_blur) tile = 0;
    return reached;
}

}  // namespace render2mpeg::renderer
