#include "encoder/motion_nonuniformity.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/error.h"
#include "film.h"

namespace render2mpeg::encoder::testing {
namespace {

/// Motion away from the upper left corner: `growth` pixels per pixel.
core::MotionField zoom(int width, int height, float growth) {
    core::MotionField field = uniform_motion(width, height, 5, {0, 0});
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            field.vector.at(x, y) = growth * glm::vec2(static_cast<float>(x), static_cast<float>(y));
    return field;
}

TEST(MotionNonuniformity, ShiftsAreEven) {
    EXPECT_EQ(motion_nonuniformity(uniform_motion(100, 60, 1, {31.5f, -7.25f})), 0.0);
}

TEST(MotionNonuniformity, IsTheChangeOfMotionOverAMacroblock) {
    EXPECT_NEAR(motion_nonuniformity(zoom(160, 96, 0.03f)), 16 * 0.03, 1e-4);
}

TEST(MotionNonuniformity, IsThatOfOnePictureWhateverTheDistance) {
    core::MotionField field = zoom(160, 96, 0.03f);
    field.reference = field.picture + 4;
    EXPECT_NEAR(motion_nonuniformity(field), 4 * 0.03, 1e-4);
}

TEST(MotionNonuniformity, EdgesOfThingsAndWhatHasNoMotionDoNotCount) {
    core::MotionField field = uniform_motion(128, 64, 1, {0, 0});
    for (int y = 0; y < 64; ++y)
        for (int x = 64; x < 128; ++x) field.vector.at(x, y) = {9.0f, 0};
    EXPECT_EQ(motion_nonuniformity(field), 0.0);
    for (glm::vec2& v : field.vector.values()) v.y = std::nanf("");
    EXPECT_EQ(motion_nonuniformity(field), 0.0);
    for (core::PixelClass& kind : field.kind.values()) kind = core::PixelClass::none;
    EXPECT_EQ(motion_nonuniformity(field), 0.0);
    EXPECT_EQ(motion_nonuniformity(uniform_motion(7, 5, 1, {1, 1})), 0.0);
}

TEST(MotionNonuniformity, IsAskedForAgainstAnotherPicture) {
    core::MotionField field = uniform_motion(32, 32, 1, {0, 0});
    field.reference = field.picture;
    EXPECT_THROW(motion_nonuniformity(field), core::ContractViolation);
}

}  // namespace
}  // namespace render2mpeg::encoder::testing
