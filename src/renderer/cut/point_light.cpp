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
    light.error = {gathered.error[lane]};
    light.clamped = gathered.clamped[lane];
    light.capped = (gathered.capped >> lane & 1u) != 0;
    return light;
}

std::vector<PointTolerance> point_tolerances(const LightingContext& context, std::size_t tile) {
    const Frame& seen = context.seen;
    const GatherTile& points = seen.tiles[tile];
    std::array<float, tile_size * tile_size> weight{};
    for (const GatherPoint& p : points) weight[p.pixel] += core::luminance(p.weight);
    std::vector<PointTolerance> parts;
    parts.reserve(points.size());
    for (const GatherPoint& p : points) {
        const glm::ivec2 place = seen.place_of(tile, p.pixel);
        const core::Tolerance& t = context.tolerance.pixels.at(place.x, place.y);
        const float part = core::divide_or(core::luminance(p.weight), weight[p.pixel], 1.0f);
        PointTolerance& own = parts.emplace_back();
        own.part = {std::max(t.absolute, 0.0f) * part, std::max(t.relative, 0.0f), t.background * part};
        own.base = std::max(core::luminance(context.ungathered.all().at(place.x, place.y)), 0.0f) * part;
        if (part > 0.0f) own.noise = 1.0f / std::sqrt(part);
    }
    return parts;
}

}  // namespace render2mpeg::renderer
