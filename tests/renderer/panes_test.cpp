// Flat glass lets light straight through: next events and gather rays have it all, and photons bring what panes mirror
// of lamps alone.
#include <gtest/gtest.h>

#include <cmath>

#include "core/color.h"
#include "renderer/surface/dielectric.h"
#include "tests/renderer/film_stage.h"
#include "tests/renderer/glass_stage.h"

namespace render2mpeg::test {
namespace {

/// A floor, seen from above through nothing that is added later.
SceneBuilder floor_below(float albedo = 0.5f) {
    SceneBuilder b;
    b.add_quad({-60, 0, 60}, {120, 0, 0}, {0, 0, -120}, b.add_material(glm::vec3(albedo)));
    b.add_camera({0.3f, 0.5f, 0.01f}, {0.3f, 0, 0}, 0.5f);
    return b;
}

/// Of a floor so dark that what glass mirrors of it is nothing.
constexpr float dark = 0.01f;

/// As films are lit by default.
renderer::Settings by_rays() {
    renderer::Settings s = small_frame();
    s.cache = renderer::CacheUse::static_light;
    return s;
}

double mean_of(FilmStage& stage, int second = 0, float relative = 0.005f) {
    const auto tolerance = core::ToleranceMap::uniform(24, 24, {0.0f, relative});
    double sum = 0;
    const core::Radiance r = stage.shade(second, tolerance);
    for (const glm::vec3& v : r.combined.values()) sum += static_cast<double>(core::luminance(v));
    return sum / static_cast<double>(r.combined.size());
}

double lit(const SceneBuilder& b, int second = 0, float relative = 0.005f) {
    FilmStage stage(b, by_rays(), true);
    return mean_of(stage, second, relative);
}

/// Glass with two parallel faces, 4 mm apart, that lies above the camera.
void add_lid(SceneBuilder& b, float green_left = 1) {
    const int glass = add_glass(b);
    if (green_left < 1) {
        b.material(glass).attenuation_distance = 0.004f;
        b.material(glass).attenuation_color = {1, green_left, 1};
    }
    b.add_box({-60, 1, -60}, {60, 1.004f, 60}, glass);
}

TEST(Panes, PassALampsLightAsBothFacesAndAllReflectionsBetweenThemLetIt) {
    const auto scene = [](bool pane) {
        SceneBuilder b = floor_below(dark);
        b.add_quad({-0.5f, 20, -0.5f}, {1, 0, 0}, {0, 0, 1}, b.add_emitter(glm::vec3(300)));
        if (pane) add_lid(b);
        return b;
    };
    // (1 - R)^2 / (1 - R^2) for R = 0.04; light comes to within 3 degrees of the normal.
    EXPECT_NEAR(lit(scene(true)) / lit(scene(false)), 0.96 / 1.04, 0.003);
}

TEST(Panes, TakeWhatTheirGlassAbsorbs) {
    const auto green = [](float left) {
        SceneBuilder b = floor_below(dark);
        b.add_sun({0, -1, 0}, 1);
        add_lid(b, left);
        FilmStage stage(b, by_rays(), true);
        return static_cast<double>(stage.cut(0.005f).combined.at(12, 12).g);
    };
    const double r = 0.04, expected = 0.5 * (1 - r) * (1 - r) / (1 - 0.25 * r * r) / ((1 - r) / (1 + r));
    EXPECT_NEAR(green(0.5f) / green(1.0f), expected, 0.002);
}

TEST(Panes, PassTheSkyToGatherRaysSlow) {
    SceneBuilder b = floor_below(dark);
    b.film().sky.color = glm::vec3(1);
    add_lid(b);
    double passes = 0;
    constexpr int n = 1000;
    for (int i = 0; i < n; ++i) {
        const double cosine = std::sqrt((i + 0.5) / n);
        const double r = static_cast<double>(renderer::dielectric_reflectance(static_cast<float>(cosine), 1.5f));
        passes += (1 - r) / (1 + r) / n;
    }
    // At the horizon the pane ends.
    EXPECT_NEAR(lit(b), dark * passes, 0.01 * dark * passes);
}

/// A pane that stands beside what the camera sees, under an even sky; `moves`: it comes there in a second.
SceneBuilder beside_a_window(bool thin, bool moves) {
    SceneBuilder b = floor_below();
    b.film().sky.color = glm::vec3(1);
    const int glass = add_glass(b);
    if (thin) b.material(glass).thickness = scene::Thickness::thin;
    const glm::vec3 at = moves ? glm::vec3(40, 0, 0) : glm::vec3(0);
    const scene::Mesh mesh = thin ? SceneBuilder::quad({0, 0, 3}, {0, 0, -6}, {0, 3, 0})
                                  : SceneBuilder::box({-0.004f, 0, -3}, {0, 3, 3}, false);
    const int pane = b.add_object(b.add_mesh(mesh), glass, at);
    if (moves) b.move_object(pane, {at, {0, 0, 0}});
    return b;
}

TEST(Panes, MirrorTheFloorBackToIt) {
    // E = E0 / (1 - albedo R), with R what both faces mirror of even light.
    double lets = 0, mirrors = 0;
    constexpr int n = 1000;
    for (int i = 0; i < n; ++i) {
        const double cosine = std::sqrt((i + 0.5) / n);
        const double r = static_cast<double>(renderer::dielectric_reflectance(static_cast<float>(cosine), 1.5f));
        lets += (1 - r) / (1 + r) / n;
        mirrors += 2 * r / (1 + r) / n;
    }
    SceneBuilder b = floor_below(0.8f);
    b.film().sky.color = glm::vec3(1);
    add_lid(b);
    const double expected = 0.8 * lets / (1 - 0.8 * mirrors);
    EXPECT_NEAR(lit(b), expected, 0.01 * expected);
}

TEST(Panes, InAFurnaceAreNotSeen) {
    // What a pane keeps from the floor of the sky behind it, it mirrors of the sky before it.
    EXPECT_NEAR(lit(beside_a_window(false, false)), 0.5, 0.004);
    EXPECT_NEAR(lit(beside_a_window(true, false)), 0.5, 0.004);
    EXPECT_NEAR(lit(beside_a_window(false, true), 1), 0.5, 0.004);
}

TEST(Panes, CostNoPhotonsBelowASkyAndBallsDoSlow) {
    for (const bool ball : {false, true}) {
        SceneBuilder b = beside_a_window(false, false);
        if (ball) b.add_sphere({0.3f, 0.1f, 0}, 0.1f, add_glass(b), 12);
        FilmStage stage(b, by_rays(), true);
        mean_of(stage, 0, 0.1f);
        EXPECT_EQ(stage.statistics().caustic_photons > 0, ball);
    }
}

TEST(Panes, MirrorASunOntoTheFloorByPhotons) {
    // The sun stands at 45 degrees, so that all of the camera's square has the pane's mirrored light.
    SceneBuilder b = floor_below();
    b.add_sun({-1, -1, 0}, 1);
    const double without = lit(b);
    b.add_box({-0.004f, 0, -3}, {0, 3, 3}, add_glass(b));
    const double r = static_cast<double>(renderer::dielectric_reflectance(std::sqrt(0.5f), 1.5f));
    EXPECT_NEAR(lit(b) / without, 1 + 2 * r / (1 + r), 0.01);
}

TEST(SolidGlass, PassesWhatSurfacesBounceWhereCausticsHaveLightOfLampsSlow) {
    // A roof that a lamp lights from below; a plate below the lamp hides it from the floor.
    const auto light = [](bool glass, bool caustics) {
        SceneBuilder b = floor_below();
        const int grey = b.add_material(glm::vec3(0.5f));
        b.add_quad({-20, 3, -20}, {40, 0, 0}, {0, 0, 40}, grey);
        b.add_point_light({0, 2.6f, 0}, 10);
        b.add_quad({-1, 2.5f, -1}, {2, 0, 0}, {0, 0, 2}, b.add_material(glm::vec3(0)));
        if (glass) b.add_box({-4, 1, -4}, {4, 1.9f, 4}, add_glass(b));
        FilmStage stage(b, by_rays(), caustics);
        return mean_of(stage, 0, 0.02f);
    };
    const double passing = light(true, false);
    EXPECT_GT(passing, 0.7 * light(false, false));
    EXPECT_NEAR(light(true, true) / passing, 1.0, 0.03);
}

TEST(SolidGlass, PassesTheSkyHoweverWideTheSceneIsSlow) {
    // A thick plate a metre above what is seen, on a floor of this half width.
    const auto light = [](float half, bool glass) {
        SceneBuilder b;
        b.add_quad({-half, 0, half}, {2 * half, 0, 0}, {0, 0, -2 * half}, b.add_material(glm::vec3(0.1f)));
        b.film().sky.color = glm::vec3(1);
        if (glass) b.add_box({-1.5f, 1, -1.5f}, {1.5f, 1.8f, 1.5f}, add_glass(b));
        b.add_camera({0, 0.5f, 0.01f}, {0, 0, 0}, 0.5f);
        return lit(b, 0, 0.02f);
    };
    const double narrow = light(2, true);
    EXPECT_GT(narrow, 0.85 * light(2, false));
    EXPECT_NEAR(light(200, true) / narrow, 1.0, 0.03);
}

}  // namespace
}  // namespace render2mpeg::test
