#pragma once
// The next level of a mip pyramid.
#include <glm/glm.hpp>

#include "core/plane.h"
#include "core/wrap.h"

namespace render2mpeg::image {

/// The next level of a mip pyramid: each side is halved (rounded down, at least 1), whatever its length, by a filter
/// that spans the exact ratio of the two lengths, so that nothing shifts and, where the image repeats, the mean stays.
/// Values are linear.
core::Plane<glm::vec4> halve(const core::Plane<glm::vec4>& level, core::Wrap wrap_u, core::Wrap wrap_v);

/// The texel that stands for `i` of a row of `n`.
int wrapped(int i, int n, core::Wrap wrap);

}  // namespace render2mpeg::image
