#include "scene/model/track.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/numeric.h"

namespace render2mpeg::scene {
namespace {

/// A rotation's four numbers as a unit quaternion; the identity where they have no direction.
glm::dquat unit_rotation(const double* xyzw) {
    const double length = std::sqrt(xyzw[0] * xyzw[0] + xyzw[1] * xyzw[1] + xyzw[2] * xyzw[2] + xyzw[3] * xyzw[3]);
    if (!(length > 0) || !std::isfinite(length)) return {1, 0, 0, 0};
    return {xyzw[3] / length, xyzw[0] / length, xyzw[1] / length, xyzw[2] / length};
}

/// Spherical interpolation along the shorter arc. [glTF2, C.4]
glm::dquat slerp_shortest(glm::dquat a, glm::dquat b, double t) {
    double cosine = glm::dot(a, b);
    if (cosine < 0) {
        b = -b;
        cosine = -cosine;
    }
    // Nearly equal rotations have no well-defined arc; the chord serves.
    // chosen: 1 - 1e-9, where the angle is 4.5e-5 and the chord is wrong by angle^3 / 16 < 1e-14.
    if (cosine > 1 - 1e-9) return glm::normalize(a * (1 - t) + b * t);
    const double angle = std::acos(std::min(cosine, 1.0));
    return glm::normalize((a * std::sin((1 - t) * angle) + b * std::sin(t * angle)) / std::sin(angle));
}

/// Weights of in-value, out-tangent, out-value and in-tangent at t in [0, 1]. [glTF2, C.5]
struct HermiteWeights {
    double p0, m0, p1, m1;
    explicit HermiteWeights(double t) {
        const double t2 = t * t, t3 = t2 * t;
        p0 = 2 * t3 - 3 * t2 + 1;
        m0 = t3 - 2 * t2 + t;
        p1 = -2 * t3 + 3 * t2;
        m1 = t3 - t2;
    }
};

/// Widest track that is sampled without a buffer of its own.
constexpr int small_width = 16;

}  // namespace

void Track::sample(double seconds, std::span<float> out) const {
    const std::size_t n = static_cast<std::size_t>(width);
    const std::size_t per_key = interpolation == Interpolation::cubic_spline ? 3 * n : n;
    EXPECTS(!times.empty() && values.size() == times.size() * per_key && out.size() >= n);
    const std::size_t value_offset = interpolation == Interpolation::cubic_spline ? n : 0;
    const auto value_of = [&](std::size_t key) { return values.data() + key * per_key + value_offset; };

    // Find the keys on both sides: the last one not after `seconds`, and the next.
    const auto after = std::upper_bound(times.begin(), times.end(), seconds,
                                        [](double s, float t) { return s < static_cast<double>(t); });
    const std::size_t right = static_cast<std::size_t>(after - times.begin());
    const bool before_first = right == 0;
    const bool past_last = right == times.size();
    const std::size_t a = before_first ? 0 : right - 1;
    const std::size_t b = past_last ? a : right;

    // Interpolate each value in double precision.
    double small[small_width];
    std::vector<double> large(n > small_width ? n : 0);
    double* value = n > small_width ? large.data() : small;
    const bool holds = before_first || past_last || interpolation == Interpolation::step;
    const double t0 = static_cast<double>(times[a]), dt = static_cast<double>(times[b]) - t0;
    const double t = holds ? 0.0 : core::divide_or(seconds - t0, dt, 0.0);
    if (holds) {
        std::copy_n(value_of(a), n, value);
    } else if (interpolation == Interpolation::cubic_spline) {
        const HermiteWeights w(t);
        const float* out_tangent = value_of(a) + n;
        const float* in_tangent = value_of(b) - n;
        for (std::size_t i = 0; i < n; ++i)
            value[i] =
                w.p0 * value_of(a)[i] + w.m0 * dt * out_tangent[i] + w.p1 * value_of(b)[i] + w.m1 * dt * in_tangent[i];
    } else {
        for (std::size_t i = 0; i < n; ++i) value[i] = (1 - t) * value_of(a)[i] + t * value_of(b)[i];
    }

    // Keep rotations on the unit sphere.
    if (target == TrackTarget::rotation) {
        glm::dquat q = unit_rotation(value);
        if (!holds && interpolation == Interpolation::linear) {
            double from[4], to[4];
            std::copy_n(value_of(a), 4, from);
            std::copy_n(value_of(b), 4, to);
            q = slerp_shortest(unit_rotation(from), unit_rotation(to), t);
        }
        value[0] = q.x, value[1] = q.y, value[2] = q.z, value[3] = q.w;
    }
    std::copy_n(value, n, out.begin());
}

}  // namespace render2mpeg::scene
