#include "renderer/cut/cut_outline.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/sampling.h"
#include "tests/renderer/lighting.h"

namespace render2mpeg::renderer {
namespace {

using test::LitStage;
using test::SceneBuilder;

/// Two groups of points side by side on a floor under many lamps, before a wall.
class Neighbours {
  public:
    Neighbours() : stage_(room()) {
        light_trees_ = stage_.light({16, 0, 1, 0, GeometryClamp::none()});
        for (int g = 0; g < 2; ++g) {
            for (int i = 0; i < lane_count; ++i)
                points_[g].push_back(
                    stage_.point_at(0, 0,
                                    {0.25f + 0.04f * static_cast<float>(g) + 0.01f * static_cast<float>(i % 4),
                                     0.3f + 0.01f * static_cast<float>(i / 4)},
                                    {0, 1, 0}));
            const GatherPoint* pointers[lane_count];
            for (std::size_t i = 0; i < lane_count; ++i) pointers[i] = &points_[g][i];
            fill(lanes_[g], pointers);
            lanes_[g].set = g;
        }
        Gatherer(light_trees_, tracer()).gather_all(lanes_[1], truth_);
    }

    /// The second group's light, by a tolerance, with the splits of the first group's cut by another.
    GatheredLight gather(Stop stop, float relative, float neighbours, int most = 4000) {
        Gatherer gatherer(light_trees_, tracer());
        const CutLimits limits{8, most, stop};
        GatheredLight light;
        CutOutline outline;
        if (neighbours > 0) {
            gatherer.gather(lanes_[0], tolerance(neighbours), limits, light);
            gatherer.outline(lanes_[0], outline);
            EXPECT_GT(outline.splits.size(), 20u);
        }
        gatherer.gather(lanes_[1], tolerance(relative), limits, light, neighbours > 0 ? &outline : nullptr);
        return light;
    }
    /// The largest error over what it may be.
    float worst(const GatheredLight& light, float relative) const {
        float worst = 0;
        for (int i = 0; i < lane_count; ++i)
            worst = std::max(worst, std::abs(light.direct.at(i).y / truth_.direct.at(i).y - 1) / relative);
        return worst;
    }

  private:
    static SceneBuilder room() {
        SceneBuilder b;
        const int grey = b.add_material(glm::vec3(0.5f));
        b.add_quad({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}, grey);
        b.add_quad({0.1f, 0, -1}, {0, 0.4f, 0}, {0, 0, 2}, grey);
        for (std::uint64_t i = 0; i < 2000; ++i) {
            const auto u = [&](std::uint64_t k) { return core::uniform(5, i, k); };
            b.add_point_light({2 * u(0) - 1, 0.2f + 0.5f * u(1), 2 * u(2) - 1}, 0.5f + u(3));
        }
        return b;
    }
    static GroupTolerance tolerance(float relative) {
        GroupTolerance t{};
        std::fill(std::begin(t.relative), std::end(t.relative), relative);
        return t;
    }
    const RayTracer& tracer() const { return stage_.posed_scene().tracer(); }

    LitStage stage_;
    LightTrees light_trees_;
    std::vector<GatherPoint> points_[2];
    GatherLanes lanes_[2];
    GatheredLight truth_;
};

class CutOutlines : public testing::TestWithParam<Stop> {};

TEST_P(CutOutlines, GiveTheSameCutButForFewClusters) {
    Neighbours groups;
    for (const float t : {0.02f, 0.1f}) {
        const GatheredLight own = groups.gather(GetParam(), t, 0), begun = groups.gather(GetParam(), t, t);
        EXPECT_EQ(begun.capped, 0u);
        EXPECT_GE(begun.direct_clusters, own.direct_clusters * 97 / 100) << t;
        EXPECT_LE(begun.direct_clusters, own.direct_clusters * 106 / 100) << t;
        for (int i = 0; i < lane_count; ++i) {
            EXPECT_LE(begun.error[i], t * begun.direct.at(i).y) << i;
            EXPECT_NEAR(begun.direct.at(i).y, own.direct.at(i).y, t * own.direct.at(i).y) << i;
        }
        EXPECT_LT(groups.worst(begun, t), 1.5f * groups.worst(own, t) + 0.2f) << t;
    }
}

TEST_P(CutOutlines, OfStricterNeighboursCostLooserGroupsLittleAndOfLooserOnesNothing) {
    Neighbours groups;
    const int own = groups.gather(GetParam(), 0.1f, 0).direct_clusters;
    const int after_strict = groups.gather(GetParam(), 0.1f, 0.01f).direct_clusters;
    const int after_loose = groups.gather(GetParam(), 0.1f, 0.4f).direct_clusters;
    EXPECT_GE(after_strict, own * 97 / 100);
    EXPECT_LE(after_strict, own * 112 / 100);
    EXPECT_NEAR(after_loose, own, 0.03 * own);
}
TEST_P(CutOutlines, LeaveRoomForOwnSplitsWhereNoCutIsLargeEnough) {
    Neighbours groups;
    constexpr int most = 150;
    const GatheredLight own = groups.gather(GetParam(), 1e-4f, 0, most),
                        begun = groups.gather(GetParam(), 1e-4f, 1e-4f, most);
    EXPECT_EQ(own.direct_clusters, most);
    EXPECT_EQ(begun.direct_clusters, most);
    EXPECT_NE(begun.capped, 0u);
    EXPECT_LT(groups.worst(begun, 1e-4f), 1.25f * groups.worst(own, 1e-4f));
    float most_own = 0, most_begun = 0;
    for (int i = 0; i < lane_count; ++i) {
        most_own = std::max(most_own, own.error[i]);
        most_begun = std::max(most_begun, begun.error[i]);
    }
    EXPECT_LT(most_begun, 1.1f * most_own) << "its own largest bounds are split";
}

TEST_P(CutOutlines, OfWhoToleratesNothingAreNotForThoseWhoDo) {
    Neighbours groups;
    const int own = groups.gather(GetParam(), 0.3f, 0).direct_clusters;
    EXPECT_LE(groups.gather(GetParam(), 0.3f, 1e-7f).direct_clusters, own * 3 / 2);
}
INSTANTIATE_TEST_SUITE_P(Rules, CutOutlines, testing::Values(Stop::classic, Stop::honest));

}  // namespace
}  // namespace render2mpeg::renderer
