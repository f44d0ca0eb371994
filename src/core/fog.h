#pragma once
// Fog in the air of a film, as requested by it.
#include <glm/glm.hpp>

namespace render2mpeg::core {

/// How far one may see in fog, scene units.
inline constexpr float least_visibility = 1e-4f, most_visibility = 1e9f;

/// How much fog prefers to scatter light on its way: -this to this.
inline constexpr float most_anisotropy = 0.95f;

/// What fills the air, as animation files and the command line ask for it (docs/model/fog.md).
struct Fog {
    float visibility = 0;  ///< distance at which black on white has 5 % of its contrast, scene units; 0: clear air
    glm::vec3 color{1};    ///< share of the light it meets that it scatters on, 0..1 each; black: smoke
    float anisotropy = 0;  ///< mean cosine of the angle by which it scatters, -most_anisotropy..most_anisotropy
    float height = 0;      ///< where `visibility` is told for, y, where it thins out
    float falloff = 0;     ///< upwards it has 1 / e of its density every so far, scene units; 0: everywhere the same

    bool shows() const { return visibility > 0; }
    bool operator==(const Fog&) const = default;
};

}  // namespace render2mpeg::core
