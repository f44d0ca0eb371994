#include "renderer/gather/near_light.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <utility>

#include "core/color.h"
#include "core/numeric.h"
#include "core/sampling.h"
#include "renderer/base/flush_denormals.h"
#include "renderer/base/lobe.h"
#include "renderer/gather/gather_ray.h"
#include "renderer/gather/surface_cache.h"
#include "renderer/lights/photons.h"

namespace render2mpeg::renderer {
namespace {

/// Photons of an instant. chosen: 16384 of 4096 to 131072; half as many err by a third more in many_lamps.
constexpr std::uint64_t photon_paths = 16384;
/// Light points that they leave, about, at most. chosen: 4096; cuts of 1000 err where there are many times as many.
constexpr std::uint32_t most_near_points = 4096;

/// The near field begins at the irradiance of a white surface that is so many times as bright as half of what is seen.
/// chosen: 1 of 0.25 to 32, by the time of many_lamps.
constexpr float near_over_typical = 1.0f;
/// A source is hidden that would light half of what is seen by so many times that. chosen: 64; in a box the lamp comes
/// to 8.
constexpr float hidden_over_near = 64.0f;
/// How far a near field reaches at most, over the distance of half of what is seen. chosen: 0.5; not tuned.
constexpr float most_reach = 0.5f;
constexpr std::uint64_t eye_rays = 256;

}  // namespace

NearField::NearField(std::span<const LightPoint> lights, const EyeLook& look)
    : irradiance_(near_over_typical * std::numbers::pi_v<float> * look.luminance) {
    if (!(irradiance_ > 0.0f) || !std::isfinite(irradiance_)) return;
    struct Sum {
        glm::dvec3 place{0};
        double power = 0;
    };
    std::map<std::uint32_t, Sum> objects;
    const auto add = [&](glm::vec3 centre, double power) {
        float inverse2 = static_cast<float>(irradiance_ / power);
        if (!look.places.empty()) {
            std::vector<float> distances2;
            for (const glm::vec3& place : look.places) distances2.push_back(glm::dot(place - centre, place - centre));
            const auto middle = distances2.begin() + static_cast<std::ptrdiff_t>(distances2.size() / 2);
            std::nth_element(distances2.begin(), middle, distances2.end());
            if (*middle * inverse2 * hidden_over_near < 1.0f) return;
            inverse2 = std::max(inverse2, core::divide_or(1.0f, most_reach * most_reach * *middle, 0.0f));
        }
        if (inverse2 > 0.0f && std::isfinite(inverse2)) spheres_.push_back({centre, inverse2});
    };
    for (const LightPoint& p : lights) {
        const double power = core::luminance(p.intensity);
        if (p.kind == LightPointKind::directional || !is_finite(p) || !(power > 0.0)) continue;
        if (p.kind != LightPointKind::oriented) {
            add(p.position, power);
            continue;
        }
        Sum& sum = objects[p.object];
        sum.place += power * glm::dvec3(p.position);
        sum.power += power;
    }
    for (const auto& [object, sum] : objects) add(glm::vec3(sum.place / sum.power), sum.power);
}

float NearField::share(glm::vec3 place) const {
    float least = 1.0f;
    for (const Sphere& s : spheres_) {
        const glm::vec3 d = place - s.centre;
        least = std::min(least, glm::dot(d, d) * s.inverse2);
    }
    return std::min(1.0f - least, 1.0f - 0x1p-20f);
}

EyeLook look_about(const PosedScene& posed_scene, const Plan& plan, const scene::Camera& camera, glm::ivec2 size) {
    const FlushDenormals flushed;
    const GatherRays rays(posed_scene, plan);
    SurfaceCache cache(posed_scene, plan);
    cache.forget({});
    std::vector<glm::vec3> places;
    std::vector<RayTerm> terms;
    std::uint64_t traced = 0;
    for (std::uint64_t i = 0; i < eye_rays; ++i) {
        const scene::Ray eye =
            camera.ray_through(glm::vec2(core::halton(0, i + 1), core::halton(1, i + 1)) * glm::vec2(size));
        const RayQuery ray{eye.origin, eye.direction, std::numeric_limits<float>::infinity()};
        const Hit hit = posed_scene.tracer().nearest(ray.origin, ray.direction, ray.far);
        if (hit.found()) places.push_back(ray.origin + hit.distance * ray.direction);
        rays.follow(ray, hit, {}, lobe::inverse_pi, i, static_cast<std::uint32_t>(i), terms, traced);
    }
    std::vector<Sighting> wanted;
    for (const RayTerm& term : terms) wanted.push_back(term.place);
    cache.learn(wanted);
    std::vector<float> seen;
    for (const RayTerm& term : terms)
        seen.push_back(core::luminance(term.weight * cache.radiance(cache.index_of(term.place.key))));
    std::sort(seen.begin(), seen.end());
    return {std::move(places), seen.empty() ? 0.0f : seen[seen.size() / 2]};
}

std::vector<LightPoint> near_light(const PosedScene& posed_scene, std::span<const LightPoint> lights,
                                   std::span<const LightPoint> average, const NearField& near_field,
                                   std::uint64_t& rays) {
    if (near_field.empty()) return {};
    // All that ever shine, those dark that do not now.
    std::map<std::uint32_t, const LightPoint*> by_id;
    for (const LightPoint& p : lights) by_id[p.id] = &p;
    std::vector<LightPoint> shining(average.begin(), average.end());
    for (LightPoint& p : shining) {
        const auto found = by_id.find(p.id);
        if (found != by_id.end())
            p = *found->second;
        else
            p.intensity = glm::vec3(0);
    }
    PhotonSettings settings;
    settings.paths = photon_paths;
    settings.planned = average;
    PhotonResult photons = trace_photons(posed_scene, shining, settings);
    rays += photons.rays;
    double all = 0;
    for (LightPoint& p : photons.vpls) {
        const float share = near_field.share(p.position);
        p.disc2 = share > 0.0f ? core::luminance(p.intensity) / near_field.irradiance(share) : 0.0f;
        p.intensity *= std::max(share, 0.0f);
        all += static_cast<double>(core::luminance(p.intensity));
    }
    // Weak ones stay with a chance, and are as strong as others then.
    const double strength = all / most_near_points;
    std::uint64_t number = 0;
    std::uint32_t id = 0;
    std::erase_if(photons.vpls, [&](LightPoint& p) {
        const double own = static_cast<double>(core::luminance(p.intensity));
        if (!(own > strength * static_cast<double>(core::uniform(most_near_points, number++)))) return true;
        const auto stronger = static_cast<float>(std::max(strength / own, 1.0));
        p.intensity *= stronger;
        p.disc2 *= stronger;
        p.id = id++;
        return false;
    });
    return photons.vpls;
}

}  // namespace render2mpeg::renderer
