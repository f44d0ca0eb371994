#include "renderer/subsurface/probes.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/numeric.h"
#include "core/sampling.h"
#include "renderer/subsurface/profile.h"

namespace render2mpeg::renderer {
namespace {

/// Chances of the normal and of both tangents [King2013].
constexpr float chances[3] = {0.5f, 0.25f, 0.25f};

/// Surfaces that one probe meets; more are left out. chosen: 8, four folds.
constexpr int most_met = 8;

/// A place weighs no more than this: far ends of probes on surfaces that all three axes graze would be fireflies.
/// chosen: 16; not tuned.
constexpr float most_weight = 16.0f;

/// A point's normal and tangents.
struct Axes {
    glm::vec3 axis[3];

    explicit Axes(glm::vec3 normal) {
        axis[0] = normal;
        core::make_frame(normal, axis[1], axis[2]);
    }

    /// Density of all probes together at a place, per area.
    float density(const SubsurfaceProfile& profile, glm::vec3 offset, glm::vec3 normal) const {
        float sum = 0.0f;
        for (int k = 0; k < 3; ++k) {
            const float along = glm::dot(offset, axis[k]);
            const float across = core::sqrt_or_zero(glm::dot(offset, offset) - along * along);
            sum += chances[k] * profile.density(across) * std::abs(glm::dot(normal, axis[k]));
        }
        return sum;
    }
};

}  // namespace

void probe(const PosedScene& posed_scene, const SurfacePoint& point, std::uint64_t number, float time,
           std::vector<SurfacePoint>& places) {
    const scene::Subsurface& below = *posed_scene.animation().materials[point.material].subsurface;
    const SubsurfaceProfile profile(point.bsdf.diffuse, below.free_path);
    const Axes axes(point.geometric_normal);
    const glm::vec3 albedo = below.weight * point.bsdf.diffuse;
    for (int i = 0; i < probes_of_sample; ++i) {
        // The normal has two probes, which lie opposite, each tangent one.
        const int axis = std::max(i - 1, 0);
        const auto u = [&](std::uint64_t which) { return core::uniform(number, static_cast<std::uint64_t>(i), which); };
        const float r = profile.sample(u(0), u(1));
        const float turn =
            2.0f * std::numbers::pi_v<float> * (core::uniform(number, 0, 2) + 0.5f * static_cast<float>(i));
        const glm::vec3 x = axes.axis[(axis + 1) % 3], y = axes.axis[(axis + 2) % 3], down = -axes.axis[axis];
        const float half = core::sqrt_or_zero(profile.reach() * profile.reach() - r * r);
        glm::vec3 origin = point.position + r * (std::cos(turn) * x + std::sin(turn) * y) - half * down;
        float left = 2.0f * half;
        for (int met = 0; met < most_met && left > 0.0f; ++met) {
            const Hit hit = posed_scene.tracer().nearest(origin, down, left, time);
            if (!hit.found()) break;
            SurfacePoint place = posed_scene.surface_at(hit.address, -down, {}, time);
            left -= hit.distance;
            origin = offset_origin(place, down);
            if (hit.address.object != point.address.object) continue;
            // Light enters from outside, whichever way the probe came.
            if (place.back_side != point.back_side) place = posed_scene.surface_at(hit.address, down, {}, time);
            const glm::vec3 offset = place.position - point.position;
            const float density = axes.density(profile, offset, place.geometric_normal);
            const glm::vec3 weight =
                profile.at(glm::length(offset)) / (std::max(density, 1e-20f) * static_cast<float>(probes_of_sample));
            if (!core::is_finite(weight)) continue;
            place.bsdf = {};
            place.bsdf.diffuse = albedo * glm::min(weight, glm::vec3(most_weight));
            place.emission = glm::vec3(0);
            place.probed = true;
            places.push_back(place);
        }
    }
}

}  // namespace render2mpeg::renderer
