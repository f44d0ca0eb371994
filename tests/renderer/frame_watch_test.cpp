#include <gtest/gtest.h>

#include "core/sampling.h"
#include "renderer/cache/frame_lighting.h"
#include "tests/renderer/lighting.h"
#include "tests/renderer/stage.h"

namespace render2mpeg::renderer {
namespace {

constexpr int picture_side = 48;
constexpr float tolerated = 0.08f;

/// A wall before a lamp, that fills the picture.
test::SceneBuilder lit_wall() {
    test::SceneBuilder b;
    b.add_quad({-2, -2, 0}, {4, 0, 0}, {0, 4, 0}, b.add_material({0.5f, 0.5f, 0.5f}));
    b.add_quad({-1, -1, 3}, {0, 2, 0}, {2, 0, 0}, b.add_emitter(glm::vec3(5)));
    b.add_camera({0, 0, 2}, {0, 0, 0});
    return b;
}

/// Frames of the wall, one after the other, by records and a watch that tests put in order.
class FrameWatch : public ::testing::Test {
  protected:
    FrameWatch()
        : stage_(lit_wall(), picture_side, picture_side),
          lit_(lit_wall()),
          light_trees_(lit_.light({})),
          seen_(stage_.see()) {
        tolerance_ = core::ToleranceMap::uniform(picture_side, picture_side, {0.0f, tolerated});
    }

    /// Records on every second pixel of every second row: the wall's light times `factor`, and a share of it off that
    /// to both sides by turns.
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
                records_.add(*record_of(p, light, {}, 1.0f, 0));
            }
        }
    }

    FrameLight light(std::int64_t frame) {
        RecordTrust trust;
        trust.strictness = watch_.strictness();
        counts_ = {};
        shade_counts_ = {};
        scene::Snapshot world = stage_.world();
        world.frame = frame;
        FrameLighting lighting(light_trees_, stage_.tracer(), seen_, world, {}, trust, trials_, records_);
        lighting.prepare(tolerance_, last_, moved_, frame - 1, false, shade_counts_);
        lighting.refine(watch_, shade_counts_, counts_);
        return lighting.take(last_, moved_, shade_counts_, counts_);
    }

    /// As from frames before, in all of which records were right.
    void trust() {
        std::vector<WatchedPoint> points;
        for (std::uint64_t i = 0; i < RecordWatch::least_points; ++i) points.push_back({core::uniform(3, i), 0.2f, 1});
        watch_.learn(points);
    }

    test::Stage stage_;
    test::LitStage lit_;
    LightTrees light_trees_;
    Seen seen_;
    core::ToleranceMap tolerance_;
    Records records_;
    LobeTrials trials_;
    RecordWatch watch_;
    RecordCache::LitTiles last_;
    MovedPoints moved_;
    RecordCounts counts_;
    ShadeCounts shade_counts_;
};

TEST_F(FrameWatch, SomeOfWhatRecordsServeIsGatheredAndFoundRight) {
    trust();
    strew(1.0f, 0.01f);
    const FrameLight frame = light(1);
    EXPECT_GE(counts_.watched, 40u);
    EXPECT_LE(counts_.watched, 100u);
    EXPECT_EQ(counts_.missed, 0u);
    EXPECT_LE(watch_.strictness(), 1.0f);
    std::uint64_t watched = 0;
    for (const auto& tile : frame)
        for (const PointLight& l : tile) watched += l.watched ? 1 : 0;
    EXPECT_EQ(watched, counts_.watched);
    EXPECT_GE(counts_.served, static_cast<std::uint64_t>(picture_side * picture_side) * 8 / 10);
}

TEST_F(FrameWatch, RecordsThatAreWrongServeNoLonger) {
    trust();
    strew(1.3f, 0.04f);
    const FrameLight frame = light(1);
    EXPECT_GE(counts_.missed, counts_.watched * 9 / 10);
    EXPECT_GT(watch_.strictness(), 1.2f);
    std::uint64_t served = 0;
    for (const auto& tile : frame) {
        for (const PointLight& l : tile) {
            served += l.served ? 1 : 0;
            EXPECT_LE(l.doubt * watch_.strictness(), 1.0f);
        }
    }
    EXPECT_LE(served, static_cast<std::uint64_t>(picture_side * picture_side) / 2);
}

TEST_F(FrameWatch, TheSameFrameAgainIsTheSameAndShootsNoRay) {
    trust();
    strew(1.3f, 0.04f);
    const FrameLight first = light(1);
    ASSERT_GT(watch_.strictness(), 1.0f);
    ASSERT_GT(shade_counts_.shadow_rays, 0u);
    const FrameLight second = light(2);
    EXPECT_EQ(shade_counts_.shadow_rays, 0u);
    EXPECT_EQ(counts_.watched, 0u);
    for (std::size_t t = 0; t < first.size(); ++t)
        for (std::size_t i = 0; i < first[t].size(); ++i) EXPECT_EQ(first[t][i].direct, second[t][i].direct);
}

TEST_F(FrameWatch, AFirstFrameIsWatchedTwice) {
    strew(1.0f, 0.01f);
    light(0);
    EXPECT_TRUE(watch_.knows());
    EXPECT_GE(counts_.watched, RecordWatch::least_points);
    EXPECT_LE(watch_.strictness(), 1.0f);
}

}  // namespace
}  // namespace render2mpeg::renderer
