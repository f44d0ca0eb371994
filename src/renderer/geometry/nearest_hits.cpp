// Nearest hits, by two looks: one for the nearest surface, one at everything about the same distance, of which the
// lowest id wins. Rays of the eye go in packets of sixteen.
#include "renderer/geometry/nearest_hits.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "renderer/base/flush_denormals.h"
#include "renderer/geometry/embree.h"
#include "renderer/geometry/embree_scene.h"

namespace render2mpeg::renderer {
namespace {

constexpr int packet_size = 16;

/// The ray, and a hit that says nothing was met.
RTCRayHit unanswered(const RayQuery& query, float near, float far) {
    RTCRayHit ray{};
    ray.ray = ray_of(query, near, far);
    ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    ray.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    return ray;
}

/// Context that Embree hands through to the filter; its own part comes first, so that its pointer is ours.
struct TieContext {
    embree::Context embree;
    const EmbreeScene* scene;
    const RayQuery* queries;  ///< by the rays' ids
    Hit* best;                ///< likewise
};

/// Rank of a hit, the least wins: a front before a back, which a thin body has in one place with it; then the lowest
/// id.
auto rank(const EmbreeScene& scene, const Hit& hit, const RayQuery& query) {
    return std::tuple(scene.is_back(hit.address.object, hit.geometric_normal, query.direction, query.time),
                      hit.address.object, hit.address.primitive);
}

/// Remembers which of all surfaces that a ray meets wins, and refuses every hit so that all are seen.
void take_lowest(const RTCFilterFunctionNArguments* arguments) {
    const auto& context = embree::context_of<const TieContext>(arguments);
    const unsigned n = arguments->N;
    RTCHitN* const hit = arguments->hit;
    for (unsigned i = 0; i < n; ++i) {
        if (arguments->valid[i] != -1) continue;
        arguments->valid[i] = 0;
        const unsigned ray = RTCRayN_id(arguments->ray, n, i);
        Hit& best = context.best[ray];
        const core::SurfaceAddress address =
            context.scene->address(RTCHitN_instID(hit, n, i, 0), RTCHitN_geomID(hit, n, i), RTCHitN_primID(hit, n, i),
                                   RTCHitN_u(hit, n, i), RTCHitN_v(hit, n, i));
        if (address.object == best.address.object && address.primitive == best.address.primitive) continue;
        const Hit other{address,
                        RTCRayN_tfar(arguments->ray, n, i),
                        {RTCHitN_Ng_x(hit, n, i), RTCHitN_Ng_y(hit, n, i), RTCHitN_Ng_z(hit, n, i)}};
        const RayQuery& query = context.queries[ray];
        if (rank(*context.scene, other, query) < rank(*context.scene, best, query)) best = other;
    }
}

void begin(TieContext& context, const EmbreeScene& scene, const RayQuery* queries, Hit* best) {
    context.embree.filter = &take_lowest;
    context.scene = &scene;
    context.queries = queries;
    context.best = best;
}

/// What a ray that was traced by itself met on an object; its normal is Embree's.
Hit hit_of(const EmbreeScene& scene, std::uint32_t object, const RTCRayHit& found) {
    return {scene.address(object, found.hit.primID, found.hit.u, found.hit.v),
            found.ray.tfar,
            {found.hit.Ng_x, found.hit.Ng_y, found.hit.Ng_z}};
}

/// Traces a single ray in one of the scenes, for any of surfaces in one plane. Whether it met one.
bool meets_alone(RTCSceneTy* in, const RayQuery& query, RTCRayHit& found) {
    if (!is_traceable(query)) return false;
    embree::Context context;
    found = unanswered(query, 0.0f, query.far);
    embree::intersect(in, context, found);
    return found.hit.geomID != RTC_INVALID_GEOMETRY_ID;
}

/// Hit of a single ray, of surfaces in one plane any; its normal is Embree's.
Hit any_alone(const EmbreeScene& scene, const RayQuery& query) {
    RTCRayHit found;
    if (!meets_alone(scene.root(), query, found)) return {};
    return hit_of(scene, scene.object_of(found.hit.instID[0], found.hit.geomID), found);
}

/// Gives a hit the world's normal for Embree's.
void turn(const EmbreeScene& scene, const RayQuery& query, Hit& hit) {
    if (hit.found()) hit.geometric_normal = scene.world_normal(hit.address.object, hit.geometric_normal, query.time);
}

/// Up to sixteen rays on their way, lane by lane.
class HitPacket {
  public:
    HitPacket(const EmbreeScene& scene, std::span<const RayQuery> queries, bool coherent = true)
        : scene_(scene), queries_(queries), coherent_(coherent) {
        for (int i = 0; i < packet_size; ++i) {
            const bool asked = static_cast<std::size_t>(i) < queries.size();
            valid_[i] = asked && is_traceable(queries[static_cast<std::size_t>(i)]) ? -1 : 0;
            const RayQuery query = valid_[i] != 0 ? queries[static_cast<std::size_t>(i)] : RayQuery{};
            set(i, query, 0.0f, query.far);
        }
    }

    /// `hits`: as many as queries.
    void answer(Hit* hits) {
        answer_any(hits);
        TieContext ties;
        begin(ties, scene_, queries_.data(), hits);
        trace(ties.embree);
        turn_all(hits);
    }

    /// The same; of surfaces in one plane any.
    void answer_any_turned(Hit* hits) {
        answer_any(hits);
        turn_all(hits);
    }

  private:
    void answer_any(Hit* hits) {
        embree::Context context;
        trace(context);
        for (std::size_t i = 0; i < queries_.size(); ++i) hits[i] = take(static_cast<int>(i));
    }

    void turn_all(Hit* hits) const {
        for (std::size_t i = 0; i < queries_.size(); ++i) turn(scene_, queries_[i], hits[i]);
    }

    void set(int i, const RayQuery& query, float near, float far) {
        RTCRay16& ray = rays_.ray;
        ray.org_x[i] = query.origin.x, ray.org_y[i] = query.origin.y, ray.org_z[i] = query.origin.z;
        ray.dir_x[i] = query.direction.x, ray.dir_y[i] = query.direction.y, ray.dir_z[i] = query.direction.z;
        ray.tnear[i] = near;
        ray.tfar[i] = far;
        ray.time[i] = query.time;
        ray.mask[i] = 0xffffffffu;
        ray.id[i] = static_cast<unsigned>(i);
        ray.flags[i] = 0;
        rays_.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
        rays_.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
    }

    /// Traces baked geometry first, coherently; then instances (EmbreeScene::baked).
    void trace(embree::Context& context) {
        context.coherent = coherent_;
        embree::intersect(valid_, scene_.baked(), context, rays_);
        if (!scene_.has_instances()) return;
        std::fill(std::begin(rays_.ray.mask), std::end(rays_.ray.mask), EmbreeScene::instance_mask);
        context.coherent = false;
        embree::intersect(valid_, scene_.root(), context, rays_);
    }

    /// Returns the hit of ray i, and prepares it to look once more about there.
    Hit take(int i) {
        const RTCHit16& h = rays_.hit;
        if (valid_[i] == 0 || h.geomID[i] == RTC_INVALID_GEOMETRY_ID) {
            valid_[i] = 0;
            return {};
        }
        const float t = rays_.ray.tfar[i];
        const Hit hit{scene_.address(h.instID[0][i], h.geomID[i], h.primID[i], h.u[i], h.v[i]),
                      t,
                      {h.Ng_x[i], h.Ng_y[i], h.Ng_z[i]}};
        const RayQuery& query = queries_[static_cast<std::size_t>(i)];
        set(i, query, t * (1.0f - coplanar), std::min(query.far, t * (1.0f + coplanar)));
        return hit;
    }

    const EmbreeScene& scene_;
    std::span<const RayQuery> queries_;
    bool coherent_;  ///< whether baked geometry is traced coherently
    alignas(64) int valid_[packet_size];
    RTCRayHit16 rays_;
};

}  // namespace

bool is_traceable(const RayQuery& query) {
    const auto fits = [](float v) { return std::abs(v) <= largest_component; };  // false for NaN
    return fits(query.origin.x) && fits(query.origin.y) && fits(query.origin.z) && fits(query.direction.x) &&
           fits(query.direction.y) && fits(query.direction.z) && query.far > 0.0f;
}

RTCRay ray_of(const RayQuery& query, float near, float far) {
    RTCRay ray{};
    ray.org_x = query.origin.x, ray.org_y = query.origin.y, ray.org_z = query.origin.z;
    ray.dir_x = query.direction.x, ray.dir_y = query.direction.y, ray.dir_z = query.direction.z;
    ray.tnear = near;
    ray.tfar = far;
    ray.time = query.time;
    ray.mask = 0xffffffffu;
    return ray;
}

Hit nearest_hit(const EmbreeScene& scene, const RayQuery& query) {
    const FlushDenormals flushed;
    Hit hit = any_alone(scene, query);
    if (!hit.found()) return {};
    const float t = hit.distance;
    TieContext ties;
    begin(ties, scene, &query, &hit);
    RTCRayHit again = unanswered(query, t * (1.0f - coplanar), std::min(query.far, t * (1.0f + coplanar)));
    embree::intersect(scene.root(), ties.embree, again);
    hit.geometric_normal = scene.world_normal(hit.address.object, hit.geometric_normal, query.time);
    return hit;
}

void nearest_hits(const EmbreeScene& scene, std::span<const RayQuery> queries, std::span<Hit> hits) {
    const FlushDenormals flushed;
    for (std::size_t first = 0; first < queries.size(); first += packet_size) {
        const std::size_t count = std::min<std::size_t>(packet_size, queries.size() - first);
        HitPacket(scene, queries.subspan(first, count)).answer(&hits[first]);
    }
}

void any_nearest_hits(const EmbreeScene& scene, std::span<const RayQuery> queries, std::span<Hit> hits, bool coherent) {
    const FlushDenormals flushed;
    // Alone they go through all at once.
    if (queries.size() == 1 || (!coherent && scene.has_instances())) {
        for (std::size_t i = 0; i < queries.size(); ++i) {
            hits[i] = any_alone(scene, queries[i]);
            turn(scene, queries[i], hits[i]);
        }
        return;
    }
    for (std::size_t first = 0; first < queries.size(); first += packet_size) {
        const std::size_t count = std::min<std::size_t>(packet_size, queries.size() - first);
        HitPacket(scene, queries.subspan(first, count), coherent).answer_any_turned(&hits[first]);
    }
}

Hit nearest_hit_of(const EmbreeScene& scene, std::uint32_t object, const RayQuery& query) {
    RTCSceneTy* const alone = scene.alone(object);
    EXPECTS(alone != nullptr);
    const FlushDenormals flushed;
    RTCRayHit found;
    if (!meets_alone(alone, query, found)) return {};
    Hit hit = hit_of(scene, object, found);
    turn(scene, query, hit);
    return hit;
}

bool meets_any(RTCSceneTy* scene, unsigned mask, const RayQuery& query) {
    if (!is_traceable(query)) return false;
    const FlushDenormals flushed;
    embree::Context context;
    RTCRayHit found = unanswered(query, 0.0f, query.far);
    found.ray.mask = mask;
    embree::intersect(scene, context, found);
    return found.hit.geomID != RTC_INVALID_GEOMETRY_ID;
}

}  // namespace render2mpeg::renderer
