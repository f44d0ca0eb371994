#include "perceptual/share.h"

#include <gtest/gtest.h>

namespace render2mpeg::perceptual {
namespace {

TEST(HandedOn, LeavesPicturesAloneThatNothingDependsOn) {
    EXPECT_EQ(handed_on(true, 0), 1.0f);
    EXPECT_EQ(handed_on(false, 0), 1.0f);
}

TEST(HandedOn, IsLessTheMorePicturesInheritAndLeastInIntraPictures) {
    for (std::int64_t n = 1; n <= 14; ++n) {
        EXPECT_LT(handed_on(true, n), handed_on(true, n - 1)) << n;
        EXPECT_LT(handed_on(false, n), handed_on(false, n - 1)) << n;
        EXPECT_LT(handed_on(true, n), handed_on(false, n)) << n;
    }
}

TEST(HandedOn, ShrinksNoFurtherInGopsLongerThanThoseTried) {
    EXPECT_EQ(handed_on(true, 300), handed_on(true, 14));
    EXPECT_GT(handed_on(true, 300), 0.0f);
}

}  // namespace
}  // namespace render2mpeg::perceptual
