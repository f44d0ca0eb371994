#pragma once
// Two eyes of a camera.
#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <string_view>

namespace render2mpeg::scene {

/// Of a film without stereo there is a single eye, which is the camera itself.
enum class Eye : std::uint8_t { single, left, right };

/// Where the eyes' axes meet: never; at the plane of convergence, to which their pictures are shifted; or at a point of
/// it, to which they are turned.
enum class Convergence : std::uint8_t { parallel, off_axis, toe_in };
inline constexpr std::array<std::string_view, 3> convergence_names{"parallel", "off-axis", "toe-in"};

/// The eye that is the camera itself, or that it lies between both.
enum class Pivot : std::uint8_t { left, center, right };
inline constexpr std::array<std::string_view, 3> pivot_names{"left", "center", "right"};

/// Stereoscopy of a camera, with Blender's settings. Its distances are Blender's; panoramas look around by default.
struct Stereo {
    double interocular_distance = 0.065;  ///< between the eyes, scene units, >= 0
    double convergence_distance = 1.95;   ///< of the plane of convergence, scene units, > 0
    Convergence convergence = Convergence::off_axis;
    Pivot pivot = Pivot::center;
    bool spherical = true;  ///< panoramas: the eyes look around on a circle, else from their two places
    double pole_merge_from = glm::radians(60.0);  ///< latitude from which both eyes come together, radians
    double pole_merge_to = glm::radians(75.0);    ///< from which they are one; 0: they never are

    bool operator==(const Stereo&) const = default;
};

/// The circle on which an eye lies that looks around: a ray begins beside its direction.
struct EyeCircle {
    double aside = 0;  ///< to the right of the direction at the equator, scene units; 0: an eye in the middle
    double convergence_distance = std::numeric_limits<double>::infinity();  ///< from the middle; infinite: parallel
    double merge_from = 0, merge_to = 0;                                    ///< as of Stereo

    /// `aside` at a latitude, radians [CyclesStereo].
    double at(double latitude) const;
};

/// That of one eye.
EyeCircle circle_of(const Stereo& stereo, Eye eye);

/// An eye's place and turn in the space of its camera: x right, y up, the axis along -z.
glm::dmat4 place_of(const Stereo& stereo, Eye eye);

}  // namespace render2mpeg::scene
