#include "renderer/paths/light_paths.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/color.h"
#include "core/numeric.h"
#include "renderer/base/flush_denormals.h"
#include "renderer/paths/scatterer.h"
#include "renderer/subsurface/random_walk.h"
#include "renderer/surface/light_ray.h"
#include "renderer/surface/lobe_albedo.h"

namespace render2mpeg::renderer {
namespace {

/// Against a ray that never leaves: roulette leaves one path of 10^17 to so many events on one ray.
constexpr int most_events = 4096;

/// Largest albedo of fibres: light stays among white ones for hundreds of them, and ends.
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

/// State of a path.
struct LightPaths::Path {
    Scatterer at;             ///< the last place that scattered
    glm::vec3 throughput{1};  ///< until there; after `leave`, of the ray
    LightRay ray;
    float density = 0;          ///< of the ray's direction
    bool first = true;          ///< `at` is where the path began
    bool mirrored = false;      ///< a mirror lies between `at` and the ray
    bool in_pane = false;       ///< a pane does, in which rays see the sky
    bool behind_body = false;   ///< glass that bends light is between: caustics have light of lamps and sky
    glm::vec3 seen_in_lobe{0};  ///< share of a narrow lobe, on the ray from the first point; 0: it is not narrow
    glm::vec3 sky_share{1};     ///< of the sky's light that counts; caustics have the rest

    void stand_on(const Scatterer& place) {
        at = place;
        mirrored = in_pane = false;
        sky_share = glm::vec3(1);
    }
    /// Of light that was met by a direction that `other` chooses as well. [Veach1995, balance heuristic]
    float weight(float other) const { return mirrored ? 1.0f : density / (density + other); }
};

LightPaths::LightPaths(const PosedScene& posed_scene, const Plan& plan)
    : posed_scene_(posed_scene),
      sky_light_(plan.runs(Pass::sky_light) && posed_scene.sky() != nullptr),
      sky_in_panes_(plan.rays_see_sky_in_panes() ? brightest_of_rays(posed_scene.sky()) : 0.0f),
      bodies_(plan.runs(Pass::caustics) ? Bodies::block : Bodies::pass),
      lights_(posed_scene, plan) {}

glm::vec3 LightPaths::scattered(const SurfacePoint& point, PathNumbers& numbers) const {
    return scattered(point, shadow_origin(point), numbers);
}

glm::vec3 LightPaths::scattered(const SurfacePoint& point, glm::vec3 origin, PathNumbers& numbers) const {
    const FlushDenormals flushed;
    Path path;
    if (point.below) {
        const auto place = random_walk(posed_scene_, point, numbers.next_stream());
        if (!place) return glm::vec3(0);
        path.stand_on({posed_scene_, *place});
    } else {
        path.stand_on({posed_scene_, point});
        path.at.leave_from(origin);
    }
    glm::vec3 light(0);
    do light += asked(path, numbers);
    while (leave(path, numbers) && meet(path, numbers, light));
    return core::is_finite(light) ? light : glm::vec3(0);
}

/// Direct light at the point.
glm::vec3 LightPaths::asked(const Path& path, PathNumbers& numbers) const {
    const auto number = [&](FirstNumber which) { return path.first ? numbers.first(which) : numbers.next(); };
    glm::vec3 sum(0);
    const auto ask = [&](const SourceTree& lights, FirstNumber choice, FirstNumber u, FirstNumber v) {
        if (lights.empty()) return;
        // One by one: the order in which arguments are evaluated is not told.
        const float chosen = number(choice), x = number(u), y = number(v);
        sum += answer(path, lights.sample(path.at.query(), chosen, {x, y}));
    };
    ask(lights_.lamps(), FirstNumber::lamp, FirstNumber::lamp_u, FirstNumber::lamp_v);
    ask(lights_.surfaces(), FirstNumber::surface, FirstNumber::surface_u, FirstNumber::surface_v);
    ask(lights_.skies(), FirstNumber::sky, FirstNumber::sky_u, FirstNumber::sky_v);
    return path.throughput * sum;
}

glm::vec3 LightPaths::answer(const Path& path, const LightSample& sample) const {
    if (!(core::luminance(sample.light) > 0.0f) || !path.at.query().may_see(sample.direction)) return glm::vec3(0);
    const Scattered to = path.at.scattered(sample.direction, sample.density > 0.0f);
    glm::vec3 share = to.share * sample.light;
    if (!(mean(share) > 0.0f)) return glm::vec3(0);
    if (sample.density > 0.0f) share *= sample.density / (sample.density + to.density);
    if (posed_scene_.air() != nullptr) {
        const float way = std::isinf(sample.far) ? sample.far : glm::length(sample.ray) * sample.far;
        const glm::vec3 direction = core::normalize_or(sample.ray, sample.direction);
        share *= posed_scene_.air()->left_of_light(path.at.query().origin, direction, way);
    }
    const float skipped = path.at.skipped(sample.ray);
    if (!(skipped < sample.far)) return share;
    return share * posed_scene_.tracer().passes(path.at.origin_of(sample.ray), sample.ray, sample.far - skipped,
                                                path.first ? bodies_ : Bodies::pass);
}

/// Chooses where the path goes on from its point.
bool LightPaths::leave(Path& path, PathNumbers& numbers) const {
    const auto number = [&](FirstNumber which) { return path.first ? numbers.first(which) : numbers.next(); };
    const float choice = number(FirstNumber::lobe), u = number(FirstNumber::direction_u),
                v = number(FirstNumber::direction_v);
    glm::vec3 weight(0);
    path.density = path.at.sample(choice, {u, v}, path.ray.direction, weight);
    if (!(path.density > 0.0f) || !path.at.query().may_see(path.ray.direction)) return false;
    path.throughput *= weight;
    if (!(mean(path.throughput) > 0.0f) || !core::is_finite(path.throughput)) return false;
    path.ray.origin = path.at.origin_of(path.ray.direction);
    const SurfacePoint& p = path.at.point();
    path.seen_in_lobe = path.first && p.bsdf.has_narrow_lobe() ? share_of_lobe(p, path.ray.direction) : glm::vec3(0);
    return true;
}

/// Goes along the ray until the next surface that scatters; adds emission on the path.
bool LightPaths::meet(Path& path, PathNumbers& numbers, glm::vec3& light) const {
    const LayerLimit& limit = posed_scene_.tracer().limit();
    int covers = 0;
    for (int event = 0; event < most_events; ++event) {
        const Hit hit = path.ray.meet(posed_scene_);
        const float way = hit.found() ? hit.distance : std::numeric_limits<float>::infinity();
        if (const Air* air = posed_scene_.air(); air != nullptr && path.ray.media.empty())
            light += path.throughput * air->light_for_rays(path.ray.origin, path.ray.direction, way);
        path.throughput *= path.ray.left_by_air(posed_scene_, way);
        if (!hit.found()) {
            light += path.throughput * escaped(path);
            return false;
        }
        const SurfacePoint met = path.ray.surface_at(posed_scene_, hit);
        light += path.throughput * emitted(path, met);
        if (limit.ends(covers)) return false;
        covers += limit.counts(hit.address.object) ? 1 : 0;
        const float choice = path.first && event == 0 ? numbers.first(FirstNumber::event) : numbers.next();
        const Event what = go_on(path, met, choice);
        if (what != Event::passes) return what == Event::lands;
    }
    return false;
}

/// Radiance from where the ray leaves the scene.
glm::vec3 LightPaths::escaped(const Path& path) const {
    glm::vec3 sum(0);
    if (path.first && path.behind_body) return sum;
    if (sky_light_)
        sum = posed_scene_.sky()->radiance(path.ray.direction, 0.0f) *
              path.weight(lights_.sky_density(path.ray.direction)) * path.sky_share;
    if (path.in_pane) sum *= std::min(core::divide_or(sky_in_panes_, core::luminance(sum), 1.0f), 1.0f);
    if (path.first && path.mirrored) return sum;
    return sum + lights_.suns(path.at.query(), path.ray.direction, [&](float other) { return path.weight(other); });
}

/// Radiance that a surface on the ray sends back along it.
glm::vec3 LightPaths::emitted(const Path& path, const SurfacePoint& met) const {
    if (!(mean(met.emission) > 0.0f)) return glm::vec3(0);
    // Unlit surfaces are a picture's, no lamps: only lobes that rays look along show them.
    if (met.unlit) return path.first ? met.alpha * path.seen_in_lobe * met.emission : glm::vec3(0);
    if (path.first && (path.mirrored || path.behind_body)) return glm::vec3(0);
    // Alpha hides a lamp from the eye, and none of its light.
    return met.emission * path.weight(lights_.surface_density(path.at.query(), met.address));
}

/// Continues the path at a surface. Roulette by the light that each event would carry on, as photons have it.
LightPaths::Event LightPaths::go_on(Path& path, const SurfacePoint& met, float choice) const {
    Scatterer there(posed_scene_, met);
    ScatteringShares shares;
    shares[Scattering::diffuse] = there.albedo();
    shares[Scattering::beyond] = met.bsdf.diffuse_transmission;
    const bool straight = posed_scene_.passes_straight(met.address.object);
    shares[Scattering::mirror] = mirrored_beside_straight(posed_scene_, met);
    if (!straight) shares[Scattering::glass] = met.bsdf.transmission;
    // No surface is brighter than the brightest.
    const float largest = there.is_fibre() ? largest_hair_albedo : largest_albedo;
    const float whole = core::divide_or(mean(path.throughput * shares.sum()), mean(path.throughput), 0.0f);
    const float cut = met.alpha * (whole > largest ? largest / whole : 1.0f);
    for (glm::vec3& share : shares.of) share *= cut;
    // All that goes straight on is one event.
    shares[Scattering::glass] = glm::vec3(0);
    const bool translucent = met.alpha < 1.0f || straight || mean(met.bsdf.transmission) > 0.0f;
    const bool bends = translucent && path.first && bodies_ == Bodies::block && bends_light(posed_scene_, met);
    if (translucent) shares[Scattering::layer] = posed_scene_.transmittance_at(met.address, path.ray.direction);

    std::array<float, scatterings> chances = shares.chances(path.throughput);
    const float sum = std::accumulate(chances.begin(), chances.end(), 0.0f);
    if (sum > 1.0f)
        for (float& c : chances) c /= sum;
    const std::size_t found = chosen(chances, choice);
    if (found == scatterings) return Event::ends;
    switch (static_cast<Scattering>(found)) {
        case Scattering::mirror:
            path.throughput *= shares.of[found] / chances[found];
            path.ray.reflect(met, met.shading_normal);
            // The first surface has lamps and the sky in mirrors by caustics, in its narrow lobe by this path; in panes
            // the sky.
            path.in_pane =
                path.first && !path.mirrored && straight && sky_in_panes_ > 0.0f && !(mean(path.seen_in_lobe) > 0.0f);
            if (path.first && !path.in_pane) path.sky_share = path.seen_in_lobe;
            path.mirrored = true;
            return Event::passes;
        case Scattering::beyond:
            there = Scatterer(posed_scene_, posed_scene_.other_side(met));
            break;
        case Scattering::diffuse:
            break;
        default:
            path.throughput *= shares.of[found] / chances[found];
            path.ray.leave(met, path.ray.direction);
            path.behind_body = path.behind_body || bends;
            return Event::passes;
    }
    // The surface's albedo enters where the path leaves it.
    path.throughput *= cut / chances[found];
    path.first = false;
    path.stand_on(there);
    return Event::lands;
}

}  // namespace render2mpeg::renderer
