// Anchor lights [Render2MPEG, 7.3.1]: fixed places whose intensities follow the photons of each instant by density
// estimation. Changed: places are a stratified choice among places that photons reach over the film, half by area and
// half by flux, and by what cameras see, instead of even over surfaces (so that none lies where no light comes);
// photons share their flux among the nearest anchors by a kernel times the area that each anchor stands for, which
// loses no energy at edges; surfaces that move have anchors of their own, which move along.
#include "renderer/anchors.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/color.h"
#include "core/error.h"
#include "core/numeric.h"
#include "parallel/loops.h"
#include "renderer/anchor_importance.h"
#include "renderer/anchor_places.h"
#include "renderer/anchor_shares.h"
#include "renderer/usual_light.h"

namespace render2mpeg::renderer {
namespace {

/// Instants of the film at which places are looked for. chosen: 8.
constexpr int instants = 8;

/// Places looked at per anchor. chosen: 16; fewer leave strata uneven where what is seen gets a small part of the
/// light.
constexpr std::uint64_t candidates_per_anchor = 16;
constexpr std::uint64_t least_candidates = 4096;

/// VPLs that are spread in a frame for this many anchors: 32 for each, since a lamp that moves should change them by
/// what it does and not by noise; 8 at least, where anchors are so many that their noise is small in sum.
std::uint64_t photons_for(int anchors) {
    const auto count = static_cast<std::uint64_t>(anchors);
    return std::max(8 * count, std::min<std::uint64_t>(32 * count, 1u << 17));
}

/// Paths traced at once: bounds the memory that photons take.
constexpr std::uint64_t batch = 1u << 15;

/// Every anchor counts with at least this share of the mean light when trees are planned: it may be lit one day.
constexpr float least_usual = 0.01f;

/// A point of a mesh that is not placed in the world.
OrientedPoint at_rest(const scene::Mesh& mesh, const core::SurfaceAddress& a, bool front) {
    const glm::uvec3 t = mesh.triangles[a.primitive];
    const glm::vec3 p = mesh.positions[t.x], e1 = mesh.positions[t.y] - p, e2 = mesh.positions[t.z] - p;
    const glm::vec3 normal = core::normalize_or(glm::cross(e1, e2), {0, 0, 1});
    return {p + a.u * e1 + a.v * e2, front ? normal : -normal};
}

float area_of(glm::vec3 a, glm::vec3 b, glm::vec3 c) {
    return 0.5f * glm::length(glm::cross(b - a, c - a));
}

/// World area of a triangle over its area in its mesh.
float area_scale(const scene::Snapshot& now, const core::SurfaceAddress& a) {
    const scene::Animation& film = *now.animation;
    const scene::Mesh& mesh = film.meshes[static_cast<std::size_t>(film.objects[a.object].mesh)];
    const glm::uvec3 t = mesh.triangles[a.primitive];
    const scene::Triangle world = scene::triangle_of(now, a.object, a.primitive);
    return core::divide_or(area_of(world.a, world.b, world.c),
                           area_of(mesh.positions[t.x], mesh.positions[t.y], mesh.positions[t.z]), 1.0f);
}

/// Squared diagonal of a mesh's box.
float extent2_of(const scene::Mesh& mesh) {
    glm::vec3 low(std::numeric_limits<float>::max()), high(-low);
    for (const glm::vec3& p : mesh.positions) {
        low = glm::min(low, p);
        high = glm::max(high, p);
    }
    const glm::vec3 size = mesh.positions.empty() ? glm::vec3(0) : high - low;
    return glm::dot(size, size);
}

bool moves(const scene::Animation& film, std::uint32_t object) {
    return film.objects[object].mobility != scene::Mobility::still;
}

/// A still anchor, without intensity; its rest is the world.
LightPoint still_light(const AnchorPlace& place, std::uint32_t id) {
    LightPoint p;
    p.position = place.rest.position;
    p.normal = place.rest.normal;
    p.disc2 = place.disc2;
    p.id = id;
    p.object = place.address.object;
    return p;
}

}  // namespace

struct Anchors::Impl {
    Impl(const scene::Animation& animation, const AnchorSettings& s) : film(animation), settings(s) {}

    std::uint32_t group_of(std::uint32_t object) const { return moves(film, object) ? object + 1 : 0; }
    const scene::Mesh& mesh_of(std::uint32_t object) const {
        return film.meshes[static_cast<std::size_t>(film.objects[object].mesh)];
    }

    OrientedPoint rest_of(const LightPoint& vpl, const core::SurfaceAddress& address, bool front) const {
        return moves(film, address.object) ? at_rest(mesh_of(address.object), address, front)
                                           : OrientedPoint{vpl.position, vpl.normal};
    }

    AnchorCandidate candidate(const Scenery& scenery, const LightPoint& vpl,
                              const core::SurfaceAddress& address) const {
        AnchorCandidate c;
        c.address = address;
        c.front = glm::dot(scenery.front_normal(address.object, address.primitive), vpl.normal) >= 0.0f;
        c.rest = rest_of(vpl, address, c.front);
        c.group = group_of(address.object);
        c.flux = core::luminance(vpl.intensity);
        const glm::vec3 world = film.bounds_max - film.bounds_min;
        c.extent2 = glm::dot(world, world);
        if (c.group != 0) {
            c.area_scale = area_scale(scenery.posed(), address);
            c.extent2 = extent2_of(mesh_of(address.object));
        }
        return c;
    }

    void look(Scenery& scenery, LightPoints& lights);
    void look_at(const Scenery& scenery, const std::vector<LightPoint>& lights, std::uint64_t wanted);
    void add_unlit();
    void reckon_usual(const RayTracer& tracer);
    LightPoint moving_light(const Scenery& scenery, std::uint32_t place) const;
    std::uint32_t still_count() const { return static_cast<std::uint32_t>(still.size()); }

    const scene::Animation& film;
    AnchorSettings settings;
    std::vector<AnchorCandidate> candidates;
    std::vector<glm::vec3> candidate_light;  ///< radiant intensity of each, as a VPL
    std::uint64_t looked = 0;                ///< paths that candidates came from

    std::uint64_t paths = 0;          ///< in every frame
    std::vector<AnchorPlace> places;  ///< by group: what is still comes first
    AnchorSharing sharing;
    std::vector<LightPoint> still;  ///< without their intensities
    std::vector<LightPoint> usual_still, usual_moving;
};

/// Gathers candidates at instants spread over the film, and chooses among them.
void Anchors::Impl::look(Scenery& scenery, LightPoints& lights) {
    const int count = film.duration > 0.0 ? instants : 1;
    const auto wanted = std::max(candidates_per_anchor * static_cast<std::uint64_t>(settings.count), least_candidates);
    std::vector<scene::Snapshot> films(static_cast<std::size_t>(count));
    for (int i = 0; i < count; ++i) {
        const auto microseconds = static_cast<std::int64_t>(1e6 * film.duration * (i + 0.5) / count);
        const std::size_t shots = film.shots.size();
        const std::int64_t frame =
            shots == 0 ? 0 : film.shots[static_cast<std::size_t>(i) * shots / static_cast<std::size_t>(count)].frame;
        films[static_cast<std::size_t>(i)] =
            at_usual_strength(scene::snapshot_at(film, frame, {microseconds, 1000000}, importance_format));
    }
    lights.place(scenery, films.front());
    for (const scene::Snapshot& instant : films) {
        scenery.pose(instant);
        look_at(scenery, lights.at(scenery), wanted / static_cast<std::uint64_t>(count));
    }
    add_unlit();
    places = choose_places(candidates, settings.count);
    for (const AnchorPlace& place : places)
        if (place.group == 0) still.push_back(still_light(place, static_cast<std::uint32_t>(still.size())));
    // What is still lies the same at any instant; take the film's own.
    scenery.pose(films.front());
    sharing = AnchorSharing(places, film, scenery.tracer());
    reckon_usual(scenery.tracer());
}

void Anchors::Impl::look_at(const Scenery& scenery, const std::vector<LightPoint>& lights, std::uint64_t wanted) {
    const std::uint64_t needed = paths_for(scenery, lights, static_cast<int>(wanted), settings.bounces);
    if (needed == 0) return;
    // Every instant takes other paths, so that no two look at the same places.
    const PhotonResult photons = trace_photons(scenery, lights, {1 + looked, needed, settings.bounces});
    looked += needed;
    const std::vector<float> importance = importance_to_eye(scenery, photons.vpls);
    for (std::size_t i = 0; i < photons.vpls.size(); ++i) {
        candidates.push_back(candidate(scenery, photons.vpls[i], photons.addresses[i]));
        candidates.back().importance = importance[i];
        candidate_light.push_back(photons.vpls[i].intensity);
    }
}

/// Gives objects that move one place where no photon met them: they may come into light between the instants.
void Anchors::Impl::add_unlit() {
    std::vector<bool> met(film.objects.size(), false);
    for (const AnchorCandidate& c : candidates) met[c.address.object] = true;
    for (std::uint32_t object = 0; object < film.objects.size(); ++object) {
        const scene::Mesh& mesh = mesh_of(object);
        const scene::Material& material = film.materials[static_cast<std::size_t>(film.objects[object].material)];
        if (met[object] || !moves(film, object) || mesh.triangles.empty() || material.unlit) continue;
        AnchorCandidate c;
        c.address = {object, static_cast<std::uint32_t>(mesh.triangles.size() / 2), 1.0f / 3.0f, 1.0f / 3.0f};
        c.rest = at_rest(mesh, c.address, true);
        c.group = group_of(object);
        c.extent2 = extent2_of(mesh);
        candidates.push_back(c);
        candidate_light.push_back(glm::vec3(0));
    }
}

/// An anchor that moves, at the posed instant, without intensity.
LightPoint Anchors::Impl::moving_light(const Scenery& scenery, std::uint32_t index) const {
    const AnchorPlace& place = places[index];
    const glm::vec3 front = scenery.front_normal(place.address.object, place.address.primitive);
    LightPoint p;
    p.normal = place.front ? front : -front;
    p.position = offset_origin(scenery.surface_at(place.address, p.normal), p.normal);
    p.moving = true;
    p.disc2 = place.disc2 * area_scale(scenery.posed(), place.address);
    p.id = index - still_count();
    p.object = place.address.object;
    return p;
}

/// Spreads the candidates' own light.
void Anchors::Impl::reckon_usual(const RayTracer& tracer) {
    std::vector<glm::vec3> light(places.size(), glm::vec3(0));
    for (std::size_t i = 0; i < candidates.size(); ++i) {
        const std::uint32_t group = candidates[i].group;
        const AnchorShares shares = sharing.share(group, candidates[i].rest, tracer);
        for (std::size_t k = 0; k < static_cast<std::size_t>(shares.count); ++k)
            light[shares.anchor[k]] += shares.weight[k] * candidate_light[i];
    }
    glm::vec3 mean(0);
    for (const glm::vec3& l : light) mean += l / static_cast<float>(light.size());
    const glm::vec3 least = least_usual * mean + glm::vec3(1e-20f);
    // Trees of what moves are planned at rest, every object far from all others: they part ways.
    float apart = 0;
    for (const AnchorCandidate& c : candidates)
        if (c.group != 0) apart = std::max(apart, 4.0f * std::sqrt(c.extent2));
    std::uint32_t objects = 0;
    for (std::uint32_t i = 0; i < places.size(); ++i) {
        const bool moving = i >= still_count();
        if (moving && i > still_count() && places[i].group != places[i - 1].group) ++objects;
        LightPoint p;
        if (moving) {
            p.position = places[i].rest.position + glm::vec3(apart * static_cast<float>(objects), 0, 0);
            p.normal = places[i].rest.normal;
            p.disc2 = places[i].disc2;
            p.id = i - still_count();
        } else {
            p = still[i];
        }
        p.intensity = light[i] + least;
        (moving ? usual_moving : usual_still).push_back(p);
    }
}

Anchors::Anchors(Scenery& scenery, LightPoints& lights, const AnchorSettings& settings)
    : impl_(std::make_unique<Impl>(scenery.animation(), settings)) {
    Impl& a = *impl_;
    const scene::Snapshot& before = scenery.posed();
    a.look(scenery, lights);
    scenery.pose(before);
    const std::uint64_t photons = settings.photons > 0 ? settings.photons : photons_for(settings.count);
    a.paths = a.candidates.empty() ? 0 : std::max<std::uint64_t>(1, photons * a.looked / a.candidates.size());
    a.candidates = {};
    a.candidate_light = {};
}
Anchors::~Anchors() = default;
Anchors::Anchors(Anchors&&) noexcept = default;

const std::vector<LightPoint>& Anchors::usual_still() const {
    return impl_->usual_still;
}
const std::vector<LightPoint>& Anchors::usual_moving() const {
    return impl_->usual_moving;
}

std::uint64_t Anchors::paths() const {
    return impl_->paths;
}

Anchors::Lit Anchors::at(const Scenery& scenery, std::span<const LightPoint> lights) const {
    const Impl& a = *impl_;
    std::vector<glm::dvec3> light(a.places.size(), glm::dvec3(0));
    Lit lit;
    std::vector<AnchorShares> shares;
    for (std::uint64_t done = 0; done < a.paths; done += batch) {
        const std::uint64_t count = std::min(batch, a.paths - done);
        const std::uint64_t first_path = 1 + a.settings.photon_set * a.paths + done;
        const PhotonResult photons = trace_photons(scenery, lights, {first_path, count, a.settings.bounces});
        lit.rays += photons.rays;
        shares.assign(photons.vpls.size(), AnchorShares{});
        parallel::for_ranges(photons.vpls.size(), 256, [&](std::size_t first, std::size_t last) {
            for (std::size_t i = first; i < last; ++i) {
                const core::SurfaceAddress& address = photons.addresses[i];
                const glm::vec3 front = scenery.front_normal(address.object, address.primitive);
                const OrientedPoint rest =
                    a.rest_of(photons.vpls[i], address, glm::dot(front, photons.vpls[i].normal) >= 0.0f);
                shares[i] = a.sharing.share(a.group_of(address.object), rest, scenery.tracer());
            }
        });
        // In the order of photons, whatever thread found their shares.
        const double part = static_cast<double>(count) / static_cast<double>(a.paths);
        for (std::size_t i = 0; i < shares.size(); ++i)
            for (std::size_t k = 0; k < static_cast<std::size_t>(shares[i].count); ++k)
                light[shares[i].anchor[k]] +=
                    part * static_cast<double>(shares[i].weight[k]) * glm::dvec3(photons.vpls[i].intensity);
    }
    for (std::uint32_t i = 0; i < a.places.size(); ++i) {
        const bool moving = i >= a.still_count();
        if (moving && !scenery.posed().objects[a.places[i].address.object].present) continue;
        LightPoint p = moving ? a.moving_light(scenery, i) : a.still[i];
        p.intensity = glm::vec3(light[i]);
        (moving ? lit.moving : lit.still).push_back(p);
    }
    return lit;
}

}  // namespace render2mpeg::renderer
