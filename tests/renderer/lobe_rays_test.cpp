#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "core/sampling.h"
#include "parallel/loops.h"
#include "tests/renderer/film_stage.h"
#include "tests/renderer/stage.h"

namespace render2mpeg::renderer {
namespace {

using test::FilmStage;
using test::SceneBuilder;

int add_metal(SceneBuilder& b, float roughness) {
    const int metal = b.add_material({1, 1, 1});
    b.material(metal).metallic = 1;
    b.material(metal).roughness = roughness;
    return metal;
}

Settings without_bounces(int width, int height) {
    Settings settings = test::small_frame(width, height);
    settings.vpls = 0;
    return settings;
}

class LobeFurnace : public testing::TestWithParam<float> {};

TEST_P(LobeFurnace, OfAMetalBallUnderAnEvenSkyHasOneColour) {
    SceneBuilder b;
    b.add_sphere({0, 0, 0}, 1, add_metal(b, GetParam()));
    b.film().sky.color = {1, 1, 1};
    b.add_camera({0, 0, 5}, {0, 0, 0}, 0.5f);
    FilmStage stage(b, without_bounces(24, 24));
    const Frame seen = stage.renderer().look(stage.at(0));
    int compared = 0;
    for (const core::Radiance& frame : {stage.reference(), stage.cut(0.02f)}) {
        for (std::size_t i = 0; i < frame.combined.size(); ++i) {
            if (seen.visible.kind.values()[i] != core::PixelClass::surface) continue;
            ++compared;
            ASSERT_NEAR(frame.combined.values()[i].y, 1.0f, 0.015f) << i % 24 << ", " << i / 24;
        }
    }
    EXPECT_GT(compared, 300);
}
INSTANTIATE_TEST_SUITE_P(Roughness, LobeFurnace, testing::Values(0.1f, 0.2f, 0.34f));

TEST(LobeRays, ShareTheSkyWithLightTreesWithoutLossSlow) {
    // So many points that each is narrower than what rays see alone.
    SceneBuilder b;
    b.add_quad({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}, add_metal(b, 0.3f));
    b.film().sky.color = {1, 1, 1};
    b.add_camera({0, 2, 3}, {0, 0, 0}, 0.3f);
    Settings settings = without_bounces(8, 8);
    for (const int points : {300, 20000, 80000}) {
        settings.direct_points = points;
        FilmStage stage(b, settings);
        const core::Radiance frame = stage.reference();
        for (const glm::vec3 light : frame.combined.values()) EXPECT_NEAR(light.y, 1.0f, 0.02f) << points;
    }
}

TEST(LobeRays, ShareASkyThatIsDividedUnevenlySlow) {
    // A satin floor in a black well, whose sky has most of its points at the zenith.
    SceneBuilder b;
    b.add_quad({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}, add_metal(b, 0.3f));
    const int black = b.add_material({0, 0, 0});
    b.material(black).double_sided = true;
    for (const float side : {-1.0f, 1.0f}) {
        b.add_quad({side, 0, -1}, {0, 0, 2}, {0, 4, 0}, black);
        b.add_quad({-1, 0, side}, {2, 0, 0}, {0, 4, 0}, black);
    }
    b.film().sky.color = {1, 1, 1};
    b.add_camera({0, 2, 0.5f}, {0, 0, 0}, 0.3f);
    Settings settings = without_bounces(8, 8);
    double few = 0;
    for (const int points : {300, 3000, 20000, 80000}) {
        settings.direct_points = points;
        FilmStage stage(b, settings);
        double mean = 0;
        const core::Radiance frame = stage.reference();
        for (const glm::vec3 light : frame.combined.values()) mean += light.y / 64.0;
        if (points == 300) few = mean;
        EXPECT_NEAR(mean, few, 0.035 * few) << points;  // chosen: measured 0.031
    }
    EXPECT_GT(few, 0.1);
}

/// A satin floor y = 0, and a black wall x = 0 that hides half of the sky.
SceneBuilder floor_by_a_wall() {
    SceneBuilder b;
    b.add_quad({-4, 0, 4}, {8, 0, 0}, {0, 0, -8}, add_metal(b, 0.3f));
    const int black = b.add_material({0, 0, 0});
    b.material(black).double_sided = true;
    b.add_quad({0, 0, 1000}, {0, 0, -2000}, {0, 1000, 0}, black);
    b.film().sky.color = {1, 1, 1};
    b.add_camera({1.5f, 3, 6}, {1.5f, 0, 0}, 0.4f);
    return b;
}

TEST(LobeRays, OfAFloorByAWallAreTheIntegralOfItsLobe) {
    const SceneBuilder b = floor_by_a_wall();
    Settings settings = without_bounces(24, 16);
    settings.samples = 1;
    FilmStage stage(b, settings);
    Frame seen = stage.renderer().look(stage.at(0));
    const core::Radiance frame = stage.reference();
    double mean = 0, squares = 0;
    int compared = 0;
    for (const GatherTile& tile : seen.tiles) {
        for (const GatherPoint& p : tile) {
            if (!p.point.bsdf.has_narrow_lobe()) continue;
            // The wall hides what is at its side.
            double expected = 0, all = 0;
            constexpr std::uint64_t count = 4096;
            for (std::uint64_t i = 0; i < count; ++i) {
                const LobeSample s = sample_glossy(p.point.bsdf, p.point.shading_normal, p.point.outgoing,
                                                   {core::halton(0, i), core::halton(1, i)});
                all += s.weight.y;
                expected += s.direction.x > 0.0f ? s.weight.y : 0.0f;
            }
            const auto t = static_cast<int>(&tile - seen.tiles.data());
            const int x = t % seen.tiles_across() * tile_size + p.pixel % tile_size;
            const int y = t / seen.tiles_across() * tile_size + p.pixel / tile_size;
            const double error = frame.combined.at(x, y).y - expected / all;
            mean += error;
            squares += error * error;
            ++compared;
        }
    }
    ASSERT_GT(compared, 100);
    EXPECT_LT(std::abs(mean / compared), 0.003);
    // chosen: measured 0.001 and 0.021, of an edge as sharp as there are.
    EXPECT_LT(std::sqrt(squares / compared), 0.025);
}

TEST(LobeRays, OfAFloorShowTheLightOfAWallSlow) {
    // A sun lights the wall x = 0 alone, along the floor: radiance 0.5 / pi x pi.
    SceneBuilder b;
    b.add_quad({0, 0, 2}, {4, 0, 0}, {0, 0, -4}, add_metal(b, 0.2f));
    b.add_quad({0, 0, 2}, {0, 0, -4}, {0, 3, 0}, b.add_material({0.5f, 0.5f, 0.5f}));
    b.add_sun({-1, 0, 0}, std::numbers::pi_v<float>);
    b.add_camera({5, 2, 0}, {1.5f, 0, 0}, 0.3f);
    Settings settings = without_bounces(24, 24);
    settings.vpls = 1000;
    settings.bounces = 1;
    FilmStage stage(b, settings);
    const Frame seen = stage.renderer().look(stage.at(0));
    const core::Radiance frame = stage.reference();
    double mean = 0, squares = 0;
    int compared = 0;
    for (std::size_t t = 0; t < seen.tiles.size(); ++t) {
        for (const GatherPoint& p : seen.tiles[t]) {
            if (!p.point.bsdf.has_narrow_lobe() || p.weight.x < 0.99f || std::abs(p.point.position.z) > 0.8f) continue;
            double expected = 0, all = 0;
            for (std::uint64_t i = 0; i < 1024; ++i) {
                const LobeSample s = sample_glossy(p.point.bsdf, p.point.shading_normal, p.point.outgoing,
                                                   {core::halton(0, i), core::halton(1, i)});
                const glm::vec3 met = p.point.position - s.direction * (p.point.position.x / s.direction.x);
                all += s.weight.y;
                expected += s.direction.x < 0 && met.y < 3 && std::abs(met.z) < 2 ? 0.5 * s.weight.y : 0.0;
            }
            const auto tile = static_cast<int>(t);
            const int x = tile % seen.tiles_across() * tile_size + p.pixel % tile_size;
            const int y = tile / seen.tiles_across() * tile_size + p.pixel / tile_size;
            const double error = frame.combined.at(x, y).y / (expected / all) - 1;
            mean += error;
            squares += error * error;
            ++compared;
        }
    }
    ASSERT_GT(compared, 100);
    // chosen: measured 0.007 and 0.05; a thousand VPLs are few.
    EXPECT_LT(std::abs(mean / compared), 0.02);
    EXPECT_LT(std::sqrt(squares / compared), 0.08);
}

/// Whether a ray from outside meets the box.
bool meets_box(glm::vec3 origin, glm::vec3 direction, glm::vec3 low, glm::vec3 high) {
    const glm::vec3 a = (low - origin) / direction, b = (high - origin) / direction;
    const glm::vec3 in = glm::min(a, b), out = glm::max(a, b);
    const float enters = std::max({in.x, in.y, in.z}), leaves = std::min({out.x, out.y, out.z});
    return enters > 0.0f && enters < leaves;
}

/// Sums over a floor's pixels: of what they show, of the integral of its lobe, of how far these are apart.
struct Compared {
    double sum = 0, expected = 0, error = 0;
};

/// `shown(p, direction, i)`: what the i-th of so many directions of the lobe shows from a point.
template <class Shown>
Compared beside_its_integral(FilmStage& stage, std::uint64_t directions, const Shown& shown) {
    const Frame seen = stage.renderer().look(stage.at(0));
    const core::Radiance frame = stage.reference();
    Compared c;
    for (std::size_t t = 0; t < seen.tiles.size(); ++t)
        for (const GatherPoint& p : seen.tiles[t]) {
            if (!p.point.bsdf.has_narrow_lobe() || p.point.shading_normal.y < 0.9f) continue;
            double sum = 0, all = 0;
            for (std::uint64_t i = 0; i < directions; ++i) {
                const LobeSample s = sample_glossy(p.point.bsdf, p.point.shading_normal, p.point.outgoing,
                                                   {core::halton(0, i), core::halton(1, i)});
                all += s.weight.y;
                sum += s.weight.y * shown(p.point, s.direction, i);
            }
            const glm::ivec2 at = seen.place_of(t, p.pixel);
            const double found = frame.combined.at(at.x, at.y).y;
            c.sum += found;
            c.expected += sum / all;
            c.error += std::abs(found - sum / all);
        }
    return c;
}

TEST(LobeRays, OfAFloorShowAShiningBoxHoweverFewLightPointsItHasSlow) {
    const glm::vec3 low(-0.3f, 0.2f, -0.3f), high(0.3f, 0.8f, 0.3f);
    SceneBuilder b;
    b.add_quad({-4, 0, 4}, {8, 0, 0}, {0, 0, -8}, add_metal(b, 0.2f));
    b.add_box(low, high, b.add_emitter({1, 1, 1}));
    b.add_camera({0, 1.6f, 4}, {0, 0, 1.2f}, 0.25f);
    for (const int points : {1, 8000}) {
        Settings settings = without_bounces(24, 24);
        settings.direct_points = points;
        settings.samples = 1;
        FilmStage stage(b, settings);
        const Compared c = beside_its_integral(stage, 1024, [&](const SurfacePoint& p, glm::vec3 to, std::uint64_t) {
            return meets_box(p.position, to, low, high) ? 1.0f : 0.0f;
        });
        RecordProperty("error_" + std::to_string(points), std::to_string(c.error / c.expected));
        EXPECT_GT(c.expected, 10.0);
        EXPECT_NEAR(c.sum / c.expected, 1.0, 0.005) << points;
        EXPECT_LT(c.error / c.expected, 0.02) << points;
    }
}

TEST(LobeRays, OfAFloorShowWhatAPolishedWallShowsSlow) {
    // The wall x = 0 mirrors a shining bar to the floor.
    const glm::vec3 low(2.5f, 1.6f, -1), high(2.6f, 1.9f, 1);
    SceneBuilder b;
    b.add_quad({0, 0, 2}, {2, 0, 0}, {0, 0, -4}, add_metal(b, 0.2f));
    b.add_quad({0, 0, 2}, {0, 0, -4}, {0, 3, 0}, add_metal(b, 0.15f));
    b.add_box(low, high, b.add_emitter({1, 1, 1}));
    b.add_camera({4, 1.5f, 0}, {1.2f, 0, 0}, 0.25f);
    Settings settings = without_bounces(16, 16);
    settings.samples = 1;
    settings.bounces = 1;
    settings.vpls = 1000;
    FilmStage stage(b, settings);
    const Compared c = beside_its_integral(stage, 4096, [&](const SurfacePoint& p, glm::vec3 to, std::uint64_t i) {
        const glm::vec3 met = p.position - to * (p.position.x / to.x);
        if (!(to.x < 0 && met.y < 3 && std::abs(met.z) < 2)) return 0.0f;
        Bsdf wall = p.bsdf;
        wall.alpha = 0.15f * 0.15f;
        const LobeSample s = sample_glossy(wall, {1, 0, 0}, -to, {core::halton(2, i), core::halton(3, i)});
        return meets_box(met, s.direction, low, high) ? s.weight.y : 0.0f;
    });
    RecordProperty("error", std::to_string(c.error / c.expected));
    RecordProperty("mean", std::to_string(c.sum / c.expected));
    EXPECT_GT(c.expected, 10.0);
    // chosen: measured 0.982, of which cells' 0.99 at most is half, and 0.026; by a lobe as wide as other cells' 0.37
    // and 0.68.
    EXPECT_NEAR(c.sum / c.expected, 1.0, 0.03);
    EXPECT_LT(c.error / c.expected, 0.06);
}

TEST(LobeRays, LeaveSoftSunsToLamps) {
    SceneBuilder b;
    b.add_quad({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}, add_metal(b, 0.3f));
    const glm::vec3 to_sun = glm::normalize(glm::vec3(0, 2, -3));
    const int sun = b.add_sun(-to_sun, 1);
    b.film().lights[static_cast<std::size_t>(sun)].angle = 0.02f;
    b.add_camera({0, 2, 3}, {0, 0, 0}, 0.1f);
    Settings settings = without_bounces(8, 8);
    settings.samples = 1;
    FilmStage stage(b, settings);
    const Frame seen = stage.renderer().look(stage.at(0));
    const core::Radiance frame = stage.reference();
    int compared = 0;
    for (const GatherPoint& p : seen.tiles[0]) {
        ASSERT_TRUE(p.point.bsdf.has_narrow_lobe());
        const SurfacePoint& s = p.point;
        const float expected = (evaluate(s.bsdf, s.shading_normal, s.outgoing, to_sun) * to_sun.y).y;
        EXPECT_NEAR(frame.combined.at(p.pixel % tile_size, p.pixel / tile_size).y, expected, 0.05f * expected);
        ++compared;
    }
    EXPECT_EQ(compared, 64);
}

TEST(LobeRays, AreTheSameForAnyNumberOfThreads) {
    std::optional<core::Radiance> one;
    for (const int threads : {1, 8}) {
        const parallel::ThreadLimit limit(threads);
        FilmStage stage(floor_by_a_wall(), without_bounces(24, 24));
        core::Radiance frame = stage.cut(0.02f);
        EXPECT_GT(stage.statistics().gather_rays, 10000u);
        if (!one) {
            one = std::move(frame);
            continue;
        }
        EXPECT_TRUE(test::same_bytes(*one, frame));
    }
}

TEST(LobeRays, AreAsManyAsTheToleranceAsksForSlow) {
    FilmStage coarse(floor_by_a_wall(), without_bounces(32, 32)), fine(floor_by_a_wall(), without_bounces(32, 32));
    coarse.cut(0.1f);
    fine.cut(0.005f);
    EXPECT_GT(fine.statistics().gather_rays, 2 * coarse.statistics().gather_rays);
}

TEST(LobeRays, AreMissedByNoEdgeOfALobeThatIsJustNotNarrow) {
    // Its pixels' mean alpha rounds to below that of narrow lobes.
    SceneBuilder b;
    b.add_sphere({0, 0, 0}, 1, add_metal(b, scene::narrow_roughness));
    b.film().sky.color = {1, 1, 1};
    b.add_camera({0, 0, 5}, {0, 0, 0}, 0.5f);
    Settings settings = test::small_frame(32, 32);
    settings.vpls = 1000;
    settings.samples = 4;
    settings.edge_samples = 16;
    FilmStage stage(b, settings);
    const Frame seen = stage.renderer().look(stage.at(0));
    const core::Radiance frame = stage.cut(0.02f);
    for (std::size_t i = 0; i < frame.combined.size(); ++i) {
        if (seen.visible.kind.values()[i] != core::PixelClass::surface) continue;
        EXPECT_GT(frame.combined.values()[i].y, 0.8f) << i % 32 << ", " << i / 32;
    }
}

TEST(LobeRays, AreInTheLayerOfLobes) {
    FilmStage stage(floor_by_a_wall(), without_bounces(24, 16));
    stage.restart(true);
    const Frame seen = stage.renderer().look(stage.at(0));
    const core::Radiance frame = stage.reference();
    int lit = 0;
    for (std::size_t i = 0; i < frame.combined.size(); ++i) {
        if (seen.visible.kind.values()[i] != core::PixelClass::surface) continue;
        EXPECT_NEAR(frame.glossy.values()[i].y + frame.emission.values()[i].y, frame.combined.values()[i].y, 1e-5f);
        lit += frame.glossy.values()[i].y > 0.5f ? 1 : 0;
    }
    EXPECT_GT(lit, 50);
}

TEST(LobeRays, AreNotTracedForOtherLobes) {
    SceneBuilder b;
    b.add_quad({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}, add_metal(b, 0.35f));
    b.film().sky.color = {1, 1, 1};
    b.add_camera({0, 2, 3}, {0, 0, 0}, 0.3f);
    test::Stage stage(b);
    EXPECT_FALSE(stage.plan().runs(Pass::lobe_rays));
    for (const GatherTile& tile : stage.see().tiles)
        for (const GatherPoint& p : tile) EXPECT_FALSE(p.point.bsdf.has_narrow_lobe());
}

}  // namespace
}  // namespace render2mpeg::renderer
