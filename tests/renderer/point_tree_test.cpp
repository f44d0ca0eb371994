#include "renderer/lights/point_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "core/sampling.h"

namespace render2mpeg::renderer {
namespace {

float point_dice(std::uint64_t seed, std::uint64_t i, std::uint64_t k) {
    return core::uniform(seed, i, k);
}

/// Points of a storey: a floor, walls, a few undersides of shelves, and a ball that faces every way.
std::vector<OrientedPoint> storey(std::uint64_t count) {
    std::vector<OrientedPoint> points;
    for (std::uint64_t i = 0; i < count; ++i) {
        const float u = 10 * point_dice(1, i, 0), v = 10 * point_dice(1, i, 1);
        if (i % 100 == 0)
            points.push_back({{u, 1, v}, {0, -1, 0}});
        else if (i % 4 == 0)
            points.push_back({{0, u, v}, {1, 0, 0}});
        else if (i % 4 == 1)
            points.push_back(
                {{5 + u / 10, v / 10, 5}, core::sample_sphere({point_dice(1, i, 2), point_dice(1, i, 3)})});
        else
            points.push_back({{u, 0, v}, {0, 1, 0}});
    }
    // As a tree keeps them.
    for (OrientedPoint& p : points) p.normal = core::PackedNormal(p.normal).unpack();
    return points;
}

std::vector<Neighbour> by_looking_at_all(const std::vector<OrientedPoint>& points, const OrientedPoint& at,
                                         float least_facing, std::size_t most) {
    std::vector<Neighbour> found;
    for (std::uint32_t i = 0; i < points.size(); ++i) {
        const glm::vec3 d = points[i].position - at.position;
        if (glm::dot(points[i].normal, at.normal) > least_facing) found.push_back({glm::dot(d, d), i});
    }
    std::sort(found.begin(), found.end(), [](const Neighbour& a, const Neighbour& b) {
        return a.distance2 != b.distance2 ? a.distance2 < b.distance2 : a.point < b.point;
    });
    found.resize(std::min(found.size(), most));
    return found;
}

TEST(PointTree, FindsWhatLookingAtAllFinds) {
    const std::vector<OrientedPoint> points = storey(3000);
    const PointTree tree(points);
    std::array<Neighbour, 12> found;
    for (const float least_facing : {0.5f, 0.99f, 0.0f, -0.7f, -2.0f}) {
        for (std::uint64_t i = 0; i < 200; ++i) {
            OrientedPoint at = points[i * 15];
            if (i % 3 == 0) at.normal = core::sample_sphere({point_dice(2, i, 0), point_dice(2, i, 1)});
            at.position += 0.1f * glm::vec3(point_dice(2, i, 2), point_dice(2, i, 3), point_dice(2, i, 4));
            const std::vector<Neighbour> expected = by_looking_at_all(points, at, least_facing, found.size());
            ASSERT_EQ(tree.nearest(at, least_facing, found), static_cast<int>(expected.size()));
            for (std::size_t k = 0; k < expected.size(); ++k) {
                ASSERT_EQ(found[k].point, expected[k].point) << least_facing << " " << i;
                ASSERT_EQ(found[k].distance2, expected[k].distance2);
            }
        }
    }
}

TEST(PointTree, NamesPointsByPlaceOnceItsOrderIsTaken) {
    const std::vector<OrientedPoint> points = storey(500);
    PointTree tree(points);
    const std::vector<std::uint32_t> order = tree.take_order();
    ASSERT_EQ(order.size(), points.size());
    std::array<Neighbour, 1> found;
    for (std::uint32_t i = 0; i < points.size(); ++i) {
        EXPECT_EQ(tree[i].position, points[order[i]].position);
        ASSERT_EQ(tree.nearest(tree[i], 0.5f, found), 1);
        EXPECT_EQ(found[0].point, i);
    }
}

TEST(PointTree, OfNothingOrOfCoincidentPointsIsWhole) {
    std::array<Neighbour, 4> found;
    EXPECT_EQ(PointTree().nearest({}, 0.5f, found), 0);
    const PointTree same(std::vector<OrientedPoint>(100));
    ASSERT_EQ(same.nearest({}, 0.5f, found), 4);
    for (std::uint32_t k = 0; k < 4; ++k) EXPECT_EQ(found[k].point, k);
    OrientedPoint back;
    back.normal = {0, 0, -1};
    EXPECT_EQ(same.nearest(back, 0.5f, found), 0);
}

}  // namespace
}  // namespace render2mpeg::renderer
