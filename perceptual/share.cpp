#include "perceptual/share.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"

namespace render2mpeg::perceptual {

float default_share(float scale) {
    EXPECTS(scale > 0.0f);
    // fit: docs/fits/coupled-share
    constexpr float share = 0.156f, exponent = -0.116f;
    return std::min(1.0f, share * std::pow(scale, exponent));
}

}  // namespace render2mpeg::perceptual
