// Films as they are by default, where gathering by rays could leave traces: held against paths.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/color.h"
#include "tests/renderer/door_stage.h"
#include "tests/renderer/film_stage.h"

namespace render2mpeg::renderer {
namespace {

using test::SceneBuilder;

constexpr int columns = 32, rows = 24;

/// A room without lamps, and an emitter behind a window of a fortieth of its wall.
SceneBuilder small_window() {
    SceneBuilder b;
    const int white = b.add_material(glm::vec3(0.7f));
    b.add_quad({0, 0, 4}, {4, 0, 0}, {0, 0, -4}, white);
    b.add_quad({0, 3, 0}, {4, 0, 0}, {0, 0, 4}, white);
    b.add_quad({0, 0, 0}, {4, 0, 0}, {0, 3, 0}, white);
    b.add_quad({4, 0, 4}, {-4, 0, 0}, {0, 3, 0}, white);
    b.add_quad({4, 0, 0}, {0, 0, 4}, {0, 3, 0}, white);
    // The wall about the window.
    b.add_quad({0, 0, 4}, {0, 0, -4}, {0, 1.5f, 0}, white);
    b.add_quad({0, 2.05f, 4}, {0, 0, -4}, {0, 0.95f, 0}, white);
    b.add_quad({0, 1.5f, 4}, {0, 0, -1.5f}, {0, 0.55f, 0}, white);
    b.add_quad({0, 1.5f, 1.95f}, {0, 0, -1.95f}, {0, 0.55f, 0}, white);
    b.add_quad({-3, -2, 6}, {0, 0, -8}, {0, 8, 0}, b.add_emitter(glm::vec3(10)));
    b.add_camera({0.3f, 1.6f, 3.7f}, {2.5f, 0.8f, 0.5f}, 1.0f);
    return b;
}

/// A smooth floor of a glossy paint and a block that touches it.
SceneBuilder contact() {
    SceneBuilder b;
    const int white = b.add_material(glm::vec3(0.7f)), floor = b.add_material({0.4f, 0.3f, 0.2f});
    b.material(floor).roughness = 0.3f;
    b.add_box({0, 0.001f, 0}, {4, 3, 4}, white, true);
    b.add_quad({0, 0.002f, 4}, {4, 0, 0}, {0, 0, -4}, floor);
    b.add_box({1.2f, 0, 1}, {2.4f, 0.8f, 2.2f}, white);
    b.add_quad({1, 2.9f, 1}, {1, 0, 0}, {0, 0, 1}, b.add_emitter(glm::vec3(12)));
    b.add_camera({2.0f, 1.6f, 3.8f}, {2.0f, 0.5f, 1.0f}, 1.0f);
    return b;
}

struct Place {
    const char* name;
    SceneBuilder (*scene)();
    int second;
    double off = 0.04;   ///< of the mean, at most
    double over = 0.05;  ///< share of pixels off by three standard errors, at most
};

class HardLightSlow : public testing::TestWithParam<Place> {};

/// Root mean square of what a column differs by from the mean of those beside it, of differences between frames as
/// shares of the truth: a comb or a screen-door grid has all of its energy there.
double teeth(const core::Plane<glm::vec3>& frame, const core::Plane<glm::vec3>& truth) {
    const auto off = [&](int x, int y) {
        const float t = core::luminance(truth.at(x, y));
        return static_cast<double>((core::luminance(frame.at(x, y)) - t) / (t + 1e-3f));
    };
    double squares = 0;
    for (int y = 0; y < rows; ++y)
        for (int x = 1; x + 1 < columns; ++x)
            squares += std::pow(off(x, y) - 0.5 * (off(x - 1, y) + off(x + 1, y)), 2) / (rows * (columns - 2));
    return std::sqrt(squares);
}

TEST_P(HardLightSlow, IsThatOfPaths) {
    Settings settings = test::small_frame(columns, rows);
    settings.cache = CacheUse::on;
    settings.samples = 4;
    settings.direct_points = 1024;
    constexpr float tolerance = 0.04f, finely = 0.03f;
    test::FilmStage stage(GetParam().scene(), settings);
    const core::Radiance found = stage.cut(tolerance, GetParam().second);
    const scene::Snapshot world = stage.at(GetParam().second);
    const core::ToleranceMap none = core::ToleranceMap::reference();
    const LightOrder by_paths{none, LightingMode::truth, {}, nullptr, {finely, 1u << 13, 1}};
    const core::Radiance truth = stage.renderer().light(world, stage.renderer().look(world), by_paths).radiance;

    // The mean, in all and of the darker half: nothing leaks, nothing is lost.
    std::vector<std::pair<float, float>> pixels;
    for (std::size_t i = 0; i < truth.combined.size(); ++i)
        pixels.emplace_back(core::luminance(truth.combined.values()[i]), core::luminance(found.combined.values()[i]));
    std::sort(pixels.begin(), pixels.end());
    double expected = 0, mean = 0;
    for (std::size_t i = 0; i < pixels.size(); ++i) {
        expected += static_cast<double>(pixels[i].first);
        mean += static_cast<double>(pixels[i].second);
        if (i + 1 == pixels.size() / 2) {
            EXPECT_NEAR(mean, expected, (GetParam().off + 0.01) * expected) << "darker half";
        }
    }
    EXPECT_NEAR(mean, expected, GetParam().off * expected);
    // Pixels: a tolerance is 1.3 standard errors, and the truth has its own.
    const double error = std::hypot(tolerance / 1.3, finely);
    int over = 0;
    for (std::size_t i = 0; i < truth.combined.size(); ++i) {
        const float t = core::luminance(truth.combined.values()[i]), f = core::luminance(found.combined.values()[i]);
        over += std::abs(f - t) > 3.0f * std::hypot(tolerance / 1.3f * t, truth.error.values()[i]) ? 1 : 0;
    }
    EXPECT_LT(over, GetParam().over * static_cast<double>(truth.combined.size()));
    // White errors of neighbours leave this much.
    EXPECT_LT(teeth(found.combined, truth.combined), 2 * std::sqrt(1.5) * error);
}

INSTANTIATE_TEST_SUITE_P(
    Places, HardLightSlow,
    // All cells behind a window hang on few rays: five sets of places are off by -5 to 5 %, mean 1.
    testing::Values(Place{"SmallWindow", small_window, 0, 0.1, 0.12}, Place{"Contact", contact, 0},
                    Place{"LampBehindADoor", test::rooms_with_a_door, 1}),
    [](const auto& place) { return std::string(place.param.name); });

}  // namespace
}  // namespace render2mpeg::renderer
