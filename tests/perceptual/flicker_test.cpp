#include "perceptual/pumping.h"

#include <gtest/gtest.h>

#include <limits>

namespace render2mpeg::perceptual {
namespace {

core::MotionField still(int width, int height) {
    core::MotionField field;
    field.vector = core::Plane<glm::vec2>(width, height, glm::vec2(0));
    field.kind = core::Plane<core::PixelClass>(width, height, core::PixelClass::surface);
    return field;
}

core::Plane<std::uint8_t> slope(int width, int height, int step, int from) {
    core::Plane<std::uint8_t> plane(width, height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) plane.at(x, y) = static_cast<std::uint8_t>(from + step * x);
    return plane;
}

TEST(Flicker, IsTheMeanChangeWhereNothingMoves) {
    const core::Plane<std::uint8_t> before(8, 6, 100), now(8, 6, 103);
    EXPECT_DOUBLE_EQ(change_along(still(8, 6), now, before), 3);
    EXPECT_DOUBLE_EQ(change_along(still(8, 6), before, now), 3) << "darker or brighter";
    EXPECT_DOUBLE_EQ(change_along(still(8, 6), now, now), 0);
}

TEST(Flicker, IsNoneWhereThingsOnlyMove) {
    // A slope that has gone a pixel and a half to the left: what is at x was at x + 1.5.
    core::MotionField motion = still(16, 4);
    for (glm::vec2& v : motion.vector.values()) v = {1.5f, 0};
    const core::Plane<std::uint8_t> before = slope(16, 4, 4, 50), now = slope(16, 4, 4, 56);
    EXPECT_NEAR(change_along(motion, now, before), 0, 1e-5);
    EXPECT_DOUBLE_EQ(change_along(still(16, 4), now, before), 6) << "seen without its motion it changes";
}

TEST(Flicker, CountsOnlyWhatHasAPlaceBefore) {
    core::MotionField motion = still(4, 1);
    motion.kind.at(0, 0) = core::PixelClass::none;
    motion.vector.at(1, 0) = {-1.01f, 0};
    motion.vector.at(1, 0).x -= 1;
    motion.vector.at(2, 0) = {std::numeric_limits<float>::quiet_NaN(), 0};
    core::Plane<std::uint8_t> now(4, 1, 200), before(4, 1, 100);
    now.at(3, 0) = 101;
    EXPECT_DOUBLE_EQ(change_along(motion, now, before), 1) << "the last alone";
    for (core::PixelClass& kind : motion.kind.values()) kind = core::PixelClass::none;
    EXPECT_DOUBLE_EQ(change_along(motion, now, before), 0);
}

}  // namespace
}  // namespace render2mpeg::perceptual
