#include "perceptual/tolerance_fraction.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"

namespace render2mpeg::perceptual {

float propagation_factor(bool intra, std::int64_t followers) {
    EXPECTS(followers >= 0);
    // chosen: 0.51 for an I picture of a GOP of 15 (0.3 to 1.4 tried), 0.78 to 1 for its P pictures (0.5 to 1), at
    // equal rays. docs/measurements.md#tolerance-fraction, "By type". Followers beyond 14 were not tried and change
    // nothing.
    constexpr std::int64_t most = 14;
    const float strength = intra ? 0.25f : 0.1f;
    return std::pow(1.0f + static_cast<float>(std::min(followers, most)), -strength);
}

}  // namespace render2mpeg::perceptual
