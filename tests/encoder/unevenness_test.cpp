#include "encoder/unevenness.h"

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

TEST(Unevenness, ShiftsAreEven) {
    EXPECT_EQ(unevenness(uniform_motion(100, 60, 1, {31.5f, -7.25f})), 0.0);
}

TEST(Unevenness, IsTheChangeOfMotionOverAMacroblock) {
    EXPECT_NEAR(unevenness(zoom(160, 96, 0.03f)), 16 * 0.03, 1e-4);
}

TEST(Unevenness, IsThatOfOnePictureWhateverTheDistance) {
    core::MotionField field = zoom(160, 96, 0.03f);
    field.reference = field.picture + 4;
    EXPECT_NEAR(unevenness(field), 4 * 0.03, 1e-4);
}

TEST(Unevenness, EdgesOfThingsAndWhatHasNoMotionDoNotCount) {
    core::MotionField field = uniform_motion(128, 64, 1, {0, 0});
    for (int y = 0; y < 64; ++y)
        for (int x = 64; x < 128; ++x) field.vector.at(x, y) = {9.0f, 0};
    EXPECT_EQ(unevenness(field), 0.0);
    for (glm::vec2& v : field.vector.values()) v.y = std::nanf("");
    EXPECT_EQ(unevenness(field), 0.0);
    for (core::PixelClass& kind : field.kind.values()) kind = core::PixelClass::none;
    EXPECT_EQ(unevenness(field), 0.0);
    EXPECT_EQ(unevenness(uniform_motion(7, 5, 1, {1, 1})), 0.0);
}

TEST(Unevenness, IsAskedForAgainstAnotherPicture) {
    core::MotionField field = uniform_motion(32, 32, 1, {0, 0});
    field.reference = field.picture;
    EXPECT_THROW(unevenness(field), core::ContractViolation);
}

}  // namespace
}  // namespace render2mpeg::encoder::testing
