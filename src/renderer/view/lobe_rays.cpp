#include "renderer/view/lobe_rays.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/color.h"
#include "core/numeric.h"
#include "core/sampling.h"
#include "renderer/base/lobe.h"
#include "renderer/surface/lobe_albedo.h"

namespace render2mpeg::renderer {
namespace {

/// Rays that are traced at once; twice as many tell whether more are wanted; and the most of a point. chosen: 16, a
/// packet; 64, which leave an edge of the sky in steps of a 64th.
constexpr std::uint32_t rays_at_once = 16, most_lobe_rays = 64;

/// Surfaces that a ray passes or mirrors one after another, and the share of it below which it ends. chosen: 6, 0.02.
constexpr int most_surfaces = 6;
constexpr float least_passing = 0.02f;

/// Rays of a point that differ by more than this share of their mean, half against half, call for more. chosen: 0.01, a
/// quarter of what pictures are usually allowed to be off by.
constexpr float alike_halves = 0.01f;

/// Element `index` of Sobol's first two dimensions, its digits flipped by `scramble`: any 16, 32 or 64 in a row from a
/// multiple of that lie one in each cell of all nets of that size.
glm::vec2 net_point(std::uint32_t index, glm::uvec2 scramble) {
    glm::uvec2 bits = scramble;
    std::uint32_t first = 1u << 31, second = 1u << 31;
    for (; index != 0; index >>= 1, first >>= 1, second ^= second >> 1) {
        if ((index & 1u) == 0) continue;
        bits.x ^= first;
        bits.y ^= second;
    }
    // The upper 24 bits, so that it never rounds to 1.
    return glm::vec2(bits >> 8u) * 0x1p-24f;
}

}  // namespace

/// Sums over the rays of a point, of the lobe's two parts.
struct LobeRays::Sums {
    glm::vec3 f0{0}, f90{0};  ///< weight x radiance
    float f0_weight = 0, f90_weight = 0;
    std::uint64_t rays = 0;

    /// Radiance of the lobe [Karis2013].
    glm::vec3 radiance(const Bsdf& bsdf, LobeAlbedo albedo) const {
        glm::vec3 sum(0);
        for (int k = 0; k < 3; ++k)
            sum[k] = bsdf.f0[k] * albedo.f0 * core::divide_or(f0[k], f0_weight, 0.0f) +
                     bsdf.f90[k] * albedo.f90 * core::divide_or(f90[k], f90_weight, 0.0f);
        return sum;
    }
};

LobeRays::LobeRays(const PosedScene& posed_scene, const SeeSettings& settings, const Plan& plan)
    : posed_scene_(posed_scene),
      irradiance_(settings.irradiance),
      sky_importance_(settings.sky_importance),
      traces_(plan.runs(Pass::lobe_rays)),
      brightest_(settings.sky_part / (std::numbers::pi_v<float> * lobe::lobe_rays_disc2)),
      pixel_extent_(2.0f * std::tan(0.5f * posed_scene.posed().camera.lens().vertical_fov) /
                    static_cast<float>(settings.format.height)) {}

/// Light trees have the rest: of a part of the sky with this radiance as much as it is too narrow (lobe::by_trees).
glm::vec3 LobeRays::sky(glm::vec3 direction, float solid_angle) const {
    if (posed_scene_.sky() == nullptr) return glm::vec3(0);
    const glm::vec3 radiance = posed_scene_.sky()->radiance(direction, solid_angle);
    const float brightest =
        sky_importance_ ? core::divide_or(brightest_, sky_importance_(direction), 0.0f) : brightest_;
    return radiance * std::min(core::divide_or(brightest, core::luminance(radiance), 1.0f), 1.0f);
}

/// A pattern of its own for every cell of a surface, about as large as a pixel, that stays on it as it moves.
glm::uvec2 LobeRays::scramble_of(const SurfacePoint& p) const {
    const scene::Snapshot& now = posed_scene_.posed();
    const scene::Triangle t = scene::triangle_of(now, p.address.object, p.address.primitive);
    const float edge = std::max(glm::distance(t.a, t.b), glm::distance(t.a, t.c));
    const float pixel = pixel_extent_ * glm::distance(p.position, now.camera.position());
    const float cells =
        std::exp2(std::floor(std::log2(std::clamp(core::divide_or(edge, pixel, 1.0f), 1.0f, 65536.0f))));
    const auto cell = [&](float u) { return static_cast<std::uint64_t>(std::clamp(u, 0.0f, 1.0f) * cells); };
    const std::uint64_t triangle = core::mix(std::uint64_t{p.address.object} << 32 | p.address.primitive);
    const std::uint64_t bits = core::mix(triangle ^ (cell(p.address.u) << 32 | cell(p.address.v)));
    return {static_cast<std::uint32_t>(bits), static_cast<std::uint32_t>(bits >> 32)};
}

/// Sixteen rays, from number `first` of the point's pattern.
void LobeRays::trace(const GatherPoint& point, std::uint32_t first, glm::uvec2 scramble, Sums& sums) const {
    const SurfacePoint& p = point.point;
    const glm::vec3 n = p.shading_normal, smooth = p.geometric_normal + p.smooth.tilt;
    glm::vec3 t, b;
    core::make_frame(n, t, b);
    const StretchedLobe stretched(p.bsdf, n);
    const bool is_stretched = p.bsdf.is_stretched();
    if (is_stretched) t = stretched.x, b = stretched.y;
    const float nv = std::max(glm::dot(n, p.outgoing), 1e-3f), a2 = p.bsdf.alpha * p.bsdf.alpha;
    const glm::vec3 outgoing = glm::normalize(glm::vec3(glm::dot(t, p.outgoing), glm::dot(b, p.outgoing), nv));
    const glm::vec3 origin = offset_origin(p, p.geometric_normal) + p.smooth.lift;

    RayQuery queries[rays_at_once];
    Hit hits[rays_at_once];
    std::uint32_t asked[rays_at_once], count = 0;
    float weight[rays_at_once], fresnel[rays_at_once], solid_angle[rays_at_once];
    for (std::uint32_t i = 0; i < rays_at_once; ++i) {
        const glm::vec2 u = net_point(first + i, scramble);
        const glm::vec3 h =
            is_stretched ? visible_normal(outgoing, stretched.alpha, u) : visible_normal(outgoing, p.bsdf.alpha, u);
        const float vh = std::max(glm::dot(outgoing, h), 0.0f);
        const glm::vec3 l = 2.0f * vh * h - outgoing;
        const glm::vec3 direction = core::normalize_or(l.x * t + l.y * b + l.z * n, n);
        fresnel[i] = lobe::schlick(vh);
        // G2 / G1, but for what is the same for all of them.
        const auto masking = [&] {
            return is_stretched ? stretched.masking(l, outgoing) : lobe::masking(l.z, outgoing.z, a2);
        };
        weight[i] = l.z > 0.0f ? masking() * l.z : 0.0f;
        const float g1 = 2.0f / (outgoing.z + std::sqrt(a2 + (1.0f - a2) * outgoing.z * outgoing.z));
        const float pdf = is_stretched ? stretched.density(h, outgoing)
                                       : 0.25f * g1 * lobe::distribution(std::min(h.z * h.z, 1.0f), a2);
        solid_angle[i] = core::divide_or(1.0f / static_cast<float>(most_lobe_rays), pdf, 0.0f);
        const float f0 = weight[i] * (1.0f - fresnel[i]), f90 = weight[i] * fresnel[i];
        sums.f0_weight += f0;
        sums.f90_weight += f90;
        if (!(weight[i] > 0.0f) || !(glm::dot(smooth, direction) > 0.0f)) continue;
        asked[count] = i;
        queries[count++] = {origin, direction, std::numeric_limits<float>::infinity()};
    }
    posed_scene_.tracer().nearest(std::span<const RayQuery>(queries, count), std::span<Hit>(hits, count));
    sums.rays += count;
    for (std::uint32_t k = 0; k < count; ++k) {
        const std::uint32_t i = asked[k];
        const glm::vec3 light = radiance_along(queries[k], hits[k], solid_angle[i], sums.rays);
        sums.f0 += weight[i] * (1.0f - fresnel[i]) * light;
        sums.f90 += weight[i] * fresnel[i] * light;
    }
}

/// What comes along a ray that stands for a cone: of surfaces what they scatter of the light at anchors, of layers and
/// mirrors what is behind and in them, some deep. What shines and is a lamp is none of it, since light trees have it.
glm::vec3 LobeRays::radiance_along(RayQuery ray, Hit hit, float solid_angle, std::uint64_t& rays) const {
    const float spread = std::sqrt(solid_angle * lobe::inverse_pi);
    glm::vec3 sum(0), passing(1), t, b;
    float distance = 0;
    for (int step = 0; step < most_surfaces; ++step) {
        if (step > 0) {
            hit = posed_scene_.tracer().nearest(ray.origin, ray.direction, ray.far);
            ++rays;
        }
        const Air* air = posed_scene_.air();
        if (air != nullptr)
            passing *= std::exp(-(hit.found() ? air->optical_depth(ray.origin, ray.direction, hit.distance)
                                              : air->depth_to_sky(ray.origin, ray.direction)));
        if (!hit.found()) return sum + passing * sky(ray.direction, solid_angle);
        distance += hit.distance;
        core::make_frame(ray.direction, t, b);
        const SurfacePoint p = posed_scene_.surface_at(hit.address, -ray.direction,
                                                       {2.0f * spread * distance * t, 2.0f * spread * distance * b});
        const Bsdf& bsdf = p.bsdf;
        const float cosine = glm::dot(p.shading_normal, p.outgoing);
        const glm::vec3 shown = passing * p.alpha;
        if (p.unlit) sum += shown * p.emission;
        if (irradiance_ && p.alpha > 0.0f && (bsdf.has_diffuse() || bsdf.has_glossy())) {
            int more = 0;
            sum += shown * (diffuse_albedo(bsdf, cosine) + glossy_albedo(bsdf, cosine)) * irradiance_(p, more);
            rays += static_cast<std::uint64_t>(more);
        }
        if (irradiance_ && p.alpha > 0.0f && bsdf.has_diffuse_transmission()) {
            int more = 0;
            sum += shown * bsdf.diffuse_transmission * irradiance_(posed_scene_.other_side(p), more);
            rays += static_cast<std::uint64_t>(more);
        }
        passing = passing * (1.0f - p.alpha) + shown * bsdf.transmission;
        if (!(core::luminance(passing) > least_passing)) {
            passing = shown * bsdf.mirror;
            if (!(core::luminance(passing) > least_passing)) break;
            ray.direction = core::normalize_or(2.0f * cosine * p.shading_normal - p.outgoing, p.geometric_normal);
        }
        ray.origin = offset_origin(p, ray.direction);
    }
    return sum;
}

glm::vec3 LobeRays::radiance(const GatherPoint& p, std::uint64_t& rays) const {
    const Bsdf& bsdf = p.point.bsdf;
    const LobeAlbedo albedo = lobe_albedo(glm::dot(p.point.shading_normal, p.point.outgoing), bsdf.mean_alpha());
    const glm::uvec2 scramble = scramble_of(p.point);
    Sums sums;
    trace(p, 0, scramble, sums);
    const float some = core::luminance(sums.radiance(bsdf, albedo));
    trace(p, rays_at_once, scramble, sums);
    const float more = core::luminance(sums.radiance(bsdf, albedo));
    if (std::abs(some - more) > alike_halves * more)
        for (std::uint32_t first = 2 * rays_at_once; first < most_lobe_rays; first += rays_at_once)
            trace(p, first, scramble, sums);
    rays += sums.rays;
    return sums.radiance(bsdf, albedo);
}

std::uint64_t LobeRays::light(std::size_t tile, Seen& seen) const {
    const auto across = static_cast<std::size_t>(seen.tiles_across());
    std::uint64_t rays = 0;
    for (GatherPoint& p : seen.tiles[tile]) {
        if (p.has_lobe_rays || !p.point.bsdf.has_narrow_lobe()) continue;
        p.has_lobe_rays = true;
        const int x = static_cast<int>(tile % across) * tile_size + p.pixel % tile_size;
        const int y = static_cast<int>(tile / across) * tile_size + p.pixel / tile_size;
        const glm::vec3 light = p.weight * radiance(p, rays);
        seen.emitted.at(x, y) += light;
        (p.reached_by_specular() ? seen.emitted_specular : seen.emitted_glossy).at(x, y) += light;
    }
    return rays;
}

}  // namespace render2mpeg::renderer
