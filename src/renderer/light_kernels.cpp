// Bounds after [Walter2005, 5.1]: the receiver's cosine over the cluster's box, the emitter's cosine over box and
// normal cone, and the box's least distance, each at its extreme. Changed: a GGX lobe instead of Phong's; colours are
// bounded channel by channel; the clamp of near lights bounds what the box's distance cannot.
#include "renderer/light_kernels.h"

#include <algorithm>
#include <cmath>

#include "core/color.h"
#include "core/sampling.h"
#include "renderer/isa_clones.h"
#include "renderer/lobe.h"

namespace render2mpeg::renderer {
namespace {

/// Half vectors turn half as far as directions, and a disc of radius r at distance d has a variance of (r / d)^2 / 4
/// along each axis; a GGX lobe's slopes have about alpha^2 / 2. Adding variances widens alpha^2 by (r / d)^2 / 8.
constexpr float widening = 0.125f;

/// Covers the rounding of bounds. chosen: 1e-4, some thousand roundings' worth; costs nothing measurable.
constexpr float outward = 1.0001f;

RENDER2MPEG_ALWAYS_INLINED float dot(const Vec3Lanes& a, int i, float x, float y, float z) {
    return a.x[i] * x + a.y[i] * y + a.z[i] * z;
}
RENDER2MPEG_ALWAYS_INLINED float dot_abs(const Vec3Lanes& a, int i, float x, float y, float z) {
    return inlined::abs(a.x[i]) * x + inlined::abs(a.y[i]) * y + inlined::abs(a.z[i]) * z;
}

/// The GGX lobe's radiance per unit of `irradiance` from direction (x, y, z), unit.
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
    out.f0[i] = dv * (1.0f - s);
    out.schlick[i] = dv * s;
}

template <LightFamily family, bool glossy>
RENDER2MPEG_ALWAYS_INLINED void evaluate_lanes(const GatherLanes& __restrict lanes, const TreeLight& light, float scale,
                                               LightLanes& __restrict out) {
    const float lx = light.position.x, ly = light.position.y, lz = light.position.z;
    const float mx = light.normal.x, my = light.normal.y, mz = light.normal.z;
    const float range2 = light.disc2, spot_scale = light.spot_scale, spot_offset = light.spot_offset;
    const float blur2 = light.disc2 / scale, clamp = 1.0f / inlined::max(blur2, lobe::tiny);
    Lanes unclamped;
    for (int i = 0; i < lane_count; ++i) {
        float x = lx, y = ly, z = lz, inverse2 = 1.0f, emit = 1.0f;
        if constexpr (family != LightFamily::directional) {
            x -= lanes.position.x[i];
            y -= lanes.position.y[i];
            z -= lanes.position.z[i];
            const float distance2 = x * x + y * y + z * z;
            inverse2 = 1.0f / inlined::max(distance2, lobe::tiny);
            const float inverse = inlined::sqrt(inverse2);
            x *= inverse;
            y *= inverse;
            z *= inverse;
            const float cosine = -(mx * x + my * y + mz * z);
            if constexpr (family == LightFamily::oriented) {
                emit = inlined::max(cosine, 0.0f);
            } else {
                // Window of the range [KHR_lights_punctual] and the spot's falloff.
                const float reach2 = distance2 / range2;
                const float window = inlined::min(inlined::max(1.0f - reach2 * reach2, 0.0f), 1.0f);
                const float spot = inlined::min(inlined::max(cosine * spot_scale + spot_offset, 0.0f), 1.0f);
                emit = window * spot * spot;
            }
        }
        const float front = dot(lanes.geometric, i, x, y, z);
        const float facing = inlined::max(dot(lanes.normal.axis, i, x, y, z), 0.0f);
        const float cosine = front > 0.0f ? facing : 0.0f;
        float g = cosine * emit * inverse2;
        if constexpr (family == LightFamily::oriented) {
            unclamped[i] = g;
            g = inlined::min(g, clamp);
        }
        out.diffuse[i] = g;
        if constexpr (glossy)
            glossy_value(lanes, i, x, y, z, family == LightFamily::punctual ? 0.0f : blur2 * inverse2, g, out);
    }
    int clamped = 0;
    if constexpr (family == LightFamily::oriented)
        for (int i = 0; i < lane_count; ++i) clamped |= unclamped[i] > clamp ? 1 : 0;
    out.any_clamped = clamped != 0;
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
    glm::vec3 axis, tangent, bitangent, half;
    explicit NodeFrame(const LightNode& node) : axis(node.axis.unpack()) {
        core::make_frame(axis, tangent, bitangent);
        half = {glm::dot(glm::abs(axis), node.half), glm::dot(glm::abs(tangent), node.half),
                glm::dot(glm::abs(bitangent), node.half)};
    }
};

/// How much of light in this colour an eye notices, in luminance: its luminance, or its Cr or Cb [BT709, 3.3] at
/// `chroma_share` of that. Without chroma the light of a blue lamp would count a fourteenth of a white one's, and may
/// be lost where it is all the colour there is. chosen: docs/decisions/0014.
constexpr float chroma_share = 0.5f;
RENDER2MPEG_ALWAYS_INLINED float noticed(const Vec3Lanes& weight, int i, float red, float green, float blue) {
    const float r = weight.x[i] * red, g = weight.y[i] * green, b = weight.z[i] * blue;
    const float luma = r + g + b;
    const float cr = (r * (1.0f / core::luminance_weights.x) - luma) * (chroma_share / 1.5748f);
    const float cb = (b * (1.0f / core::luminance_weights.z) - luma) * (chroma_share / 1.8556f);
    return inlined::max(luma, inlined::max(cr, cb));
}

template <LightFamily family, bool glossy>
RENDER2MPEG_ALWAYS_INLINED void bound_lanes(const GatherLanes& __restrict lanes, const LightNode& node,
                                            const NodeFrame& frame, float scale, float* __restrict out) {
    const float cx = node.middle.x, cy = node.middle.y, cz = node.middle.z;
    const float hx = node.half.x, hy = node.half.y, hz = node.half.z;
    const float red = node.intensity.x * outward, green = node.intensity.y * outward, blue = node.intensity.z * outward;
    const float cone = node.cone_cosine, range2 = node.largest_disc2;
    const float least_blur2 = node.least_disc2 / scale, largest_blur2 = node.largest_disc2 / scale;
    const float clamp = 1.0f / inlined::max(least_blur2, lobe::tiny);
    const glm::vec3 &a = frame.axis, &t = frame.tangent, &b = frame.bitangent, &across = frame.half;
    for (int i = 0; i < lane_count; ++i) {
        float x = cx, y = cy, z = cz, inverse2 = 1.0f, emit = 1.0f, spread2_low = 0.0f, spread2_high = 0.0f;
        if constexpr (family != LightFamily::directional) {
            x -= lanes.position.x[i];
            y -= lanes.position.y[i];
            z -= lanes.position.z[i];
            const float nx = inlined::max(inlined::abs(x) - hx, 0.0f), ny = inlined::max(inlined::abs(y) - hy, 0.0f);
            const float nz = inlined::max(inlined::abs(z) - hz, 0.0f);
            const float near2 = nx * nx + ny * ny + nz * nz;
            inverse2 = 1.0f / inlined::max(near2, lobe::tiny);
            const float theta =
                lobe::cosine_bound(-(a.x * x + a.y * y + a.z * z), across.x, t.x * x + t.y * y + t.z * z, across.y,
                                   b.x * x + b.y * y + b.z * z, across.z);
            emit = lobe::cone_bound(theta, cone);
            if constexpr (family == LightFamily::punctual)
                emit = near2 <= range2 && theta * outward >= cone ? 1.0f : 0.0f;
            if constexpr (glossy && family == LightFamily::oriented) {
                const float fx = inlined::abs(x) + hx, fy = inlined::abs(y) + hy, fz = inlined::abs(z) + hz;
                spread2_low = least_blur2 / inlined::max(fx * fx + fy * fy + fz * fz, lobe::tiny);
                spread2_high = largest_blur2 * inverse2;
            }
        } else {
            spread2_low = least_blur2;
            spread2_high = largest_blur2;
        }
        const float cosine = inlined::max(box_cosine(lanes.normal, i, x, y, z, hx, hy, hz), 0.0f);
        const float reach = emit * inverse2;
        float g = cosine * reach;
        if constexpr (family == LightFamily::oriented) g = inlined::min(g, clamp);
        float bound = g * noticed(lanes.diffuse_weight, i, red, green, blue);
        if constexpr (glossy) {
            const lobe::BoxCosines box{cosine, box_cosine(lanes.mirrored, i, x, y, z, hx, hy, hz),
                                       -1.0f * box_cosine(lanes.outgoing, i, -x, -y, -z, hx, hy, hz)};
            const float a2 = lanes.lobe_width[i];
            const lobe::GlossyBound lobe_bound = lobe::glossy_bound(
                {box.normal, box.mirrored, -box.away}, lanes.cos_outgoing[i],
                inlined::min(a2 + widening * spread2_low, 1.0f), inlined::min(a2 + widening * spread2_high, 1.0f));
            float lit = lobe_bound.cosine * reach;
            if constexpr (family == LightFamily::oriented) lit = inlined::min(lit, lobe_bound.value * clamp);
            lit = cosine > 0.0f ? lit : 0.0f;
            // The lobe's colour lies between f0 and white; what is noticed of a mixture is no more than the mixture.
            const float f0 = noticed(lanes.f0_weight, i, red, green, blue);
            const float grazing = noticed(lanes.schlick_weight, i, red, green, blue);
            bound += lit * (f0 + lobe_bound.schlick * inlined::max(grazing - f0, 0.0f));
        }
        out[i] = bound;
    }
}

RENDER2MPEG_CLONES
void bound_framed(const GatherLanes& lanes, LightFamily family, const LightNode& node, const NodeFrame& frame,
                  float scale, Lanes& out) {
    if (family == LightFamily::oriented) {
        lanes.glossy ? bound_lanes<LightFamily::oriented, true>(lanes, node, frame, scale, out)
                     : bound_lanes<LightFamily::oriented, false>(lanes, node, frame, scale, out);
    } else if (family == LightFamily::punctual) {
        lanes.glossy ? bound_lanes<LightFamily::punctual, true>(lanes, node, frame, scale, out)
                     : bound_lanes<LightFamily::punctual, false>(lanes, node, frame, scale, out);
    } else {
        lanes.glossy ? bound_lanes<LightFamily::directional, true>(lanes, node, frame, scale, out)
                     : bound_lanes<LightFamily::directional, false>(lanes, node, frame, scale, out);
    }
}

}  // namespace

RENDER2MPEG_CLONES
void evaluate_light(const GatherLanes& lanes, LightFamily family, const TreeLight& light, GeometryClamp clamp,
                    LightLanes& out) {
    if (family == LightFamily::oriented) {
        lanes.glossy ? evaluate_lanes<LightFamily::oriented, true>(lanes, light, clamp.scale, out)
                     : evaluate_lanes<LightFamily::oriented, false>(lanes, light, clamp.scale, out);
    } else if (family == LightFamily::punctual) {
        lanes.glossy ? evaluate_lanes<LightFamily::punctual, true>(lanes, light, clamp.scale, out)
                     : evaluate_lanes<LightFamily::punctual, false>(lanes, light, clamp.scale, out);
    } else {
        lanes.glossy ? evaluate_lanes<LightFamily::directional, true>(lanes, light, clamp.scale, out)
                     : evaluate_lanes<LightFamily::directional, false>(lanes, light, clamp.scale, out);
    }
}

void bound_node(const GatherLanes& lanes, LightFamily family, const LightNode& node, GeometryClamp clamp, Lanes& out) {
    bound_framed(lanes, family, node, NodeFrame(node), clamp.scale, out);
}

}  // namespace render2mpeg::renderer
