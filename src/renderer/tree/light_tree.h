#pragma once
// The light tree: clusters of light points, their representatives and bounds.
#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <span>
#include <vector>

#include "core/packed_normal.h"
#include "renderer/base/isa_clones.h"
#include "renderer/base/light_packing.h"
#include "renderer/base/light_point.h"

namespace render2mpeg::renderer {

/// A node of a light tree: a light (a leaf) or an inner node.
class LightRef {
  public:
    LightRef() = default;
    static LightRef leaf(std::uint32_t light) { return LightRef(light | leaf_bit); }
    static LightRef inner(std::uint32_t node) { return LightRef(node); }
    bool is_leaf() const { return (value_ & leaf_bit) != 0; }
    std::uint32_t index() const { return value_ & ~leaf_bit; }
    bool operator==(const LightRef&) const = default;

  private:
    static constexpr std::uint32_t leaf_bit = 0x80000000u;
    explicit LightRef(std::uint32_t value) : value_(value) {}
    std::uint32_t value_ = 0;
};

/// A light as the inner loop reads it: 32 bytes, half a cache line.
struct alignas(32) TreeLight {
    glm::vec3 position{0};  ///< world; directional: unit direction to the light
    float disc2 = 0;        ///< see LightPoint::disc2; punctual: squared range, infinite for none
    glm::vec3 intensity{0};
    core::PackedNormal axis;  ///< its normal; directional: unused

    glm::vec3 normal() const { return axis.unpack(); }
};

/// Sets of representatives: in each, every node has one of its lights, one of its children's. Whoever gathers takes one
/// set; neighbouring pixels take different ones, so that their errors are not alike (docs/model/lightcut.md). chosen: 4
/// of 1, 4 and 16 (docs/decisions.md#representative-sets).
inline constexpr int representative_sets = 4;

/// The least and largest TreeLight::disc2 below a node, rounded outwards to the upper half of a float: by 0.8 % at
/// most.
class Disc2Range {
  public:
    Disc2Range() = default;
    Disc2Range(float least, float largest);
    RENDER2MPEG_ALWAYS_INLINED float least() const { return __builtin_bit_cast(float, std::uint32_t{least_} << 16); }
    RENDER2MPEG_ALWAYS_INLINED float largest() const {
        return __builtin_bit_cast(float, std::uint32_t{largest_} << 16);
    }
    bool operator==(const Disc2Range&) const = default;

  private:
    std::uint16_t least_ = 0, largest_ = 0;
};

/// The half angle of a cone as the sine of its half, rounded up: by 3e-5 rad where it is narrow.
class PackedCone {
  public:
    PackedCone() = default;
    explicit PackedCone(float half_angle);
    RENDER2MPEG_ALWAYS_INLINED float cosine() const {
        const float sine = sine_ * (1.0f / 65535.0f);
        return 1.0f - 2.0f * sine * sine;
    }
    bool operator==(const PackedCone&) const = default;

  private:
    std::uint16_t sine_ = 0;
};

/// An inner node: 48 bytes. Its two children, its representatives and what bounds need.
class LightNode {
  public:
    LightNode() = default;
    /// Node `self` of a tree whose nodes and lights lie in depth-first order, parents before children.
    void set_children(std::uint32_t self, LightRef first, LightRef second);
    RENDER2MPEG_ALWAYS_INLINED LightRef child(std::uint32_t self, int side) const {
        // In depth-first order the first child, and a second one that follows a light, come next: of the two only one
        // place is not known.
        const std::uint32_t place = children_ & ~(first_is_leaf | second_is_leaf);
        const bool leaf = (children_ & first_is_leaf) != 0;
        if (side == 0) return leaf ? LightRef::leaf(place) : LightRef::inner(self + 1);
        if ((children_ & second_is_leaf) != 0) return LightRef::leaf(leaf ? place + 1 : place);
        return LightRef::inner(leaf ? self + 1 : place);
    }

    PackedBox box;          ///< holds all positions (directional: directions), in steps of LightTree::grid
    PackedLight intensity;  ///< summed
    /// Of each set: what stands for the child that does not keep the node's representative, as its distance from
    /// that in the tree's lights; `far_away` where it is too far. Looked up where a cut splits the node, since walking
    /// down would wait for memory at each step.
    std::int16_t other_representative[representative_sets] = {far_away, far_away, far_away, far_away};
    static constexpr std::int16_t far_away = -0x8000;
    /// Bit k: the representative of set k is that of the first child; chosen by dice in proportion to intensity.
    std::uint16_t first_represents = 0xf;
    PackedCone cone;  ///< about `axis`, holds all normals
    core::PackedNormal axis;
    Disc2Range disc2;

  private:
    static constexpr std::uint32_t first_is_leaf = 0x80000000u, second_is_leaf = 0x40000000u;
    std::uint32_t children_ = 0;
};
static_assert(sizeof(TreeLight) == 32 && sizeof(LightNode) == 48);

/// A binary tree over light points of one type [Walter2005, 4.1], clustered bottom up. Plain data, fixed once built.
struct LightTree {
    LightType type = LightType::oriented;
    std::vector<LightNode> nodes;   ///< in depth-first order, parents before children
    std::vector<TreeLight> lights;  ///< in the same
    std::vector<Spot> spots;        ///< of punctual lights; else none
    /// LightPoint::id of each light; its topology's, where it was built from one.
    std::shared_ptr<const std::vector<std::uint32_t>> ids;
    BoxGrid grid;   ///< of the nodes' boxes
    LightRef root;  ///< meaningless where there are no lights

    bool empty() const { return lights.empty(); }
    glm::vec3 intensity(LightRef ref) const {
        if (ref.is_leaf()) return lights[ref.index()].intensity;
        glm::vec3 sum;
        nodes[ref.index()].intensity.unpack(sum.x, sum.y, sum.z);
        return sum;
    }
    LightRef child(std::uint32_t node, int side) const { return nodes[node].child(node, side); }
    MiddleBox box(std::uint32_t node) const {
        MiddleBox box;
        nodes[node].box.unpack(grid, box.middle.x, box.middle.y, box.middle.z, box.half.x, box.half.y, box.half.z);
        return box;
    }
    /// Null where lights have no cone.
    const Spot* spot(std::uint32_t light) const { return spots.empty() ? nullptr : &spots[light]; }
    /// The light that stands for a node in a set, 0..representative_sets - 1.
    std::uint32_t representative(LightRef ref, int set = 0) const {
        while (!ref.is_leaf()) ref = child(ref.index(), first_represents(ref, set) ? 0 : 1);
        return ref.index();
    }
    /// The light that stands for an inner node's other child, which does not keep its representative `own`.
    std::uint32_t other_representative(LightRef inner, std::uint32_t own, int set) const {
        const LightNode& node = nodes[inner.index()];
        const std::int16_t distance = node.other_representative[set];
        if (distance != LightNode::far_away) return own + static_cast<std::uint32_t>(std::int32_t{distance});
        return representative(child(inner.index(), first_represents(inner, set) ? 1 : 0), set);
    }
    /// Whether an inner node's representative is its first child's.
    bool first_represents(LightRef inner, int set) const {
        return (nodes[inner.index()].first_represents >> set & 1u) != 0;
    }
    /// Bytes held beside ids, for the budget per light.
    std::size_t bytes() const {
        return nodes.capacity() * sizeof(LightNode) + lights.capacity() * sizeof(TreeLight) +
               spots.capacity() * sizeof(Spot);
    }
};

/// Fills the nodes' `other_representative` from their bits; children come after their parents.
void cache_representatives(LightTree& tree);

/// Builds a tree over `points`, which are all of `type`; lights without intensity are left out, and coincident ones
/// that shine alike become one. The result is a function of the arguments alone. O(n log n).
LightTree build_light_tree(LightType type, std::span<const LightPoint> points, std::uint64_t seed);

/// The same, to be updated: dark and coincident lights stay lights of their own. Ids are unique.
LightTree build_persistent_tree(LightType type, std::span<const LightPoint> points, std::uint64_t seed);

/// Who is whose child in a persistent tree, and nothing else: 4.25 bytes per light, since nodes in depth-first order
/// need only say which of their children are lights.
struct TreeTopology {
    LightType type = LightType::oriented;
    std::vector<bool> leaves;  ///< of each node, whether its first and whether its second child is a light
    std::shared_ptr<const std::vector<std::uint32_t>> ids;  ///< of lights, in the tree's order

    std::size_t lights() const { return ids ? ids->size() : 0; }
    std::size_t bytes() const;
};
TreeTopology topology_of(const LightTree& tree);

/// The persistent tree of a topology, updated by these points (`update_light_tree`).
LightTree build_from_topology(const TreeTopology& topology, std::span<const LightPoint> points, std::uint64_t seed);

/// Gives the lights of a persistent tree places and intensities of `points` with the same ids, none of either where
/// there is no such point, and every node its bounds, sum and representative (docs/model/lights.md). Who is whose
/// child stays; a function of that, the points and the seed, whatever was updated before. O(n log n), a tenth of the
/// time of building.
void update_light_tree(LightTree& tree, std::span<const LightPoint> points, std::uint64_t seed);

}  // namespace render2mpeg::renderer
