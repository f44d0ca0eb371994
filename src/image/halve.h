#pragma once
// The next level of a mip pyramid.

#include <functional>
#include <glm/glm.hpp>

#include "core/plane.h"
#include "core/wrap.h"

namespace render2mpeg::image {

/// The next level of a mip pyramid: each side is halved (rounded down, at least 1), whatever its length, by a filter
/// that spans the exact ratio of the two lengths, so that nothing shifts and, where the image repeats, the mean stays.
/// Values are linear.
core::Plane<glm::vec4> halve(const core::Plane<glm::vec4>& level, core::Wrap wrap_u, core::Wrap wrap_v);

/// Hands out row `y` of a level, which stays until the next call.
using RowOf = std::function<const glm::vec4*(int y)>;

/// The same for a level of `width` x `height` that need not be in memory: each row is asked for once but for those that
/// an edge wants again.
core::Plane<glm::vec4> halve(int width, int height, const RowOf& row, core::Wrap wrap_u, core::Wrap wrap_v);

/// The texel that stands for `i` of a row of `n`.
int wrapped(int i, int n, core::Wrap wrap);

}  // namespace render2mpeg::image
