#pragma once

#include <glm/glm.hpp>

#include "scene/model/animation.h"

namespace render2mpeg::reference {

/// A film's fog, by numbers: optical depths are sums over steps.
class Fog {
  public:
    explicit Fog(const scene::Animation& film);

    double extinction(glm::dvec3 place) const;
    /// Share of light that is left of a way; of one without end in homogeneous fog what lies in the scene's box counts,
    /// for all others what lies within `endless`.
    double left(glm::dvec3 from, glm::dvec3 direction, double distance) const;
    double phase(double cosine) const;
    glm::dvec3 albedo() const { return fog_.color; }
    /// A way so long that nothing beyond it counts.
    double endless() const { return 12 * fog_.visibility; }

  private:
    core::Fog fog_;
    glm::dvec3 low_, high_;
};

}  // namespace render2mpeg::reference
