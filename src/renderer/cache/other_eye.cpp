#include "renderer/cache/other_eye.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/color.h"
#include "core/numeric.h"
#include "parallel/loops.h"
#include "renderer/cache/irradiance_record.h"

namespace render2mpeg::renderer {
namespace {

/// Farther from a point's place, in its pixels on the surface, the other eye's pixels lie too sparsely for it. chosen:
/// 2.5, the diagonal of four pixels that are seen at much the same angle; not tuned.
constexpr float most_pixels_apart = 2.5f;

/// Grazing pixels are no longer than so many of those seen straight on.
constexpr float longest_pixel = 20.0f;

/// Of four pixels about a place, the share by interpolation of those that show its surface, from which on they tell:
/// beside silhouettes not all do. chosen: 1/4, one of four even ones; not tuned.
constexpr float least_share = 0.25f;

}  // namespace

void OtherEye::take(const Frame& seen, const scene::Camera& camera, std::span<const std::vector<PointLight>> light,
                    std::span<const std::vector<SharedLight>> shared) {
    camera_ = camera;
    tiles_across_ = seen.tiles_across();
    tiles_.resize(seen.tiles.size());
    parallel::for_each(tiles_.size(), [&](std::size_t t) {
        tiles_[t].clear();
        for (std::size_t i = 0; i < seen.tiles[t].size(); ++i) {
            const GatherPoint& p = seen.tiles[t][i];
            if (p.reached_by_specular()) continue;
            Point& point = tiles_[t].emplace_back(Point{p.pixel, p.point.back_side, p.point.address.object,
                                                        p.point.position, core::PackedNormal(p.point.geometric_normal),
                                                        core::PackedNormal(p.point.shading_normal),
                                                        shared[t].empty() ? SharedLight() : shared[t][i]});
            const PointLight& known = light[t][i];
            const float weight = core::luminance(p.weight);
            point.shared.direct = known.direct;
            point.shared.indirect = known.indirect;
            point.shared.glossy = known.glossy;
            point.shared.error = core::divide_or(known.error.value, weight, 0.0f);
            point.shared.error_of_block = core::divide_or(known.shared.value, weight, 0.0f);
        }
    });
}

const OtherEye::Point* OtherEye::point_at(glm::ivec2 pixel, const GatherPoint& p, float extent) const {
    const glm::ivec2 size(camera_.size());
    if (camera_.wraps()) pixel.x = (pixel.x + size.x) % size.x;
    if (pixel.x < 0 || pixel.y < 0 || pixel.x >= size.x || pixel.y >= size.y) return nullptr;
    const std::vector<Point>& tile =
        tiles_[static_cast<std::size_t>(pixel.y / tile_size * tiles_across_ + pixel.x / tile_size)];
    const auto place = static_cast<std::uint16_t>(pixel.y % tile_size * tile_size + pixel.x % tile_size);
    const SurfacePoint& s = p.point;
    const SurfaceMark mark{
        {}, 0, surface_of(s.address, s.back_side, p.path), s.position, s.geometric_normal, s.shading_normal};
    const float cosine = std::abs(glm::dot(s.geometric_normal, s.outgoing)),
                apart = most_pixels_apart * extent / std::max(cosine, 1.0f / longest_pixel);
    auto q = std::lower_bound(tile.begin(), tile.end(), place,
                              [](const Point& a, std::uint16_t wanted) { return a.pixel < wanted; });
    for (; q != tile.end() && q->pixel == place; ++q) {
        core::SurfaceAddress address;
        address.object = q->object;
        const glm::vec3 between = q->position - s.position;
        if (glm::dot(between, between) > apart * apart) continue;
        const SurfaceMark other{{},
                                0,
                                surface_of(address, q->back_side, direct_path),
                                q->position,
                                q->geometric_normal.unpack(),
                                q->shading_normal.unpack()};
        if (on_one_surface(mark, other, extent, extent, s.position_error)) return &*q;
    }
    return nullptr;
}

ToldLight OtherEye::at(const GatherPoint& p, float extent) const {
    if (tiles_.empty() || p.reached_by_specular()) return {};
    const auto seen = camera_.project(p.point.position);
    if (!seen) return {};
    const glm::vec2 corner = seen->position - 0.5f;
    if (!(std::abs(corner.x) < 1e6f && std::abs(corner.y) < 1e6f)) return {};
    const glm::vec2 first = glm::floor(corner), part = corner - first;
    ToldLight told;
    SharedLight& sum = told.light;
    sum.lit = sum.dark = ~0u;
    float least = std::numeric_limits<float>::infinity(), most = -least, shares = 0;
    int tell = 0;
    for (int k = 0; k < 4; ++k) {
        const glm::ivec2 step(k % 2, k / 2);
        const Point* const other = point_at(glm::ivec2(first) + step, p, extent);
        if (other == nullptr) continue;
        const SharedLight& one = other->shared;
        const float share = (step.x == 1 ? part.x : 1 - part.x) * (step.y == 1 ? part.y : 1 - part.y);
        shares += share;
        ++tell;
        sum.lit &= one.lit;
        sum.dark &= one.dark;
        sum.direct += share * one.direct;
        sum.indirect += share * one.indirect;
        sum.glossy += share * one.glossy;
        sum.error += share * one.error;
        sum.error_of_block += share * one.error_of_block;
        const float shown =
            core::luminance(p.weight * (p.point.bsdf.diffuse * (one.direct + one.indirect) + one.glossy));
        least = std::min(least, shown);
        most = std::max(most, shown);
    }
    if (shares < least_share) return {};
    for (glm::vec3* light : {&sum.direct, &sum.indirect, &sum.glossy}) *light /= shares;
    for (float* error : {&sum.error, &sum.error_of_block}) *error /= shares;
    // How light varies is not known of one pixel.
    if (tell < 2) sum.error = 0;
    told.spread = most - least;
    told.turn =
        core::normalize_or(camera_.eye_of(p.point.position) - p.point.position, p.point.outgoing) - p.point.outgoing;
    return told;
}

}  // namespace render2mpeg::renderer
