#include "renderer/paths/light_paths.h"

#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "core/color.h"
#include "core/numeric.h"
#include "core/sampling.h"
#include "renderer/base/flush_denormals.h"
#include "renderer/paths/scatterer.h"
#include "renderer/subsurface/random_walk.h"
#include "renderer/surface/light_ray.h"
#include "renderer/surface/lobe_albedo.h"

namespace render2mpeg::renderer {
namespace {

/// Against a ray that never leaves: roulette leaves one path of 10^17 to so many events on one ray.
constexpr int most_events = 4096;

/// Fibres keep so much of what they scatter: light stays among white ones for hundreds of them, and ends.
constexpr float largest_hair_albedo = 0.9995f;

float mean(glm::vec3 v) {
    return (v.x + v.y + v.z) / 3.0f;
}

/// Share of f_s that is the lobe's, per channel.
glm::vec3 share_of_lobe(const SurfacePoint& p, glm::vec3 direction) {
    Bsdf lobe = p.bsdf;
    lobe.diffuse = glm::vec3(0);
    const glm::vec3 part = evaluate(lobe, p.shading_normal, p.outgoing, direction),
                    whole = evaluate(p.bsdf, p.shading_normal, p.outgoing, direction);
    glm::vec3 share;
    for (int c = 0; c < 3; ++c) share[c] = core::divide_or(part[c], whole[c], 0.0f);
    return share;
}

}  // namespace

/// Event at a surface on a ray: the path is over, the ray goes on, the path scatters there.
enum class LightPaths::Event : std::uint8_t { ends, passes, lands };

/// A path on its way.
struct LightPaths::Way {
    Scatterer at;             ///< the last place that scattered
    glm::vec3 throughput{1};  ///< until there; after `leave`, of what comes along the ray
    LightRay ray;
    float density = 0;          ///< of the ray's direction
    bool first = true;          ///< `at` is where the path began
    bool mirrored = false;      ///< a mirror lies between `at` and the ray
    glm::vec3 seen_in_lobe{0};  ///< share of a narrow lobe, on the ray from the first point; 0: it is not narrow

    void stand_on(Scatterer place) {
        at = std::move(place);
        mirrored = false;
    }
    /// Of light that was met by a direction that `other` chooses as well. [Veach1995, balance heuristic]
    float weight(float other) const { return mirrored ? 1.0f : density / (density + other); }
};

LightPaths::LightPaths(const PosedScene& posed_scene, const Plan& plan)
    : posed_scene_(posed_scene),
      sky_light_(plan.runs(Pass::sky_light) && posed_scene.sky() != nullptr),
      bodies_(plan.runs(Pass::caustics) ? Bodies::block : Bodies::pass),
      lights_(posed_scene, plan) {}

glm::vec3 LightPaths::scattered(const SurfacePoint& point, PathNumbers& numbers) const {
    return scattered(point, shadow_origin(point), numbers);
}

glm::vec3 LightPaths::scattered(const SurfacePoint& point, glm::vec3 origin, PathNumbers& numbers) const {
    const FlushDenormals flushed;
    Way way;
    if (point.below) {
        const auto place = random_walk(posed_scene_, point, core::mix(std::bit_cast<std::uint32_t>(numbers.next())));
        if (!place) return glm::vec3(0);
        way.stand_on({posed_scene_, *place});
    } else {
        way.stand_on({posed_scene_, point});
        way.at.leave_from(origin);
    }
    glm::vec3 light(0);
    do light += asked(way, numbers);
    while (leave(way, numbers) && meet(way, numbers, light));
    return core::is_finite(light) ? light : glm::vec3(0);
}

/// Direct light at the point.
glm::vec3 LightPaths::asked(const Way& way, PathNumbers& numbers) const {
    const auto number = [&](FirstNumber which) { return way.first ? numbers.first(which) : numbers.next(); };
    // One by one: the order in which arguments are evaluated is not told.
    struct Three {
        float choice, u, v;
    };
    const auto three = [&](FirstNumber choice, FirstNumber u, FirstNumber v) {
        return Three{number(choice), number(u), number(v)};
    };
    glm::vec3 sum(0);
    if (lights_.has_lamps()) {
        const Three n = three(FirstNumber::lamp, FirstNumber::lamp_u, FirstNumber::lamp_v);
        sum += answer(way, lights_.to_lamp(way.at.query(), n.choice, {n.u, n.v}));
    }
    if (lights_.has_surfaces()) {
        const Three n = three(FirstNumber::surface, FirstNumber::surface_u, FirstNumber::surface_v);
        sum += answer(way, lights_.to_surface(way.at.query(), n.choice, {n.u, n.v}));
    }
    if (lights_.has_sky()) {
        const Three n = three(FirstNumber::sky, FirstNumber::sky_u, FirstNumber::sky_v);
        sum += answer(way, lights_.to_sky(way.at.query(), n.choice, {n.u, n.v}));
    }
    return way.throughput * sum;
}

glm::vec3 LightPaths::answer(const Way& way, const LightSample& sample) const {
    if (!(core::luminance(sample.light) > 0.0f) || !way.at.query().may_see(sample.direction)) return glm::vec3(0);
    const Scattered to = way.at.scattered(sample.direction, sample.density > 0.0f);
    glm::vec3 share = to.share * sample.light;
    if (!(mean(share) > 0.0f)) return glm::vec3(0);
    if (sample.density > 0.0f) share *= sample.density / (sample.density + to.density);
    if (posed_scene_.air() != nullptr) {
        const float length = glm::length(sample.ray);
        const glm::vec3 direction = core::normalize_or(sample.ray, sample.direction);
        const Air& air = *posed_scene_.air();
        share *= std::isinf(sample.far) ? std::exp(-air.depth_to_sky(way.at.query().origin, direction))
                                        : air.transmittance(way.at.query().origin, direction, length * sample.far);
    }
    const float skipped = way.at.skipped(sample.ray);
    if (!(skipped < sample.far)) return share;
    return share * posed_scene_.tracer().passes(way.at.origin_of(sample.ray), sample.ray, sample.far - skipped,
                                                way.first ? bodies_ : Bodies::pass);
}

/// Chooses where the path goes on from its point.
bool LightPaths::leave(Way& way, PathNumbers& numbers) const {
    const auto number = [&](FirstNumber which) { return way.first ? numbers.first(which) : numbers.next(); };
    const float choice = number(FirstNumber::lobe), u = number(FirstNumber::direction_u),
                v = number(FirstNumber::direction_v);
    glm::vec3 weight(0);
    way.density = way.at.sample(choice, {u, v}, way.ray.direction, weight);
    if (!(way.density > 0.0f) || !way.at.query().may_see(way.ray.direction)) return false;
    way.throughput *= weight;
    if (!(mean(way.throughput) > 0.0f) || !core::is_finite(way.throughput)) return false;
    way.ray.origin = way.at.origin_of(way.ray.direction);
    const SurfacePoint& p = way.at.point();
    way.seen_in_lobe = way.first && p.bsdf.has_narrow_lobe() ? share_of_lobe(p, way.ray.direction) : glm::vec3(0);
    return true;
}

/// Goes along the ray until the next surface that scatters; adds what shines on the way.
bool LightPaths::meet(Way& way, PathNumbers& numbers, glm::vec3& light) const {
    for (int event = 0; event < most_events; ++event) {
        const Hit hit = way.ray.meet(posed_scene_);
        way.throughput *=
            way.ray.left_by_air(posed_scene_, hit.found() ? hit.distance : std::numeric_limits<float>::infinity());
        if (!hit.found()) {
            light += way.throughput * escaped(way);
            return false;
        }
        const SurfacePoint met = way.ray.surface_at(posed_scene_, hit);
        light += way.throughput * emitted(way, met);
        const float choice = way.first && event == 0 ? numbers.first(FirstNumber::event) : numbers.next();
        const Event what = go_on(way, met, choice);
        if (what != Event::passes) return what == Event::lands;
    }
    return false;
}

/// Radiance from where the ray leaves the scene.
glm::vec3 LightPaths::escaped(const Way& way) const {
    glm::vec3 sum(0);
    if (sky_light_)
        sum =
            posed_scene_.sky()->radiance(way.ray.direction, 0.0f) * way.weight(lights_.sky_density(way.ray.direction));
    if (way.first && way.mirrored) return sum;
    return sum + lights_.suns(way.at.query(), way.ray.direction, [&](float other) { return way.weight(other); });
}

/// Radiance that a surface on the ray sends back along it.
glm::vec3 LightPaths::emitted(const Way& way, const SurfacePoint& met) const {
    if (!(mean(met.emission) > 0.0f)) return glm::vec3(0);
    // Unlit surfaces are a picture's, no lamps: only lobes that rays look along show them.
    if (met.unlit) return way.first ? met.alpha * way.seen_in_lobe * met.emission : glm::vec3(0);
    if (way.first && way.mirrored) return glm::vec3(0);
    // Alpha hides what is seen of a lamp, not what it shines.
    return met.emission * way.weight(lights_.surface_density(way.at.query(), met.address));
}

/// Continues the path at a surface. Roulette by the light that each event would carry on, as photons have it.
LightPaths::Event LightPaths::go_on(Way& way, const SurfacePoint& met, float choice) const {
    Scatterer there(posed_scene_, met);
    ScatteringShares shares;
    shares[Scattering::diffuse] = there.albedo();
    shares[Scattering::beyond] = met.bsdf.diffuse_transmission;
    shares[Scattering::mirror] = met.bsdf.mirror;
    shares[Scattering::glass] = met.bsdf.transmission;
    // No surface is brighter than the brightest.
    const float largest = there.is_fibre() ? largest_hair_albedo : largest_albedo;
    const float whole = core::divide_or(mean(way.throughput * shares.sum()), mean(way.throughput), 0.0f);
    const float cut = met.alpha * (whole > largest ? largest / whole : 1.0f);
    for (glm::vec3& share : shares.of) share *= cut;
    // All that goes straight on is one event.
    shares[Scattering::glass] = glm::vec3(0);
    const bool translucent = met.alpha < 1.0f || mean(met.bsdf.transmission) > 0.0f;
    if (translucent && !(way.first && bodies_ == Bodies::block && bends_light(posed_scene_, met)))
        shares[Scattering::layer] = posed_scene_.transmittance_at(met.address, way.ray.direction);
    // No caustic on the first surface; its narrow lobe alone looks into mirrors.
    if (way.first) shares[Scattering::mirror] *= way.seen_in_lobe;

    std::array<float, scatterings> chances = shares.chances(way.throughput);
    const float sum = std::accumulate(chances.begin(), chances.end(), 0.0f);
    if (sum > 1.0f)
        for (float& c : chances) c /= sum;
    const std::size_t found = chosen(chances, choice);
    if (found == scatterings) return Event::ends;
    switch (static_cast<Scattering>(found)) {
        case Scattering::mirror:
            way.throughput *= shares.of[found] / chances[found];
            way.ray.reflect(met, met.shading_normal);
            way.mirrored = true;
            if (way.first) way.seen_in_lobe = glm::vec3(1);
            return Event::passes;
        case Scattering::beyond:
            there = Scatterer(posed_scene_, posed_scene_.other_side(met));
            break;
        case Scattering::diffuse:
            break;
        default:
            way.throughput *= shares.of[found] / chances[found];
            way.ray.leave(met, way.ray.direction);
            return Event::passes;
    }
    // What the place reflects is weighed where the path leaves it.
    way.throughput *= cut / chances[found];
    way.first = false;
    way.stand_on(std::move(there));
    return Event::lands;
}

}  // namespace render2mpeg::renderer
