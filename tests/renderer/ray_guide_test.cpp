#include "renderer/gather/ray_guide.h"

#include <gtest/gtest.h>

#include <cmath>

#include "renderer/base/stream.h"

namespace render2mpeg::renderer {
namespace {

/// A window: bright in a small rectangle of the square, dim elsewhere.
double window(glm::vec2 u) {
    return u.x > 0.61f && u.x < 0.7f && u.y > 0.3f && u.y < 0.41f ? 20.0 : 0.05 + 0.05 * u.x;
}
constexpr double window_mean = 20.0 * 0.09 * 0.11 + (0.05 + 0.025) - 0.09 * 0.11 * (0.05 + 0.05 * 0.655);

RayGuide taught(std::uint32_t rays, double (*light)(glm::vec2)) {
    RayGuide guide;
    for (std::uint32_t i = 0; i < rays; ++i) {
        const glm::vec2 u = Stream(Purpose::guided_rays, {.index = 7}).sobol(i);
        guide.add(RayGuide::cell_of(u), light(u));
    }
    guide.learn();
    return guide;
}

struct Moments {
    double mean = 0, variance = 0, area = 0;
};
Moments drawn(const RayGuide& guide, double (*light)(glm::vec2)) {
    constexpr std::uint32_t count = 1u << 16;
    Moments m;
    double square = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
        const auto [u, density] = guide.draw(Stream(Purpose::guided_rays, {.index = 11}).sobol(i));
        EXPECT_TRUE(u.x >= 0.0f && u.x < 1.0f && u.y >= 0.0f && u.y < 1.0f && density > 0.0f);
        m.area += 1.0 / density / count;
        m.mean += light(u) / density / count;
        square += light(u) * light(u) / density / density / count;
    }
    m.variance = square - m.mean * m.mean;
    return m;
}

TEST(RayGuide, DrawsByTheDensityThatItTells) {
    const Moments m = drawn(taught(256, window), window);
    EXPECT_NEAR(m.area, 1.0, 2e-3);
    EXPECT_NEAR(m.mean, window_mean, 0.01 * window_mean);
}

TEST(RayGuide, LeavesLittleOfTheVarianceOfASmallBrightSpot) {
    const double even = 400.0 * 0.09 * 0.11 - window_mean * window_mean;
    const RayGuide guide = taught(256, window);
    EXPECT_LT(drawn(guide, window).variance, 0.3 * even);
    EXPECT_LT(guide.variance_share(), 0.6);
    // What it draws itself teaches it more.
    RayGuide again = guide;
    for (std::uint32_t i = 0; i < 4096; ++i) {
        const glm::vec2 u = guide.draw(Stream(Purpose::guided_rays, {.index = 13}).sobol(i)).u;
        again.add(RayGuide::cell_of(u), window(u));
    }
    again.learn();
    EXPECT_LT(drawn(again, window).variance, 0.1 * even);
}

TEST(RayGuide, SaysThatEvenLightNeedsNone) {
    const RayGuide guide = taught(256, [](glm::vec2) { return 1.0; });
    EXPECT_GT(guide.variance_share(), 0.7);
    for (std::uint32_t i = 0; i < 64; ++i)
        EXPECT_NEAR(guide.draw(Stream(Purpose::guided_rays, {.index = 3}).sobol(i)).density, 1.0f, 0.2f);
}

TEST(RayGuide, SaysThatDarknessNeedsNone) {
    EXPECT_EQ(taught(256, [](glm::vec2) { return 0.0; }).variance_share(), 1.0);
    EXPECT_EQ(taught(0, window).variance_share(), 1.0);
}

}  // namespace
}  // namespace render2mpeg::renderer
