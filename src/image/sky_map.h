#pragma once
// The sky: a colour or a latitude-longitude image.
#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <vector>

#include "core/plane.h"
#include "image/stored_image.h"
#include "image/texture.h"

namespace render2mpeg::image {

/// One part of the sky, as a light that is infinitely far.
struct SkySample {
    glm::vec3 direction{0, 1, 0};  ///< to the sky, unit: the part's centre of power
    glm::vec3 irradiance{0};  ///< across the beam: the integral of radiance over the part's solid angle; finite, >= 0
    float solid_angle = 0;    ///< of the part, steradian, > 0
    std::uint32_t id = 0;     ///< 0, 1, 2, ... in the order of the parts; the same for the same arguments
};

/// How much light from a direction (unit) counts, > 0, relative to other directions.
using SkyImportance = std::function<float(glm::vec3)>;

/// A latitude-longitude image as cells to be divided into lights: pixels, groups of at most a quarter of a degree (half
/// the sun), or pieces of large pixels. Directions in the map's space.
class SkyGrid {
  public:
    SkyGrid() = default;
    /// From linear radiance (alpha is ignored), finite and >= 0.
    explicit SkyGrid(const core::Plane<glm::vec4>& radiance);

    bool empty() const { return light_.empty(); }
    int columns() const { return light_.width(); }
    int rows() const { return light_.height(); }

    /// Integral of radiance over the whole sphere.
    glm::vec3 total() const { return total_; }

    /// SkyMap::samples, in the map's own space.
    std::vector<SkySample> divide(int count, const SkyImportance& importance = {}) const;

  private:
    struct Part;

    double solid_angle(const Part& part) const;
    SkySample sample_of(const Part& part, const core::Plane<float>& power) const;
    void divide(const Part& part, const core::Plane<float>& power, std::vector<Part>& open,
                std::vector<SkySample>& samples) const;

    core::Plane<glm::vec3> light_;      ///< integral of radiance over each cell
    core::Plane<glm::vec3> center_;     ///< each cell's centre of power, unit
    std::vector<double> column_edges_;  ///< 0..1 of the map's width, one more than columns
    std::vector<double> row_edges_;     ///< likewise from the zenith down
    glm::vec3 total_{0};
};

/// Light from where no surface is: one colour, or a latitude-longitude image (+y up, -z in its middle, +x at three
/// quarters of its width) times a colour. Everything is scene-linear and in world space. How it becomes lights:
/// docs/model/images.md.
class SkyMap {
  public:
    /// The same radiance everywhere.
    explicit SkyMap(glm::vec3 radiance);

    /// `factor` (>= 0) multiplies the image. `rotation` turns the sky about +y, in radians, right-handed: what lay at
    /// -z then lies at
    /// (-sin, 0, -cos). 8- and 16-bit images are taken as sRGB. Negative values and NaN count as black, infinite ones
    /// as 65504, the largest half float: an overflowed sun was at least that. An image without pixels is black.
    SkyMap(const StoredImage& image, glm::vec3 factor, float rotation);

    /// Mean radiance over a cone of `solid_angle` steradian about `direction` (any length > 0); 0: a point,
    /// interpolated. Finite for any arguments.
    glm::vec3 radiance(glm::vec3 direction, float solid_angle) const;

    /// About the same, unevenly blurred near the zenith and the nadir, in a third of the time.
    glm::vec3 radiance_of_ray(glm::vec3 direction, float solid_angle) const;

    /// Mean radiance over the sphere.
    glm::vec3 mean() const { return mean_; }

    /// At most `count` parts of about equal power (luminance x solid angle) that cover all that shines; their
    /// irradiances sum to 4 pi x mean(). Pixels that alone hold more than 1 / count of the power, like a sun, are parts
    /// of their own, but pixels that lie within a quarter of a degree are one. Fewer than `count` where the map has
    /// fewer bright pixels; none where the sky is black or `count` is 0. A sky of one colour gives exactly `count`
    /// directions, spread evenly. With `importance` (of directions in the world) parts are of about equal power times
    /// importance.
    std::vector<SkySample> samples(int count, const SkyImportance& importance = {}) const;

    /// Whether the sky has one colour.
    bool uniform() const { return grid_.empty(); }

  private:
    glm::vec3 to_world(glm::vec3 in_map) const;
    glm::vec3 to_map(glm::vec3 in_world) const;

    glm::vec3 mean_{0};
    float cos_rotation_ = 1, sin_rotation_ = 0;
    SkyGrid grid_;     ///< empty: one colour
    Texture texture_;  ///< radiance; alpha weighs rows by their solid angle
};

}  // namespace render2mpeg::image
