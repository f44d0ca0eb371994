#include "renderer/paths/light_paths.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "core/color.h"
#include "image/image.h"
#include "tests/reference/path_tracer.h"
#include "tests/renderer/stage.h"
#include "tests/support/program.h"

namespace render2mpeg::renderer {
namespace {

using test::SceneBuilder;
using test::Stage;

/// A mean over paths, and its standard error.
struct PathMean {
    double value = 0, error = 0;
};

/// Luminance scattered at a point of the stage; unless told, in the middle of a quad.
PathMean scattered_at(const Stage& stage, glm::vec3 outgoing, std::uint64_t paths, std::uint32_t object = 0,
                      glm::vec2 uv = {0, 0.5f}) {
    const LightPaths light(stage.posed_scene(), stage.plan());
    const SurfacePoint p = stage.posed_scene().surface_at({object, 0, uv.x, uv.y}, glm::normalize(outgoing));
    constexpr std::uint64_t batches = 32;
    double sum = 0, squares = 0;
    for (std::uint64_t b = 0; b < batches; ++b) {
        double batch = 0;
        for (std::uint64_t i = 0; i < paths / batches; ++i) {
            PathNumbers numbers(Stream(Purpose::true_paths, {.index = 1000 + b}), i);
            batch += core::luminance(light.scattered(p, numbers));
        }
        batch /= static_cast<double>(paths / batches);
        sum += batch;
        squares += batch * batch;
    }
    PathMean m{sum / batches, 0};
    m.error = std::sqrt(std::max(squares / batches - m.value * m.value, 0.0) / (batches - 1));
    return m;
}

/// Within four standard errors, which are to be below a share of the value.
void expect_mean(const PathMean& m, double expected, double known_to) {
    EXPECT_NEAR(m.value, expected, 4 * m.error + 1e-4 * expected) << "+- " << m.error;
    EXPECT_LT(m.error, known_to * expected);
}

constexpr float albedo = 0.5f;

/// A large floor about the origin, whose middle lies on the edge between its two triangles.
SceneBuilder floor_stage() {
    SceneBuilder b;
    b.add_quad({-50, 0, 50}, {100, 0, 0}, {0, 0, -100}, b.add_material(glm::vec3(albedo)));
    return b;
}

TEST(LightPaths, OfAFurnaceAreAGeometricSum) {
    SceneBuilder b;
    const int wall = b.add_material(glm::vec3(albedo));
    b.material(wall).emission = glm::vec3(1);
    b.add_box({-1, -1, -1}, {1, 1, 1}, wall, true);
    const Stage stage(b);
    // Emission itself is not scattered.
    expect_mean(scattered_at(stage, {0.1f, 0.2f, 0.3f}, 20000, 0, {0.3f, 0.3f}), 1 / (1 - albedo) - 1, 0.01);
}

TEST(LightPaths, OfAPanelAreItsConfigurationFactor) {
    SceneBuilder b = floor_stage();
    // Two units above, its front below. [Lambert1760]
    b.add_quad({-0.5f, 2, -0.5f}, {1, 0, 0}, {0, 0, 1}, b.add_emitter(glm::vec3(3)));
    const double a = 0.25,
                 form = 4 / (2 * std::numbers::pi) * 2 * a / std::sqrt(1 + a * a) * std::atan(a / std::sqrt(1 + a * a));
    expect_mean(scattered_at(Stage(b), {1, 1, 0}, 20000), albedo * 3 * form, 0.005);
}

TEST(LightPaths, OfARoundLampAreItsSolidAngle) {
    SceneBuilder b = floor_stage();
    b.add_sphere({0, 2, 0}, 0.25f, b.add_emitter(glm::vec3(3)), 64);
    // The inscribed mesh is smaller by some 0.1 %.
    const PathMean m = scattered_at(Stage(b), {1, 1, 0}, 40000);
    EXPECT_NEAR(m.value, albedo * 3 * 0.25 * 0.25 / 4, 4 * m.error + 0.002 * m.value);
    EXPECT_LT(m.error, 0.01 * m.value);
}

TEST(LightPaths, OfALampThatFillsTheHalfSpaceAreAsBrightAsIt) {
    SceneBuilder b = floor_stage();
    b.add_sphere({0, 0, 0}, 5.0f, b.add_emitter(glm::vec3(1)), 24);
    b.material(1).double_sided = true;
    expect_mean(scattered_at(Stage(b), {1, 1, 0}, 20000), albedo, 0.005);
}

TEST(LightPaths, OfSunsAndPointsAreTheirIrradiance) {
    for (const float angle : {0.0f, 0.05f, 0.5f}) {
        SceneBuilder b = floor_stage();
        const int sun = b.add_sun({1, -1, 0}, 4.0f);
        b.film().lights[static_cast<std::size_t>(sun)].angle = angle;
        expect_mean(scattered_at(Stage(b), {1, 1, 0}, 20000), albedo * 4 * std::sqrt(0.5) / std::numbers::pi, 0.005);
    }
    SceneBuilder b = floor_stage();
    b.add_point_light({0, 2, 0}, 10);
    b.add_point_light({0, 4, 0}, 40);
    expect_mean(scattered_at(Stage(b), {1, 1, 0}, 20000), albedo * (2.5 + 2.5) / std::numbers::pi, 0.005);
}

TEST(LightPaths, OfAnEvenSkyAreAsBrightAsIt) {
    SceneBuilder b = floor_stage();
    b.film().sky.color = glm::vec3(1);
    expect_mean(scattered_at(Stage(b), {1, 1, 0}, 2000), albedo, 0.001);
}

TEST(LightPaths, OfASkyImageAreItsLightByDirectionsAndByPlacesSlow) {
    // Dark, but for eight pixels about the middle of the upper half: 45 degrees up, along -z.
    const support::Folder folder;
    constexpr int width = 64, height = 32;
    std::vector<float> values(std::size_t{width} * height, 0.01f);
    for (const int y : {7, 8})
        for (const int x : {30, 31, 32, 33}) values[static_cast<std::size_t>(y * width + x)] = 1000.0f;
    std::vector<image::Channel> channels;
    for (const char* name : {"R", "G", "B"}) channels.push_back({name, values, true});
    image::write_exr(folder / "sky.exr", width, height, channels);
    SceneBuilder b = floor_stage();
    b.film().images.push_back({"sky", folder / "sky.exr", {}});
    b.film().sky.image = 0;
    b.film().sky.color = glm::vec3(1);
    // A wall behind casts the light on.
    b.add_quad({-50, 0, 3}, {0, 40, 0}, {100, 0, 0}, 0);
    const Stage stage(b);
    const PathMean m = scattered_at(stage, {1, 1, 0}, 20000);
    const SurfacePoint p = stage.posed_scene().surface_at({0, 0, 0, 0.5f}, glm::normalize(glm::vec3(1, 1, 0)));
    const reference::Estimate plain = reference::scattered_light(stage.posed_scene(), p, 12, 400000, 5);
    EXPECT_NEAR(m.value, plain.mean.x, 4 * std::hypot(m.error, plain.error.x));
    EXPECT_LT(m.error, 0.3 * plain.error.x);
}

TEST(LightPaths, OfNothingAreNothing) {
    SceneBuilder b = floor_stage();
    b.add_point_light({0, -2, 0}, 10);  // behind the floor
    const PathMean m = scattered_at(Stage(b), {1, 1, 0}, 1024);
    EXPECT_EQ(m.value, 0.0);
    EXPECT_EQ(m.error, 0.0);
}

TEST(LightPaths, PassLayersAsShadowRaysDo) {
    const double a = 0.25,
                 form = 4 / (2 * std::numbers::pi) * 2 * a / std::sqrt(1 + a * a) * std::atan(a / std::sqrt(1 + a * a));
    // A black pane of alpha 0.25 hides a quarter, one of clear glass what it reflects.
    for (const bool glass : {false, true}) {
        for (const bool lamp : {false, true}) {
            // So dark that what glass mirrors of it is nothing.
            SceneBuilder b = floor_stage();
            const float dark = 0.01f;
            b.material(0).base_color = {dark, dark, dark, 1};
            const int pane = b.add_material(glm::vec3(glass ? 1.0f : 0.0f));
            b.material(pane).base_color.a = glass ? 1.0f : 0.25f;
            b.material(pane).alpha_mode = glass ? scene::AlphaMode::opaque : scene::AlphaMode::blend;
            b.material(pane).transmission = glass ? 1.0f : 0.0f;
            b.material(pane).ior = glass ? 1.5f : 1.0f;
            b.material(pane).roughness = 0;
            b.add_quad({-60, 1, 60}, {120, 0, 0}, {0, 0, -120}, pane);
            if (lamp)
                b.add_quad({-0.5f, 2, -0.5f}, {1, 0, 0}, {0, 0, 1}, b.add_emitter(glm::vec3(3)));
            else
                b.film().sky.color = glm::vec3(1);
            // All directions, or those next to the normal.
            const double passes = glass ? 0.96 - (lamp ? 0.0 : 0.96 / 21) : 0.75;
            // At the horizon the pane ends.
            const PathMean m = scattered_at(Stage(b), {1, 1, 0}, 40000);
            const double expected = passes * dark * (lamp ? 3 * form : 1.0);
            EXPECT_NEAR(m.value, expected, 4 * m.error + 2e-3 * expected) << glass << lamp;
        }
    }
}

/// A perfect mirror above the floor, all that light could come by.
SceneBuilder below_a_mirror(float floor_roughness) {
    SceneBuilder b = floor_stage();
    b.material(0).roughness = floor_roughness;
    b.material(0).metallic = floor_roughness < 0.3f ? 1.0f : 0.0f;
    b.material(0).ior = 1.5f;
    const int mirror = b.add_material(glm::vec3(1));
    b.material(mirror).metallic = 1;
    b.material(mirror).roughness = 0;
    b.add_quad({-1000, 1, -1000}, {2000, 0, 0}, {0, 0, 2000}, mirror);
    // A lamp between, which shines up.
    b.add_quad({-0.5f, 0.5f, 0.5f}, {1, 0, 0}, {0, 0, -1}, b.add_emitter(glm::vec3(3)));
    return b;
}

TEST(LightPaths, HoldNoCausticOfAMirrorOnTheFirstSurfaceSlow) {
    // The floor beside the lamp is lit by the mirror alone: by the lamp in it, and by the floor about that it lights.
    const SceneBuilder all = below_a_mirror(1.0f);
    const Stage stage(all);
    const PathMean m = scattered_at(stage, {1, 1, 0}, 40000, 0, {0.02f, 0.5f});
    reference::PathSettings settings;
    settings.finding = reference::Finding::by_connection;
    const auto plain = [&](bool caustics) {
        settings.caustics = caustics;
        return reference::PathTracer(stage.posed_scene())
            .scattered({0, 0, 0.02f, 0.5f}, {1, 1, 0}, settings, 200000, 9);
    };
    const reference::Estimate without = plain(false);
    EXPECT_NEAR(m.value, without.mean.y, 4 * std::hypot(m.error, without.error.y));
    EXPECT_GT(m.value, 10 * m.error);
    EXPECT_GT(plain(true).mean.y, 2 * m.value);
    // A narrow lobe sees the floor in it as well.
    EXPECT_GT(scattered_at(Stage(below_a_mirror(0.2f)), {1, 1, 0}, 4096, 0, {0.02f, 0.5f}).value, 0.0);
}

/// A room with a block and a shiny ball of this roughness.
SceneBuilder full_room(float roughness, bool metal) {
    SceneBuilder b;
    const int grey = b.add_material({0.7f, 0.6f, 0.5f}), red = b.add_material({0.6f, 0.1f, 0.1f});
    const int shiny = b.add_material({0.7f, 0.6f, 0.3f});
    b.material(shiny).roughness = roughness;
    b.material(shiny).ior = 1.5f;
    b.material(shiny).metallic = metal ? 1.0f : 0.0f;
    b.add_quad({0, 0, 4}, {4, 0, 0}, {0, 0, -4}, shiny);
    b.add_quad({0, 3, 0}, {4, 0, 0}, {0, 0, 4}, grey);
    b.add_quad({0, 0, 0}, {4, 0, 0}, {0, 3, 0}, grey);
    b.add_quad({0, 0, 4}, {0, 0, -4}, {0, 3, 0}, red);
    b.add_quad({4, 0, 4}, {-4, 0, 0}, {0, 3, 0}, grey);
    b.add_box({2.6f, 0, 0.6f}, {3.4f, 1.0f, 1.4f}, grey);
    b.add_quad({1, 2.5f, 1}, {1.5f, 0, 0}, {0, 0, 1.5f}, b.add_emitter({10, 8, 6}));
    b.add_point_light({1.5f, 2.0f, 2.5f}, 5.0f, {1, 0.8f, 0.6f});
    b.film().sky.color = {0.2f, 0.3f, 0.4f};
    return b;
}

TEST(LightPaths, AgreeWithAPlainPathTracerSlow) {
    for (const float roughness : {0.15f, 0.4f, 0.8f}) {
        const Stage stage(full_room(roughness, roughness < 0.5f));
        for (const std::uint32_t object : {0u, 2u, 3u}) {
            const glm::vec3 to(2, 1.5f, 2);
            const SurfacePoint p = stage.posed_scene().surface_at({object, 0, 0.3f, 0.3f}, {0, 1, 0});
            const PathMean m = scattered_at(stage, to - p.position, 40000, object, {0.3f, 0.3f});
            const SurfacePoint seen =
                stage.posed_scene().surface_at({object, 0, 0.3f, 0.3f}, glm::normalize(to - p.position));
            const reference::Estimate plain = reference::scattered_light(stage.posed_scene(), seen, 24, 60000, 5);
            const double value = core::luminance(glm::vec3(plain.mean)),
                         error = core::luminance(glm::vec3(plain.error));
            EXPECT_NEAR(m.value, value, 4 * std::hypot(m.error, error)) << roughness << ", " << object;
            EXPECT_LT(m.error, 0.015 * value);
        }
    }
}

TEST(LightPaths, AgreeWithAPlainPathTracerBesideMirrorsAndGlassSlow) {
    SceneBuilder b = full_room(0.6f, false);
    b.film().lights.clear();  // paths that chance leads do not meet points in mirrors
    const int mirror = b.add_material({0.9f, 0.8f, 0.7f}), glass = b.add_material({0.8f, 0.9f, 1.0f});
    b.material(mirror).metallic = 1;
    b.material(mirror).roughness = 0;
    b.material(glass).transmission = 1;
    b.material(glass).ior = 1.5f;
    b.material(glass).roughness = 0;
    b.add_quad({0.5f, 0.2f, 0.05f}, {3, 0, 0}, {0, 2.6f, 0}, mirror);
    b.add_quad({0.2f, 1.6f, 0.2f}, {0, 0, 3.6f}, {3.6f, 0, 0}, glass);
    const Stage stage(b);
    reference::PathSettings settings;
    settings.finding = reference::Finding::by_connection;
    for (const std::uint32_t object : {0u, 3u, 4u}) {
        const core::SurfaceAddress address{object, 0, 0.3f, 0.3f};
        const glm::vec3 position = stage.posed_scene().surface_at(address, {0, 1, 0}).position;
        const glm::vec3 outgoing = glm::normalize(glm::vec3(2, 1.5f, 2) - position);
        const PathMean m = scattered_at(stage, outgoing, 80000, object, {0.3f, 0.3f});
        const reference::Estimate plain =
            reference::PathTracer(stage.posed_scene()).scattered(address, outgoing, settings, 200000, 9);
        const double value = core::luminance(glm::vec3(plain.mean)), error = core::luminance(glm::vec3(plain.error));
        EXPECT_NEAR(m.value, value, 4 * std::hypot(m.error, error)) << object;
        EXPECT_LT(m.error, 0.02 * value);
        EXPECT_LT(error, 0.03 * value);
    }
}

}  // namespace
}  // namespace render2mpeg::renderer
