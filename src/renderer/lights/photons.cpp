#include "renderer/lights/photons.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/color.h"
#include "core/numeric.h"
#include "core/sampling.h"
#include "parallel/loops.h"
#include "renderer/base/lobe.h"
#include "renderer/surface/lobe_albedo.h"
#include "renderer/surface/media_path.h"

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
    vpl.kind = LightPointKind::oriented;
    vpl.normal = p.geometric_normal;
    vpl.position = offset_origin(p, p.geometric_normal);
    const float cosine = glm::dot(p.shading_normal, p.outgoing);
    // Light reflected by the lobe leaves as if it were dull: right in power, too wide in direction.
    vpl.intensity = flux * (diffuse_albedo(p.bsdf, cosine) + glossy_albedo(p.bsdf, cosine)) * lobe::inverse_pi;
    vpl.object = p.address.object;
    return vpl;
}

/// Transmittance of air for a photon on its way.
float left_by_air(const Air& air, const Photon& photon, float distance) {
    if (!photon.from_far) return air.transmittance(photon.origin, photon.direction, distance);
    return std::exp(-air.depth_to_sky(photon.origin + distance * photon.direction, -photon.direction));
}

/// Where a photon goes on from a surface; no flux: nowhere.
struct Onward {
    glm::vec3 direction{0};
    glm::vec3 flux{0};
    bool passes = false;  ///< through the surface
    bool beyond = false;  ///< scattered to the surface's other side
    float lost = 0;       ///< luminance that largest_albedo took
};

Onward scatter(const SurfacePoint& p, glm::vec3 flux, float choice, glm::vec2 u) {
    const Bsdf& b = p.bsdf;
    const float cosine = glm::dot(p.shading_normal, p.outgoing);
    const glm::vec3 diffuse = diffuse_albedo(b, cosine), glossy = glossy_albedo(b, cosine);
    // By the flux that each would carry on, colours alike: light that a surface swallows ends there, whatever it would
    // do to other light. [Szecsi2003]
    const float before = flux.x + flux.y + flux.z;
    const auto kept = [&](glm::vec3 albedo) { return core::divide_or(glm::dot(flux, albedo), before, 0.0f); };
    float chance[5] = {kept(diffuse), kept(glossy), kept(b.mirror), kept(b.transmission), kept(b.diffuse_transmission)};
    const float sum = chance[0] + chance[1] + chance[2] + chance[3] + chance[4];
    // A surface brighter than any real one is taken as the brightest: probabilities fall, weights do not rise.
    const float lost = std::max(sum - largest_albedo, 0.0f) * core::luminance(flux);
    const float kept_share = sum > largest_albedo ? largest_albedo / sum : 1.0f;
    choice = core::divide_or(choice, kept_share, 1.0f);
    if (choice < chance[0]) {
        const glm::vec3 direction = core::sample_cosine_hemisphere(p.shading_normal, u);
        return {direction, flux * diffuse_weight(b, p.outgoing, direction) / chance[0], false, false, lost};
    }
    choice -= chance[0];
    if (choice < chance[1]) {
        const LobeSample sample = sample_glossy(b, p.shading_normal, p.outgoing, u);
        return {sample.direction, flux * sample.weight / chance[1], false, false, lost};
    }
    choice -= chance[1];
    if (choice < chance[2]) {
        const float nv = glm::dot(p.shading_normal, p.outgoing);
        return {core::normalize_or(2.0f * nv * p.shading_normal - p.outgoing, p.shading_normal),
                flux * b.mirror / chance[2], false, false, lost};
    }
    choice -= chance[2];
    if (choice < chance[3]) return {-p.outgoing, flux * b.transmission / chance[3], true, false, lost};
    choice -= chance[3];
    if (choice < chance[4]) {
        const glm::vec3 direction = core::sample_cosine_hemisphere(-p.shading_normal, u);
        return {direction, flux * b.diffuse_transmission / chance[4], false, true, lost};
    }
    return {{}, {}, false, false, lost};
}

/// Leaves a VPL where a photon landed; `landed`: of its flux.
void leave(const SurfacePoint& p, glm::vec3 flux, glm::vec3 landed, PhotonResult& out) {
    out.vpls.push_back(vpl_at(p, flux));
    out.addresses.push_back(p.address);
    out.landed += static_cast<double>(core::luminance(landed));
}

/// One path; appends its VPLs, not yet divided by the number of paths, and returns the rays it took.
int follow(const PosedScene& posed_scene, const PhotonSource& source, std::uint64_t path,
           const PhotonSettings& settings, PhotonResult& out) {
    // Few paths are so long that the sequence has no more dimensions; they go on with random numbers.
    const auto number = [&](int dimension) {
        return dimension < core::halton_dimensions ? core::halton(dimension, path)
                                                   : core::uniform(path, static_cast<std::uint64_t>(dimension));
    };
    Photon photon = source.emit({number(0), number(1), number(2)});
    MediaPath media;
    int rays = 0;
    int left = settings.bounces;
    for (int event = 0; event < most_events && (settings.bounces == 0 || left > 0); ++event) {
        if (!(core::luminance(photon.flux) > 0.0f)) break;
        ++rays;
        const Hit hit =
            posed_scene.tracer().nearest(photon.origin, photon.direction, std::numeric_limits<float>::infinity());
        if (!hit.found()) break;
        if (posed_scene.air() != nullptr && media.media.empty())
            photon.flux *= left_by_air(*posed_scene.air(), photon, hit.distance);
        if (photon.range > 0.0f)  // [KHR_lights_punctual]
            photon.flux *= std::clamp(1.0f - std::pow(hit.distance / photon.range, 4.0f), 0.0f, 1.0f);
        photon.flux *= media.way_to(posed_scene, hit, photon.direction);
        const SurfacePoint p = media.surface_at(posed_scene, hit, photon.direction);
        const int dimension = first_event_dimension + 3 * event;
        float choice = number(dimension);
        photon.range = 0.0f;
        // Pass a translucent layer with the share that it does not cover.
        if (choice < 1.0f - p.alpha) {
            // Air before the layer has dimmed it.
            photon.origin = offset_origin(p, photon.direction);
            photon.from_far = false;
            continue;
        }
        if (p.unlit) break;
        choice = core::divide_or(choice - (1.0f - p.alpha), p.alpha, 0.0f);
        if (p.bsdf.has_diffuse() || p.bsdf.has_glossy()) {
            leave(p, photon.flux, photon.flux, out);
            --left;
        }
        if (p.bsdf.has_diffuse_transmission()) leave(posed_scene.other_side(p), photon.flux, glm::vec3(0), out);
        Onward onward = scatter(p, photon.flux, choice, {number(dimension + 1), number(dimension + 2)});
        out.lost += static_cast<double>(onward.lost);
        // A bounce below the horizon of the true surface would leak through it.
        const float up = glm::dot(onward.direction, p.geometric_normal);
        if (!onward.passes && !((onward.beyond ? -up : up) > 0.0f)) break;
        if (onward.passes && p.bounds_body) onward.direction = media.cross(posed_scene, p, p.shading_normal);
        if (onward.direction == glm::vec3{0.0f}) break;
        photon = {offset_origin(p, onward.direction), onward.direction, false, 0.0f, onward.flux};
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
        result.addresses.insert(result.addresses.end(), p.addresses.begin(), p.addresses.end());
        result.rays += p.rays;
        result.landed += p.landed;
        result.lost += p.lost;
    }
    return result;
}

}  // namespace

WorldBox world_box(const scene::Snapshot& snapshot) {
    const scene::Animation& film = *snapshot.animation;
    WorldBox box{film.bounds_min, film.bounds_max};
    const auto hold = [&](glm::vec3 p) {
        if (!core::is_finite(p)) return;
        box.low = glm::min(box.low, p);
        box.high = glm::max(box.high, p);
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
    const float share = static_cast<float>(1.0 / static_cast<double>(settings.paths));
    for (LightPoint& vpl : result.vpls) vpl.intensity *= share;
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
