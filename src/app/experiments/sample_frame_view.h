#pragma once

#include <string>

#include "app/experiments/trial.h"

namespace render2mpeg::app {

/// A trial's last reference frame in a page: as it was decoded beside the truth, what its light may be off by and what
/// it is off by. Empty where no truth is known. `name`: what the trial is called.
std::string sample_frame_figures(const std::string& name, const Trial& trial, perceptual::ColorMatrix matrix);

/// Two trials' last reference frame, both decoded, beside each other. Empty where either has none.
std::string decoded_pair(const std::string& title, const std::string& name, const Trial& trial,
                         const std::string& other_name, const Trial& other, perceptual::ColorMatrix matrix);

}  // namespace render2mpeg::app
