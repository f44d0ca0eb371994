#include "perceptual/flicker.h"

#include <cmath>

#include "core/error.h"
#include "perceptual/along_motion.h"

namespace render2mpeg::perceptual {

double change_along(const core::MotionField& motion, const core::Plane<std::uint8_t>& now,
                    const core::Plane<std::uint8_t>& before) {
    EXPECTS(now.width() == before.width() && now.height() == before.height());
    EXPECTS(motion.kind.width() == now.width() && motion.kind.height() == now.height());
    double sum = 0, count = 0;
    for (int y = 0; y < now.height(); ++y)
        for (int x = 0; x < now.width(); ++x) {
            const std::optional<float> there = value_along(motion, before, x, y);
            if (!there) continue;
            sum += std::abs(static_cast<double>(now.at(x, y)) - static_cast<double>(*there));
            count += 1;
        }
    return count > 0 ? sum / count : 0.0;
}

}  // namespace render2mpeg::perceptual
