#pragma once

#include <string>
#include <vector>

#include "tests/support/scene_builder.h"

namespace render2mpeg::bench {

/// Small films in each of which things move through a room under a lamp, 25 frames a second, two seconds: what light
/// may get wrong about what moves. All show 5 m x 3 m x 5 m.
///
/// `ball`: a white ball of 40 cm crosses the room. `along_wall`: a white board of 60 cm x 60 cm x 2 cm slides along the
/// back wall, 4 cm off it, less than the radius of a VPL's disc. `touching_wall`: the same, 1 mm off it. `swarm`:
/// 60 balls of 8 cm fly about, each its own way. `copies`: the ball of `ball`, before three columns that are still
/// instances; `columns`: the same, the columns no instances.
test::SceneBuilder mover_scene(const std::string& name);

std::vector<std::string> names_of_mover_scenes();

}  // namespace render2mpeg::bench
