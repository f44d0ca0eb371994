#include "renderer/tree/gather_lanes.h"

#include <algorithm>

#include "core/color.h"
#include "core/error.h"
#include "core/numeric.h"
#include "core/sampling.h"
#include "renderer/base/lobe.h"
#include "renderer/surface/posed_scene.h"

namespace render2mpeg::renderer {
namespace {

/// A grazing eye ray divides by its cosine. chosen: 1e-3, which only keeps the quotient finite: the masking term of any
/// lobe in use is flat below it (alpha >= 0.01).
constexpr float least_cosine = 1e-3f;

void fill_lobe(GatherLanes& lanes, int lane, const SurfacePoint& p, glm::vec3 luminance_share) {
    const bool has_lobe = p.bsdf.has_lobe();
    const float nv = glm::dot(p.shading_normal, p.outgoing);
    put(lanes.f0_weight, lane, has_lobe ? luminance_share * p.bsdf.f0 : glm::vec3(0));
    put(lanes.schlick_weight, lane, has_lobe ? luminance_share * p.bsdf.f90 : glm::vec3(0));
    put_frame(lanes.outgoing, lane, p.outgoing);
    put_frame(lanes.mirrored, lane, core::normalize_or(2.0f * nv * p.shading_normal - p.outgoing, p.shading_normal));
    lanes.cos_outgoing[lane] = std::max(nv, least_cosine);
    lanes.coat[lane] = has_lobe ? p.bsdf.covered : 0.0f;
    lanes.lobed[lane] = has_lobe ? 1.0f : 0.0f;
    const float width = p.bsdf.is_stretched() ? p.bsdf.alpha_along * p.bsdf.alpha : p.bsdf.alpha * p.bsdf.alpha;
    lanes.lobe_width[lane] = has_lobe ? width : 1.0f;
}

void fill_stretch(GatherLanes& lanes, int lane, const SurfacePoint& p) {
    const StretchedLobe axes(p.bsdf, p.shading_normal);
    put(lanes.along, lane, axes.x);
    put(lanes.across, lane, axes.y);
    lanes.view_along[lane] = glm::dot(axes.x, p.outgoing);
    lanes.view_across[lane] = glm::dot(axes.y, p.outgoing);
    const bool stretched = p.bsdf.has_lobe() && p.bsdf.is_stretched();
    lanes.along2[lane] = stretched ? p.bsdf.alpha_along * p.bsdf.alpha_along : lanes.lobe_width[lane];
    lanes.across2[lane] = stretched ? p.bsdf.alpha * p.bsdf.alpha : lanes.lobe_width[lane];
    lanes.retro[lane] = p.bsdf.shape.retro;
    lanes.loss[lane] = p.bsdf.shape.loss;
    lanes.flat[lane] = p.bsdf.shape.flat;
    lanes.rough[lane] = p.bsdf.shape.rough;
}

}  // namespace

void fill(GatherLanes& lanes, std::span<const GatherPoint* const> points) {
    EXPECTS(!points.empty() && points.size() <= lane_count);
    lanes.count = static_cast<int>(points.size());
    lanes.glossy = false;
    for (const GatherPoint* point : points) lanes.glossy = lanes.glossy || point->point.bsdf.has_glossy();
    lanes.stretched = false;
    for (const GatherPoint* point : points)
        lanes.stretched = lanes.stretched || (point->point.bsdf.has_lobe() && point->point.bsdf.is_stretched()) ||
                          !point->point.bsdf.shape.is_lambert();
    lanes.timed = false;
    for (const GatherPoint* point : points) lanes.timed = lanes.timed || point->shadow_part != 0;
    lanes.places = 1;
    for (const GatherPoint* point : points) lanes.places = std::max(lanes.places, 1 + point->others);
    for (int i = 0; i < lane_count; ++i) {
        // Repeat the first point where there is none, but let it receive nothing.
        const bool used = i < lanes.count;
        const GatherPoint& point = *points[used ? static_cast<std::size_t>(i) : 0];
        const SurfacePoint& p = point.point;
        const glm::vec3 share = used ? core::luminance_weights * point.weight : glm::vec3(0);
        put(lanes.position, i, p.position);
        lanes.own_places[i] = 1 + point.others;
        lanes.more_places[i] = used ? point.more_places.get() : nullptr;
        const glm::vec3 origin = shadow_origin(p);
        put(lanes.origin, i, origin);
        for (int k = 1; k < lanes.places; ++k) {
            const int other = k % (1 + point.others);
            put(lanes.elsewhere[k - 1], i, other == 0 ? origin : point.elsewhere[static_cast<std::size_t>(other - 1)]);
        }
        if (lanes.timed)
            lanes.shadow_part[i] =
                point.shadow_part == 0 ? -1.0f : (static_cast<float>(point.shadow_part) - 0.5f) / 16.0f;
        put(lanes.geometric, i, used ? p.geometric_normal + p.smooth.tilt : glm::vec3(0));
        put_frame(lanes.normal, i, p.shading_normal);
        if (!used) put(lanes.normal.axis, i, glm::vec3(0));
        put(lanes.diffuse_weight, i, share * p.bsdf.diffuse * lobe::inverse_pi);
        if (!lanes.glossy) continue;
        fill_lobe(lanes, i, p, share);
        if (lanes.stretched) fill_stretch(lanes, i, p);
        lanes.rays_see[i] = p.bsdf.has_narrow_lobe() ? 1.0f / lobe::lobe_rays_disc2 : 0.0f;
    }
}

}  // namespace render2mpeg::renderer
