// Cycles' limit of transparent bounces: what ends a ray behind more layers than that is black, but may shine.
#include "renderer/geometry/layer_limit.h"

#include <gtest/gtest.h>

#include <numbers>
#include <optional>

#include "tests/renderer/film_stage.h"

namespace render2mpeg::renderer {
namespace {

using test::FilmStage;
using test::SceneBuilder;

constexpr int limit = 3;
constexpr float lit = 0.5f;  ///< radiance of the wall, by a sun at 45 degrees

struct Stacks {
    int before_eye = 0, before_sun = 0;
    bool wall = true;
    float shines = 0;
    float holes_shine = 0;
    bool holes_seen = true;
};

/// The middle of a picture of a wall through layers that cover nothing, which Cycles counts as well.
float seen(const Stacks& stacks, std::optional<int> layers) {
    SceneBuilder b;
    const int paint = b.add_material(glm::vec3(lit));
    b.material(paint).emission = glm::vec3(stacks.shines);
    if (stacks.wall) b.add_quad({-9, -9, 0}, {18, 0, 0}, {0, 18, 0}, paint);
    const int hole = b.add_material(glm::vec3(1));
    b.material(hole).alpha_mode = scene::AlphaMode::blend;
    b.material(hole).emission = glm::vec3(stacks.holes_shine);
    b.material(hole).seen = stacks.holes_seen;
    const auto stack = [&](int count, float y, float z) {
        for (int i = 0; i < count; ++i) {
            const float at = z + 0.05f * static_cast<float>(i);
            scene::Mesh mesh = SceneBuilder::quad({-1, y - 0.7f, at}, {2, 0, 0}, {0, 1.4f, 0});
            mesh.colors.assign(mesh.positions.size(), {1, 1, 1, 0});
            b.add_object(b.add_mesh(mesh), hole);
        }
    };
    stack(stacks.before_eye, 0, 3);
    stack(stacks.before_sun, 1.5f, 1.5f);
    b.add_sun({0, -1, -1}, std::numbers::pi_v<float> * std::numbers::sqrt2_v<float>);
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
        EXPECT_NEAR(seen({.before_sun = count}, std::nullopt), lit, 0.01f) << count;
        EXPECT_NEAR(seen({.before_sun = count}, limit), count > limit ? 0.0f : lit, 0.01f) << count;
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

TEST(LayerLimit, OfAsManyLayersAsRaysCountIsNone) {
    EXPECT_NEAR(seen({.before_eye = 30, .before_sun = 30}, 16), lit, 0.01f);
}

}  // namespace
}  // namespace render2mpeg::renderer
