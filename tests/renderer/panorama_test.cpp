#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/color.h"
#include "tests/renderer/film_stage.h"

/// Pictures of all directions: closed forms, and the same picture wherever its seam is.
namespace render2mpeg::renderer {
namespace {

using test::FilmStage;
using test::SceneBuilder;

constexpr int width = 64, height = 32;

scene::CameraLens all_around() {
    scene::CameraLens lens;
    scene::make_panorama(lens, {});
    return lens;
}

Settings panorama_frame(int samples = 1) {
    Settings settings = test::small_frame(width, height);
    settings.samples = samples;
    return settings;
}

TEST(PanoramaFurnace, AnEvenSkyIsAnEvenPicturePolesAndSeamIncluded) {
    SceneBuilder b;
    b.add_box({40, 40, 40}, {40.001f, 40.001f, 40.001f}, b.add_material());
    b.film().sky.color = {2, 1, 0.5f};
    b.add_camera(all_around(), {0, 0, 0}, {1, 0.3f, 1});
    FilmStage stage(b, panorama_frame(4));
    const core::Radiance lit = stage.cut(0.02f);
    for (const glm::vec3& r : lit.combined.values()) {
        EXPECT_NEAR(r.x, 2, 1e-5);
        EXPECT_NEAR(r.y, 1, 1e-5);
        EXPECT_NEAR(r.z, 0.5f, 1e-5);
    }
}

TEST(PanoramaFurnace, InAShiningRoomAllDirectionsShineAndNoneIsLost) {
    SceneBuilder b;
    b.add_box({-1, -1, -1}, {1, 1, 1}, b.add_emitter({3, 2, 1}), true);
    b.add_camera(all_around(), {0.2f, 0.1f, -0.3f}, {0.2f, 0.1f, -1});
    FilmStage stage(b, panorama_frame(4));
    const core::Radiance lit = stage.cut(0.02f);
    for (const glm::vec3& r : lit.combined.values()) EXPECT_NEAR(glm::distance(r, glm::vec3(3, 2, 1)), 0, 1e-5);
    const Frame seen = stage.renderer().look(stage.at(0));
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            EXPECT_EQ(seen.visible.kind.at(x, y), core::PixelClass::surface);
            // Depth is the distance to the nearest wall along the ray.
            const glm::vec3 d = stage.at(0).camera.ray_through(glm::vec2(x, y) + 0.5f).direction;
            const glm::vec3 eye{0.2f, 0.1f, -0.3f}, ways = (glm::sign(d) - eye) / d;
            const float nearest = std::min({ways.x, ways.y, ways.z});
            EXPECT_NEAR(seen.visible.depth.at(x, y), nearest, 1e-4f);
        }
}

/// A furnished room; the eye in it looks this way.
SceneBuilder room_about(glm::vec3 ahead) {
    SceneBuilder b = test::furnished_room();
    b.film().cameras.clear();
    const glm::vec3 eye{2.0f, 1.5f, 2.2f};
    b.add_camera(all_around(), eye, eye + ahead);
    return b;
}

/// Things that show their colours whatever the light, one of which may move past on the side of +x.
SceneBuilder colors_about(glm::vec3 ahead, bool moves) {
    SceneBuilder b;
    const auto unlit = [&](glm::vec3 color) {
        const int m = b.add_material(color);
        b.material(m).unlit = true;
        return m;
    };
    b.add_sun({0, -1, 0}, 1);
    b.add_box({-3, -3, -3}, {3, 3, 3}, unlit({0.2f, 0.3f, 0.4f}), true);
    b.add_sphere({0, 0, 2}, 0.7f, unlit({0.9f, 0.5f, 0.1f}), 12);
    b.add_sphere({0.3f, 2, 0.1f}, 0.5f, unlit({0.1f, 0.5f, 0.9f}), 12);
    const int ball = b.add_mesh(SceneBuilder::sphere(0.6f, 16));
    const int object = b.add_object(ball, unlit({1, 1, 1}), {2, 0.1, 0});
    if (moves) {
        b.move_object(object, {{2, 0.1f, 0}, {2, 0.4f, 4}});
        b.film().shutter.angle = 180;
    }
    b.add_camera(all_around(), {0, 0, 0}, ahead);
    return b;
}

/// Mean and largest difference of the luminances of a picture and one that looks the other way, over the mean.
std::pair<double, double> differ(const core::Radiance& a, const core::Radiance& opposite) {
    double sum = 0, largest = 0, mean = 0;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const float here = core::luminance(a.combined.at(x, y)),
                        there = core::luminance(opposite.combined.at((x + width / 2) % width, y));
            EXPECT_TRUE(std::isfinite(here));
            const double off = std::abs(static_cast<double>(here) - static_cast<double>(there));
            sum += off;
            largest = std::max(largest, off);
            mean += static_cast<double>(here);
        }
    return {sum / mean, largest * width * height / mean};
}

TEST(PanoramaSeam, ShowsThePictureThatIsInTheMiddleOfOneThatLooksTheOtherWay) {
    FilmStage ahead(colors_about({1, 0, 0}, false), panorama_frame(4)),
        back(colors_about({-1, 0, 0}, false), panorama_frame(4));
    const auto [mean, largest] = differ(ahead.reference(), back.reference());
    EXPECT_LT(mean, 1e-4);
    EXPECT_LT(largest, 0.01);
}

TEST(PanoramaSeam, HasLightAsSmoothAsElsewhereSlow) {
    // Records on either side of the seam are each other's neighbours.
    FilmStage ahead(room_about({1, 0, 0}), panorama_frame()), back(room_about({-1, 0, 0}), panorama_frame());
    const core::Radiance a = ahead.cut(0.05f), b = back.cut(0.05f), truth = ahead.reference();
    const auto off_in = [&](const core::Radiance& lit, int seam, int shift) {
        double off = 0;
        for (int y = height / 4; y < 3 * height / 4; ++y)
            for (int k = -3; k < 3; ++k) {
                const int x = (seam + k + width) % width;
                const float exact = core::luminance(truth.combined.at(x, y));
                const float found = core::luminance(lit.combined.at((x + shift) % width, y));
                off += std::abs(static_cast<double>(found / exact) - 1) / (height / 2 * 6);
            }
        return off;
    };
    // Columns about the first picture's seam, as it shows them and as the other one does in its middle.
    const double at_seam = off_in(a, 0, 0), in_middle = off_in(b, 0, width / 2);
    RecordProperty("at_seam", std::to_string(at_seam));
    RecordProperty("in_middle", std::to_string(in_middle));
    EXPECT_LT(at_seam, 1.5 * in_middle + 2e-3);
    EXPECT_LT(at_seam, 0.05);
}

TEST(PanoramaSeam, BlursWhatMovesAcrossItAsElsewhere) {
    const auto lit = [](glm::vec3 ahead, bool moves) {
        FilmStage stage(colors_about(ahead, moves), panorama_frame(4));
        const scene::Snapshot world = stage.at(0);
        const core::ToleranceMap exact = core::ToleranceMap::reference();
        return stage.renderer()
            .light(world, stage.renderer().look(world), {exact, LightingMode::film, ExposureSamples{16, 16}})
            .radiance;
    };
    const core::Radiance ahead = lit({-1, 0, 0}, true), back = lit({1, 0, 0}, true);
    const double blur = differ(lit({-1, 0, 0}, false), back).first;
    EXPECT_GT(blur, 1e-2);
    EXPECT_LT(differ(ahead, back).first, 0.02 * blur);
}

TEST(PanoramaPoles, AreFiniteUnderAFinelyDividedDomeWithGlossAndGlass) {
    SceneBuilder b;
    const int shiny = b.add_material({0.8f, 0.5f, 0.3f});
    b.material(shiny).metallic = 1;
    b.material(shiny).roughness = 0.3f;
    const int glass = b.add_material({1, 1, 1});
    b.material(glass).transmission = 1;
    b.material(glass).roughness = 0;
    b.add_sphere({0, 2, 0}, 0.5f, glass, 16);
    b.add_sphere({0, -2, 0}, 0.8f, shiny, 24);
    b.add_box({-3, -3, -3}, {3, 3, 3}, b.add_material({0.5f, 0.5f, 0.5f}), true);
    b.add_point_light({1, 1, 1}, 10);
    b.add_camera(all_around(), {0, 0, 0}, {0, 0, -1});
    FilmStage stage(b, panorama_frame(4), true);
    const core::Radiance lit = stage.cut(0.05f);
    for (const glm::vec3& r : lit.combined.values()) {
        EXPECT_TRUE(std::isfinite(r.x) && std::isfinite(r.y) && std::isfinite(r.z));
        EXPECT_GE(std::min({r.x, r.y, r.z}), 0);
    }
    EXPECT_EQ(stage.statistics().non_finite, 0u);
}

}  // namespace
}  // namespace render2mpeg::renderer
