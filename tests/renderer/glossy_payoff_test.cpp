#include "renderer/cache/glossy_payoff.h"

#include <gtest/gtest.h>

namespace render2mpeg::renderer {
namespace {

/// Frames, of so many, in which a material took part of whose points so many of a hundred are served.
int frames_tried(GlossyPayoff& payoff, int frames, std::uint64_t served) {
    int tried = 0;
    for (int i = 0; i < frames; ++i) {
        if (payoff.uses_cache(2)) {
            ++tried;
            payoff.note(2, 100, served);
        }
        payoff.judge();
    }
    return tried;
}

TEST(GlossyPayoff, AMaterialThatIsServedStaysTried) {
    GlossyPayoff payoff;
    EXPECT_EQ(frames_tried(payoff, 50, 40), 50);
}

TEST(GlossyPayoff, AMaterialThatIsNotServedIsTriedForTwoFramesOfSixteen) {
    GlossyPayoff payoff;
    EXPECT_EQ(frames_tried(payoff, 16, 20), 2);
    EXPECT_EQ(frames_tried(payoff, 32, 20), 4);
}

TEST(GlossyPayoff, TheFirstFrameSaysNothing) {
    GlossyPayoff payoff;
    payoff.note(2, 100, 0);
    payoff.judge();
    EXPECT_EQ(frames_tried(payoff, 20, 40), 20);
}

TEST(GlossyPayoff, FramesThatDoNotShowAMaterialSayNothing) {
    GlossyPayoff payoff;
    payoff.note(2, 100, 50);
    payoff.judge();
    for (int i = 0; i < 5; ++i) payoff.judge();
    EXPECT_TRUE(payoff.uses_cache(2));
    EXPECT_EQ(frames_tried(payoff, 3, 40), 3);
}

TEST(GlossyPayoff, OneBadFrameAfterGoodOnesIsForgiven) {
    GlossyPayoff payoff;
    ASSERT_EQ(frames_tried(payoff, 10, 80), 10);
    payoff.note(2, 100, 0);
    payoff.judge();
    EXPECT_TRUE(payoff.uses_cache(2));
    payoff.note(2, 100, 0);
    payoff.judge();
    EXPECT_FALSE(payoff.uses_cache(2));
}

TEST(GlossyPayoff, MaterialsAreJudgedEachForItself) {
    GlossyPayoff payoff;
    for (int i = 0; i < 2; ++i) {
        payoff.note(0, 100, 90);
        payoff.note(5, 100, 1);
        payoff.judge();
    }
    EXPECT_TRUE(payoff.uses_cache(0));
    EXPECT_TRUE(payoff.uses_cache(3));
    EXPECT_FALSE(payoff.uses_cache(5));
    payoff.forget();
    EXPECT_TRUE(payoff.uses_cache(5));
}

}  // namespace
}  // namespace render2mpeg::renderer
