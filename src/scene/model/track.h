#pragma once
// Animation tracks: keys and interpolation.
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <span>
#include <vector>

namespace render2mpeg::scene {

enum class Interpolation { step, linear, cubic_spline };

/// Target of a track. `visibility` is 0 or 1; `light_intensity` and `emission` are factors; `field_of_view` (radians),
/// `f_stop` and `focus_distance` are cameras'; `reflection_radius` and `reflection_border` are edits'; `light_color`
/// and `base_color` replace the own one.
enum class TrackTarget {
    translation,
    rotation,
    scale,
    weights,
    visibility,
    light_intensity,
    emission,
    field_of_view,
    light_color,
    base_color,
    f_stop,
    focus_distance,
    reflection_radius,
    reflection_border
};

/// Curve over time [glTF2, 3.11 and appendix C], constant outside its keys. Key k has `width` values; cubic_spline has
/// in-tangent, value, out-tangent.
struct Track {
    TrackTarget target = TrackTarget::translation;
    int index = -1;  ///< node; for light_* the light, emission, base_color the material, field_of_view, f_stop and
                     ///< focus_distance the camera, reflection_* the edit
    Interpolation interpolation = Interpolation::linear;
    int width = 3;  ///< translation, scale, light_color 3; rotation 4 (x, y, z, w), base_color 4; weights: number of
                    ///< morph targets; else 1
    std::vector<float> times;  ///< seconds, finite, strictly rising after validation
    std::vector<float> values;

    /// Writes `width` values; rotations are unit, by the shortest path.
    void sample(double seconds, std::span<float> out) const;
};

}  // namespace render2mpeg::scene
