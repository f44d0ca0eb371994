#include "renderer/air/ambient_air.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/numeric.h"
#include "parallel/loops.h"
#include "renderer/cut/gatherer.h"

namespace render2mpeg::renderer {
namespace {

/// Cells of the lattice at a place, over its distance from the eye. chosen: 1/4 of 1/2 to 1/8, some hundred corners for
/// each doubling of the distance.
constexpr float cell_of_distance = 0.25f;

/// The finest cells, over the scene's size.
constexpr float finest_cell = 1.0f / 256;

/// How well corners are lit: clusters at most, and what of their light they may be off by. chosen: 512 and 10 %; errors
/// of neighbours are averaged along rays, and what air adds to a pixel is a part of its light. Against 4,096 and 1 %
/// the light of the air errs by 0.3 and 1.0 % (root mean square) in colonnade and many_lamps in fog; with 64 clusters
/// by 10 and 8 %, and was 3 to 4 % too dark, more so the more light points there were.
constexpr int most_clusters = 512;
constexpr float relative_tolerance = 0.1f;

/// Gather rays of each of twelve sides of a corner: as many on all, so that their mean has no bias.
constexpr std::uint32_t rays_of_side = 32;

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

glm::vec3 gather_at(glm::vec3 place, const std::vector<glm::vec3>& normals, Gatherer& gatherer, std::uint64_t& rays) {
    const std::vector<GatherPoint> points = body_at(place, normals);
    std::vector<const GatherPoint*> all;
    GroupTolerance tolerance;
    for (const GatherPoint& p : points) all.push_back(&p);
    for (int i = 0; i < lane_count; ++i) tolerance.set(i, {{0.0f, relative_tolerance}, 0.0f});
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

std::uint64_t corner_key(int level, glm::ivec3 cell) {
    constexpr int reach = 1 << 18;
    const auto part = [](int v) { return static_cast<std::uint64_t>(std::clamp(v + reach, 0, 2 * reach - 1)); };
    return static_cast<std::uint64_t>(level + 64) << 57 | part(cell.x) << 38 | part(cell.y) << 19 | part(cell.z);
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

std::vector<glm::vec3> SmoothAirLight::at(const RayTracer& tracer, std::span<const glm::vec3> places,
                                          std::uint64_t& rays) const {
    std::vector<glm::vec3> light(places.size());
    const std::vector<glm::vec3> normals = sides();
    constexpr std::size_t grain = 32;
    std::vector<std::uint64_t> task_rays((places.size() + grain - 1) / grain, 0);
    parallel::for_ranges(places.size(), grain, [&](std::size_t from, std::size_t to) {
        Gatherer gatherer(trees, tracer);
        for (std::size_t i = from; i < to; ++i)
            light[i] = gather_at(places[i], normals, gatherer, task_rays[from / grain]);
    });
    for (const std::uint64_t r : task_rays) rays += r;
    return light;
}

struct AmbientAir::Corner {
    std::uint64_t key;
    glm::vec3 place;
};

void AmbientAir::start(std::int64_t lit_frame, const LightTrees& light_trees, std::span<const LightPoint> points,
                       FinalGather* gather, bool bounces, float extent) {
    gather_ = gather;
    bounces_ = bounces;
    least_distance_ = std::max(extent, 1e-6f) * finest_cell / cell_of_distance;
    const bool is_known = std::exchange(is_known_, false) && lit_frame == lit_frame_;
    if (lit_frame == lit_frame_ && !is_known) return;
    lit_frame_ = lit_frame;
    if (!is_known) {
        known_.clear();
        light_.clear();
    }
    smooth_ = SmoothAirLight(light_trees, points, bounces);
    shines_ = gather != nullptr || smooth_.shines;
}

/// Calls visit(key, corner, weight) for the corners about a place in the two lattices that its distance lies between.
template <class Visit>
void AmbientAir::for_each_corner(glm::vec3 place, float distance, Visit visit) const {
    const float level = std::clamp(std::log2(cell_of_distance * std::max(distance, least_distance_)), -60.0f, 60.0f);
    const int coarse = static_cast<int>(std::floor(level));
    for (int l = coarse; l <= coarse + 1; ++l) {
        const float share = l == coarse ? 1 - (level - static_cast<float>(coarse)) : level - static_cast<float>(coarse);
        const float size = std::ldexp(1.0f, l);
        const glm::vec3 at = glm::clamp(place / size, glm::vec3(-2e5f), glm::vec3(2e5f)), low = glm::floor(at);
        const glm::vec3 t = at - low;
        for (int c = 0; c < 8; ++c) {
            const glm::ivec3 step(c & 1, c >> 1 & 1, c >> 2);
            const glm::ivec3 cell = glm::ivec3(low) + step;
            const glm::vec3 w = glm::mix(1.0f - t, t, glm::vec3(step));
            visit(corner_key(l, cell), glm::vec3(cell) * size, share * w.x * w.y * w.z);
        }
    }
}

std::uint64_t AmbientAir::learn(const RayTracer& tracer, std::span<const glm::vec4> places) {
    std::vector<Corner> wanted;
    for (const glm::vec4& p : places)
        for_each_corner(glm::vec3(p), p.w, [&](std::uint64_t key, glm::vec3 place, float) {
            if (known_.emplace(key, static_cast<std::uint32_t>(light_.size() + wanted.size())).second)
                wanted.push_back({key, place});
        });
    const std::size_t first = light_.size();
    std::vector<glm::vec3> corners;
    for (const Corner& c : wanted) corners.push_back(c.place);
    std::uint64_t sum = 0;
    const std::vector<glm::vec3> found = smooth_.at(tracer, corners, sum);
    light_.insert(light_.end(), found.begin(), found.end());
    return sum + gather(wanted, first);
}

/// Adds what rays see from these corners, the first of which is light `first`.
std::uint64_t AmbientAir::gather(std::span<const Corner> corners, std::size_t first) {
    if (gather_ == nullptr) return 0;
    const std::vector<glm::vec3> normals = sides();
    const std::uint64_t before = gather_->counts().rays + gather_->counts().cell_rays;
    std::vector<std::vector<GatherPoint>> bodies;
    std::vector<GatherRequest> requests;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        bodies.push_back(body_at(corners[i].place, normals));
        for (const GatherPoint& side : bodies.back()) {
            GatherRequest r;
            r.point = &side;
            r.tolerance = {{1.0f, 0.0f}, 0.0f};
            r.rays = rays_of_side;
            r.bounces = bounces_;
            r.numbers = Stream(Purpose::rays_of_air, {.index = corners[i].key}).at(requests.size() % normals.size());
            r.pool = static_cast<std::uint32_t>(i);
            requests.push_back(r);
        }
    }
    const std::vector<RayLight> found = gather_->gather(requests, {});
    for (std::size_t i = 0; i < corners.size(); ++i) {
        glm::vec3 sum(0);
        for (std::size_t k = 0; k < normals.size(); ++k)
            sum += std::numbers::pi_v<float> * found[i * normals.size() + k].light[0];
        light_[first + i] += fluence_of(sum);
    }
    return gather_->counts().rays + gather_->counts().cell_rays - before;
}

glm::vec3 AmbientAir::fluence(glm::vec3 place, float distance) const {
    glm::vec3 sum(0);
    for_each_corner(place, distance, [&](std::uint64_t key, glm::vec3, float weight) {
        const auto found = known_.find(key);
        if (found != known_.end()) sum += weight * light_[found->second];
    });
    return sum;
}

}  // namespace render2mpeg::renderer
