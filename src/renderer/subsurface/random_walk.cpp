#include "renderer/subsurface/random_walk.h"

#include <algorithm>
#include <cmath>

#include "core/numeric.h"
#include "core/sampling.h"

namespace render2mpeg::renderer {
namespace {

/// Events of a walk at most. chosen: 1024; in a medium that scatters 0.999 a hundredth of the light
/// goes on, and one that absorbs nothing loses what does not leave by then.
constexpr int most_events = 1024;

/// Walks that carry less go on as likely as they carry. chosen: 0.1; not tuned.
constexpr float least_carried = 0.1f;

/// Channels whose light goes less far than this share of the farthest have so much: it leaves where it enters, within a
/// pixel of the others' blur.
constexpr float least_share = 0.01f;

/// Numbers of an event, 16 bits each: walks have many.
struct Numbers {
    float choice, turn, channel, distance;
    explicit Numbers(std::uint64_t bits) {
        const auto part = [&](unsigned k) { return (static_cast<float>(bits >> k & 0xffffu) + 0.5f) * 0x1p-16f; };
        choice = part(0);
        turn = part(16);
        channel = part(32);
        distance = part(48);
    }
};

float mean(glm::vec3 v) {
    return (v.x + v.y + v.z) / 3.0f;
}

}  // namespace

float scattering_albedo(float albedo) {
    // albedo = (1 - s) (1 - 0.139 s) / (1 + 1.17 s), where s is the root of what is absorbed.
    const float a = std::clamp(albedo, 0.0f, 1.0f), half = 0.5f * (1.139f + 1.17f * a);
    const float s = (half - std::sqrt(std::max(half * half - 0.139f * (1.0f - a), 0.0f))) / 0.139f;
    return std::clamp(1.0f - s * s, 0.0f, 1.0f);
}

std::optional<SurfacePoint> random_walk(const PosedScene& posed_scene, const SurfacePoint& point,
                                        const Stream& numbers) {
    const scene::Subsurface& below = *posed_scene.animation().materials[point.material].subsurface;
    const glm::vec3 surface = point.bsdf.diffuse / std::max(below.weight, 1e-6f);
    const glm::vec3 albedo(scattering_albedo(surface.x), scattering_albedo(surface.y), scattering_albedo(surface.z));
    const float longest = std::max({below.free_path.x, below.free_path.y, below.free_path.z});
    const glm::vec3 path = glm::max(below.free_path, least_share * longest);

    glm::vec3 direction, origin, carried(1);
    for (int event = 0; event < most_events; ++event) {
        const Stream of_event = numbers.at(static_cast<std::uint64_t>(event));
        const Numbers n(of_event.bits());
        direction = event == 0 ? core::sample_cosine_hemisphere(-point.geometric_normal, {n.choice, n.turn})
                               : core::sample_sphere({n.choice, n.turn});
        if (event == 0) origin = offset_origin(point, direction);
        // A channel tells how far: any might have, so that all count.
        const float scattered = 3.0f * mean(carried * albedo);
        if (!(scattered > 1e-12f)) return std::nullopt;  // all is absorbed
        const glm::vec3 chance = carried * albedo / scattered;
        const int channel = n.channel < chance.x ? 0 : n.channel < chance.x + chance.y ? 1 : 2;
        const float far = -std::log(1.0f - n.distance) * path[channel];
        const Hit hit = posed_scene.tracer().nearest_of(point.address.object, {origin, direction, far});
        const glm::vec3 passes = glm::exp(-(hit.found() ? hit.distance : far) / path);
        if (hit.found()) {
            SurfacePoint place = posed_scene.surface_at(hit.address, direction);
            place.bsdf = {};
            place.bsdf.diffuse = below.weight * carried * passes / std::max(glm::dot(chance, passes), 1e-30f);
            place.emission = glm::vec3(0);
            place.outgoing = place.shading_normal;
            return core::is_finite(place.bsdf.diffuse) ? std::optional(place) : std::nullopt;
        }
        carried *= albedo * passes / path / std::max(glm::dot(chance, passes / path), 1e-30f);
        const float most = std::max({carried.x, carried.y, carried.z});
        if (most < least_carried) {
            if (!(of_event.uniform(0) * least_carried < most)) return std::nullopt;
            carried *= least_carried / most;
        }
        origin += far * direction;
    }
    return std::nullopt;
}

}  // namespace render2mpeg::renderer
