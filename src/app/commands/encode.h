#pragma once

#include "app/options/options.h"

namespace render2mpeg::app {

/// `render2mpeg encode`: frames and motion of any renderer to a film. Returns the exit status: 0, or 130 after an
/// interruption. Throws core::Error.
int encode(const EncodeOptions& options, const std::string& command);

}  // namespace render2mpeg::app
