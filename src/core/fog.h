#pragma once
// Fog in the air of a film, as requested by it.
#include <glm/glm.hpp>

namespace render2mpeg::core {

/// How far one may see in fog, scene units.
inline constexpr float least_visibility = 1e-4f, most_visibility = 1e9f;

/// How much fog prefers to scatter light on its way: -this to this.
inline constexpr float most_anisotropy = 0.95f;

/// Participating medium in the air, as requested by animation files and the command line (docs/model/fog.md).
struct Fog {
    float visibility = 0;  ///< distance at which black on white keeps 5 % of its contrast, scene units; 0: clear air
    glm::vec3 color{1};    ///< single-scattering albedo, 0..1 each; black: smoke
    float anisotropy = 0;  ///< mean cosine of the angle by which it scatters, -most_anisotropy..most_anisotropy
    float height = 0;      ///< y at which `visibility` holds, if the fog thins out
    float falloff = 0;     ///< scale height: density falls to 1 / e over this height, scene units; 0: homogeneous

    bool bounces = true;  ///< light that surfaces bounce lights it as well

    bool shows() const { return visibility > 0; }
    bool operator==(const Fog&) const = default;
};

}  // namespace render2mpeg::core
