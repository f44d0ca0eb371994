#include "renderer/point_tree.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

namespace render2mpeg::renderer {
namespace {

/// So few points are looked at one after another. chosen: 8.
constexpr std::size_t few = 8;

}  // namespace

struct PointTree::Search {
    OrientedPoint at;
    float least_facing;
    std::span<Neighbour> found;
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

PointTree::PointTree(std::vector<OrientedPoint> points)
    : points_(std::move(points)), index_(points_.size()), axis_(points_.size(), 0) {
    std::iota(index_.begin(), index_.end(), 0u);
    build(0, index_.size());
    std::vector<OrientedPoint> ordered(points_.size());
    for (std::size_t i = 0; i < ordered.size(); ++i) ordered[i] = points_[index_[i]];
    points_.swap(ordered);
}

void PointTree::build(std::size_t first, std::size_t last) {
    if (last - first < 2) return;
    glm::vec3 low = points_[index_[first]].position, high = low;
    for (std::size_t i = first; i < last; ++i) {
        low = glm::min(low, points_[index_[i]].position);
        high = glm::max(high, points_[index_[i]].position);
    }
    const glm::vec3 size = high - low;
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const std::size_t middle = first + (last - first) / 2;
    const auto begin = index_.begin();
    std::nth_element(begin + static_cast<std::ptrdiff_t>(first), begin + static_cast<std::ptrdiff_t>(middle),
                     begin + static_cast<std::ptrdiff_t>(last), [&](std::uint32_t a, std::uint32_t b) {
                         const float pa = points_[a].position[axis], pb = points_[b].position[axis];
                         return pa != pb ? pa < pb : a < b;
                     });
    axis_[middle] = static_cast<std::uint8_t>(axis);
    build(first, middle);
    build(middle + 1, last);
}

std::vector<std::uint32_t> PointTree::take_order() {
    return std::exchange(index_, {});
}

int PointTree::nearest(const OrientedPoint& at, float least_facing, std::span<Neighbour> found) const {
    Search search{at, least_facing, found};
    if (!found.empty()) visit(0, points_.size(), search);
    return search.count;
}

void PointTree::visit(std::size_t first, std::size_t last, Search& search) const {
    const auto look = [&](std::size_t i) {
        const OrientedPoint& candidate = points_[i];
        const glm::vec3 d = candidate.position - search.at.position;
        const float distance2 = glm::dot(d, d);
        if (distance2 <= search.reach() && glm::dot(candidate.normal, search.at.normal) > search.least_facing)
            search.insert({distance2, name(i)});
        return d;
    };
    if (last - first <= few) {
        for (std::size_t i = first; i < last; ++i) look(i);
        return;
    }
    const std::size_t middle = first + (last - first) / 2;
    const glm::vec3 d = look(middle);
    // The side that holds the place first, the other only where it can hold something nearer.
    const float split = -d[axis_[middle]];
    const bool left_first = split < 0.0f;
    left_first ? visit(first, middle, search) : visit(middle + 1, last, search);
    if (split * split <= search.reach()) left_first ? visit(middle + 1, last, search) : visit(first, middle, search);
}

}  // namespace render2mpeg::renderer
