#include "renderer/gather/frame_rays.h"

#include "core/color.h"
#include "renderer/cut/gather_groups.h"

namespace render2mpeg::renderer {
namespace {

GatherRequest ray_request(const GatherPoint& p, const PointTolerance& allowed, glm::ivec2 pixel,
                          const scene::Camera& camera, RaysOf which) {
    GatherRequest r = request_of(p, allowed, pixel, camera);
    r.which = which;
    return r;
}

}  // namespace

bool wants_rays(const Bsdf& bsdf, RaysOf which) {
    return which == RaysOf::lobes ? bsdf.has_narrow_lobe() : bsdf.has_diffuse() || bsdf.has_glossy();
}

void add_rays(FinalGather& gather, const scene::Camera& camera, const LightingContext& context, RaysOf which,
              FrameLight& light) {
    const Frame& seen = context.seen;
    const core::ToleranceMap& tolerance = context.tolerance;
    std::vector<GatherRequest> requests;
    std::vector<PointLight*> of_request;
    std::uint32_t pool = 0;
    for (std::size_t t = 0; t < seen.tiles.size(); ++t) {
        const GatherTile& tile = seen.tiles[t];
        const std::vector<PointTolerance> tolerances =
            tolerance.is_reference() ? std::vector<PointTolerance>(tile.size()) : point_tolerances(context, t, true);
        const int across = seen.tiles_across(), index = static_cast<int>(t);
        const glm::ivec2 corner = tile_size * glm::ivec2(index % across, index / across);
        for (const GatherGroup& group : group_points(tile, camera.position(), 1)) {
            for (const std::uint32_t k : group.points) {
                const GatherPoint& p = tile[k];
                if (!wants_rays(p.point.bsdf, which)) continue;
                PointTolerance allowed = tolerances[k];
                allowed.base += core::luminance(light[t][k].scattered(p));
                const glm::ivec2 pixel = corner + glm::ivec2(p.pixel % tile_size, p.pixel / tile_size);
                requests.push_back(ray_request(p, allowed, pixel, camera, which));
                requests.back().pool = pool;
                of_request.push_back(&light[t][k]);
            }
            ++pool;
        }
    }
    const std::vector<RayLight> rays =
        gather.gather(requests, {.typical = tolerance.typical, .most = tolerance.most_rays});
    for (std::size_t k = 0; k < requests.size(); ++k) add(rays[k], *requests[k].point, *of_request[k]);
}

std::vector<glm::vec3> exact_rays(FinalGather& gather, const scene::Camera& camera, std::span<const GatherPoint> points,
                                  std::span<const std::size_t> of_pixel, std::size_t pixels, RaysOf which) {
    std::vector<GatherRequest> requests;
    std::vector<std::size_t> asked;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (!wants_rays(points[i].point.bsdf, which)) continue;
        requests.push_back(ray_request(points[i], {}, {0, 0}, camera, which));
        requests.back().numbers = Stream(Purpose::audited_rays, {.index = 2 * i});
        requests.back().pool = static_cast<std::uint32_t>(i);
        asked.push_back(i);
    }
    const std::vector<RayLight> rays = gather.gather(requests, {});
    std::vector<glm::vec3> sums(pixels, glm::vec3(0));
    for (std::size_t k = 0; k < asked.size(); ++k) {
        PointLight light;
        add(rays[k], points[asked[k]], light);
        sums[of_pixel[asked[k]]] += light.scattered(points[asked[k]]);
    }
    return sums;
}

}  // namespace render2mpeg::renderer
