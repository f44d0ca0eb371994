#include <gtest/gtest.h>

#include <limits>

#include "core/sampling.h"
#include "renderer/lights/area_lamps.h"
#include "renderer/lights/light.h"
#include "tests/renderer/lighting.h"

/// All kinds of light by one interface: what they tell of themselves agrees.
namespace render2mpeg::renderer {
namespace {

using test::LitStage;
using test::SceneBuilder;

/// At the origin, facing up.
const LightQuery query{{0, 0, 0}, {0, 0, 0}, {0, 1, 0}};

/// Irradiance by samples of one light.
double sampled(const Light& light) {
    constexpr std::uint64_t count = 1u << 14;
    double sum = 0;
    for (std::uint64_t i = 1; i <= count; ++i) {
        const LightSample s =
            light.sample(query, static_cast<double>(core::halton(2, i)), {core::halton(0, i), core::halton(1, i)});
        sum += static_cast<double>(s.light.x * std::max(s.direction.y, 0.0f));
    }
    return sum / count;
}

SceneBuilder floor_and_lamp() {
    SceneBuilder b;
    b.add_quad({-5, 0, 5}, {10, 0, 0}, {0, 0, -10}, b.add_material(glm::vec3(0.5f)));
    b.add_quad({-0.5f, 1, -0.25f}, {1, 0, 0}, {0, 0, 0.5f}, b.add_emitter(glm::vec3(3)));
    return b;
}

TEST(Lights, OfSurfacesSendTheIrradianceOfTheirClosedForm) {
    LitStage stage(floor_and_lamp());
    const Lights lights = surfaces_of(stage.posed_scene());
    const auto whole = AreaLamps(stage.posed_scene(), stage.direct_points(64, 1)).at(stage.posed_scene());
    ASSERT_EQ(lights.size(), 1u);
    ASSERT_EQ(whole.size(), 1u);
    const double expected = 3.0 * static_cast<double>(whole[0]->irradiance(query.position, query.normal));
    EXPECT_GT(expected, 0.5);
    EXPECT_NEAR(sampled(*lights[0]), expected, 0.003 * expected);
}

TEST(Lights, OfSunsSendTheIrradianceOfTheirClosedForm) {
    SceneBuilder b = floor_and_lamp();
    b.add_sun({0.6f, -0.8f, 0}, 2.0f);
    b.film().lights.back().angle = 0.3f;
    const LitStage stage(b);
    const Lights lights = lamps_of(stage.posed_scene().posed());
    ASSERT_EQ(lights.size(), 1u);
    const auto whole = lights[0]->whole();
    ASSERT_NE(whole, nullptr);
    const double expected = static_cast<double>(whole->radiance.x * whole->irradiance({}, query.normal));
    EXPECT_NEAR(expected, 2.0 * 0.8, 1e-4);
    EXPECT_NEAR(sampled(*lights[0]), expected, 0.003 * expected);
}

TEST(Lights, TellTheDensityOfTheirSamples) {
    SceneBuilder b = floor_and_lamp();
    b.add_sun({0, -1, 0.5f}, 2.0f);
    b.film().lights.back().angle = 0.1f;
    const LitStage stage(b);
    const Lights surfaces = surfaces_of(stage.posed_scene()), suns = lamps_of(stage.posed_scene().posed());
    int met = 0;
    for (const Light* light : {surfaces[0].get(), suns[0].get()})
        for (std::uint64_t i = 1; i <= 100; ++i) {
            const LightSample s =
                light->sample(query, static_cast<double>(core::halton(2, i)), {core::halton(0, i), core::halton(1, i)});
            ASSERT_GT(s.density, 0.0f);
            // The ray starts a little off the floor, and may pass the lamp's edge.
            const Hit hit = stage.posed_scene().tracer().nearest({0, 0.001f, 0}, s.direction,
                                                                 std::numeric_limits<float>::infinity());
            if (light->object() != core::no_id && hit.address.object != light->object()) continue;
            ++met;
            EXPECT_NEAR(light->density(query, s.direction, hit.address), s.density, 0.01f * s.density);
        }
    EXPECT_GT(met, 190);
}

TEST(Lights, ThatArePointsSendWhatTheirLightPointsDo) {
    SceneBuilder b = floor_and_lamp();
    scene::Light spot;
    spot.kind = scene::LightKind::spot;
    spot.intensity = 7;
    spot.inner_cone = 0.5f;
    spot.outer_cone = 1.5f;
    spot.range = 9;
    b.add_point_light({1, 2, 3}, 5);
    spot.node = b.film().lights.back().node;
    b.add_light(spot);
    const LitStage stage(b);
    for (const auto& light : lamps_of(stage.posed_scene().posed())) {
        const LightPoint p = light->point().value();
        const glm::vec3 to = p.position - query.position;
        const float distance2 = glm::dot(to, to);
        const LightSample s = light->sample(query, 0, {});
        const float expected = p.intensity.x * p.emitted(-glm::normalize(to), distance2) / distance2;
        EXPECT_GT(expected, 0.01f);
        EXPECT_NEAR(s.light.x, expected, 1e-5f * expected);
        EXPECT_EQ(s.density, 0.0f);
        EXPECT_NEAR(light->weight(query), static_cast<double>(expected), 1e-5 * static_cast<double>(expected));
    }
}

}  // namespace
}  // namespace render2mpeg::renderer
