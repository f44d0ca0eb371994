// Bounds after [Walter2005, 5.1]: the receiver's cosine over the cluster's box, the emitter's cosine over box and
// normal cone, and the box's least distance, each at its extreme. Changed: a GGX lobe instead of Phong's; colours are
// bounded channel by channel; the clamp of near lights bounds what the box's distance cannot.
#include "renderer/tree/light_kernels.h"

#include <algorithm>
#include <cmath>

#include "core/color.h"
#include "core/error.h"
#include "renderer/base/light_packing.h"
#include "renderer/base/lobe.h"

namespace render2mpeg::renderer {
namespace {

/// Half vectors turn half as far as directions, and a disc of radius r at distance d has a variance of (r / d)^2 / 4
/// along each axis; a GGX lobe's slopes have about alpha^2 / 2. Adding variances widens alpha^2 by (r / d)^2 / 8.
constexpr float widening = 0.125f;

/// Covers the rounding of bounds. chosen: 1e-4, some thousand roundings' worth; costs nothing measurable.
constexpr float outward = 1.0001f, inward = 1.0f / outward;

RENDER2MPEG_ALWAYS_INLINED float dot(const Vec3Lanes& a, int i, float x, float y, float z) {
    return a.x[i] * x + a.y[i] * y + a.z[i] * z;
}
RENDER2MPEG_ALWAYS_INLINED float dot_abs(const Vec3Lanes& a, int i, float x, float y, float z) {
    return inlined::abs(a.x[i]) * x + inlined::abs(a.y[i]) * y + inlined::abs(a.z[i]) * z;
}

/// The GGX lobe's radiance per unit of `irradiance` from direction (x, y, z), unit; and the irradiance that passes it.
RENDER2MPEG_ALWAYS_INLINED void glossy_value(const GatherLanes& lanes, int i, float x, float y, float z, float spread2,
                                             float irradiance, LightLanes& out) {
    const float nl = dot(lanes.normal.axis, i, x, y, z);
    const float nv = lanes.cos_outgoing[i];
    const float lv = dot(lanes.outgoing.axis, i, x, y, z);
    const float a2 = inlined::min(lanes.lobe_width[i] + widening * spread2, 1.0f);
    const float half2 = inlined::max(2.0f + 2.0f * lv, 1e-7f);
    const float nh2 = inlined::min((nl + nv) * (nl + nv) / half2, 1.0f);
    const float vh = inlined::sqrt(inlined::max(0.5f * (1.0f + lv), 0.0f));
    const float s = lobe::schlick(vh);
    const float dv = lobe::distribution(nh2, a2) * lobe::masking(inlined::max(nl, 0.0f), nv, a2) * irradiance;
    out.diffuse[i] = irradiance * (1.0f - lanes.coat[i] * s);
    out.f0[i] = dv * (1.0f - s);
    out.schlick[i] = dv * s;
}

/// The same where lobes may be stretched, and diffuse parts may have a shape.
RENDER2MPEG_ALWAYS_INLINED void stretched_value(const GatherLanes& lanes, int i, float x, float y, float z,
                                                float spread2, float irradiance, LightLanes& out) {
    const lobe::StretchedCosines light{dot(lanes.along, i, x, y, z), dot(lanes.across, i, x, y, z),
                                       dot(lanes.normal.axis, i, x, y, z)};
    const lobe::StretchedCosines eye{lanes.view_along[i], lanes.view_across[i], lanes.cos_outgoing[i]};
    const float lv = dot(lanes.outgoing.axis, i, x, y, z);
    const float half2 = inlined::max(2.0f + 2.0f * lv, 1e-7f);
    const float s = lobe::schlick(inlined::sqrt(inlined::max(0.5f * (1.0f + lv), 0.0f)));
    const float dv = lobe::stretched_value(light, eye, half2, inlined::min(lanes.along2[i] + widening * spread2, 1.0f),
                                           inlined::min(lanes.across2[i] + widening * spread2, 1.0f)) *
                     irradiance;
    out.diffuse[i] = irradiance * (1.0f - lanes.coat[i] * s) *
                     lobe::shaped(lanes.retro[i], lanes.loss[i], lanes.flat[i], lanes.rough[i],
                                  inlined::max(light.normal, 0.0f), eye.normal, lv);
    out.f0[i] = dv * (1.0f - s);
    out.schlick[i] = dv * s;
}

/// The clamp of G, 1 / (disc2 / scale), with one division.
RENDER2MPEG_ALWAYS_INLINED float largest_g(float disc2, float scale) {
    return scale / inlined::max(disc2, lobe::tiny * scale);
}

/// A light as one lane sees it.
struct LaneLight {
    float x, y, z, nx, ny, nz;
    float blur2, clamp;  ///< GeometryClamp
    float range2, spot_scale, spot_offset, spot_smooth;
    float rays;  ///< argument of `lobe::by_trees` for its disc2
};

/// Argument of `lobe::by_trees` for a light's disc2, for directional lights and for others at the distance 1.
RENDER2MPEG_ALWAYS_INLINED float seen_by_rays(float disc2, GeometryClamp clamp) {
    constexpr float all = 1e30f;
    if (clamp.by_rays == GeometryClamp::ByRays::none) return 0.0f;
    return clamp.by_rays == GeometryClamp::ByRays::by_size ? disc2 : all;
}

RENDER2MPEG_ALWAYS_INLINED LaneLight lane_light(float x, float y, float z, float nx, float ny, float nz, float disc2,
                                                const Spot& spot, float scale, float rays) {
    return {x,     y,          z,           nx,          ny,  nz, disc2 / scale, largest_g(disc2, scale),
            disc2, spot.scale, spot.offset, spot.smooth, rays};
}

/// Writes lane i of `out`; returns G before the clamp.
template <LightType type, bool glossy, bool stretched = false>
RENDER2MPEG_ALWAYS_INLINED float evaluate_lane(const GatherLanes& lanes, int i, const LaneLight& l, LightLanes& out) {
    float x = l.x, y = l.y, z = l.z, inverse2 = 1.0f, emit = 1.0f;
    if constexpr (type != LightType::directional) {
        x -= lanes.position.x[i];
        y -= lanes.position.y[i];
        z -= lanes.position.z[i];
        const float distance2 = x * x + y * y + z * z;
        inverse2 = 1.0f / inlined::max(distance2, lobe::tiny);
        if constexpr (type == LightType::punctual || glossy) {
            const float inverse = inlined::sqrt(inverse2);
            x *= inverse;
            y *= inverse;
            z *= inverse;
        }
        const float cosine = -(l.nx * x + l.ny * y + l.nz * z);
        if constexpr (type == LightType::oriented) {
            emit = inlined::max(cosine, 0.0f) * inverse2;
        } else {
            // Window of the range [KHR_lights_punctual] and the spot's falloff.
            const float reach2 = distance2 / l.range2;
            const float window = inlined::min(inlined::max(1.0f - reach2 * reach2, 0.0f), 1.0f);
            const float spot = inlined::min(inlined::max(cosine * l.spot_scale + l.spot_offset, 0.0f), 1.0f);
            // As `Spot::falloff`.
            const float shape = 1.0f + l.spot_smooth * (cosine * (3.0f - 2.0f * spot) - 1.0f);
            emit = window * spot * spot * shape * inverse2;
        }
    }
    const float front = dot(lanes.geometric, i, x, y, z);
    const float facing = inlined::max(dot(lanes.normal.axis, i, x, y, z), 0.0f);
    const float cosine = front > 0.0f ? facing : 0.0f;
    // Without a lobe nobody wants unit directions: cosines times the distance, each over its square.
    constexpr bool plain = type == LightType::oriented && !glossy;
    float g = plain ? cosine * inverse2 * emit : cosine * emit;
    const float unclamped = g;
    if constexpr (type == LightType::oriented) g = inlined::min(g, l.clamp);
    if constexpr (!glossy) out.diffuse[i] = g;
    if constexpr (glossy && !stretched)
        glossy_value(lanes, i, x, y, z, type == LightType::punctual ? 0.0f : l.blur2 * inverse2, g, out);
    if constexpr (stretched)
        stretched_value(lanes, i, x, y, z, type == LightType::punctual ? 0.0f : l.blur2 * inverse2, g, out);
    if constexpr (glossy && type != LightType::punctual) {
        const float seen = inlined::min(l.rays * inverse2, 1.0f);
        const float share = lobe::by_trees(seen, lanes.rays_see[i]);
        out.f0[i] *= share;
        out.schlick[i] *= share;
    }
    return unclamped;
}

RENDER2MPEG_ALWAYS_INLINED LaneLight lane_light(const TreeLight& light, const Spot* spot, GeometryClamp clamp) {
    float nx = 0, ny = 0, nz = 0;
    unpack_normal(light.axis, nx, ny, nz);
    return lane_light(light.position.x, light.position.y, light.position.z, nx, ny, nz, light.disc2,
                      spot != nullptr ? *spot : Spot{}, clamp.scale, seen_by_rays(light.disc2, clamp));
}

template <LightType type, bool glossy, bool stretched = false>
RENDER2MPEG_ALWAYS_INLINED void evaluate_lanes(const GatherLanes& __restrict lanes, const TreeLight& light,
                                               const Spot* spot, GeometryClamp clamp, LightLanes& __restrict out) {
    const LaneLight l = lane_light(light, spot, clamp);
    Lanes unclamped;
    for (int i = 0; i < lane_count; ++i) unclamped[i] = evaluate_lane<type, glossy, stretched>(lanes, i, l, out);
    int clamped = 0;
    if constexpr (type == LightType::oriented)
        for (int i = 0; i < lane_count; ++i) clamped |= unclamped[i] > l.clamp ? 1 : 0;
    out.any_clamped = clamped != 0;
}

template <LightType type, bool glossy, bool stretched = false>
RENDER2MPEG_ALWAYS_INLINED void evaluate_each(const GatherLanes& __restrict lanes, const LightPacket& __restrict p,
                                              GeometryClamp clamp, LightLanes& __restrict out) {
    for (int i = 0; i < lane_count; ++i) {
        const LaneLight l = lane_light(
            p.position.x[i], p.position.y[i], p.position.z[i], p.normal.x[i], p.normal.y[i], p.normal.z[i], p.disc2[i],
            Spot{p.spot_scale[i], p.spot_offset[i], p.spot_smooth[i]}, clamp.scale, seen_by_rays(p.disc2[i], clamp));
        evaluate_lane<type, glossy, stretched>(lanes, i, l, out);
    }
    out.any_clamped = false;
}

template <LightType type>
RENDER2MPEG_ALWAYS_INLINED void add_lanes(const GatherLanes& __restrict lanes, const Representative& representative,
                                          GeometryClamp clamp, RgbLanes& __restrict out) {
    const float red = representative.intensity.x, green = representative.intensity.y, blue = representative.intensity.z;
    const LaneLight l = lane_light(*representative.light, representative.spot, clamp);
    LightLanes unit;
    for (int i = 0; i < lane_count; ++i) {
        evaluate_lane<type, false>(lanes, i, l, unit);
        const float g = unit.diffuse[i];
        out.r[i] += g * red;
        out.g[i] += g * green;
        out.b[i] += g * blue;
    }
}

/// Box of a node about the axes of `frame`, as seen from the lane whose difference to the middle is (x, y, z).
RENDER2MPEG_ALWAYS_INLINED float box_cosine(const FrameLanes& frame, int i, float x, float y, float z, float hx,
                                            float hy, float hz) {
    return lobe::cosine_bound(dot(frame.axis, i, x, y, z), dot_abs(frame.axis, i, hx, hy, hz),
                              dot(frame.tangent, i, x, y, z), dot_abs(frame.tangent, i, hx, hy, hz),
                              dot(frame.bitangent, i, x, y, z), dot_abs(frame.bitangent, i, hx, hy, hz));
}

/// A node's cone axis with two directions across it, and the box's half extents along the three.
struct NodeFrame {
    float ax, ay, az, tx, ty, tz, bx, by, bz;
    float along_axis, along_tangent, along_bitangent;
};

/// As core::make_frame, in the caller's instruction set.
RENDER2MPEG_ALWAYS_INLINED NodeFrame frame_of(const LightNode& node, float hx, float hy, float hz) {
    NodeFrame f;
    unpack_normal(node.axis, f.ax, f.ay, f.az);
    const float sign = f.az < 0.0f ? -1.0f : 1.0f, a = -1.0f / (sign + f.az), b = f.ax * f.ay * a;
    f.tx = 1.0f + sign * f.ax * f.ax * a, f.ty = sign * b, f.tz = -sign * f.ax;
    f.bx = b, f.by = sign + f.ay * f.ay * a, f.bz = -f.ay;
    f.along_axis = inlined::abs(f.ax) * hx + inlined::abs(f.ay) * hy + inlined::abs(f.az) * hz;
    f.along_tangent = inlined::abs(f.tx) * hx + inlined::abs(f.ty) * hy + inlined::abs(f.tz) * hz;
    f.along_bitangent = inlined::abs(f.bx) * hx + inlined::abs(f.by) * hy + inlined::abs(f.bz) * hz;
    return f;
}

/// How much of light in this colour an eye notices, in luminance: its luminance, or its Cr or Cb [BT709, 3.3] at
/// `chroma_share` of that. Without chroma the light of a blue lamp would count a fourteenth of a white one's, and may
/// be lost where it is all the colour there is. chosen: docs/decisions.md#stopping-rule.
constexpr float chroma_share = 0.5f;
RENDER2MPEG_ALWAYS_INLINED float noticed(const Vec3Lanes& weight, int i, float red, float green, float blue) {
    const float r = weight.x[i] * red, g = weight.y[i] * green, b = weight.z[i] * blue;
    const float luma = r + g + b;
    const float cr = (r * (1.0f / core::luminance_weights.x) - luma) * (chroma_share / 1.5748f);
    const float cb = (b * (1.0f / core::luminance_weights.z) - luma) * (chroma_share / 1.8556f);
    return inlined::max(luma, inlined::max(cr, cb));
}

/// A node as all lanes see it: its box, intensity, cone and what the clamp makes of its lights.
struct LaneNode {
    float cx, cy, cz, hx, hy, hz, red, green, blue;
    float cone, range2, rays, least_blur2, largest_blur2, clamp;
    NodeFrame frame;
};

RENDER2MPEG_ALWAYS_INLINED LaneNode lane_node(LightType type, const LightNode& node, const BoxGrid& grid,
                                              GeometryClamp clamp) {
    LaneNode n;
    node.box.unpack(grid, n.cx, n.cy, n.cz, n.hx, n.hy, n.hz);
    node.intensity.unpack(n.red, n.green, n.blue);
    n.red *= outward;
    n.green *= outward;
    n.blue *= outward;
    n.cone = node.cone.cosine();
    n.range2 = node.disc2.largest();
    // Nodes on surfaces may be far: trees have all then.
    const bool may_be_far = type != LightType::directional && clamp.by_rays == GeometryClamp::ByRays::by_size;
    n.rays = may_be_far ? 0.0f : inlined::min(inward * seen_by_rays(node.disc2.least(), clamp), 1.0f);
    const float scale = clamp.scale;
    n.least_blur2 = node.disc2.least() / scale;
    n.largest_blur2 = node.disc2.largest() / scale;
    n.clamp = largest_g(node.disc2.least(), scale);
    n.frame = frame_of(node, n.hx, n.hy, n.hz);
    return n;
}

/// Bound of a light's geometry times the diffuse part's shape.
RENDER2MPEG_ALWAYS_INLINED float shaped_geometry(const GatherLanes& lanes, int i, float cosine, float reach,
                                                 bool clamped, float clamp) {
    const float retro = lanes.retro[i], loss = lanes.loss[i], flat = lanes.flat[i], rough = lanes.rough[i];
    const float nv = lanes.cos_outgoing[i], g = reach * lobe::shaped_bound(retro, loss, flat, rough, cosine, nv);
    return clamped ? inlined::min(g, clamp * lobe::shaped_most(retro, loss, flat, rough, nv)) : g;
}

template <LightType type, bool glossy, bool stretched>
RENDER2MPEG_ALWAYS_INLINED float bound_lane(const GatherLanes& __restrict lanes, int i, const LaneNode& n) {
    float x = n.cx, y = n.cy, z = n.cz, inverse2 = 1.0f, emit = 1.0f, spread2_low = 0.0f, spread2_high = 0.0f;
    if constexpr (type != LightType::directional) {
        x -= lanes.position.x[i];
        y -= lanes.position.y[i];
        z -= lanes.position.z[i];
        const float nx = inlined::max(inlined::abs(x) - n.hx, 0.0f), ny = inlined::max(inlined::abs(y) - n.hy, 0.0f);
        const float nz = inlined::max(inlined::abs(z) - n.hz, 0.0f);
        const float near2 = nx * nx + ny * ny + nz * nz;
        inverse2 = 1.0f / inlined::max(near2, lobe::tiny);
        const NodeFrame& f = n.frame;
        const float theta =
            lobe::cosine_bound(-(f.ax * x + f.ay * y + f.az * z), f.along_axis, f.tx * x + f.ty * y + f.tz * z,
                               f.along_tangent, f.bx * x + f.by * y + f.bz * z, f.along_bitangent);
        emit = lobe::cone_bound(theta, n.cone);
        if constexpr (type == LightType::punctual)
            emit = near2 <= n.range2 && theta + (outward - 1.0f) >= n.cone ? 1.0f : 0.0f;
        if constexpr (glossy && type == LightType::oriented) {
            const float fx = inlined::abs(x) + n.hx, fy = inlined::abs(y) + n.hy, fz = inlined::abs(z) + n.hz;
            spread2_low = n.least_blur2 / inlined::max(fx * fx + fy * fy + fz * fz, lobe::tiny);
            spread2_high = n.largest_blur2 * inverse2;
        }
    } else {
        spread2_low = n.least_blur2;
        spread2_high = n.largest_blur2;
    }
    const FrameLanes& normal = lanes.normal;
    const float cosine =
        lobe::positive_cosine_bound(dot(normal.axis, i, x, y, z), dot_abs(normal.axis, i, n.hx, n.hy, n.hz),
                                    dot(normal.tangent, i, x, y, z), dot_abs(normal.tangent, i, n.hx, n.hy, n.hz),
                                    dot(normal.bitangent, i, x, y, z), dot_abs(normal.bitangent, i, n.hx, n.hy, n.hz));
    const float reach = emit * inverse2;
    float g = cosine * reach;
    if constexpr (type == LightType::oriented) g = inlined::min(g, n.clamp);
    if constexpr (stretched) g = shaped_geometry(lanes, i, cosine, reach, type == LightType::oriented, n.clamp);
    float bound = g * noticed(lanes.diffuse_weight, i, n.red, n.green, n.blue);
    if constexpr (glossy) {
        const lobe::BoxCosines box{cosine, box_cosine(lanes.mirrored, i, x, y, z, n.hx, n.hy, n.hz),
                                   box_cosine(lanes.outgoing, i, -x, -y, -z, n.hx, n.hy, n.hz)};
        const float least = stretched ? lanes.across2[i] : lanes.lobe_width[i];
        const float most = stretched ? lanes.along2[i] : lanes.lobe_width[i];
        const lobe::GlossyBound lobe_bound =
            lobe::glossy_bound(box, lanes.cos_outgoing[i], inlined::min(least + widening * spread2_low, 1.0f),
                               inlined::min(most + widening * spread2_high, 1.0f));
        float lit = lobe_bound.cosine * reach;
        if constexpr (type == LightType::oriented) lit = inlined::min(lit, lobe_bound.value * n.clamp);
        // A stretched lobe is nowhere more than the round one of its larger width, times by how much it is narrower.
        if constexpr (stretched) lit *= inlined::sqrt(most / least);
        lit = cosine > 0.0f ? lit : 0.0f;
        if constexpr (type != LightType::punctual) lit *= lobe::by_trees(n.rays, lanes.rays_see[i]);
        // The lobe's colour lies between f0 and f90; what is noticed of a mixture is no more than the mixture.
        const float f0 = noticed(lanes.f0_weight, i, n.red, n.green, n.blue);
        const float grazing = noticed(lanes.schlick_weight, i, n.red, n.green, n.blue);
        bound += lit * (f0 + lobe_bound.schlick * inlined::max(grazing - f0, 0.0f));
    }
    return bound;
}

template <LightType type, bool glossy, bool stretched = false>
RENDER2MPEG_ALWAYS_INLINED void bound_lanes(const GatherLanes& __restrict lanes, const BoxGrid& grid,
                                            const LightNode& node, GeometryClamp clamp, float* __restrict out) {
    const LaneNode n = lane_node(type, node, grid, clamp);
    for (int i = 0; i < lane_count; ++i) out[i] = bound_lane<type, glossy, stretched>(lanes, i, n);
}

}  // namespace

RENDER2MPEG_CLONES
void evaluate_light(const GatherLanes& lanes, LightType type, const TreeLight& light, const Spot* spot,
                    GeometryClamp clamp, LightLanes& out) {
    if (type == LightType::oriented) {
        lanes.stretched ? evaluate_lanes<LightType::oriented, true, true>(lanes, light, spot, clamp, out)
        : lanes.glossy  ? evaluate_lanes<LightType::oriented, true>(lanes, light, spot, clamp, out)
                        : evaluate_lanes<LightType::oriented, false>(lanes, light, spot, clamp, out);
    } else if (type == LightType::punctual) {
        lanes.stretched ? evaluate_lanes<LightType::punctual, true, true>(lanes, light, spot, clamp, out)
        : lanes.glossy  ? evaluate_lanes<LightType::punctual, true>(lanes, light, spot, clamp, out)
                        : evaluate_lanes<LightType::punctual, false>(lanes, light, spot, clamp, out);
    } else {
        lanes.stretched ? evaluate_lanes<LightType::directional, true, true>(lanes, light, spot, clamp, out)
        : lanes.glossy  ? evaluate_lanes<LightType::directional, true>(lanes, light, spot, clamp, out)
                        : evaluate_lanes<LightType::directional, false>(lanes, light, spot, clamp, out);
    }
}

RENDER2MPEG_CLONES
void evaluate_lights(const GatherLanes& lanes, LightType type, const LightPacket& lights, GeometryClamp clamp,
                     LightLanes& out) {
    if (type == LightType::oriented) {
        lanes.stretched ? evaluate_each<LightType::oriented, true, true>(lanes, lights, clamp, out)
        : lanes.glossy  ? evaluate_each<LightType::oriented, true>(lanes, lights, clamp, out)
                        : evaluate_each<LightType::oriented, false>(lanes, lights, clamp, out);
    } else if (type == LightType::punctual) {
        lanes.stretched ? evaluate_each<LightType::punctual, true, true>(lanes, lights, clamp, out)
        : lanes.glossy  ? evaluate_each<LightType::punctual, true>(lanes, lights, clamp, out)
                        : evaluate_each<LightType::punctual, false>(lanes, lights, clamp, out);
    } else {
        lanes.stretched ? evaluate_each<LightType::directional, true, true>(lanes, lights, clamp, out)
        : lanes.glossy  ? evaluate_each<LightType::directional, true>(lanes, lights, clamp, out)
                        : evaluate_each<LightType::directional, false>(lanes, lights, clamp, out);
    }
}

RENDER2MPEG_CLONES
void add_irradiance(const GatherLanes& lanes, LightType type, const Representative* lights, int count,
                    GeometryClamp clamp, RgbLanes& out) {
    for (int k = 0; k < count; ++k) {
        const Representative& light = lights[k];
        if (type == LightType::oriented)
            add_lanes<LightType::oriented>(lanes, light, clamp, out);
        else if (type == LightType::punctual)
            add_lanes<LightType::punctual>(lanes, light, clamp, out);
        else
            add_lanes<LightType::directional>(lanes, light, clamp, out);
    }
}

void fill_lights(LightPacket& packet, const LightTree& tree, std::size_t first, std::size_t count) {
    EXPECTS(count > 0 && count <= lane_count && first + count <= tree.lights.size());
    for (std::size_t i = 0; i < lane_count; ++i) {
        const std::size_t place = first + std::min(i, count - 1);
        const TreeLight& light = tree.lights[place];
        const Spot spot = tree.spots.empty() ? Spot{} : tree.spots[place];
        put(packet.position, static_cast<int>(i), light.position);
        put(packet.normal, static_cast<int>(i), light.normal());
        put(packet.intensity, static_cast<int>(i), i < count ? light.intensity : glm::vec3(0));
        packet.disc2[i] = light.disc2;
        packet.spot_scale[i] = spot.scale;
        packet.spot_offset[i] = spot.offset;
        packet.spot_smooth[i] = spot.smooth;
    }
}

RENDER2MPEG_CLONES
void bound_node(const GatherLanes& lanes, const LightTree& tree, std::uint32_t index, GeometryClamp clamp, Lanes& out) {
    const LightType type = tree.type;
    const BoxGrid& grid = tree.grid;
    const LightNode& node = tree.nodes.data()[index];
    if (type == LightType::oriented) {
        lanes.stretched ? bound_lanes<LightType::oriented, true, true>(lanes, grid, node, clamp, out)
        : lanes.glossy  ? bound_lanes<LightType::oriented, true>(lanes, grid, node, clamp, out)
                        : bound_lanes<LightType::oriented, false>(lanes, grid, node, clamp, out);
    } else if (type == LightType::punctual) {
        lanes.stretched ? bound_lanes<LightType::punctual, true, true>(lanes, grid, node, clamp, out)
        : lanes.glossy  ? bound_lanes<LightType::punctual, true>(lanes, grid, node, clamp, out)
                        : bound_lanes<LightType::punctual, false>(lanes, grid, node, clamp, out);
    } else {
        lanes.stretched ? bound_lanes<LightType::directional, true, true>(lanes, grid, node, clamp, out)
        : lanes.glossy  ? bound_lanes<LightType::directional, true>(lanes, grid, node, clamp, out)
                        : bound_lanes<LightType::directional, false>(lanes, grid, node, clamp, out);
    }
}

}  // namespace render2mpeg::renderer
