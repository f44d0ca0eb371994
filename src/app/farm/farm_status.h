#pragma once
// `render2mpeg farm-status`: how far the parts of a film are.
#include "app/options/options.h"

namespace render2mpeg::app {

/// Returns the exit status. Throws core::Error.
int farm_status(const FarmStatusOptions& options);

}  // namespace render2mpeg::app
