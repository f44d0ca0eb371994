#pragma once

#include <vector>

namespace render2mpeg::app {

struct RatePoint {
    double bits = 0;  ///< > 0; or any other cost
    double psnr = 0;  ///< dB; or any other quality that grows
};

/// Mean difference of rate at equal quality in per cent, over the qualities both curves reach; negative: `test` needs
/// fewer bits. NaN where no quality is reached by both, or a curve has fewer than two. [Bjontegaard2001] with piecewise
/// cubics of log rate over quality.
double bd_rate(std::vector<RatePoint> anchor, std::vector<RatePoint> test);

}  // namespace render2mpeg::app
