#include "renderer/air/smooth_air.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "core/color.h"
#include "core/numeric.h"
#include "parallel/loops.h"
#include "renderer/cut/gatherer.h"

namespace render2mpeg::renderer {
namespace {

/// How well places are lit: clusters at most, and what of all their light they may be off by. chosen: 512 and 10 %;
/// errors of neighbours are averaged along rays, and what air adds to a pixel is a part of its light. With 64 clusters
/// fog was 3 to 4 % too dark.
constexpr int most_clusters = 512;
constexpr float relative_tolerance = 0.1f;

/// Normals of an icosahedron's corners: irradiance on twelve such sides, over 3, is the light from all directions to 8
/// % of that of any one.
std::vector<glm::vec3> sides() {
    constexpr float phi = std::numbers::phi_v<float>;
    std::vector<glm::vec3> all;
    for (const float a : {-1.0f, 1.0f})
        for (const float b : {-phi, phi})
            for (const glm::vec3 v : {glm::vec3(0, a, b), glm::vec3(a, b, 0), glm::vec3(b, 0, a)})
                all.push_back(glm::normalize(v));
    return all;
}

/// White sides of a body at a place.
std::vector<GatherPoint> body_at(glm::vec3 place, const std::vector<glm::vec3>& normals) {
    std::vector<GatherPoint> points(normals.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
        SurfacePoint& p = points[i].point;
        p.position = place;
        p.geometric_normal = p.shading_normal = p.outgoing = normals[i];
        p.bsdf.diffuse = glm::vec3(1);
    }
    return points;
}

/// Light from all directions over 4 pi, by the sum of irradiances over pi.
glm::vec3 fluence_of(glm::vec3 sum) {
    sum *= 1.0f / (3.0f * 4.0f * std::numbers::pi_v<float>);
    return core::is_finite(sum) ? glm::max(sum, glm::vec3(0)) : glm::vec3(0);
}

/// `known`: light that the place has already, mean luminance over all directions.
glm::vec3 gather_at(glm::vec3 place, float known, const std::vector<glm::vec3>& normals, Gatherer& gatherer,
                    std::uint64_t& rays) {
    const std::vector<GatherPoint> points = body_at(place, normals);
    std::vector<const GatherPoint*> all;
    GroupTolerance tolerance;
    for (const GatherPoint& p : points) all.push_back(&p);
    const float allowed = relative_tolerance * std::numbers::pi_v<float> * known;  // of a side's irradiance
    for (int i = 0; i < lane_count; ++i) tolerance.set(i, {{allowed, relative_tolerance}, 0.0f});
    GatherLanes lanes;
    fill(lanes, all);
    lanes.at_one_place = true;
    GatheredLight light;
    CutLimits limits;
    limits.most = most_clusters;
    gatherer.gather(lanes, tolerance, limits, light);
    rays += light.shadow_rays;
    glm::vec3 sum(0);
    for (int i = 0; i < static_cast<int>(points.size()); ++i) sum += light.direct.at(i) + light.indirect.at(i);
    return fluence_of(sum);
}

}  // namespace

SmoothAirLight::SmoothAirLight(const LightTrees& light_trees, std::span<const LightPoint> points, bool bounces)
    : trees(light_trees) {
    trees.exact.clear();
    trees.trees[static_cast<std::size_t>(LightType::punctual)] = {};
    trees.trees[static_cast<std::size_t>(LightType::punctual)].type = LightType::punctual;
    if (!bounces)
        for (int tree = LightTrees::direct_trees; tree < LightTrees::tree_count; ++tree)
            trees.trees[static_cast<std::size_t>(tree)] = {};
    // Suns that are clustered among points of the sky count by themselves.
    std::vector<LightPoint> sky;
    bool suns = false;
    for (const LightPoint& p : points) {
        if (!p.is_far()) continue;
        suns = suns || !p.is_of_sky();
        if (p.is_of_sky()) sky.push_back(p);
    }
    if (suns)
        trees.trees[static_cast<std::size_t>(LightType::directional)] =
            build_light_tree(LightType::directional, sky, 1);
    std::erase_if(trees.lamps, [](const auto& lamp) { return lamp->is_round(); });
    shines = !trees.lamps.empty() ||
             std::any_of(trees.trees.begin(), trees.trees.end(), [](const LightTree& tree) { return !tree.empty(); });
}

std::uint64_t SmoothAirLight::add(const RayTracer& tracer, std::span<const glm::vec3> places,
                                  std::span<const float> known, std::span<glm::vec3> light) const {
    if (!shines) return 0;
    const std::vector<glm::vec3> normals = sides();
    constexpr std::size_t grain = 32;
    std::vector<std::uint64_t> task_rays((places.size() + grain - 1) / grain, 0);
    parallel::for_ranges(places.size(), grain, [&](std::size_t from, std::size_t to) {
        Gatherer gatherer(trees, tracer);
        for (std::size_t i = from; i < to; ++i)
            light[i] += gather_at(places[i], known[i], normals, gatherer, task_rays[from / grain]);
    });
    return std::accumulate(task_rays.begin(), task_rays.end(), std::uint64_t{0});
}

}  // namespace render2mpeg::renderer
