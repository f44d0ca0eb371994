#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "renderer/anchor_places.h"
#include "renderer/point_tree.h"
#include "renderer/ray_tracer.h"

namespace render2mpeg::renderer {

/// Anchors that one photon is shared among [Render2MPEG, 7.3.1].
inline constexpr int shared_among = 16;

/// A photon's share in each of its anchors; `weight` adds up to 1. None where the photon's group has no anchor.
struct AnchorShares {
    int count = 0;
    std::array<std::uint32_t, shared_among> anchor;
    std::array<float, shared_among> weight;
};

/// Finds the anchors among which photons are shared (docs/model.md, "Anchor lights").
class AnchorSharing {
  public:
    AnchorSharing() = default;

    /// `places` lie by group, what is still (group 0) first. Of that only such anchors are neighbours as see each other
    /// in the posed `scene`, as far as still surfaces are in the way: light stays on its side of a wall. Keeps a
    /// reference to the film.
    AnchorSharing(std::span<const AnchorPlace> places, const scene::Animation& film, const RayTracer& scene);

    /// Shares of a photon that landed at `at`, in the space of its group, in the posed `scene`.
    AnchorShares share(std::uint32_t group, const OrientedPoint& at, const RayTracer& scene) const;

  private:
    std::uint32_t nearest(std::uint32_t group, const OrientedPoint& at, const RayTracer& scene) const;
    bool see_each_other(const OrientedPoint& a, const OrientedPoint& b, float lift, const RayTracer& scene) const;

    /// Anchors of one group.
    struct Group {
        std::uint32_t first = 0;
        PointTree tree;
    };
    struct Anchor {
        OrientedPoint rest;
        float disc2 = 0;
        std::uint32_t first_neighbour = 0, last_neighbour = 0;  ///< in `neighbours_`; the nearest first
    };

    const scene::Animation* film_ = nullptr;
    bool tested_ = false;  ///< neighbours see each other
    std::map<std::uint32_t, Group> groups_;
    std::vector<Anchor> anchors_;
    std::vector<std::uint32_t> neighbours_;
};

}  // namespace render2mpeg::renderer
