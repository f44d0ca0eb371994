#include <gtest/gtest.h>

#include <algorithm>

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
    // Two away, an eye that moves by 0.05 turns half vectors by a twentieth of the width, one that moves by 0.3 by more
    // than an eighth.
    const auto holds = [&](float moved, float relative) {
        records_.forget();
        strew(2, [](glm::vec2) { return 1.0f; });
        polish(stage_.world().camera.position() + glm::vec3(moved, 0, 0));
        return estimate_polished(point_at(12, 12), relative).has_value();
    };
    EXPECT_TRUE(holds(0.0f, 0.01f));
    EXPECT_FALSE(holds(0.05f, 0.02f));
    EXPECT_TRUE(holds(0.05f, 0.04f));
    EXPECT_FALSE(holds(0.3f, 10.0f));
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
