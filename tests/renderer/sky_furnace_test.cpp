#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "scene/model/png.h"
#include "tests/renderer/film_stage.h"

/// Skies on bodies that shadow nothing of themselves, where the answer is known.
namespace render2mpeg::renderer {
namespace {

using test::FilmStage;
using test::SceneBuilder;

/// Largest relative error of the lit pixels of `stage` against `expected`, in any channel.
double largest_error(FilmStage& stage, glm::vec3 expected) {
    const Frame seen = stage.renderer().look(stage.at(0));
    const core::Radiance r = stage.reference();
    double largest = 0;
    int compared = 0;
    for (std::size_t i = 0; i < r.combined.size(); ++i) {
        if (seen.visible.kind.values()[i] != core::PixelClass::surface) continue;
        ++compared;
        const glm::vec3 ratio = r.combined.values()[i] / expected;
        for (int k = 0; k < 3; ++k) largest = std::max(largest, std::abs(static_cast<double>(ratio[k]) - 1));
    }
    EXPECT_GT(compared, 200);
    return largest;
}

/// A box that shows three of its sides.
FilmStage box_under_sky(int lights) {
    SceneBuilder b;
    b.add_box({-1, -1, -1}, {1, 1, 1}, b.add_material({0.6f, 0.5f, 0.4f}));
    b.film().sky.color = {2, 1, 0.5f};
    b.add_camera({4, 3, 5}, {0, 0, 0}, 0.5f);
    Settings settings = test::small_frame(32, 32);
    settings.direct_points = lights;
    settings.vpls = 0;
    return FilmStage(b, settings);
}

TEST(SkyFurnace, OfAFlatSidedConvexBodyIsReflectanceTimesSkyAndNearerWithMoreLights) {
    FilmStage few = box_under_sky(500), many = box_under_sky(8000);
    const glm::vec3 expected{0.6f * 2, 0.5f * 1, 0.4f * 0.5f};
    const double coarse = largest_error(few, expected), fine = largest_error(many, expected);
    RecordProperty("error_with_500_lights", std::to_string(coarse));
    RecordProperty("error_with_8000_lights", std::to_string(fine));
    // chosen: measured 2e-4 and 3e-6.
    EXPECT_LT(coarse, 1e-3);
    EXPECT_LT(fine, 3e-5);
}

TEST(SkyFurnace, OfAFloorIsWithoutTheSkyThatLiesBelowTheHorizon) {
    // A sky that shines for an eighth of a half turn on either side of the horizon lights a floor by sin^2 of that.
    constexpr int width = 64, height = 32;
    std::vector<glm::u8vec4> texels(std::size_t{width} * height, {0, 0, 0, 255});
    std::fill(texels.begin() + 12 * width, texels.begin() + 20 * width, glm::u8vec4(255));
    SceneBuilder b;
    b.add_quad({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, b.add_material({0.6f, 0.6f, 0.6f}));
    b.film().images.push_back({"sky", {}, scene::encode_png(width, height, texels)});
    b.film().sky.image = 0;
    b.film().sky.color = glm::vec3(1);
    b.add_camera({0, 3, 0.1f}, {0, 0, 0}, 0.4f);
    Settings settings = test::small_frame(16, 16);
    FilmStage stage(b, settings);
    const core::Radiance lit = stage.cut(0.02f);
    double mean = 0;
    for (const glm::vec3& r : lit.combined.values()) mean += static_cast<double>(r.x) / (16 * 16);
    const double height_of_band = std::sin(std::numbers::pi / 8);
    EXPECT_NEAR(mean / (0.6 * height_of_band * height_of_band), 1.0, 0.02);
}

}  // namespace
}  // namespace render2mpeg::renderer
