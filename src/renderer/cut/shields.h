#pragma once
// Conservative occluders: large triangles that hide lights without rays.
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "renderer/tree/gather_lanes.h"
#include "renderer/tree/light_tree.h"
#include "scene/pose/snapshot.h"

namespace render2mpeg::renderer {

/// A large opaque triangle of what never moves, or two that share an edge and make a convex quad: what hides lights
/// for certain, so that a cut need not ask about them.
struct Shield {
    glm::vec3 corner[4];  ///< in their order around it; a triangle's last two are the same
};

/// At most `count` shields: the largest triangles, paired where they share an edge. A function of the triangles and
/// their order.
std::vector<Shield> shields_of(const std::vector<scene::Triangle>& triangles, std::size_t count);

/// Many shields as one group of points chooses among them.
class ShieldList {
  public:
    ShieldList() = default;
    explicit ShieldList(std::vector<Shield> shields);

    std::size_t size() const { return shields_.size(); }
    const Shield& operator[](std::size_t i) const { return shields_[i]; }

    /// Writes the solid angle of each as seen from `at` (any rising function of it) to `seen`, 0 for those that lie
    /// wholly below the plane through `at` with this normal. `seen` has room for `padded()`.
    void look_from(glm::vec3 at, glm::vec3 normal, float* seen) const;
    std::size_t padded() const { return padded_; }

  private:
    std::vector<Shield> shields_;
    std::vector<float> places_;  ///< x of all first corners, y, z; the same of the others
    std::size_t padded_ = 0;     ///< to whole vectors
};

/// The shields that hide most from the points of one group, and what they hide for certain. A light is hidden from a
/// lane where the whole way to it passes through the inside of one shield, by more than rounding can be.
class GroupShields {
  public:
    static constexpr int most = 8;
    /// All shields that may hide something: start with it, and hand a node's on to what lies below it.
    static constexpr std::uint16_t all = 0xff;

    void choose(const GatherLanes& lanes, const ShieldList& shields);
    bool empty() const { return count_ == 0; }

    /// Whether nothing in the box about `middle` (world; directional: of unit directions) can be seen from any lane.
    /// Takes those shields out of `viable` that do not touch it.
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
    void set(Chosen& chosen, const GatherLanes& lanes, const Shield& shield) const;

    int count_ = 0;
    Chosen chosen_[most];
};

}  // namespace render2mpeg::renderer
