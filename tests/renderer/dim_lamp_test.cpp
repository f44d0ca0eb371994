// A dim lamp in the room that is seen, beside one of 1e12 times its power that is not.
#include <gtest/gtest.h>

#include <cmath>

#include "core/color.h"
#include "tests/renderer/virtual_light_stage.h"

namespace render2mpeg::renderer {
namespace {

using test::SceneBuilder;
using test::VirtualLightStage;

SceneBuilder two_rooms(float beyond) {
    SceneBuilder b;
    const int white = b.add_material(glm::vec3(0.5f));
    b.add_box({-2, 0, -2}, {2, 3, 2}, white, true);
    b.add_box({2.001f, 0, -2}, {6, 3, 2}, white, true);
    b.add_point_light({0, 2, 0}, 1);
    if (beyond > 0) b.add_point_light({4, 2, 0}, beyond);
    b.add_camera({0, 2.9f, 0}, {0, 0, 0}, 0.9f);
    return b;
}

/// Indirect irradiance at a hundred places of the first room's floor. Nothing hides anything in it.
std::vector<double> on_the_floor(float beyond, VirtualLightSettings settings) {
    VirtualLightStage stage(two_rooms(beyond), settings);
    stage.pose(0);
    const std::vector<LightPoint> lights = stage.light();
    std::vector<double> irradiance(100, 0);
    for (std::size_t i = 0; i < irradiance.size(); ++i) {
        const glm::vec3 at(-1.8f + 0.4f * static_cast<float>(i % 10), 0, -1.8f + 0.4f * static_cast<float>(i / 10));
        for (const LightPoint& l : lights) {
            const glm::vec3 way = l.position - at;
            const float d2 = glm::dot(way, way), from = -glm::dot(way, l.normal);
            if (l.position.x > 2 || way.y < 1e-3f || from <= 0) continue;
            irradiance[i] += core::luminance(l.intensity) * from * way.y / (d2 * (d2 + 0.01f));
        }
    }
    return irradiance;
}

TEST(DimLampSlow, BesideAHiddenOneOf1e12TimesItsPowerIsAsIfAlone) {
    const std::vector<double> reference = on_the_floor(0, {1 << 19, 8}), both = on_the_floor(1e12f, {1 << 17, 8});
    double mean = 0, square = 0;
    for (std::size_t i = 0; i < both.size(); ++i) {
        const double off = both[i] / reference[i] - 1;
        mean += off / static_cast<double>(both.size());
        square += off * off / static_cast<double>(both.size());
    }
    EXPECT_LE(std::abs(mean), 0.02);
    EXPECT_LE(std::sqrt(square), 0.05);
    EXPECT_GE(std::sqrt(square), 0.005);
}

}  // namespace
}  // namespace render2mpeg::renderer
