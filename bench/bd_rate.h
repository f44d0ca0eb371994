#pragma once

#include "app/experiments/bd_rate.h"

namespace render2mpeg::bench {

using app::bd_rate;
using app::Pchip;
using app::RatePoint;

}  // namespace render2mpeg::bench
