#pragma once

#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "core/motion_field.h"
#include "core/picture.h"

namespace render2mpeg::bench {

/// A film with exact motion for measuring the encoder without a renderer: a walk through a textured room with spinning
/// spheres, lit by a lamp, 4 samples per pixel.
class Clip {
  public:
    /// `speed` 1 is a slow walk (a few pixels per picture), 3 a hasty one. The same arguments give the same film.
    Clip(int width, int height, int count, float speed);

    std::vector<core::Picture> pictures;

    /// Exact motion from one picture to another; computed when it is first asked for. Not for several threads.
    const core::MotionField& motion(std::int64_t picture, std::int64_t reference) const;

  private:
    int width_, height_;
    float speed_;
    mutable std::map<std::pair<std::int64_t, std::int64_t>, core::MotionField> fields_;
};

}  // namespace render2mpeg::bench
