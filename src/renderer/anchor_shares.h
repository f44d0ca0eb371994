#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "renderer/anchor_places.h"
#include "renderer/point_tree.h"
#include "renderer/ray_tracer.h"

namespace render2mpeg::renderer {

/// What is kept of an anchor's place, beside where it rests.
struct Anchor {
    core::SurfaceAddress address;
    float disc2 = 0;    ///< in the space of its group: see LightPoint::disc2
    bool front = true;  ///< which side of the triangle it lies on
};

/// Anchors that one photon is shared among [Render2MPEG, 7.3.1].
inline constexpr int shared_among = 16;

/// A photon's share in each of its anchors; `weight` adds up to 1. None where the photon's group has no anchor.
struct AnchorShares {
    int count = 0;
    int rays = 0;  ///< that were traced to find them
    std::array<std::uint32_t, shared_among> anchor;
    std::array<float, shared_among> weight;
};

/// What moves, where it stands between still anchors at one instant: a door that is shut. Empty where nothing moves.
struct AnchorPartings {
    std::vector<std::uint32_t> parted;  ///< of each still anchor; bit k: from the k-th of its neighbours
    std::uint64_t rays = 0;             ///< that were traced to find them
};

/// Holds all anchors, and finds those among which a photon is shared (docs/model.md, "Anchor lights").
class AnchorSharing {
  public:
    AnchorSharing() = default;

    /// `places` lie by group, what is still (group 0) first; so do the anchors, in an order of their own. Of what is
    /// still only such anchors are neighbours as see each other over what is still of `scene`: light stays on its side
    /// of a wall.
    AnchorSharing(std::span<const AnchorPlace> places, const RayTracer& scene);

    std::uint32_t size() const { return static_cast<std::uint32_t>(anchors_.size()); }
    /// Those of group 0, which come first.
    std::uint32_t still_count() const { return still_count_; }
    const Anchor& operator[](std::uint32_t anchor) const { return anchors_[anchor]; }
    /// Where it lies, in the space of its group.
    const OrientedPoint& rest(std::uint32_t anchor) const;

    /// Which neighbours what moves keeps apart, as `scene` is posed.
    AnchorPartings partings(const RayTracer& scene) const;

    /// Shares of a photon that landed at `at`, in the space of its group, while `scene` is posed as it was for
    /// `partings`. Without those what moves does not count.
    AnchorShares share(std::uint32_t group, const OrientedPoint& at, const RayTracer& scene,
                       const AnchorPartings* partings = nullptr) const;

    /// Rays traced for neighbours.
    std::uint64_t rays() const { return rays_; }

    /// Bytes held.
    std::size_t bytes() const;

  private:
    /// Anchors of one group: `first` and those after it, in the tree's order.
    struct Group {
        std::uint32_t id = 0, first = 0;
        PointTree tree;
    };

    void list_neighbours(const RayTracer& scene);
    float lift_between(std::uint32_t a, std::uint32_t b) const;
    std::uint32_t nearest_in_sight(const OrientedPoint& at, const RayTracer& scene, bool past_movers, int& rays) const;
    AnchorShares share_among_alike(const Group& group, const OrientedPoint& at) const;
    AnchorShares share_in_sight(const OrientedPoint& at, const RayTracer& scene, const AnchorPartings* partings) const;

    std::vector<Anchor> anchors_;
    std::vector<Group> groups_;  ///< by id
    std::uint32_t still_count_ = 0;
    bool tested_ = false;                         ///< still neighbours see each other, and are listed
    std::vector<std::uint32_t> first_neighbour_;  ///< of each still anchor in `neighbours_`, and the end of the last
    std::vector<std::uint16_t> neighbours_;       ///< the nearest first
    std::uint64_t rays_ = 0;
};

}  // namespace render2mpeg::renderer
