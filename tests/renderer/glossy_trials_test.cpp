#include "renderer/cache/glossy_trials.h"

#include <gtest/gtest.h>

namespace render2mpeg::renderer {
namespace {

/// Frames, of so many, in which a material took part of whose points so many of a hundred are served.
int frames_tried(GlossyTrials& trials, int frames, std::uint64_t served) {
    int tried = 0;
    for (int i = 0; i < frames; ++i) {
        if (trials.uses_cache(2)) {
            ++tried;
            trials.note(2, 100, served);
        }
        trials.judge();
    }
    return tried;
}

TEST(GlossyTrials, AMaterialThatIsServedStaysTried) {
    GlossyTrials trials;
    EXPECT_EQ(frames_tried(trials, 50, 40), 50);
}

TEST(GlossyTrials, AMaterialThatIsNotServedIsTriedForTwoFramesOfSixteen) {
    GlossyTrials trials;
    EXPECT_EQ(frames_tried(trials, 16, 20), 2);
    EXPECT_EQ(frames_tried(trials, 32, 20), 4);
}

TEST(GlossyTrials, TheFirstFrameSaysNothing) {
    GlossyTrials trials;
    trials.note(2, 100, 0);
    trials.judge();
    EXPECT_EQ(frames_tried(trials, 20, 40), 20);
}

TEST(GlossyTrials, FramesThatDoNotShowAMaterialSayNothing) {
    GlossyTrials trials;
    trials.note(2, 100, 50);
    trials.judge();
    for (int i = 0; i < 5; ++i) trials.judge();
    EXPECT_TRUE(trials.uses_cache(2));
    EXPECT_EQ(frames_tried(trials, 3, 40), 3);
}

TEST(GlossyTrials, OneBadFrameAfterGoodOnesIsForgiven) {
    GlossyTrials trials;
    ASSERT_EQ(frames_tried(trials, 10, 80), 10);
    trials.note(2, 100, 0);
    trials.judge();
    EXPECT_TRUE(trials.uses_cache(2));
    trials.note(2, 100, 0);
    trials.judge();
    EXPECT_FALSE(trials.uses_cache(2));
}

TEST(GlossyTrials, MaterialsAreJudgedEachForItself) {
    GlossyTrials trials;
    for (int i = 0; i < 2; ++i) {
        trials.note(0, 100, 90);
        trials.note(5, 100, 1);
        trials.judge();
    }
    EXPECT_TRUE(trials.uses_cache(0));
    EXPECT_TRUE(trials.uses_cache(3));
    EXPECT_FALSE(trials.uses_cache(5));
    trials.forget();
    EXPECT_TRUE(trials.uses_cache(5));
}

}  // namespace
}  // namespace render2mpeg::renderer
