// After photon ray splatting [Herzog2007, 4]. Changed: photons are aimed at what throws light, and only light that came
// by specular ways alone is kept (L S+ D); and in place of the density of the path, which knows nothing of focusing at
// mirrors, each photon carries how its neighbours differ [Igehy1999; Schjoth2007]: that is the density of the path with
// its Jacobian, exact at mirrors and lenses.
#include "renderer/caustics/caustic_photons.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/color.h"
#include "core/numeric.h"
#include "core/sampling.h"
#include "renderer/geometry/nearest_hits.h"
#include "renderer/surface/media_path.h"

namespace render2mpeg::renderer {
namespace {

/// Surfaces on one way. chosen: 12, of 8 to 16: a slab in the sun loses less than 1e-4 of its light.
constexpr int most_surfaces = 12;

/// Least share of a photon that is followed further.
constexpr float least_share = 1e-3f;

/// First Halton dimension of choices on the way; two for each surface.
constexpr int first_choice = 3;

/// Semi-axis of a kernel in cells. fit: docs/measurements.md#caustics
float smoothness(float photons) {
    return std::clamp(2.8f * std::pow(1e-4f * photons, 0.25f), 2.0f, 8.0f);
}

/// A photon on its way, with its four neighbours: two on the caster, two on the lamp.
struct Ray {
    glm::vec3 origin{0}, direction{0}, flux{0};
    std::array<glm::vec3, 4> place{}, turn{};  ///< differences of origin and direction
    float spread = 0;                          ///< angle by which rough glass has widened it
    float blur = 0;                            ///< radius of the same
    float time = scene::middle_time;           ///< of the shutter
    bool from_far = false;                     ///< on its first way, from infinitely far
    MediaPath glass;
};

/// Chooses the step so that the normals of neighbours are asked for within the triangle, then scales back.
void turn_at(const PosedScene& scene, const SurfacePoint& point, glm::vec3 facet, bool passes, Ray& ray) {
    // chosen: neighbours at 1/1000 of the cell: normals bend evenly over that, and digits are left.
    constexpr float step = 1e-3f;
    const float side = point.back_side ? -step : step;
    for (std::size_t k = 0; k < 4; k += 2) {
        const SurfaceFootprint change =
            scene.normal_change(point.address, {step * ray.place[k], step * ray.place[k + 1]}, ray.time);
        const std::array<glm::vec3, 2> normals{change.dx / side, change.dy / side};
        for (std::size_t i = 0; i < 2; ++i) {
            glm::vec3& turn = ray.turn[k + i];
            turn = passes ? refracted_change(-point.outgoing, turn, facet, normals[i], point.bsdf.ior)
                          : mirrored_change(-point.outgoing, turn, facet, normals[i]);
        }
    }
}

void advance(Ray& ray, float distance, glm::vec3 normal) {
    // [Igehy1999, "Transfer"]
    const float cosine = glm::dot(ray.direction, normal);
    for (std::size_t k = 0; k < 4; ++k) {
        const glm::vec3 moved = ray.place[k] + distance * ray.turn[k];
        const glm::vec3 slid = moved - core::divide_or(glm::dot(moved, normal), cosine, 0.0f) * ray.direction;
        ray.place[k] = core::is_finite(slid) ? slid : glm::vec3{0.0f};
    }
    ray.blur += distance * ray.spread;
}

Ray start(const AimedPhoton& aimed) {
    Ray ray;
    ray.origin = aimed.origin;
    ray.direction = aimed.direction;
    ray.flux = aimed.flux;
    ray.place = aimed.place;
    ray.turn = aimed.turn;
    ray.time = aimed.time;
    ray.from_far = aimed.from_far;
    return ray;
}

/// Transmittance of air on a way outside of glass.
float left_by_air(const Air& air, const Ray& ray, float distance) {
    if (!ray.from_far) return air.transmittance(ray.origin, ray.direction, distance);
    return std::exp(-air.depth_to_sky(ray.origin + distance * ray.direction, -ray.direction));
}

/// Light lands where the surface is in the middle of the shutter, as gather points lie.
Landing land(const PosedScene& scene, const Ray& ray, const SurfacePoint& point, float length, std::uint32_t caster) {
    Landing landing;
    landing.position = point.position;
    landing.normal = point.geometric_normal;
    if (ray.time != scene::middle_time && scene.posed().sweep->object_moves(point.address.object)) {
        const SurfaceShape middle = scene.shape_at(point.address, scene::middle_time);
        landing.position = middle.position;
        landing.normal = point.back_side ? -middle.front_normal : middle.front_normal;
    }
    landing.time = ray.time;
    landing.direction = ray.direction;
    landing.flux = point.alpha * ray.flux;
    for (std::size_t k = 0; k < 2; ++k) {
        landing.cell[k] = ray.place[k];
        landing.lamp[k] = ray.place[k + 2];
    }
    landing.length = length;
    landing.spread = ray.blur;
    landing.object = point.address.object;
    landing.caster = caster;
    return landing;
}

/// Where light that meets a surface goes on: mirrored, bent, or straight through thin glass.
enum class Onward : std::uint8_t { ends, mirrored, bent, straight };

/// Chooses by what each would carry, and carries it all.
Onward choose(const PosedScene& scene, const SurfacePoint& p, float u, glm::vec3& flux) {
    const float before = core::luminance(flux);
    const float mirrored = core::luminance(flux * p.bsdf.mirror), passed = core::luminance(flux * p.bsdf.transmission);
    const float sum = p.alpha * (mirrored + passed);
    const float through = (1.0f - p.alpha) * before;
    if (!(sum + through > 0.0f)) return Onward::ends;
    float at = u * (sum + through);
    if (at < through) {
        flux *= (1.0f - p.alpha) * (sum + through) / through;
        return Onward::straight;
    }
    at -= through;
    if (at < p.alpha * mirrored) {
        flux *= p.bsdf.mirror * ((sum + through) / mirrored);
        return Onward::mirrored;
    }
    flux *= p.bsdf.transmission * core::divide_or(sum + through, passed, 0.0f);
    const bool bends = p.bounds_body && scene.animation().objects[p.address.object].body == scene::Body::solid;
    return bends ? Onward::bent : Onward::straight;
}

/// Turns the ray at a surface; false where it ends.
bool turn(const PosedScene& scene, const SurfacePoint& p, Onward onward, glm::vec2 u, Ray& ray) {
    if (onward == Onward::straight) {
        if (p.bounds_body) ray.glass.media.cross(p.address.object, *scene.medium_within(p.address.object), p.back_side);
        ray.origin = offset_origin(p, ray.direction);
        return true;
    }
    const glm::vec3 facet = facet_of(p, u);
    turn_at(scene, p, facet, onward == Onward::bent, ray);
    if (onward == Onward::bent) {
        ray.direction = ray.glass.cross(scene, p, facet);
        constexpr float sharp = scene::mirror_roughness * scene::mirror_roughness;
        // chosen: half the lobe's width between photons, as between samples of the eye.
        ray.spread += 0.5f * std::max(p.bsdf.alpha - sharp, 0.0f);
    } else {
        ray.direction = core::normalize_or(ray.direction - 2.0f * glm::dot(ray.direction, facet) * facet, facet);
        if (!(glm::dot(ray.direction, p.geometric_normal) > 0.0f)) return false;
    }
    ray.origin = offset_origin(p, ray.direction);
    return ray.direction != glm::vec3{0.0f};
}

/// Light on its way to what it is aimed at passes thin glass and layers straight; false where it meets anything else.
bool pass_before(const PosedScene& scene, const SurfacePoint& p, Ray& ray) {
    const scene::Body body = scene.animation().objects[p.address.object].body;
    if (p.unlit || (p.bounds_body && body == scene::Body::solid))
        ray.flux *= 1.0f - p.alpha;
    else
        ray.flux *= 1.0f - p.alpha + p.alpha * p.bsdf.transmission;
    return turn(scene, p, Onward::straight, {}, ray);
}

void follow(const PosedScene& scene, const AimedPhoton& aimed, std::vector<Landing>& landings, LandingCounts& counts) {
    Ray ray = start(aimed);
    const float least = least_share * core::luminance(ray.flux);
    std::uint32_t caster = aimed.object;
    bool is_sent_on = false;
    for (int surfaces = 0; surfaces < most_surfaces && core::luminance(ray.flux) > least; ++surfaces) {
        ++counts.rays;
        const Hit hit =
            scene.tracer().nearest(ray.origin, ray.direction, std::numeric_limits<float>::infinity(), ray.time);
        if (!hit.found()) return;
        ray.flux *= ray.glass.way_to(scene, hit, ray.direction);
        if (scene.air() != nullptr && ray.glass.media.empty()) ray.flux *= left_by_air(*scene.air(), ray, hit.distance);
        ray.from_far = false;
        const SurfacePoint p = ray.glass.surface_at(scene, hit, ray.direction, {}, ray.time);
        advance(ray, hit.distance, p.geometric_normal);
        if (!is_sent_on && p.address.object != aimed.object) {
            if (!pass_before(scene, p, ray)) return;
            continue;
        }
        if (p.unlit) return;
        if (is_sent_on && p.alpha > 0.0f && (p.bsdf.has_diffuse() || p.bsdf.has_glossy()))
            landings.push_back(land(scene, ray, p, hit.distance, caster));
        const int dimension = first_choice + 3 * surfaces;
        const auto number = [&](int k) { return core::halton(dimension + k, aimed.number); };
        const Onward onward = choose(scene, p, number(0), ray.flux);
        if (onward == Onward::ends || !turn(scene, p, onward, {number(1), number(2)}, ray)) return;
        if (onward == Onward::straight) continue;
        is_sent_on = true;
        caster = p.address.object;
    }
}

}  // namespace

void follow_photons(const PosedScene& posed_scene, const Casters& casters, std::uint64_t first, std::uint64_t end,
                    std::uint64_t count, std::vector<Landing>& landings, LandingCounts& counts) {
    for (std::uint64_t i = first; i < end; ++i) {
        const AimedPhoton aimed = casters.aim(i, count);
        ++counts.photons;
        const std::size_t before = landings.size();
        follow(posed_scene, aimed, landings, counts);
        const float share = smoothness(static_cast<float>(aimed.of));
        for (std::size_t k = before; k < landings.size(); ++k) {
            landings[k].photon = i;
            for (glm::vec3& edge : landings[k].cell) edge *= share;
        }
    }
}

}  // namespace render2mpeg::renderer
