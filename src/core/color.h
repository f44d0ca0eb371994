#pragma once
// Luminance, and the sRGB curve.
#include <algorithm>
#include <cmath>
#include <concepts>
#include <glm/glm.hpp>

namespace render2mpeg::core {

/// Luminance weights of linear RGB with BT.709 primaries. [BT709, 3.2]
inline constexpr glm::vec3 luminance_weights{0.2126f, 0.7152f, 0.0722f};

/// Relative luminance of scene-linear BT.709 RGB.
inline float luminance(glm::vec3 rgb) {
    return luminance_weights.x * rgb.x + luminance_weights.y * rgb.y + luminance_weights.z * rgb.z;
}

/// The larger of Cr and Cb of linear light, without sign [BT709, 3.3].
inline float chroma(glm::vec3 rgb) {
    const float y = luminance(rgb);
    return std::max(std::abs(rgb.x - y) / 1.5748f, std::abs(rgb.z - y) / 1.8556f);
}

/// Perceived magnitude of a difference of light, in luminance: the eye tolerates twice as much of chroma
/// (docs/decisions.md#stopping-rule).
inline float noticed(glm::vec3 difference) {
    return std::max(std::abs(luminance(difference)), 0.5f * chroma(difference));
}

/// sRGB code value in [0, 1] to linear light. [sRGB, 5.2]
template <std::floating_point T>
T srgb_to_linear(T v) {
    return v <= T(0.04045) ? v / T(12.92) : std::pow((v + T(0.055)) / T(1.055), T(2.4));
}
/// Linear light in [0, 1] to sRGB code value, of pictures and of films. [sRGB, 5.2]
template <std::floating_point T>
T linear_to_srgb(T v) {
    return v <= T(0.0031308) ? v * T(12.92) : T(1.055) * std::pow(v, T(1) / T(2.4)) - T(0.055);
}
/// Slope of linear_to_srgb at 0, nowhere steeper.
inline constexpr float srgb_slope_at_black = 12.92f;

}  // namespace render2mpeg::core
