#pragma once
// Projections: how the rays that a camera sees lie on its film.
#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>

#include "scene/model/stereo.h"

namespace render2mpeg::scene {

enum class ProjectionKind : std::uint8_t { perspective, orthographic, equirectangular };

/// The part of the sphere that an equirectangular picture shows, radians: longitudes to the right of the camera's
/// axis, west < east <= west + 2 pi; latitudes above it, south < north.
struct SphereWindow {
    double west = -std::numbers::pi, east = std::numbers::pi, south = -std::numbers::pi / 2,
           north = std::numbers::pi / 2;

    /// Whether the left and the right edge show one meridian.
    bool is_closed() const { return east - west > 2 * std::numbers::pi - 1e-9; }
    double aspect() const { return (east - west) / (north - south); }
    bool operator==(const SphereWindow&) const = default;
};

/// "360 by 180 degrees".
std::string text_of(const SphereWindow& window);

/// VR180: half of the longitudes, all latitudes.
inline constexpr SphereWindow half_sphere{-std::numbers::pi / 2, std::numbers::pi / 2, -std::numbers::pi / 2,
                                          std::numbers::pi / 2};

/// Words for panoramas, and what each shows.
inline constexpr std::array<std::string_view, 2> panorama_names{"equirectangular", "vr180"};
inline constexpr std::array<SphereWindow, 2> panorama_windows{SphereWindow(), half_sphere};

/// A ray in the camera's space: x right, y up, the axis along -z.
struct FilmRay {
    glm::dvec3 origin{0};
    glm::dvec3 direction{0};  ///< of any length
};

/// Where a point appears on the film, and how deep it lies.
struct FilmPoint {
    glm::dvec2 place;
    double depth;  ///< along the axis, > 0; in an equirectangular picture the distance
};

/// Between places on the film, (-1, -1) its lower left corner and (1, 1) the upper right one, and rays in the camera's
/// space. Both ways are one map and its inverse, in double precision.
class Projection {
  public:
    Projection() = default;
    /// `half_extent`: of the film at unit depth (perspective), or in scene units (orthographic).
    Projection(ProjectionKind kind, glm::dvec2 half_extent) : kind_(kind), half_extent_(half_extent) {}
    explicit Projection(const SphereWindow& window)
        : kind_(ProjectionKind::equirectangular),
          half_extent_(0.5 * (window.east - window.west), 0.5 * (window.north - window.south)),
          window_(window) {}

    /// A panorama's of an eye on a circle.
    Projection(const SphereWindow& window, const EyeCircle& circle) : Projection(window) { circle_ = circle; }

    FilmRay ray(glm::dvec2 place) const;
    /// None on or behind the eye's plane; of a sphere none in the eye alone, or within the circle that it goes round.
    /// Points beyond a window lie off its film.
    std::optional<FilmPoint> point(glm::dvec3 seen) const;
    /// At depth +infinity; none for orthographic cameras, which see one direction everywhere.
    std::optional<FilmPoint> direction(glm::dvec3 seen) const;

    /// Where the ray begins that shows a point; of parallel rays the origin.
    glm::dvec3 eye_of(glm::dvec3 seen) const;

    /// Whether all rays leave one point, or a circle about it that is small beside what is seen.
    bool has_eye() const { return kind_ != ProjectionKind::orthographic; }
    /// Whether depths are distances.
    bool is_sphere() const { return kind_ == ProjectionKind::equirectangular; }
    /// Whether the film's left edge goes on at its right one.
    bool is_closed() const { return is_sphere() && window_.is_closed(); }
    /// Half of the film's sides at unit depth, in scene units where there is no eye, in radians on a sphere.
    glm::dvec2 half_extent() const { return half_extent_; }

    /// Solid angle of a small piece of film at this height over that of one at the film's middle; 1 on flat films.
    double solid_angle_at(double height) const;
    /// A height on the film, such that numbers spread evenly over [0, 1] (0: the top) spread it evenly over the solid
    /// angle; evenly over flat films.
    double even_height(double number) const;

  private:
    /// Of a place where a flat picture has `right` and `up` at this scale.
    glm::dvec2 on_plane(glm::dvec3 seen, double scale) const;
    glm::dvec2 on_sphere(glm::dvec3 seen) const;
    /// The direction, about the circle's middle, of the ray that shows a point.
    std::optional<glm::dvec3> way_from_circle(glm::dvec3 seen) const;
    double latitude(double height) const { return window_.south + (height + 1) * half_extent_.y; }

    ProjectionKind kind_ = ProjectionKind::perspective;
    glm::dvec2 half_extent_{1, 1};
    SphereWindow window_;
    EyeCircle circle_;
};

}  // namespace render2mpeg::scene
