#include "renderer/cut/point_light.h"

#include <array>
#include <cmath>

#include "core/color.h"
#include "core/numeric.h"
#include "renderer/base/lobe.h"
#include "renderer/cut/gathered_light.h"

namespace render2mpeg::renderer {

PointLight point_light(const GatheredLight& gathered, int lane, const GatherPoint& point) {
    PointLight light;
    light.direct = gathered.direct.at(lane) * lobe::inverse_pi;
    light.indirect = gathered.indirect.at(lane) * lobe::inverse_pi;
    if (point.point.bsdf.has_glossy())
        light.glossy = point.point.bsdf.f0 * gathered.f0.at(lane) + point.point.bsdf.f90 * gathered.schlick.at(lane);
    light.direct_cut = static_cast<float>(gathered.direct_clusters);
    light.indirect_cut = static_cast<float>(gathered.indirect_clusters);
    light.add_alone({gathered.error[lane]});
    light.clamped = gathered.clamped[lane];
    light.capped = (gathered.capped >> lane & 1u) != 0;
    return light;
}

namespace {

/// Luminance of a point's weights in all pixels.
float given_by(const Frame& seen, std::size_t tile, std::size_t index) {
    const GatherPoint& p = seen.tiles[tile][index];
    if (!seen.exposure) return core::luminance(p.weight);
    const glm::ivec2 place = seen.place_of(tile, p.pixel);
    const float blurred = seen.exposure->given[seen.exposure->first_point[tile] + index];
    return seen.exposure->exposed.at(place.x, place.y) != 0 ? blurred : blurred + core::luminance(p.weight);
}

}  // namespace

std::vector<PointTolerance> point_tolerances(const LightingContext& context, std::size_t tile, bool priced) {
    const Frame& seen = context.seen;
    const GatherTile& points = seen.tiles[tile];
    std::array<float, tile_size * tile_size> weight{};
    for (const GatherPoint& p : points) weight[p.pixel] += core::luminance(p.weight);
    const bool are_prices = priced && context.tolerance.typical > 0.0f;
    std::vector<PointTolerance> parts;
    parts.reserve(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
        const GatherPoint& p = points[i];
        const glm::ivec2 place = seen.place_of(tile, p.pixel);
        const core::Tolerance& t = context.tolerance.pixels.at(place.x, place.y);
        const float part = core::divide_or(core::luminance(p.weight), weight[p.pixel], 1.0f);
        PointTolerance& own = parts.emplace_back();
        own.part = {std::max(t.absolute, 0.0f) * part, std::max(t.relative, 0.0f), t.background * part};
        own.base = std::max(core::luminance(context.ungathered.all().at(place.x, place.y)), 0.0f) * part;
        if (!(part > 0.0f)) continue;
        const float given = given_by(seen, tile, i), share = core::divide_or(given, weight[p.pixel], part);
        own.root = std::sqrt(std::clamp(share, part, std::max(part, 1.0f)));
        own.noise = are_prices ? core::divide_or(weight[p.pixel], given, 1.0f / part) : 1.0f / std::sqrt(part);
    }
    return parts;
}

}  // namespace render2mpeg::renderer
