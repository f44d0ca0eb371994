#pragma once
// The surface of an object that shines, as a source of photons: any place of it may be one's origin.
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "renderer/base/discrete_distribution.h"
#include "renderer/base/light_point.h"
#include "renderer/surface/posed_scene.h"

namespace render2mpeg::renderer {

/// All sides of an object's triangles that emit at the posed instant. `posed_scene` outlives it.
class ShiningSurface {
  public:
    ShiningSurface(const PosedScene& posed_scene, std::uint32_t object);

    /// Area times mean luminance, both sides; scene units squared.
    double power() const { return light_.total(); }

    /// Covariance of its places, weighted by their light; world.
    const glm::mat3& covariance() const { return covariance_; }

    /// A place by two numbers in [0, 1), chosen in proportion to light. Its intensity is that of the whole, had it all
    /// the radiance that is there (over the density), and its disc a true point's.
    LightPoint at(glm::vec2 u) const;

  private:
    /// A piece of one side of a triangle, as finely as its texture is cut for light points.
    struct LitCell {
        std::uint32_t primitive = 0;
        bool front = true;
        glm::vec2 corner{0}, edge_u{0}, edge_v{0};  ///< in barycentrics of the triangle
        float luminance = 0;                        ///< mean
    };

    const PosedScene* posed_scene_;
    std::uint32_t object_;
    std::vector<LitCell> cells_;
    DiscreteDistribution light_;  ///< by area times luminance
    glm::mat3 covariance_{0};
};

}  // namespace render2mpeg::renderer
