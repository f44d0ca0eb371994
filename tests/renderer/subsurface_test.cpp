#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/color.h"
#include "core/sampling.h"
#include "renderer/subsurface/probes.h"
#include "renderer/subsurface/profile.h"
#include "tests/renderer/film_stage.h"
#include "tests/renderer/stage.h"

namespace render2mpeg::renderer {
namespace {

using test::FilmStage;
using test::SceneBuilder;
using test::Stage;

constexpr double pi = std::numbers::pi;

TEST(SubsurfaceProfile, ShinesAllLightAndIsDrawnByItsDensity) {
    const SubsurfaceProfile profile({0.8f, 0.5f, 0.3f}, {1.0f, 0.4f, 0.2f});
    glm::dvec3 all(0);
    double density = 0;
    constexpr int n = 200000;
    const double step = static_cast<double>(profile.reach()) / n;
    for (int i = 0; i < n; ++i) {
        const double r = (i + 0.5) * step;
        all += 2 * pi * r * step * glm::dvec3(profile.at(static_cast<float>(r)));
        density += 2 * pi * r * step * static_cast<double>(profile.density(static_cast<float>(r)));
    }
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(all[c], 1, 0.005);
    EXPECT_NEAR(density, 1, 0.005);
    double drawn = 0, meant = 0;
    for (int i = 0; i < n; ++i) {
        const auto number = static_cast<std::uint64_t>(i);
        drawn += static_cast<double>(profile.sample(core::uniform(number, 0, 0), core::uniform(number, 0, 1))) / n;
        const double r = (i + 0.5) * step;
        meant += 2 * pi * r * r * step * static_cast<double>(profile.density(static_cast<float>(r)));
    }
    EXPECT_NEAR(drawn, meant, 0.01 * meant);
}

int skin(SceneBuilder& b, float free_path) {
    const int material = b.add_material({0.8f, 0.5f, 0.3f});
    b.material(material).subsurface = scene::Subsurface{1.0f, glm::vec3(free_path)};
    b.material(material).double_sided = true;
    return material;
}

/// Mean of what probes around a point of the first object find, as reflectance.
glm::dvec3 found_at(const Stage& stage, glm::vec3 from, glm::vec3 to, int n = 4000) {
    const Hit hit = stage.tracer().nearest(from, to, 1e3f);
    SurfacePoint p = stage.posed_scene().surface_at(hit.address, -to);
    EXPECT_TRUE(p.spreads);
    p.below = true;
    glm::dvec3 sum(0);
    for (int i = 0; i < n; ++i)
        if (const auto place = probe(stage.posed_scene(), p, core::mix(static_cast<std::uint64_t>(i))))
            sum += glm::dvec3(place->bsdf.diffuse) / static_cast<double>(n);
    return sum;
}

TEST(Subsurface, OfASemiInfiniteSlabReflectsItsAlbedo) {
    SceneBuilder b;
    b.add_quad({-50, 0, 50}, {100, 0, 0}, {0, 0, -100}, skin(b, 0.1f));
    b.add_sun({0, -1, 0}, 1);
    const glm::dvec3 reflectance = found_at(Stage(b), {0.3f, 2, 0.1f}, {0, -1, 0});
    const double albedo[3] = {0.8, 0.5, 0.3};
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(reflectance[c], albedo[c], 0.02 * albedo[c]);
}

TEST(Subsurface, ReflectsLessAtAnEdgeAndNothingAcrossAGapToAnotherThing) {
    const auto edge = [](bool neighbour) {
        SceneBuilder b;
        const int material = skin(b, 0.3f);
        b.add_quad({-50, 0, 50}, {50, 0, 0}, {0, 0, -100}, material);
        if (neighbour) b.add_quad({0.01f, 0, 50}, {50, 0, 0}, {0, 0, -100}, material);
        b.add_sun({0, -1, 0}, 1);
        return found_at(Stage(b), {-1e-3f, 2, 0.1f}, {0, -1, 0});
    };
    const glm::dvec3 alone = edge(false), beside = edge(true);
    EXPECT_NEAR(alone.x, 0.4, 0.03);
    EXPECT_NEAR(beside.x, alone.x, 1e-9);
}

TEST(Subsurface, LetsLightThroughThinParts) {
    const auto lit_from_behind = [](float thickness) {
        SceneBuilder b;
        b.add_box({-1, -1, -thickness}, {1, 1, 0}, skin(b, 0.3f));
        b.add_sun({0, 0, 1}, static_cast<float>(pi));
        b.add_camera({0, 0, 4}, {0, 0, 0}, 0.2f);
        Settings settings = test::small_frame(12, 12);
        settings.samples = 16;
        settings.indirect = Indirect::rays;
        FilmStage stage(b, settings);
        return static_cast<double>(core::luminance(stage.cut(0.05f).combined.at(6, 6)));
    };
    const double thin = lit_from_behind(0.05f), thick = lit_from_behind(5.0f);
    EXPECT_GT(thin, 0.05);
    EXPECT_LT(thick, 0.01 * thin);
}

TEST(Subsurface, BlursTheEdgeOfAShadowAndKeepsItsMean) {
    const auto row = [](bool below) {
        SceneBuilder b;
        const int material = skin(b, 0.2f);
        if (!below) b.material(material).subsurface.reset();
        b.add_quad({-20, 0, 20}, {40, 0, 0}, {0, 0, -40}, material);
        b.add_box({-20, 3, -20}, {0, 3.1f, 20}, b.add_material(glm::vec3(0)));
        b.add_sun({0, -1, 0}, static_cast<float>(pi));
        b.add_camera({0, 2, 0.01f}, {0, 0, 0}, 0.9f);
        Settings settings = test::small_frame(32, 8);
        settings.samples = 16;
        settings.indirect = Indirect::rays;
        FilmStage stage(b, settings);
        const core::Radiance r = stage.cut(0.05f);
        std::vector<double> means;
        for (int x = 0; x < 32; ++x) {
            double sum = 0;
            for (int y = 0; y < 8; ++y) sum += static_cast<double>(r.combined.at(x, y).y) / 8;
            means.push_back(sum);
        }
        return means;
    };
    const std::vector<double> sharp = row(false), soft = row(true);
    double all_sharp = 0, all_soft = 0;
    for (std::size_t x = 0; x < 32; ++x) all_sharp += sharp[x], all_soft += soft[x];
    EXPECT_NEAR(all_soft, all_sharp, 0.05 * all_sharp);
    EXPECT_LT(sharp[13], 0.05);
    EXPECT_GT(soft[14], 2 * sharp[14] + 0.01);
    EXPECT_LT(soft[17], 0.95 * sharp[17]);
}

}  // namespace
}  // namespace render2mpeg::renderer
