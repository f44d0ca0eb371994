#pragma once
// Divides a sky into directional lights.
#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <vector>

#include "core/plane.h"

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

/// A latitude-longitude image as cells of light: what is divided into lights. A cell is a pixel, or as many pixels as
/// are not more than a quarter of a degree (half the sun), or a piece of a pixel where the image has only a few.
/// Directions are in the map's own space.
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

}  // namespace render2mpeg::image
