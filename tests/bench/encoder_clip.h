#pragma once

#include <cstdint>
#include <vector>

#include "core/motion_field.h"
#include "core/picture.h"

namespace render2mpeg::bench {

/// A film with exact motion for measuring the encoder without a renderer: a walk through a textured room with spinning
/// spheres, lit by a lamp, 4 samples per pixel.
struct Clip {
    std::vector<core::Picture> pictures;
    std::vector<core::MotionField> motion;  ///< [n]: from picture n to n - 1; [0] is empty
};

/// `speed` 1 is a slow walk (a few pixels per picture), 3 a hasty one. The same arguments give the same film.
Clip make_clip(int width, int height, int count, float speed);

}  // namespace render2mpeg::bench
