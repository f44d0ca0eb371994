// Virtual point lights [Render2MPEG, 6.1; 7.3.1]: every photon takes the same numbers in every frame, so that a VPL
// stays where nothing on its path moved. Changed: VPLs are not gathered in anchors, since light trees find clusters of
// any number of them.
#include "renderer/lights/virtual_lights.h"

#include <algorithm>
#include <array>
#include <bit>
#include <map>

#include "core/color.h"
#include "core/numeric.h"
#include "parallel/loops.h"
#include "renderer/base/lobe.h"
#include "renderer/lights/point_tree.h"

namespace render2mpeg::renderer {
namespace {

/// Neighbours that density is estimated by, and how alike they must face. chosen: 12 and 60 degrees; 6 are noisy, 24
/// and 48 blur edges (in Sponza what is clamped changes by a tenth between 6 and 48).
constexpr std::size_t neighbours = 12;
constexpr float least_facing = 0.5f;

/// VPLs of an instant over those wanted, at most, about. chosen: 4; bounds memory where light comes indoors.
constexpr int most_over_wanted = 4;

/// Paths that leave so many VPLs each: a power of two, so that hardly an instant differs in it, and light that stays is
/// as bright.
std::uint64_t most_paths(int vpls, double each) {
    const double most = core::divide_or(static_cast<double>(most_over_wanted) * vpls, each, 1e18);
    return std::bit_floor(static_cast<std::uint64_t>(std::clamp(most, 1.0, 1e18)));
}

}  // namespace

PlannedLights::PlannedLights(std::span<const LightPoint> now, std::span<const LightPoint> average)
    : shining(average.begin(), average.end()), planned(shining) {
    std::map<std::uint32_t, const LightPoint*> by_id;
    for (const LightPoint& p : now) by_id[p.id] = &p;
    for (LightPoint& p : shining) {
        const auto found = by_id.find(p.id);
        if (found == by_id.end()) {
            p.intensity = glm::vec3(0);
            continue;
        }
        p = *found->second;
        by_id.erase(found);
    }
    for (const auto& [id, light] : by_id) {
        planned.push_back(*light);
        shining.push_back(*light);
    }
}

void spread(std::span<LightPoint> points, float alone) {
    std::vector<OrientedPoint> places;
    places.reserve(points.size());
    for (const LightPoint& p : points) places.push_back({p.position, p.normal});
    PointTree tree(places);
    // In the tree's order neighbours are near in memory, too.
    const std::vector<std::uint32_t> order = tree.take_order();
    parallel::for_ranges(points.size(), 256, [&](std::size_t first, std::size_t last) {
        std::array<Neighbour, neighbours> found;
        for (std::size_t i = first; i < last; ++i) {
            const int count = tree.nearest(tree[i], least_facing, found);
            LightPoint& point = points[order[i]];
            float sum = 0;
            for (std::size_t k = 0; k < static_cast<std::size_t>(count); ++k) {
                // The circle through the farthest holds the others, and half of it.
                const float part = k + 1 == static_cast<std::size_t>(count) ? 0.5f : 1.0f;
                sum += part * core::luminance(points[order[found[k].point]].intensity);
            }
            const float circle2 = count > 1 ? found[static_cast<std::size_t>(count - 1)].distance2 : 0.0f;
            point.disc2 = count > 1 ? core::divide_or(circle2 * core::luminance(point.intensity), sum, 0.0f)
                                    : alone * lobe::inverse_pi;
        }
    });
}

std::uint64_t virtual_light_paths(const PosedScene& posed_scene, std::span<const LightPoint> average, int vpls,
                                  int bounces) {
    const std::uint64_t paths = paths_for(posed_scene, average, vpls, bounces);
    return paths > 0 ? paths : static_cast<std::uint64_t>(vpls);
}

PhotonResult virtual_lights(const PosedScene& posed_scene, const PlannedLights& lights,
                            const VirtualLightSettings& settings) {
    PhotonSettings photons{1, std::min(settings.paths, static_cast<std::uint64_t>(settings.vpls)), settings.bounces,
                           lights.planned};
    PhotonResult result = trace_photons(posed_scene, lights.shining, photons);
    const double each = static_cast<double>(result.vpls.size()) / std::max(static_cast<double>(photons.paths), 1.0);
    const std::uint64_t paths = std::min(settings.paths, most_paths(settings.vpls, each));
    if (paths != photons.paths) {
        // Where few paths landed when they were counted, all of them may land now; others leave more than most do.
        photons.paths = paths;
        const std::uint64_t rays = result.rays;
        result = trace_photons(posed_scene, lights.shining, photons);
        result.rays += rays;
    }
    const glm::vec3 extent = world_box(posed_scene.posed()).size();
    spread(result.vpls, glm::dot(extent, extent));
    return result;
}

}  // namespace render2mpeg::renderer
