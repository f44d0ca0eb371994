#include "renderer/gather/near_light.h"

#include <algorithm>
#include <limits>
#include <map>
#include <numbers>

#include "core/color.h"
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

/// The near field begins at the irradiance of a white surface that is so many times as bright as half of what some rays
/// of the eye meet. chosen: 1 of 0.25 to 32. Two frames of many_lamps take 52 CPU s, 60 with 2, 166 without a near
/// field; a box at a fixed 2 % takes 1.9 s instead of 4.8, for an error of 1.7 instead of 1.4 %.
constexpr float near_over_typical = 1.0f;
constexpr std::uint64_t eye_rays = 256;

}  // namespace

NearField::NearField(std::span<const LightPoint> lights, float irradiance) : irradiance_(irradiance) {
    if (!(irradiance > 0.0f) || irradiance == std::numeric_limits<float>::infinity()) return;
    struct Sum {
        glm::dvec3 place{0};
        double power = 0;
    };
    std::map<std::uint32_t, Sum> objects;
    const auto add = [&](glm::vec3 centre, double power) {
        const auto inverse2 = static_cast<float>(irradiance / power);
        if (inverse2 > 0.0f && inverse2 < std::numeric_limits<float>::infinity())
            spheres_.push_back({centre, inverse2});
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

float near_irradiance(const PosedScene& posed_scene, const Plan& plan, const scene::Camera& camera, glm::ivec2 size) {
    const FlushDenormals flushed;
    const GatherRays rays(posed_scene, plan);
    SurfaceCache cache(posed_scene, plan);
    cache.forget({});
    std::vector<RayTerm> terms;
    std::uint64_t traced = 0;
    for (std::uint64_t i = 0; i < eye_rays; ++i) {
        const scene::Ray eye =
            camera.ray_through(glm::vec2(core::halton(0, i + 1), core::halton(1, i + 1)) * glm::vec2(size));
        const RayQuery ray{eye.origin, eye.direction, std::numeric_limits<float>::infinity()};
        rays.follow(ray, posed_scene.tracer().nearest(ray.origin, ray.direction, ray.far), {}, lobe::inverse_pi, i,
                    static_cast<std::uint32_t>(i), terms, traced);
    }
    std::vector<Sighting> wanted;
    for (const RayTerm& term : terms) wanted.push_back(term.place);
    cache.learn(wanted);
    std::vector<float> seen;
    for (const RayTerm& term : terms)
        seen.push_back(core::luminance(term.weight * cache.radiance(cache.index_of(term.place.key))));
    std::sort(seen.begin(), seen.end());
    const float typical = seen.empty() ? 0.0f : seen[seen.size() / 2];
    return typical > 0.0f ? near_over_typical * std::numbers::pi_v<float> * typical
                          : std::numeric_limits<float>::infinity();
}

std::vector<LightPoint> near_light(const PosedScene& posed_scene, std::span<const LightPoint> lights,
                                   const NearField& near_field, std::uint64_t& rays) {
    if (near_field.empty()) return {};
    PhotonSettings settings;
    settings.paths = photon_paths;
    PhotonResult photons = trace_photons(posed_scene, lights, settings);
    rays += photons.rays;
    std::uint32_t id = 0;
    std::erase_if(photons.vpls, [&](LightPoint& p) {
        const float share = near_field.share(p.position);
        if (!(share > 0.0f)) return true;
        p.disc2 = core::luminance(p.intensity) / near_field.irradiance(share);
        p.intensity *= share;
        p.id = id++;
        return false;
    });
    return photons.vpls;
}

}  // namespace render2mpeg::renderer
