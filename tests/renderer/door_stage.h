#pragma once

#include <cmath>
#include <numbers>

#include "tests/renderer/virtual_light_stage.h"

namespace render2mpeg::test {

/// The wall between both rooms lies here, 20 cm thick.
inline constexpr float door_wall = 4.0f;

/// Two rooms with a doorway between, a lamp in the left one, and a door of 4 cm in the doorway: it is shut in the first
/// second and swings into the right room in the next.
inline SceneBuilder rooms_with_a_door() {
    SceneBuilder b;
    const int grey = b.add_material({0.7f, 0.6f, 0.5f}), wood = b.add_material({0.5f, 0.35f, 0.2f});
    b.add_box({0, 0, 0}, {8, 3, 4}, grey, true);
    b.add_box({door_wall - 0.1f, -0.1f, -0.1f}, {door_wall + 0.1f, 3.1f, 1.5f}, grey);
    b.add_box({door_wall - 0.1f, -0.1f, 2.5f}, {door_wall + 0.1f, 3.1f, 4.1f}, grey);
    b.add_box({door_wall - 0.1f, 2.2f, 1.4f}, {door_wall + 0.1f, 3.1f, 2.6f}, grey);
    // It reaches 1 cm into floor, lintel and both jambs: there is no gap.
    const int door = b.add_object(b.add_mesh(SceneBuilder::box({-0.02f, -0.01f, 0}, {0.02f, 2.21f, 1.02f}, false)),
                                  wood, {door_wall, 0, 1.49});
    const float half = 0.25f * std::numbers::pi_v<float>;
    b.add_track(scene::TrackTarget::rotation, b.film().objects[static_cast<std::size_t>(door)].node, 4, {0, 1, 2},
                {0, 0, 0, 1, 0, 0, 0, 1, 0, std::sin(half), 0, std::cos(half)});
    b.add_point_light({2, 2, 2}, 20.0f);
    b.add_camera({7.5f, 1.6f, 2}, {4, 1, 2}, 1.2f);
    return b;
}

}  // namespace render2mpeg::test
