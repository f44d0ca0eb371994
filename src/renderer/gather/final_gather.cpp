#include "renderer/gather/final_gather.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <optional>
#include <utility>

#include "core/color.h"
#include "core/numeric.h"
#include "core/sampling.h"
#include "core/standard_error.h"
#include "parallel/loops.h"
#include "renderer/base/flush_denormals.h"
#include "renderer/base/lobe.h"
#include "renderer/base/stopwatch.h"
#include "renderer/gather/narrow_lobe.h"
#include "renderer/gather/ray_guide.h"
#include "renderer/gather/ray_sums.h"
#include "renderer/paths/path_directions.h"
#include "renderer/surface/lobe_albedo.h"

namespace render2mpeg::renderer {
namespace {

static_assert(pilot_rays == 2 * batch_rays);

/// Rays that are traced in one go before what they ask is learnt, and of one bundle. chosen: memory of some 100 MB.
constexpr std::size_t rays_at_once = std::size_t{1} << 17;
constexpr std::uint32_t bundle_rays = 256;

/// Rays of one task, and pools that one task looks at.
constexpr std::size_t rays_of_task = 512, pools_of_task = 16;

/// Rays of a lobe whose cones fill it, for the sky's sake. chosen: 64.
constexpr float lobe_rays = 64.0f;

/// Rays of a bundle from which sixteen neighbours lie within an eighth of the hemisphere.
constexpr std::uint32_t coherent_rays = 128;

/// A guide is used if the rays left are at least so many times the pilot's, and guided ones have at most so much of the
/// variance. chosen: 4 of 2 to 4, and 0.7; pilots count no more then.
constexpr std::uint32_t worth_guiding = 4;
constexpr double gain_of_guides = 0.7;

/// Least cosine of a ray to the normal, where a lobe shares rays with it.
constexpr float least_cosine = 1e-4f;

}  // namespace

/// Some rays of one request.
struct FinalGather::Bundle {
    std::uint32_t request = 0, first = 0, count = 0;
    const RayGuide* guide = nullptr;  ///< that they are drawn by; null: evenly
    Stream numbers;
};

/// Requests that know of each other's rays.
struct FinalGather::Pool {
    std::uint32_t first = 0, last = 0;  ///< requests, `last` not included
    bool is_guided = false;
    std::unique_ptr<RayGuide> guide;  ///< null: it would not pay
};

/// Results of tracing, by ray.
struct FinalGather::Traced {
    struct Ray {
        glm::vec3 light{0};             ///< radiance
        std::array<float, 3> weight{};  ///< of it in the sums
        std::uint32_t cell = 0;         ///< of RayGuide
        float density = 1;              ///< that it was drawn by
        bool along_lobe = false;        ///< a narrow one
        float nearness = 0;             ///< one over its length
    };
    std::vector<Ray> rays;
    std::vector<RayTerm> terms;
    std::uint64_t traced = 0;
};

/// Calls body(k) for all pools, whose requests and sums it may change.
template <class Pools, class Body>
void for_each_pool(const Pools& pools, const Body& body) {
    parallel::for_ranges(pools.size(), pools_of_task, [&](std::size_t first, std::size_t last) {
        for (std::size_t k = first; k < last; ++k) body(k);
    });
}

GatherRequest request_of(const GatherPoint& point, const PointTolerance& tolerance, glm::ivec2 pixel,
                         const scene::Camera& camera) {
    GatherRequest r;
    r.point = &point;
    r.tolerance = tolerance;
    const core::SurfaceAddress& address = point.point.address;
    r.numbers = Stream(Purpose::hemisphere_rays, {.pixel = pixel})
                    .at(static_cast<std::uint64_t>(address.object) << 8 | point.path)
                    .at(address.primitive);
    const auto on_picture = camera.project(point.point.position);
    r.extent = camera.pixel_extent(on_picture ? on_picture->depth : 1.0f);
    return r;
}

void add(const RayLight& rays, const GatherPoint& point, PointLight& light) {
    const Bsdf& bsdf = point.point.bsdf;
    light.indirect += rays.light[0];
    light.glossy += bsdf.f0 * rays.light[1] + bsdf.f90 * rays.light[2];
    light.indirect_cut += static_cast<float>(rays.rays);
    light.add_alone(rays.error);
}

FinalGather::FinalGather(const PosedScene& posed_scene, const Plan& plan)
    : posed_scene_(posed_scene),
      gather_rays_(posed_scene, plan),
      cache_(posed_scene, plan),
      bodies_block_(plan.runs(Pass::caustics)) {}

void FinalGather::forget(const SkyOfRays& sky) {
    cache_.forget(sky.near_field);
    sky_ = sky;
}

// The estimate.

/// Directions of a bundle's rays, and what the sums take of each.
struct FinalGather::Directions {
    struct Ray {
        glm::vec3 direction{0};
        std::array<float, 3> weight{};  ///< of irradiance, f0, f90; all 0: it is not traced
        bool along_lobe = false;        ///< a narrow one
        float solid_angle = RayRules{}.solid_angle;
        std::uint32_t cell = 0;  ///< of RayGuide
        float density = 1;       ///< that it was drawn by, over an even one
    };
    std::array<Ray, bundle_rays> rays;
    std::array<std::uint32_t, bundle_rays> order;  ///< neighbours lie next to each other
};

namespace {

/// Share of a request's rays that are drawn along its lobe: whole rays of a batch.
float share_of_lobe(const GatherRequest& request) {
    const SurfacePoint& p = request.point->point;
    if (request.which == RaysOf::lobes) return 1.0f;
    if (!p.bsdf.has_lobe() || !(glm::dot(p.shading_normal, p.outgoing) > 0.0f)) return 0.0f;
    if (!p.bsdf.has_narrow_lobe()) return lobe_chance(p);
    if (!p.bsdf.has_diffuse()) return 1.0f;
    return std::clamp(std::round(lobe_chance(p) * batch_rays), 1.0f, batch_rays - 1.0f) / batch_rays;
}

}  // namespace

/// Cosine-distributed, eq. 1 of docs/model/gathering.md, and some by the lobe. Rays of a wide lobe and of the
/// hemisphere both take all [Veach1995]; narrow ones see other light, and take the lobe's.
FinalGather::Directions FinalGather::directions(const GatherRequest& request, const Bundle& bundle) const {
    const SurfacePoint& p = request.point->point;
    const bool narrow = p.bsdf.has_narrow_lobe(), coated = p.bsdf.has_glossy(), glossy = p.bsdf.has_lobe() && !narrow;
    Bsdf white = p.bsdf;  // of the lobe alone
    white.diffuse = glm::vec3(0);
    white.f0 = white.f90 = glm::vec3(1);
    Directions out;
    const float of_lobe = share_of_lobe(request);
    const NarrowLobe narrow_lobe(p);
    std::array<std::pair<std::uint32_t, std::uint32_t>, bundle_rays> order;
    for (std::uint32_t i = 0; i < bundle.count; ++i) {
        order[i] = {0, i};
        const glm::vec2 even = bundle.numbers.sobol(bundle.first + i);
        const bool by_lobe = even.x < of_lobe;
        const glm::vec2 rest((by_lobe ? even.x : even.x - of_lobe) / (by_lobe ? of_lobe : 1.0f - of_lobe), even.y);
        Directions::Ray& ray = out.rays[i];
        if (by_lobe && narrow) {
            const NarrowLobe::Drawn drawn = narrow_lobe.draw(rest);
            ray.along_lobe = true;
            ray.direction = drawn.direction;
            ray.weight = {0.0f, drawn.weight * (1.0f - drawn.schlick), drawn.weight * drawn.schlick};
            ray.solid_angle = core::divide_or(1.0f, lobe_rays * drawn.density, 0.0f);
            continue;
        }
        auto [u, density] = !by_lobe && bundle.guide != nullptr ? bundle.guide->draw(rest) : RayGuide::Drawn{rest};
        ray.direction = chosen_direction(p, by_lobe, u);
        if (of_lobe > 0.0f) {
            const float cosine = glm::dot(p.shading_normal, ray.direction);
            if (!(cosine > least_cosine)) continue;
            if (by_lobe) {
                u = core::place_of_cosine(p.shading_normal, ray.direction);
                density = bundle.guide != nullptr ? bundle.guide->density_at(u) : 1.0f;
            }
            density *= 1.0f - of_lobe;
            if (!narrow)
                density += direction_density(p, 1.0f, ray.direction) * of_lobe * std::numbers::pi_v<float> / cosine;
        }
        order[i].first = RayGuide::place_of(u);
        ray.cell = RayGuide::cell_of(u);
        ray.density = density;
        const float share = 1.0f / density;
        ray.weight[0] = share;
        if (!coated) continue;
        const glm::vec3 half = core::normalize_or(ray.direction + p.outgoing, p.shading_normal);
        const float s = lobe::schlick(glm::dot(half, p.outgoing));
        ray.weight[0] = share * (1.0f - (p.bsdf.has_lobe() ? p.bsdf.covered : 0.0f) * s);
        if (!p.bsdf.shape.is_lambert())
            ray.weight[0] *=
                p.bsdf.shape.value(glm::dot(p.shading_normal, ray.direction), glm::dot(p.shading_normal, p.outgoing),
                                   glm::dot(ray.direction, p.outgoing));
        if (!glossy) continue;
        const float both =
            share * std::numbers::pi_v<float> * evaluate(white, p.shading_normal, p.outgoing, ray.direction).x;
        ray.weight[1] = both * (1.0f - s);
        ray.weight[2] = both * s;
    }
    if (bundle.count >= coherent_rays) std::sort(order.begin(), order.begin() + bundle.count);
    for (std::uint32_t i = 0; i < bundle.count; ++i) out.order[i] = order[i].second;
    return out;
}

void FinalGather::trace(const GatherRequest& request, const Bundle& bundle, Traced& out) const {
    const GatherPoint& point = *request.point;
    const SurfacePoint& p = point.point;
    const glm::vec3 smooth = p.geometric_normal + p.smooth.tilt;
    const std::uint32_t places = point.others + 1u;
    const Directions drawn = directions(request, bundle);
    RayRules even, along_lobe;
    even.near = request.extent;
    even.bodies_block = bodies_block_;
    along_lobe = even;
    along_lobe.is_lobe = true;
    along_lobe.spread = std::min(even.spread, 0.5f * p.bsdf.alpha);
    along_lobe.shining = sky_.shining;

    std::array<RayQuery, bundle_rays> queries;
    std::array<Hit, bundle_rays> hits;
    std::array<std::uint32_t, bundle_rays> index;
    std::uint32_t asked = 0;
    out.rays.assign(bundle.count, {});
    for (std::uint32_t k = 0; k < bundle.count; ++k) {
        const std::uint32_t i = drawn.order[k], number = bundle.first + i;
        const Directions::Ray& ray = drawn.rays[i];
        const bool counts = ray.weight[0] + ray.weight[1] + ray.weight[2] > 0.0f;
        // A lobe is known in all, whatever of it the surface hides; so is a diffuse surface.
        out.rays[i] = {glm::vec3(0), ray.weight, ray.cell, ray.density, ray.along_lobe};
        if (!counts || !(glm::dot(smooth, ray.direction) > 0.0f)) continue;
        const auto place = static_cast<std::uint32_t>(bundle.numbers.at(number).bits() % places);
        queries[asked] = {place == 0 ? shadow_origin(p) : point.elsewhere[place - 1], ray.direction,
                          std::numeric_limits<float>::infinity()};
        index[asked++] = i;
    }
    posed_scene_.tracer().any_nearest(std::span<const RayQuery>(queries.data(), asked),
                                      std::span<Hit>(hits.data(), asked),
                                      bundle.count >= coherent_rays && !p.bsdf.has_narrow_lobe());
    out.traced += asked;
    for (std::uint32_t k = 0; k < asked; ++k) {
        const Directions::Ray& ray = drawn.rays[index[k]];
        RayRules& rules = ray.along_lobe ? along_lobe : even;
        rules.solid_angle = ray.solid_angle;
        rules.brightest = !ray.along_lobe ? sky_.brightest
                          : !sky_.importance
                              ? sky_.lobe_brightest
                              : core::divide_or(sky_.lobe_brightest, sky_.importance(ray.direction), 0.0f);
        if (hits[k].found())
            out.rays[index[k]].nearness = core::divide_or(1.0f, std::max(hits[k].distance, request.extent), 0.0f);
        out.rays[index[k]].light = gather_rays_.follow(
            queries[k], hits[k], rules, bundle.numbers.at(bundle.first + index[k]), index[k], out.terms, out.traced);
    }
}

/// Bundles that tasks take, by their rays: ends of runs.
std::vector<std::size_t> FinalGather::runs_of(std::span<const Bundle> bundles, std::size_t rays) {
    std::vector<std::size_t> ends;
    for (std::size_t b = 0, sum = 0; b < bundles.size(); ++b) {
        sum += bundles[b].count;
        if (sum < rays && b + 1 < bundles.size()) continue;
        ends.push_back(b + 1);
        sum = 0;
    }
    return ends;
}

void FinalGather::trace_all(std::span<const GatherRequest> requests, std::span<const Bundle> bundles,
                            std::vector<PointSums>& sums, std::vector<Pool>& pools) {
    std::vector<Traced> found(bundles.size());
    const std::vector<std::size_t> ends = runs_of(bundles, rays_of_task);
    std::vector<std::vector<CellQuery>> wanted(ends.size());
    parallel::for_each(ends.size(), [&](std::size_t run) {
        const FlushDenormals flushed;
        for (std::size_t b = run == 0 ? 0 : ends[run - 1]; b < ends[run]; ++b) {
            trace(requests[bundles[b].request], bundles[b], found[b]);
            for (RayTerm& term : found[b].terms)
                if ((term.cell = cache_.find(term.place.key)) == LightCells::none) wanted[run].push_back(term.place);
        }
    });
    // Learn what the cells that they met do not know,
    for (const Traced& t : found) counts_.rays += t.traced;
    cache_.learn(std::move(wanted));
    // and sum up, in the order of rays: a task has pools to itself.
    std::vector<std::size_t> pool_ends;
    for (std::size_t run = 0, b = 0; b < bundles.size();) {
        while (run + 1 < ends.size() && ends[run] <= b) ++run;
        b = ends[run];
        while (b < bundles.size() && sums[bundles[b].request].pool == sums[bundles[b - 1].request].pool) ++b;
        pool_ends.push_back(b);
    }
    parallel::for_each(pool_ends.size(), [&](std::size_t run) {
        for (std::size_t b = run == 0 ? 0 : pool_ends[run - 1]; b < pool_ends[run]; ++b) {
            PointSums& s = sums[bundles[b].request];
            add_bundle(requests[bundles[b].request], found[b], s, pools[s.pool].guide.get());
        }
    });
}

/// Adds the rays of a bundle to the sums of its request, and tells the guide of its pool, if it has one. They go.
void FinalGather::add_bundle(const GatherRequest& request, Traced& traced, PointSums& s, RayGuide* guide) const {
    for (const RayTerm& term : traced.terms) {
        const std::uint32_t cell = term.cell != LightCells::none ? term.cell : cache_.index_of(term.place.key);
        Traced::Ray& ray = traced.rays[term.ray];
        ray.light += term.weight * (ray.along_lobe ? cache_.radiance(cell) : cache_.far_part(cell));
    }
    RaySums batch;
    for (const Traced::Ray& ray : traced.rays) {
        std::array<glm::vec3, 3> shares;
        for (std::size_t k = 0; k < 3; ++k) {
            shares[k] = ray.weight[k] * ray.light;
            s.light[k] += shares[k];
            s.weight[k] += ray.weight[k];
            batch.light[k] += shares[k];
            batch.weight[k] += ray.weight[k];
        }
        s.nearness += static_cast<double>(ray.nearness) * (ray.weight[1] + ray.weight[2]);
        ++s.rays;
        if (guide != nullptr && !ray.along_lobe)
            guide->add(ray.cell, ray.density * shown_luminance(*request.point, shares));
        if (++batch.rays < batch_rays) continue;
        const double shown = shown_luminance(*request.point, batch.mean(s.albedo));
        if (const std::uint32_t number = s.rays / batch_rays - 1; number < 2) s.first_batches[number] = shown;
        s.batches += shown;
        s.batch_squares += shown * shown;
        batch = {};
    }
    traced = {};
}

void FinalGather::trace_wanted(std::span<const GatherRequest> requests, std::span<const std::uint32_t> wanted,
                               std::vector<PointSums>& sums, std::vector<Pool>& pools) {
    std::vector<Bundle> bundles;
    std::size_t rays = 0;
    const auto flush = [&] {
        if (!bundles.empty()) trace_all(requests, bundles, sums, pools);
        bundles.clear();
        rays = 0;
    };
    // Guides stay as they are until all of these rays are traced.
    for (std::uint32_t i = 0; i < requests.size(); ++i) {
        const Pool& pool = pools[sums[i].pool];
        const Stream& own = requests[i].numbers;
        const Stream numbers = pool.is_guided ? own.with(Purpose::guided_rays) : own;
        for (std::uint32_t first = sums[i].rays; first < wanted[i]; first += bundle_rays)
            bundles.push_back({i, requests[i].from + first, std::min(bundle_rays, wanted[i] - first),
                               pool.is_guided ? pool.guide.get() : nullptr, numbers});
        rays += wanted[i] - std::min(wanted[i], sums[i].rays);
        if (rays >= rays_at_once) flush();
    }
    flush();
}

// How many rays.

/// How many rays each request of a pool needs in all: eq. 2 and 3 of docs/model/gathering.md. `pilot`: from the pilots,
/// which do not know what guided rays find.
void FinalGather::want_rays(std::span<const GatherRequest> requests, std::span<const PointSums> sums, const Pool& pool,
                            bool pilot, Allocation allocation, std::vector<std::uint32_t>& wanted) const {
    double all = 0;
    for (std::size_t i = pool.first; i < pool.last; ++i) all += sums[i].batch_variance();
    const double share = pilot && pool.is_guided ? pool.guide->variance_share() : 1.0;
    const double others = static_cast<double>(pool.last - pool.first) - 1.0;
    for (std::size_t i = pool.first; i < pool.last; ++i) {
        if (wanted[i] = requests[i].rays; wanted[i] > 0) continue;
        const PointSums& s = sums[i];
        const double V_8 = share * (others > 0 ? (all - s.batch_variance()) / others : s.batch_variance());
        const double mean = s.batches * batch_rays / s.rays;
        const double T = requests[i].tolerance.allows_noise(static_cast<float>(mean)) / core::errors_of_noise;
        // Of points that may not err those that show most get most.
        const double shown = std::min(static_cast<double>(core::luminance(requests[i].point->weight)), 1.0);
        const double N = T > 0.0 ? allocation.worth(samples_for(T * T, batch_rays, V_8, variance_power))
                                 : allocation.capped(most_gather_rays * shown);
        const auto rays = static_cast<std::uint32_t>(std::clamp(N, 1.0 * pilot_rays, 1.0 * most_gather_rays));
        wanted[i] = (rays + batch_rays - 1) / batch_rays * batch_rays;
    }
}

// Where to.

namespace {

/// Rays of a request's pilot.
std::uint32_t pilot_of(const GatherRequest& r) {
    return r.rays == 0 ? pilot_rays
                       : std::max(r.rays / (worth_guiding * batch_rays) * batch_rays, std::min(pilot_rays, r.rays));
}

/// Whether a guide may pay, as far as it is known before any ray.
bool may_be_guided(std::span<const GatherRequest> pool) {
    if (pool.front().which == RaysOf::lobes) return false;
    double rays = 0, seen = 0;
    for (const GatherRequest& r : pool) {
        if (r.rays == 0) return true;
        rays += r.rays;
        seen += pilot_of(r);
    }
    return !(rays < worth_guiding * seen);
}

}  // namespace

/// Pools, and empty sums of their requests.
std::vector<FinalGather::Pool> FinalGather::pools_of(std::span<const GatherRequest> requests,
                                                     std::vector<PointSums>& sums) {
    std::vector<Pool> pools;
    for (std::uint32_t i = 0; i < requests.size(); ++i) {
        if (i == 0 || requests[i].pool != requests[i - 1].pool) pools.push_back({i, i, false, nullptr});
        ++pools.back().last;
    }
    sums.resize(requests.size());
    for_each_pool(pools, [&](std::size_t k) {
        Pool& pool = pools[k];
        if (may_be_guided(requests.subspan(pool.first, pool.last - pool.first)))
            pool.guide = std::make_unique<RayGuide>();
        for (std::size_t i = pool.first; i < pool.last; ++i) {
            const SurfacePoint& p = requests[i].point->point;
            sums[i].pool = static_cast<std::uint32_t>(k);
            if (p.bsdf.has_narrow_lobe())
                sums[i].albedo = lobe_albedo(glm::dot(p.shading_normal, p.outgoing), p.bsdf.mean_alpha());
        }
    });
    return pools;
}

/// Draws the rest of a pool's rays by what its pilots found, where that pays; these count no more then.
void FinalGather::guide(std::span<const GatherRequest> requests, Allocation allocation, Pool& pool,
                        std::vector<PointSums>& sums, std::vector<std::uint32_t>& wanted) const {
    want_rays(requests, sums, pool, true, allocation, wanted);
    if (pool.guide == nullptr) return;
    double rays = 0, seen = 0;
    for (std::size_t i = pool.first; i < pool.last; ++i) rays += wanted[i], seen += sums[i].rays;
    if (rays < worth_guiding * seen) return;
    pool.guide->learn();
    if (pool.guide->variance_share() > gain_of_guides) return;
    pool.is_guided = true;
    want_rays(requests, sums, pool, true, allocation, wanted);
    for (std::size_t i = pool.first; i < pool.last; ++i) {
        sums[i].forget();
        // Half of them tell more.
        if (requests[i].rays == 0)
            wanted[i] = std::clamp(wanted[i] / 2 / batch_rays * batch_rays, pilot_rays, 3 * pilot_rays);
    }
}

// Order.

std::vector<RayLight> FinalGather::gather(std::span<const GatherRequest> requests, Allocation allocation) {
    const Stopwatch timer(counts_.seconds);
    std::vector<PointSums> sums;
    std::vector<Pool> pools = pools_of(requests, sums);
    // Pilots tell how many rays are wanted and where to, then guided rays whether these are enough.
    std::vector<std::uint32_t> wanted(requests.size());
    std::transform(requests.begin(), requests.end(), wanted.begin(), pilot_of);
    trace_wanted(requests, wanted, sums, pools);
    for_each_pool(pools, [&](std::size_t k) { guide(requests, allocation, pools[k], sums, wanted); });
    trace_wanted(requests, wanted, sums, pools);
    for_each_pool(pools, [&](std::size_t k) {
        if (pools[k].is_guided) pools[k].guide->learn();
        want_rays(requests, sums, pools[k], false, allocation, wanted);
    });
    trace_wanted(requests, wanted, sums, pools);
    std::vector<RayLight> light(requests.size());
    for_each_pool(pools, [&](std::size_t k) {
        for (std::size_t i = pools[k].first; i < pools[k].last; ++i) {
            const PointSums& s = sums[i];
            light[i] = {s.mean(),
                        {static_cast<float>(std::sqrt(s.variance()))},
                        static_cast<float>(s.batch_variance()),
                        s.rays,
                        static_cast<float>(s.mean_nearness()),
                        static_cast<float>(s.first_batches[0] - s.first_batches[1])};
        }
    });
    counts_.points += requests.size();
    counts_.cell_rays = cache_.rays();
    return light;
}

}  // namespace render2mpeg::renderer
