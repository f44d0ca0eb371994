#include "tests/reference/path_tracer.h"

#include <cmath>
#include <limits>
#include <numbers>

#include "core/sampling.h"
#include "tests/reference/scattering.h"

namespace render2mpeg::reference {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();

/// Radiance scattered at p by punctual lights.
glm::dvec3 from_punctual(const renderer::PosedScene& posed_scene, const renderer::SurfacePoint& p) {
    glm::dvec3 sum(0);
    const Scattering scattering = scattering_of(posed_scene.animation(), p);
    for (const scene::LightState& light : posed_scene.posed().lights) {
        glm::dvec3 to_light = -glm::dvec3(light.direction), received(light.intensity);
        float far = infinity;
        const glm::vec3 normal_side = renderer::offset_origin(p, p.geometric_normal);
        if (light.kind != scene::LightKind::directional) {
            const glm::dvec3 d = glm::dvec3(light.position) - glm::dvec3(p.position);
            const double distance = glm::length(d);
            to_light = d / distance;
            received /= distance * distance;
            far = glm::length(light.position - normal_side);
            if (light.range > 0) received *= std::max(0.0, std::min(1.0, 1.0 - std::pow(distance / light.range, 4.0)));
            if (light.kind == scene::LightKind::spot) {
                const double cosine = glm::dot(-to_light, glm::dvec3(light.direction));
                const double scale = 1.0 / std::max(1e-3, static_cast<double>(light.cos_inner) - light.cos_outer);
                const double falloff = std::min(1.0, std::max(0.0, (cosine - light.cos_outer) * scale));
                received *= falloff * falloff;
            }
        }
        const glm::vec3 l(to_light);
        if (!(glm::dot(p.shading_normal, l) > 0.0f) || !(glm::dot(p.geometric_normal, l) > 0.0f)) continue;
        const glm::dvec3 passes(posed_scene.tracer().passes(normal_side, l, far));
        sum += scattering.times_cosine(p.shading_normal, p.outgoing, to_light) * received * passes;
    }
    return sum;
}

/// One path that starts at p: what it brings back to p's `outgoing`.
glm::dvec3 follow(const renderer::PosedScene& posed_scene, renderer::SurfacePoint p, int bounces, int least_bounces,
                  std::uint64_t seed, std::uint64_t path) {
    glm::dvec3 light(0), throughput(1);
    for (int bounce = 0; bounce <= bounces; ++bounce) {
        const bool counts = bounce >= least_bounces;
        if (counts) light += throughput * from_punctual(posed_scene, p);
        const auto key = static_cast<std::uint64_t>(2 * bounce);
        const glm::vec3 d = core::sample_cosine_hemisphere(
            p.shading_normal, {core::uniform(seed, path, key), core::uniform(seed, path, key + 1)});
        if (!(glm::dot(d, p.geometric_normal) > 0.0f) || !(glm::dot(d, p.shading_normal) > 1e-6f)) break;
        const glm::dvec3 to_light = glm::normalize(glm::dvec3(d));
        const double density = glm::dot(glm::dvec3(p.shading_normal), to_light) / std::numbers::pi;
        throughput *=
            scattering_of(posed_scene.animation(), p).times_cosine(p.shading_normal, p.outgoing, to_light) / density;
        const renderer::Hit hit = posed_scene.tracer().nearest(renderer::offset_origin(p, d), d, infinity);
        if (!hit.found()) {
            if (counts && posed_scene.sky() != nullptr)
                light += throughput * glm::dvec3(posed_scene.sky()->radiance(d, 0.0f));
            break;
        }
        p = posed_scene.surface_at(hit.address, -d);
        if (counts) light += throughput * glm::dvec3(p.emission);
    }
    return light;
}

}  // namespace

Estimate scattered_light(const renderer::PosedScene& posed_scene, const renderer::SurfacePoint& point, int bounces,
                         std::uint64_t samples, std::uint64_t seed, int least_bounces) {
    glm::dvec3 sum(0), squares(0);
    for (std::uint64_t i = 0; i < samples; ++i) {
        const glm::dvec3 l = follow(posed_scene, point, bounces, least_bounces, seed, i);
        sum += l;
        squares += l * l;
    }
    const auto n = static_cast<double>(samples);
    Estimate estimate;
    estimate.mean = sum / n;
    for (int k = 0; k < 3; ++k)
        estimate.error[k] = std::sqrt(std::max(0.0, squares[k] / n - estimate.mean[k] * estimate.mean[k]) / n);
    return estimate;
}

}  // namespace render2mpeg::reference
