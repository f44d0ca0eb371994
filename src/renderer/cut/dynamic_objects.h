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
    /// Of many dynamic objects those that look largest from the group. chosen: 8, as of shields; not tuned.
    static constexpr int most = 8;

    /// What looks smaller hides too little for parts of clusters to be looked at past it. chosen: 0.02, a
    /// ten-thousandth of what a point sees: less than one light of a cut.
    static constexpr float least_seen = 0.02f;

    /// Those that look smaller than `least` (half their diagonal over their distance) are none.
    void choose(const GatherLanes& lanes, std::span<const MiddleBox> movers, float least = least_seen);
    bool empty() const { return count_ == 0; }

    /// Whether something may move between the group and the lights of a box (directional: of unit directions). Rough: a
    /// ball about the group and one about the box.
    bool may_hide(LightType type, const glm::vec3& middle, const glm::vec3& half) const;

    /// The same, and no is certain: of the lights of a box none is hidden from a lane.
    bool can_hide(LightType type, const glm::vec3& middle, const glm::vec3& half) const;

    /// Bit i: ray i, asked for or not, meets one of the boxes.
    std::uint32_t met(const ShadowPacket& packet) const;

    /// Bit i: ray i, asked for or not, passes through one of the boxes, in at one side and out at another before it
    /// ends. Boxes that hold one of its ends do not count: of what lies on a dynamic object, or is the light, the box
    /// tells nothing.
    std::uint32_t passed(const ShadowPacket& packet) const;

  private:
    int count_ = 0;
    MiddleBox box_[most];
    glm::vec3 middle_{0}, half_{0};  ///< of a box about the group
    float radius_ = 0;               ///< of a ball about it
};

}  // namespace render2mpeg::renderer
