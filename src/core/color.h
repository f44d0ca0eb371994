#pragma once
// Luminance, and the sRGB curve.
#include <algorithm>
#include <cmath>
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
inline float srgb_to_linear(float v) {
    return v <= 0.04045f ? v / 12.92f : std::pow((v + 0.055f) / 1.055f, 2.4f);
}
/// Linear light in [0, 1] to sRGB code value. [sRGB, 5.2]
inline float linear_to_srgb(float v) {
    return v <= 0.0031308f ? v * 12.92f : 1.055f * std::pow(v, 1.0f / 2.4f) - 0.055f;
}

}  // namespace render2mpeg::core
