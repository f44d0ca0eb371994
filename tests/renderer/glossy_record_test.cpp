#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/color.h"
#include "renderer/cache/gather_requests.h"
#include "tests/renderer/film_stage.h"
#include "tests/renderer/record_wall.h"

namespace render2mpeg::renderer {
namespace {

TEST_F(Wall, LobesThatOneEyeSawAreFoundBetweenRecords) {
    // From pixel to pixel half vectors turn by a twelfth of the lobe's width.
    const auto light = [](glm::vec2 at) { return 1.0f + 0.05f * at.x - 0.03f * at.y; };
    strew(4, light);
    polish(stage_.world().camera.position());
    int found = 0;
    for (int y = 5; y < 19; ++y) {
        for (int x = 5; x < 19; ++x) {
            const auto e = estimate_polished(point_at(x, y), 0.02f);
            if (!e) continue;
            ++found;
            const float expected = light({static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f});
            EXPECT_NEAR(e->glossy.x, expected, 1e-3f * expected) << x << ", " << y;
        }
    }
    EXPECT_GE(found, 14 * 14 * 8 / 10);
}

TEST_F(Wall, LobesThatAnotherEyeSawServeByHowFarItWas) {
    // Two away, an eye that moves by 0.05 turns half vectors by a twentieth of the width, one that moves by 3 by more
    // than all of it.
    const auto holds = [&](float moved, float relative) {
        records_.forget();
        strew(2, [](glm::vec2) { return 1.0f; });
        polish(stage_.world().camera.position() + glm::vec3(moved, 0, 0));
        return estimate_polished(point_at(12, 12), relative).has_value();
    };
    EXPECT_TRUE(holds(0.0f, 0.01f));
    EXPECT_FALSE(holds(0.05f, 0.02f));
    EXPECT_TRUE(holds(0.05f, 0.04f));
    EXPECT_TRUE(holds(0.3f, 0.2f));
    EXPECT_FALSE(holds(3.0f, 10.0f));
}

TEST_F(Wall, LobesThatFollowWhatTheyShowServeHoweverFarTheEyeWent) {
    // Of what white metal shows nothing stays behind, of paint the irradiance does.
    const auto error = [&](float moved, float matt) {
        records_.forget();
        strew(2, [](glm::vec2) { return 1.0f; });
        const glm::vec3 eye = stage_.world().camera.position() + glm::vec3(moved, 0, 0);
        polish(eye);
        for (std::uint32_t i = 0; i < records_.size(); ++i) {
            IrradianceRecord& r = records_.change(i);
            r.indirect = glm::vec3(matt);
            r.lobe.depth = glm::distance(eye, r.position) / (1.0f + matt);
        }
        map_.build(records_.all(), stage_.world().camera);
        const auto found = estimate_polished(point_at(12, 12), 10.0f, matt > 0.0f ? 1.0f : 0.0f);
        return found ? found->error.value : -1.0f;
    };
    EXPECT_NEAR(error(0.3f, 0.0f), 0.0f, 1e-3f);
    // Half of the turn that a point behind the wall by its part of the light is seen by: 0.3 of 2 + 1.
    EXPECT_NEAR(error(0.3f, 1.0f), 0.23f * 0.5f * 0.5f * (0.3f / 3.0f) / lobe_width, 0.002f);
}

TEST_F(Wall, LobesOfBentSurfacesErrByWhatAPlaneMisses) {
    // Normals that turn by a sixth of a width from pixel to pixel, and light with them, at the picture's rim.
    const auto light = [](glm::vec2 at) { return 20.0f + 2.0f * (at.x - 12.5f); };
    strew(1, light);
    polish(stage_.world().camera.position());
    for (std::uint32_t i = 0; i < records_.size(); ++i) {
        IrradianceRecord& r = records_.change(i);
        const float across = stage_.world().camera.project(r.position)->position.x - 12.5f;
        r.shading_normal = glm::normalize(glm::vec3(across * lobe_width / 6.0f, 0, 1));
    }
    map_.build(records_.all(), stage_.world().camera);
    const auto found = estimate_polished(point_at(12, 0), 0.1f);
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->glossy.x, 20.0f, 0.01f);
    EXPECT_LT(found->error.value, 0.005f);
}

TEST_F(Wall, RoundLobesTakeRecordsHoweverNarrowTheyAre) {
    GatherPoint p = point_at(12, 12);
    EXPECT_TRUE(uses_cache(p));
    p.point.bsdf = {glm::vec3(0.5f), glm::vec3(0.04f), 0.1f * 0.1f};
    EXPECT_TRUE(uses_cache(p));
    p.point.bsdf.along = {1, 0, 0};
    EXPECT_FALSE(uses_cache(p));
    p.path = renderer::extended_path(p.path, true);
    EXPECT_FALSE(uses_cache(p)) << "in a mirror as well";
}

/// A floor under an even sky, half of which a dark wall hides, past which the camera goes.
test::SceneBuilder glossy_floor(float roughness) {
    test::SceneBuilder b;
    const int metal = b.add_material({1, 1, 1});
    b.material(metal).metallic = 1;
    b.material(metal).roughness = roughness;
    b.add_quad({-20, 0, 20}, {40, 0, 0}, {0, 0, -40}, metal);
    b.add_quad({-20, 0, -4}, {20, 0, 0}, {0, 20, 0}, b.add_material({0.2f, 0.2f, 0.2f}));
    b.film().sky.color = {1, 1, 1};
    b.add_camera({0, 1.5f, 4}, {0, 0.3f, 0}, 0.4f);
    b.add_track(scene::TrackTarget::translation, b.film().cameras[0].node, 3, {0, 10},
                {0.0f, 1.5f, 4.0f, 0.2f, 1.5f, 4.0f});
    return b;
}

class GlossyFloor : public testing::TestWithParam<float> {};

TEST_P(GlossyFloor, IsServedByRecordsAndShowsTheWallWhereItIsSlow) {
    Settings s = test::small_frame(96, 64);
    test::FilmStage kept(glossy_floor(GetParam()), s);
    s.cache = CacheUse::off;
    test::FilmStage alone(glossy_floor(GetParam()), s);
    std::uint64_t served = 0, points = 0;
    for (int second = 0; second < 3; ++second) {
        const core::Radiance frame = kept.shade(second, core::ToleranceMap::uniform(96, 64, {0.0f, 0.1f})),
                             fine = alone.shade(second, core::ToleranceMap::uniform(96, 64, {0.0f, 0.02f}));
        double sum = 0, expected = 0, square = 0;
        for (std::size_t i = 0; i < frame.combined.size(); ++i) {
            const float light = core::luminance(frame.combined.values()[i]),
                        wanted = core::luminance(fine.combined.values()[i]);
            sum += light;
            expected += wanted;
            square += (light - wanted) * (light - wanted);
        }
        EXPECT_NEAR(sum / expected, 1.0, 0.01) << second;
        EXPECT_LT(std::sqrt(square / static_cast<double>(frame.combined.size())), 0.05) << second;
        if (second == 0) served = kept.statistics().cache.served, points = kept.statistics().gather_points;
    }
    served = kept.statistics().cache.served - served;
    points = kept.statistics().gather_points - points;
    EXPECT_GT(static_cast<double>(served), 0.6 * static_cast<double>(points));
}
INSTANTIATE_TEST_SUITE_P(Roughness, GlossyFloor, testing::Values(0.1f, 0.15f, 0.3f));

TEST_F(Wall, LobesLieWhereTheirReflectionIsSeen) {
    strew(2, [](glm::vec2) { return 1.0f; });
    const scene::Camera& camera = stage_.world().camera;
    const glm::vec3 eye = camera.position() + glm::vec3(0.1f, 0, 0);
    polish(eye);
    for (std::uint32_t i = 0; i < records_.size(); ++i)
        records_.change(i).lobe.depth = glm::distance(eye, records_[i].position);
    map_.build(records_.all(), camera);
    ASSERT_GT(map_.size(), 50u);
    for (const SurfaceMark& m : map_.marks()) {
        // As far behind the wall as this eye is before it, half of its way is seen on it.
        const glm::vec3 place = m.position - glm::vec3(0.05f, 0, 0);
        const auto seen = camera.project(place);
        EXPECT_NEAR(m.at.x, seen->position.x, 1e-2f);
        EXPECT_NEAR(m.at.y, seen->position.y, 1e-2f);
    }
}

/// A ball under an even sky. Its rim has few records, of few rays at first.
core::Radiance ball_by(CacheUse cache) {
    test::SceneBuilder b;
    const int paint = b.add_material({0.25f, 0.02f, 0.02f});
    b.material(paint).specular_glossiness = false;
    b.material(paint).metallic = 0.4f;
    b.material(paint).roughness = 0.35f;
    b.add_sphere({0, 0, 0}, 1, paint, 32);
    b.film().sky.color = glm::vec3(1);
    b.add_camera({0, 0.5f, 4}, {0, 0, 0}, 0.6f);
    Settings s = test::small_frame(64, 64);
    s.cache = cache;
    test::FilmStage stage(b, s);
    return stage.shade(0, core::ToleranceMap::uniform(64, 64, {0.0f, 0.02f}));
}

TEST(GlossyBalls, HaveNoBlackSpecksAtTheirRims) {
    const core::Radiance kept = ball_by(CacheUse::static_light), alone = ball_by(CacheUse::off);
    float worst = 1;
    for (std::size_t i = 0; i < kept.combined.size(); ++i)
        worst =
            std::min(worst, core::luminance(kept.combined.values()[i]) / core::luminance(alone.combined.values()[i]));
    // Without neighbours that say how rays vary: 0.17.
    EXPECT_GT(worst, 0.4f);
}

}  // namespace
}  // namespace render2mpeg::renderer
