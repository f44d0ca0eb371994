#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "renderer/view/see.h"
#include "stage.h"

namespace render2mpeg::test {
namespace {

using core::PixelClass;
using renderer::Frame;
using renderer::GatherPoint;
using renderer::tile_size;

int add_veil(SceneBuilder& builder, glm::vec3 color, float alpha) {
    const int veil = builder.add_material(color);
    builder.material(veil).alpha_mode = scene::AlphaMode::blend;
    builder.material(veil).base_color.a = alpha;
    return veil;
}

int add_mirror(SceneBuilder& builder, glm::vec3 reflectance) {
    const int mirror = builder.add_material(reflectance);
    builder.material(mirror).metallic = 1;
    builder.material(mirror).roughness = 0;
    return mirror;
}

/// The gather points of the pixel in the middle of a 16 x 16 picture.
std::vector<GatherPoint> middle(const Frame& seen) {
    std::vector<GatherPoint> points;
    for (const GatherPoint& g : seen.tiles.at(0))
        if (g.pixel == 8 * tile_size + 8) points.push_back(g);
    return points;
}

int add_wall(SceneBuilder& builder, float z, int material) {
    return builder.add_quad({-50, -50, z}, {100, 0, 0}, {0, 100, 0}, material);
}

TEST(Layers, AreComposedFrontToBack) {
    SceneBuilder builder;
    add_wall(builder, -9, builder.add_material());
    add_wall(builder, -7, add_veil(builder, {1, 1, 1}, 0.5f));
    add_wall(builder, -5, add_veil(builder, {1, 1, 1}, 0.25f));
    builder.add_camera({0, 0, 0}, {0, 0, -1});
    Stage stage(builder, 16, 16);
    const Frame seen = stage.see(1);
    const auto points = middle(seen);
    ASSERT_EQ(points.size(), 3u);
    EXPECT_FLOAT_EQ(points[0].weight.x, 0.25f);
    EXPECT_FLOAT_EQ(points[1].weight.x, 0.375f);
    EXPECT_FLOAT_EQ(points[2].weight.x, 0.375f);
    EXPECT_FALSE(points[2].reached_by_specular());
    // The nearest of equal shares is what the pixel shows.
    EXPECT_NEAR(seen.visible.depth.at(8, 8), 7.0f, 1e-4f);
    EXPECT_TRUE(seen.emitted_specular.empty());
}

TEST(Layers, BeyondTheCapCountAsOpaque) {
    SceneBuilder builder;
    for (int i = 0; i < 40; ++i)
        add_wall(builder, -2.0f - 0.1f * static_cast<float>(i), add_veil(builder, {1, 1, 1}, 0.01f));
    add_wall(builder, -9, builder.add_emitter({100, 100, 100}));
    builder.add_camera({0, 0, 0}, {0, 0, -1});
    Stage stage(builder, 16, 16);
    const Frame seen = stage.see(1);
    float sum = 0;
    for (const GatherPoint& g : middle(seen)) sum += g.weight.x;
    EXPECT_NEAR(sum, 1.0f, 1e-5f);
    EXPECT_EQ(seen.emitted.at(8, 8), glm::vec3{0.0f});
}

TEST(Layers, ThatAreHolesCostNothingButTheirRays) {
    SceneBuilder builder;
    for (int i = 0; i < 40; ++i) {
        const int holes = builder.add_material();
        builder.material(holes).alpha_mode = scene::AlphaMode::mask;
        builder.material(holes).base_color.a = 0.4f;
        add_wall(builder, -2.0f - 0.1f * static_cast<float>(i), holes);
    }
    add_wall(builder, -9, builder.add_emitter({3, 2, 1}));
    builder.add_camera({0, 0, 0}, {0, 0, -1});
    Stage stage(builder, 16, 16);
    const Frame seen = stage.see(1);
    EXPECT_TRUE(middle(seen).empty());
    EXPECT_EQ(seen.emitted.at(8, 8), (glm::vec3{3, 2, 1}));
    EXPECT_NEAR(seen.visible.depth.at(8, 8), 9.0f, 1e-4f);
}

TEST(Emission, LeavesTheFrontAndTheBackOnlyOfDoubleSidedSurfaces) {
    for (const bool double_sided : {false, true}) {
        SceneBuilder builder;
        const int lamp = builder.add_emitter({4, 5, 6});
        builder.material(lamp).double_sided = double_sided;
        builder.add_quad({-50, 0, -5}, {100, 0, 0}, {0, 50, 0}, lamp);   // upper half: front
        builder.add_quad({-50, 0, -5}, {100, 0, 0}, {0, -50, 0}, lamp);  // lower half: back
        builder.add_camera({0, 0, 0}, {0, 0, -1});
        Stage stage(builder, 16, 16);
        const Frame seen = stage.see(4);
        EXPECT_EQ(seen.emitted.at(8, 2), (glm::vec3{4, 5, 6}));
        EXPECT_EQ(seen.emitted.at(8, 13), double_sided ? glm::vec3(4, 5, 6) : glm::vec3(0));
        EXPECT_EQ(seen.visible.kind.at(8, 13), PixelClass::surface);
    }
}

TEST(UnlitSurfaces, ShowTheirColourAndGatherNothing) {
    SceneBuilder builder;
    const int card = builder.add_material({0.3f, 0.6f, 0.9f});
    builder.material(card).unlit = true;
    add_wall(builder, -5, card);
    builder.add_camera({0, 0, 0}, {0, 0, -1});
    Stage stage(builder, 16, 16);
    const Frame seen = stage.see(4);
    EXPECT_TRUE(seen.tiles[0].empty());
    for (const glm::vec3 light : seen.emitted.values()) EXPECT_LT(glm::distance(light, {0.3f, 0.6f, 0.9f}), 1e-6f);
}

TEST(Sky, IsSeenWhereThereIsNoSurface) {
    SceneBuilder builder;
    builder.add_quad({-50, -50, -5}, {100, 0, 0}, {0, 50, 0}, builder.add_material());
    builder.film().sky.color = {0.1f, 0.2f, 0.4f};
    builder.add_camera({0, 0, 0}, {0, 0, -1});
    Stage stage(builder, 16, 16);
    const Frame seen = stage.see(4);
    EXPECT_EQ(seen.visible.kind.at(3, 2), PixelClass::sky);
    EXPECT_EQ(seen.visible.material.at(3, 2), core::no_id);
    EXPECT_LT(glm::distance(seen.emitted.at(3, 2), {0.1f, 0.2f, 0.4f}), 1e-6f);
    EXPECT_EQ(seen.visible.kind.at(3, 13), PixelClass::surface);
    EXPECT_EQ(seen.emitted.at(3, 13), glm::vec3{0.0f});
}

TEST(Mirrors, ShowASphereWhereItsMirrorImageWouldStand) {
    // A mirror in the plane y = 0, and a sphere above it.
    SceneBuilder builder;
    const int mirror = add_mirror(builder, {0.9f, 0.8f, 0.7f});
    builder.add_quad({-20, 0, 20}, {40, 0, 0}, {0, 0, -40}, mirror);
    const int ball = builder.add_sphere({0, 2, -1}, 1, builder.add_material(), 48);
    builder.add_camera({0, 3, 8}, {0, -0.5f, 0}, 0.7f);
    Stage stage(builder, 64, 64);
    const Frame seen = stage.see(1);
    int reflected = 0;
    for (std::size_t t = 0; t < seen.tiles.size(); ++t) {
        for (const GatherPoint& g : seen.tiles[t]) {
            ASSERT_EQ(g.point.address.object, static_cast<std::uint32_t>(ball));
            const int x = static_cast<int>(t) % 4 * 16 + g.pixel % 16, y = static_cast<int>(t) / 4 * 16 + g.pixel / 16;
            if (!g.reached_by_specular()) continue;
            ++reflected;
            const auto image = stage.world().camera.project(g.point.position * glm::vec3{1, -1, 1});
            ASSERT_TRUE(image);
            EXPECT_NEAR(image->position.x, static_cast<float>(x) + 0.5f, 1e-2f);
            EXPECT_NEAR(image->position.y, static_cast<float>(y) + 0.5f, 1e-2f);
            EXPECT_EQ(seen.visible.kind.at(x, y), PixelClass::reflected);
            // Schlick: at least the metal's colour, at most 1.
            EXPECT_GE(g.weight.z, 0.7f);
            EXPECT_LT(g.weight.z, 0.75f);
        }
    }
    EXPECT_GT(reflected, 100);
}

/// A mirror below the camera, which looks at it from above; what stands above it is behind the camera.
SceneBuilder above_a_mirror(float reflectance) {
    SceneBuilder builder;
    builder.add_quad({-9, 0, 9}, {18, 0, 0}, {0, 0, -18}, add_mirror(builder, glm::vec3(reflectance)));
    builder.add_camera({0, 2, 0}, {0, 0, 0}, 0.5f);
    return builder;
}

TEST(Mirrors, AloneShowALampThatAlphaHidesWhereItIsMirrored) {
    for (const bool mirrored : {false, true}) {
        SceneBuilder builder = above_a_mirror(0.5f);
        const int lamp = builder.add_emitter({8, 6, 4});
        builder.material(lamp).base_color.a = 0;
        builder.material(lamp).alpha_mode = scene::AlphaMode::blend;
        builder.material(lamp).mirrored = mirrored;
        builder.add_quad({-9, 1, -9}, {18, 0, 0}, {0, 0, 18}, lamp);  // faces down, before the camera
        Stage stage(builder, 16, 16);
        EXPECT_LT(glm::distance(stage.see(4).emitted.at(8, 8), mirrored ? glm::vec3(4, 3, 2) : glm::vec3(0)), 0.01f);
    }
}

/// Mean light over the picture.
float mean_emitted(const Frame& seen) {
    double sum = 0;
    for (const glm::vec3& light : seen.emitted.values()) sum += static_cast<double>(light.x);
    return static_cast<float>(sum) / static_cast<float>(seen.emitted.values().size());
}

TEST(Mirrors, ShowTheDiscsOfSpotsAndSunsWithTheirLight) {
    constexpr float pi = 3.14159265f;
    for (const scene::LightKind kind : {scene::LightKind::spot, scene::LightKind::directional}) {
        SceneBuilder builder = above_a_mirror(0.5f);
        // Straight above the mirror, 4 m from the camera's image; it shines down.
        scene::Light& lamp = builder.film().lights[static_cast<std::size_t>(builder.add_sun({0, -1, 0}, 3))];
        builder.film().nodes[static_cast<std::size_t>(lamp.node)].translation = {0, 2, 0};
        lamp.kind = kind;
        lamp.angle = 0.05f;
        lamp.inner_cone = 0.5f;
        lamp.disc = kind == scene::LightKind::spot ? 0.2f : std::sin(lamp.angle);
        Stage stage(builder, 64, 64);
        const float tangent = kind == scene::LightKind::spot ? 0.2f / 4 : std::tan(lamp.angle);
        const float share = pi * tangent * tangent / std::pow(2 * std::tan(0.25f), 2.0f);
        const float disc = stage.film().lights.front().disc;
        const float radiance = 0.5f * 3 / (pi * disc * disc);
        const Frame seen = stage.see(4, 6, 64);
        EXPECT_NEAR(mean_emitted(seen), share * radiance, 0.015f * share * radiance);
        // Its rim is looked at closely, and the pixels beside that, whose few samples may have missed it.
        const auto closely = std::count(seen.samples.values().begin(), seen.samples.values().end(), 64);
        EXPECT_GT(closely, 60);
        EXPECT_LT(closely, 250);
    }
}

TEST(Suns, AreSeenByTheEyeOnlyWhereTheyAreSaidToBe) {
    for (const bool seen : {false, true}) {
        SceneBuilder builder;
        scene::Light sun;
        sun.kind = scene::LightKind::directional;
        sun.intensity = 2;
        sun.angle = 0.3f;
        sun.disc = std::sin(sun.angle);
        sun.seen = seen;
        builder.add_light(sun);  // shines along -z
        builder.add_camera({0, 0, 0}, {0, 0, 1}, 0.1f);
        Stage stage(builder, 16, 16);
        const float radiance = 2 / (3.14159265f * sun.disc * sun.disc);
        EXPECT_NEAR(stage.see(1).emitted.at(8, 8).x, seen ? radiance : 0.0f, 1e-3f * radiance);
    }
}

TEST(Coats, ThatMirrorOneInAHundredShowTheSky) {
    SceneBuilder builder;
    const int paint = builder.add_material({0, 0, 0});
    builder.material(paint).model = scene::SurfaceModel::principled_3;
    builder.material(paint).specular_level = 0;
    builder.material(paint).coat = 0.25f;
    builder.material(paint).coat_roughness = 0.03f;
    builder.add_quad({-9, 0, 9}, {18, 0, 0}, {0, 0, -18}, paint);
    builder.film().sky.color = {1, 1, 1};
    builder.add_camera({0, 2, 0}, {0, 0, 0}, 0.1f);
    Stage stage(builder, 16, 16);
    EXPECT_NEAR(stage.see(1).emitted.at(8, 8).x, 0.25f * 0.04f, 1e-4f);
}

TEST(Mirrors, FacingEachOtherEndAtTheDepthOfTheSettings) {
    for (const int depth : {0, 1, 4}) {
        SceneBuilder builder;
        const int mirror = add_mirror(builder, {1, 1, 1});
        add_wall(builder, -2, mirror);
        builder.add_quad({50, -50, 2}, {-100, 0, 0}, {0, 100, 0}, mirror);
        builder.add_camera({0, 0, 0}, {0.1f, 0.05f, -1});
        Stage stage(builder, 16, 16);
        stage.see(1, depth);
        EXPECT_EQ(stage.counts().primary_rays, 256u);
        EXPECT_EQ(stage.counts().specular_rays, 256u * static_cast<unsigned>(depth));
    }
}

/// Their diffuse part has a shape, but reflects nothing: light gathered there would be for nobody.
TEST(Mirrors, OfBlendersMetalsAreNoPlacesToGather) {
    for (const auto model : {scene::SurfaceModel::principled_3, scene::SurfaceModel::principled_4}) {
        SceneBuilder builder;
        const int mirror = add_mirror(builder, {0.9f, 0.8f, 0.7f});
        builder.material(mirror).model = model;
        builder.material(mirror).diffuse_roughness = model == scene::SurfaceModel::principled_4 ? 0.5f : 0.0f;
        add_wall(builder, -2, mirror);
        builder.add_quad({50, -50, 2}, {-100, 0, 0}, {0, 100, 0}, builder.add_material());
        builder.add_camera({0, 0, 0}, {0, 0, -1}, 0.2f);
        Stage stage(builder, 16, 16);
        const auto points = middle(stage.see(1));
        ASSERT_EQ(points.size(), 1u);
        EXPECT_TRUE(points[0].reached_by_specular());
    }
}

TEST(SmoothDielectrics, MirrorAFewPercentOnce) {
    SceneBuilder builder;
    const int polished = builder.add_material({0.5f, 0.5f, 0.5f});
    builder.material(polished).ior = 1.5f;
    builder.material(polished).roughness = 0;
    add_wall(builder, -2, polished);
    builder.add_quad({50, -50, 2}, {-100, 0, 0}, {0, 100, 0}, polished);
    builder.add_camera({0, 0, 0}, {0, 0, -1}, 0.2f);
    Stage stage(builder, 16, 16);
    const Frame seen = stage.see(1);
    const auto points = middle(seen);
    ASSERT_EQ(points.size(), 2u);
    EXPECT_EQ(points[0].weight, glm::vec3{1.0f});
    EXPECT_NEAR(points[1].weight.x, 0.04f, 1e-4f);
    EXPECT_TRUE(points[1].reached_by_specular());
    EXPECT_EQ(seen.visible.kind.at(8, 8), PixelClass::surface);
}

TEST(Glass, ShowsAFloorBehindItAndTheFloorThatItMirrorsAtTheirOwnPlaces) {
    SceneBuilder builder;
    const int pane = builder.add_material({1.0f, 1.0f, 1.0f});
    builder.material(pane).transmission = 1;
    builder.material(pane).ior = 1.5f;
    builder.material(pane).roughness = 0;
    add_wall(builder, -4, pane);
    builder.add_quad({-50, -2, 50}, {100, 0, 0}, {0, 0, -100}, builder.add_material());
    builder.add_camera({0, 0, 0}, {0, -1.6f, -4}, 0.1f);
    Stage stage(builder, 16, 16);
    const auto points = middle(stage.see(4));
    ASSERT_EQ(points.size(), 2u);
    for (const GatherPoint& p : points) {
        const bool behind = p.weight.x > 0.5f;
        EXPECT_NEAR(p.weight.x, behind ? 0.96f : 0.04f, 0.005f);
        EXPECT_NEAR(p.point.position.z, behind ? -5.0f : -3.0f, 0.1f);
    }
}

TEST(Glass, TintsWhatIsBehindItAndMirrorsALittle) {
    SceneBuilder builder;
    const int pane = builder.add_material({0.5f, 0.9f, 1.0f});
    builder.material(pane).transmission = 1;
    builder.material(pane).ior = 1.5f;
    builder.material(pane).roughness = 0;
    add_wall(builder, -2, pane);
    const int wall = add_wall(builder, -6, builder.add_material());
    builder.add_quad({50, -50, 3}, {-100, 0, 0}, {0, 100, 0}, builder.add_emitter({1, 1, 1}));
    builder.add_camera({0, 0, 0}, {0, 0, -1}, 0.2f);
    Stage stage(builder, 16, 16);
    const Frame seen = stage.see(1);
    const auto points = middle(seen);
    ASSERT_EQ(points.size(), 1u);
    EXPECT_EQ(points[0].point.address.object, static_cast<std::uint32_t>(wall));
    EXPECT_TRUE(points[0].reached_by_specular());
    EXPECT_NEAR(points[0].weight.x, 0.96f * 0.5f, 1e-3f);
    EXPECT_NEAR(points[0].weight.z, 0.96f, 1e-3f);
    EXPECT_NEAR(seen.emitted.at(8, 8).x, 0.04f, 1e-3f);
    EXPECT_EQ(seen.emitted, seen.emitted_specular);
    // The pixel moves like what is seen through it.
    EXPECT_EQ(seen.visible.kind.at(8, 8), PixelClass::surface);
    EXPECT_NEAR(seen.visible.depth.at(8, 8), 6.0f, 1e-4f);
    // Shadow rays lose what the tint and the Fresnel reflection at their own angle take, whatever their length.
    const glm::vec3 light = stage.tracer().passes({0, 0, 0}, {0, 0, -1}, 5.0f);
    EXPECT_NEAR(light.x, 0.5f * 0.96f, 1e-4f);
    EXPECT_NEAR(light.z, 0.96f, 1e-4f);
    const float reflected = 0.04f + 0.96f * std::pow(1 - 0.28f, 5.0f);
    EXPECT_NEAR(stage.tracer().passes({0, 0, 0}, {9.6f, 0, -2.8f}, 1.0f).z, 1 - reflected, 1e-4f);
}

TEST(Energy, OfAPixelsWeightsNeverExceedsOne) {
    // Mirrors, glass, veils and dull surfaces together, under a white sky: albedo 1 everywhere must not shine brighter
    // than it.
    SceneBuilder builder;
    const int pane = builder.add_material({1, 1, 1});
    builder.material(pane).transmission = 0.8f;
    builder.material(pane).ior = 1.5f;
    builder.material(pane).roughness = 0;
    builder.add_sphere({-1, 0, -5}, 1, pane);
    builder.add_sphere({1, 0, -6}, 1.2f, add_mirror(builder, {1, 1, 1}));
    builder.add_sphere({0, 1, -4}, 0.7f, add_veil(builder, {1, 1, 1}, 0.5f));
    builder.add_quad({-20, -1, 10}, {40, 0, 0}, {0, 0, -40}, builder.add_material({1, 1, 1}));
    builder.film().sky.color = {1, 1, 1};
    builder.add_camera({0, 0.5f, 0}, {0, 0, -5});
    Stage stage(builder, 48, 48);
    const Frame seen = stage.see(4, 12);
    core::Plane<glm::vec3> sum = seen.emitted;
    for (std::size_t t = 0; t < seen.tiles.size(); ++t) {
        for (const GatherPoint& g : seen.tiles[t]) {
            const int x = static_cast<int>(t) % 3 * 16 + g.pixel % 16, y = static_cast<int>(t) / 3 * 16 + g.pixel / 16;
            sum.at(x, y) += g.weight * (g.point.bsdf.diffuse + g.point.bsdf.f0);
        }
    }
    float lowest = 1, highest = 0;
    for (const glm::vec3 s : sum.values()) {
        lowest = std::min(lowest, s.x);
        highest = std::max(highest, s.x);
    }
    EXPECT_LT(highest, 1.0f + 1e-4f);
    EXPECT_GT(lowest, 0.8f);
}

}  // namespace
}  // namespace render2mpeg::test
