#include "perceptual/tolerance.h"

#include <gtest/gtest.h>

namespace render2mpeg::perceptual {
namespace {

TEST(HandedOn, LeavesPicturesAloneThatNothingDependsOn) {
    EXPECT_EQ(propagation_factor(true, 0), 1.0f);
    EXPECT_EQ(propagation_factor(false, 0), 1.0f);
}

TEST(HandedOn, IsLessTheMorePicturesInheritAndLeastInIntraPictures) {
    for (std::int64_t n = 1; n <= 14; ++n) {
        EXPECT_LT(propagation_factor(true, n), propagation_factor(true, n - 1)) << n;
        EXPECT_LT(propagation_factor(false, n), propagation_factor(false, n - 1)) << n;
        EXPECT_LT(propagation_factor(true, n), propagation_factor(false, n)) << n;
    }
}

TEST(HandedOn, ShrinksNoFurtherInGopsLongerThanThoseTried) {
    EXPECT_EQ(propagation_factor(true, 300), propagation_factor(true, 14));
    EXPECT_GT(propagation_factor(true, 300), 0.0f);
}

}  // namespace
}  // namespace render2mpeg::perceptual
