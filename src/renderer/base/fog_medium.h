#pragma once
// Air that dims and scatters light: closed forms of homogeneous fog and of fog that thins out with height.
#include <glm/glm.hpp>

#include "core/fog.h"

namespace render2mpeg::renderer {

/// Share of what is scattered that goes on by this cosine to where it went, per steradian, where the mean cosine is `g`
/// [Henyey1941].
float phase(float g, float cosine);

/// Air that dims and scatters light (docs/model/fog.md): homogeneous, or exponential in y. Directions are unit vectors,
/// distances >= 0 and may be infinite; so may optical depths.
class FogMedium {
  public:
    /// `fog` shows; [low, high]: a box about the scene, at whose border light from infinitely far begins to be dimmed
    /// where the fog is homogeneous. It is made no thinner than 1/16 of its longest side.
    FogMedium(const core::Fog& fog, glm::vec3 low, glm::vec3 high);

    /// Share of light that is lost by unit of way, per scene unit.
    float extinction(float y) const;
    /// Integral of the extinction along a way. Exact but for rounding.
    float optical_depth(glm::vec3 from, glm::vec3 direction, float distance) const;
    /// Of light from infinitely far in that direction.
    float depth_to_sky(glm::vec3 from, glm::vec3 direction) const;
    /// How far a way goes whose optical depth is `depth`; infinite where none is so long.
    float distance_at(glm::vec3 from, glm::vec3 direction, float depth) const;

    glm::vec3 low() const { return low_; }
    glm::vec3 high() const { return high_; }
    float anisotropy() const { return fog_.anisotropy; }
    /// Share of what is dimmed that is scattered.
    glm::vec3 albedo() const { return fog_.color; }
    bool is_lit_by_bounces() const { return fog_.bounces; }

  private:
    float density(float y) const;

    core::Fog fog_;
    float extinction_;  ///< at its height
    glm::vec3 low_, high_;
};

}  // namespace render2mpeg::renderer
