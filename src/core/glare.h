#pragma once
// Glare of bright light in the eye, as requested by a film.
#include <array>
#include <cstdint>
#include <string_view>

namespace render2mpeg::core {

enum class GlareKind : std::uint8_t {
    off,
    still,    ///< the same pattern in every frame
    temporal  ///< the pattern of an eye that never rests
};

/// Their names, in that order.
inline constexpr std::array<std::string_view, 3> glare_names{"off", "static", "temporal"};

/// Glare's strength lies within 0 and this.
inline constexpr float most_glare = 0.5f;

/// Glare: scattering of bright light in the eye (docs/model/display.md).
struct Glare {
    GlareKind kind = GlareKind::off;
    float strength = 0.1f;   ///< scattered share of the light, 0..most_glare; real eyes scatter a tenth
    float size = 0.5f;       ///< how far it is scattered, over the picture's height, > 0..1
    std::uint32_t seed = 0;  ///< of the eye

    bool shows() const { return kind != GlareKind::off && strength > 0; }
    bool operator==(const Glare&) const = default;
};

}  // namespace render2mpeg::core
