#include <gtest/gtest.h>

#include <numbers>

#include "tests/hard_cases/hard_case.h"

namespace render2mpeg::test {
namespace {

SceneBuilder seen_by(const std::function<void(scene::CameraLens&)>& change) {
    SceneBuilder b = floor_from_above();
    b.add_point_light({0, 2, 0}, 1);
    change(b.film().cameras.front());
    return b;
}

/// A wall of one radiance that fills the view.
SceneBuilder bright_wall(float radiance) {
    SceneBuilder b;
    b.add_quad({-5, -5, -1}, {10, 0, 0}, {0, 10, 0}, b.add_emitter(glm::vec3(radiance)));
    b.add_camera({0, 0, 0}, {0, 0, -1});
    return b;
}

HardCase of_size(int width, int height, const char* name) {
    return {name,
            "blocks that the picture does not fill, chroma of half a sample",
            "coded and shown as it is",
            [] { return small_room(); },
            [](const Lit& film) { EXPECT_GT(film.mean(), 0.0); },
            INFINITY,
            "",
            {width, height}};
}

}  // namespace

std::vector<HardCase> view_cases() {
    return {
        {"a camera inside a block", "back faces, distances that count from outside",
         "the inside is seen, black without light",
         [] {
             SceneBuilder b = floor_from_above();
             b.add_box({-0.5f, 1.5f, -0.5f}, {0.5f, 2.5f, 0.5f}, b.add_material(glm::vec3(0.5f)));
             b.add_point_light({2, 2, 2}, 1);
             return b;
         },
         [](const Lit& film) { EXPECT_EQ(film.brightest(), 0.0f); }},
        {"a camera on a surface", "the first hit is at distance 0", "finite, and a whole film",
         [] {
             SceneBuilder b;
             b.add_quad({-5, 0, 5}, {10, 0, 0}, {0, 0, -10}, b.add_material(glm::vec3(0.5f)));
             b.add_camera({0, 0, 0}, {0, 1, 0});
             b.film().sky.color = glm::vec3(1);
             return b;
         }},
        {"a camera that looks straight down", "its up vector is along its view", "the floor",
         [] { return seen_by([](scene::CameraLens&) {}); },
         [](const Lit& film) { EXPECT_GT(film.at(16, 16).y, 0.9f * 0.5f / std::numbers::pi_v<float> / 4); }},
        {"a field of view of a hundredth of a degree", "all rays round to one direction",
         "a piece of the floor as bright as its middle",
         [] { return seen_by([](scene::CameraLens& lens) { lens.vertical_fov = 1.7e-4f; }); },
         [](const Lit& film) { EXPECT_NEAR(film.at(3, 3).y / film.at(28, 28).y, 1.0f, 0.03f); }},
        {"a field of view of 179.9 degrees", "its tangent is 1e3", "finite, and a whole film",
         [] { return seen_by([](scene::CameraLens& lens) { lens.vertical_fov = 3.1398f; }); }},
        {"a field of view of half a turn",
         "its tangent is infinite",
         "a line that names the camera",
         [] { return seen_by([](scene::CameraLens& lens) { lens.vertical_fov = std::numbers::pi_v<float>; }); },
         {},
         {},
         "camera 0"},
        {"parallel rays across no height",
         "division by it",
         "a line that names the camera",
         [] {
             return seen_by([](scene::CameraLens& lens) {
                 lens.projection = scene::ProjectionKind::orthographic, lens.y_magnification = 0;
             });
         },
         {},
         {},
         "camera 0"},
        {"parallel rays", "a camera without a place: depth and distance are not the same", "the floor",
         [] {
             return seen_by([](scene::CameraLens& lens) {
                 lens.projection = scene::ProjectionKind::orthographic, lens.y_magnification = 1;
             });
         },
         [](const Lit& film) { EXPECT_GT(film.at(16, 16).y, 0.9f * 0.5f / std::numbers::pi_v<float> / 4); }},
        {"a picture that is white all over", "the tone curve has no inverse where it clips", "white, and a small film",
         [] { return bright_wall(1e6f); },
         [](const Lit& film) {
             EXPECT_EQ(film.decoded.back().y.at(16, 16), 235);
             EXPECT_LT(film.bytes, 4000u);
         }},
        {"a picture of one grey", "no detail: contrasts and masking of 0", "that grey, and a small film",
         [] { return bright_wall(0.18f); }, [](const Lit& film) { EXPECT_LT(film.bytes, 4000u); }},
        of_size(1, 1, "a picture of one pixel"),
        of_size(33, 17, "a picture of 33x17"),
        of_size(2, 48, "a picture of 2x48"),
    };
}

}  // namespace render2mpeg::test
