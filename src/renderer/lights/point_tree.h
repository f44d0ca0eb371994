#pragma once
// A k-d tree of surface points, for nearest neighbours.
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "core/packed_normal.h"

namespace render2mpeg::renderer {

/// A point on a surface, as neighbours are looked for.
struct OrientedPoint {
    glm::vec3 position{0};
    glm::vec3 normal{0, 0, 1};
};

/// A neighbour of a place.
struct Neighbour {
    float distance2 = 0;
    std::uint32_t point = 0;  ///< index
};

/// A k-d tree over points on surfaces: the middle of every range is its splitting point. Larger ranges know which ways
/// their points face, so that what faces as nothing about it does (the underside of a shelf over a floor) is not looked
/// for everywhere.
class PointTree {
  public:
    PointTree() = default;
    explicit PointTree(const std::vector<OrientedPoint>& points);

    /// Puts the up to found.size() nearest points that face as `at` does (by more than this cosine) into
    /// `found`, nearest first, and returns how many there are. Of points equally far those of lower index come first.
    int nearest(const OrientedPoint& at, float least_facing, std::span<Neighbour> found) const;

    std::size_t size() const { return points_.size(); }
    /// In the tree's order; normals are kept to 7e-5 rad.
    OrientedPoint operator[](std::size_t i) const { return {position(i), points_[i].normal.unpack()}; }
    const glm::vec3& position(std::size_t i) const { return points_[i].position; }

    /// Which point, as they were given, lies at each place of the tree's order. From then on neighbours are told by
    /// their place in that order: for who keeps what belongs to the points in the same.
    std::vector<std::uint32_t> take_order();

  private:
    struct Search;
    struct Point {
        glm::vec3 position{0};
        core::PackedNormal normal;
    };
    std::uint64_t build(std::size_t first, std::size_t last, std::size_t range);
    std::uint32_t name(std::size_t i) const { return index_.empty() ? static_cast<std::uint32_t>(i) : index_[i]; }
    void visit(std::size_t first, std::size_t last, std::size_t range, Search& search) const;

    std::vector<Point> points_;         ///< in the tree's order
    std::vector<std::uint32_t> index_;  ///< of each, as they were given; empty: by place
    std::vector<std::uint8_t> axis_;
    /// Ways that the points of each large range face, as bits; the halves of range r are 2r + 1 and 2r + 2.
    std::vector<std::uint64_t> facing_;
};

}  // namespace render2mpeg::renderer
