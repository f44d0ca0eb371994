#pragma once
// Large convex occluders of what never moves.
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "scene/pose/snapshot.h"

namespace render2mpeg::renderer {

/// A large opaque triangle of what never moves, or two that share an edge and make a convex quad: what hides lights
/// for certain, so that a cut need not ask about them.
struct Occluder {
    glm::vec3 corner[4];  ///< in their order around it; a triangle's last two are the same
};

/// At most `count` occluders: the largest triangles, paired where they share an edge. A function of the triangles and
/// their order.
std::vector<Occluder> occluders_of(const std::vector<scene::Triangle>& triangles, std::size_t count);

/// Many occluders as one group of points chooses among them.
class OccluderList {
  public:
    OccluderList() = default;
    explicit OccluderList(std::vector<Occluder> occluders);

    std::size_t size() const { return occluders_.size(); }
    const Occluder& operator[](std::size_t i) const { return occluders_[i]; }

    /// Writes the solid angle of each as seen from `at` (any rising function of it) to `seen`, 0 for those that lie
    /// wholly below the plane through `at` with this normal. `seen` has room for `padded()`.
    void look_from(glm::vec3 at, glm::vec3 normal, float* seen) const;
    std::size_t padded() const { return padded_; }

  private:
    std::vector<Occluder> occluders_;
    std::vector<float> places_;  ///< x of all first corners, y, z; the same of the others
    std::size_t padded_ = 0;     ///< to whole vectors
};

}  // namespace render2mpeg::renderer
