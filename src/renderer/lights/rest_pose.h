#pragma once
// Surfaces that move as their meshes have them, where they are divided among their anchors.
#include <cstdint>

#include "core/surface_address.h"
#include "renderer/lights/point_tree.h"
#include "scene/pose/snapshot.h"

namespace render2mpeg::renderer {

/// Places of surfaces that move, in the space of their meshes: their anchors are chosen there.
class RestPoses {
  public:
    explicit RestPoses(const scene::Animation& film) : film_(&film) {}

    OrientedPoint at(const core::SurfaceAddress& address, bool front) const;

    /// World area of a triangle at an instant over its area at rest; bounded, where it has none at rest.
    float area_scale(const scene::Snapshot& now, const core::SurfaceAddress& address) const;

    /// Squared diagonal of an object's box at rest.
    float extent2(std::uint32_t object) const;

  private:
    const scene::Mesh& mesh_of(std::uint32_t object) const;

    const scene::Animation* film_;
};

}  // namespace render2mpeg::renderer
