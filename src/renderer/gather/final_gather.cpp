#include "renderer/gather/final_gather.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "core/color.h"
#include "core/numeric.h"
#include "core/sampling.h"
#include "parallel/loops.h"
#include "renderer/base/flush_denormals.h"
#include "renderer/base/lobe.h"
#include "renderer/base/stopwatch.h"
#include "renderer/surface/lobe_albedo.h"

namespace render2mpeg::renderer {
namespace {

/// Rays of a point's first look, in two halves; and of one batch whose spread is looked at.
constexpr std::uint32_t first_rays = 16, batch_rays = 8;

/// Rays that are traced in one go before what they ask is learnt, and of one task. chosen: memory of some 60 MB.
constexpr std::size_t rays_at_once = std::size_t{1} << 19;
constexpr std::uint32_t bundle_rays = 256;

/// Rays of a lobe whose cones fill it, for the sky's sake. chosen: 64.
constexpr float lobe_rays = 64.0f;

/// Rays of a bundle from which sixteen neighbours lie within an eighth of the hemisphere.
constexpr std::uint32_t coherent_rays = 128;

/// Standard errors that a tolerance holds. chosen: 1.3 of 0.7 to 2.6, half of what one point in a hundred exceeds: the
/// error of rays is white, which coding hides twice to four times as well as what is smooth.
constexpr float errors_allowed = 1.3f;

/// Power of the number of rays that their mean's variance falls with. chosen: 1.2, of 1.14 to 1.32 measured in Sponza
/// and a box; independent rays have 1, a smooth integrand more than 2.
constexpr float variance_power = 1.2f;

/// Rays after which one more buys its price where N rays meet the tolerance: N0 of docs/model/gathering.md, times the
/// typical tolerance. chosen: 10, of 4 to 20 on cornell, colonnade and character, for most squared error a ray.
constexpr float worth_rays = 10.0f;

/// Owen's scrambling of bits below each bit by those above, by a hash [Laine2011].
std::uint32_t scrambled(std::uint32_t bits, std::uint32_t seed) {
    bits = (bits & 0x55555555u) << 1 | (bits >> 1 & 0x55555555u);
    bits = (bits & 0x33333333u) << 2 | (bits >> 2 & 0x33333333u);
    bits = (bits & 0x0f0f0f0fu) << 4 | (bits >> 4 & 0x0f0f0f0fu);
    bits = (bits & 0x00ff00ffu) << 8 | (bits >> 8 & 0x00ff00ffu);
    bits = bits << 16 | bits >> 16;
    bits += seed;
    bits ^= bits * 0x6c50b47cu;
    bits ^= bits * 0xb82f1e52u;
    bits ^= bits * 0xc7afe638u;
    bits ^= bits * 0x8d22f6e6u;
    bits = (bits & 0x55555555u) << 1 | (bits >> 1 & 0x55555555u);
    bits = (bits & 0x33333333u) << 2 | (bits >> 2 & 0x33333333u);
    bits = (bits & 0x0f0f0f0fu) << 4 | (bits >> 4 & 0x0f0f0f0fu);
    bits = (bits & 0x00ff00ffu) << 8 | (bits >> 8 & 0x00ff00ffu);
    return bits << 16 | bits >> 16;
}

/// Element `index` of Sobol's first two dimensions [Sobol1967], scrambled: any power of two of them in a row lie
/// evenly.
glm::vec2 net_point(std::uint32_t index, std::uint64_t seed) {
    std::uint32_t x = 0, y = 0, first = 1u << 31, second = 1u << 31;
    for (; index != 0; index >>= 1, first >>= 1, second ^= second >> 1) {
        if ((index & 1u) == 0) continue;
        x ^= first;
        y ^= second;
    }
    const glm::uvec2 bits(scrambled(x, static_cast<std::uint32_t>(seed)),
                          scrambled(y, static_cast<std::uint32_t>(seed >> 32)));
    return glm::vec2(bits >> 8u) * 0x1p-24f;
}

/// The upper four bits of both coordinates, in turn: neighbours in the square have numbers near each other.
std::uint32_t interleaved(glm::vec2 u) {
    const auto x = static_cast<std::uint32_t>(16.0f * u.x), y = static_cast<std::uint32_t>(16.0f * u.y);
    std::uint32_t bits = 0;
    for (unsigned b = 0; b < 4; ++b) bits |= (x >> b & 1u) << (2 * b) | (y >> b & 1u) << (2 * b + 1);
    return bits;
}

/// Luminance that the pixel shows of light found by rays: irradiance over pi and the lobe's two parts.
double shown_luminance(const GatherPoint& point, const std::array<glm::vec3, 3>& light) {
    const Bsdf& bsdf = point.point.bsdf;
    return core::luminance(point.weight * (bsdf.diffuse * light[0] + bsdf.f0 * light[1] + bsdf.f90 * light[2]));
}

/// Where the pool of a request ends.
std::size_t pool_end(std::span<const GatherRequest> requests, std::size_t first) {
    std::size_t last = first;
    while (last < requests.size() && requests[last].pool == requests[first].pool) ++last;
    return last;
}

}  // namespace

/// Sums over some rays of a point.
struct FinalGather::RaySums {
    std::array<glm::dvec3, 3> light{};  ///< irradiance over pi, and the lobe's two parts: RayLight
    std::array<double, 3> weight{};
    std::uint32_t rays = 0;

    /// Light by all of them. Weights of rays along a lobe come to its albedo in the end [Karis2013].
    std::array<glm::vec3, 3> mean(const std::optional<LobeAlbedo>& albedo) const {
        if (albedo)
            return {glm::vec3(0), glm::vec3(light[1] * core::divide_or(1.0 * albedo->f0, weight[1], 0.0)),
                    glm::vec3(light[2] * core::divide_or(1.0 * albedo->f90, weight[2], 0.0))};
        const double share = 1.0 / rays;
        return {glm::vec3(share * light[0]), glm::vec3(share * light[1]), glm::vec3(share * light[2])};
    }
};

/// What a point's rays have found so far.
struct FinalGather::Sums : RaySums {
    std::optional<LobeAlbedo> albedo{};     ///< of a request along a lobe
    double batches = 0, batch_squares = 0;  ///< of luminances of the pixel, means of batches

    std::array<glm::vec3, 3> mean() const { return RaySums::mean(albedo); }
    /// Variance of the mean of a batch.
    double batch_variance() const {
        const double n = rays / batch_rays;
        return n < 2 ? 0.0 : std::max(batch_squares - batches * batches / n, 0.0) / (n - 1);
    }
    /// Variance of the mean of all rays.
    double variance() const { return batch_variance() * std::pow(1.0 * batch_rays / rays, variance_power); }
};

/// Some rays of one request.
struct FinalGather::Bundle {
    std::uint32_t request = 0, first = 0, count = 0;
};

/// What they found: by ray.
struct FinalGather::Traced {
    struct Ray {
        glm::vec3 light{0};             ///< radiance
        std::array<float, 3> weight{};  ///< of it in the sums
    };
    std::vector<Ray> rays;
    std::vector<RayTerm> terms;
    std::uint64_t traced = 0;
};

FinalGather::FinalGather(const PosedScene& posed_scene, const Plan& plan)
    : posed_scene_(posed_scene),
      gather_rays_(posed_scene, plan),
      cache_(posed_scene, plan),
      bodies_block_(plan.runs(Pass::caustics)) {}

void FinalGather::forget(const SkyOfRays& sky) {
    cache_.forget(sky.near_field);
    sky_ = sky;
}

/// Directions of a bundle's rays, and what the sums take of each.
struct FinalGather::Directions {
    struct Ray {
        glm::vec3 direction{0};
        std::array<float, 3> weight{};  ///< of irradiance, f0, f90; all 0: it is not traced
        float solid_angle = 0;
    };
    std::array<Ray, bundle_rays> rays;
    std::array<std::uint32_t, bundle_rays> order;  ///< neighbours lie next to each other
};

/// Cosine-distributed; wide lobes take them as well.
FinalGather::Directions FinalGather::hemisphere(const GatherRequest& request, const Bundle& bundle) const {
    const SurfacePoint& p = request.point->point;
    const bool coated = p.bsdf.has_glossy(), glossy = coated && !p.bsdf.has_narrow_lobe();
    Bsdf white = p.bsdf;
    white.diffuse = glm::vec3(0);
    white.f0 = white.f90 = glm::vec3(1);
    Directions out;
    std::array<std::pair<std::uint32_t, std::uint32_t>, bundle_rays> order;
    for (std::uint32_t i = 0; i < bundle.count; ++i) {
        const glm::vec2 u = net_point(bundle.first + i, request.seed);
        order[i] = {interleaved(u), i};
        Directions::Ray& ray = out.rays[i];
        ray.direction = core::sample_cosine_hemisphere(p.shading_normal, u);
        ray.solid_angle = std::numbers::pi_v<float> / static_cast<float>(std::max(bundle.first + bundle.count, 64u));
        ray.weight[0] = 1.0f;
        if (!coated) continue;
        const glm::vec3 half = core::normalize_or(ray.direction + p.outgoing, p.shading_normal);
        const float s = lobe::schlick(glm::dot(half, p.outgoing));
        ray.weight[0] = 1.0f - s;
        if (!glossy) continue;
        const float both = std::numbers::pi_v<float> * evaluate(white, p.shading_normal, p.outgoing, ray.direction).x;
        ray.weight[1] = both * (1.0f - s);
        ray.weight[2] = both * s;
    }
    if (bundle.count >= coherent_rays) std::sort(order.begin(), order.begin() + bundle.count);
    for (std::uint32_t i = 0; i < bundle.count; ++i) out.order[i] = order[i].second;
    return out;
}

/// Mirrored by the lobe's visible normals [Heitz2018].
FinalGather::Directions FinalGather::lobe(const GatherRequest& request, const Bundle& bundle) const {
    const SurfacePoint& p = request.point->point;
    StretchedLobe lobe(p.bsdf, p.shading_normal);
    if (!p.bsdf.is_stretched()) lobe.alpha = glm::vec2(p.bsdf.alpha);
    glm::vec3 eye = lobe.local(p.outgoing);
    eye.z = std::max(eye.z, 1e-3f);
    eye = glm::normalize(eye);
    Directions out;
    for (std::uint32_t i = 0; i < bundle.count; ++i) {
        out.order[i] = i;
        const glm::vec3 half = visible_normal(eye, lobe.alpha, net_point(bundle.first + i, request.seed));
        const float eye_half = std::max(glm::dot(eye, half), 0.0f);
        const glm::vec3 light = 2.0f * eye_half * half - eye;
        if (!(light.z > 0.0f)) continue;
        Directions::Ray& ray = out.rays[i];
        ray.direction = core::normalize_or(lobe.world(light), p.shading_normal);
        const float density = lobe.density(half, eye);
        // G2 / G1
        const float weight =
            core::divide_or(lobe.distribution(half) * lobe.masking(light, eye) * light.z, density, 0.0f);
        const float s = lobe::schlick(eye_half);
        ray.weight = {0.0f, weight * (1.0f - s), weight * s};
        ray.solid_angle = core::divide_or(1.0f, lobe_rays * density, 0.0f);
    }
    return out;
}

void FinalGather::trace(const GatherRequest& request, const Bundle& bundle, Traced& out) const {
    const GatherPoint& point = *request.point;
    const SurfacePoint& p = point.point;
    const glm::vec3 smooth = p.geometric_normal + p.smooth.tilt;
    const std::uint32_t places = point.others + 1u;
    const Directions directions = request.lobe ? lobe(request, bundle) : hemisphere(request, bundle);
    RayRules rules;
    rules.near = request.extent;
    rules.is_lobe = request.lobe;
    if (request.lobe) rules.spread = std::min(rules.spread, 0.5f * p.bsdf.alpha);
    rules.bodies_block = bodies_block_;

    std::array<RayQuery, bundle_rays> queries;
    std::array<Hit, bundle_rays> hits;
    std::array<std::uint32_t, bundle_rays> index;
    std::uint32_t asked = 0;
    out.rays.assign(bundle.count, {});
    for (std::uint32_t k = 0; k < bundle.count; ++k) {
        const std::uint32_t i = directions.order[k], number = bundle.first + i;
        const Directions::Ray& ray = directions.rays[i];
        const bool counts = ray.weight[0] + ray.weight[1] + ray.weight[2] > 0.0f;
        // A lobe is known in all, whatever of it the surface hides; so is a diffuse surface.
        out.rays[i].weight = ray.weight;
        if (!counts || !(glm::dot(smooth, ray.direction) > 0.0f)) continue;
        const auto place = static_cast<std::uint32_t>(core::mix(request.seed ^ number) % places);
        queries[asked] = {place == 0 ? shadow_origin(p) : point.elsewhere[place - 1], ray.direction,
                          std::numeric_limits<float>::infinity()};
        index[asked++] = i;
    }
    posed_scene_.tracer().any_nearest(std::span<const RayQuery>(queries.data(), asked),
                                      std::span<Hit>(hits.data(), asked),
                                      bundle.count >= coherent_rays && !request.lobe);
    out.traced += asked;
    for (std::uint32_t k = 0; k < asked; ++k) {
        const Directions::Ray& ray = directions.rays[index[k]];
        rules.brightest = !request.lobe ? sky_.brightest
                          : !sky_.importance
                              ? sky_.lobe_brightest
                              : core::divide_or(sky_.lobe_brightest, sky_.importance(ray.direction), 0.0f);
        out.rays[index[k]].light = gather_rays_.follow(queries[k], hits[k], rules, ray.solid_angle,
                                                       core::mix(request.seed + 8u * (bundle.first + index[k])),
                                                       index[k], out.terms, out.traced);
    }
}

void FinalGather::trace_all(std::span<const GatherRequest> requests, std::span<const Bundle> bundles,
                            std::vector<Sums>& sums) {
    std::vector<Traced> found(bundles.size());
    parallel::for_ranges(bundles.size(), 16, [&](std::size_t first, std::size_t last) {
        const FlushDenormals flushed;
        for (std::size_t b = first; b < last; ++b) trace(requests[bundles[b].request], bundles[b], found[b]);
    });
    // Learn what the cells that they met do not know,
    std::vector<Sighting> wanted;
    for (Traced& t : found) {
        counts_.rays += t.traced;
        for (const RayTerm& term : t.terms)
            if (cache_.find(term.place.key) == CellTable::none) wanted.push_back(term.place);
    }
    cache_.learn(wanted);
    // and sum up, in the order of rays.
    parallel::for_ranges(bundles.size(), 16, [&](std::size_t first, std::size_t last) {
        for (std::size_t b = first; b < last; ++b)
            for (const RayTerm& term : found[b].terms) {
                const std::uint32_t cell = cache_.index_of(term.place.key);
                glm::vec3 radiance = cache_.radiance(cell);
                if (!requests[bundles[b].request].lobe)
                    radiance = glm::max(radiance - cache_.near_part(cell), glm::vec3(0));
                found[b].rays[term.ray].light += term.weight * radiance;
            }
    });
    for (std::size_t b = 0; b < bundles.size(); ++b) {
        const GatherPoint& point = *requests[bundles[b].request].point;
        Sums& s = sums[bundles[b].request];
        RaySums batch;
        for (const Traced::Ray& ray : found[b].rays) {
            for (std::size_t k = 0; k < 3; ++k) {
                const glm::dvec3 light = ray.weight[k] * ray.light;
                s.light[k] += light;
                s.weight[k] += ray.weight[k];
                batch.light[k] += light;
                batch.weight[k] += ray.weight[k];
            }
            if (++batch.rays < batch_rays) continue;
            const double shown = shown_luminance(point, batch.mean(s.albedo));
            s.batches += shown;
            s.batch_squares += shown * shown;
            batch = {};
        }
        s.rays += bundles[b].count;
    }
}

/// A plane of least squares through the light of a pool, by place on the surface and weighted by rays. What a point
/// itself found is drawn towards it by as much as noise explains what points are off it by: the empirical Bayes
/// estimator [Efron1973]. It keeps the pool's mean.
struct FinalGather::PoolFit {
    static constexpr std::size_t quantities = 3, least_points = 6;
    using Light = std::array<glm::dvec3, quantities>;

    std::vector<Light> plane;  ///< at the points; empty: of too few
    double own = 1;            ///< weight of what a point itself found
    double plane_share = 1;    ///< variance of the plane at a point, over a point's

    /// Variance that is left, over a point's.
    double variance_share() const { return plane_share + (1.0 - plane_share) * own; }
    /// The same as far as nothing but noise is off the plane.
    static double least_share(std::span<const GatherRequest> requests) {
        const bool is_exact = !(requests.front().tolerance.allows(1.0f) > 0.0f);
        return is_exact || requests.size() < least_points ? 1.0 : 3.0 / static_cast<double>(requests.size());
    }

    PoolFit(std::span<const GatherRequest> requests, std::span<const Sums> sums) {
        const std::size_t n = requests.size();
        plane_share = least_share(requests);
        if (plane_share == 1.0) return;
        const SurfacePoint& first = requests.front().point->point;
        glm::vec3 t, b;
        core::make_frame(first.shading_normal, t, b);
        std::vector<glm::dvec2> place(n);
        double rays = 0;
        glm::dvec2 middle(0);
        for (std::size_t i = 0; i < n; ++i) {
            const glm::vec3 d = requests[i].point->point.position - first.position;
            place[i] = {glm::dot(t, d), glm::dot(b, d)};
            middle += 1.0 * sums[i].rays * place[i];
            rays += sums[i].rays;
        }
        middle /= rays;
        Light mean{}, x{}, y{};
        double xx = 0, xy = 0, yy = 0;
        for (std::size_t i = 0; i < n; ++i) {
            place[i] -= middle;
            xx += sums[i].rays * place[i].x * place[i].x;
            xy += sums[i].rays * place[i].x * place[i].y;
            yy += sums[i].rays * place[i].y * place[i].y;
            const std::array<glm::vec3, quantities> found = sums[i].mean();
            for (std::size_t k = 0; k < quantities; ++k) {
                const glm::dvec3 sum = 1.0 * sums[i].rays * glm::dvec3(found[k]);
                mean[k] += sum / rays;
                x[k] += place[i].x * sum;
                y[k] += place[i].y * sum;
            }
        }
        // Points in a row say nothing about the other direction.
        const double ridge = 1e-3 * (xx + yy);
        xx += ridge, yy += ridge;
        const double over = core::divide_or(1.0, xx * yy - xy * xy, 0.0);
        plane.resize(n);
        double off = 0, noise = 0;
        for (std::size_t i = 0; i < n; ++i) {
            std::array<glm::vec3, quantities> difference = sums[i].mean();
            for (std::size_t k = 0; k < quantities; ++k) {
                plane[i][k] =
                    mean[k] + over * ((yy * x[k] - xy * y[k]) * place[i].x + (xx * y[k] - xy * x[k]) * place[i].y);
                difference[k] -= glm::vec3(plane[i][k]);
            }
            const double d = shown_luminance(*requests[i].point, difference);
            off += d * d;
            noise += sums[i].variance();
        }
        off /= static_cast<double>(n) - 3.0;
        noise /= static_cast<double>(n);
        own = off > noise ? 1.0 - noise / off : 0.0;
        // What is infinite stays at its point.
        if (!(off + noise < std::numeric_limits<double>::infinity())) plane.clear(), own = plane_share = 1;
    }
};

/// How many rays each request needs in all. `pilot`: from the first look, which cannot tell detail from noise.
std::vector<std::uint32_t> FinalGather::wanted_rays(std::span<const GatherRequest> requests, std::span<const Sums> sums,
                                                    bool pilot, GatherAim aim) const {
    const double gain = aim.typical > 0.0f ? variance_power / (1.0 + variance_power) : 1.0;
    const double worth = gain < 1.0 ? std::pow(worth_rays / aim.typical, 1.0 - gain) : 1.0;
    const double more = std::pow(aim.finer, 2.0 / variance_power);
    std::vector<std::uint32_t> wanted(requests.size());
    for (std::size_t first = 0, last = 0, k = 0; first < requests.size(); first = last) {
        double all = 0;
        for (last = pool_end(requests, first); k < last;) all += sums[k++].batch_variance();
        const double share =
            pilot ? PoolFit::least_share(requests.subspan(first, last - first))
                  : PoolFit(requests.subspan(first, last - first), sums.subspan(first, last - first)).variance_share();
        const auto others = static_cast<double>(last - first) - 1.0;
        for (std::size_t i = first; i < last; ++i) {
            const Sums& s = sums[i];
            const double variance = share * (others > 0 ? (all - s.batch_variance()) / others : s.batch_variance());
            const double mean = s.batches * batch_rays / s.rays;
            const double error = requests[i].tolerance.allows(static_cast<float>(mean)) / errors_allowed;
            // Of points that may not err those that show most get most.
            const double shown = std::min(static_cast<double>(core::luminance(requests[i].point->weight)), 1.0);
            const double n =
                error > 0.0
                    ? more * worth *
                          std::pow(batch_rays * std::pow(variance / (error * error), 1.0 / variance_power), gain)
                    : most_gather_rays * shown;
            const auto rays = static_cast<std::uint32_t>(std::clamp(n, 1.0 * first_rays, 1.0 * most_gather_rays));
            wanted[i] = requests[i].rays > 0 ? requests[i].rays : (rays + batch_rays - 1) / batch_rays * batch_rays;
        }
    }
    return wanted;
}

GatherRequest request_of(const GatherPoint& point, const PointTolerance& tolerance, glm::ivec2 pixel,
                         const scene::Camera& camera) {
    GatherRequest r;
    r.point = &point;
    r.tolerance = tolerance;
    r.seed = core::mix(core::mix(static_cast<std::uint64_t>(pixel.y) << 32 | static_cast<std::uint32_t>(pixel.x)) ^
                       (static_cast<std::uint64_t>(point.point.address.object) << 8 | point.way));
    const auto on_picture = camera.project(point.point.position);
    r.extent = camera.pixel_size() * (camera.perspective() && on_picture ? on_picture->depth : 1.0f);
    return r;
}

void add(const RayLight& rays, const GatherPoint& point, PointLight& light) {
    const Bsdf& bsdf = point.point.bsdf;
    light.indirect += rays.irradiance;
    light.glossy += bsdf.f0 * rays.f0 + bsdf.f90 * rays.schlick;
    light.indirect_cut += static_cast<float>(rays.rays);
    light.error = std::hypot(light.error, rays.error);
}

std::vector<RayLight> FinalGather::gather(std::span<const GatherRequest> requests, GatherAim aim) {
    const Stopwatch timer(counts_.seconds);
    std::vector<Sums> sums(requests.size());
    for (std::size_t i = 0; i < requests.size(); ++i) {
        const SurfacePoint& p = requests[i].point->point;
        if (requests[i].lobe) sums[i].albedo = lobe_albedo(glm::dot(p.shading_normal, p.outgoing), p.bsdf.mean_alpha());
    }
    std::vector<std::uint32_t> wanted(requests.size(), first_rays);
    // A first look tells how many rays are wanted, a second one whether these are enough.
    for (int round = 0; round < 3; ++round) {
        std::vector<Bundle> bundles;
        std::size_t rays = 0;
        const auto flush = [&] {
            if (!bundles.empty()) trace_all(requests, bundles, sums);
            bundles.clear();
            rays = 0;
        };
        for (std::uint32_t i = 0; i < requests.size(); ++i) {
            for (std::uint32_t first = sums[i].rays; first < wanted[i]; first += bundle_rays)
                bundles.push_back({i, first, std::min(bundle_rays, wanted[i] - first)});
            rays += wanted[i] - std::min(wanted[i], sums[i].rays);
            if (rays >= rays_at_once) flush();
        }
        flush();
        wanted = wanted_rays(requests, sums, round == 0, aim);
    }
    std::vector<RayLight> light(requests.size());
    for (std::size_t first = 0, last = 0; first < requests.size(); first = last) {
        last = pool_end(requests, first);
        const PoolFit fit(requests.subspan(first, last - first), std::span(sums).subspan(first, last - first));
        for (std::size_t i = first; i < last; ++i) {
            const Sums& s = sums[i];
            std::array<glm::vec3, 3> found = s.mean();
            if (!fit.plane.empty())
                for (std::size_t k = 0; k < found.size(); ++k)
                    found[k] =
                        glm::max(glm::mix(glm::vec3(fit.plane[i - first][k]), found[k], static_cast<float>(fit.own)),
                                 glm::vec3(0));
            light[i] = {found[0], found[1], found[2], 0.0f, s.rays};
            light[i].error = errors_allowed * static_cast<float>(std::sqrt(fit.variance_share() * s.variance()));
        }
    }
    counts_.points += requests.size();
    counts_.cell_rays = cache_.rays();
    return light;
}

}  // namespace render2mpeg::renderer
