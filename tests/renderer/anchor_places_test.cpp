#include "renderer/lights/anchor_places.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/sampling.h"

namespace render2mpeg::renderer {
namespace {

/// Places evenly over a square of 10 x 10.
std::vector<OrientedPoint> square(std::uint64_t count, glm::vec3 normal = {0, 0, 1}, float z = 0) {
    std::vector<OrientedPoint> points;
    for (std::uint64_t i = 0; i < count; ++i)
        points.push_back({{core::halton(0, i) * 10, core::halton(1, i) * 10, z}, normal});
    return points;
}

std::vector<AnchorCandidate> candidates(const std::vector<OrientedPoint>& points) {
    std::vector<AnchorCandidate> all;
    for (const OrientedPoint& p : points) {
        AnchorCandidate c;
        c.address.object = 0;
        c.address.primitive = 0;
        c.rest = p;
        c.flux = 1;
        c.extent2 = 200;
        all.push_back(c);
    }
    return all;
}

double sum(const std::vector<float>& areas) {
    return std::accumulate(areas.begin(), areas.end(), 0.0);
}

TEST(CellAreas, CoverTheSurface) {
    const auto front = square(4000);
    const std::vector<float> areas = cell_areas(front, 0.0f);
    EXPECT_NEAR(sum(areas) / 100, 1.0, 0.1);
    // The other side of a thin wall is another surface.
    auto both = front;
    for (const OrientedPoint& p : square(4000, {0, 0, -1}, -1e-4f)) both.push_back(p);
    const std::vector<float> with_back = cell_areas(both, 0.0f);
    for (std::size_t i = 0; i < front.size(); ++i) EXPECT_EQ(with_back[i], areas[i]);
}

TEST(CellAreas, ScaleWithTheScene) {
    auto points = square(500);
    const std::vector<float> areas = cell_areas(points, 0.0f);
    for (OrientedPoint& p : points) p.position *= 64.0f;
    const std::vector<float> scaled = cell_areas(points, 0.0f);
    for (std::size_t i = 0; i < points.size(); ++i) EXPECT_EQ(areas[i] * 4096.0f, scaled[i]);
}

TEST(CellAreas, OfCoincidentOrSinglePlacesAreFinite) {
    std::vector<OrientedPoint> points(50);
    for (const float a : cell_areas(points, 3.0f)) EXPECT_TRUE(std::isfinite(a));
    points.resize(1);
    EXPECT_EQ(cell_areas(points, 3.0f), std::vector<float>{3.0f});
    EXPECT_TRUE(cell_areas({}, 3.0f).empty());
}

TEST(AnchorPlaces, LieEvenlyOverAnEvenlyLitSurface) {
    const std::vector<AnchorPlace> places = choose_places(candidates(square(4000)), 400);
    ASSERT_EQ(places.size(), 400u);
    // No cell of a 10 x 10 grid, which is due four anchors, has fewer than one or more than eight; dice would leave two
    // empty and two with nine or more.
    int cells[100] = {};
    for (const AnchorPlace& p : places)
        ++cells[std::min(9, static_cast<int>(p.rest.position.x)) * 10 +
                std::min(9, static_cast<int>(p.rest.position.y))];
    for (const int n : cells) {
        EXPECT_GE(n, 1);
        EXPECT_LE(n, 8);
    }
}

TEST(AnchorPlaces, FollowLightByHalfAndSurfaceByHalf) {
    // Nine tenths of all light lie on the left tenth: half of the anchors follow it, half the surface.
    auto all = candidates(square(8000));
    for (AnchorCandidate& c : all) c.flux = c.rest.position.x < 1.0f ? 81.0f : 1.0f;
    const std::vector<AnchorPlace> places = choose_places(all, 500);
    int left = 0;
    for (const AnchorPlace& p : places) left += p.rest.position.x < 1.0f ? 1 : 0;
    EXPECT_NEAR(left / 500.0, 0.5 * 0.9 + 0.5 * 0.1, 0.05);
}

TEST(AnchorPlaces, GiveEveryObjectThatMovesOneAtLeast) {
    auto all = candidates(square(2000));
    for (std::uint32_t object = 1; object <= 20; ++object) {
        AnchorCandidate c = all.front();
        c.group = object;
        c.flux = 0;
        all.push_back(c);
    }
    const std::vector<AnchorPlace> places = choose_places(all, 100);
    std::vector<int> of_group(21, 0);
    for (const AnchorPlace& p : places) {
        ++of_group[p.group];
        EXPECT_TRUE(std::isfinite(p.disc2));
        EXPECT_GT(p.disc2, 0.0f);
    }
    for (std::size_t g = 1; g <= 20; ++g) EXPECT_EQ(of_group[g], 1);
    EXPECT_NEAR(of_group[0], 100, 2);
}

TEST(AnchorPlaces, GiveEachWayInWhichLightMeetsAMoverOneAtLeast) {
    auto all = candidates(square(2000));
    const glm::vec3 ways[] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    for (std::uint32_t object = 1; object <= 3; ++object)
        for (const glm::vec3& way : ways) {
            AnchorCandidate c = all.front();
            c.group = object;
            c.rest.normal = way;
            c.flux = way.x < 0 ? 0.0f : 1e-9f;
            c.area_scale = 1e-9f;
            all.push_back(c);
        }
    std::vector<int> of_way(18, 0);
    for (const AnchorPlace& p : choose_places(all, 100)) {
        if (p.group == 0) continue;
        for (std::size_t w = 0; w < 6; ++w)
            if (p.rest.normal == ways[w]) ++of_way[6 * (p.group - 1) + w];
    }
    // The dark way needs none.
    for (std::size_t i = 0; i < of_way.size(); ++i) EXPECT_EQ(of_way[i], i % 6 == 1 ? 0 : 1) << i;
    // Where half of all anchors would not do, every object gets one.
    const std::vector<AnchorPlace> few = choose_places(all, 20);
    EXPECT_EQ(std::count_if(few.begin(), few.end(), [](const AnchorPlace& p) { return p.group != 0; }), 3);
}

TEST(AnchorPlaces, GiveAFewToPlacesThatNoLightWasSeenToReach) {
    // Light meets the left half of a square only; even places lie all over it.
    auto all = candidates(square(4000));
    std::erase_if(all, [](const AnchorCandidate& c) { return c.rest.position.x > 5.0f; });
    for (AnchorCandidate c : candidates(square(500))) {
        c.flux = 0;
        c.even = true;
        all.push_back(c);
    }
    int right = 0;
    for (const AnchorPlace& p : choose_places(all, 800)) right += p.rest.position.x > 5.0f ? 1 : 0;
    EXPECT_NEAR(right, 800 / 16 / 2, 8);
}

TEST(AnchorPlaces, AreAtMostAsManyAsCandidates) {
    EXPECT_TRUE(choose_places({}, 100).empty());
    EXPECT_EQ(choose_places(candidates(square(7)), 100).size(), 7u);
}

}  // namespace
}  // namespace render2mpeg::renderer
