#include "renderer/cache/cache_validation.h"

#include <gtest/gtest.h>

#include "core/sampling.h"

namespace render2mpeg::renderer {
namespace {

/// Points of evenly spread doubts, of which a share of those with a doubt above a half is off.
std::vector<HeldOutPoint> points(int count, float off, std::uint64_t seed, float share = 1.0f,
                                 float cache_error_scale = 1.0f) {
    std::vector<HeldOutPoint> result;
    for (int i = 0; i < count; ++i) {
        const float doubt = core::uniform(seed, static_cast<std::uint64_t>(i)) / cache_error_scale;
        const bool missed = doubt > 0.5f && core::uniform(seed, static_cast<std::uint64_t>(i), 1) < off;
        result.push_back({doubt, missed ? 1.5f : 0.5f, share});
    }
    return result;
}

TEST(CacheValidation, TrustsWhileLittleIsKnown) {
    CacheValidation watch;
    watch.learn(points(static_cast<int>(CacheValidation::least_points) - 1, 1.0f, 1));
    EXPECT_FALSE(watch.knows());
    EXPECT_EQ(watch.cache_error_scale(), 1.0f);
}

TEST(CacheValidation, ExcludesTheDoubtsThatMissAndNoMore) {
    CacheValidation watch;
    for (std::uint64_t frame = 0; frame < 8; ++frame)
        watch.learn(points(256, 0.2f, frame, 1.0f, watch.cache_error_scale()));
    // Doubts above a half are served no longer; all others still are.
    EXPECT_GE(watch.cache_error_scale(), 1.8f);
    EXPECT_LE(watch.cache_error_scale(), 2.5f);
}

TEST(CacheValidation, SingleMissesAreChance) {
    CacheValidation watch;
    std::vector<HeldOutPoint> few = points(256, 0.0f, 1);
    few[10].error = few[20].error = few[30].error = 2.0f;
    watch.learn(few);
    EXPECT_EQ(watch.cache_error_scale(), 1.0f);
}

TEST(CacheValidation, WhereFewPointsAreServedFewOfAllAreOff) {
    CacheValidation watch;
    for (std::uint64_t frame = 0; frame < 8; ++frame) watch.learn(points(256, 0.1f, frame, 0.1f));
    EXPECT_LE(watch.cache_error_scale(), 1.0f);
}

TEST(CacheValidation, TrustComesBackStepByStepOnceNothingMisses) {
    CacheValidation watch;
    for (std::uint64_t frame = 0; frame < 8; ++frame)
        watch.learn(points(256, 0.3f, frame, 1.0f, watch.cache_error_scale()));
    const float strict = watch.cache_error_scale();
    ASSERT_GT(strict, 1.0f);
    for (std::uint64_t frame = 8; frame < 40; ++frame)
        watch.learn(points(256, 0.0f, frame, 1.0f, watch.cache_error_scale()));
    EXPECT_EQ(watch.cache_error_scale(), 0.5f) << "smoother than in naves";
}

TEST(CacheValidation, OfNothingItLearnsNothing) {
    CacheValidation watch;
    for (std::uint64_t frame = 0; frame < 8; ++frame)
        watch.learn(points(256, 0.3f, frame, 1.0f, watch.cache_error_scale()));
    watch.learn(points(2048, 0.0f, 8, 1.0f, watch.cache_error_scale()));
    const float strict = watch.cache_error_scale();
    ASSERT_GT(strict, 1.0f);
    for (int frame = 0; frame < 10; ++frame) watch.learn({});
    EXPECT_EQ(watch.cache_error_scale(), strict);
}

TEST(CacheValidation, ForgetsWithTheChunk) {
    CacheValidation watch;
    for (std::uint64_t frame = 0; frame < 8; ++frame) watch.learn(points(256, 0.3f, frame));
    watch.forget();
    EXPECT_EQ(watch.cache_error_scale(), 1.0f);
    EXPECT_FALSE(watch.knows());
}

}  // namespace
}  // namespace render2mpeg::renderer
