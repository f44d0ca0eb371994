// Light of a film in which something bright crosses a room.
#include <gtest/gtest.h>

#include <string>

#include "tests/renderer/moving_light_film.h"

namespace render2mpeg::renderer {
namespace {

using test::FilmLight;
using test::MovingLightFilm;
using test::SceneBuilder;

constexpr int flicker_size = 24, first = 3, frames = 4;

/// A white ball that crosses a room under a lamp, 12 cm a frame, or shines itself.
SceneBuilder flicker_room(bool glows) {
    SceneBuilder b;
    b.add_box({0, 0, 0}, {5, 3, 5}, b.add_material({0.7f, 0.6f, 0.5f}), true);
    b.add_box({3.0f, 0, 1.0f}, {4.0f, 1.5f, 2.0f}, b.add_material({0.3f, 0.5f, 0.7f}));
    const int ball =
        b.add_sphere({0, 0, 0}, 0.4f, glows ? b.add_emitter(glm::vec3(8)) : b.add_material(glm::vec3(0.9f)), 10);
    b.move_object(ball, {{1, 0.6f, 3}, {4.0f, 0.6f, 3}});
    b.add_point_light({2, 2.4f, 3}, glows ? 2.0f : 20.0f, {1, 0.8f, 0.6f});
    b.add_camera({2.5f, 1.7f, 4.9f}, {2.5f, 1.0f, 0.0f}, 1.1f);
    return b;
}

class FlickerSlow : public testing::TestWithParam<bool> {};

TEST_P(FlickerSlow, AlongMotionIsThatOfLightWithoutNoise) {
    MovingLightFilm film(flicker_room(GetParam()), flicker_size);
    // The reference: four times the light points, and cuts of half a per cent.
    FilmLight usual, fine;
    fine.virtual_lights.vpls = 4 * usual.virtual_lights.vpls;
    fine.tolerance = core::ToleranceMap::uniform(flicker_size, flicker_size, {0.0f, 0.005f});
    const double reference = film.flicker(film.lit(fine, first, frames), first);
    usual.tolerance = fine.tolerance;
    const double points = film.flicker(film.lit(usual, first, frames), first);
    usual.tolerance = core::ToleranceMap::uniform(flicker_size, flicker_size, {0.0f, 0.02f});
    const double cuts = film.flicker(film.lit(usual, first, frames), first);
    EXPECT_GT(reference, 0.002);
    EXPECT_LE(points, 1.1 * reference) << points / reference;
    EXPECT_GE(points, 0.9 * reference) << points / reference;
    EXPECT_LE(cuts, 1.18 * reference) << cuts / reference;
    RecordProperty("points", std::to_string(points / reference));
    RecordProperty("cuts", std::to_string(cuts / reference));
}
INSTANTIATE_TEST_SUITE_P(OfAWhiteBallAndALamp, FlickerSlow, testing::Bool());

}  // namespace
}  // namespace render2mpeg::renderer
