// After photon ray splatting [Herzog2007, 4]. Changed: photons are aimed at casters, and only light that came
// by specular ways alone is kept (L S+ D); and in place of the density of the path, which knows nothing of focusing at
// mirrors, each photon carries how its neighbours differ [Igehy1999; Schjoth2007]: that is the density of the path with
// its Jacobian, exact at mirrors and lenses.
#include "renderer/caustics/caustic_photons.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "core/color.h"
#include "core/numeric.h"
#include "core/sampling.h"

namespace render2mpeg::renderer {
namespace {

/// Surfaces on one way. chosen: 12, of 8 to 16: a slab in the sun loses less than 1e-4 of its light.
constexpr int most_surfaces = 12;

/// Least share of a photon that is followed further.
constexpr float least_share = 1e-3f;

/// First Halton dimension of choices on the way; two for each surface.
constexpr int first_choice = 4;

/// A photon and its four neighbours on their path.
struct PhotonPath : AimedPhoton {
    float spread = 0;  ///< angle by which rough glass has widened it
    float blur = 0;    ///< radius of the same
};

/// Chooses the step so that the normals of neighbours are asked for within the triangle, then scales back.
void turn_at(const PosedScene& scene, const SurfacePoint& point, glm::vec3 facet, bool passes, PhotonPath& ray) {
    // chosen: neighbours at 1/1000 of the kernel: normals bend evenly over that, and digits are left.
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

void advance(PhotonPath& ray, float distance, glm::vec3 normal) {
    for (std::size_t k = 0; k < 4; ++k)
        ray.place[k] = transferred(ray.place[k], ray.turn[k], distance, ray.direction, normal);
    ray.blur += distance * ray.spread;
}

/// Light lands where the surface is in the middle of the shutter, as gather points lie.
Landing land(const PosedScene& scene, const PhotonPath& ray, const SurfacePoint& point, float length,
             std::uint32_t caster) {
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
    landing.edges = ray.place;
    landing.turns = ray.turn;
    landing.length = length;
    landing.spread = ray.blur;
    landing.object = point.address.object;
    landing.caster = caster;
    return landing;
}

/// Chooses an event by the flux that it would carry, and carries it all; `scatterings`: nothing goes on. `sent_on`: the
/// light has left the straight way from its lamp.
std::size_t choose(const PosedScene& scene, const SurfacePoint& p, bool sent_on, const PhotonPath& ray, float u,
                   glm::vec3& flux) {
    ScatteringShares shares = specular_shares(p);
    const bool straight = scene.passes_straight(p.address.object);
    if (straight) {
        shares[Scattering::glass] = glm::vec3(0);
        shares[Scattering::layer] = scene.transmittance_at(p.address, ray.direction);
        shares[Scattering::mirror] = p.alpha * mirrored_by_pane(scene, p);
    }
    std::array<float, scatterings> chances = shares.chances(flux);
    // What passes straight is no caustic, unless another face mirrors it: thin glass mirrors every other photon, the
    // front of a pane all.
    if (straight && !sent_on) {
        const bool all = p.bounds_body && !p.back_side;
        float& passes = chances[static_cast<std::size_t>(Scattering::layer)];
        passes = all ? 0.0f : std::min(passes, chances[static_cast<std::size_t>(Scattering::mirror)]);
    }
    const float sum = std::accumulate(chances.begin(), chances.end(), 0.0f);
    const std::size_t event = chosen(chances, u * sum);
    if (event < scatterings) flux *= shares.of[event] * (sum / chances[event]);
    return event;
}

/// Turns the ray and its neighbours by a mirror or a boundary that bends light; false where all is reflected.
bool turn(const PosedScene& scene, const SurfacePoint& p, bool bends, glm::vec2 u, PhotonPath& ray) {
    const glm::vec3 facet = facet_of(p, u);
    turn_at(scene, p, facet, bends, ray);
    if (!bends) {
        ray.reflect(p, facet);
        return true;
    }
    ray.spread += widening_of(p);
    return ray.refract(scene, p, facet);
}

/// Light that has not met its caster passes thin glass and layers straight, and ends at anything else.
void pass_before(const PosedScene& scene, const SurfacePoint& p, PhotonPath& ray) {
    ray.flux *= bends_light(scene, p) ? glm::vec3(1.0f - p.alpha) : scene.transmittance_at(p.address, ray.direction);
    ray.pass(scene, p);
}

void follow(const PosedScene& scene, const AimedPhoton& aimed, std::vector<Landing>& landings, LandingCounts& counts) {
    PhotonPath ray{aimed};
    const float least = least_share * core::luminance(ray.flux);
    std::uint32_t caster = aimed.object;
    bool is_sent_on = false;
    for (int surfaces = 0; surfaces < most_surfaces && core::luminance(ray.flux) > least; ++surfaces) {
        ++counts.rays;
        const Hit hit = ray.meet(scene);
        if (!hit.found()) return;
        // Panes take what they absorb at their faces.
        if (!scene.passes_straight(hit.address.object)) ray.flux *= ray.left_by_bodies(scene, hit);
        ray.flux *= ray.left_by_air(scene, hit.distance);
        const SurfacePoint p = ray.surface_at(scene, hit);
        advance(ray, hit.distance, p.geometric_normal);
        if (!is_sent_on && p.address.object != aimed.object) {
            pass_before(scene, p, ray);
            continue;
        }
        if (p.unlit) return;
        if (is_sent_on && p.alpha > 0.0f && (p.bsdf.has_diffuse() || p.bsdf.has_glossy()))
            landings.push_back(land(scene, ray, p, hit.distance, caster));
        const int dimension = first_choice + 3 * surfaces;
        const auto number = [&](int k) { return core::halton(dimension + k, aimed.number); };
        const std::size_t found = choose(scene, p, is_sent_on, ray, number(0), ray.flux);
        if (found == scatterings) return;
        const bool mirrors = static_cast<Scattering>(found) == Scattering::mirror;
        if (!mirrors && (static_cast<Scattering>(found) == Scattering::layer || !bends_light(scene, p))) {
            ray.pass(scene, p);
            continue;
        }
        if (!turn(scene, p, !mirrors, {number(1), number(2)}, ray)) return;
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
        for (std::size_t k = before; k < landings.size(); ++k) landings[k].photon = i;
    }
}

}  // namespace render2mpeg::renderer
