#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "scene/model/projection.h"

namespace render2mpeg::scene {

/// A camera in its node's space: looks along -z, +y up, +x right.
struct CameraLens {
    std::string name;
    int node = -1;
    ProjectionKind projection = ProjectionKind::perspective;
    SphereWindow window;        ///< equirectangular: what it shows
    float vertical_fov = 0.9f;  ///< perspective: radians, 0 < fov < pi; equirectangular: of the window
    float y_magnification = 1;  ///< orthographic: half the visible height, scene units, > 0
    glm::vec2 shift{0, 0};      ///< of the picture to the right and up over what the lens shows, in picture heights
    float near = 0;             ///< depth, scene units; nothing nearer is seen
    float far = 0;              ///< 0: infinite
    float aspect = 0;           ///< width over height of the picture that its maker framed; 0: not said

    /// Focus: the box of `focus_objects`, else `focus_point`, else `focus_distance`.
    float f_stop = 0;              ///< focal length over the aperture's diameter; 0: a pinhole, all is sharp
    float sensor_height = 0.024f;  ///< scene units, of the picture's height: says what the focal length is
    float focus_distance = 0;      ///< along the axis, scene units, > 0
    std::vector<int> focus_objects;
    std::optional<glm::dvec3> focus_point;  ///< in the file's own space
    int blades = 0;                         ///< corners of the aperture; below 3: round
    float blade_rotation = 0;               ///< radians
    float squeeze = 1;                      ///< anamorphic: the aperture's height over its width, > 0
    float aperture_radius = 0;              ///< scene units, what follows from all this at one instant; 0: a pinhole

    Stereo stereo;          ///< of films for two eyes
    Eye eye = Eye::single;  ///< at one instant: that which looks

    bool is_panorama() const { return projection == ProjectionKind::equirectangular; }
};

/// Has a lens show part of the sphere, all of it sharp; its place, near and far stay.
void make_panorama(CameraLens& lens, const SphereWindow& window);

struct Ray {
    glm::vec3 origin;
    glm::vec3 direction;  ///< unit
};

/// Where a point appears: pixels, (0, 0) the upper left corner of the upper left pixel, whose centre is (0.5, 0.5).
struct ScreenPoint {
    glm::vec2 position;
    float depth;  ///< along the camera's axis, > 0; in a panorama the distance
};

/// A camera at one instant with one picture format.
class Camera {
  public:
    Camera() = default;
    /// `to_world` is rigid, and that of the camera between or at its eyes. `aspect`: displayed width over height, pixel
    /// aspect included.
    Camera(const CameraLens& lens, const glm::mat4& to_world, int width, int height, float aspect);

    /// The same camera elsewhere, and with another field of view.
    Camera moved(const glm::mat4& to_world, float vertical_fov) const;

    /// The ray through a position on the picture.
    Ray ray_through(glm::vec2 position) const;

    /// Ray from `lens` (unit disc, x right, y up) through the focused point of the central ray.
    Ray ray_through(glm::vec2 position, glm::vec2 lens) const;

    /// 1: it is the right eye of two; else 0.
    std::size_t eye_number() const { return lens_.eye == Eye::right ? 1 : 0; }

    bool has_aperture() const { return lens_.aperture_radius > 0; }

    /// Horizontal diameter of the blur disc at this depth, pixels; vertical `squeeze` times that.
    float circle_of_confusion(float depth) const;

    /// Position of a world point; none on or behind the eye's plane.
    std::optional<ScreenPoint> project(glm::vec3 world) const;
    /// The same for a position in double precision.
    std::optional<ScreenPoint> project_exact(glm::dvec3 world) const;

    /// Position of a direction, at depth +infinity; none for orthographic cameras.
    std::optional<ScreenPoint> project_direction(glm::vec3 world_direction) const;

    /// Whether columns go on from the right edge to the left one: a panorama all around.
    bool wraps() const { return projection_.is_closed(); }
    /// A position, or the same a turn away where the picture wraps: that which is nearest to another one.
    glm::vec2 nearest_turn(glm::vec2 position, glm::vec2 to) const;
    /// Picture that a ball may cover, upper left and lower right corner, beyond its sides where it wraps; none in flat
    /// pictures.
    std::optional<std::pair<glm::vec2, glm::vec2>> cover_of_ball(glm::vec3 middle, float radius) const;
    /// Solid angle of a pixel of a row over that of the largest; 1 in flat pictures.
    float weight_of_row(int row) const;
    /// A position for two numbers in [0, 1]: even numbers are even over the solid angle, or over a flat picture.
    glm::vec2 even_position(glm::vec2 numbers) const;

    /// Of the eye, or of the middle of the circle that it goes round.
    glm::vec3 position() const { return glm::vec3(to_world_[3]); }
    /// Where the ray begins that shows a world point, if there is an eye.
    glm::vec3 eye_of(glm::vec3 world) const;
    glm::vec3 forward() const { return -glm::vec3(to_world_[2]); }
    /// World size of one pixel at unit depth; everywhere for an orthographic camera.
    float pixel_size() const;
    /// World size of one pixel at a depth.
    float pixel_extent(float depth) const { return pixel_size() * (has_eye() ? depth : 1.0f); }
    /// Angle of one pixel, radians: the picture's height over its rows.
    float pixel_angle() const { return lens_.vertical_fov / static_cast<float>(height_); }
    float depth_of(glm::vec3 world) const;
    /// The direction along which a ray's points become deeper by their distance: the camera's axis, or the ray's own.
    glm::vec3 depth_axis(glm::vec3 direction) const { return projection_.is_sphere() ? direction : forward(); }
    /// Whether all rays leave one point: not those of an orthographic camera.
    bool has_eye() const { return projection_.has_eye(); }
    bool is_flat() const { return !projection_.is_sphere(); }
    glm::vec2 size() const { return {width_, height_}; }  ///< of the picture, pixels
    const CameraLens& lens() const { return lens_; }
    const glm::mat4& to_world() const { return to_world_; }
    /// The same camera through another lens.
    Camera through(const CameraLens& lens, float aspect) const {
        return Camera(lens, head_to_world_, width_, height_, aspect);
    }
    /// World points to OpenEXR's camera space: x right, y up, z along the view.
    glm::mat4 world_to_camera() const;
    /// World to (0, 0) upper left, (1, 1) lower right after division by w; the third coordinate is 0 at
    /// CameraLens::near. Of flat pictures.
    glm::mat4 world_to_ndc() const;

  private:
    glm::dvec2 film_place(glm::vec2 position) const;
    std::optional<ScreenPoint> on_picture(const std::optional<FilmPoint>& film) const;
    glm::dvec3 along_axes(glm::dvec3 way) const;

    CameraLens lens_;
    glm::mat4 head_to_world_{1.0f};  ///< as it was given
    glm::mat4 to_world_{1.0f};       ///< of the eye
    int width_ = 0;
    int height_ = 0;
    glm::vec2 shift_{0, 0};  ///< CameraLens::shift in halves of the picture's width and height
    Projection projection_;
};

}  // namespace render2mpeg::scene
