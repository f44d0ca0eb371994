#pragma once
// Bjontegaard's mean difference of rate.
#include <vector>

namespace render2mpeg::app {

struct RatePoint {
    double bits = 0;  ///< > 0; or any other cost
    double psnr = 0;  ///< dB; or any other quality that grows
};

/// Mean difference of rate at equal quality, per cent, over the common qualities; negative: `test` needs fewer bits.
/// NaN without common quality or with fewer than two points. [Bjontegaard2001] with piecewise cubics of log rate.
double bd_rate(std::vector<RatePoint> anchor, std::vector<RatePoint> test);

}  // namespace render2mpeg::app
