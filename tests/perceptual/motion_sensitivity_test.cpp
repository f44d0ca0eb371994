#include "perceptual/motion_sensitivity.h"

#include <gtest/gtest.h>

#include <limits>

namespace render2mpeg::perceptual {
namespace {

core::MotionField field_of(glm::vec2 v, int height = 90, std::int64_t away = -1) {
    core::MotionField field;
    field.picture = 10;
    field.reference = 10 + away;
    field.vector = core::Plane<glm::vec2>(16, height, v);
    field.kind = core::Plane<core::PixelClass>(16, height, core::PixelClass::surface);
    return field;
}

TEST(MotionSensitivity, IsOneWhereNothingMovesAndFallsWithSpeed) {
    EXPECT_DOUBLE_EQ(motion_sensitivity(field_of({0, 0}), 25), 1.0);
    double before = 1;
    for (const float speed : {2.0f, 8.0f, 32.0f, 128.0f}) {
        const double now = motion_sensitivity(field_of({speed, 0}), 25);
        EXPECT_LT(now, before);
        EXPECT_GT(now, 0);
        before = now;
    }
}

TEST(MotionSensitivity, IsThatOfTheSpeedOnTheRetina) {
    // 90 lines are 18.92 degrees: 4 pixels at 25 Hz are 21.03 degrees per second, of which 3.64 stay on the retina.
    EXPECT_NEAR(motion_sensitivity(field_of({0, 4}), 25), 2.15 / (3.635 + 2), 0.001);
    EXPECT_DOUBLE_EQ(motion_sensitivity(field_of({0, -4}), 25), motion_sensitivity(field_of({4, 0}), 25));
    EXPECT_NEAR(motion_sensitivity(field_of({8, 0}, 90, 2), 25), motion_sensitivity(field_of({4, 0}), 25), 1e-9)
        << "speed counts, not the way";
    EXPECT_NEAR(motion_sensitivity(field_of({8, 0}, 180), 25), motion_sensitivity(field_of({4, 0}), 25), 1e-9)
        << "as seen, not in pixels";
}

TEST(MotionSensitivity, TakesUnknownMotionForNone) {
    core::MotionField field = field_of({50, 0});
    field.kind = core::Plane<core::PixelClass>(16, 90, core::PixelClass::none);
    EXPECT_DOUBLE_EQ(motion_sensitivity(field, 25), 1.0);
    EXPECT_DOUBLE_EQ(motion_sensitivity(field_of({std::numeric_limits<float>::quiet_NaN(), 0}), 25), 1.0);
}

}  // namespace
}  // namespace render2mpeg::perceptual
