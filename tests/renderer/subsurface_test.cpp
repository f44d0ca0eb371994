#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/color.h"
#include "core/sampling.h"
#include "renderer/subsurface/random_walk.h"
#include "tests/renderer/film_stage.h"
#include "tests/renderer/stage.h"

namespace render2mpeg::renderer {
namespace {

using test::FilmStage;
using test::SceneBuilder;
using test::Stage;

constexpr double pi = std::numbers::pi;

int skin(SceneBuilder& b, float free_path) {
    const int material = b.add_material({0.8f, 0.5f, 0.3f});
    b.material(material).subsurface = scene::Subsurface{1.0f, glm::vec3(free_path)};
    b.material(material).double_sided = true;
    return material;
}

/// Mean of what walks from a point of the first object come to, as reflectance.
glm::dvec3 found_at(const Stage& stage, glm::vec3 from, glm::vec3 to, int n = 20000) {
    const Hit hit = stage.tracer().nearest(from, to, 1e3f);
    SurfacePoint p = stage.posed_scene().surface_at(hit.address, -to);
    EXPECT_TRUE(p.spreads);
    p.below = true;
    glm::dvec3 sum(0);
    for (int i = 0; i < n; ++i)
        if (const auto place =
                random_walk(stage.posed_scene(), p, Stream(Purpose::strands).at(static_cast<std::uint64_t>(i))))
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

TEST(Subsurface, OfBlackSkinBringsNothing) {
    SceneBuilder b;
    const int material = skin(b, 0.1f);
    b.add_sphere({0, 0, 0}, 0.05f, material, 24);
    b.add_sun({0, -1, 0}, 1);
    const Stage stage(b);
    const Hit hit = stage.tracer().nearest({0.01f, 2, 0.01f}, {0, -1, 0}, 1e3f);
    SurfacePoint p = stage.posed_scene().surface_at(hit.address, {0, 1, 0});
    p.below = true;
    for (const float albedo : {0.0f, 1e-30f, 1e-8f}) {
        p.bsdf.diffuse = glm::vec3(albedo);
        for (std::uint64_t i = 0; i < 2000; ++i)
            if (const auto place = random_walk(stage.posed_scene(), p, Stream(Purpose::strands).at(i))) {
                EXPECT_LT(core::luminance(place->bsdf.diffuse), 10.0f) << albedo;
            }
    }
}

/// Slow and plain: an analog walk in a ball of radius 1, in double precision. Returns the share that leaves.
double share_of_ball(double albedo, double path, int n) {
    std::uint64_t drawn = 0;
    const auto next = [&] { return (static_cast<double>(core::mix(++drawn) >> 11) + 0.5) * 0x1p-53; };
    int left = 0;
    for (int i = 0; i < n; ++i) {
        glm::dvec3 at(0, 0, 1);
        const double phi = 2 * pi * next(), down = std::sqrt(next()), across = std::sqrt(1 - down * down);
        glm::dvec3 d(across * std::cos(phi), across * std::sin(phi), -down);
        for (;;) {
            const double b = glm::dot(at, d), out = -b + std::sqrt(std::max(b * b + 1 - glm::dot(at, at), 0.0));
            const double far = -path * std::log(next());
            if (far >= out && ++left) break;
            if (next() >= albedo) break;
            at += far * d;
            const double z = 2 * next() - 1, turn = 2 * pi * next(), s = std::sqrt(1 - z * z);
            d = {s * std::cos(turn), s * std::sin(turn), z};
        }
    }
    return left / static_cast<double>(n);
}

TEST(Subsurface, OfABallIsThatOfASlowWalkForEachChannel) {
    SceneBuilder b;
    const int material = skin(b, 0.1f);
    b.material(material).subsurface->free_path = {0.1f, 0.3f, 0.02f};
    b.add_sphere({0, 0, 0}, 1.0f, material, 96);
    b.add_sun({0, -1, 0}, 1);
    const glm::dvec3 reflectance = found_at(Stage(b), {0.1f, 0.2f, 3}, {0, 0, -1});
    const float colors[3] = {0.8f, 0.5f, 0.3f};
    const double paths[3] = {0.1, 0.3, 0.02};
    for (int c = 0; c < 3; ++c) {
        const double walked = share_of_ball(static_cast<double>(scattering_albedo(colors[c])), paths[c], 40000);
        EXPECT_NEAR(reflectance[c], walked, 0.02 * walked + 0.004) << c;
        EXPECT_GT(reflectance[c], static_cast<double>(colors[c])) << "light leaves a ball sooner than a plane";
    }
}

TEST(Subsurface, SendsNothingAcrossAGapToAnotherThing) {
    const auto beside = [](bool neighbour) {
        SceneBuilder b;
        const int material = skin(b, 0.3f);
        b.add_box({-1, -1, -1}, {0, 0, 1}, material);
        if (neighbour) b.add_box({0.01f, -1, -1}, {1, 0, 1}, material);
        b.add_sun({0, -1, 0}, 1);
        return found_at(Stage(b), {-0.05f, 2, 0.1f}, {0, -1, 0});
    };
    EXPECT_NEAR(beside(true).x, beside(false).x, 1e-9);
}

TEST(Subsurface, LetsLightThroughThinParts) {
    const auto lit_from_behind = [](float thickness) {
        SceneBuilder b;
        b.add_box({-1, -1, -thickness}, {1, 1, 0}, skin(b, 0.3f));
        b.add_sun({0, 0, 1}, static_cast<float>(pi));
        b.add_camera({0, 0, 4}, {0, 0, 0}, 0.2f);
        Settings settings = test::small_frame(12, 12);
        settings.samples = 16;
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
    EXPECT_LT(soft[17], 0.97 * sharp[17]);
}

}  // namespace
}  // namespace render2mpeg::renderer
