#include "renderer/air/fog_lighting.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/color.h"
#include "core/numeric.h"
#include "parallel/loops.h"
#include "renderer/air/lamp_ways.h"
#include "renderer/air/scattering_system.h"
#include "renderer/air/smooth_air.h"

namespace render2mpeg::renderer {
namespace {

/// Corners of the lattice at most. chosen: 1,000, whose equations take 4 MB; not tuned.
constexpr int most_corners = 1000;

/// Directions that a corner looks along. chosen: 48, six in each octant; not tuned.
constexpr std::size_t corner_directions = 48;

/// A lamp's light at a corner is at most the mean over a cell about the lamp: the mean of 1 / r^2 over a ball as large
/// is 3 over its squared radius, and that is 0.62 times a cube's side.
constexpr float least_of_cell = 0.62f * 0.57735f;

LitFog lattice_in(const FogMedium& fog) {
    const glm::vec3 low = fog.low(), sides = fog.high() - low;
    if (!(std::min({sides.x, sides.y, sides.z}) > 0.0f) || !core::is_finite(sides)) return {};
    // Roots first: products of extreme sides are 0 or infinite.
    float size = std::cbrt(sides.x) * std::cbrt(sides.y) * std::cbrt(sides.z) / std::cbrt(float{most_corners});
    const auto cells = [&] { return glm::max(glm::ivec3(glm::ceil(sides / size)), glm::ivec3(1)); };
    const auto corners = [&] { return (cells().x + 1) * (cells().y + 1) * (cells().z + 1); };
    while (corners() > most_corners) size *= 1.05f;
    return {low, low + sides, cells()};
}

std::vector<RayQuery> rays_from(const LitFog& fog, const Stream& numbers, std::size_t corners) {
    std::vector<RayQuery> rays;
    rays.reserve(corners * corner_directions);
    for (std::size_t i = 0; i < corners; ++i) add_even_rays(fog.place_of(i), corner_directions, numbers.at(i), rays);
    return rays;
}

/// Of directions (0), and of what rays meet (1).
Stream numbers_of_fog(std::uint64_t index) {
    return Stream(Purpose::rays_of_fog, {.index = index});
}

/// Light of lamps alone, and how far corners see along their rays.
void light_by_lamps(const AirInstant& instant, std::span<const RayQuery> looks, std::span<const LightPoint> lamps,
                    LitFog& lit) {
    std::vector<LitFog::Corner>& corners = lit.corners();
    parallel::for_ranges(corners.size(), 16, [&](std::size_t first, std::size_t last) {
        std::vector<Hit> hits(corner_directions);
        for (std::size_t i = first; i < last; ++i) {
            const std::span<const RayQuery> own = looks.subspan(i * corner_directions, corner_directions);
            instant.posed_scene.tracer().any_nearest(own, hits, false);
            std::array<float, 8> sum{}, count{};
            for (std::size_t k = 0; k < own.size(); ++k) {
                const std::size_t octant = LitFog::octant(own[k].direction);
                sum[octant] += std::min(hits[k].found() ? hits[k].distance : lit.farthest(), lit.farthest());
                ++count[octant];
            }
            for (std::size_t o = 0; o < 8; ++o) corners[i].clear[o] = core::divide_or(sum[o], count[o], lit.farthest());
            corners[i].lamps = mean_of_lamps(instant, lamps, lit.place_of(i), least_of_cell * lit.size());
        }
    });
}

/// All other light, beside that of lamps. Returns the shadow rays.
std::uint64_t light_by_rest(const AirInstant& instant, std::span<const RayQuery> looks,
                            std::span<const LightPoint> points, LitFog& lit) {
    const Air& air = *instant.posed_scene.air();
    const FogMedium& fog = *air.fog();
    const bool bounces = fog.is_lit_by_bounces() && instant.bounces;
    const std::size_t count = lit.corners().size();
    const std::vector<FinalGather::Seen> seen = seen_at_ends(instant, looks, numbers_of_fog(1), bounces);
    constexpr float part = 1.0f / static_cast<float>(corner_directions);
    std::vector<glm::vec3> own(count, glm::vec3(0)), places;
    std::vector<float> known(count);
    ScatteringSystem system(count);
    for (std::size_t i = 0; i < count; ++i) places.push_back(lit.place_of(i));
    parallel::for_ranges(count, 16, [&](std::size_t first, std::size_t last) {
        ScatteringSystem::Sums shares(count);
        for (std::size_t i = first; i < last; ++i) {
            glm::vec3 light(0);
            for (std::size_t k = i * corner_directions; k < (i + 1) * corner_directions; ++k) {
                const RayQuery& ray = looks[k];
                light += part * air.left_of_light(ray.origin, ray.direction, seen[k].distance) * seen[k].light;
                if (!bounces) continue;
                light += part * air.light_of_volumes(ray.origin, ray.direction, seen[k].distance, VolumeView::rough);
                lit.along(fog, ray.origin, ray.direction, seen[k].distance, [&](glm::vec3 place, float share) {
                    if (!air.volumes().empty())
                        share *= core::luminance(glm::exp(
                            -air.depth_of_volumes(ray.origin, ray.direction, glm::distance(ray.origin, place))));
                    light += part * share * fog.albedo() * lit.light_at(place);
                    lit.about(place, [&](std::size_t corner, float weight) { shares.add(corner, share * weight); });
                });
            }
            shares.move_to(system.row(i), part);
            own[i] = core::is_finite(light) ? light : glm::vec3(0);
            known[i] = core::luminance(own[i] + lit.light_at(places[i]));
        }
    });
    const SmoothAirLight smooth(instant.light_trees, points, bounces);
    const std::uint64_t rays = smooth.add(instant.posed_scene.tracer(), places, known, own);
    const std::vector<glm::vec3> all = system.solve(own, std::vector<glm::vec3>(count, fog.albedo()));
    for (std::size_t i = 0; i < count; ++i) lit.corners()[i].rest = all[i];
    return rays;
}

}  // namespace

void light_fog(const AirInstant& instant, PosedScene& posed_scene, std::uint64_t& rays) {
    LitFog lit = lattice_in(*posed_scene.air()->fog());
    if (lit.empty()) return;
    const std::size_t corners = lit.corners().size();
    const std::vector<RayQuery> looks = rays_from(lit, numbers_of_fog(0), corners);
    const std::vector<LightPoint> points = points_beyond_rays(instant);
    const std::vector<LightPoint> lamps = air_lamps(points, instant.light_trees);
    light_by_lamps(instant, looks, lamps, lit);
    posed_scene.light_fog(lit);
    rays += 2 * looks.size() + corners * lamps.size() + light_by_rest(instant, looks, points, lit);
    posed_scene.light_fog(std::move(lit));
}

}  // namespace render2mpeg::renderer
