#include "renderer/air/lamp_ways.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/numeric.h"
#include "core/sampling.h"
#include "renderer/cut/shadow_rays.h"

namespace render2mpeg::renderer {
namespace {

constexpr float no_bound = std::numeric_limits<float>::infinity();

/// Optical depths that ways keep at most.
constexpr float deepest_way = 60.0f;

}  // namespace

LampWay way_of_light(const AirInstant& instant, const LightPoint& lamp, glm::vec3 place) {
    LampWay found;
    const glm::vec3 way = lamp.is_far() ? -lamp.normal : lamp.position - place;
    const float length = glm::length(way);
    if (!lamp.is_far() && !(lamp.emitted(-way / std::max(length, 1e-20f), length * length) > 0.0f)) return found;
    const float before = core::divide_or(std::sqrt(lamp.disc2), length, 1.0f);
    const float far = lamp.is_far() ? no_bound : std::clamp(1.0f - before, 0.0f, shadow_ray_end);
    found.passes = instant.posed_scene.tracer().passes(place, way, far, instant.light_trees.bodies);
    if (found.passes == glm::vec3(0)) return found;
    const glm::vec3 direction = way / std::max(length, 1e-20f);
    found.depth = glm::min(
        instant.posed_scene.air()->depth_of_light(place, direction, lamp.is_far() ? no_bound : length), deepest_way);
    return found;
}

glm::vec3 mean_of_lamps(const AirInstant& instant, std::span<const LightPoint> lamps, glm::vec3 place,
                        float least_distance) {
    glm::vec3 sum(0);
    for (const LightPoint& lamp : lamps) {
        const LampWay way = way_of_light(instant, lamp, place);
        const glm::vec3 d = place - lamp.position;
        const float distance2 = lamp.is_far() ? 1.0f : std::max(glm::dot(d, d), least_distance * least_distance);
        const float emitted = lamp.is_far() ? 1.0f : lamp.emitted(core::normalize_or(d, lamp.normal), distance2);
        sum += way.passes * lamp.intensity * glm::exp(-way.depth) *
               (emitted / (4.0f * std::numbers::pi_v<float> * distance2));
    }
    return sum;
}

void add_even_rays(glm::vec3 place, std::size_t count, const Stream& numbers, std::vector<RayQuery>& rays) {
    // A random rotation.
    const glm::vec3 axis = core::sample_sphere({numbers.uniform(0), numbers.uniform(1)});
    const float turned = 2.0f * std::numbers::pi_v<float> * numbers.uniform(2);
    glm::vec3 a, b;
    core::make_frame(axis, a, b);
    for (std::size_t k = 0; k < count; ++k) {
        const float h = 1.0f - (2.0f * static_cast<float>(k) + 1.0f) / static_cast<float>(count);
        const float r = core::sqrt_or_zero(1.0f - h * h), angle = 2.39996323f * static_cast<float>(k) + turned;
        rays.push_back({place, glm::normalize(h * axis + r * (std::cos(angle) * a + std::sin(angle) * b)), no_bound});
    }
}

std::vector<FinalGather::Seen> seen_at_ends(const AirInstant& instant, std::span<const RayQuery> rays,
                                            const Stream& numbers, bool bounces) {
    if (instant.gather != nullptr) return instant.gather->seen_by(rays, numbers, bounces);
    std::vector<Hit> hits(rays.size());
    instant.posed_scene.tracer().any_nearest(rays, hits, false);
    std::vector<FinalGather::Seen> seen(hits.size());
    for (std::size_t i = 0; i < hits.size(); ++i) seen[i].distance = hits[i].found() ? hits[i].distance : no_bound;
    return seen;
}

}  // namespace render2mpeg::renderer
