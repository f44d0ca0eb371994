#pragma once
// Splats photons' energy onto the anchors around their hits.
#include <array>
#include <compare>
#include <cstdint>
#include <span>
#include <vector>

#include "renderer/geometry/ray_tracer.h"
#include "renderer/lights/anchor_places.h"
#include "renderer/lights/point_tree.h"

namespace render2mpeg::renderer {

/// Where an anchor that moves is carried along.
struct AnchorMount {
    core::SurfaceAddress address;
    bool front = true;  ///< which side of the triangle it lies on
};

/// Where a photon hit a surface that scatters it.
struct PhotonHit {
    std::uint32_t group = 0;
    OrientedPoint at;    ///< in the space of its group
    glm::vec3 light{0};  ///< radiant intensity that it leaves
};

/// Anchors that one photon is shared among at most [Render2MPEG, 7.3.1].
inline constexpr int shared_among = 16;

/// A photon's share in each of its anchors; `weight` adds up to 1. None where the photon's group has no anchor.
struct SplatWeights {
    int count = 0;
    std::array<std::uint32_t, shared_among> anchor;
    std::array<float, shared_among> weight;
};

/// Of each still anchor, which of the neighbours that it sees what moves keeps apart from it at one instant, a door
/// that is shut: bit k is the k-th nearest of them. Empty where nothing moves.
struct OccludedNeighbours {
    std::vector<std::uint32_t> hidden;
    std::uint64_t rays = 0;  ///< that were traced to find them
};

/// Up to so many still anchors keep the lists of their neighbours, 132 bytes each, so that no frame looks for them
/// anew. chosen: 32,768, 4 MB.
inline constexpr std::size_t most_listed = 1u << 15;

/// Holds all anchors, and finds those among which a photon is shared (docs/model/lights.md).
class PhotonSplatter {
  public:
    PhotonSplatter() = default;

    /// `places` lie by group, what is still (group 0) first; so do the anchors, in an order of their own. Of what is
    /// still only such anchors are neighbours as see each other over what is still of `scene`: light stays on its side
    /// of a wall. If no more than `listed` are still, each keeps the list of its neighbours, which changes no result.
    PhotonSplatter(std::span<const AnchorPlace> places, const RayTracer& scene, std::size_t listed = most_listed);

    std::uint32_t size() const { return static_cast<std::uint32_t>(disc2_.size()); }
    /// Those of group 0, which come first.
    std::uint32_t still_count() const { return still_count_; }
    /// In the space of its group: see LightPoint::disc2.
    float disc2(std::uint32_t anchor) const { return disc2_[anchor]; }
    /// Of those that move.
    const AnchorMount& mount(std::uint32_t anchor) const { return mounts_[anchor - still_count_]; }
    /// Where it lies, in the space of its group.
    OrientedPoint rest(std::uint32_t anchor) const;

    /// Which neighbours what moves keeps apart, as `scene` is posed.
    OccludedNeighbours occluded_neighbours(const RayTracer& scene) const;

    /// Adds the light of photons that landed while `scene` is posed as it was for `occluded` to their anchors, of which
    /// `light` has one each. Without occluded what moves does not count. Returns the rays that it took. Does not depend
    /// on the number of threads; the more photons at once, the less time each takes.
    std::uint64_t splat(std::span<const PhotonHit> photons, const RayTracer& scene, const OccludedNeighbours* occluded,
                        std::span<glm::dvec3> light) const;

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

    /// Neighbours of a still anchor that it sees, the nearest first, itself among them.
    struct Neighbours {
        static constexpr int most = 2 * shared_among;
        static_assert(most <= 32, "bit sets have 32 bits");
        std::array<std::uint32_t, most> anchor{};
        int count = 0;
    };

    void look_about(const RayTracer& scene, std::size_t listed);
    float lift_between(std::uint32_t a, std::uint32_t b) const;
    Neighbours neighbours(std::uint32_t anchor) const;
    std::uint32_t nearest_in_sight(const OrientedPoint& at, const RayTracer& scene, bool past_dynamic, int& rays) const;
    SplatWeights share_among_alike(std::uint32_t group, const OrientedPoint& at) const;
    SplatWeights share_among(const Neighbours& neighbours, std::uint32_t hidden, const OrientedPoint& at) const;
    /// The place of a photon in `photons`, and the nearest anchor that sees it where it is one of what is still.
    struct Placed {
        std::uint32_t nearest, photon;
        auto operator<=>(const Placed&) const = default;  // NOLINT(modernize-use-nullptr): a mistake of version 14
    };
    void share(std::span<const Placed> placed, std::span<const PhotonHit> photons, const OccludedNeighbours* occluded,
               std::span<SplatWeights> shares) const;

    std::vector<float> disc2_;
    std::vector<AnchorMount> mounts_;  ///< of those that move
    std::vector<Group> groups_;        ///< by id
    std::uint32_t still_count_ = 0;
    /// Of each still anchor, which of its nearest neighbours it sees: bit k is the k-th.
    std::vector<std::uint64_t> visible_;
    /// Of each still anchor; empty where these are many: then they are looked for whenever they are asked for.
    std::vector<Neighbours> neighbours_;
    std::uint64_t rays_ = 0;
};

}  // namespace render2mpeg::renderer
