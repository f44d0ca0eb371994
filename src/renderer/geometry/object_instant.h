#pragma once
// One object at one instant of the shutter.
#include <optional>

#include "scene/pose/sweep.h"

namespace render2mpeg::renderer {

/// One object of a snapshot at an instant of its shutter, as rays of that time meet it: between two knots of the sweep
/// vertices move straight. In the middle, and where it does not move, it is what the snapshot says.
class ObjectInstant {
  public:
    /// `snapshot` outlives it.
    ObjectInstant(const scene::Snapshot& snapshot, std::uint32_t object, float time = scene::middle_time);
    ObjectInstant(const ObjectInstant&) = delete;
    ObjectInstant& operator=(const ObjectInstant&) = delete;

    const scene::Snapshot& snapshot() const { return snapshot_; }
    const scene::Mesh& mesh() const { return mesh_; }
    const scene::ObjectState& state() const { return *state_; }
    bool deforms() const { return before_ != nullptr; }

    /// World place of a vertex.
    glm::vec3 position(std::uint32_t vertex) const;
    bool has_normals() const { return before_ != nullptr ? !before_->normals.empty() : !mesh_.normals.empty(); }
    /// Normal of a vertex, in world space where the object deforms, else in its own.
    glm::vec3 normal(std::uint32_t vertex) const;

  private:
    const scene::Snapshot& snapshot_;
    const scene::Mesh& mesh_;
    std::optional<scene::ObjectState> moved_;  ///< where it is not the snapshot's
    const scene::ObjectState* state_;
    const scene::DeformedMesh *before_ = nullptr, *after_ = nullptr;  ///< deforming: vertices of both knots
    float share_ = 0;                                                 ///< of the second
};

}  // namespace render2mpeg::renderer
