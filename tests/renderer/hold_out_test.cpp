#include <gtest/gtest.h>

#include "core/color.h"
#include "core/sampling.h"
#include "renderer/cache/cache_lookup.h"
#include "renderer/cache/temporal_reuse.h"
#include "tests/renderer/lighting.h"
#include "tests/renderer/stage.h"

namespace render2mpeg::renderer {
namespace {

constexpr int tested_side = 48;
constexpr float tolerated = 0.08f;

/// A wall before a lamp, that fills the picture.
test::SceneBuilder lit_wall() {
    test::SceneBuilder b;
    b.add_quad({-2, -2, 0}, {4, 0, 0}, {0, 4, 0}, b.add_material({0.5f, 0.5f, 0.5f}));
    b.add_quad({-1, -1, 3}, {0, 2, 0}, {2, 0, 0}, b.add_emitter(glm::vec3(5)));
    b.add_camera({0, 0, 2}, {0, 0, 0});
    return b;
}

/// Frames of the wall, one after the other, by records and a validation that tests put in order.
class HoldOutFrames : public ::testing::Test {
  protected:
    HoldOutFrames()
        : stage_(lit_wall(), tested_side, tested_side),
          lit_(lit_wall()),
          light_trees_(lit_.light({})),
          seen_(stage_.see()) {
        tolerance_ = core::ToleranceMap::uniform(tested_side, tested_side, {0.0f, tolerated});
    }

    /// Records on every second pixel of every second row: the wall's light times `factor`, and a share of it off
    /// that to both sides by turns.
    void strew(float factor, float share) {
        for (const GatherTile& tile : seen_.tiles) {
            for (const GatherPoint& p : tile) {
                const auto at = stage_.world().camera.project(p.point.position);
                const int x = static_cast<int>(at->position.x), y = static_cast<int>(at->position.y);
                if (x % 2 != 0 || y % 2 != 0) continue;
                const test::Scattered all = test::gather_all(lit_, light_trees_, p);
                PointLight light;
                light.direct = glm::vec3(all.direct) / p.point.bsdf.diffuse * factor *
                               (1.0f + ((x / 2 + y / 2) % 2 == 0 ? share : -share));
                records_.insert(*record_of(p, light, {}, 1.0f, 0));
            }
        }
    }

    FrameLight light(std::int64_t frame) {
        CacheErrorModel model;
        model.cache_error_scale = validation_.cache_error_scale();
        model.reused = risen_;
        scene::Snapshot world = stage_.world();
        world.frame = frame;
        const UngatheredLight ungathered(seen_);
        const LightingContext context{light_trees_, stage_.tracer(),         seen_,
                                      ungathered,   world.camera.position(), tolerance_};
        FrameState state(context, world, {}, model, records_, nullptr);
        start(state, context, history_);
        light_points(state, validation_);
        FrameLight light = finish(state, history_);
        counts_ = state.counts;
        shade_counts_ = state.shade_counts;
        return light;
    }

    /// As from frames before, in all of which records were right.
    void learn_to_trust() {
        std::vector<HeldOutPoint> points;
        for (std::uint64_t i = 0; i < CacheValidation::least_points; ++i)
            points.push_back({core::uniform(3, i), 0.2f, 1});
        validation_.learn(points);
    }

    test::Stage stage_;
    test::LitStage lit_;
    LightTrees light_trees_;
    Frame seen_;
    core::ToleranceMap tolerance_;
    RecordStore records_;
    CacheValidation validation_;
    FrameHistory history_;
    float risen_ = 1;  ///< the error scale of cuts over that of the last frame
    CacheCounts counts_;
    ShadeCounts shade_counts_;
};

TEST_F(HoldOutFrames, SomeOfWhatRecordsServeIsGatheredAndFoundRight) {
    learn_to_trust();
    strew(1.0f, 0.01f);
    const FrameLight frame = light(1);
    EXPECT_GE(counts_.held_out, 40u);
    EXPECT_LE(counts_.held_out, 100u);
    EXPECT_EQ(counts_.missed, 0u);
    EXPECT_LE(validation_.cache_error_scale(), 1.0f);
    std::uint64_t held_out = 0;
    for (const auto& tile : frame)
        for (const PointLight& l : tile) held_out += l.held_out ? 1 : 0;
    EXPECT_EQ(held_out, counts_.held_out);
    EXPECT_GE(counts_.served, static_cast<std::uint64_t>(tested_side * tested_side) * 8 / 10);
}

TEST_F(HoldOutFrames, RecordsThatAreWrongServeNoLonger) {
    learn_to_trust();
    strew(1.3f, 0.04f);
    const FrameLight frame = light(1);
    EXPECT_GE(counts_.missed, counts_.held_out * 9 / 10);
    EXPECT_GT(validation_.cache_error_scale(), 1.2f);
    std::uint64_t served = 0;
    for (const auto& tile : frame) {
        for (const PointLight& l : tile) {
            served += l.served ? 1 : 0;
            EXPECT_LE(l.cache_error * validation_.cache_error_scale(), 1.0f);
        }
    }
    EXPECT_LE(served, static_cast<std::uint64_t>(tested_side * tested_side) / 2);
}

TEST_F(HoldOutFrames, TheSameFrameAgainIsTheSameAndShootsNoRay) {
    learn_to_trust();
    strew(1.3f, 0.04f);
    const FrameLight first = light(1);
    ASSERT_GT(validation_.cache_error_scale(), 1.0f);
    ASSERT_GT(shade_counts_.shadow_rays, 0u);
    const FrameLight second = light(2);
    EXPECT_EQ(shade_counts_.shadow_rays, 0u);
    EXPECT_EQ(counts_.held_out, 0u);
    for (std::size_t t = 0; t < first.size(); ++t)
        for (std::size_t i = 0; i < first[t].size(); ++i) EXPECT_EQ(first[t][i].direct, second[t][i].direct);
}

TEST_F(HoldOutFrames, LightIsReusedOnlyWithinItsToleranceByAnErrorScaleThatHasRisen) {
    light(0);
    light(1);
    ASSERT_EQ(shade_counts_.shadow_rays, 0u);
    risen_ = 100;
    const FrameLight frame = light(2);
    EXPECT_GT(shade_counts_.shadow_rays, 0u);
    for (std::size_t t = 0; t < frame.size(); ++t)
        for (std::size_t i = 0; i < frame[t].size(); ++i) {
            if (!frame[t][i].served || frame[t][i].age < 2.0f) continue;
            EXPECT_LE(frame[t][i].error, 1.01f * tolerated * core::luminance(frame[t][i].scattered(seen_.tiles[t][i])));
        }
}

TEST_F(HoldOutFrames, AFirstFrameIsValidatedTwice) {
    strew(1.0f, 0.01f);
    light(0);
    EXPECT_TRUE(validation_.knows());
    EXPECT_GE(counts_.held_out, CacheValidation::least_points);
    EXPECT_LE(validation_.cache_error_scale(), 1.0f);
}

}  // namespace
}  // namespace render2mpeg::renderer
