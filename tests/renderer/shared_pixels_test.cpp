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

/// Slats before a sunny room, four to a pixel; each is an object, so that none serves another.
SceneBuilder slats() {
    SceneBuilder b = test::furnished_room();
    const int white = b.add_material(glm::vec3(0.6f));
    constexpr float pitch = 0.011f;
    for (int k = -55; k < 55; ++k) {
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
Picture look(int samples, float tolerance, bool are_prices) {
    Settings s = test::small_frame(shared_size, shared_size);
    s.cache = CacheUse::on;
    s.samples = samples;
    FilmStage stage(slats(), s);
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

TEST(PointsOfAPixel, KeepBoundsTogetherSlow) {
    const Picture many = look(16, tolerance(), false);
    const Picture& exact = exact_of_many();
    // Rays err by a standard error of 1 / 1.3 of it, and cuts besides.
    EXPECT_LT(error(many, exact), tolerance());
    EXPECT_GT(error(many, exact), tolerance() / 10);
}

}  // namespace
}  // namespace render2mpeg::renderer
