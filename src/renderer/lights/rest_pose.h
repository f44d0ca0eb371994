#pragma once
// The shape in which a deforming surface is divided among its anchors.
#include <cstdint>
#include <glm/glm.hpp>
#include <map>
#include <vector>

#include "core/surface_address.h"
#include "renderer/lights/point_tree.h"
#include "scene/pose/snapshot.h"

namespace render2mpeg::renderer {

/// The shape in which the surface of an object that moves is parted among its anchors: its mesh, or, where that has
/// hardly any area (what grows from a point), its largest shape among the instants that were looked at.
class RestPoses {
  public:
    explicit RestPoses(const scene::Animation& film) : film_(&film) {}

    /// Looks at the shapes of one more instant.
    void consider(const scene::Snapshot& now);

    OrientedPoint at(const core::SurfaceAddress& address, bool front) const;

    /// World area of a triangle at an instant over its area at rest; bounded, where it has none at rest.
    float area_scale(const scene::Snapshot& now, const core::SurfaceAddress& address) const;

    /// Squared diagonal of an object's box at rest.
    float extent2(std::uint32_t object) const;

  private:
    struct Shape {
        double area = 0;
        std::vector<glm::vec3> positions;
    };
    const scene::Mesh& mesh_of(std::uint32_t object) const;
    const std::vector<glm::vec3>& positions_of(std::uint32_t object) const;

    const scene::Animation* film_;
    std::map<std::uint32_t, Shape> grown_;  ///< of objects whose mesh does not serve
};

}  // namespace render2mpeg::renderer
