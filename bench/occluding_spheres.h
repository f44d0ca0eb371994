#pragma once

#include <cstdint>
#include <vector>

#include "bench/surface_cloud.h"
#include "renderer/geometry/ray_tracer.h"

namespace render2mpeg::bench {

/// Spheres that lie inside of things and stand for them where shadow rays are asked.
class OccludingSpheres {
  public:
    /// The `most` spheres that together fill most of the inside, the one that fills most anew first.
    OccludingSpheres(const SurfaceCloud& cloud, int most);

    /// Bit i: ray i of the packet meets a sphere. Spheres far from all sixteen are left out at once.
    std::uint32_t occluded(const renderer::ShadowPacket& packet) const;

    std::size_t count() const { return count_; }

  private:
    std::size_t count_ = 0;
    std::vector<float> x_, y_, z_, radius_;  ///< in whole blocks
};

}  // namespace render2mpeg::bench
