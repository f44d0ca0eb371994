#include "core/plane.h"

#include <gtest/gtest.h>

#include <numeric>

#include "core/visible.h"

namespace render2mpeg::core {
namespace {

TEST(Plane, IsStoredRowByRowWithoutPadding) {
    Plane<int> plane(3, 2);
    std::iota(plane.values().begin(), plane.values().end(), 0);
    for (int y = 0; y < 2; ++y)
        for (int x = 0; x < 3; ++x) {
            EXPECT_EQ(plane.at(x, y), y * 3 + x);
            EXPECT_EQ(&plane.at(x, y), plane.row(y) + x);
        }
    EXPECT_EQ(plane.size(), 6u);
}

TEST(Plane, BeginsFilled) {
    const Plane<float> plane(5, 4, 2.5f);
    for (const float v : plane.values()) EXPECT_EQ(v, 2.5f);
}

TEST(Plane, WithoutRowsOrColumnsIsEmptyAndKeepsItsSize) {
    EXPECT_TRUE(Plane<int>().empty());
    const Plane<int> narrow(0, 7);
    EXPECT_TRUE(narrow.empty());
    EXPECT_EQ(narrow.height(), 7);
}

TEST(Plane, RefusesNegativeSizes) {
    EXPECT_THROW(Plane<int>(-1, 4), ContractViolation);
    EXPECT_THROW(Plane<int>(4, -1), ContractViolation);
}

TEST(Plane, EqualsOnlyTheSameShapeAndValues) {
    EXPECT_EQ(Plane<int>(2, 3, 1), Plane<int>(2, 3, 1));
    EXPECT_NE(Plane<int>(2, 3, 1), Plane<int>(3, 2, 1));
    EXPECT_NE(Plane<int>(2, 3, 1), Plane<int>(2, 3, 2));
}

TEST(Visible, BeginsWithNothingInFrontOfTheSky) {
    const Visible visible(7, 4, 3);
    EXPECT_EQ(visible.frame, 7);
    EXPECT_EQ(visible.width(), 4);
    EXPECT_EQ(visible.height(), 3);
    EXPECT_FALSE(visible.address.at(3, 2).is_surface());
    EXPECT_TRUE(std::isinf(visible.depth.at(0, 0)));
    EXPECT_EQ(visible.material.at(0, 0), no_id);
    EXPECT_EQ(visible.kind.at(0, 0), PixelClass::none);
}

}  // namespace
}  // namespace render2mpeg::core
