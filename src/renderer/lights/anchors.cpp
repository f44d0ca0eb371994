// Anchor lights [Render2MPEG, 7.3.1]: fixed places whose intensities follow the photons of each instant by density
// estimation. Changed: places are a stratified choice among places that photons reach over the film, half by area and
// half by flux, and by importance to cameras, instead of even over surfaces (so that none lies where no light comes);
// photons share their flux among the nearest anchors by a kernel times the area that each anchor stands for, which
// loses no energy at edges; surfaces that move have anchors of their own, which move along.
#include "renderer/lights/anchors.h"

#include <algorithm>
#include <cmath>

#include "core/color.h"
#include "core/numeric.h"
#include "core/sampling.h"
#include "parallel/loops.h"
#include "renderer/base/lobe.h"
#include "renderer/lights/anchor_importance.h"
#include "renderer/lights/anchor_paths.h"
#include "renderer/lights/anchor_places.h"
#include "renderer/lights/even_points.h"
#include "renderer/lights/rest_pose.h"

namespace render2mpeg::renderer {
namespace {

/// Instants of the film at which places are looked for. chosen: 64, a lamp that crosses a film is then seen within a
/// 64th of its way; each asks for a 64th of the photons.
constexpr int instants = 64;

/// Points spread evenly over all still surfaces, as a share of the places looked at. chosen: an eighth.
constexpr std::uint64_t even_part = 8;

/// Places looked at per anchor. chosen: 16; fewer leave strata uneven where visible surfaces get a small part of the
/// light.
constexpr std::uint64_t candidates_per_anchor = 16;
constexpr std::uint64_t least_candidates = 4096;

/// From so many places on, 16,384 anchors' worth, fewer are looked at for each anchor, but 4 at least: strata that are
/// uneven matter less where anchors lie that densely, and each place takes some 150 bytes while they are chosen.
constexpr std::uint64_t many_candidates = 1u << 18;
constexpr std::uint64_t least_per_anchor = 4;

/// Paths, or places, that are traced at once: bounds the memory that they take.
constexpr std::uint64_t batch = 1u << 15;

/// Photons that are shared out at once, about: they take 40 bytes each until then, and less time the more there are.
constexpr std::size_t most_hits = 1u << 20;

/// Every anchor counts with at least this share of the mean light when trees are planned: it may be lit one day.
constexpr float least_average = 0.01f;

bool moves(const scene::Animation& film, std::uint32_t object) {
    return film.objects[object].mobility != scene::Mobility::still;
}

/// A still anchor, without intensity; its rest is the world.
LightPoint still_light(const PhotonSplatter& anchors, std::uint32_t id) {
    LightPoint p;
    p.position = anchors.rest(id).position;
    p.normal = anchors.rest(id).normal;
    p.disc2 = anchors.disc2(id);
    p.id = id;
    return p;
}

}  // namespace

std::uint64_t candidates_for(std::uint64_t anchors) {
    const std::uint64_t most = std::max(many_candidates, least_per_anchor * anchors);
    return std::max(std::min(candidates_per_anchor * anchors, most), least_candidates);
}

struct Anchors::Impl {
    Impl(const scene::Animation& animation, const AnchorSettings& s) : film(animation), settings(s), rest(animation) {}

    std::uint32_t group_of(std::uint32_t object) const { return moves(film, object) ? object + 1 : 0; }
    OrientedPoint rest_of(const LightPoint& vpl, const core::SurfaceAddress& address, bool front) const {
        return moves(film, address.object) ? rest.at(address, front) : OrientedPoint{vpl.position, vpl.normal};
    }

    AnchorCandidate candidate(const PosedScene& posed_scene, const LightPoint& vpl,
                              const core::SurfaceAddress& address) const;
    void look(PosedScene& posed_scene, LightPoints& lights);
    void look_at(const PosedScene& posed_scene, const std::vector<LightPoint>& lights, std::uint64_t wanted);
    void add_even(const PosedScene& posed_scene, std::uint64_t count);
    void add_unlit();
    void average_light(const RayTracer& tracer);
    LightPoint moving_light(const PosedScene& posed_scene, std::uint32_t place) const;
    PhotonHit hit_of(const PosedScene& posed_scene, const PhotonResult& photons, std::size_t i, float part) const;
    std::vector<PhotonHit> hits_of(const PosedScene& posed_scene, const PhotonResult& photons,
                                   std::uint64_t count) const;
    void follow_all(const PosedScene& posed_scene, std::span<const LightPoint> lights, Lit& lit,
                    std::span<glm::dvec3> light) const;

    const scene::Animation& film;
    AnchorSettings settings;
    RestPoses rest;
    std::vector<AnchorCandidate> candidates;
    std::vector<glm::vec3> candidate_light;  ///< radiant intensity of each, as a VPL
    Landings seen;                           ///< of the candidates' paths
    EyeImportance eye;

    std::uint64_t paths = 0, rays = 0;
    PhotonSplatter anchors;
    std::vector<float> average;  ///< luminance of each anchor's intensity
    float apart = 0;             ///< how far from each other objects that move are thought to be
};

AnchorCandidate Anchors::Impl::candidate(const PosedScene& posed_scene, const LightPoint& vpl,
                                         const core::SurfaceAddress& address) const {
    AnchorCandidate c;
    c.address = address;
    c.front = glm::dot(posed_scene.front_normal(address.object, address.primitive), vpl.normal) >= 0.0f;
    c.rest = rest_of(vpl, address, c.front);
    c.group = group_of(address.object);
    c.flux = core::luminance(vpl.intensity);
    const glm::vec3 world = film.bounds_max - film.bounds_min;
    c.extent2 = glm::dot(world, world);
    if (c.group != 0) {
        c.area_scale = rest.area_scale(posed_scene.posed(), address);
        c.extent2 = rest.extent2(address.object);
    }
    return c;
}

/// Gathers candidates at instants spread over the film, and chooses among them.
void Anchors::Impl::look(PosedScene& posed_scene, LightPoints& lights) {
    const int count = film.duration > 0.0 ? instants : 1;
    const std::uint64_t wanted = candidates_for(static_cast<std::uint64_t>(settings.count));
    const scene::Snapshot first = importance_instant(film, 0, count);
    lights.place(posed_scene, first);
    scene::Snapshot instant;
    for (int i = 0; i < count; ++i) {
        scene::Snapshot next = importance_instant(film, i, count);
        std::swap(instant, next);
        posed_scene.pose(instant);
        look_at(posed_scene, lights.at(posed_scene),
                std::max<std::uint64_t>(wanted / static_cast<std::uint64_t>(count), 1));
    }
    // Still objects lie the same at any instant.
    posed_scene.pose(first);
    add_even(posed_scene, wanted / even_part);
    add_unlit();
    anchors = PhotonSplatter(choose_places(candidates, settings.count), posed_scene.tracer());
    rays += anchors.rays();
    average_light(posed_scene.tracer());
    if (anchors.size() > 0) paths = paths_of_anchors(settings.count, settings.photons, settings.bounces, seen);
}

void Anchors::Impl::look_at(const PosedScene& posed_scene, const std::vector<LightPoint>& lights,
                            std::uint64_t wanted) {
    const std::uint64_t needed = paths_for(posed_scene, lights, static_cast<int>(wanted), settings.bounces);
    if (needed == 0) return;
    // Every instant takes other paths, so that no two look at the same places.
    const PhotonResult photons = trace_photons(posed_scene, lights, {1 + seen.paths, needed, settings.bounces});
    seen.paths += needed;
    seen.landed += photons.vpls.size();
    rays += photons.rays;
    const std::vector<float> importance = eye.of(posed_scene, photons.vpls);
    for (std::size_t i = 0; i < photons.vpls.size(); ++i) {
        candidates.push_back(candidate(posed_scene, photons.vpls[i], photons.addresses[i]));
        // The root, since errors are light times the size of its cell: fewest errors in sum come of cells that shrink
        // as it.
        candidates.back().importance = std::sqrt(importance[i]);
        candidate_light.push_back(photons.vpls[i].intensity);
    }
}

/// Gives still surfaces places whether photons met them or not: light may come between the instants.
void Anchors::Impl::add_even(const PosedScene& posed_scene, std::uint64_t count) {
    for (const SurfacePoint& p : even_points(posed_scene, count)) {
        LightPoint point;
        point.normal = p.geometric_normal;
        point.position = offset_origin(p, p.geometric_normal);
        candidates.push_back(candidate(posed_scene, point, p.address));
        candidates.back().even = true;
        candidate_light.push_back(glm::vec3(0));
    }
}

/// Gives objects that move one place where no photon met them.
void Anchors::Impl::add_unlit() {
    std::vector<bool> met(film.objects.size(), false);
    for (const AnchorCandidate& c : candidates) met[c.address.object] = true;
    for (std::uint32_t object = 0; object < film.objects.size(); ++object) {
        const scene::Mesh& mesh = film.meshes[static_cast<std::size_t>(film.objects[object].mesh)];
        const scene::Material& material = film.materials[static_cast<std::size_t>(film.objects[object].material)];
        if (met[object] || !moves(film, object) || mesh.triangles.empty() || material.unlit) continue;
        AnchorCandidate c;
        c.address = {object, static_cast<std::uint32_t>(mesh.triangles.size() / 2), 1.0f / 3.0f, 1.0f / 3.0f};
        c.rest = rest.at(c.address, true);
        c.group = group_of(object);
        c.extent2 = rest.extent2(object);
        candidates.push_back(c);
        candidate_light.push_back(glm::vec3(0));
    }
}

/// An anchor that moves, at the posed instant, without intensity.
LightPoint Anchors::Impl::moving_light(const PosedScene& posed_scene, std::uint32_t index) const {
    const AnchorMount& place = anchors.mount(index);
    const glm::vec3 front = posed_scene.front_normal(place.address.object, place.address.primitive);
    LightPoint p;
    p.normal = place.front ? front : -front;
    p.position = offset_origin(posed_scene.surface_at(place.address, p.normal), p.normal);
    p.disc2 = anchors.disc2(index) * rest.area_scale(posed_scene.posed(), place.address);
    p.id = index - anchors.still_count();
    p.object = place.address.object;
    return p;
}

/// Hit of a photon, as a part of those of all batches.
PhotonHit Anchors::Impl::hit_of(const PosedScene& posed_scene, const PhotonResult& photons, std::size_t i,
                                float part) const {
    const LightPoint& vpl = photons.vpls[i];
    const core::SurfaceAddress& address = photons.addresses[i];
    const bool at_front = glm::dot(posed_scene.front_normal(address.object, address.primitive), vpl.normal) >= 0.0f;
    return {group_of(address.object), rest_of(vpl, address, at_front), part * vpl.intensity};
}

/// Time-averaged light of each anchor: splats the candidates' own.
void Anchors::Impl::average_light(const RayTracer& tracer) {
    std::vector<glm::dvec3> light(anchors.size(), glm::dvec3(0));
    std::vector<PhotonHit> hits;
    for (std::size_t i = 0; i < candidates.size(); ++i) {
        if (candidates[i].flux > 0.0f) hits.push_back({candidates[i].group, candidates[i].rest, candidate_light[i]});
        if (hits.size() < most_hits && i + 1 < candidates.size()) continue;
        rays += anchors.splat(hits, tracer, nullptr, light);
        hits.clear();
    }
    average.clear();
    average.reserve(light.size());
    for (const glm::dvec3& l : light) average.push_back(core::luminance(glm::vec3(l)));
    double sum = 0;
    for (const float l : average) sum += l;
    const auto mean = static_cast<float>(core::divide_or(sum, static_cast<double>(average.size()), 0.0));
    for (float& l : average) l += least_average * mean + 1e-20f;
    // Trees of moving objects are planned at rest, every object far from all others, since they part.
    for (const AnchorCandidate& c : candidates)
        if (c.group != 0) apart = std::max(apart, 4.0f * std::sqrt(c.extent2));
}

Anchors::Anchors(PosedScene& posed_scene, LightPoints& lights, const AnchorSettings& settings)
    : impl_(std::make_unique<Impl>(posed_scene.animation(), settings)) {
    Impl& a = *impl_;
    const scene::Snapshot& before = posed_scene.posed();
    a.look(posed_scene, lights);
    posed_scene.pose(before);
    a.candidates = {};
    a.candidate_light = {};
}
Anchors::~Anchors() = default;
Anchors::Anchors(Anchors&&) noexcept = default;

std::vector<LightPoint> Anchors::average_still() const {
    std::vector<LightPoint> points;
    points.reserve(impl_->anchors.still_count());
    for (std::uint32_t i = 0; i < impl_->anchors.still_count(); ++i) {
        points.push_back(still_light(impl_->anchors, i));
        points.back().intensity = glm::vec3(impl_->average[i]);
    }
    return points;
}

std::vector<LightPoint> Anchors::average_moving() const {
    const Impl& a = *impl_;
    const std::uint32_t first = a.anchors.still_count();
    std::vector<LightPoint> points;
    std::uint32_t objects = 0;
    for (std::uint32_t i = first; i < a.anchors.size(); ++i) {
        if (i > first && a.anchors.mount(i).address.object != a.anchors.mount(i - 1).address.object) ++objects;
        LightPoint p = still_light(a.anchors, i);
        p.position += glm::vec3(a.apart * static_cast<float>(objects), 0, 0);
        p.intensity = glm::vec3(a.average[i]);
        p.id = i - first;
        points.push_back(p);
    }
    return points;
}

std::uint64_t Anchors::paths() const {
    return impl_->paths;
}

std::uint64_t Anchors::rays() const {
    return impl_->rays;
}

std::size_t Anchors::bytes() const {
    return impl_->average.capacity() * sizeof(float) + impl_->anchors.bytes();
}

/// The hits of photons, as parts of those of all batches.
std::vector<PhotonHit> Anchors::Impl::hits_of(const PosedScene& posed_scene, const PhotonResult& photons,
                                              std::uint64_t count) const {
    const float part = static_cast<float>(static_cast<double>(count) / static_cast<double>(paths));
    std::vector<PhotonHit> hits(photons.vpls.size());
    parallel::for_ranges(hits.size(), 256, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) hits[i] = hit_of(posed_scene, photons, i, part);
    });
    return hits;
}

void Anchors::Impl::follow_all(const PosedScene& posed_scene, std::span<const LightPoint> lights, Lit& lit,
                               std::span<glm::dvec3> light) const {
    std::vector<PhotonHit> hits;
    for (std::uint64_t done = 0; done < paths; done += batch) {
        const std::uint64_t count = std::min(batch, paths - done);
        const PhotonResult photons = trace_photons(posed_scene, lights, {1 + done, count, settings.bounces});
        lit.rays += photons.rays;
        lit.landed += photons.landed / static_cast<double>(paths);
        lit.lost += photons.lost / static_cast<double>(paths);
        const std::vector<PhotonHit> more = hits_of(posed_scene, photons, count);
        hits.insert(hits.end(), more.begin(), more.end());
        if (hits.size() < most_hits && done + count < paths) continue;
        lit.rays += anchors.splat(hits, posed_scene.tracer(), &lit.occluded, light);
        hits.clear();
    }
}

Anchors::Lit Anchors::at(const PosedScene& posed_scene, std::span<const LightPoint> lights) const {
    const Impl& a = *impl_;
    std::vector<glm::dvec3> light(a.anchors.size(), glm::dvec3(0));
    Lit lit;
    lit.occluded = a.anchors.occluded_neighbours(posed_scene.tracer());
    lit.rays += lit.occluded.rays;
    a.follow_all(posed_scene, lights, lit, light);
    const std::uint32_t still = a.anchors.still_count();
    lit.still.reserve(still);
    lit.moving.reserve(a.anchors.size() - still);
    for (std::uint32_t i = 0; i < a.anchors.size(); ++i) {
        const bool moving = i >= still;
        if (moving && !posed_scene.posed().objects[a.anchors.mount(i).address.object].present) continue;
        LightPoint p = moving ? a.moving_light(posed_scene, i) : still_light(a.anchors, i);
        p.intensity = glm::vec3(light[i]);
        (moving ? lit.moving : lit.still).push_back(p);
    }
    return lit;
}

}  // namespace render2mpeg::renderer
