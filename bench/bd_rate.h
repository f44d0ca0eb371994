#pragma once

#include "perceptual/bd_rate.h"

namespace render2mpeg::bench {

using perceptual::bd_rate;
using perceptual::Pchip;
using perceptual::RatePoint;

}  // namespace render2mpeg::bench
