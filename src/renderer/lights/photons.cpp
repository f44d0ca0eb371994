#include "renderer/lights/photons.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "core/box.h"
#include "core/color.h"
#include "core/numeric.h"
#include "core/sampling.h"
#include "parallel/loops.h"
#include "renderer/base/lobe.h"
#include "renderer/base/stream.h"
#include "renderer/surface/light_ray.h"
#include "renderer/surface/lobe_albedo.h"

namespace render2mpeg::renderer {
namespace {

/// Of all events of a path (scattering, mirrors, layers passed), each takes three numbers after the first three.
constexpr int first_event_dimension = 3;

/// Against paths without end: largest_albedo leaves one path of 10^17 to so many events, layers of alpha not counted.
constexpr int most_events = 4096;

/// Paths traced to learn how many VPLs a path leaves, as a share of the VPLs wanted, and the most paths per VPL wanted
/// at all.
constexpr std::uint64_t pilot_share = 8;
constexpr std::uint64_t most_paths_per_vpl = 64;

LightPoint vpl_at(const SurfacePoint& p, glm::vec3 flux) {
    LightPoint vpl;
    vpl.normal = p.geometric_normal;
    vpl.position = offset_origin(p, p.geometric_normal);
    const float cosine = glm::dot(p.shading_normal, p.outgoing);
    // Light reflected by the lobe leaves as if it were dull: right in power, too wide in direction.
    vpl.intensity = flux * (diffuse_albedo(p.bsdf, cosine) + glossy_albedo(p.bsdf, cosine)) * lobe::inverse_pi;
    vpl.object = p.address.object;
    return vpl;
}

/// Chances of the events at a surface, by the flux that each would carry on.
struct Chances {
    ScatteringShares shares;
    std::array<float, scatterings> of{};
    float lost = 0;  ///< luminance that largest_albedo takes

    Chances(const SurfacePoint& p, glm::vec3 flux) : shares(specular_shares(p)) {
        const float cosine = glm::dot(p.shading_normal, p.outgoing);
        shares[Scattering::diffuse] = p.alpha * diffuse_albedo(p.bsdf, cosine);
        shares[Scattering::glossy] = p.alpha * glossy_albedo(p.bsdf, cosine);
        shares[Scattering::beyond] = p.alpha * p.bsdf.diffuse_transmission;
        of = shares.chances(flux);
        // A surface brighter than any real one is taken as the brightest: chances fall, weights do not rise.
        float& layer = of[static_cast<std::size_t>(Scattering::layer)];
        const float sum = std::accumulate(of.begin(), of.end(), -layer), most = largest_albedo * p.alpha;
        if (!(sum > most)) return;
        lost = (sum - most) / p.alpha * core::luminance(flux);
        for (float& chance : of)
            if (&chance != &layer) chance *= most / sum;
    }
};

/// Sends a photon on; `flux` becomes the flux that goes on. False where it ends. A bounce below the horizon of the true
/// surface would leak through it.
bool go_on(const PosedScene& scene, const SurfacePoint& p, Scattering event, glm::vec2 u, LightRay& ray,
           glm::vec3& flux) {
    const auto kept = [&](glm::vec3 share) {
        return core::divide_or(glm::dot(flux, share), flux.x + flux.y + flux.z, 0.0f);
    };
    const float cosine = glm::dot(p.shading_normal, p.outgoing);
    glm::vec3 direction(0), weight(0);
    switch (event) {
        case Scattering::layer:
            ray.pass(scene, p);
            return true;
        case Scattering::mirror:
            flux *= p.bsdf.mirror / kept(p.bsdf.mirror);
            ray.reflect(p, p.shading_normal);
            return true;
        case Scattering::glass:
            flux *= p.bsdf.transmission / kept(p.bsdf.transmission);
            if (p.bounds_body) return ray.refract(scene, p, p.shading_normal);
            ray.pass(scene, p);
            return true;
        case Scattering::diffuse:
            direction = core::sample_cosine_hemisphere(p.shading_normal, u);
            weight =
                diffuse_weight(p.bsdf, p.shading_normal, p.outgoing, direction) / kept(diffuse_albedo(p.bsdf, cosine));
            break;
        case Scattering::glossy: {
            const LobeSample sample = sample_glossy(p.bsdf, p.shading_normal, p.outgoing, u);
            direction = sample.direction;
            weight = sample.weight / kept(glossy_albedo(p.bsdf, cosine));
            break;
        }
        case Scattering::beyond:
            direction = core::sample_cosine_hemisphere(-p.shading_normal, u);
            weight = p.bsdf.diffuse_transmission / kept(p.bsdf.diffuse_transmission);
            break;
    }
    const float up = glm::dot(direction, p.geometric_normal);
    if (!((event == Scattering::beyond ? -up : up) > 0.0f)) return false;
    flux *= weight;
    ray.leave(p, direction);
    return true;
}

/// Leaves a VPL where a photon landed; `landed`: of its flux.
void leave(const SurfacePoint& p, glm::vec3 flux, glm::vec3 landed, std::uint64_t key, PhotonResult& out) {
    out.vpls.push_back(vpl_at(p, flux));
    out.vpls.back().id = static_cast<std::uint32_t>(core::mix(key) >> 32);
    out.landed += static_cast<double>(core::luminance(landed));
}

/// One path; appends its VPLs, not yet divided by the number of paths, and returns the rays it took.
int follow(const PosedScene& posed_scene, const PhotonSource& source, std::uint64_t path,
           const PhotonSettings& settings, PhotonResult& out) {
    // Few paths are so long that the sequence has no more dimensions; they go on with random numbers.
    const Stream numbers(Purpose::photons, {.index = path});
    const auto number = [&](int dimension) {
        return dimension < core::halton_dimensions ? core::halton(dimension, path)
                                                   : numbers.uniform(static_cast<std::uint64_t>(dimension));
    };
    Photon photon = source.emit({number(0), number(1), number(2)});
    int rays = 0;
    int left = settings.bounces;
    const LayerLimit& limit = posed_scene.tracer().limit();
    int covers = 0;
    for (int event = 0; event < most_events && (settings.bounces == 0 || left > 0); ++event) {
        if (!(core::luminance(photon.flux) > 0.0f)) break;
        ++rays;
        const Hit hit = photon.meet(posed_scene);
        if (!hit.found()) break;
        photon.flux *= photon.left_by_bodies(posed_scene, hit);
        photon.flux *= photon.left_by_air(posed_scene, hit.distance);
        if (photon.range > 0.0f)  // [KHR_lights_punctual]
            photon.flux *= std::clamp(1.0f - std::pow(hit.distance / photon.range, 4.0f), 0.0f, 1.0f);
        photon.range = 0.0f;
        if (limit.ends(covers)) break;
        const SurfacePoint p = photon.surface_at(posed_scene, hit);
        const int dimension = first_event_dimension + 3 * event;
        const Chances chances(p, photon.flux);
        const std::size_t found = chosen(chances.of, number(dimension));
        const auto next = static_cast<Scattering>(found);
        if (p.unlit && next != Scattering::layer) break;
        covers = next != Scattering::layer ? 0 : covers + (limit.counts(hit.address.object) ? 1 : 0);
        if (next != Scattering::layer) {
            const std::uint64_t key = 2 * (path * most_events + static_cast<std::uint64_t>(event));
            if (p.bsdf.has_diffuse() || p.bsdf.has_glossy()) {
                leave(p, photon.flux, photon.flux, key, out);
                --left;
            }
            if (p.bsdf.has_diffuse_transmission())
                leave(posed_scene.other_side(p), photon.flux, glm::vec3(0), key + 1, out);
            out.lost += static_cast<double>(chances.lost);
        }
        if (found == scatterings) break;
        const glm::vec2 u(number(dimension + 1), number(dimension + 2));
        if (!go_on(posed_scene, p, next, u, photon, photon.flux)) break;
    }
    return rays;
}

PhotonResult follow_all(const PosedScene& posed_scene, const PhotonSource& source, const PhotonSettings& settings) {
    constexpr std::size_t grain = 64;
    PhotonResult result;
    std::vector<PhotonResult> part((settings.paths + grain - 1) / grain);
    parallel::for_ranges(settings.paths, grain, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) {
            const std::uint64_t path = settings.first_path + i;
            part[first / grain].rays +=
                static_cast<std::uint64_t>(follow(posed_scene, source, path, settings, part[first / grain]));
        }
    });
    for (const PhotonResult& p : part) {
        result.vpls.insert(result.vpls.end(), p.vpls.begin(), p.vpls.end());
        result.rays += p.rays;
        result.landed += p.landed;
        result.lost += p.lost;
    }
    return result;
}

}  // namespace

core::Box world_box(const scene::Snapshot& snapshot) {
    const scene::Animation& film = *snapshot.animation;
    core::Box box{film.bounds_min, film.bounds_max};
    const auto hold = [&](glm::vec3 p) {
        if (core::is_finite(p)) box.hold(p);
    };
    for (std::size_t i = 0; i < film.objects.size(); ++i) {
        const scene::ObjectState& state = snapshot.objects[i];
        if (film.objects[i].mobility == scene::Mobility::still || !state.present) continue;
        if (state.deformed >= 0) {
            for (const glm::vec3& p : snapshot.deformed[static_cast<std::size_t>(state.deformed)].positions) hold(p);
            continue;
        }
        for (const glm::vec3& p : film.meshes[static_cast<std::size_t>(film.objects[i].mesh)].positions)
            hold(glm::vec3(state.to_world * glm::vec4(p, 1)));
    }
    return box;
}

PhotonResult trace_photons(const PosedScene& posed_scene, std::span<const LightPoint> lights,
                           const PhotonSettings& settings) {
    const PhotonSource source(lights, world_box(posed_scene.posed()), settings.planned);
    if (source.empty() || settings.paths == 0) return {};
    PhotonResult result = follow_all(posed_scene, source, settings);
    const double share = 1.0 / static_cast<double>(settings.paths);
    for (LightPoint& vpl : result.vpls) vpl.intensity *= static_cast<float>(share);
    for (double* flux : {&result.landed, &result.lost}) *flux *= share;
    return result;
}

std::uint64_t paths_for(const PosedScene& posed_scene, std::span<const LightPoint> lights, int vpls, int bounces) {
    const PhotonSource source(lights, world_box(posed_scene.posed()));
    if (source.empty() || vpls <= 0) return 0;
    // Double the pilot until it has left enough to judge by.
    const auto wanted = static_cast<std::uint64_t>(vpls);
    const std::uint64_t enough = std::max<std::uint64_t>(wanted / pilot_share, 32);
    for (std::uint64_t paths = std::max<std::uint64_t>(wanted / pilot_share, 64);; paths *= 2) {
        const std::uint64_t left = follow_all(posed_scene, source, {1, paths, bounces}).vpls.size();
        if (left < enough && paths < wanted * most_paths_per_vpl) continue;
        if (left == 0) return 0;
        return std::clamp<std::uint64_t>(paths * wanted / left, 1, wanted * most_paths_per_vpl);
    }
}

}  // namespace render2mpeg::renderer
