#include "renderer/cache/record_watch.h"

#include <gtest/gtest.h>

#include "core/sampling.h"

namespace render2mpeg::renderer {
namespace {

/// Points of evenly spread doubts, of which a share of those with a doubt above a half is off.
std::vector<WatchedPoint> points(int count, float off, std::uint64_t seed, float share = 1.0f,
                                 float strictness = 1.0f) {
    std::vector<WatchedPoint> result;
    for (int i = 0; i < count; ++i) {
        const float doubt = core::uniform(seed, static_cast<std::uint64_t>(i)) / strictness;
        const bool missed = doubt > 0.5f && core::uniform(seed, static_cast<std::uint64_t>(i), 1) < off;
        result.push_back({doubt, missed ? 1.5f : 0.5f, share});
    }
    return result;
}

TEST(RecordWatch, TrustsWhileLittleIsKnown) {
    RecordWatch watch;
    watch.learn(points(static_cast<int>(RecordWatch::least_points) - 1, 1.0f, 1));
    EXPECT_FALSE(watch.knows());
    EXPECT_EQ(watch.strictness(), 1.0f);
}

TEST(RecordWatch, ExcludesTheDoubtsThatMissAndNoMore) {
    RecordWatch watch;
    for (std::uint64_t frame = 0; frame < 8; ++frame) watch.learn(points(256, 0.2f, frame, 1.0f, watch.strictness()));
    // Doubts above a half are served no longer; all others still are.
    EXPECT_GE(watch.strictness(), 1.8f);
    EXPECT_LE(watch.strictness(), 2.5f);
}

TEST(RecordWatch, SingleMissesAreChance) {
    RecordWatch watch;
    std::vector<WatchedPoint> few = points(256, 0.0f, 1);
    few[10].miss = few[20].miss = few[30].miss = 2.0f;
    watch.learn(few);
    EXPECT_EQ(watch.strictness(), 1.0f);
}

TEST(RecordWatch, WhereFewPointsAreServedFewOfAllAreOff) {
    RecordWatch watch;
    for (std::uint64_t frame = 0; frame < 8; ++frame) watch.learn(points(256, 0.1f, frame, 0.1f));
    EXPECT_LE(watch.strictness(), 1.0f);
}

TEST(RecordWatch, TrustComesBackStepByStepOnceNothingMisses) {
    RecordWatch watch;
    for (std::uint64_t frame = 0; frame < 8; ++frame) watch.learn(points(256, 0.3f, frame, 1.0f, watch.strictness()));
    const float strict = watch.strictness();
    ASSERT_GT(strict, 1.0f);
    for (std::uint64_t frame = 8; frame < 40; ++frame) watch.learn(points(256, 0.0f, frame, 1.0f, watch.strictness()));
    EXPECT_EQ(watch.strictness(), 0.5f) << "smoother than in naves";
}

TEST(RecordWatch, OfNothingItLearnsNothing) {
    RecordWatch watch;
    for (std::uint64_t frame = 0; frame < 8; ++frame) watch.learn(points(256, 0.3f, frame, 1.0f, watch.strictness()));
    watch.learn(points(2048, 0.0f, 8, 1.0f, watch.strictness()));
    const float strict = watch.strictness();
    ASSERT_GT(strict, 1.0f);
    for (int frame = 0; frame < 10; ++frame) watch.learn({});
    EXPECT_EQ(watch.strictness(), strict);
}

TEST(RecordWatch, ForgetsWithTheChunk) {
    RecordWatch watch;
    for (std::uint64_t frame = 0; frame < 8; ++frame) watch.learn(points(256, 0.3f, frame));
    watch.forget();
    EXPECT_EQ(watch.strictness(), 1.0f);
    EXPECT_FALSE(watch.knows());
}

}  // namespace
}  // namespace render2mpeg::renderer
