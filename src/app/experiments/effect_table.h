#pragma once
// The effects of a film in a page: what each takes, and the picture without it.
#include <string>

#include "app/experiments/effect_costs.h"
#include "perceptual/display.h"

namespace render2mpeg::app {

/// The table with a small picture of each, and a large one in which they can be seen beside the whole. Empty where
/// there are no rows.
std::string effects_section(const EffectCosts& effects, perceptual::ColorMatrix matrix);

}  // namespace render2mpeg::app
