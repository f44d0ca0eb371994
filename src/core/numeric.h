#pragma once
// Divisions, roots and inverses that can meet the edge of their domain.
#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>

namespace render2mpeg::core {

/// a / b, or `otherwise` where b is 0 or the quotient is not finite.
inline float divide_or(float a, float b, float otherwise) {
    if (b == 0.0f) return otherwise;
    const float q = a / b;
    return std::isfinite(q) ? q : otherwise;
}
inline double divide_or(double a, double b, double otherwise) {
    if (b == 0.0) return otherwise;
    const double q = a / b;
    return std::isfinite(q) ? q : otherwise;
}

/// Square root that takes the rounding noise below 0 as 0.
inline float sqrt_or_zero(float x) {
    return x > 0.0f ? std::sqrt(x) : 0.0f;
}
inline double sqrt_or_zero(double x) {
    return x > 0.0 ? std::sqrt(x) : 0.0;
}

/// Arc cosine of a cosine that may lie outside [-1, 1] by rounding.
inline float acos_clamped(float x) {
    return std::acos(std::clamp(x, -1.0f, 1.0f));
}

inline bool is_finite(glm::vec2 v) {
    return std::isfinite(v.x) && std::isfinite(v.y);
}
inline bool is_finite(glm::vec3 v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}
inline bool is_finite(const glm::mat4& m) {
    for (int c = 0; c < 4; ++c)
        for (int r = 0; r < 4; ++r)
            if (!std::isfinite(m[c][r])) return false;
    return true;
}

/// v / |v|, or `otherwise` where v has no direction. Scaled first, so that 1e-30 and 1e30 neither under- nor overflow.
inline glm::vec3 normalize_or(glm::vec3 v, glm::vec3 otherwise) {
    const float m = std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
    if (!is_finite(v) || m == 0.0f) return otherwise;
    const glm::vec3 s = v / m;
    return s / std::sqrt(glm::dot(s, s));
}

}  // namespace render2mpeg::core
