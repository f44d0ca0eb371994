#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

namespace render2mpeg::scene {

/// A camera in its node's space: looks along -z, +y up, +x right.
struct CameraLens {
    std::string name;
    int node = -1;
    bool perspective = true;
    float vertical_fov = 0.9f;  ///< radians, 0 < fov < pi
    float y_magnification = 1;  ///< orthographic: half the visible height, scene units, > 0
    glm::vec2 shift{0, 0};      ///< of the picture to the right and up over what the lens shows, in picture heights
    float near = 0;             ///< scene units; nothing nearer is seen
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
};

struct Ray {
    glm::vec3 origin;
    glm::vec3 direction;  ///< unit
};

/// Where a point appears: pixels, (0, 0) the upper left corner of the upper left pixel, whose centre is (0.5, 0.5).
struct ScreenPoint {
    glm::vec2 position;
    float depth;  ///< along the camera's axis, > 0
};

/// A camera at one instant with one picture format.
class Camera {
  public:
    Camera() = default;
    /// `to_world` is rigid. `aspect`: displayed width over height, pixel aspect included.
    Camera(const CameraLens& lens, const glm::mat4& to_world, int width, int height, float aspect);

    /// The same camera elsewhere, and with another field of view.
    Camera moved(const glm::mat4& to_world, float vertical_fov) const;

    /// The ray through a position on the picture.
    Ray ray_through(glm::vec2 position) const;

    /// Ray from `lens` (unit disc, x right, y up) through the focused point of the central ray.
    Ray ray_through(glm::vec2 position, glm::vec2 lens) const;

    bool has_aperture() const { return lens_.aperture_radius > 0; }

    /// Horizontal diameter of the blur disc at this depth, pixels; vertical `squeeze` times that.
    float circle_of_confusion(float depth) const;

    /// Position of a world point; none on or behind the eye's plane.
    std::optional<ScreenPoint> project(glm::vec3 world) const;
    /// The same for a position in double precision.
    std::optional<ScreenPoint> project_exact(glm::dvec3 world) const;

    /// Position of a direction, at depth +infinity; none for orthographic cameras.
    std::optional<ScreenPoint> project_direction(glm::vec3 world_direction) const;

    glm::vec3 position() const { return glm::vec3(to_world_[3]); }
    glm::vec3 forward() const { return -glm::vec3(to_world_[2]); }
    /// World size of one pixel: at unit depth for a perspective camera, everywhere for an orthographic one.
    float pixel_size() const;
    bool perspective() const { return lens_.perspective; }
    glm::vec2 size() const { return {width_, height_}; }  ///< of the picture, pixels
    const CameraLens& lens() const { return lens_; }
    const glm::mat4& to_world() const { return to_world_; }
    /// World points to OpenEXR's camera space: x right, y up, z along the view.
    glm::mat4 world_to_camera() const;
    /// World to (0, 0) upper left, (1, 1) lower right after division by w; the third coordinate is 0 at
    /// CameraLens::near.
    glm::mat4 world_to_ndc() const;

  private:
    /// From coordinates along the camera's axes, divided by `scale` where it is a perspective camera.
    std::optional<ScreenPoint> on_picture(double right, double up, double scale, double depth) const;

    CameraLens lens_;
    glm::mat4 to_world_{1.0f};
    int width_ = 0;
    int height_ = 0;
    glm::vec2 shift_{0, 0};        ///< CameraLens::shift in halves of the picture's width and height
    glm::vec2 half_extent_{1, 1};  ///< of the picture at unit depth (perspective) or in scene units (orthographic)
};

}  // namespace render2mpeg::scene
