#pragma once
// Which moving objects may throw shadows on a group of points.
#include <cstdint>
#include <glm/glm.hpp>
#include <span>

#include "renderer/base/light_packing.h"
#include "renderer/geometry/ray_tracer.h"
#include "renderer/tree/gather_lanes.h"
#include "renderer/tree/light_tree.h"

namespace render2mpeg::renderer {

/// Which of the things that move may throw shadows on one group of points, and where they may: told by their boxes
/// (RayTracer::dynamic_objects), so that most lights need no ray to find that nothing moves before them.
class GroupDynamicObjects {
  public:
    /// Of many dynamic objects those that look largest from the group. chosen: 8, as of occluders; not tuned.
    static constexpr int most = 8;

    void choose(const GatherLanes& lanes, std::span<const MiddleBox> boxes);
    bool empty() const { return count_ == 0; }

    /// Conservative: false means that no light of the box (directional: of unit directions) is hidden from any lane.
    bool can_hide(LightType type, const glm::vec3& middle, const glm::vec3& half) const;

    /// Bit i: ray i, asked for or not, meets one of the boxes.
    std::uint32_t met(const ShadowPacket& packet) const;

  private:
    int count_ = 0;
    MiddleBox box_[most];
    glm::vec3 middle_{0}, half_{0};  ///< of a box about the group
};

}  // namespace render2mpeg::renderer
