#include "encoder/mpeg2/motion/picture_order.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "encoder/mpeg2/bitstream/tuning.h"

namespace render2mpeg::encoder::mpeg2 {

std::int64_t next_reference_after(std::int64_t rest, int most_b, std::optional<double> motion_nonuniformity) {
    EXPECTS(rest >= 1 && most_b >= 0);
    // Refer no further than vectors hold, but spare no B picture altogether: half of a distance of two is one.
    std::int64_t furthest = most_b + 1;
    if (motion_nonuniformity && *motion_nonuniformity * static_cast<double>(furthest) > nonuniform_reach)
        furthest = std::clamp<std::int64_t>(static_cast<std::int64_t>(nonuniform_reach / *motion_nonuniformity),
                                            std::min<std::int64_t>(2, furthest), furthest);
    const std::int64_t runs = (rest + furthest - 1) / furthest;
    return (rest + runs - 1) / runs;
}

}  // namespace render2mpeg::encoder::mpeg2
