#pragma once
// Animation tracks: keys and interpolation.
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <span>
#include <string>
#include <vector>

namespace render2mpeg::scene {

enum class Interpolation { step, linear, cubic_spline };

/// What a track moves. `visibility` (0 or 1), `light_intensity` and `emission` (factors on the light's or material's
/// own value), `field_of_view` (CameraLens::vertical_fov, radians), `f_stop` and `focus_distance` come from animation
/// files. `light_color` and `base_color` replace Light::color and Material::base_color.
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
    focus_distance
};

/// A curve over time [glTF2, 3.11 and appendix C]. Key k has `width` values; with cubic_spline three times as many:
/// in-tangent, value, out-tangent. Before the first key and after the last the curve is constant.
struct Track {
    TrackTarget target = TrackTarget::translation;
    int index = -1;  ///< node; for light_* the light, emission, base_color the material, field_of_view, f_stop and
                     ///< focus_distance the camera
    Interpolation interpolation = Interpolation::linear;
    int width = 3;  ///< translation, scale, light_color 3; rotation 4 (x, y, z, w), base_color 4; weights: number of
                    ///< morph targets; else 1
    std::vector<float> times;  ///< seconds, finite, strictly rising after validation
    std::vector<float> values;

    /// Writes `width` values at `seconds` to `out`. Rotations come normalised, by the shortest path.
    void sample(double seconds, std::span<float> out) const;
};

}  // namespace render2mpeg::scene
