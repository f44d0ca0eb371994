#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "tests/hard_cases/hard_case.h"

namespace render2mpeg::test {
namespace {

/// Half of each frame's time.
SceneBuilder with_open_shutter(SceneBuilder b, float angle = 180) {
    b.film().shutter.angle = angle;
    return b;
}

/// A lit floor with a block that is at these places at frames 0, 1 and 2.
SceneBuilder exposed_block(const std::vector<glm::vec3>& places, float angle = 180) {
    SceneBuilder b = floor_from_above();
    const int block = b.add_box({-0.3f, 0, -0.3f}, {0.3f, 0.3f, 0.3f}, b.add_material({0.2f, 0.4f, 0.6f}));
    b.move_object(block, places);
    b.add_point_light({0.5f, 1.9f, 0.5f}, 1);
    return with_open_shutter(std::move(b), angle);
}

SceneBuilder through_lens(float f_stop, float focus, float sensor_height = 0.024f) {
    SceneBuilder b = small_room();
    scene::CameraLens& lens = b.film().cameras.at(0);
    lens.f_stop = f_stop;
    lens.focus_distance = focus;
    lens.sensor_height = sensor_height;
    return b;
}

SceneBuilder turning_block(float radians) {
    SceneBuilder b = exposed_block({{0, 0, 0}, {0, 0, 0}, {0, 0, 0}}, 360);
    std::vector<float> turns, times;
    for (int k = 0; k <= 24; ++k) {
        const float half = radians * static_cast<float>(k) / 24;
        times.push_back(static_cast<float>(k) / 12);
        turns.insert(turns.end(), {0, std::sin(half), 0, std::cos(half)});
    }
    b.add_track(scene::TrackTarget::rotation, b.film().objects.back().node, 4, times, turns);
    return b;
}

HardCase refused_shutter(const char* name, float angle, float phase) {
    return {name,
            "strata of time without bounds",
            "a line that names the shutter",
            [=] {
                SceneBuilder b = small_room();
                b.film().shutter = {angle, phase};
                return b;
            },
            {},
            {},
            "shutter"};
}

HardCase refused_lens(const char* name, const char* breaks, float f_stop, float focus, float sensor_height = 0.024f) {
    return {
        name, breaks,    "a line that names the camera", [=] { return through_lens(f_stop, focus, sensor_height); }, {},
        {},   "camera 0"};
}

}  // namespace

std::vector<HardCase> exposure_cases() {
    constexpr float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
    return {
        of_side({"an open shutter over what stands still", "noise of the strata where nothing is blurred",
                 "the film of a closed shutter, bit for bit", [] { return with_open_shutter(small_room(), 360); },
                 [](const Lit& film) {
                     HardCase plain;
                     plain.size = {16, 16};
                     EXPECT_TRUE(
                         same_values(film.frames[2].combined, lit(plain, small_room(), film.way).frames[2].combined));
                 }},
                16),
        {"an open shutter in a film of one frame",
         "there is no frame before or behind",
         "a frame that is blurred",
         [] {
             return exposed_block({{-1, 0, 0}, {1, 0, 0}});
         },
         {},
         INFINITY,
         "",
         {16, 16},
         1},
        {"a block that passes the eye while the shutter is open", "what is behind the eye has no place in the picture",
         "finite, and the floor on both sides",
         [] {
             return exposed_block({{0, -4, 0}, {0, 1.9f, 0}, {0, 8, 0}});
         }},
        {"a block that crosses 10,000 pixels in a frame", "more strata than memory, boxes of the whole world",
         "a trace of it, and a finished film",
         [] {
             return exposed_block({{-600, 0, 0}, {0, 0, 0}, {600, 0, 0}});
         },
         [](const Lit& film) { EXPECT_NEAR(film.mean(1) / film.mean(0), 1.0, 0.1); }},
        of_side({"a block that turns three times in a frame", "its corners' chords miss its arcs", "a round blur",
                 [] { return turning_block(6 * std::numbers::pi_v<float>); }},
                16),
        of_side({"a block of size 0 when the shutter opens", "no inverse at one instant, and one at the next", "finite",
                 [] {
                     SceneBuilder b = exposed_block({{0, 0, 0}, {0.2f, 0, 0}, {0.4f, 0, 0}});
                     b.add_track(scene::TrackTarget::scale, b.film().objects.back().node, 3, {0.75f, 1, 2},
                                 {0, 0, 0, 1, 1, 1, 1, 1, 1});
                     return b;
                 }},
                16),
        {"an aperture wider than the room",
         "rays begin inside of walls",
         "finite",
         [] { return through_lens(0.01f, 2, 0.5f); },
         nullptr,
         std::numeric_limits<float>::infinity(),
         {},
         {16, 16},
         1},
        of_side({"a focus at 1e30", "the far plane less the lens' own place rounds to nothing", "finite",
                 [] { return through_lens(1.4f, 1e30f); }},
                16),
        {"a focus a millionth before the eye",
         "its inverse makes discs of 1e6 pixels",
         "finite",
         [] { return through_lens(22, 1e-6f); },
         nullptr,
         std::numeric_limits<float>::infinity(),
         {},
         {16, 16},
         1},
        refused_lens("a focus on the eye", "division by its distance", 2.8f, 0),
        refused_lens("an f-stop below 0", "an aperture turned inside out", -1, 2),
        refused_lens("an f-stop that is no number", "NaN in every ray", nan, 2),
        refused_lens("a sensor without size", "no focal length", 2.8f, 2, 0),
        refused_shutter("a shutter of 400 degrees", 400, 0),
        refused_shutter("a shutter whose angle is no number", nan, 0),
        refused_shutter("a shutter an infinity late", 180, inf),
    };
}

}  // namespace render2mpeg::test
