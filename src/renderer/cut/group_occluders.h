#pragma once
// The occluders of one group of points, and what they hide for certain.
#include <cstdint>
#include <glm/glm.hpp>

#include "renderer/geometry/occluders.h"
#include "renderer/tree/gather_lanes.h"
#include "renderer/tree/light_tree.h"

namespace render2mpeg::renderer {

/// The occluders that hide most from the points of one group, and what they hide for certain. A light is hidden from a
/// lane where the whole way to it passes through the inside of one occluder, by more than rounding can be.
class GroupOccluders {
  public:
    static constexpr int most = 8;
    /// All occluders that may hide something: start with it, and hand a node's on to what lies below it.
    static constexpr std::uint16_t all = 0xff;

    void choose(const GatherLanes& lanes, const OccluderList& occluders);
    bool empty() const { return count_ == 0; }

    /// Whether nothing in the box about `middle` (world; directional: of unit directions) can be seen from any lane.
    /// Takes those occluders out of `viable` that do not touch it.
    bool hide(const GatherLanes& lanes, LightType type, const glm::vec3& middle, const glm::vec3& half,
              std::uint16_t& viable) const;

  private:
    static constexpr int edges = 4;
    struct alignas(64) Chosen {
        Vec3Lanes inward[edges];  ///< unit normals of the planes through a lane and an edge, shortened by what rounding
                                  ///< may turn them; 0 where the lane lies too near to tell
        Lanes sign;               ///< which side of the plane the lane lies on: 1 before it as wound, else -1
        glm::vec3 normal{0};      ///< unit
        float offset = 0;         ///< of the plane along it
        bool any_before = false, any_behind = false;  ///< lanes on either side of the plane, as wound
        float far = 0;                                ///< how far beyond the plane lights must lie
    };
    void set(Chosen& chosen, const GatherLanes& lanes, const Occluder& occluder) const;

    int count_ = 0;
    Chosen chosen_[most];
};

}  // namespace render2mpeg::renderer
