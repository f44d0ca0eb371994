#pragma once
// The border type of exact motion, per picture and reference.
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>

#include "core/plane.h"
#include "core/visible.h"

namespace render2mpeg::core {

/// Dense exact motion from one picture to one of its references (docs/model/scene.md).
struct MotionField {
    std::int64_t picture = 0;    ///< display number
    std::int64_t reference = 0;  ///< display number; before or after `picture`
    /// Position in the reference minus position here, pixels, y down; may point outside. Meaningless for class `none`.
    Plane<glm::vec2> vector;
    /// Depth that the pixel's point has in the reference's camera; +infinity for the sky. Empty where not needed.
    Plane<float> depth_in_reference;
    /// `none`: the point does not exist in the reference or lies behind its camera.
    Plane<PixelClass> kind;
    bool wraps = false;  ///< the reference's columns go on from the right edge to the left one: a panorama's

    /// A column of the reference's picture, where that wraps at -0.5 to the width - 0.5.
    float column(float x) const {
        if (!wraps) return x;
        const auto turn = static_cast<float>(vector.width());
        return x - turn * std::floor((x + 0.5f) / turn);
    }
};

}  // namespace render2mpeg::core
