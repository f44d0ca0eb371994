#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/color.h"
#include "core/sampling.h"
#include "renderer/cut/stopping_rule.h"
#include "tests/renderer/film_stage.h"
#include "tests/renderer/lighting.h"

namespace render2mpeg::renderer {
namespace {

using test::FilmStage;
using test::furnished_room;
using test::SceneBuilder;

Settings stop_settings() {
    Settings settings = test::lightcuts_frame(48, 48);
    settings.vpls = 2000;
    settings.direct_points = 256;
    settings.max_cut = 1 << 20;
    return settings;
}

/// One for all tests of a process that only light frames of it: settling it and lighting its truth take longest.
FilmStage& shared_stage() {
    static FilmStage stage(furnished_room(), stop_settings());
    return stage;
}
const core::Radiance& shared_truth() {
    static const core::Radiance truth = shared_stage().reference();
    return truth;
}

/// Errors of all pixels in units of their tolerance, sorted.
std::vector<double> shares(const core::Radiance& truth, const core::Radiance& cut, const core::ToleranceMap& map) {
    std::vector<double> e;
    for (std::size_t i = 0; i < truth.combined.size(); ++i) {
        const double t = core::luminance(truth.combined.values()[i]), o = core::luminance(cut.combined.values()[i]);
        const core::Tolerance& tolerance = map.pixels.values()[i];
        const double allowed = std::max<double>(tolerance.absolute, tolerance.relative * t);
        if (allowed > 0) e.push_back(std::abs(o - t) / allowed);
    }
    std::sort(e.begin(), e.end());
    return e;
}

double share_over(const std::vector<double>& e) {
    return static_cast<double>(e.end() - std::upper_bound(e.begin(), e.end(), 1.0)) / static_cast<double>(e.size());
}

TEST(StoppingRule, KeepsItsToleranceInNinetyNineOfAHundredPixelsSlow) {
    FilmStage& stage = shared_stage();
    const core::Radiance& truth = shared_truth();
    for (const float tolerance : {0.01f, 0.02f, 0.04f, 0.08f, 0.26f}) {
        const auto map = core::ToleranceMap::uniform(48, 48, {0.0f, tolerance});
        const std::vector<double> e = shares(truth, stage.shade(0, map), map);
        ASSERT_GT(e.size(), 2000u);
        EXPECT_LE(share_over(e), 0.01) << tolerance;
        // A rule that never errs wastes rays.
        EXPECT_GT(e[e.size() * 99 / 100], 0.1) << tolerance;
    }
    EXPECT_EQ(stage.statistics().capped_points, 0u);
}

TEST(StoppingRule, KeepsEveryPixelsOwnToleranceSlow) {
    // Fine and coarse pixels alternate, so that every group holds both.
    const core::Radiance& truth = shared_truth();
    core::ToleranceMap map = core::ToleranceMap::uniform(48, 48, {0.0f, 0.3f});
    for (int y = 0; y < 48; ++y)
        for (int x = 0; x < 48; ++x)
            if ((x + y) % 2 == 0)
                map.pixels.at(x, y) = {0.02f * core::luminance(truth.combined.at(x, y)) + 1e-6f, 0.0f};
    const core::Radiance cut = shared_stage().shade(0, map);
    std::vector<double> fine;
    for (int y = 0; y < 48; ++y) {
        for (int x = y % 2; x < 48; x += 2) {
            const double t = core::luminance(truth.combined.at(x, y)), o = core::luminance(cut.combined.at(x, y));
            fine.push_back(std::abs(o - t) / static_cast<double>(map.pixels.at(x, y).absolute));
        }
    }
    std::sort(fine.begin(), fine.end());
    EXPECT_LE(share_over(fine), 0.01);
}

TEST(StoppingRule, RefinesLessWhereMoreIsToleratedSlow) {
    FilmStage& stage = shared_stage();
    std::uint64_t last = std::numeric_limits<std::uint64_t>::max();
    for (const float tolerance : {0.01f, 0.02f, 0.05f, 0.1f, 0.2f, 0.4f}) {
        const std::uint64_t before = stage.statistics().shadow_rays;
        stage.cut(tolerance);
        EXPECT_LT(stage.statistics().shadow_rays - before, last);
        last = stage.statistics().shadow_rays - before;
    }
}

TEST(StoppingRule, SaysByHowMuchEveryPixelMayErrSlow) {
    FilmStage stage(furnished_room(), stop_settings());
    EXPECT_FALSE(stage.cut(0.08f).error.empty()) << "whatever layers are wanted";
    stage.restart(true);
    const core::Radiance truth = stage.reference(), cut = stage.cut(0.08f);
    int within = 0, pixels = 0;
    for (std::size_t i = 0; i < truth.combined.size(); ++i) {
        const float light = core::luminance(truth.combined.values()[i]);
        const float off = std::abs(core::luminance(cut.combined.values()[i]) - light);
        const float exceeded_by_one_in_hundred = core::errors_of_one_in_hundred * cut.error.values()[i];
        within += off <= exceeded_by_one_in_hundred + 1e-5f * light ? 1 : 0;
        ++pixels;
        EXPECT_LE(exceeded_by_one_in_hundred, 0.095f * light);
        EXPECT_EQ(cut.capped.values()[i], 0);
        EXPECT_EQ(truth.error.values()[i], 0.0f);
    }
    EXPECT_GE(within, pixels * 98 / 100);
    Settings short_cuts = stop_settings();
    short_cuts.max_cut = 10;
    FilmStage capped(furnished_room(), short_cuts);
    capped.restart(true);
    const core::Radiance rough = capped.cut(0.01f);
    std::size_t stopped = 0;
    for (std::size_t i = 0; i < rough.combined.size(); ++i) {
        if (rough.capped.values()[i] == 0) continue;
        ++stopped;
        EXPECT_GT(core::errors_of_one_in_hundred * rough.error.values()[i],
                  0.005f * core::luminance(rough.combined.values()[i]));
    }
    EXPECT_GT(stopped, rough.combined.size() * 9 / 10);
}

/// One group of points on the floor of a box, among lamps that no clamp limits.
struct LampGroup {
    explicit LampGroup(const std::vector<glm::vec3>& lamps, float intensity) : stage(room(lamps, intensity)) {
        light_trees = stage.light({16, 0, 1, 0, GeometryClamp::none()});
        for (int i = 0; i < lane_count; ++i)
            points.push_back(stage.point_at(
                0, 0, {0.2f + 0.01f * static_cast<float>(i % 4), 0.2f + 0.01f * static_cast<float>(i / 4)}, {0, 1, 0}));
        const GatherPoint* pointers[lane_count];
        for (std::size_t i = 0; i < lane_count; ++i) pointers[i] = &points[i];
        fill(lanes, pointers);
    }
    static SceneBuilder room(const std::vector<glm::vec3>& lamps, float intensity) {
        SceneBuilder b;
        b.add_quad({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}, b.add_material(glm::vec3(0.5f)));
        for (const glm::vec3 lamp : lamps) b.add_point_light(lamp, intensity);
        return b;
    }
    GatheredLight gather(float absolute, float relative, const CutLimits& limits) {
        GroupTolerance tolerance{};
        for (int i = 0; i < lane_count; ++i) tolerance.absolute[i] = absolute, tolerance.relative[i] = relative;
        GatheredLight light;
        Gatherer(light_trees, stage.posed_scene().tracer()).gather(lanes, tolerance, limits, light);
        return light;
    }
    test::LitStage stage;
    LightTrees light_trees;
    std::vector<GatherPoint> points;
    GatherLanes lanes;
};

/// Lamps all about the group, so that it lies within the boxes of most clusters, where bounds have no bound.
std::vector<glm::vec3> cloud(int count) {
    std::vector<glm::vec3> lamps;
    for (std::uint64_t i = 0; i < static_cast<std::uint64_t>(count); ++i)
        lamps.push_back(
            {2 * core::uniform(1, i, 0) - 1, 0.5f * core::uniform(1, i, 1) - 0.05f, 2 * core::uniform(1, i, 2) - 1});
    return lamps;
}

TEST(CutBounds, CountLightByItsLumaOrHalfItsChroma) {
    LampGroup group(cloud(40), 1.0f);
    LightTree lamps = group.light_trees.trees[static_cast<int>(LightType::punctual)];
    ASSERT_GT(lamps.nodes.size(), 10u);
    const auto bound_of = [&](glm::vec3 color, int lane) {
        lamps.nodes.back().intensity = PackedLight(color);
        Lanes bound;
        bound_node(group.lanes, lamps, static_cast<std::uint32_t>(lamps.nodes.size() - 1), GeometryClamp::none(),
                   bound);
        return bound[lane];
    };
    for (int lane = 0; lane < lane_count; lane += 5) {
        const float white = bound_of(glm::vec3(1), lane);
        ASSERT_GT(white, 0.0f);
        EXPECT_NEAR(bound_of({0, 1, 0}, lane) / white, 0.7152f, 1e-3f);
        EXPECT_NEAR(bound_of({1, 0, 0}, lane) / white, 0.25f, 1e-3f);
        EXPECT_NEAR(bound_of({0, 0, 1}, lane) / white, 0.25f, 1e-3f);
        EXPECT_NEAR(bound_of({0.5f, 0.7f, 1}, lane) / white, 0.679f,
                    1e-3f);  // a sky's blue is no colour of its own yet
    }
}

TEST(StoppingRule, EndFiniteWhateverLightAndTolerance) {
    for (const float intensity : {1e-30f, 1.0f, 1e25f}) {
        LampGroup group(cloud(120), intensity);
        for (const float absolute : {0.0f, 1e-6f, std::numeric_limits<float>::infinity()}) {
            for (const float relative : {0.0f, 0.02f, 1e30f}) {
                const GatheredLight light = group.gather(absolute, relative, {8, 1 << 20});
                EXPECT_EQ(light.capped, 0u);
                for (int i = 0; i < lane_count; ++i) {
                    ASSERT_TRUE(std::isfinite(light.direct.r[i]));
                    ASSERT_GE(light.error[i], 0.0f);
                }
            }
        }
        // With no tolerance at all every lamp is a cluster of its own, but for those that send next to nothing.
        const GatheredLight exact = group.gather(0, 0, {8, 1 << 20});
        for (int i = 0; i < lane_count; ++i) EXPECT_LE(exact.error[i], 1e-30f);
    }
}

TEST(StoppingRule, TakeEqualLightsAtOnePlaceForOne) {
    LampGroup group(std::vector<glm::vec3>(100, glm::vec3(0.3f, 0.7f, 0.1f)), 2.0f);
    const GatheredLight light = group.gather(0, 0.02f, {8, 1000});
    EXPECT_EQ(light.direct_clusters, 1);
    EXPECT_EQ(light.capped, 0u);
    EXPECT_GT(light.direct.r[0], 0.0f);
}

TEST(StoppingRule, SayWhichPointsTheLargestCutLeftOut) {
    LampGroup group(cloud(200), 1.0f);
    const GatheredLight light = group.gather(0, 1e-3f, {8, 12});
    EXPECT_EQ(light.direct_clusters, 12);
    EXPECT_EQ(light.capped, 0xffffu);
    for (int i = 0; i < lane_count; ++i) EXPECT_GT(light.error[i], 0.0f);
    const GatheredLight enough = group.gather(0, 1e-3f, {8, 1000});
    EXPECT_EQ(enough.capped, 0u);
    for (int i = 0; i < lane_count; ++i) EXPECT_LT(enough.error[i], light.error[i]);
}

TEST(StoppingRule, GatherNothingFromNoLight) {
    LampGroup group(cloud(1), 1.0f);
    group.light_trees = {};
    const GatheredLight light = group.gather(0, 0, {8, 1000});
    EXPECT_EQ(light.direct_clusters + light.indirect_clusters, 0);
    EXPECT_EQ(light.direct.at(0), glm::vec3(0));
    EXPECT_EQ(light.error[0], 0.0f);
}

TEST(StoppingRule, TakesBoundsForLooserTheCoarserTheTolerance) {
    StoppingRule rule;
    const Lanes none{};
    GroupTolerance tolerance{};
    const Lanes& absolute = tolerance.absolute;
    Lanes light;
    for (int i = 0; i < lane_count; ++i) {
        tolerance.absolute[i] = 0.002f * std::pow(1.6f, static_cast<float>(i));
        light[i] = 1.0f;
    }
    rule.start(1.0f, tolerance);
    rule.observe(light);
    for (int i = 1; i < lane_count; ++i) {
        EXPECT_LT(rule.scale(i), rule.scale(i - 1));
        EXPECT_GT(rule.scale(i), 0.1f);
    }
    // As many clusters of one bound as fill the tolerance, and one more.
    for (int i = 0; i < lane_count; ++i) {
        const double fits = absolute[i] / rule.scale(i);
        double squares[lane_count] = {};
        squares[i] = 0.999 * fits * fits;
        EXPECT_TRUE(rule.satisfied(squares));
        squares[i] = 1.001 * fits * fits;
        EXPECT_FALSE(rule.satisfied(squares));
        // Many small clusters may add up to more than is tolerated; each by itself may fill a part of it safely.
        Lanes largest{};
        largest[i] = absolute[i];
        EXPECT_EQ(rule.broken(squares, largest), 1u << i);
        largest[i] = 0.14f * absolute[i];
        EXPECT_EQ(rule.broken(squares, largest), 0u);
    }
    // In the dark only the absolute tolerance is left, and it is a coarse one.
    rule.observe(none);
    EXPECT_LT(rule.scale(0), 0.37f);
}

TEST(StoppingRule, AllowsWhatThePixelsToleranceDoesAtTheLightSoFar) {
    StoppingRule rule;
    GroupTolerance tolerance{};
    Lanes light, allowed;
    for (int i = 0; i < lane_count; ++i) {
        const PointTolerance t{{0.1f, i % 2 == 0 ? 0.02f : 0.2f, 0.2f * static_cast<float>(i / 4)}, 0.1f};
        tolerance.set(i, t);
        light[i] = 0.05f * static_cast<float>(i);
        allowed[i] = t.allows(light[i]);
    }
    // An error just above it breaks it, one just below does not.
    rule.start(1.0f, tolerance);
    rule.observe(light);
    for (int i = 0; i < lane_count; ++i) {
        const double fits = allowed[i] / rule.scale(i);
        double squares[lane_count] = {};
        squares[i] = 0.999 * fits * fits;
        EXPECT_TRUE(rule.satisfied(squares)) << i;
        squares[i] = 1.001 * fits * fits;
        EXPECT_FALSE(rule.satisfied(squares)) << i;
    }
}

TEST(StoppingRule, RanksWhatHasNoMeasureAboveAllElse) {
    const float nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();
    StoppingRule rule;
    Lanes some, worst;
    GroupTolerance tolerance{};
    for (int i = 0; i < lane_count; ++i) some[i] = tolerance.relative[i] = 1.0f;
    rule.start(1.0f, tolerance);
    rule.observe(some);
    const float usual = rule.priority(some);
    for (const float bad : {nan, infinity}) {
        std::copy(std::begin(some), std::end(some), std::begin(worst));
        worst[3] = bad;
        EXPECT_TRUE(std::isfinite(rule.priority(worst)));
        EXPECT_GT(rule.priority(worst), 1e10f * usual);
    }
}

}  // namespace
}  // namespace render2mpeg::renderer
