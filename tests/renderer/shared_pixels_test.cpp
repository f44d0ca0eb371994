// Rays of points that share a pixel.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>

#include "core/color.h"
#include "parallel/loops.h"
#include "tests/renderer/film_stage.h"

namespace render2mpeg::renderer {
namespace {

using test::FilmStage;
using test::SceneBuilder;

constexpr int shared_size = 24;

/// Slats before a sunny room, so many; a hundred are four to a pixel. Each is an object, so that none serves another.
SceneBuilder slats(int count) {
    SceneBuilder b = test::furnished_room();
    const int white = b.add_material(glm::vec3(0.6f));
    const float pitch = 1.21f / static_cast<float>(count);
    for (int k = -count / 2; k < count / 2; ++k) {
        const float x = 2 + pitch * static_cast<float>(k), turned = k % 2 == 0 ? 0.4f : -0.4f;
        b.add_quad({x, 0, 2.8f + (turned < 0 ? 0.4f * pitch : 0)}, {pitch, 0, turned * pitch}, {0, 3, 0}, white);
    }
    b.film().cameras.clear();
    b.add_camera({2, 1.5f, 3.9f}, {2, 1.5f, 0}, 0.9f);
    return b;
}

struct Picture {
    core::Radiance light;
    double rays = 0, points = 0;  ///< of a pixel; rays to cells count
};

/// Lit by prices, or within bounds, that are luminances.
Picture look(int samples, float tolerance, bool are_prices, int count = 110) {
    Settings s = test::small_frame(shared_size, shared_size);
    s.cache = CacheUse::on;
    s.samples = samples;
    FilmStage stage(slats(count), s);
    core::ToleranceMap map = core::ToleranceMap::uniform(shared_size, shared_size, {tolerance, 0.0f, 0.0f});
    if (are_prices) map.typical = 0.03f;
    Picture picture;
    picture.light = stage.shade(0, map);
    picture.rays = static_cast<double>(stage.statistics().gather_rays) / (shared_size * shared_size);
    picture.points = static_cast<double>(stage.statistics().gather_points) / (shared_size * shared_size);
    return picture;
}

/// Root mean square of what luminances differ by.
double error(const Picture& a, const Picture& b) {
    double squares = 0;
    for (std::size_t i = 0; i < a.light.combined.size(); ++i)
        squares +=
            std::pow(core::luminance(a.light.combined.values()[i]) - core::luminance(b.light.combined.values()[i]), 2);
    return std::sqrt(squares / (shared_size * shared_size));
}

/// Three hundredths of what pixels show.
float tolerance() {
    static const float found = [] {
        const Picture picture = look(1, 0.1f, false);
        float sum = 0;
        for (const glm::vec3& light : picture.light.combined.values()) sum += core::luminance(light);
        return 0.03f * sum / (shared_size * shared_size);
    }();
    return found;
}

const Picture& exact_of_many() {
    static const Picture exact = look(16, 0.1f * tolerance(), false);
    return exact;
}

TEST(PointsOfAPixel, TakeAboutAsManyRaysTogetherAsOneThatFillsItSlow) {
    const Picture one = look(1, tolerance(), true), many = look(16, tolerance(), true);
    EXPECT_EQ(one.points, 1);
    EXPECT_GT(many.points, 3.5);
    // Each by itself would take four times as many; their pilots alone are 64 rays.
    EXPECT_LT(many.rays, 2.0 * one.rays) << one.rays;
    EXPECT_GT(many.rays, 0.7 * one.rays) << one.rays;
    const double off = error(one, look(1, 0.1f * tolerance(), false)), off_together = error(many, exact_of_many());
    EXPECT_LT(off_together, 1.3 * off) << off;
    EXPECT_GT(off_together, 0.4 * off) << off;
}

TEST(PointsOfAPixel, ShareLightWhereTheyAreACrowdSlow) {
    constexpr int crowd = 1100;
    const Picture few = look(16, tolerance(), true), many = look(64, tolerance(), true, crowd),
                  exact = look(64, 0.1f * tolerance(), false, crowd);
    EXPECT_GT(many.points, 30);
    // Their pilots alone would be 500 rays.
    EXPECT_LT(many.rays, 2.0 * few.rays) << few.rays;
    EXPECT_LT(error(many, exact), 1.5 * error(few, exact_of_many()));
    EXPECT_GT(error(many, exact), 0.1 * tolerance()) << "they share";
    double light = 0, all = 0, told = 0;
    for (std::size_t i = 0; i < exact.light.combined.size(); ++i) {
        light += static_cast<double>(core::luminance(many.light.combined.values()[i]));
        all += static_cast<double>(core::luminance(exact.light.combined.values()[i]));
        told += std::pow(static_cast<double>(many.light.error.values()[i]), 2);
    }
    EXPECT_NEAR(light / all, 1.0, 0.01) << "none is lost";
    told = std::sqrt(told / (shared_size * shared_size));
    EXPECT_GT(told, 0.5 * error(many, exact));
    EXPECT_LT(told, 2.0 * error(many, exact));
}

/// Steps under a sun with a disc, of which a bar hides a part.
SceneBuilder sunny_steps(int count) {
    SceneBuilder b;
    const int white = b.add_material(glm::vec3(0.6f));
    const float pitch = 1.2f / static_cast<float>(count);
    for (int k = 0; k < count; ++k)
        b.add_quad({pitch * static_cast<float>(k), 0, pitch * static_cast<float>(k % 2)}, {pitch, 0, 0}, {0, 1.2f, 0},
                   white);
    b.add_quad({-1, 1, 20}, {3, 0, 0}, {0, 0.3f, 0}, white);
    b.film().lights[static_cast<std::size_t>(b.add_sun({0, -0.02f, -1}, 3))].angle = 0.015f;
    b.add_camera({0.6f, 0.6f, 1.2f}, {0.6f, 0.6f, 0}, 0.9f);
    return b;
}

TEST(PointsOfAPixel, TakeSunsRaysTogetherSlow) {
    struct Sunny {
        core::Radiance light;
        double rays = 0;
    };
    const auto look = [](int count, float tolerance) {
        Settings s = test::small_frame(shared_size, shared_size);
        s.cache = CacheUse::on;
        s.samples = 64;
        FilmStage stage(sunny_steps(count), s);
        core::ToleranceMap map = core::ToleranceMap::uniform(shared_size, shared_size, {tolerance, 0.0f, 0.0f});
        if (tolerance > 0.001f) map.typical = 0.03f;
        Sunny sunny;
        sunny.light = stage.shade(0, map);
        sunny.rays = static_cast<double>(stage.statistics().shadow_rays) / (shared_size * shared_size);
        return sunny;
    };
    const auto off = [](const Sunny& a, const Sunny& b) { return error({a.light}, {b.light}); };
    const Sunny few = look(12, 0.015f), many = look(1200, 0.015f), fine = look(12, 0.0005f),
                fine_of_many = look(1200, 0.0005f);
    EXPECT_GT(few.rays, 4) << "a penumbra is there";
    EXPECT_LT(many.rays, 5 * few.rays) << "of fifty points";
    EXPECT_GT(fine_of_many.rays, 4 * many.rays);
    EXPECT_LT(off(few, fine), 0.015);
    EXPECT_LT(off(many, fine_of_many), 0.015);
}

TEST(PointsOfAPixel, KeepBoundsTogetherSlow) {
    const Picture many = look(16, tolerance(), false);
    const Picture& exact = exact_of_many();
    // Rays err by a standard error of 1 / 1.3 of it, and cuts besides.
    EXPECT_LT(error(many, exact), tolerance());
    EXPECT_GT(error(many, exact), tolerance() / 10);
}

}  // namespace
}  // namespace render2mpeg::renderer
