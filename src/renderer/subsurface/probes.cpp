#include "renderer/subsurface/probes.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/numeric.h"
#include "core/sampling.h"
#include "renderer/subsurface/profile.h"

namespace render2mpeg::renderer {
namespace {

/// Probes at a time: two along the normal, one along each tangent, as often as [King2013] has them.
constexpr int probes = 4;
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

std::optional<SurfacePoint> probe(const PosedScene& posed_scene, const SurfacePoint& point, std::uint64_t number) {
    const scene::Subsurface& below = *posed_scene.animation().materials[point.material].subsurface;
    const SubsurfaceProfile profile(point.bsdf.diffuse / std::max(below.weight, 1e-6f), below.free_path);
    const Axes axes(point.geometric_normal);
    std::optional<SurfacePoint> chosen;
    float sum = 0.0f, left = core::uniform(number, 0, 5);
    const auto offer = [&](SurfacePoint place, glm::vec3 share) {
        const float own = share.x + share.y + share.z;
        if (!(own > 0.0f) || !core::is_finite(share)) return;
        sum += own;
        const float likely = own / sum;
        const bool taken = left < likely;
        left = taken ? left / likely : (left - likely) / (1.0f - likely);
        if (!taken) return;
        place.bsdf = {};
        place.bsdf.diffuse = share / own;
        place.emission = glm::vec3(0);
        place.outgoing = place.shading_normal = place.geometric_normal;
        chosen = place;
    };
    for (int i = 0; i < probes; ++i) {
        const int axis = std::max(i - 1, 0);
        const auto u = [&](std::uint64_t which) { return core::uniform(number, static_cast<std::uint64_t>(i), which); };
        const float r = profile.sample(u(0), u(1));
        // The two of the normal lie opposite.
        const float turn =
            2.0f * std::numbers::pi_v<float> * (core::uniform(number, 0, 2) + 0.5f * static_cast<float>(i));
        const glm::vec3 x = axes.axis[(axis + 1) % 3], y = axes.axis[(axis + 2) % 3], down = -axes.axis[axis];
        const float half = core::sqrt_or_zero(profile.reach() * profile.reach() - r * r);
        glm::vec3 origin = point.position + r * (std::cos(turn) * x + std::sin(turn) * y) - half * down;
        float far = 2.0f * half;
        for (int met = 0; met < most_met && far > 0.0f; ++met) {
            const Hit hit = posed_scene.tracer().nearest(origin, down, far);
            if (!hit.found()) break;
            SurfacePoint place = posed_scene.surface_at(hit.address, -down);
            far -= hit.distance;
            origin = offset_origin(place, down);
            if (hit.address.object != point.address.object) continue;
            // Light enters from outside, whichever way the probe came.
            if (place.back_side != point.back_side) place = posed_scene.surface_at(hit.address, down);
            const glm::vec3 offset = place.position - point.position;
            const float density = axes.density(profile, offset, place.geometric_normal);
            const glm::vec3 weight = profile.at(glm::length(offset)) / (std::max(density, 1e-20f) * probes);
            offer(place, point.bsdf.diffuse * glm::min(weight, glm::vec3(most_weight)));
        }
    }
    if (chosen) chosen->bsdf.diffuse *= sum;
    return chosen;
}

}  // namespace render2mpeg::renderer
