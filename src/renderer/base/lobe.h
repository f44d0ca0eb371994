#pragma once
// The glossy lobe (GGX) and its bounds, for sixteen points at once.
#include <numbers>

#include "renderer/base/isa_clones.h"

/// Scalar pieces of f_s and of its bounds, without branches, so that a loop over sixteen points of a tile vectorises.
/// All in single precision; every quotient is guarded.
namespace render2mpeg::renderer::lobe {

inline constexpr float inverse_pi = std::numbers::inv_pi_v<float>;

/// Below it a squared length or a denominator counts as 0.
inline constexpr float tiny = 1e-30f;

/// Least LightPoint::disc2 of a part of the sky or of a shining surface for lobe rays alone to see it; a point of light
/// is seen by trees alone, and values in between are divided (`by_trees`). chosen: 2.5e-4, a part of 1.8 degrees
/// across; a sky of one colour has narrower ones from 16,384 points on, suns always.
inline constexpr float lobe_rays_disc2 = 2.5e-4f;

/// Share of such a light that light trees send along a lobe that has rays; they see the rest. `rays_see`: 1 /
/// `lobe_rays_disc2`, or 0 where there are no rays.
RENDER2MPEG_ALWAYS_INLINED float by_trees(float disc2, float rays_see) {
    return inlined::max(1.0f - disc2 * rays_see, 0.0f);
}

/// GGX distribution of half vectors; `nh2` is the squared cosine to the normal, `a2` the lobe's alpha squared.
/// [Walter2007, eq. 33] in the form that keeps its digits at the peak, where 1 - nh2 (1 - a2) is a2.
RENDER2MPEG_ALWAYS_INLINED float distribution(float nh2, float a2) {
    const float t = inlined::max(1.0f - nh2 * (1.0f - a2), a2);
    return a2 * inverse_pi / (t * t);
}

/// Height-correlated masking over 4 nl nv [Heitz2014, eq. 99]; cosines > 0.
RENDER2MPEG_ALWAYS_INLINED float masking(float nl, float nv, float a2) {
    const float light = inlined::sqrt(a2 + (1.0f - a2) * nl * nl);
    const float view = inlined::sqrt(a2 + (1.0f - a2) * nv * nv);
    return 0.5f / inlined::max(nv * light + nl * view, 1e-12f);
}

/// D V of a stretched lobe [Burley2012, eq. 13; Heitz2014, eq. 99], by its squared widths and the cosines to its axes:
/// of light and eye, and `half2`, the squared length of their sum.
struct StretchedCosines {
    float along, across, normal;
};
RENDER2MPEG_ALWAYS_INLINED float stretched_value(StretchedCosines light, StretchedCosines eye, float half2,
                                                 float along2, float across2) {
    const float x = light.along + eye.along, y = light.across + eye.across, z = light.normal + eye.normal;
    const float e = inlined::max((x * x / along2 + y * y / across2 + z * z) / half2, 1e-12f);
    const float d = inverse_pi / (inlined::sqrt(along2 * across2) * e * e);
    const auto length = [&](StretchedCosines v) {
        return inlined::sqrt(along2 * v.along * v.along + across2 * v.across * v.across + v.normal * v.normal);
    };
    const float nl = inlined::max(light.normal, 0.0f);
    return d * 0.5f / inlined::max(eye.normal * length(light) + nl * length(eye), 1e-12f);
}

/// Schlick's fifth power: the Fresnel reflectance is f0 (1 - s) + s. [Schlick1994, eq. 15]
RENDER2MPEG_ALWAYS_INLINED float schlick(float vh) {
    const float m = inlined::min(inlined::max(1.0f - vh, 0.0f), 1.0f);
    const float m2 = m * m;
    return m2 * m2 * m;
}

/// DiffuseShape's value at cosines of light, eye, and between them; 1 for (0, 0, 1, 0).
RENDER2MPEG_ALWAYS_INLINED float shaped(float retro, float loss, float flat, float rough, float nl, float nv,
                                        float lv) {
    const float a = retro * (1.0f + lv) - loss;
    const float t = lv - nl * nv, larger = inlined::max(inlined::max(nl, nv), tiny);
    return flat * (1.0f + a * schlick(nl)) * (1.0f + a * schlick(nv)) + rough * (t > 0.0f ? t / larger : t);
}

/// Upper bound of that value times n.l, where n.l is at most `nl`: with `a` at its largest it rises with n.l, and t n.l
/// is below sin(v) min(n.l / n.v, 1).
RENDER2MPEG_ALWAYS_INLINED float shaped_bound(float retro, float loss, float flat, float rough, float nl, float nv) {
    const float a = 2.0f * retro - loss, across = inlined::sqrt(inlined::max(1.0f - nv * nv, 0.0f));
    return flat * nl * (1.0f + a * schlick(nl)) * (1.0f + a * schlick(nv)) +
           rough * across * inlined::min(nl / inlined::max(nv, tiny), 1.0f);
}

/// Upper bound of the value itself.
RENDER2MPEG_ALWAYS_INLINED float shaped_most(float retro, float loss, float flat, float rough, float nv) {
    const float a = inlined::max(2.0f * retro - loss, 0.0f);
    const float across = inlined::sqrt(inlined::max(1.0f - nv * nv, 0.0f));
    return flat * (1.0f + a) * (1.0f + a * schlick(nv)) + rough * across / inlined::max(nv, tiny);
}

/// Upper bound of the cosine between an axis and the vectors of a box [Walter2005, 5.1]. The box is given along the
/// axis and along two directions across it, each as middle and half extent; 1 where it may hold the axis itself.
RENDER2MPEG_ALWAYS_INLINED float cosine_bound(float axis_middle, float axis_half, float x_middle, float x_half,
                                              float y_middle, float y_half) {
    const float top = axis_middle + axis_half;
    const float x_far = inlined::abs(x_middle) + x_half, x_near = inlined::max(inlined::abs(x_middle) - x_half, 0.0f);
    const float y_far = inlined::abs(y_middle) + y_half, y_near = inlined::max(inlined::abs(y_middle) - y_half, 0.0f);
    // Across the axis the nearest corner makes the largest positive cosine, the farthest the largest negative one.
    const float x = top >= 0.0f ? x_near : x_far;
    const float y = top >= 0.0f ? y_near : y_far;
    return top / inlined::sqrt(inlined::max(x * x + y * y + top * top, tiny));
}

/// The same where it is positive, else 0: what a receiver wants to know, which no far corner tells.
RENDER2MPEG_ALWAYS_INLINED float positive_cosine_bound(float axis_middle, float axis_half, float x_middle, float x_half,
                                                       float y_middle, float y_half) {
    const float top = inlined::max(axis_middle + axis_half, 0.0f);
    const float x = inlined::max(inlined::abs(x_middle) - x_half, 0.0f);
    const float y = inlined::max(inlined::abs(y_middle) - y_half, 0.0f);
    return top / inlined::sqrt(inlined::max(x * x + y * y + top * top, tiny));
}

/// Upper bound of an emitter's cosine whose normal lies within a cone: cos(max(0, theta - beta)), not below 0.
RENDER2MPEG_ALWAYS_INLINED float cone_bound(float cos_theta, float cos_beta) {
    const float c = inlined::min(inlined::max(cos_theta, -1.0f), 1.0f);
    const float sines = inlined::max(1.0f - c * c, 0.0f) * inlined::max(1.0f - cos_beta * cos_beta, 0.0f);
    const float turned = c * cos_beta + inlined::sqrt(sines);
    return c >= cos_beta ? 1.0f : inlined::max(turned, 0.0f);
}

/// Cosines from which bounds of the GGX lobe over a box of directions are computed; see `glossy_bound`.
struct BoxCosines {
    float normal;    ///< upper bound of the cosine to the normal, >= 0
    float mirrored;  ///< to the mirrored outgoing direction
    float away;      ///< to the negative outgoing direction
};

/// Upper bounds, over all light directions of a box, of D V (without cosine) and of D V cos, and of Schlick's power.
/// The lobe's squared width may lie anywhere in [a2_low, a2_high], since light points widen it
/// (docs/model/lightcut.md).
struct GlossyBound {
    float value;    ///< of D V
    float cosine;   ///< of D V cos
    float schlick;  ///< of the fifth power
};
RENDER2MPEG_ALWAYS_INLINED GlossyBound glossy_bound(BoxCosines box, float nv, float a2_low, float a2_high) {
    // Bound n.h twice: a half vector off the normal by e turns the mirrored direction by at most 2e, hence n.h <=
    // cos(d/2); and n.h = (n.l + n.v) / |l + v| with both ends at their bounds.
    const float lv = inlined::max(-box.away, -1.0f);
    const float by_mirror = 0.5f * (1.0f + inlined::min(inlined::max(box.mirrored, -1.0f), 1.0f));
    const float sum = box.normal + nv;
    const float by_sum = sum * sum / inlined::max(2.0f + 2.0f * lv, 1e-7f);
    const float nh2 = inlined::min(inlined::min(by_mirror, by_sum), 1.0f);
    // D rises with n.h, and over the width it peaks at a2 = (1 - nh2) / nh2.
    const float peak = (1.0f - nh2) / inlined::max(nh2, 1e-7f);
    const float d = distribution(nh2, inlined::min(inlined::max(peak, a2_low), a2_high));
    // V cos rises with the cosine, V falls; both fall with the width.
    const float nl = inlined::min(inlined::max(box.normal, 0.0f), 1.0f);
    const float view = inlined::sqrt(a2_low + (1.0f - a2_low) * nv * nv);
    const float flat = 0.5f / inlined::max(nv * inlined::sqrt(a2_low), 1e-12f);
    const float steep = 0.5f / inlined::max(nv * inlined::sqrt(a2_low + (1.0f - a2_low) * nl * nl) + nl * view, 1e-12f);
    const float vh = inlined::sqrt(inlined::max(0.5f * (1.0f + lv), 0.0f));
    return {d * flat, d * steep * nl, schlick(vh)};
}

}  // namespace render2mpeg::renderer::lobe
