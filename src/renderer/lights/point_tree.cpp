#include "renderer/lights/point_tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "core/box.h"

namespace render2mpeg::renderer {
namespace {

/// So few points are looked at one after another. chosen: 8.
constexpr std::size_t few = 8;

/// Ways to face: nine on each side of a cube, three by three, so that what faces along an axis lies in the middle of
/// one, and floors do not look alike with walls.
constexpr std::size_t ways = 54;

/// The middle direction of each way, and how far from it directions of the way lie at most.
class Ways {
  public:
    Ways() {
        cosine_.fill(1.0f);
        for (std::size_t side = 0; side < 6; ++side)
            for (int row = 0; row < 3; ++row)
                for (int column = 0; column < 3; ++column) {
                    const std::size_t way = 9 * side + static_cast<std::size_t>(3 * row + column);
                    middle_[way] = towards(side, static_cast<float>(column - 1) * (2.0f / 3.0f),
                                           static_cast<float>(row - 1) * (2.0f / 3.0f));
                    for (const float u : {column - 1.5f, column - 0.5f})
                        for (const float v : {row - 1.5f, row - 0.5f}) {
                            const glm::vec3 corner = towards(side, u * (2.0f / 3.0f), v * (2.0f / 3.0f));
                            cosine_[way] = std::min(cosine_[way], glm::dot(corner, middle_[way]) - rounding);
                        }
                    sine_[way] = std::sqrt(1.0f - cosine_[way] * cosine_[way]);
                }
    }

    static std::size_t of(const glm::vec3& normal) {
        const glm::vec3 a = glm::abs(normal);
        const std::size_t axis = a.x >= a.y && a.x >= a.z ? 0 : a.y >= a.z ? 1 : 2;
        const auto along = static_cast<glm::length_t>(axis);
        const float third = a[along] * (1.0f / 3.0f);
        const auto part = [third](float v) -> std::size_t { return v < -third ? 0 : v > third ? 2 : 1; };
        return 9 * (2 * axis + (normal[along] < 0.0f ? 1 : 0)) + 3 * part(normal[(along + 2) % 3]) +
               part(normal[(along + 1) % 3]);
    }

    /// Those that may hold a direction whose cosine to `normal` exceeds `least`.
    std::uint64_t alike(const glm::vec3& normal, float least) const {
        if (!(least > -1.0f)) return ~std::uint64_t{0};
        const float sine = std::sqrt(std::max(1.0f - least * least, 0.0f));
        std::uint64_t found = 0;
        for (std::size_t way = 0; way < ways; ++way) {
            // cos(a + b), or everything where that is beyond a half turn.
            const float enough = least < -cosine_[way] ? -2.0f : least * cosine_[way] - sine * sine_[way];
            found |= std::uint64_t{glm::dot(normal, middle_[way]) > enough} << way;
        }
        return found;
    }

  private:
    /// More than cosines of unit vectors and sums of angles are off by.
    static constexpr float rounding = 1e-3f;

    static glm::vec3 towards(std::size_t side, float u, float v) {
        const auto axis = static_cast<glm::length_t>(side / 2);
        glm::vec3 d(0);
        d[axis] = side % 2 == 0 ? 1.0f : -1.0f;
        d[(axis + 1) % 3] = u;
        d[(axis + 2) % 3] = v;
        return glm::normalize(d);
    }

    std::array<glm::vec3, ways> middle_{};
    std::array<float, ways> cosine_{}, sine_{};  ///< of the widest angle
};

const Ways& all_ways() {
    static const Ways instance;
    return instance;
}

}  // namespace

struct PointTree::Search {
    OrientedPoint at;
    float least_facing;
    std::span<Neighbour> found;
    std::uint64_t ways;  ///< that what is looked for may face
    int count = 0;

    float reach() const {
        return count < static_cast<int>(found.size()) ? std::numeric_limits<float>::max() : found.back().distance2;
    }
    static bool nearer(const Neighbour& a, const Neighbour& b) {
        return a.distance2 != b.distance2 ? a.distance2 < b.distance2 : a.point < b.point;
    }
    void insert(Neighbour near) {
        if (count == static_cast<int>(found.size()) && !nearer(near, found.back())) return;
        int i = count < static_cast<int>(found.size()) ? count++ : count - 1;
        for (; i > 0 && nearer(near, found[static_cast<std::size_t>(i - 1)]); --i)
            found[static_cast<std::size_t>(i)] = found[static_cast<std::size_t>(i - 1)];
        found[static_cast<std::size_t>(i)] = near;
    }
};

PointTree::PointTree(const std::vector<OrientedPoint>& points)
    : points_(points.size()), index_(points.size()), axis_(points.size(), 0) {
    for (std::size_t i = 0; i < points.size(); ++i)
        points_[i] = {points[i].position, core::PackedNormal(points[i].normal)};
    std::iota(index_.begin(), index_.end(), 0u);
    build(0, index_.size(), 0);
    facing_.shrink_to_fit();
    std::vector<Point> ordered(points_.size());
    for (std::size_t i = 0; i < ordered.size(); ++i) ordered[i] = points_[index_[i]];
    points_.swap(ordered);
}

/// Returns the ways that its points face.
std::uint64_t PointTree::build(std::size_t first, std::size_t last, std::size_t range) {
    if (last == first) return 0;
    if (last - first == 1) return std::uint64_t{1} << Ways::of(points_[index_[first]].normal.unpack());
    core::Box box;
    for (std::size_t i = first; i < last; ++i) box.hold(points_[index_[i]].position);
    const int axis = box.longest_axis();
    const std::size_t middle = first + (last - first) / 2;
    const auto begin = index_.begin();
    std::nth_element(begin + static_cast<std::ptrdiff_t>(first), begin + static_cast<std::ptrdiff_t>(middle),
                     begin + static_cast<std::ptrdiff_t>(last), [&](std::uint32_t a, std::uint32_t b) {
                         const float pa = points_[a].position[axis], pb = points_[b].position[axis];
                         return pa != pb ? pa < pb : a < b;
                     });
    axis_[middle] = static_cast<std::uint8_t>(axis);
    const std::uint64_t facing = build(first, middle, 2 * range + 1) | build(middle + 1, last, 2 * range + 2) |
                                 std::uint64_t{1} << Ways::of(points_[index_[middle]].normal.unpack());
    if (last - first > few) {
        if (facing_.size() <= range) facing_.resize(range + 1, ~std::uint64_t{0});
        facing_[range] = facing;
    }
    return facing;
}

std::vector<std::uint32_t> PointTree::take_order() {
    return std::exchange(index_, {});
}

int PointTree::nearest(const OrientedPoint& at, float least_facing, std::span<Neighbour> found) const {
    Search search{at, least_facing, found, all_ways().alike(at.normal, least_facing)};
    if (!found.empty()) visit(0, points_.size(), 0, search);
    return search.count;
}

void PointTree::visit(std::size_t first, std::size_t last, std::size_t range, Search& search) const {
    const auto look = [&](std::size_t i) {
        const Point& candidate = points_[i];
        const glm::vec3 d = candidate.position - search.at.position;
        const float distance2 = glm::dot(d, d);
        if (distance2 <= search.reach() && candidate.normal.faces(search.at.normal, search.least_facing))
            search.insert({distance2, name(i)});
        return d;
    };
    if (last - first <= few) {
        for (std::size_t i = first; i < last; ++i) look(i);
        return;
    }
    if ((facing_[range] & search.ways) == 0) return;
    const std::size_t middle = first + (last - first) / 2;
    const glm::vec3 d = look(middle);
    // The side that holds the place first, the other only where it can hold something nearer.
    const float split = -d[axis_[middle]];
    const bool left_first = split < 0.0f;
    const auto left = [&] { visit(first, middle, 2 * range + 1, search); };
    const auto right = [&] { visit(middle + 1, last, 2 * range + 2, search); };
    left_first ? left() : right();
    if (split * split <= search.reach()) left_first ? right() : left();
}

}  // namespace render2mpeg::renderer
