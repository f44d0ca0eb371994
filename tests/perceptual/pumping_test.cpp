#include "perceptual/pumping.h"

#include <gtest/gtest.h>

#include <cmath>

namespace render2mpeg::perceptual {
namespace {

using Errors = core::Plane<std::int16_t>;

core::MotionField moved_by(int width, int height, glm::vec2 vector) {
    core::MotionField field;
    field.vector = core::Plane<glm::vec2>(width, height, vector);
    field.kind = core::Plane<core::PixelClass>(width, height, core::PixelClass::surface);
    return field;
}

TEST(Pumping, IsTheChangeOfBlocksMeanErrors) {
    const Errors before(64, 32, 1);
    EXPECT_DOUBLE_EQ(pumping(nullptr, Errors(64, 32, 4), before).value(), 3);
    EXPECT_DOUBLE_EQ(pumping(nullptr, Errors(64, 32, -2), before).value(), 3) << "darker or brighter";
    EXPECT_DOUBLE_EQ(pumping(nullptr, before, before).value(), 0) << "an error that stays is not seen to move";

    // One block of eight changes by 4: the root of 16/8.
    Errors now = before;
    for (int y = 0; y < 16; ++y)
        for (int x = 16; x < 32; ++x) now.at(x, y) = 5;
    EXPECT_DOUBLE_EQ(pumping(nullptr, now, before).value(), std::sqrt(2.0));
}

TEST(Pumping, IsNoneWhereDetailAloneIsOff) {
    // Errors that change everywhere, but whose mean over each block does not.
    Errors now(32, 32);
    for (int y = 0; y < 32; ++y)
        for (int x = 0; x < 32; ++x) now.at(x, y) = static_cast<std::int16_t>((x + y) % 2 == 0 ? 5 : -5);
    EXPECT_DOUBLE_EQ(pumping(nullptr, now, Errors(32, 32, 0)).value(), 0);
}

TEST(Pumping, FollowsWhatMoves) {
    // The error is 8 on what moves 16 pixels to the right.
    Errors before(64, 16), now(64, 16);
    for (int y = 0; y < 16; ++y)
        for (int x = 0; x < 16; ++x) before.at(x + 16, y) = now.at(x + 32, y) = 8;
    const core::MotionField motion = moved_by(64, 16, {-16, 0});
    EXPECT_NEAR(pumping(&motion, now, before).value(), 0, 1e-6);
    EXPECT_DOUBLE_EQ(pumping(nullptr, now, before).value(), std::sqrt(32.0));
}

TEST(Pumping, CountsOnlyBlocksThatWereThere) {
    // Each of the two blocks changes by its own amount; the first is half known, then less than half.
    Errors now(32, 16, 2);
    for (int y = 0; y < 16; ++y)
        for (int x = 0; x < 16; ++x) now.at(x, y) = 6;
    const Errors before(32, 16, 0);
    core::MotionField motion = moved_by(32, 16, {0, 0});
    for (int x = 0; x < 16; ++x)
        for (int y = 0; y < 8; ++y) motion.kind.at(x, y) = core::PixelClass::none;
    EXPECT_NEAR(pumping(&motion, now, before).value(), std::sqrt(20.0), 1e-6);
    motion.kind.at(0, 8) = core::PixelClass::none;
    EXPECT_NEAR(pumping(&motion, now, before).value(), 2, 1e-6);
    for (core::PixelClass& kind : motion.kind.values()) kind = core::PixelClass::none;
    EXPECT_EQ(pumping(&motion, now, before), std::nullopt);
}

TEST(Pumping, ALightsChangeLeavesOutWhatShowsSomethingElse) {
    const core::Plane<std::uint8_t> before(64, 16, 100);
    core::Plane<std::uint8_t> now(64, 16, 102);
    for (int y = 0; y < 16; ++y)
        for (int x = 0; x < 16; ++x) {
            now.at(x, y) = 97;
            now.at(x + 16, y) = 150;
        }
    EXPECT_NEAR(light_change(nullptr, now, before).value(), (3 + 2 + 2) / 3.0, 1e-9);
    EXPECT_EQ(light_change(nullptr, core::Plane<std::uint8_t>(64, 16, 180), before), std::nullopt);
}

TEST(Pumping, HoldsForPicturesThatEndWithinBlocks) {
    const core::Plane<std::uint8_t> source(20, 18, 100), decoded(20, 18, 97);
    const Errors error = luma_error(decoded, source);
    EXPECT_EQ(error.at(19, 17), -3);
    EXPECT_DOUBLE_EQ(pumping(nullptr, error, luma_error(source, source)).value(), 3);
}

}  // namespace
}  // namespace render2mpeg::perceptual
