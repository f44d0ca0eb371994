#pragma once
// Normals of a pixel's samples on one surface, taken into its lobe.
#include <glm/glm.hpp>

#include "renderer/surface/surface_point.h"

namespace render2mpeg::renderer {

/// Mean and covariance of shading normals. A lobe whose half vectors vary as much as normals do within a pixel shows
/// what a mean over the pixel shows: slopes of GGX facets vary by alpha^2 / 2 along each axis, those of normals add
/// their own [Kaplanyan2016, sec. 4; Olano2010]. One point then stands for a bent edge or a bump, and no sample hits or
/// misses a lamp alone.
class NormalSpread {
  public:
    /// `turn`: by how much it differs at neighbouring samples to the right and below. `weight` >= 0.
    void add(glm::vec3 normal, const SurfaceFootprint& turn, float weight);

    /// Gives the point the mean normal, where that faces as its own does, and widens its lobe: across and along where
    /// normals vary more one way, else round; what it reflects under even light stays. Widths of wide lobes stay.
    void fold_into(SurfacePoint& point) const;

  private:
    float weight_ = 0;
    glm::vec3 first_{0}, sum_{0};  ///< the sum, and that of squares, of differences from the first
    glm::mat3 squares_{0};
};

}  // namespace render2mpeg::renderer
