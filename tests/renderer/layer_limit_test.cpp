// Cycles' limit of transparent bounces: what ends a ray behind more layers than that is black, but may shine.
#include "renderer/geometry/layer_limit.h"

#include <gtest/gtest.h>

#include <numbers>
#include <optional>
#include <span>
#include <tuple>

#include "renderer/gather/final_gather.h"
#include "tests/renderer/film_stage.h"
#include "tests/renderer/stage.h"

namespace render2mpeg::renderer {
namespace {

using test::FilmStage;
using test::SceneBuilder;

constexpr int limit = 3;
constexpr float lit = 0.5f;  ///< radiance of the wall, by a sun at 45 degrees

enum class Light { sun, point, spot, panel };

struct Stacks {
    int before_eye = 0, before_light = 0;
    Light light = Light::sun;
    bool wall = true;
    float shines = 0;
    float holes_shine = 0;
    bool holes_seen = true;
};

/// A stack of layers that cover nothing, which Cycles counts as well. Returns their material.
int add_holes(SceneBuilder& b, int count, glm::vec3 corner, glm::vec3 edge_u, glm::vec3 edge_v, glm::vec3 apart) {
    const int hole = b.add_material(glm::vec3(1));
    b.material(hole).alpha_mode = scene::AlphaMode::blend;
    for (int i = 0; i < count; ++i) {
        scene::Mesh mesh = SceneBuilder::quad(corner + static_cast<float>(i) * apart, edge_u, edge_v);
        mesh.colors.assign(mesh.positions.size(), {1, 1, 1, 0});
        b.add_object(b.add_mesh(mesh), hole);
    }
    return hole;
}

/// A light at 45 degrees that lights the middle of the wall like the others.
void add_light(SceneBuilder& b, Light light) {
    constexpr float across = std::numbers::pi_v<float> * std::numbers::sqrt2_v<float>, square = 50, edge = 0.2f;
    if (light == Light::sun) {
        b.add_sun({0, -1, -1}, across);
    } else if (light == Light::point) {
        b.add_point_light({0, 5, 5}, across * square);
    } else if (light == Light::spot) {
        const auto number = static_cast<std::size_t>(b.add_point_light({0, 5, 5}, across * square));
        scene::Light& spot = b.film().lights[number];
        spot.kind = scene::LightKind::spot;
        b.film().nodes[static_cast<std::size_t>(spot.node)].rotation = SceneBuilder::looking_along({0, -1, -1});
    } else {
        const float along = edge / std::numbers::sqrt2_v<float>;
        b.add_quad({-edge / 2, 5 + along / 2, 5 - along / 2}, {edge, 0, 0}, {0, -along, along},
                   b.add_emitter(glm::vec3(across * square / (edge * edge))));
    }
}

/// The middle of a picture of a wall through stacks of layers.
float seen(const Stacks& stacks, std::optional<int> layers) {
    SceneBuilder b;
    const int paint = b.add_material(glm::vec3(lit));
    b.material(paint).emission = glm::vec3(stacks.shines);
    if (stacks.wall) b.add_quad({-9, -9, 0}, {18, 0, 0}, {0, 18, 0}, paint);
    for (const auto& [count, y, z] : {std::tuple(stacks.before_eye, 0.0f, 3.0f), {stacks.before_light, 1.5f, 1.5f}}) {
        const int hole = add_holes(b, count, {-1, y - 0.7f, z}, {2, 0, 0}, {0, 1.4f, 0}, {0, 0, 0.01f});
        b.material(hole).emission = glm::vec3(stacks.holes_shine);
        b.material(hole).seen = stacks.holes_seen;
    }
    add_light(b, stacks.light);
    if (!stacks.wall) b.film().sky.color = glm::vec3(lit);
    b.add_camera({0, 0, 5}, {0, 0, 0}, 0.1f);
    b.film().layers = layers;
    Settings settings = test::lightcuts_frame(8, 8);
    settings.vpls = 0;
    FilmStage stage(b, settings);
    return stage.reference().combined.at(4, 4).y;
}

TEST(LayerLimit, LetsTheEyeThroughSoManyLayersAndOneMore) {
    for (int count = 0; count < 7; ++count) {
        EXPECT_NEAR(seen({.before_eye = count}, std::nullopt), lit, 0.01f) << count;
        EXPECT_NEAR(seen({.before_eye = count}, limit), count > limit ? 0.0f : lit, 0.01f) << count;
    }
}

TEST(LayerLimit, LetsTheSunThroughSoManyLayers) {
    for (int count = 0; count < 7; ++count) {
        EXPECT_NEAR(seen({.before_light = count}, std::nullopt), lit, 0.01f) << count;
        EXPECT_NEAR(seen({.before_light = count}, limit), count > limit ? 0.0f : lit, 0.01f) << count;
    }
}

TEST(LayerLimit, ShowsLampsAndTheSkyBehindTheLastLayerAlone) {
    for (const int more : {1, 2}) {
        const float share = more == 1 ? 1.0f : 0.0f;
        EXPECT_NEAR(seen({.before_eye = limit + more, .shines = 2}, limit), share * 2.0f, 0.01f);
        EXPECT_NEAR(seen({.before_eye = limit + more, .wall = false}, limit), share * lit, 0.01f);
    }
}

TEST(LayerLimit, ShowsNoLightOfHolesAndCountsNoneThatTheEyeDoesNotSee) {
    EXPECT_NEAR(seen({.before_eye = limit + 2, .holes_shine = 2}, limit), 0, 0.01f);
    EXPECT_NEAR(seen({.before_eye = limit + 2, .holes_seen = false}, limit), lit, 0.01f);
}

TEST(LayerLimit, OfManyLayersHoldsForTheEyeAndForShadowsOfAllLamps) {
    for (const int most : {15, 16, 17, 40})
        for (const int count : {most, most + 1}) {
            const float expected = count > most ? 0.0f : lit;
            EXPECT_NEAR(seen({.before_eye = count}, most), expected, 0.01f) << most;
            for (const Light light : {Light::sun, Light::point, Light::spot, Light::panel})
                EXPECT_NEAR(seen({.before_light = count, .light = light}, most), expected, 0.02f)
                    << most << " " << static_cast<int>(light);
        }
}

/// Light that rays from a floor find below a ceiling that a lamp lights, with so many layers between.
float gathered(int count, std::optional<int> layers) {
    SceneBuilder b;
    const int paint = b.add_material(glm::vec3(0.5f));
    b.add_quad({-0.1f, 0, 0.1f}, {0.2f, 0, 0}, {0, 0, -0.2f}, paint);
    b.add_quad({-50, 4, -50}, {100, 0, 0}, {0, 0, 100}, paint);
    b.add_sun({0, 1, 0.1f}, 1);
    add_holes(b, count, {-20, 1, 20}, {40, 0, 0}, {0, 0, -40}, {0, -0.03f, 0});
    b.film().layers = layers;
    const test::Stage stage(b);
    GatherPoint point;
    point.point = stage.posed_scene().surface_at({0, 0, 0.3f, 0.3f}, {0, 1, 0});
    FinalGather gather(stage.posed_scene(), stage.plan());
    gather.forget({});
    const GatherRequest request{&point, {}, Stream(Purpose::hemisphere_rays), 1e-3f, RaysOf::all, 0, 1024};
    return gather.gather(std::span(&request, 1), {})[0].light[0].y;
}

TEST(LayerLimit, HoldsForGatherRaysThatPassAnyNumberOfHoles) {
    const float open = gathered(0, std::nullopt);
    ASSERT_GT(open, 0.0f);
    for (const int most : {3, 20})
        for (const int count : {most, most + 1}) {
            EXPECT_NEAR(gathered(count, std::nullopt), open, 0.1f * open) << count;
            EXPECT_NEAR(gathered(count, most), count > most ? 0.0f : open, 0.1f * open) << most;
        }
}

}  // namespace
}  // namespace render2mpeg::renderer
